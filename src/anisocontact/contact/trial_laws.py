"""Laws that trials are answered by: as the user gave them, softer, or with a layer behind."""

from __future__ import annotations

from typing import Any

from anisocontact.contact.augmentable_laws import AugmentedLaw
from anisocontact.contact.layer import Layer
from anisocontact.contact.master import Master
from anisocontact.contact.multipliers import RATIO, Multipliers
from anisocontact.contact.semismooth import Semismooth
from anisocontact.interface import State


class TrialLaws:
    """Those of one contact, with penalties as its multipliers say.

    Args:
        given: Laws, as the user gave them.
        master: What answers by them.
        comm: Communicator of the mesh.

    Attributes:
        layer: What stands behind adhesion; None for nothing.
        softened: Whether they are a share of the penalties that were given.
    """

    def __init__(self, given: Any, master: Master, comm: Any) -> None:
        self._given, self._master, self._comm = given, master, comm
        self._laws: AugmentedLaw = given
        self._stiff_laws: AugmentedLaw = given
        self.layer: Layer | None = None
        self.softened = False

    def follows(self, own: Multipliers | None) -> Semismooth | Layer | None:
        """What follows every step of Newton's method.

        Args:
            own: Multipliers, if there are any.
        """
        return self.layer or (None if own is None else own.semismooth)

    def slip_stiffness(self, dt: float) -> float:
        """Largest stiffness against slip, stress/length, for a time increment."""
        return float(self._laws.slip_stiffness(dt))

    def take_given(self) -> None:
        """Answer by the laws as they are."""
        self._laws = self._stiff_laws = self._given

    def soften(self, share: float) -> None:
        """Answer with a share of the penalties; with 1 by the laws as they are."""
        self.softened = share != 1.0
        soft = self._given if share == 1.0 else self._given.stiffened(share, share)
        self._laws = self._stiff_laws = soft

    def lay(self, compliance: float, dt: float, own: Multipliers | None, start: State) -> State:
        """Put a compliant layer behind adhesion, or make the one there stiffer.

        Args:
            compliance: Of the layer, length/stress.
            dt: Time increment.
            own: Multipliers, if there are any.
            start: State from which trials start.

        Returns:
            The state without what a layer has written into it.
        """
        soft, first = self._given.in_series(compliance, dt)
        stiff, begun = self._given.in_series(compliance / RATIO, dt)
        if self.layer is not None:
            start = self.layer.without(start)
            self.layer.stiffer(compliance, (first, begun))
        else:
            normal = None if own is None else own.semismooth
            self.layer = Layer(compliance, (first, begun), normal, self._master.at, self._comm)
        self._laws, self._stiff_laws = soft, stiff
        return start

    def remove_layer(self, start: State) -> State:
        """Take the layer away, if there is one; gives the state without it."""
        if self.layer is None:
            return start
        start, self.layer = self.layer.without(start), None
        self.take_given()
        return start

    def stiffen(self, own: Multipliers | None) -> None:
        """Let the master answer by them, with penalties multiplied as multipliers say.

        Args:
            own: Multipliers, if there are any.
        """
        laws, stiff = self._laws, self._stiff_laws
        if own is not None:
            laws = laws.stiffened(*own.factors)
            if (follows := self.follows(own)) is not None:
                stiff = stiff.stiffened(*follows.stiff_factors)
        self._master.take(laws, stiff)
