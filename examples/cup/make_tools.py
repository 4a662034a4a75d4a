"""Surfaces of die and punch: NURBS of revolution about z.

    python examples/cup/make_tools.py

prints their tables for case.toml. A meridian of two straight lines and a rounding, turned about z
by an arc that goes 15 degrees beyond the quarter on both sides. The punch has no surface within
1 mm of the axis, where a patch would have a pole. Lengths in mm.
"""

import math

THICKNESS = 1.0
DIE, DIE_ROUNDING = 21.4, 5.0  # radius of the hole, and of its edge
PUNCH, PUNCH_ROUNDING = 20.0, 5.0
REACH = 60.0  # half of the arc, degrees; its middle is at 45 degrees


def meridian(start: tuple, corner: tuple, end: tuple, rounding: float) -> list[tuple]:
    """Control points (r, z, weight) of start - rounding - end, three pieces of degree 2."""
    first = towards(corner, start, rounding)
    last = towards(corner, end, rounding)
    line = [start, middle(start, first), first], [last, middle(last, end), end]
    arc = math.sqrt(0.5)  # weight of the middle of a right angle
    return [(*p, 1.0) for p in line[0]] + [(*corner, arc)] + [(*p, 1.0) for p in line[1]]


def towards(start: tuple, end: tuple, length: float) -> tuple:
    """The point at a distance from the start."""
    share = length / math.dist(start, end)
    return tuple(a + share * (b - a) for a, b in zip(start, end, strict=True))


def middle(a: tuple, b: tuple) -> tuple:
    """The point between two."""
    return tuple(0.5 * (x + y) for x, y in zip(a, b, strict=True))


def table(name: str, profile: list[tuple]) -> str:
    """The table of a surface."""
    arc = math.cos(math.radians(REACH))
    points, weights = [], []
    for r, z, weight in profile:
        for angle, out, share in ((-REACH, 1.0, 1.0), (0.0, 1.0 / arc, arc), (REACH, 1.0, 1.0)):
            turn = math.radians(45.0 + angle)
            points.append((out * r * math.cos(turn), out * r * math.sin(turn), z))
            weights.append(weight * share)
    rows = [", ".join(f"{x:.9g}" for x in point) for point in points]
    lines = [
        f"[surface.{name}]",
        'shape = "nurbs"',
        "degrees = [2, 2]                 # along the meridian, around",
        "knots_1 = [0, 0, 0, 1, 1, 2, 2, 3, 3, 3]",
        "knots_2 = [0, 0, 0, 1, 1, 1]",
        "points = [",
        *(f"  {'  '.join(f'{row},' for row in rows[i : i + 3])}" for i in range(0, len(rows), 3)),
        "]",
        "weights = [",
        *(f"  {', '.join(f'{w:.8g}' for w in weights[i : i + 3])}," for i in range(0, 21, 3)),
        "]",
        "flip = true",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    print(table("die", meridian((42, 0), (DIE, 0), (DIE, -40), DIE_ROUNDING)))
    print()
    flat = THICKNESS
    print(table("punch", meridian((1, flat), (PUNCH, flat), (PUNCH, 45), PUNCH_ROUNDING)))
