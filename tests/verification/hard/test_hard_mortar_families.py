"""Families of mortar contacts with multipliers: members at random, not cases that were chosen."""

from __future__ import annotations

import numpy as np
import pytest

PAIR = """
[mesh.box.block]
origin = [{x}, {y}, 0]
size = [1, 1, 0.6]
cells = [{n}, {n}, 2]
cell = "{cell}"
order = {order}
rotate = {{ axis = [0, 1, 0], angle_deg = {tilt} }}

[mesh.box.base]
origin = [-1, -1, -0.8]
size = [3, 3, 0.8]
cells = [{m}, {m}, 2]
cell = "{cell}"
order = {order}
rotate = {{ axis = [0, 1, 0], angle_deg = {tilt} }}

[material.block]
model = "{model}"
E = {young}
nu = {nu}

[material.base]
model = "{model}"
E = 1000
nu = 0.3

[[contact]]
slave = "{slave}"
master = "{master}"
pass = "mortar"
method = "{method}"
friction.coefficients = [{mu}, {across}]
friction.directions = {{ kind = "constant", vector = [1, 0, 0], angle_deg = 20 }}

[[step]]
name = "press"
increments = {increments}
{press}

[[step]]
name = "drag"
increments = 3
{drag}
"""
#: Unknowns that no member has.
MOST = 5000
#: What a block that is led, or pressed by a traction, is given in both steps.
LED = """[step.displacement]
"base.bottom" = {{ x = 0, y = 0, z = 0 }}
"block.top" = {{ {led} }}"""
LOADED = """[step.pressure]
"block.top" = {pressure}
[step.displacement]
"base.bottom" = {{ x = 0, y = 0, z = 0 }}"""


def member(seed: int, method: str = "augmented", model: str = "linear-elastic") -> str:
    """Case file of a member.

    Facets, their ratio and offset, cells, order, stiffness, friction, tilt and load are random; the
    softer body is the slave.
    """
    rng = np.random.default_rng(seed)
    order, n = (2, 2) if rng.random() < 0.25 else (1, int(rng.integers(2, 6)))
    young = 1000.0 * 10.0 ** rng.uniform(-3.0, 3.0)
    tilt = float(rng.choice([0.0, rng.uniform(5.0, 40.0)]))
    softer = min(young, 1000.0)
    c, s = np.cos(np.radians(tilt)), np.sin(np.radians(tilt))
    deep, far = rng.uniform(0.003, 0.02), rng.uniform(0.01, 0.08)
    mu = rng.uniform(0.1, 0.9)
    across = mu * rng.uniform(0.4, 1.0)
    sides = ("block.bottom", "base.top")
    if young > 1000.0:
        sides = sides[::-1]
    if rng.random() < 0.3:
        load = LOADED.format(pressure=deep * softer)
        press, drag = load, load.replace(str(deep * softer), str(2.0 * deep * softer))
    else:
        towards = -deep * np.array([s, 0, c])
        ways = (towards, towards + far * np.array([c, 0.5, -s]))
        press, drag = (LED.format(led="x = {}, y = {}, z = {}".format(*way)) for way in ways)
    text = PAIR.format(
        order=order,
        n=n,
        m=int(rng.integers(3, 8)),
        cell=str(rng.choice(["hexahedron", "tetrahedron"], p=[0.7, 0.3])),
        tilt=tilt,
        x=rng.uniform(-0.4, 0.4),
        y=rng.uniform(-0.4, 0.4),
        model=model,
        young=young,
        nu=rng.uniform(0.0, 0.45),
        slave=sides[0],
        master=sides[1],
        mu=mu,
        across=across,
        method=method,
        increments=int(rng.integers(1, 3)),
        press=press,
        drag=drag,
    )
    return text


def _asked(run) -> None:
    """What every member has to have: multipliers that hold, and friction within its cone."""
    contact = run.problem.contacts[0]
    last, size = contact.last, contact.slave_points.size
    covered = contact.slave_points.covered(contact.areas)
    touches = last.status != 0
    assert touches.any()
    assert np.abs(covered * contact.state["gap"])[touches].max() < 1e-6 * size
    # the texture shears with its body: what counts are the axes of now, not the larger coefficient
    coefficients = contact.interface.tangential.friction.named[1]["coefficients"]
    yields = np.linalg.norm(last.traction_principal / np.array(coefficients), axis=1)
    assert (yields <= (1.0 + 1e-12) * last.pressure + 1e-12 * last.pressure.max()).all()


