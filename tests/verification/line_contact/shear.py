"""Shear at slave nodes beside its closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


@dataclass(frozen=True)
class Shear:
    """Shear at the slave nodes.

    Attributes:
        place: x over a, (n,).
        found: Shear over mu p0, (n,).
        exact: What should be found, (n,).
        told: Nodes whose status is told by the closed form, (n,).
        sticks: Which of all of them stick, and should, (n,) each.
    """

    place: Floats
    found: Floats
    exact: Floats
    told: npt.NDArray[np.bool_]
    sticks: tuple[npt.NDArray[np.bool_], npt.NDArray[np.bool_]]

    @property
    def _error(self) -> Floats:
        return np.asarray((self.found - self.exact)[np.abs(self.place) <= 0.8])

    @property
    def largest(self) -> float:
        """Largest error within 0.8 a, over mu p0."""
        return float(np.abs(self._error).max())

    @property
    def mean(self) -> float:
        """Root of the mean square of the error within 0.8 a, over mu p0."""
        return float(np.sqrt(np.mean(self._error**2)))

    def check_status(self) -> None:
        """Stick and slip are right wherever the closed form tells them."""
        found, exact = self.sticks
        np.testing.assert_array_equal(found[self.told], exact[self.told])
