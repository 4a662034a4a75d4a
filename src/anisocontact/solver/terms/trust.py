"""Whether contact alone is trusted to hold bodies that have no other support."""

from __future__ import annotations

from collections.abc import Sequence


class Trust:
    """Whether bodies that stick go without springs in the next attempt.

    Once an attempt without springs has failed, contact is trusted again when it has held all bodies
    in as many sub-increments as `_patience` says, when bodies on springs of their own are caught,
    or when the step ends. The patience doubles each time that contact is trusted in vain: where
    springs are needed all through a step, few attempts without them are lost.

    Attributes:
        careful: Whether bodies get springs also where they stick.
        held: Whether contact has held all bodies in the last sub-increment of the step, as it may
            where all their points slide.
    """

    def __init__(self) -> None:
        self.renew()
        self._caught = self._holding = self._held = False

    def renew(self) -> None:
        """Trust contact: a step begins."""
        self.careful, self._patience, self._sound = False, 1, 0
        self.held = False

    def lose(self, trusted: bool) -> None:
        """Bodies get springs in the next attempts, since one has failed.

        Args:
            trusted: Whether contact alone was to hold a body in that attempt.
        """
        if trusted and not self.careful:
            self._patience *= 2
        self.careful, self._sound = True, 0

    def look(self, holding: bool, sprung: bool) -> None:
        """Note what contact does in equilibrium.

        Args:
            holding: Whether contact and springs have stiffness against all motions again.
            sprung: Whether all bodies have springs of their own.
        """
        self._held, self._holding = holding, self.careful and holding
        self._caught = self._holding and sprung

    def accept(self) -> None:
        """The equilibrium is accepted."""
        self._sound += self._holding
        self.held = self._held
        self.careful = self.careful and not (self._caught or self._sound >= self._patience)

    def numbers(self) -> list[int]:
        """What goes into a checkpoint."""
        return [int(self.careful), self._patience, self._sound, int(self.held)]

    def restore(self, numbers: Sequence[float]) -> None:
        """Take up what `numbers` gave."""
        careful, self._patience, self._sound, held = map(int, numbers)
        self.careful, self.held = bool(careful), bool(held)
