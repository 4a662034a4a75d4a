"""Cells that built-in shapes can have, by the kind of their entries; the first is the default."""

from __future__ import annotations

#: Kinds of shapes: bodies in space, and those in the plane z = 0.
IN_SPACE, IN_PLANE = "shape", "shape in the plane"

CELLS = {IN_SPACE: ("hexahedron", "tetrahedron"), IN_PLANE: ("quadrilateral", "triangle")}
