"""Augmented contacts in cases that contacts with penalties run through."""

from __future__ import annotations

import numpy as np
import pytest

PLATE = """
[mesh.box.plate]
origin = [0, 0, 0]
size = [1, {depth}, 1]
cells = [{n}, 1, {n}]

[material.plate]
model = "linear-elastic"
E = 1000
nu = {nu}

[surface.ground]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "plate.bottom"
master = "ground"
method = "augmented"
friction = {{ coefficients = {mu} }}

[[step]]
name = "load"
increments = 2

[step.pressure]
"plate.top" = 1.0
"plate.left" = {side}

[step.displacement]
"plate.right" = {{ x = 0 }}
"plate.front" = {{ y = 0 }}
"plate.back" = {{ y = 0 }}
"""
PAIR = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [3, 3, 2]
cell = "{cell}"

[material.block]
model = "{model}"
E = {young}
nu = 0.3

[mesh.box.base]
origin = [-1, -1, -1]
size = [3, 3, 1]
cells = [4, 4, 2]
cell = "{cell}"

[material.base]
model = "{model}"
E = 10
nu = 0.3

[[contact]]
slave = "block.bottom"
master = "base.top"
method = "{method}"
friction = {{ coefficients = {mu} }}

[[step]]
name = "press"
increments = 1

[step.displacement]
"base.bottom" = {{ x = 0, y = 0, z = 0 }}
"block.top" = {{ x = 0, y = 0, z = {press} }}
"""
DRAG = """
[[step]]
name = "drag"
increments = 4

