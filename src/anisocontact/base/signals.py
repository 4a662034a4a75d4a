"""Signals that ask a process to end: the terminal is closed, a batch system, Ctrl-C."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

#: Ctrl-C, what batch systems send, a terminal that is closed.
_ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@contextmanager
def on_signals(act: Callable[[int], None]) -> Iterator[None]:
    """Let a function answer the signals that ask the process to end.

    A signal that whoever started the process wants ignored stays ignored, as `nohup` does.

    Args:
        act: Takes the number of the signal, in the main thread between two instructions.
    """
    if threading.current_thread() is not threading.main_thread():
        yield  # only the main thread may handle signals
        return

    def handle(number: int, frame: FrameType | None) -> None:
        act(number)

    answered = [number for number in _ENDING if signal.getsignal(number) != signal.SIG_IGN]
    before = [signal.signal(number, handle) for number in answered]
    try:
        yield
    finally:
        for number, handler in zip(answered, before, strict=True):
            signal.signal(number, handler)


@contextmanager
def held_back() -> Iterator[Callable[[], None]]:
    """Answer signals afterwards, as whoever has set their handlers wants it.

    An exception out of a handler while a compiled module is loaded ends the process, in C++.

    Yields:
        What answers those that have come, and lets later ones be answered at once.
    """
    came: list[tuple[int, FrameType | None]] = []
    main = threading.current_thread() is threading.main_thread()
    before = {number: signal.getsignal(number) for number in _ENDING if main}
    before = {number: handler for number, handler in before.items() if callable(handler)}

    def keep(number: int, frame: FrameType | None) -> None:
        came.append((number, frame))

    def answer() -> None:
        while before:
            signal.signal(*before.popitem())
        while came:
            number, frame = came.pop()
            signal.getsignal(number)(number, frame)  # type: ignore[operator, misc]

    for number in before:
        signal.signal(number, keep)
    try:
        yield answer
    finally:
        answer()


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Raise KeyboardInterrupt where the process is asked to end, as Ctrl-C does."""
    with on_signals(interrupt):
        yield


def interrupt(_: int) -> None:
    """Raise what ends the process at once, whatever the signal.

    Raises:
        KeyboardInterrupt: Always.
    """
    raise KeyboardInterrupt
