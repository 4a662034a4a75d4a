"""Benchmarks of this code beside the blocks, by name."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from records import Record

#: Runs a part; its argument is the time that a process may take, s.
PARTS: dict[str, Callable[[float], Iterator[Record]]] = {}