[step.displacement]
"block.top" = {{ x = {x} }}
"""


def _augmented(run) -> None:
    """Penetration and elastic slip below 1e-6 of a facet at every point of the first contact."""
    contact = run.problem.contacts[0]
    size = np.sqrt(contact.areas.mean())
    touching = contact.state["status"] != 0
    assert touching.any()
    assert np.abs(contact.state["gap"][touching]).max() < 1e-6 * size
    assert np.abs(contact.elastic_slip()).max() < 5e-6 * size


@pytest.mark.parametrize(
    ("n", "mu", "side", "nu"),
    [(12, 0.6, 2.0, 0.25), (16, 0.6, 2.0, 0.25), (16, 1.0, 4.0, 0.3), (18, 0.5, 4.0, 0.3)],
)
def test_plate_pressed_from_two_sides(to_the_end, n, mu, side, nu):
    """Points of a plate find their status one after the other: full steps get there, no cut.

    Source: the load grows in proportion, so the resultant of the second increment is twice that of
    the first; the ground carries the
    pressure on top in full. Tolerance: that of
    the equilibrium and of the multipliers, 1e-5.
    """
    run = to_the_end(PLATE.format(n=n, depth=1 / n, mu=mu, side=side, nu=nu))
    assert not run.cuts
    first, second = (a.resultants[run.problem.contacts[0].name][0] for a in run.accepted)
    np.testing.assert_allclose(second, 2.0 * first, rtol=1e-5, atol=1e-9)
    assert second[2] == pytest.approx(1.0 / n, rel=1e-6)
    _augmented(run)


def _alternation(values, status) -> float:
    """Amplitude of what alternates from node to node, where five neighbours have one status."""
    fourth = np.abs(np.diff(values, 4)) / 16.0
    same = np.array([np.ptp(status[i : i + 5]) == 0 for i in range(len(fourth))])
    return float(fourth[2:-2][same[2:-2]].max(initial=0.0))


@pytest.mark.parametrize(
    "member", [0, 1, 2, *(pytest.param(i, marks=pytest.mark.slow) for i in range(3, 20))]
)
def test_plates_with_mortar(to_the_end, member):
    """Members of the family at random: no cut, at most 8 iterations an increment on average.

    Pressure and shear are smooth along the plate: what alternates from node to node is less than
    2 % of the pressure on top where five neighbours have one status, off both corners by two nodes.
    Fourth differences of an alternation of amplitude A are 16 A; those of a smooth traction fall
    with the fourth power of the facets, and 1 % was measured beside kinks.
    Source of the rest: see `test_plate_pressed_from_two_sides`.
    """
    rng = np.random.default_rng(member)
    n, mu, side = int(rng.integers(8, 20)), rng.uniform(0.4, 1.0), rng.uniform(1.0, 4.0)
    text = PLATE.format(n=n, depth=1 / n, mu=mu, side=side, nu=0.25)
    text = text.replace('"augmented"', '"augmented"\npass = "mortar"')
    run = to_the_end(text.replace("increments = 2", "increments = 5"))
    assert not run.cuts
    assert sum(a.iterations for a in run.accepted) <= 8 * 5
    contact = run.problem.contacts[0]
    first, *_, last = (a.resultants[contact.name][0] for a in run.accepted)
    np.testing.assert_allclose(last, 5.0 * first, rtol=1e-5, atol=1e-9)
    assert last[2] == pytest.approx(1.0 / n, rel=1e-6)
    _augmented(run)
    line = np.flatnonzero(np.abs(contact.points[:, 1]) < 1e-9)
    line = line[np.argsort(contact.points[line, 0])]
    for values in (contact.last.pressure, contact.last.traction[:, 0]):
        assert _alternation(values[line], contact.last.status[line]) < 0.02


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
def test_points_above_the_rims_of_facets(to_the_end, strategy):
    """Slave points over the sides and corners of facets of the master, which dents: no cut.

    Each of those points has up to four facets of unequal normal below it and alternates between
    them. Symmetry of mesh and load: no force along x and y, to the tilt of the facets, 1e-3.
    """
    model = "neo-hookean" if strategy == "direct" else "linear-elastic"
    text = PAIR.format(
        cell="hexahedron", model=model, young=10, method="augmented", mu=0.3, press=-0.05
    )
    run = to_the_end(text, f'strategy = "{strategy}"')
    assert not run.cuts
    force = run.force("press")
    assert force[2] > 0.0
    assert np.abs(force[:2]).max() < 1e-3 * force[2]
    _augmented(run)


@pytest.mark.parametrize(
    ("cell", "young", "mu", "press", "x"),
    [
        ("hexahedron", 1e-3, 0.5, -0.05, 0.5),
        ("hexahedron", 10, 0.3, -0.05, 1.0),
        ("tetrahedron", 10, 0.5, -0.05, 0.3),
    ],
    ids=["soft", "far", "tetrahedra"],
)
def test_block_dragged_over_coarse_facets(to_the_end, cell, young, mu, press, x):
    """Pressed and dragged over facets twice as large, soft, far and of tetrahedra.

    Source: the same with penalties, 10 E / h and the same quadrature. The overlap of the penalties
    takes a share h p / (10 E) of the approach, some hundredths: forces agree to 15 %.
    """
    given = {"cell": cell, "model": "neo-hookean", "young": young, "mu": mu, "press": press}
    text = PAIR.format(method="augmented", **given) + DRAG.format(x=x)
    run = to_the_end(text)
    _augmented(run)
    penalty = to_the_end(PAIR.format(method="penalty", **given) + DRAG.format(x=x))
    ours, theirs = run.force("drag"), penalty.force("drag")
    assert np.linalg.norm(ours - theirs) < 0.15 * np.linalg.norm(theirs)
    spent = [sum(a.iterations for a in one.accepted) for one in (run, penalty)]
    assert spent[0] <= 3 * spent[1]


@pytest.mark.parametrize("strategy", ["condensed", "iterative"])
def test_a_free_die_takes_no_more_iterations_than_with_all_unknowns(to_the_end, strategy):
    """A rigid plane pressed on a block, let free about its normal and turned by a moment.

    Requirement: what a correction takes beyond the forces of the trial acts on rigid bodies, too,
    whatever the strategy. Source: `direct`, to the tolerance of Newton's method; iterations to a
    tenth, as linear systems are solved otherwise.
    """
    text = """
[mesh.box.block]
origin = [-0.5, -0.5, -0.5]
size = [1, 1, 0.5]
cells = [4, 4, 2]

[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3

[surface.die]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, -1]

[rigid.die]
reference = [0, 0, 0]

[[contact]]
slave = "block.top"
master = "die"
method = "augmented"
friction = { coefficients = 0.5 }

[[step]]
name = "press"
increments = 2
displacement = { "block.bottom" = { x = 0, y = 0, z = 0 } }
motion = { die = { z = -0.005 } }

[[step]]
name = "turn"
increments = 5
motion = { die = { rz_deg = "free" } }
load = { die = { rz = 1.0 } }
"""
    runs = [to_the_end(text, f'strategy = "{name}"') for name in (strategy, "direct")]
    counts = [sum(a.iterations for a in run.accepted) for run in runs]
    assert counts[0] <= 1.1 * counts[1]
    turns = [run.problem.rigid.bodies[0].accepted.rotation[2] for run in runs]
    assert turns[0] == pytest.approx(turns[1], rel=1e-6)
