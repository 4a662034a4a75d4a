"""What a NURBS patch refuses, in one line."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.surfaces import make_surface

SQUARE: dict[str, Any] = {
    "degrees": (1, 1),
    "knots_1": (0, 0, 1, 1),
    "knots_2": (0, 0, 1, 1),
    "points": [(0, 0, 0), (0, 1, 0), (1, 0, 0), (1, 1, 0)],
}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"degrees": (0, 1)}, "degrees"),
        ({"degrees": (9, 1)}, "degrees must be from 1 to 8"),
        ({"degrees": (1,)}, "degrees has 1 values, needs 2"),
        ({"knots_1": (0, 0, 1)}, "knots_1 has 3 knots, degree 1 needs at least 4"),
        ({"knots_2": (0, 1, 0.5, 1)}, "knots_2 must not decrease"),
        ({"knots_2": (0, 0, 0, 0)}, "knots_2 spans nothing"),
        (
            {"knots_1": (0, 0, 0.5, 0.5, 1, 1), "points": np.zeros((4, 2, 3))},
            "knots_1 tears the surface",
        ),
        ({"points": np.zeros((5, 3))}, "points has 15 numbers, .* need 3 x 2 x 2"),
        ({"weights": (1, 1, 1)}, "weights has 3 numbers, .* need 2 x 2"),
        ({"weights": (1, 1, 1, 0)}, "weights: .*> 0"),
    ],
)
def test_mistakes(change: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message) as caught:
        make_surface("nurbs", **(SQUARE | change))
    assert "\n" not in str(caught.value)
