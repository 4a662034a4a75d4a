"""Length over thickness of bodies.

Source: the definition in `mesh/slenderness.py`, `d A / 2 V` with the diagonal d of the box of a
body, its surface A and volume V, by hand for boxes. Tolerance: rounding.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.mesh import BoxSpec, build_box
from anisocontact.mesh.slenderness import slenderness


@pytest.mark.parametrize("cells", [(1, 1, 1), (4, 2, 3)])
def test_boxes(cells: tuple[int, int, int]) -> None:
    """Whatever their cells; the more slender one of some counts."""
    box, cube = BoxSpec((0, 0, 0), (4, 2, 1), cells), BoxSpec((9, 9, 9), (1, 1, 1), cells)
    expected = np.sqrt(21.0) * 28.0 / 16.0
    both = build_box({"box": box, "cube": cube})
    assert slenderness(both, ["box"]) == pytest.approx(expected, rel=1e-12)
    assert slenderness(both, ["cube"]) == pytest.approx(np.sqrt(27.0), rel=1e-12)
    assert slenderness(both, ["cube", "box"]) == pytest.approx(expected, rel=1e-12)
    assert slenderness(both, []) == 0.0
