"""A law written in Python on a meshed master gives what the same law in the core gives.

Requirement: an open interface for both kinds of master, with the exact tangent; source: the law of
the core, order of convergence, balance. Requirement and source of the others stand with the test.
"""

from __future__ import annotations

import shutil
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.conftest import difference_errors
from tests.verification.laws_in_python import RadialReturn, Skew, Spoiled
from tests.verification.test_fe_self_contact import GAP, hairpin

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Augmentation, ContactLaw, Interface, PythonLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.results import checkpoint
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

#: At slave nodes.
POINTS, MORTAR = (partial(Contact, mortar=nodes) for nodes in (False, True))


type Ends = dict[str, dict[str, float]]

STIFFNESS, COEFFICIENTS = (2e4, 8e3), (0.3, 0.12)
MARKS = make_directions("constant", vector=(1, 0, 0), angle=np.pi / 6)
NORMAL = NormalLaw(penalty=2e4)
RADIAL = RadialReturn(STIFFNESS, COEFFICIENTS)
HELD = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
DOWN = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.02}}
LATER = [
    Step("drag", 2, {"block.top": {"x": 0.01, "y": 0.004, "z": -0.015}}),
    Step("lift", 1, {"block.top": {"x": 0.012, "z": -0.005}}),
]


def _python(law: Any = RADIAL, on: str = "master") -> ContactLaw:
    return ContactLaw(NORMAL, PythonLaw(law, directions=MARKS, directions_on=on))


def _core() -> ContactLaw:
    return ContactLaw(
        NORMAL,
        Adhesion(stiffness=STIFFNESS, directions=MARKS),
        Friction(coefficients=COEFFICIENTS, directions=MARKS, sliding_rule="radial"),
    )


def _blocks(cell: str = "hexahedron", order: int = 1) -> Model:
    """A block on a base whose mesh does not match."""
    upper = BoxSpec((0, 0, 0), (1, 1, 0.5), (2, 2, 1), cell=cell, order=order)
    lower = BoxSpec((-0.5, -0.5, -0.5), (2, 2, 0.5), (3, 3, 1), cell=cell, order=order)
    return build_box({"block": upper, "base": lower})


def _problem(law: Any, kind: Any = POINTS, material: str = "neo-hookean", **given: Any) -> Problem:
    shape = {name: given.pop(name) for name in ("cell", "order") if name in given}
    model = _blocks(**shape)
    elastic = make_material(material, E=1000.0, nu=0.3)
    given.setdefault("current_area", material != "linear-elastic")
    contact = kind(model, "block.bottom", "base.top", law=law, **given)
    return Problem(model, {"block": elastic, "base": elastic}, [contact])


def _solver(
    problem: Problem, strategy: str = "direct", rtol: float = 1e-12, held: Ends | None = None
) -> Solver:
    first = Step("press", 2, {**HELD, **DOWN, **(held or {})})
    options = {"snes_rtol": rtol}
    return Solver(problem, [first, *LATER], options=options, strategy=strategy)


def _numbers(
    problem: Problem, strategy: str = "direct", held: Ends | None = None
) -> tuple[list[Any], np.ndarray]:
    """Resultants, energies, iterations and counts of all increments; displacements at the end."""
    found = []
    for a in _solver(problem, strategy, held=held).run():
        numbers = [*np.ravel(list(a.resultants.values())), *a.energies.values()]
        found.append((np.array(numbers), a.iterations, a.contacts))
    return found, problem.u.x.array.copy()


def _same(
    one: Problem,
    other: Problem,
    tolerance: float,
    strategy: str = "direct",
    held: Ends | None = None,
) -> None:
    (ours, u), (theirs, v) = _numbers(one, strategy, held), _numbers(other, held=held)
    assert len(ours) == len(theirs) == 5
    scale = max(np.abs(numbers).max() for numbers, _, _ in theirs)
    for (a, _, _), (b, _, _) in zip(ours, theirs, strict=True):
        assert np.abs(a - b).max() <= tolerance * scale
    assert np.abs(u - v).max() <= tolerance * np.abs(v).max()
    seen = {s for _, _, points in theirs for p in points.values() for s, n in p.items() if n}
    assert {"stick", "slip"} <= seen


