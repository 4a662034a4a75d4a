"""What has a history, which is that of one problem."""

from __future__ import annotations

from anisocontact.base.errors import InputError
from anisocontact.base.sealed import Sealed


class OneHistory(Sealed, changing="history_of"):
    """A part of a problem that remembers its increments: no other problem can go on from them.

    Attributes:
        name: Its name.
        history_of: Key of what has accepted its increments; None before the first one.
    """

    name: str
    history_of: object | None = None

    def check_history(self, key: object, kind: str) -> None:
        """Refuse a history that another problem has made, with displacements that are not of this.

        Args:
            key: That of what is to go on, an object of its own, so that a part does not refer to
                what it is a part of.
            kind: What this is, for the message.

        Raises:
            InputError: Another one has accepted increments.
        """
        if self.history_of not in (None, key):
            raise InputError(
                "it has the history of another problem that has been solved; make one for each "
                "problem",
                f"{kind} {self.name!r}",
            )
