"""Rubbers whose constants are stable at some stretches alone.

Of an incompressible rubber the work of a change of its logarithmic stretches h against the change
of stress is `dh . H dh`, H the second derivative of the energy of shape by h; it is positive where
the material is stable [Hill 1957; Ogden 1984, ch. 6]. Constants that were fitted in tension may
lack that in compression, and Newton's method then finds nothing, or something else.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Protocol, runtime_checkable

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.bulk.expansion import without_expansion

#: Stretches that are looked at lie within this factor of 1.
MOST = 4.0
#: Deformations that tests are made of, by the logarithms of their stretches.
_PATHS: Mapping[str, tuple[float, float, float]] = {
    "tension or compression": (1.0, -0.5, -0.5),
    "equibiaxial stretch": (1.0, 1.0, -2.0),
    "planar stretch": (1.0, 0.0, -1.0),
}
#: Changes of two of the logarithms, with that of the third that keeps the volume.
_FREE: Floats = np.array([[1.0, 0.0], [0.0, 1.0], [-1.0, -1.0]])


@runtime_checkable
class Rubber(Protocol):
    """A material that tells how its energy of shape goes with its stretches."""

    def curvature(self, logs: Floats) -> Floats:
        """Second derivative by the logarithmic stretches, (3, 3), stress."""
        ...


def stable_range(rubber: Rubber, path: str) -> tuple[float, float]:
    """Stretches around 1 at which a rubber is stable, within the factor `MOST`.

    Args:
        rubber: The material.
        path: One of the names of deformations.

    Returns:
        The least and the largest.

    Example:
        >>> from anisocontact.bulk import make_material
        >>> soft = make_material("mooney-rivlin", C10=1.0, C01=-0.5, bulk_modulus=100.0)
        >>> [round(s, 2) for s in stable_range(soft, "equibiaxial stretch")]
        [0.85, 1.2]
    """
    ends = []
    for way in (-1.0, 1.0):
        sizes = np.linspace(0.0, np.log(MOST), 201)
        stable = [_is_stable(rubber, way * size * np.array(_PATHS[path])) for size in sizes]
        last = len(sizes) if all(stable) else stable.index(False)
        ends.append(float(np.exp(way * sizes[max(last - 1, 0)])))
    return ends[0], ends[1]


def unstable_rubbers(materials: Mapping[str, Any]) -> list[str]:
    """What is to be known of bodies whose rubber is not stable at moderate stretches, a line each.

    Args:
        materials: Body name -> material.

    Returns:
        The body, and the stretches beyond which it is unstable.
    """
    said = []
    for body, material in materials.items():
        rubber = without_expansion(material)
        if not isinstance(rubber, Rubber):
            continue
        ranges = {path: stable_range(rubber, path) for path in _PATHS}
        bounds = [
            f"{path} {' and '.join(_bounds(*found))}"
            for path, found in ranges.items()
            if _bounds(*found)
        ]
        if bounds:
            said.append(
                f"body {body!r}: its rubber is unstable in {'; '.join(bounds)}: the constants do "
                "not hold there"
            )
    return said


def _bounds(low: float, high: float) -> list[str]:
    """Bounds that are within the range that is looked at."""
    within = 1.0 + 1e-9
    below = [f"below {low:.2f}"] if low > within / MOST else []
    return below + ([f"beyond {high:.2f}"] if high < MOST / within else [])


def _is_stable(rubber: Rubber, logs: Floats) -> bool:
    stiffness = _FREE.T @ rubber.curvature(logs) @ _FREE
    return bool(np.linalg.eigvalsh(stiffness)[0] > 0.0)
