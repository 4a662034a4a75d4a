"""What a surface of revolution refuses, in one line."""

from __future__ import annotations

from typing import Any

import pytest

from anisocontact.base.errors import InputError
from anisocontact.surfaces import make_surface

DIE: dict[str, Any] = {
    "point": (0, 0, 0),
    "axis": (0, 0, 1),
    "profile": [(2, 0), (1, 0), (1, -2)],
}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"profile": [2, 0, 1]}, "profile has 3 numbers, needs pairs r, z of two points or more"),
        ({"profile": [(2, 0)]}, "profile has 2 numbers"),
        ({"profile": [(2, 0), (2, 0), (1, 0)]}, "profile has a segment without length"),
        ({"profile": [(2, 0), (2, 0)], "spline": True}, "a segment without length"),
        ({"profile": [(2, 0), (-1, 0)]}, "profile meets the axis"),
        ({"profile": [(0, 0), (0, 1)]}, "profile meets the axis"),
        ({"profile": [(1, 0), (0, 1), (1, 2)]}, "profile meets the axis"),
        ({"profile": [(1, 0), (1, 3)], "arcs_deg": [-180]}, "profile meets the axis"),
        ({"arcs_deg": [90]}, "arcs has 1 numbers, the profile has 2 segments"),
        ({"arcs_deg": [360, 0]}, "arcs must be less than a full turn"),
        ({"rounding": [0.1, 0.1]}, "rounding has 2 numbers, the profile has 1 inner points"),
        ({"rounding": [1.5]}, "rounding is too large .* at .1.0+, 0.0+."),
        ({"rounding": -1.0}, "rounding: .*>= 0"),
        ({"rounding": [0.1], "arcs_deg": [0, 90]}, "rounding is between straight segments"),
        ({"rounding": [0.1], "spline": True}, "spline goes with neither arcs nor rounding"),
        ({"axis": (0, 0, 0)}, "axis: .*not be zero"),
    ],
)
def test_mistakes(change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        make_surface("revolution", **(DIE | change))
    assert "\n" not in str(caught.value)
