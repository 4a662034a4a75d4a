"""Values that steps prescribe: linearly up to a number, or along a load curve."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.load_curve import PrescribedValue, TimeHistory, history_of


class PrescribedComponents:
    """A vector of prescribed components; those that a step does not name stay as they are.

    Args:
        size: Number of components, at first 0.

    Attributes:
        start: Values when the step began, (size,).
        end: Values at its end, (size,).

    Example:
        >>> from anisocontact.base.load_curve import LoadCurve
        >>> force = PrescribedComponents(2)
        >>> force.begin(1.0)
        >>> force.prescribe(0, 4.0)
        >>> force.prescribe(1, LoadCurve(lambda t: t**2))
        >>> force.at(0.5).tolist(), force.end.tolist()
        ([2.0, 0.25], [4.0, 1.0])
    """

    def __init__(self, size: int) -> None:
        self.start, self.end = np.zeros(size), np.zeros(size)
        self._curved: dict[int, TimeHistory] = {}
        self._duration = 1.0

    def begin(self, duration: float, start: Floats | None = None) -> None:
        """Begin a step.

        Args:
            duration: Time it takes.
            start: Values at its beginning; those at the end of the step before if left out.
        """
        self.start = (self.end if start is None else start).copy()
        self.end = self.start.copy()
        self._curved, self._duration = {}, duration

    def prescribe(self, i: int, value: PrescribedValue) -> None:
        """Prescribe a component for the step that has begun."""
        history = history_of(value)
        self._curved.pop(i, None)
        if not history.linear:
            self._curved[i] = history
        self.end[i] = history.at(1.0, self._duration, self.start[i])

    def stop(self, fraction: float) -> None:
        """End the step at a fraction of it: the values there are those at its end."""
        self.end = self.at(fraction)
        self._curved = {}

    @property
    def varies(self) -> bool:
        """Whether a component follows a load curve."""
        return bool(self._curved)

    @property
    def rests(self) -> bool:
        """Whether all components stay as they are along the step."""
        return not self._curved and bool((self.start == self.end).all())

    def at(self, fraction: float) -> Floats:
        """Values at a fraction of the step, (size,)."""
        values = (1.0 - fraction) * self.start + fraction * self.end
        for i, history in self._curved.items():
            values[i] = history.at(fraction, self._duration, self.start[i])
        return values
