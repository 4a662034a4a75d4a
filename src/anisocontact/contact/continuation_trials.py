"""Trials on the way to the laws of a contact: continuation from what is easier to solve."""

from __future__ import annotations

from anisocontact.base.array_types import Flags
from anisocontact.contact.trials import Trials


class ContinuationTrials(Trials):
    """Trials that a compliant layer, softer penalties or multipliers can lead to their laws."""

    def lay(self, compliance: float, dt: float) -> None:
        """Put a compliant layer behind adhesion, see `Layer`, until `take_away`; or a stiffer one.

        Args:
            compliance: Of the layer, length/stress.
            dt: Time increment.
        """
        start = self.start.copy()
        start["facet"][self.master.beyond(self._state)] = -1  # nothing shifts where no master is
        first = self._laws.lay(compliance, dt, self._own, start)
        self._stiffen()
        assert self._layer is not None
        self.start = self._layer.begin(first, self.master.axes(self._accepted.response))

    def without_slip(self) -> Flags:
        """Points that come to the master as if from nowhere, (n,).

        Those beyond its border, of which there are none in the usual trials, see `beyond_border`,
        and those that were farther away than it is searched.
        """
        over = self.master.beyond(self._state) & ~self.master.located(self.start)
        return over | self.master.from_afar(self.start)

    @property
    def penalised(self) -> bool:
        """Whether penalties alone hold where multipliers could follow."""
        return self.multipliers.penalised

    @property
    def at_nodes(self) -> bool:
        """Whether the points are nodes, which have one multiplier each; others are many more."""
        return self._points.at_nodes

    @property
    def by_penalty(self) -> bool:
        """Whether a penalty alone presses, and no layer is behind it."""
        alone = self._own is None and self._layer is None
        return alone and self.interface.penalties()[0] > 0.0

    @property
    def softened(self) -> bool:
        """Whether they answer with a share of the penalties, see `soften_laws`."""
        return self._laws.softened

    def soften_laws(self, share: float) -> None:
        """Answer with a share of the penalties, `by_penalty`; with 1 by the law as it is."""
        self._laws.soften(share)
        self._stiffen()

    def comply(self, stiffness: float, size: float) -> None:
        """Come to penalties by way of multipliers, see `Compliant`, until `take_away`.

        Args:
            stiffness: Of the bodies, stress/length.
            size: Facet size, length.
        """
        self.multipliers.comply(stiffness, size)
        self.begin(self._state, self._accepted)

    def take_away(self) -> None:
        """Take the layer away, or multipliers that are a way to penalties."""
        if not self.multipliers.exact:
            self.multipliers.taken = None
            self._laws.take_given()
            self._stiffen()
            self.begin(self._state, self._accepted)
        if self._layer is not None:
            self.start = self._laws.remove_layer(self.start)
            self._stiffen()