@pytest.mark.parametrize("on", ["master", "slave"])
@pytest.mark.parametrize("kind", [POINTS, MORTAR])
def test_same_as_the_core(kind: Any, on: str) -> None:
    """Forces, energies and displacements of a pair that sticks and slips, isotropic friction.

    Tolerance 1e-9 relative: both are solved to a residual of 1e-12.
    """
    adhesion, friction = (2e4, 2e4), (0.3, 0.3)
    core = ContactLaw(
        NORMAL,
        Adhesion(stiffness=adhesion),
        Friction(coefficients=friction, sliding_rule="radial"),
    )
    own = _python(RadialReturn(adhesion, friction), on)
    one, other = (_problem(law, kind) for law in (own, core))
    _same(one, other, 1e-9)
    assert one.contacts[0].state["internal"].max() > 0.0


def test_same_axes_as_the_core() -> None:
    """Orthotropic friction on a master that nothing shears.

    Both axes of the core follow the material, that of a law in Python only the first: they are the
    same where the master does not shear. Tolerance 1e-9 relative: both are solved to a residual of
    1e-12.
    """
    held = {"base.top": dict.fromkeys("xyz", 0.0)}
    one, other = _problem(_python()), _problem(_core())
    _same(one, other, 1e-9, held=held)
    axes, those = (p.contacts[0].last.directions_friction for p in (one, other))
    np.testing.assert_allclose(axes, those, rtol=0.0, atol=1e-9)


def test_newton_takes_as_many_iterations() -> None:
    """With the tangent of the core: the same iterations, one more or less by rounding."""
    (ours, _), (theirs, _) = (_numbers(_problem(law)) for law in (_python(), _core()))
    assert max(abs(a[1] - b[1]) for a, b in zip(ours, theirs, strict=True)) <= 1


@pytest.mark.parametrize("law", [RADIAL, Skew(2e4)], ids=["radial", "skew"])
@pytest.mark.parametrize(
    ("cell", "order", "kind", "on"),
    [
        ("hexahedron", 1, POINTS, "master"),
        ("tetrahedron", 2, POINTS, "slave"),
        ("hexahedron", 2, MORTAR, "master"),
        ("hexahedron", 1, POINTS, ""),
    ],
)
def test_tangent_by_order(law: Any, cell: str, order: int, kind: Any, on: str) -> None:
    """Halving the step quarters the error of central differences, asserted 3.5 to 4.5.

    From a random state in contact, with history of an increment before it. The skew law has a
    slope by everything that it sees: also the turn of its axes against a facet counts.
    """
    directed = _python(law, on) if on else ContactLaw(NORMAL, PythonLaw(law))
    problem = _problem(directed, kind, cell=cell, order=order)
    ends = {**HELD, "block.top": {"x": 0.003, "y": 0.002, "z": -0.02}}
    for _ in Solver(problem, [Step("press", 2, ends)]).run():
        pass
    rng = np.random.default_rng(2)
    x = problem.accepted()
    x.array[:] += rng.normal(0.0, 2e-4, x.getLocalSize())
    problem.set_load_factor(1.0, 1.0)
    problem.evaluate(x)
    counts = problem.contacts[0].counts()
    assert counts["stick"] + counts["slip"] > 10
    direction = x.duplicate()
    direction.array[:] = rng.normal(size=x.getLocalSize())
    errors = difference_errors(problem, x, direction, (2e-7, 1e-7))
    # below 1e-7 the difference is rounding, and the order cannot be seen
    assert 3.5 < errors[0] / errors[1] < 4.5 or errors[0] < 1e-7


