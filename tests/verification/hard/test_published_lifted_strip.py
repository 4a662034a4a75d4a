"""A heavy strip on a floor is lifted at its end: the edge of its contact runs along it.

An elastica that is hardly inclined, free of its floor over the length l: no moment where it leaves
the floor and none at the end that is lifted by d, so that half of the weight of that length is
carried by the end [S. P. Timoshenko, Strength of Materials II, beams on a rigid foundation],

    d = w l^4 / (24 E I) ,  F = w l / 2 .

At the place where it leaves the floor a force w l / 2 acts as well, so that the strip is pressed
down by a single point there and stands clear of the floor beside it: points open one after the
other as Newton's method corrects, whatever the increment.

Bilinear cells of the length a lock in bending by their shear, G h a^2 / 12 is added to E I without
Poisson's ratio: with cells as long as the strip is high it is half as stiff again.

Requirement: the force, without a cut, with friction and without. Tolerances: the force to 1e-3, as
the free length is known to a cell in eighty; corrections as counted, and a tenth.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.verification.hard.case_texts import on_a_floor

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import load
from anisocontact.case.build import build

LENGTH, HEIGHT, YOUNG, WEIGHT, LIFT = 40.0, 0.5, 1e4, 1e-3, 0.0625
CASE = f"""
{on_a_floor("strip", (LENGTH, HEIGHT), (80, 4), YOUNG)}
METHOD
friction = {{ coefficients = [FRICTION, FRICTION] }}
[[step]]
name = "weight"
increments = 1
body_force = {{ strip = {{ y = -{WEIGHT} }} }}
displacement = {{ "strip.left" = {{ x = 0 }} }}
[[step]]
name = "lift"
increments = 1
displacement = {{ "strip.right" = {{ y = {LIFT} }} }}
[solver]
strategy = "direct"
options = {{ snes_rtol = 1e-10 }}
"""


MULTIPLIERS = 'method = "augmented"'
POINTS = 'method = "penalty"\npass = "single"'
PENALTIES = 'method = "penalty"\npass = "mortar"'


@pytest.mark.parametrize(
    ("method", "friction", "most"),
    [
        (MULTIPLIERS, 0.0, 70),
        (MULTIPLIERS, 0.3, 120),
        (PENALTIES, 0.0, 66),
        (PENALTIES, 0.3, 142),
        (POINTS, 0.3, 95),
    ],
    ids=["multipliers", "multipliers-friction", "nodes", "nodes-friction", "points-friction"],
)
def test_force_that_lifts(method: str, friction: float, most: int, tmp_path: Path) -> None:
    """One increment, which opens fifty cells at once; with penalties residuals rise and fall."""
    case = CASE.replace("METHOD", method).replace("FRICTION", str(friction))
    (tmp_path / "case.toml").write_text(case)
    built = build(load(tmp_path / "case.toml"))
    cuts: list[Any] = []
    *_, lifted = built.solver.run(on_cut=cuts.append, on_warning=lambda _: None)
    assert not cuts
    weight, bending = WEIGHT * HEIGHT, YOUNG * HEIGHT**3 / 12.0
    locked = bending + 0.5 * YOUNG * HEIGHT * (LENGTH / 80.0) ** 2 / 12.0
    free = (24.0 * locked * LIFT / weight) ** 0.25
    assert lifted.reactions["strip.right"][1] == pytest.approx(0.5 * weight * free, rel=1e-3)
    assert lifted.iterations <= most


BASE = """
[mesh.rectangle.base]
origin = [-2, -2]
size = [44, 2]
cells = [50, 3]
[material.base]
model = "linear-elastic"
E = 1e4
nu = 0
"""


@pytest.mark.parametrize("base", [False, True], ids=["floor", "block"])
def test_a_heavier_strip_lies_on_points(base: bool, tmp_path: Path) -> None:
    """Thirty times the weight, lifted farther, coarser cells, points on a floor and on a block.

    Requirement: one increment without a cut, in 80 corrections, 71 and 74 as counted and a tenth,
    and the force to 2 %. Source: as above; the free length is known to a cell in 26, and the block
    is as soft as the strip. Points that slip with the first soft penalties went on slipping to and
    fro: a thousand corrections and three or four cuts.
    """
    weight, lift, cells = 0.03, 0.3, 60
    case = CASE.replace("METHOD", POINTS).replace("FRICTION", "0.3")
    case = case.replace("cells = [80, 4]", f"cells = [{cells}, 2]")
    case = case.replace("nu = 0.0\n", "nu = 0.3\n")
    case = case.replace(f"y = -{WEIGHT}", f"y = -{weight}").replace(f"y = {LIFT}", f"y = {lift}")
    if base:
        case = case.replace('master = "floor"', 'master = "base.top"')
        case = case.replace("[[contact]]", f"{BASE}[[contact]]").replace(
            '{ "strip.left" = { x = 0 } }',
            '{ "strip.left" = { x = 0 }, "base.bottom" = { x = 0, y = 0 } }',
        )
    (tmp_path / "case.toml").write_text(case)
    built = build(load(tmp_path / "case.toml"))
    cuts: list[Any] = []
    *_, lifted = built.solver.run(on_cut=cuts.append, on_warning=lambda _: None)
    assert not cuts
    assert lifted.iterations <= 80
    bending = YOUNG * HEIGHT**3 / 12.0 / (1.0 - 0.3**2)
    locked = bending + YOUNG / 2.6 * HEIGHT * (LENGTH / cells) ** 2 / 12.0
    free = (24.0 * locked * lift / (weight * HEIGHT)) ** 0.25
    force = 0.5 * weight * HEIGHT * free
    assert lifted.reactions["strip.right"][1] == pytest.approx(force, rel=0.02)


def test_a_script_lifts_it() -> None:
    """A form of the user's, with friction, in space: no way but by soft penalties ends."""
    from anisocontact import Adhesion, Friction, Interface, NormalLaw, make_surface
    from anisocontact.base.fenicsx import fem, ufl
    from anisocontact.contact import Contact
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.solver import ContactProblem

    length, lift = 20.0, 0.01
    model = build_box({"strip": BoxSpec((0, 0, 0), (length, 1, HEIGHT), (40, 1, 1))})
    u, v = fem.Function(model.space), ufl.TestFunction(model.space)
    strain = ufl.inner(ufl.sym(ufl.grad(u)), ufl.grad(v))
    form = (YOUNG * strain + WEIGHT * v[2]) * ufl.dx
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    law = Adhesion(stiffness=(2e5, 2e5)), Friction(coefficients=(0.3, 0.3))
    contact = Contact(model, "strip.bottom", Interface(plane, NormalLaw(penalty=2e5), *law))

    def held(nodes: np.ndarray, axis: int, value: float) -> Any:
        component = model.space.sub(axis)
        return fem.dirichletbc(value, (3 * nodes + axis).astype(np.int32), component)

    every = np.arange(len(u.x.array) // 3)
    bcs = [held(every, 1, 0.0), held(model.nodes("strip.left"), 0, 0.0)]
    problem = ContactProblem(form, u, bcs=bcs, contacts=[contact])
    problem.solve()
    problem.bcs.append(held(model.nodes("strip.right"), 2, lift))
    problem.solve()
    weight, bending = WEIGHT * HEIGHT, YOUNG * HEIGHT**3 / 12.0
    locked = bending + 0.5 * YOUNG * HEIGHT * (length / 40.0) ** 2 / 12.0
    free = (24.0 * locked * lift / weight) ** 0.25
    force = contact.resultant()[0][2]
    assert force == pytest.approx(weight * (length - 0.5 * free), rel=1e-3)
