"""Parts of the case files of this code that the benchmarks share."""

from __future__ import annotations

from collections.abc import Sequence

PLANE = '[surface.plane]\nshape = "plane"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n'


def box(
    name: str, origin: Sequence[float], size: Sequence[float], cells: Sequence[int], material: str
) -> str:
    """A body and its material.

    Args:
        name: Its name.
        origin: Lowest corner.
        size: Edge lengths.
        cells: Cells along each axis.
        material: Entries of its material.
    """
    return (
        f"[mesh.box.{name}]\norigin = {list(origin)}\nsize = {list(size)}\n"
        f"cells = {list(cells)}\n[material.{name}]\n{material}\n"
    )


def coulomb(pair: bool, penalty: float, friction: float, more: str = "") -> str:
    """Coulomb friction below the block, on the base or on the plane, at integration points.

    Args:
        pair: Whether it is on the base.
        penalty: Along the normal and the tangent, force/length^3.
        friction: Coefficient.
        more: More entries.
    """
    return f"""
[[contact]]
slave = "block.bottom"
master = "{"base.top" if pair else "plane"}"
{more}pass = "single"
normal = {{ penalty = {penalty} }}
adhesion = {{ stiffness = [{penalty}, {penalty}] }}
friction = {{ coefficients = [{friction}, {friction}] }}
"""


def press_and_drag(pair: bool, down: float, along: float, presses: int, drags: int) -> str:
    """The top of the block goes down, then along x; a base is clamped below.

    Args:
        pair: Whether there is a base.
        down: Way down, length.
        along: Way along x, length.
        presses: Increments on the way down.
        drags: Increments along x.
    """
    clamp = ', "base.bottom" = { x = 0, y = 0, z = 0 }' if pair else ""
    return f"""
[[step]]
name = "press"
increments = {presses}
displacement = {{ "block.top" = {{ x = 0, y = 0, z = {-down} }}{clamp} }}

[[step]]
name = "drag"
increments = {drags}
displacement = {{ "block.top" = {{ x = {along} }} }}
"""