@pytest.mark.parametrize("kind", [POINTS, MORTAR])
def test_forces_and_moments_balance(kind: Any) -> None:
    """Contact does nothing to both bodies together: 1e-13 of the sizes of the nodal forces.

    Source: third law. Tolerance: rounding. At slave nodes moments balance but for the couple of
    friction over what the penalty leaves of the gap.
    """
    problem = _problem(_python(), kind)
    x = problem.model.space.tabulate_dof_coordinates()
    for _ in _solver(problem).run():
        u = problem.u.x.array.reshape(-1, 3)
        contact = problem.contacts[0]
        forces = np.zeros_like(u)
        contact.update(u, 1.0)
        contact.add_force(forces)
        contact.roll_back()
        scale = np.abs(forces).sum()
        assert np.abs(forces.sum(axis=0)).max() < 1e-13 * scale
        couple = np.abs(np.cross(x + u, forces).sum(axis=0)).max()
        gap = np.abs(contact.last.gap).max()
        assert couple < (1e-13 if kind is POINTS else gap) * scale
        friction = contact.last.traction_t * contact.areas[:, None]
    assert np.abs(friction).sum() > 0.01 * scale


def test_condensed() -> None:
    """Bodies condensed to their contact nodes: the same to 1e-9 of the whole matrix."""
    one, other = (_problem(_python(), material="linear-elastic") for _ in range(2))
    _same(one, other, 1e-9, "condensed")


@pytest.mark.parametrize("multipliers", ["newton", "uzawa"])
def test_exact_pressure(multipliers: str) -> None:
    """Multipliers hold the gap at zero; the tangential law is physical and is refused for them."""
    exact = Augmentation(tangential=False, multipliers=multipliers)
    problem = _problem(_python(), material="linear-elastic", augmentation=exact)
    for _ in _solver(problem, rtol=1e-8).run():
        contact = problem.contacts[0]
        assert contact.extreme(-contact.last.gap) < exact.tolerance * contact.facet_size
    with pytest.raises(InputError, match="a tangential law written in Python is physical"):
        _problem(_python(), augmentation=Augmentation(multipliers=multipliers))


def test_restart_carries_what_the_law_remembers(tmp_path: Any) -> None:
    """Through the file and back: what follows is the same bit by bit."""
    first, second = (_solver(_problem(_python())) for _ in range(2))
    later = []
    for count, accepted in enumerate(first.run()):
        if count == 2:
            own, common = checkpoint.own_arrays(first.problem.model, first.persistent())
            checkpoint.save_checkpoint(tmp_path, own | common, {})
            kept = first.problem.contacts[0].state["internal"].copy()
        elif count > 2:
            later.append(accepted)
    stored = checkpoint.load_checkpoint(tmp_path)
    assert stored is not None
    like = second.persistent()
    second.restore(checkpoint.distribute(stored, second.problem.model, like))
    assert np.array_equal(second.problem.contacts[0].state["internal"], kept)
    assert kept.max() > 0.0
    for a, b in zip(later, second.run(), strict=True):
        assert (a.iterations, a.residuals, a.energies) == (b.iterations, b.residuals, b.energies)
    ends = [s.problem.contacts[0].state["internal"] for s in (first, second)]
    assert np.array_equal(*ends)
    assert not np.array_equal(ends[0], kept)


