"""Numbers of a gmsh file in the order they are written, text or binary alike."""

from __future__ import annotations

import mmap
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats, Ints

INT, SIZE, FLOAT = np.dtype("<i4"), np.dtype("<i8"), np.dtype("<f8")
#: Bytes of text that are taken apart at a time.
CHUNK = 1 << 18
_BLANK = re.compile(rb"\s")


class MshError(ValueError):
    """The file is not a mesh this reader understands; the text says why."""


class Stream:
    """A file that is read from front to back and never held as a whole.

    Attributes:
        binary: Whether the numbers are binary.

    Raises:
        OSError: It cannot be read.
    """

    def __init__(self, path: Path) -> None:
        self._data: bytes | mmap.mmap = b""
        with path.open("rb") as file:
            if path.stat().st_size:
                self._data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self.binary = False
        self._at = self._end = 0
        self._words: list[bytes] = []
        self._next = 0

    @property
    def ended(self) -> bool:
        """Whether there is nothing more."""
        return self._at >= len(self._data)

    def line(self) -> bytes:
        """The next line without blanks at its ends."""
        end = self._data.find(b"\n", self._at)
        end = len(self._data) if end < 0 else end
        text = self._data[self._at : end].strip()
        self._at = end + 1
        return text

    def count(self) -> int:
        """A number on a line of its own."""
        try:
            return int(self.line())
        except ValueError:
            raise MshError("text where a number belongs") from None

    def open_section(self, name: bytes) -> None:
        """Make the numbers up to the closing line of a text section available."""
        if not self.binary:
            self._end = self._closing(name)

    def close_section(self, name: bytes) -> None:
        """Go behind the closing line; nothing may be left in between."""
        closing = re.compile(rb"\s*\$End" + name).match(self._data, self._at)
        if self._next < len(self._words) or not closing:
            raise MshError(f"section ${name.decode()} holds more than it announces")
        self.skip(name)

    def skip(self, name: bytes) -> None:
        """Go behind the closing line of a section."""
        self._at = self._closing(name)
        self.line()

    def ints(self, n: int = 1) -> Ints:
        """Short integers, (n,)."""
        return self._take(n, INT).astype(np.int64)

    def sizes(self, n: int = 1) -> Ints:
        """Long integers, (n,)."""
        return self._take(n, SIZE)

    def floats(self, n: int = 1) -> Floats:
        """Numbers with a fraction, (n,)."""
        return self._take(n, FLOAT)

    def rows(
        self,
        count: int,
        width: int,
        dtype: np.dtype,
        own: tuple[int, int],
    ) -> npt.NDArray:  # type: ignore[type-arg]
        """Some rows of a table; the others are passed over.

        Args:
            count: Rows of the table.
            width: Numbers of a row.
            dtype: What they are where they are binary: INT, SIZE or FLOAT.
            own: First row and the one after the last.

        Returns:
            The rows, (last - first, width).
        """
        self._pass(own[0] * width, dtype)
        out = self._take((own[1] - own[0]) * width, dtype).reshape(-1, width)
        self._pass((count - own[1]) * width, dtype)
        return out

    def _take(self, n: int, dtype: np.dtype) -> npt.NDArray:  # type: ignore[type-arg]
        if self.binary:
            return self._raw(n, dtype)
        kind = np.float64 if dtype.kind == "f" else np.int64
        try:
            parts = [np.array(some).astype(kind) for some in self._split(n)]
        except (ValueError, OverflowError) as error:
            if isinstance(error, MshError):
                raise
            raise MshError("text where a number belongs") from None
        return parts[0] if len(parts) == 1 else np.concatenate([np.zeros(0, kind), *parts])

    def _pass(self, n: int, dtype: np.dtype) -> None:
        """Leave numbers out."""
        if self.binary:
            self._at += self._size(n, dtype)
        else:
            for _ in self._split(n):
                pass

    def _raw(self, n: int, dtype: np.dtype) -> npt.NDArray:  # type: ignore[type-arg]
        size = self._size(n, dtype)
        out = np.frombuffer(self._data, dtype=dtype, count=int(n), offset=self._at).copy()
        self._at += size
        return out

    def _size(self, n: int, dtype: np.dtype) -> int:
        size = int(n) * dtype.itemsize
        if n < 0 or self._at + size > len(self._data):
            raise MshError("the file ends too early")
        return size

    def _split(self, n: int) -> Iterator[list[bytes]]:
        """The next words of a text section, some at a time."""
        if n < 0 or n > len(self._words) - self._next + self._end - self._at:
            raise MshError("the file ends too early")
        while n > 0:
            if self._next == len(self._words):
                self._refill()
            some = self._words[self._next : self._next + n]
            self._next += len(some)
            n -= len(some)
            yield some

    def _refill(self) -> None:
        self._words, self._next = [], 0
        while not self._words:
            if self._at == self._end:
                raise MshError("the file ends too early")
            blank = _BLANK.search(self._data, min(self._at + CHUNK, self._end), self._end)
            end = blank.start() if blank else self._end
            self._words = self._data[self._at : end].split()
            self._at = end

    def _closing(self, name: bytes) -> int:
        end = self._data.find(b"$End" + name, self._at)
        if end < 0:
            raise MshError(f"section ${name.decode()[:40]} is not closed")
        return end
