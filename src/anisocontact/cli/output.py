"""Standard output and error that take any text, and that may break off without ending a run."""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any, Protocol, TextIO, cast

from anisocontact.base.errors import printable


class TextStream(Protocol):
    """Where lines can go."""

    def write(self, text: str, /) -> object:
        """Take a text."""

    def flush(self) -> object:
        """Hand on what was written."""


class Output:
    """A stream that never raises: what cannot be written is dropped, and why is remembered.

    Args:
        stream: Where text goes; None where the process was started without it.

    Attributes:
        failure: Why nothing can be written any more.
    """

    def __init__(self, stream: TextIO | None) -> None:
        self._stream = stream
        self.failure: OSError | None = None
        self._terminal = self.isatty()
        self._errors = getattr(stream, "errors", None)
        # what the encoding lacks is written as an escape
        self._reconfigure("backslashreplace")

    @classmethod
    def of(cls, stream: TextIO) -> Output:
        """A stream as an output; the same one if it is one."""
        return stream if isinstance(stream, cls) else cls(stream)

    @property
    def gone(self) -> bool:
        """Whether the reader of a pipe has gone, or a terminal: nobody is there to be told."""
        left = (errno.EPIPE, errno.EIO) if self._terminal else (errno.EPIPE,)
        return self.failure is not None and self.failure.errno in left

    @property
    def why(self) -> str:
        """Why nothing can be written, in a few words; empty while it can."""
        if self.failure is None:
            return ""
        if self.gone:
            return "nobody reads what is printed any more"
        return f"what is printed cannot be written ({self.failure.strerror}: send it elsewhere)"

    def isatty(self) -> bool:
        """Whether it is a terminal."""
        return self._stream is not None and self._stream.isatty()

    def __getattr__(self, name: str) -> Any:
        """All else is that of the stream, its encoding for instance."""
        return getattr(self._stream, name)

    def write(self, text: str) -> int:
        """Write a text, or drop it."""
        if self._stream is not None and self.failure is None:
            try:
                self._stream.write(text)
            except OSError as error:
                self._lose(self._stream, error)
        return len(text)

    def flush(self) -> None:
        """Hand on what was written."""
        if self._stream is not None and self.failure is None:
            try:
                self._stream.flush()
            except OSError as error:
                self._lose(self._stream, error)

    def release(self) -> None:
        """Leave the stream as it was."""
        self.flush()
        if self._errors is not None:
            self._reconfigure(self._errors)

    def _lose(self, stream: TextIO, error: OSError) -> None:
        self.failure = error
        # what is kept for it would be tried again, and told, when the process ends
        with suppress(OSError, ValueError):
            nothing = os.open(os.devnull, os.O_WRONLY)
            os.dup2(nothing, stream.fileno())
            os.close(nothing)

    def _reconfigure(self, errors: str) -> None:
        change: Any = getattr(self._stream, "reconfigure", None)
        if change is not None:
            change(errors=errors)


@contextmanager
def outputs() -> Iterator[tuple[Output, Output]]:
    """Standard output and error as `Output`, which are `sys.stdout` and `sys.stderr` meanwhile."""
    before = sys.stdout, sys.stderr
    out, err = Output(sys.stdout), Output(sys.stderr)
    sys.stdout, sys.stderr = cast(TextIO, out), cast(TextIO, err)
    try:
        yield out, err
    finally:
        out.release()
        err.release()
        sys.stdout, sys.stderr = before


def say(line: str, stream: TextStream | None = None) -> None:
    """Print a line at once; what does not print in it is written as an escape.

    Args:
        line: The line; names and texts of the user may be in it.
        stream: Where; standard output if not given.
    """
    print(printable(line), file=stream or sys.stdout, flush=True)
