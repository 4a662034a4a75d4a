"""Tables of case files that several of the hard cases begin with."""

from __future__ import annotations

from collections.abc import Sequence


def on_a_floor(
    body: str,
    size: Sequence[float],
    cells: Sequence[int],
    young: float,
    *,
    kind: str = "plane-strain",
    lateral: bool = False,
    model: str = "linear-elastic",
    nu: float = 0.0,
    order: int = 1,
    gap: float = 0.0,
) -> str:
    """A body on a rigid plane, to its contact, which is the last table and wants its laws.

    Args:
        body: Its name.
        size: Of the rectangle, from the origin on, or of the box, whose middle is at y = 0.
        cells: How many along each side.
        young: Young's modulus.
        kind: What a rectangle is taken for.
        lateral: Whether it moves across its plane too.
        model: The material.
        nu: Poisson's ratio.
        order: Of the cells.
        gap: Below the body.
    """
    plane = len(size) == 2
    origin = [0, 0] if plane else [0, -0.5 * size[1], 0]
    point, normal = ([0, -gap, 0], [0, 1, 0]) if plane else ([0, 0, -gap], [0, 0, 1])
    taken_for = f'[idealisation]\nkind = "{kind}"\nlateral = {str(lateral).lower()}\n'
    return f"""
{taken_for if plane else ""}
[mesh.{"rectangle" if plane else "box"}.{body}]
origin = {origin}
size = {list(size)}
cells = {list(cells)}
order = {order}
[material.{body}]
model = "{model}"
E = {young}
nu = {nu}
[surface.floor]
shape = "plane"
point = {point}
normal = {normal}
[[contact]]
slave = "{body}.bottom"
master = "floor"
"""


def pad_touches_block(
    sides: tuple[str, str],
    young: float,
    nu: float,
    friction: float,
    *,
    held: str,
    touch: float,
    model: str = "linear-elastic",
) -> str:
    """A pad of "bodies.msh" under a head that meets a block of its material in an increment.

    Args:
        sides: Slave and master.
        young: Young's modulus.
        nu: Poisson's ratio.
        friction: Coefficient.
        held: What holds the block, a table.
        touch: Way of the head to the first touch.
        model: The material.
    """
    bodies = "".join(
        f'[material.{body}]\nmodel = "{model}"\nE = {young}\nnu = {nu}\n'
        for body in ("pad", "block")
    )
    return f"""
[idealisation]
kind = "plane-strain"
[mesh]
file = "bodies.msh"
{bodies}
[[contact]]
slave = "{sides[0]}"
master = "{sides[1]}"
friction = {{ coefficients = {friction} }}
[rigid.head]
faces = ["pad.top"]
reference = [0, 12, 0]
[[step]]
name = "touch"
increments = 1
displacement = {held}
motion = {{ head = {{ y = -{touch} }} }}
"""


def then_pressed(load: float) -> str:
    """A further increment, in which a load presses that head and lets it move along the block."""
    return f"""
[[step]]
name = "press"
increments = 1
motion = {{ head = {{ x = "free", y = "free" }} }}
load = {{ head = {{ y = -{load} }} }}
"""
