"""Adhesion that is far stiffer than the bodies: every point sticks within a tiny slip only."""

from __future__ import annotations

import numpy as np
import pytest

PAIR = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [4, 4, 2]

[mesh.box.plate]
origin = [-1, -1, -1]
size = [3, 3, 1]
cells = [6, 6, 1]

[material.block]
model = "neo-hookean"
E = 10
nu = 0.3

[material.plate]
model = "neo-hookean"
E = 20
nu = 0.3

[[contact]]
slave = "block.bottom"
master = "plate.top"
"""
RIGID = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 0.6]
cells = [4, 4, 2]

[material.block]
model = "linear-elastic"
E = 10
nu = 0.3

[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "plate"
"""
DIRECTIONS = 'directions = { kind = "constant", vector = [1, 0, 0], angle_deg = 30 }'
FRICTION = f"friction = {{ coefficients = [0.2, 0.4], {DIRECTIONS} }}\n"
PLATE_HELD = '"plate.bottom" = { x = 0, y = 0, z = 0 }, '


def case(bodies: str, adhesion: str, more: str = "") -> str:
    held = PLATE_HELD if "plate.top" in bodies else ""
    return f"""{bodies}
adhesion = {{ {adhesion} }}
{FRICTION}{more}
[[step]]
name = "press"
increments = 1
displacement = {{ {held}"block.top" = {{ x = 0, y = 0, z = -0.025 }} }}

[[step]]
name = "drag"
increments = 2
displacement = {{ "block.top" = {{ x = 0.1 }} }}
"""


def check_law(contact, stiffness: tuple[float, float], tolerance: float) -> None:
    """T = -S xi_el at every sticking point, the force over its largest value."""
    stick = contact.last.status == 1
    axes, traction = contact.last.directions_adhesion[stick], contact.last.traction_t[stick]
    force = np.einsum("nad,nd->na", axes, traction)
    slip = np.einsum("nad,nd->na", axes, contact.elastic_slip()[stick])
    assert stick.any()
    assert np.abs(force + slip * stiffness).max() <= tolerance * np.abs(force).max()


@pytest.mark.parametrize("stiffness", [1e5, 1e7, 1e9])
@pytest.mark.parametrize("bodies", [PAIR, RIGID], ids=["pair", "rigid"])
def test_stiff_adhesion_ends_without_a_cut(to_the_end, bodies, stiffness):
    """Stiffness of 1e4 to 1e8 times that of the bodies, which stopped in the first increment.

    Requirement: no cut, and the forces of 750 times E/h, which plain Newton takes: they differ
    by the elastic slip over the motion, 1e-5 over 0.1.
    """
    run = to_the_end(case(bodies, f"stiffness = {stiffness}"))
    soft = to_the_end(case(bodies, "stiffness = 3e4"))
    assert not run.cuts
    wanted = soft.force("drag")
    assert np.linalg.norm(run.force("drag") - wanted) < 2e-4 * np.linalg.norm(wanted)


@pytest.mark.parametrize("solver", ['"direct"', '"condensed"', '"iterative"'])
@pytest.mark.parametrize("pair", [(1e8, 1e8), (1e9, 1e2), (1e2, 1e9)])
def test_accepted_state_has_the_stiffness_of_the_user(to_the_end, solver, pair):
    """The layer that helps leaves nothing behind: T = -S xi_el at every point that sticks.

    Source: [Konyukhov Schweizerhof 2006, eq. (28)], whose force is linear in the elastic slip
    until it slides. The tolerance is that of rounding in a sum of slips of 1e-10 at places of 1.
    """
    text = case(RIGID, f"stiffness = [{pair[0]}, {pair[1]}], {DIRECTIONS}")
    text = text.split('[[step]]\nname = "drag"')[0]
    pressed = to_the_end(text, f"strategy = {solver}")
    assert not pressed.cuts
    check_law(pressed.problem.contacts[0], pair, 1e-6)


TIMED = [
    'model = "maxwell", stiffness = 1e7, relaxation_time = 0.5',
    'model = "kelvin-voigt", stiffness = 1e3, viscosity = 1e6',
    'model = "standard-linear-solid", stiffness = 1e6, stiffness_maxwell = 1e7, '
    "relaxation_time = 0.5",
]


@pytest.mark.parametrize("adhesion", TIMED)
def test_stiff_adhesion_with_a_time(to_the_end, adhesion):
    """Models whose stiffness depends on the time increment; steady slip does not know of it."""
    run = to_the_end(case(PAIR, adhesion))
    soft = to_the_end(case(PAIR, "stiffness = 3e4"))
    wanted = soft.force("drag")
    assert not run.cuts
    assert np.linalg.norm(run.force("drag") - wanted) < 2e-3 * np.linalg.norm(wanted)


