"""Contact of meshed bodies: tangent of the assembled system, patch test, invariance, another code.

Requirement and source stand with each test.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
import pytest
from tests.conftest import difference_errors

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.solver import Problem, Solver, Step

#: At slave nodes.
POINTS, MORTAR = (partial(Contact, mortar=nodes) for nodes in (False, True))


CLAMP = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}


def _law(mu: float = 0.3, stiffness: float = 1e5, ratio: float = 1.0) -> ContactLaw:
    marks = make_directions("constant", vector=(1, 0, 0), angle=np.pi / 6)
    return ContactLaw(
        NormalLaw(penalty=1e5),
        Adhesion(stiffness=(stiffness, ratio * stiffness), directions=marks),
        Friction(coefficients=(mu, ratio * mu), directions=marks),
    )


def _blocks(
    n: int, cell: str = "hexahedron", order: int = 1, base: tuple[int, int, int] | None = None
) -> Model:
    """A block 1 x 1 x 0.5 on a base 2 x 2 x 0.5 whose mesh does not match."""
    m = 3 * n // 2
    return build_box(
        {
            "block": BoxSpec((0, 0, 0), (1, 1, 0.5), (n, n, n // 2), cell=cell, order=order),
            "base": BoxSpec(
                (-0.5, -0.5, -0.5),
                (2, 2, 0.5),
                base or (m, m, max(1, m // 4)),
                cell=cell,
                order=order,
            ),
        }
    )


def _problem(
    model: Model, law: ContactLaw, material: str, kind: Any = POINTS, **options: object
) -> Problem:
    elastic = make_material(material, E=1000.0, nu=0.3)
    options.setdefault("current_area", material != "linear-elastic")
    contact = kind(model, "block.bottom", "base.top", law=law, **options)
    return Problem(model, {"block": elastic, "base": elastic}, [contact])


def _run(problem: Problem, steps: Sequence[Step], rtol: float = 1e-8) -> list[np.ndarray]:
    """Contact force on the slave after every increment."""
    solver = Solver(problem, steps, options={"snes_rtol": rtol})
    return [problem.contacts[0].resultant()[0] for _ in solver.run()]


def _press_and_drag(increments: tuple[int, int] = (5, 10)) -> list[Step]:
    press = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}
    drag = {"block.top": {"x": 0.02, "y": 0.0, "z": -0.01}}
    return [
        Step(name="press", increments=increments[0], displacement={**CLAMP, **press}),
        Step(name="drag", increments=increments[1], displacement=drag),
    ]


def test_against_calculix() -> None:
    """Block on block, non-matching: the resultants of CalculiX 2.20 within 1 %.

    Source: CalculiX 2.20 (Debian), surface-to-surface penalty contact of the same meshes and
    stiffnesses, n = 12: normal force after pressing 13.388, tangential force 2.4849 at a drag of
    0.006 and 3.8851 at 0.02. The two codes integrate over the slave differently.
    """
    forces = _run(_problem(_blocks(12), _law(), "linear-elastic"), _press_and_drag())
    assert forces[4][2] == pytest.approx(13.388, rel=0.01)
    assert -forces[7][0] == pytest.approx(2.4849, rel=0.01)
    assert -forces[14][0] == pytest.approx(3.8851, rel=0.01)


@pytest.mark.parametrize(
    ("cell", "order", "material"),
    [
        ("hexahedron", 1, "linear-elastic"),
        ("hexahedron", 1, "neo-hookean"),
        ("hexahedron", 2, "neo-hookean"),
        ("tetrahedron", 1, "neo-hookean"),
        ("tetrahedron", 2, "neo-hookean"),
    ],
)
@pytest.mark.parametrize("mu", [0.3, 30.0])
@pytest.mark.parametrize("kind", [POINTS, MORTAR])
def test_tangent_of_the_system_by_order(
    cell: str, order: int, material: str, mu: float, kind: Any
) -> None:
    """Halving the step quarters the error of central differences (asserted 3.5 to 4.5), with the
    points of the block sliding (mu = 0.3) or sticking (mu = 30), from a random state in contact."""
    n = 4 if kind is MORTAR and order == 1 else 2  # two facets have nine slave nodes
    problem = _problem(_blocks(n, cell, order), _law(mu, ratio=0.5), material, kind)
    step = Step(
        name="press",
        increments=2,
        displacement={**CLAMP, "block.top": {"x": 0.003, "y": 0.002, "z": -0.02}},
    )
    for _ in Solver(problem, [step]).run():
        pass
    rng = np.random.default_rng(2)
    x = problem.accepted()
    x.array[:] += rng.normal(0.0, 2e-4, x.getLocalSize())
    problem.set_load_factor(1.0, 1.0)
    problem.evaluate(x)
    counts = problem.contacts[0].counts()
    assert counts["slip" if mu < 1.0 else "stick"] > 10
    direction = x.duplicate()
    direction.array[:] = rng.normal(size=x.getLocalSize())
    errors = difference_errors(problem, x, direction, (2e-7, 1e-7))
    # below 1e-7 the difference is rounding, and the order cannot be seen
    assert 3.5 < errors[0] / errors[1] < 4.5 or errors[0] < 1e-7


def test_newton_is_quadratic() -> None:
    """The last corrections square the residual, and a drag takes at most 7 a step on average.

    Source: exact tangent. Asserted: below 1e-3 the next residual is below the square times 1e3,
    or below the tolerance.
    """
    problem = _problem(_blocks(8), _law(ratio=0.4), "neo-hookean")
    iterations = []
    for accepted in Solver(problem, _press_and_drag()).run():
        iterations.append(accepted.iterations)
        r = accepted.residuals
        for now, then in itertools.pairwise(r):
            if now < 1e-3:
                assert then < max(1e3 * now**2, 1e-8)
    assert np.mean(iterations[5:]) <= 7.0


def _scattered(model: Model) -> None:
    """Move the nodes of the base at random in its planes, but for those at its border."""
    x = model.mesh.geometry.x
    inner = (x[:, 2] <= 0.0) & np.all(np.abs(x[:, :2] - 0.5) < 0.999, axis=1)
    inner[np.unique(model.mesh.geometry.dofmaps[0][model.cells("block")])] = False
    spacing = 2.0 / np.sqrt(model.count_facets("base.top"))
    x[inner, :2] += np.random.default_rng(5).uniform(-0.3, 0.3, (inner.sum(), 2)) * spacing


FLAT = [
    ("hexahedron", 1, [(1, 1, 1), (2, 2, 1), (32, 32, 1)]),
    ("tetrahedron", 1, [(1, 1, 1), (2, 1, 1), (23, 22, 1)]),
    ("hexahedron", 2, [(1, 1, 1), (9, 7, 1)]),
]


@pytest.mark.filterwarnings("ignore:.*the facets of the slave are")  # on purpose, 8 times as large
@pytest.mark.parametrize(("cell", "order", "bases"), FLAT)
def test_flat_master_of_any_facets(
    cell: str, order: int, bases: list[tuple[int, int, int]]
) -> None:
    """A rigidly held flat master of 1, 4 and 1000 facets at random gives the same force along a
    slide over half of its length: 1e-9 (triangles: 2, 4 and 1012).

    Source: the traction depends on the surface, not on how it is cut into facets; every point of
    the block passes from facet to facet of the fine base. Friction and adhesion have directions.
    """
    held = {f"base.{f}": {"x": 0.0, "y": 0.0, "z": 0.0} for f in ("bottom", "top")}
    down = {"x": 0.0, "y": 0.0, "z": -0.01}
    steps = [
        Step("press", 1, {**held, "block.top": down}),
        Step("slide", 4, {"block.top": {"x": 0.4, "y": 0.1}}),
        Step("turn", 4, {"block.top": {"x": -0.45, "y": -0.3}}),
    ]
    forces = []
    for base in bases:
        model = _blocks(2, cell, order, base=base)
        _scattered(model)
        problem = _problem(model, _law(ratio=0.4), "linear-elastic")
        forces.append(np.array(_run(problem, steps, rtol=1e-12)))
    for other in forces[1:]:
        assert np.abs(other - forces[0]).max() < 1e-9 * np.abs(forces[0]).max()


def test_action_is_reaction() -> None:
    """Supports and contact balance on each body: 1e-8 of the force, the tolerance of Newton."""
    problem = _problem(_blocks(4), _law(ratio=0.4), "neo-hookean")
    for _ in Solver(problem, _press_and_drag((2, 3))).run():
        pass
    force = problem.contacts[0].resultant()[0]
    reactions = problem.reactions()
    scale = np.linalg.norm(force)
    assert np.linalg.norm(force + reactions["block.top"]) < 1e-8 * scale
    assert np.linalg.norm(reactions["block.top"] + reactions["base.bottom"]) < 1e-8 * scale


def test_off_the_end_is_open() -> None:
    """A block slid over the edge of its base loses contact there, without failure, and says so.

    Every point that was pressed is named once, in the increment in which it leaves.
    """
    problem = _problem(_blocks(4), _law(), "linear-elastic")
    steps = [
        Step(
            name="press",
            increments=1,
            displacement={**CLAMP, "block.top": {"x": 0.0, "y": 0.0, "z": -0.005}},
        ),
        Step(
            name="off",
            increments=8,
            displacement={"block.top": {"x": 0.9, "y": 0.0, "z": -0.005}},
        ),
    ]
    contact = problem.contacts[0]
    forces, pressed = [], np.zeros(len(contact.points), dtype=bool)
    for a in Solver(problem, steps, options={"snes_rtol": 1e-8}).run():
        forces.append(a.resultants[contact.name][0])
        left = pressed & (contact.points[:, 0] > 1.5)
        named = a.ran_off.get(contact.name, np.zeros((0, 3)))
        np.testing.assert_array_equal(named, contact.points[left])
        pressed = contact.last.pressure > 0.0
    beyond = contact.points[:, 0] > 1.5
    assert beyond.any()
    assert np.all(contact.last.status[beyond] == 0)
    assert 0.3 * forces[0][2] < forces[-1][2] < 0.8 * forces[0][2]


def test_mistakes_are_said() -> None:
    """Overlapping groups and groups that do not exist: one line with the field."""
    model = _blocks(2)
    with pytest.raises(InputError, match=r"master: .*share 4 facets"):
        Contact(model, "block.bottom", "block.bottom", law=_law(), mortar=False)
    with pytest.raises(InputError, match=r"master: .*did you mean 'base.top'"):
        Contact(model, "block.bottom", "base.topp", law=_law(), mortar=False)
