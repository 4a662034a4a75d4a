"""Families of curved pairs, whole and halves: members at random, not cases that were chosen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

CASE = """
{upper}
{lower}
[group."up.lid"]
by = "normal"
direction = [0, 0, 1]
angle_deg = 40

[material.up]
model = "{model}"
E = {young}
nu = {nu}

[material.low]
model = "{model}"
E = 100
nu = 0.3

[[contact]]
slave = "{slave}"
master = "{master}"
pass = "mortar"
friction.coefficients = [{mu}, {across}]
friction.directions = {{ kind = "constant", vector = [0, 1, 0], angle_deg = {angle} }}

[[step]]
name = "press"
increments = 2
[step.displacement]
"up.lid" = {{ {fixed}y = 0, z = {down} }}
{supports}

[[step]]
name = "drag"
increments = 4
[step.displacement]
"up.lid" = {{ {aside}y = {along}, z = {down} }}
{supports}
"""
#: Unknowns that no member has.
MOST = 12500


@dataclass(frozen=True)
class Shape:
    """A body of a member.

    Attributes:
        table: Its table of the case file.
        meets: The face that meets the other body.
        holds: The face that is held, of the lower one.
        plane: The face in the plane of symmetry, of a half.
        bend: Radius of the face that meets, or 0.
    """

    table: str
    meets: str
    holds: str
    plane: str
    bend: float = 0.0


def _dome(name: str, radius: float, rim: float, deep: float, cells: int, half: bool) -> Shape:
    sagitta = radius - np.sqrt(radius**2 - rim**2)
    layers = f"cells = [{8 * max(1, cells // 2)}, {max(1, cells // 2)}, 2]"
    # the lower one looks upwards; of a half the turn keeps the side x >= 0
    turned = "rotate = { axis = [1, 0, 0], angle_deg = 180 }" if name == "low" else ""
    part = 'part = "half"' if half else ""
    table = f"[mesh.dome.{name}]\nradius = {radius}\nrim = {rim}\nheight = {deep + sagitta}\n"
    return Shape(f"{table}{layers}\n{turned}\n{part}", "bottom", "top", "left", radius)


def _roll(rng: np.random.Generator, cells: int, half: bool) -> Shape:
    radius, part = rng.uniform(0.4, 0.9), 'part = "half"' if half else ""
    table = f"[mesh.cylinder.up]\nradius = {radius}\nlength = 1.0\n{part}\n"
    layers = f"cells = [{8 * cells}, {cells}, {cells}]"
    place = f"rotate = {{ axis = [1, 0, 0], angle_deg = 90 }}\nmove = [0, 0.5, {radius}]"
    return Shape(f"{table}{layers}\n{place}", "outer", "", "left", radius)


def _box(name: str, wide: float, deep: float, cells: int, half: bool) -> Shape:
    x, z = (0.0 if half else -wide), (-deep if name == "low" else 0.0)
    size = [wide if half else 2.0 * wide, 2.0 * wide, deep]
    layers = [cells if half else 2 * cells, 2 * cells, 2]
    table = f"[mesh.box.{name}]\norigin = [{x}, {-wide}, {z}]\nsize = {size}\ncells = {layers}"
    return Shape(table, *("top", "bottom") if name == "low" else ("bottom", "top"), "left")


def _groove(rng: np.random.Generator, roll: float, cells: int, half: bool) -> Shape:
    """A groove for a roll, of a little larger a radius."""
    inner = roll * rng.uniform(1.1, 1.6)
    table = f"[mesh.ring.low]\ninner = {inner}\nouter = {inner + 0.6}\nlength = 2.0\n"
    sector = f"start_deg = {-90 if half else -150}\nend_deg = -30\n"
    layers = f"cells = [2, {cells if half else 2 * cells}, {2 * cells}]\n"
    place = f"rotate = {{ axis = [1, 0, 0], angle_deg = 90 }}\nmove = [0, 1.0, {inner}]"
    return Shape(f"{table}{sector}{layers}{place}", "inner", "outer", "start", inner)


def member(seed: int) -> str:
    """Case file of a member.

    Both shapes, their radii, cells, order, stiffness, friction with its direction, which of both is
    the slave and the way are random. A half is cut along the way.
    """
    rng = np.random.default_rng(seed)
    half, order = bool(rng.random() < 0.5), 2 if rng.random() < 0.3 else 1
    cell = rng.choice(["hexahedron", "tetrahedron"])
    n, m = (rng.integers(2, 4, size=2) if order == 2 else rng.integers((2, 3), (5, 6))).tolist()
    kind = rng.choice(["dome", "roll", "box"], p=[0.5, 0.35, 0.15])
    if kind == "dome":
        upper = _dome("up", rng.uniform(0.8, 5.0), 0.6, 0.5, n, half)
    else:
        upper = _roll(rng, n, half) if kind == "roll" else _box("up", 0.5, 0.5, n, half)
    below = rng.choice(["box", "dome", "groove"] if kind == "roll" else ["box", "dome"])
    if below == "groove":
        lower = _groove(rng, upper.bend, m, half)
    elif below == "dome":
        lower = _dome("low", rng.uniform(1.5, 5.0), 1.0, 0.6, m, half)
    else:
        lower = _box("low", 1.0, 0.6, m, half)
    sides = [f"up.{upper.meets}", f"low.{lower.meets}"]
    slave, master = sides[:: int(rng.choice([1, -1]))]
    way = rng.uniform(0.02, 0.15) * np.array([1.0, 0.0])
    turn = 0.0 if half else rng.uniform(0.0, 2.0 * np.pi)
    along, aside = way[0] * np.cos(turn), way[0] * np.sin(turn)
    mu = rng.uniform(0.05, 0.9)
    fixed = "" if half else "x = 0, "
    supports = f'"low.{lower.holds}" = {{ {fixed}y = 0, z = 0 }}'
    if half:
        supports += f'\n"up.{upper.plane}" = {{ x = 0 }}\n"low.{lower.plane}" = {{ x = 0 }}'
    common = f'\norder = {order}\ncell = "{cell}"'
    return CASE.format(
        upper=upper.table + common,
        lower=lower.table + common,
        model=rng.choice(["linear-elastic", "neo-hookean"]),
        young=100.0 * 10.0 ** rng.uniform(-1.5, 1.5),
        nu=rng.choice([0.0, 0.3, 0.45]),
        slave=slave,
        master=master,
        mu=mu,
        across=mu * rng.uniform(0.3, 1.0),
        angle=rng.choice([0.0, rng.uniform(0.0, 90.0)]),
        down=-rng.uniform(0.01, 0.05),
        along=along,
        aside="" if half else f"x = {aside}, ",
        fixed=fixed,
        supports=supports,
    )


#: Member whose domes touch in a point at the start.
POLES_TOUCH = 3


def _members(fast: tuple[int, ...], count: int) -> list:
    """Numbers of members, of which some are run by default."""
    slow = [pytest.param(i, marks=pytest.mark.slow) for i in range(count) if i not in fast]
    return [*fast, *slow]


@pytest.mark.parametrize("seed", _members((0, 1, 2, 3, 6, 13, 40), 100))
def test_curved_pairs(to_the_end, seed):
    """A dome, a roll or a block on a block, a dome or in a groove, pressed and dragged.

    Requirement: no cut; at most twenty iterations in an increment, which is one attempt and a way
    with smaller penalties. 97 of the hundred take twelve at most. Nodes in planes of symmetry,
    whose multipliers did not follow in Newton's step, took 90 iterations; a roll whose ends lie on
    edges of the block, and are hollow there, stopped; one of order 2 whose end is within facets,
    where vertices were held against what is a facet off, took 22 to 30; nodes in the plane of
    symmetry that had slid on the way, and got back what the support had carried of them before,
    were to slide again, 62.
    """
    run = to_the_end(member(seed), most=MOST)
    assert not run.cuts
    assert max(one.iterations for one in run.accepted) <= 20


@pytest.mark.parametrize("apart", [0.0, 1e-12, 1e-10, -1e-12])
def test_poles_that_touch(to_the_end, apart):
    """Two domes of order 2 whose poles just touch, a little apart or in one another.

    Requirement: six corrections in the increment in which they begin to touch, whatever rounding
    makes of their distance: it takes five. A pole that is pressed though its gap has not closed in
    the trial says nothing of the way along which it rubs; divided by that way, 1e-9 of the gap, it
    was to slip by 1e12 times the size of the domes, and corrections were 12 to 40, by rounding.
    """
    text = member(POLES_TOUCH)
    table = "[mesh.dome.low]"
    assert table in text
    run = to_the_end(text.replace(table, f"{table}\nmove = [0, 0, {-apart}]"), most=MOST)
    assert not run.cuts
    assert run.accepted[0].iterations <= 6