WRONG = {
    "one component": (
        "traction",
        lambda v: v[:, :1],
        r"traction: .* of shape \(\d+, 1\), .* needed",
    ),
    "no number": ("d_increment", lambda v: np.nan * v, r"d_increment: .* nan.* finite numbers"),
    "own": ("internal", lambda v: v[:, 0], r"internal: .* of shape \(\d+,\), \(\d+, 1\) needed"),
    "endless": ("energy", lambda v: v + np.inf, "energy: .* inf at .* points, finite numbers"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_answers_are_said(name: str) -> None:
    """An array that cannot be is one line with its name, at the start or out of Newton's method."""
    array, wrong, text = WRONG[name]
    with pytest.raises(InputError, match=text) as said:
        list(_solver(_problem(_python(Spoiled(RADIAL, array, wrong)))).run())
    assert "\n" not in str(said.value)


ON_ONE = """
import numpy as np
from anisocontact.base.errors import InputError
from mpi4py import MPI
from tests.verification import pairs_on_ranks as pairs
from tests.verification.laws_in_python import RadialReturn, Spoiled
wrong = np.nan if MPI.COMM_WORLD.rank == 0 else 1.0
own = Spoiled(RadialReturn((8.0, 16.0), (0.2, 0.4)), "traction", lambda v: wrong * v)
model = pairs._bodies("tetrahedron")
law = pairs.ContactLaw(pairs.NormalLaw(penalty=20.0), pairs.PythonLaw(own))
pair = pairs.Contact(model, "block.bottom", "mat.top", law=law)
try:
    list(pairs.Solver(*pairs._dragged(model, [pair])).run())
except InputError as error:
    print(error, flush=True)
"""


@pytest.mark.mpi
def test_a_wrong_answer_on_one_process_is_said_on_all() -> None:
    """The law spoils its force on the first of two processes alone: both stop with that line."""
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    command = ["timeout", "-k", "5", "120", "mpirun", "-n", "2", sys.executable, "-c", ON_ONE]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("traction: the law returned [nan, nan] at") == 2


def test_mistakes_are_said() -> None:
    """A body that there is not, directions that need a surface: one line with the field."""
    with pytest.raises(InputError, match="directions_on: 'both' given"):
        _python(on="both")
    lines = make_directions("coordinate-lines")
    with pytest.raises(InputError, match="directions: 'coordinate-lines' goes by the coordinates"):
        ContactLaw(NORMAL, PythonLaw(RADIAL, directions=lines)).check_meshed()


@pytest.mark.parametrize("kind", ["meshed", "plane"])
def test_singular_directions_are_said(kind: str) -> None:
    """Directions along the normal, where points can touch at once: one line, on both masters."""
    upright = make_directions("constant", vector=(0, 0, 1))
    model = _blocks()
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    law = ContactLaw(NORMAL, PythonLaw(RADIAL, directions=upright))
    own = Interface(plane, law)
    with pytest.raises(InputError, match="directions: no direction at 16 slave points"):
        if kind == "meshed":
            Contact(model, "block.bottom", "base.top", law=law, mortar=False)
        else:
            Contact(model, "block.bottom", own, mortar=False)


def test_self_contact() -> None:
    """A hairpin that closes, its sides held apart by the same law in Python and in the core."""
    along = ContactLaw(
        NormalLaw(penalty=2e4),
        Adhesion(stiffness=(1e4, 1e4)),
        Friction(coefficients=(0.2, 0.2), sliding_rule="radial"),
    )
    own = ContactLaw(NormalLaw(penalty=2e4), PythonLaw(RadialReturn((1e4, 1e4), (0.2, 0.2))))
    depth = 0.5 * GAP + 2e-3
    ends = {
        "pin.upper": {"x": 0.02, "y": 0.0, "z": -depth},
        "pin.lower": {"x": 0.0, "y": 0.0, "z": depth},
    }
    found = []
    for law in (along, own):
        model = hairpin(half=False)
        contact = Contact(model, "pin.inner", "pin.inner", self_contact=True, law=law, apart=0.3)
        problem = Problem(model, {"pin": make_material("neo-hookean", E=1000.0, nu=0.3)}, [contact])
        for _ in Solver(problem, [Step("close", 2, ends)], options={"snes_rtol": 1e-11}).run():
            pass
        assert contact.counts()["stick"] + contact.counts()["slip"] > 0
        found.append(problem.u.x.array.copy())
    assert np.abs(found[1] - found[0]).max() < 1e-9 * np.abs(found[0]).max()
