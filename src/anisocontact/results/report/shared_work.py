"""Work shared with a copy of this process."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence

#: Bytes of the number of a piece of work.
_SIZE = 4


def attempts(work: Sequence[Callable[[], str]], *, forks: bool) -> list[str]:
    """What each of some functions returns.

    Args:
        work: The functions; what they do beside is seen in files alone.
        forks: Whether a copy of this process helps: each takes the next one when it is free.
    """
    if not forks or len(work) < 2:
        return [one() for one in work]
    left, told = os.pipe()
    with open(told, "wb") as numbers:
        numbers.write(b"".join(i.to_bytes(_SIZE) for i in range(len(work))))
    theirs = _by_a_copy(work, left)
    found = {i: work[i]() for i in _taken(left)}
    os.close(left)
    found |= theirs()
    return [found[i] if i in found else work[i]() for i in range(len(work))]


def _taken(left: int) -> Iterator[int]:
    """Numbers of work that nobody has taken yet."""
    while number := os.read(left, _SIZE):
        yield int.from_bytes(number)


def _by_a_copy(work: Sequence[Callable[[], str]], left: int) -> Callable[[], dict[int, str]]:
    """Have a copy of this process work; gives what it found, nothing if it could not."""
    ours, theirs = os.pipe()
    number = os.fork()
    if number == 0:
        try:
            with open(theirs, "w", encoding="utf-8") as told:
                json.dump([(i, work[i]()) for i in _taken(left)], told)
        finally:
            os._exit(0)
    os.close(theirs)

    def found() -> dict[int, str]:
        with open(ours, encoding="utf-8") as told:
            text = told.read()
        os.waitpid(number, 0)
        return dict(json.loads(text)) if text else {}

    return found
