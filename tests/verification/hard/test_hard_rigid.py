"""Hard contacts with rigid surfaces: thin, soft and unsupported bodies."""

from __future__ import annotations

import numpy as np
import pytest

HOLD = "x = 0, y = 0, z = 0"


def test_deep_ironing(to_the_end):
    """A rigid cylinder pressed into a soft slab by a third of its height and drawn along it."""
    run = to_the_end(
        f"""
[mesh.box.slab]
origin = [0, 0, 0]
size = [4, 0.5, 1]
cells = [16, 1, 4]

[material.slab]
model = "neo-hookean"
E = 1
nu = 0.4

[surface.die]
shape = "cylinder"
point = [1, 0, 1.6]
axis = [0, 1, 0]
radius = 0.6

[rigid.die]
reference = [1, 0, 1.6]

[[contact]]
slave = "slab.top"
master = "die"
friction = {{ coefficients = 0.3 }}

[[step]]
name = "press"
increments = 5
displacement = {{ "slab.bottom" = {{ {HOLD} }} }}
motion = {{ die = {{ z = -0.33 }} }}

[[step]]
name = "iron"
increments = 10
motion = {{ die = {{ x = 2.0 }} }}
"""
    )
    force = run.force("iron")
    assert force[2] < 0.0
    assert 0.2 < force[0] / -force[2] < 0.8
    assert not run.problem.inverted_cells().size


def test_snap_through_of_an_arch(to_the_end):
    """A shallow arch pushed down at its crown until it snaps through under the die.

    The equilibrium jumps: behind the limit the arch leaves the die, or carries it from the other
    side. The crown ends below the line of its supports.
    """
    run = to_the_end(
        f"""
[mesh.ring.arch]
inner = 10
outer = 10.1
length = 0.5
start_deg = 75
end_deg = 105
cells = [2, 20, 1]

[material.arch]
model = "st-venant-kirchhoff"
E = 1000
nu = 0.3

[surface.die]
shape = "sphere"
centre = [0, 11.1, 0.25]
radius = 1

[rigid.die]
reference = [0, 11.1, 0.25]

[[contact]]
slave = "arch.outer"
master = "die"
friction = {{ coefficients = 0.2 }}

[[step]]
name = "push"
increments = 10
displacement = {{ "arch.start" = {{ {HOLD} }}, "arch.end" = {{ {HOLD} }} }}
motion = {{ die = {{ y = -0.7 }} }}
"""
    )
    x = run.problem.model.space.tabulate_dof_coordinates()
    crown = np.argmin(np.linalg.norm(x - [0.0, 10.1, 0.25], axis=1))
    sunk = run.problem.u.x.array.reshape(-1, 3)[crown, 1]
    assert sunk < -0.6
    external = [a.energies["external"] for a in run.accepted]
    assert max(external) > 0.0


def test_nearly_incompressible_roller(to_the_end):
    """A rubber tyre, nu = 0.499, pressed on a plane by its hub and rolled by 20 degrees."""
    run = to_the_end(
        """
[mesh.ring.tyre]
inner = 0.6
outer = 1.0
length = 0.4
cells = [2, 24, 1]
rotate = { axis = [1, 0, 0], angle_deg = 90 }
move = [0, 0, 1.0]

[material.tyre]
model = "neo-hookean-incompressible"
E = 1
nu = 0.499

[surface.road]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "tyre.outer"
master = "road"
friction = { coefficients = 0.8 }

[[step]]
name = "press"
increments = 4
displacement = { "tyre.inner" = { x = 0, y = 0, z = -0.06 } }

[[step]]
name = "roll"
increments = 8
[step.rotation]
"tyre.inner" = { axis = [0, 1, 0], angle_deg = 20, point = [0, 0, 0.94], move = [0.34, 0, 0] }
"""
    )
    press, roll = run.force("press"), run.force("roll")
    assert press[2] > 0.0
    assert roll[2] == pytest.approx(press[2], rel=0.3)
    # rolling, not sliding: far below the limit of friction
    assert abs(roll[0]) < 0.5 * 0.8 * roll[2]


def test_first_contact_of_an_unsupported_body(to_the_end):
    """A block in the air that nothing holds falls on the plate under a force, then slides not.

    Requirement: first contact of an unsupported body runs to its end with default settings; the
    plate carries the force, and the springs that kept the block in reach carry nothing.
    """
    run = to_the_end(
        """
[mesh.box.block]
origin = [0, 0, 0.05]
size = [1, 1, 1]
cells = [3, 3, 3]

[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3

[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "plate"
friction = { coefficients = 0.3 }

[[step]]
name = "load"
increments = 2
force = { "block.top" = { x = 1, z = -5 } }

[[step]]
name = "more"
increments = 1
force = { "block.top" = { z = -50 } }
"""
    )
    assert run.force("more") == pytest.approx([-1.0, 0.0, 50.0], abs=1e-5)


def test_slip_of_a_stiff_texture(to_the_end):
    """Adhesion a thousand times stiffer than the body, strong anisotropy, large increments."""
    run = to_the_end(
        """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 0.5]
cells = [4, 4, 2]

[material.block]
model = "linear-elastic"
E = 100
nu = 0.3

[surface.plate]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "plate"
adhesion = { stiffness = [1e6, 1e5], directions = { kind = "constant", vector = [1, 0, 0], angle_deg = 30 } }
friction = { coefficients = [0.8, 0.1], directions = { kind = "constant", vector = [1, 0, 0], angle_deg = 30 } }

[[step]]
name = "press"
increments = 1
displacement = { "block.top" = { x = 0, y = 0, z = -0.02 } }

[[step]]
name = "drag"
increments = 3
displacement = { "block.top" = { x = 0.1 } }

[[step]]
name = "turn"
increments = 3
displacement = { "block.top" = { y = -0.1 } }
"""  # noqa: E501
    )
    force = run.force("turn")
    assert 0.08 < np.hypot(*force[:2]) / force[2] < 0.8
