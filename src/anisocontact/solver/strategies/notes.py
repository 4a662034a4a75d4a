"""Notes of a strategy for the log."""

from __future__ import annotations

from collections.abc import Callable


def without_repeats(note: Callable[[str], None]) -> Callable[[str], None]:
    """A log that does not repeat a line, as attempts that condense the same bodies again would.

    Args:
        note: Takes a line.

    Example:
        >>> said = []
        >>> log = without_repeats(said.append)
        >>> for line in ("condensing", "condensing", "widened"):
        ...     log(line)
        >>> said
        ['condensing', 'widened']
    """
    said: set[str] = set()

    def tell(line: str) -> None:
        if line not in said:
            said.add(line)
            note(line)

    return tell