@pytest.mark.parametrize("more", ['method = "augmented"', 'pass = "mortar"'])
def test_stiff_adhesion_with_multipliers_and_slave_nodes(to_the_end, more):
    """The layer goes with multipliers of the pressure, and behind slave nodes."""
    run = to_the_end(case(PAIR, "stiffness = 1e7", more))
    soft = to_the_end(case(PAIR, "stiffness = 3e4", more))
    wanted = soft.force("drag")
    assert np.linalg.norm(run.force("drag") - wanted) < 2e-3 * np.linalg.norm(wanted)


@pytest.mark.parametrize("bodies", [PAIR, RIGID], ids=["pair", "rigid"])
def test_what_stiff_adhesion_rounds_is_no_residual(to_the_end, bodies):
    """Multipliers of the pressure beside an adhesion of 1e9, which is none of their penalties.

    Requirement: no cut, though positions at 1 are rounded to slips that are 1e-7 of the forces: a
    residual below 1e-8 of them is chance. Source: the precision of the machine times 1e9.
    """
    text = case(bodies, f"stiffness = [1e2, 1e9], {DIRECTIONS}", 'method = "augmented"')
    assert not to_the_end(text.split('[[step]]\nname = "drag"')[0]).cuts


@pytest.mark.parametrize("bodies", [PAIR, RIGID], ids=["pair", "rigid"])
@pytest.mark.parametrize("more", ["", 'method = "augmented"'])
def test_points_that_stick_turn_with_the_layer_behind_them(to_the_end, bodies, more):
    """Facets under points that stick by 1e9 since the last increment turn a little in this one.

    Requirement: the layer gives way along the arc that a slave which turns spans, so that the
    iteration converges at the pace of Newton's method: no cut, and with multipliers, whose points
    sit in the middles of facets, few corrections. Source: the point that sticks moves by force over
    stiffness, 1e-10, along the layer by 1e-3; a turn of 1e-3 makes 1e-6 of that.
    """
    text = case(
        bodies,
        'stiffness = [1e2, 1e9], directions = { kind = "constant", vector = [1, 0, 0] }',
        more,
    )
    text = text.replace("increments = 1", "increments = 2").replace("z = -0.025", "z = -0.05")
    run = to_the_end(text.split('[[step]]\nname = "drag"')[0])
    assert not run.cuts
    if more:
        assert run.accepted[-1].iterations <= 25


def test_points_that_come_to_lie_carry_no_friction_yet(to_the_end):
    """A block that is dragged opens behind and closes again when it is dragged another way.

    Requirement: a point whose gap closes in an increment is held at no gap by its multiplier, so
    that nothing of the increment is left for friction, whatever the gap is rounded to: no cut, and
    the pace of Newton's method (514 corrections and a cut before, 49 now). Source: the part of an
    increment after the gap has closed, of a penalty without limit.
    """
    axes = 'directions = { kind = "constant", vector = [1, 0, 0], angle_deg = 30 }'
    laws = (
        f"adhesion = {{ stiffness = [1e6, 1e5], {axes} }}\n"
        f'friction = {{ coefficients = [0.8, 0.1], {axes} }}\nmethod = "augmented"\n'
    )
    moves = (
        ("press", 1, "x = 0, y = 0, z = -0.02"),
        ("drag", 3, "x = 0.1"),
        ("turn", 3, "y = -0.1"),
    )
    steps = "".join(
        f'[[step]]\nname = "{name}"\nincrements = {count}\n'
        f'displacement = {{ "block.top" = {{ {to} }} }}\n'
        for name, count, to in moves
    )
    block = RIGID.replace("size = [1, 1, 0.6]", "size = [1, 1, 0.5]")
    text = block.replace("E = 10\n", "E = 100\n") + laws + steps
    run = to_the_end(text)
    assert not run.cuts
    assert max(a.iterations for a in run.accepted) <= 25


def test_failure_names_stiff_adhesion(to_the_end):
    """Where a run stops all the same, here with two iterations, the message names the adhesion."""
    from anisocontact.solver.stepping.report import StoppedError

    text = case(RIGID, "stiffness = 1e9")
    with pytest.raises(StoppedError, match=r"adhesion of block.bottom on plate is .* as stiff as"):
        to_the_end(text, "cuts = 0\noptions = { snes_max_it = 2 }")