def _members(fast: int, count: int) -> list:
    """Numbers of members, of which the first ones are run by default."""
    slow = [pytest.param(i, marks=pytest.mark.slow) for i in range(fast, count)]
    return [*range(fast), *slow]


@pytest.mark.parametrize("seed", _members(3, 200))
def test_pairs(to_the_end, seed):
    """Block on base, stiffness ratio 1e-3 to 1e3, meshes that do not match: none fails.

    Requirement: multipliers at slave nodes are as safe as penalties. At most one cut, as one member
    has in whose contact three nodes are covered to some 1e-4; penetration weighted with what is
    covered below 1e-6 of a facet, the default tolerance; friction within its ellipse to rounding.
    """
    text = member(seed)
    run = to_the_end(text, most=MOST)
    assert not run.cuts
    _asked(run)


@pytest.mark.parametrize("seed", [5, 16, 198])
def test_blocks_that_lie_there(to_the_end, seed):
    """A block that nothing but its contact holds, pressed by a traction: its first equilibrium.

    Requirement: the gaps of nodes that touch at the start, some 1e-16 of either sign, do not say
    which of them are held: 8 iterations, as increments of a block that is led take; a block that
    begins on one or two of its nodes falls over on the way, and takes 13 to 21.
    """
    run = to_the_end(member(seed))
    assert run.accepted[0].iterations <= 8


@pytest.mark.parametrize("gap", [-1e-9, 1e-9, 1e-7])
def test_gaps_within_the_tolerance(to_the_end, gap):
    """The same block a little above or within its base: its springs are no stiffer.

    Requirement: what multipliers hold from the start counts as touched, whichever the sign of its
    gap. It takes 8 iterations of the first increment, and at most 2 of the second, which goes on in
    proportion; 11 and 4 where the block counts as one that has yet to fall onto its base.
    """
    text, flat = member(198), "0]\nsize = [1, 1, 0.6]"
    assert flat in text
    run = to_the_end(text.replace(flat, flat.replace("0]", f"{gap}]", 1)))
    first, second, *_ = run.accepted
    assert first.iterations <= 8
    assert second.iterations <= 2


@pytest.mark.parametrize("seed", [68, 135])
def test_nodes_of_slivers(to_the_end, seed):
    """A corner that digs in comes over a millionth of a node whose gap, extrapolated, is -0.02.

    Requirement: no cut, at most 13 iterations an increment, and the tolerance of the penetration. A
    multiplier that closes the gap pushes the sliver away, and without it the gap is open again: 160
    to 200 iterations and a cut.
    """
    text = member(seed)
    run = to_the_end(text)
    assert not run.cuts
    assert max(accepted.iterations for accepted in run.accepted) <= 13
    _asked(run)


def test_springs_follow_where_contact_alone_does_not_hold(to_the_end):
    """A block of which next to all nodes slip in equilibrium: what follows has springs.

    Requirement: no second attempt without them, 7 iterations of 19.
    """
    run = to_the_end(member(59))
    assert run.accepted[0].iterations <= 12


@pytest.mark.parametrize("strategy", ["condensed", "iterative"])
@pytest.mark.parametrize("seed", _members(1, 11))
def test_strategies(to_the_end, seed, strategy):
    """The same members by the other strategies: forces of `direct`, to 1e-5 as of the multipliers.

    Both leave violations of 1e-6 of a facet, which are forces of 1e-6 E h; bodies are pressed in
    by some hundredths of a facet and more.
    """
    text = member(seed)
    run, direct = to_the_end(text, f'strategy = "{strategy}"'), to_the_end(text)
    assert run.strategy == strategy
    assert not run.cuts
    _asked(run)
    ours, theirs = (one.force("drag") for one in (run, direct))
    assert np.linalg.norm(ours - theirs) < 1e-5 * np.linalg.norm(theirs)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_finite_strain(to_the_end, seed):
    """The first members with bodies at finite strain."""
    text = member(seed, model="neo-hookean")
    run = to_the_end(text)
    assert not run.cuts
    _asked(run)
