"""Contact on the displacement of a mixed problem: other fields do what they are for, no more.

Requirement: a residual in a mixed space (pressure, temperature, damage) takes contact on its
displacement as one in displacements alone does, with all ways to the contact forces.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.conftest import difference_errors
from tests.verification import mixed_problems as mixed
from tests.verification.mixed_problems import PRESS_AND_DRAG, WAYS, Held, on_base, on_plate, pad

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI, basix, fem, ufl
from anisocontact.base.limits import Limits
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, PlaneStrain, build_box
from anisocontact.solver import ContactProblem, Problem, Solver, Step
from anisocontact.surfaces import make_surface

import dolfinx.mesh

ROOT = Path(__file__).parents[2]


def off(one: np.ndarray, other: np.ndarray) -> float:
    """Largest difference over the largest value."""
    return float(np.abs(one - other).max() / np.abs(other).max())


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("met", ["plate", "base"])
def test_pressures_of_cells_are_those_of_the_displacement(way: str, met: str) -> None:
    """Linear tetrahedra with a pressure in each cell, `p = K (J - 1)`, give the forces of the
    displacement alone.

    Source: J is constant in such a cell, so that both are one equation after the elimination of p.
    Tolerance 1e-7: residuals are solved to 1e-8 of the forces (measured 3e-9, by penalties 1e-12).
    A pair with multipliers starts by penalties: from a displacement without a pressure its first
    increment does not converge.
    """
    forces = []
    for pressure in ("cells", "none"):
        if met == "plate":
            g = pad(3, pressure, 1, "tetrahedron")
            contact = on_plate(g, **WAYS[way])
        else:
            g = mixed.pair(pressure, 1)
            contact = on_base(g, **(WAYS[way] if way != "multipliers" else {"reach": 0.3}))
        forces.append(Held(g, [contact]).go(PRESS_AND_DRAG))
    assert off(*forces) < 1e-7


def _own_body(n: int) -> np.ndarray:
    """The same pad of our own incompressible rubber, order 2, a linear pressure in each cell."""
    box = BoxSpec((0.0, 0.0, 0.0), (1.0, 1.0, mixed.HEIGHT), (n, n, n // 2), order=2)
    model = build_box({"pad": box})
    rubber = make_material("neo-hookean-incompressible", E=3.0 * mixed.SHEAR, nu=0.5)
    contact = Contact(model, "pad.bottom", mixed.PLATE, mixed.law(), mortar=False)
    ends = (PRESS_AND_DRAG[3], PRESS_AND_DRAG[-1])
    steps = [
        Step(str(i), 2, {"pad.top": dict(zip("xyz", way, strict=True))})
        for i, way in enumerate(ends)
    ]
    forces = []
    for accepted in Solver(Problem(model, {"pad": rubber}, [contact]), steps).run():
        if accepted.increment == 2 and accepted.done == 1.0:
            forces.append(contact.resultant()[0])
    return np.array(forces)


@pytest.mark.slow
@pytest.mark.ci
def test_taylor_hood_is_our_own_incompressible_body() -> None:
    """A pad of Taylor-Hood elements, pressed and dragged, and one with pressures of cells have the
    same forces but for discretisation.

    Source: both are stable elements of the same body, of the same order. Asserted: the difference
    falls to less than half at half the size, below 0.5 %.
    """
    differences = []
    for n in (2, 4):
        g = pad(n, "linear", 2, bulk=np.inf)
        forces = Held(g, [on_plate(g)]).go(PRESS_AND_DRAG[1::2])
        differences.append(off(forces[[1, -1]], _own_body(n)))
    assert differences[1] < 0.5 * differences[0]
    assert differences[1] < 0.005


def test_taylor_hood_tends_to_the_incompressible_form() -> None:
    """Forces with a bulk modulus K go to those of the incompressible form as 1/K.

    Source: perturbed Lagrangian, the energy of a change of volume is `p^2 / 2 K`. Asserted: ten
    times the modulus leaves a tenth, 9 to 11, at 1e3 and 1e4 of the shear modulus.
    """
    forces = []
    for bulk in (1e3 * mixed.SHEAR, 1e4 * mixed.SHEAR, np.inf):
        g = pad(2, "linear", 2, bulk=bulk)
        forces.append(Held(g, [on_plate(g)]).go(PRESS_AND_DRAG[:4]))
    ratio = off(forces[0], forces[2]) / off(forces[1], forces[2])
    assert 9.0 < ratio < 11.0


@pytest.mark.parametrize(
    ("way", "met", "mu", "step"),
    [
        ("penalty", "plate", 0.3, 1e-2),
        ("penalty", "base", 0.3, 1e-3),
        ("penalty", "plate", 30.0, 1e-3),
        ("mortar", "plate", 0.3, 1e-2),
        pytest.param("mortar", "base", 0.3, 1e-2, marks=[pytest.mark.slow, pytest.mark.ci]),
        pytest.param("mortar", "base", 30.0, 1e-3, marks=[pytest.mark.slow, pytest.mark.ci]),
    ],
)
def test_tangent_by_order(way: str, met: str, mu: float, step: float) -> None:
    """Halving the step quarters the error of central differences (asserted 3.5 to 4.5), in
    displacements and pressures at once, with points that slide (mu = 0.3) or stick (mu = 30).

    Source: exact tangents. Below 1e-7 the difference is rounding, and the order cannot be seen.
    With multipliers that follow the tangent is that of a correction, made of the same blocks.
    """
    g = pad(2, "linear", 2) if met == "plate" else mixed.pair("linear", 2)
    contact = (on_plate if met == "plate" else on_base)(g, (mu, 2.0 * mu), **WAYS[way])
    held = Held(g, [contact])
    held.go(PRESS_AND_DRAG)
    problem, rng = held.problem, np.random.default_rng(3)
    x = problem.new_vector()
    size = np.full(x.getLocalSize(), 1e4)  # of pressures, and of displacements
    size[contact.unknowns.own(np.ones((contact.unknowns.node_count, 3))) > 0.0] = 1e-5
    x.array[:] = g.w.x.array + size * rng.normal(size=len(size))
    problem.evaluate(x)
    assert contact.counts()["slip" if mu < 1.0 else "stick"] > 10
    direction = x.duplicate()
    direction.array[:] = size * rng.normal(size=len(size))
    errors = difference_errors(problem, x, direction, (step, step / 2.0))
    assert 3.5 < errors[0] / errors[1] < 4.5 or errors[0] < 1e-7


@pytest.mark.parametrize("way", WAYS)
def test_a_unit_of_the_pressure_changes_nothing(way: str) -> None:
    """Pressures in Pa, or in units of 1e9 Pa: the same iterations with the same residuals.

    Source: rows are weighed as forces. Tolerance 1e-6 of each
    residual above 1e-7 of the largest: rounding.
    """
    histories = []
    for unit in (1.0, 1e9):
        g = pad(2, "linear", 2, unit=unit)
        held = Held(g, [on_plate(g, **WAYS[way])])
        snes = held.problem.newton.snes
        snes.setConvergenceHistory(1000)
        held.go(PRESS_AND_DRAG)
        histories.append(np.array(snes.getConvergenceHistory()[0]))
    assert histories[0].shape == histories[1].shape
    clear = histories[0] > 1e-7 * histories[0].max()
    assert clear.sum() > 20
    assert histories[1][clear] == pytest.approx(histories[0][clear], rel=1e-6)


@pytest.mark.parametrize("way", WAYS)
def test_a_run_that_goes_on_is_the_same_to_the_last_bit(way: str, tmp_path: Path) -> None:
    """What `save` wrote after five steps is restored by another problem, which goes on alike.

    Source: requirement on checkpoints; all fields and the history of the contact. No tolerance.
    """
    ends = []
    for go_on in (False, True):
        g = pad(2, "linear", 2)
        held = Held(g, [on_plate(g, **WAYS[way])])
        if go_on:
            held.problem.restore(tmp_path / "state.npz")
        else:
            held.go(PRESS_AND_DRAG[:5])
            held.problem.save(tmp_path / "state.npz")
        held.go(PRESS_AND_DRAG[5:])
        ends.append(g.w.x.array.copy())
    assert np.array_equal(*ends)


def test_increments_that_fail_are_cut_and_leave_all_fields(no_detours: None) -> None:
    """With at most five iterations a drag of one increment, which takes six, is cut where no
    detour leads there; a solution that fails leaves displacement and pressure as they
    were, to the last bit.

    Source: requirement on cuts. The pad is pressed before: where it just touches rounding says how
    many iterations the smallest part takes.
    """
    g = pad(2, "linear", 2)
    held = Held(g, [on_plate(g)])
    start, end = np.array(PRESS_AND_DRAG[3]), np.array(PRESS_AND_DRAG[-1])
    held.lead(start)
    held.problem.solve()
    held.problem.newton.snes.setTolerances(max_it=5)
    held.lead(end)
    before = g.w.x.array.copy()
    with pytest.raises(RuntimeError, match="no convergence in 5 Newton iterations"):
        held.problem.solve()
    assert np.array_equal(g.w.x.array, before)
    shares: list[float] = []
    held.problem.solve_steps(
        lambda share: held.lead(start + share * (end - start)),
        callback=lambda share, _: shares.append(share),
    )
    assert len(shares) > 1
    assert shares[-1] == 1.0


@pytest.mark.parametrize("pressure", [False, True])
def test_two_components_in_the_plane(pressure: bool) -> None:
    """Plane strain with two components gives the forces of three whose third is held.

    Source: the one across the plane is zero in both. Tolerance 1e-8: what Newton leaves.
    """
    forces = [_in_the_plane(components, pressure) for components in (2, 3)]
    assert off(*forces) < 1e-8


def _in_the_plane(components: int, pressure: bool) -> np.ndarray:
    kind = dolfinx.mesh.CellType.quadrilateral
    mesh = dolfinx.mesh.create_rectangle(MPI.COMM_WORLD, [[0, 0], [1, 0.5]], [6, 3], kind)
    cell = mesh.basix_cell()
    vector = basix.ufl.element("P", cell, 2, shape=(components,))
    scalar = basix.ufl.element("P", cell, 1)
    element = basix.ufl.mixed_element([vector, scalar]) if pressure else vector
    space = fem.functionspace(mesh, element)
    displacement = space.sub(0) if pressure else space
    free = displacement.collapse()[0] if pressure else space
    w = fem.Function(space)
    u, p = ufl.split(w) if pressure else (w, None)
    h = ufl.grad(u)
    across = [h[2, 0], h[2, 1]] if components == 3 else [0.0, 0.0]
    f = ufl.as_matrix(
        [[1.0 + h[0, 0], h[0, 1], 0.0], [h[1, 0], 1.0 + h[1, 1], 0.0], [*across, 1.0]]
    )
    j = ufl.det(f)
    density = 0.5 * (j ** (-2.0 / 3.0) * ufl.tr(f.T * f) - 3.0)
    density += 1.5 * (j - 1.0) ** 2 if p is None else p * (j - 1.0)
    form = ufl.derivative(density * ufl.dx(metadata={"quadrature_degree": 4}), w)
    facets = [
        dolfinx.mesh.locate_entities_boundary(mesh, 1, lambda x, y=y: np.isclose(x[1], y))
        for y in (0.0, 0.5)
    ]
    moved = fem.Function(free)
    places = (displacement, free) if pressure else space
    dofs = fem.locate_dofs_topological(places, 1, facets[1])
    bcs = [fem.dirichletbc(moved, dofs, *([displacement] if pressure else []))]
    plate = make_surface("plane", point=(0.0, 0.0, 0.0), normal=(0.0, 1.0, 0.0))
    law = ContactLaw(NormalLaw(penalty=1e3), Adhesion(stiffness=2e2), Friction(coefficients=0.3))
    model = Model.of(displacement, {"pad.bottom": facets[0]}, PlaneStrain())
    contact = Contact(model, "pad.bottom", plate, law, **WAYS["multipliers"])
    problem = ContactProblem(form, w, bcs=bcs, contacts=[contact])
    forces = []
    for way in [(0.0, -0.01), (0.0, -0.02), (0.02, -0.02), (0.06, -0.02)]:
        moved.x.array.reshape(-1, components)[:, :2] = way
        problem.solve()
        forces.append(contact.resultant()[0])
    return np.array(forces)


@pytest.mark.slow
@pytest.mark.ci
def test_several_processes(tmp_path: Path) -> None:
    """Two processes give the forces of one, for every way to them.

    Source: requirement. Tolerance 1e-8: what Newton leaves (measured 3e-11).
    """
    found = []
    for ranks in (1, 2):
        file = tmp_path / f"{ranks}.npz"
        command = ["mpirun", "-n", str(ranks), sys.executable, "-m"]
        command = [*command, "tests.verification.mixed_problems", str(file)]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        with np.load(file) as read:
            found.append(dict(read))
    for name, forces in found[0].items():
        assert off(found[1][name], forces) < 1e-8


def test_a_part_that_nothing_holds_is_one_line() -> None:
    """A pad of Taylor-Hood elements above its plate without conditions: its six motions."""
    g = pad(2, "linear", 2)
    above = make_surface("plane", point=(0.0, 0.0, -0.1), normal=(0.0, 0.0, 1.0))
    contact = Contact(g.model, "pad.bottom", above, mixed.law(), mortar=False)
    problem = ContactProblem(g.form, g.w, contacts=[contact])
    with pytest.raises(InputError, match=r"nothing holds the body around .*translation along x, y"):
        problem.solve()


def test_limits_of_cuts_hold_for_mixed_problems() -> None:
    """The smallest part that fails is named, and conditions go back with it."""
    g = pad(2, "linear", 2)
    held = Held(g, [on_plate(g)], snes_max_it=1)
    led: list[float] = []
    with pytest.raises(RuntimeError, match="no convergence"):
        held.problem.solve_steps(
            lambda s: led.append(s) or held.lead((0.0, 0.0, -0.01 * s)), limits=Limits(cuts=2)
        )
    assert led[-1] == 0.0
