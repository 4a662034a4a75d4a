"""`anisocontact replay`."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from anisocontact.cli.output import say
from anisocontact.interface import STATUS

if TYPE_CHECKING:
    from anisocontact.interface.failed_point import FailedPoint


def command(arguments: argparse.Namespace) -> int:
    """Evaluate a failed point alone and print what decides the answer, and the answer."""
    from anisocontact.interface.failed_point import read_failed_point

    for line in _lines(read_failed_point(Path(arguments.file))):
        say(line)
    return 0


def _lines(point: FailedPoint) -> Iterator[str]:
    found = point.evaluate()
    yield f"point     {point.point} of {point.contact} at {_text(point.position)}, dt {point.dt:g}"
    yield f"failed    {point.failure}"
    yield "state     of the last accepted increment"
    yield from _fields(point.state)
    if found.failure:
        yield f"trial     {found.failure}"
        return
    yield f"trial     {STATUS[int(found.state['status'][0])]}"
    yield from _fields(found.state)
    yield f"traction  {_text(found.traction)}"
    for row in found.tangent:
        yield f"tangent   {_text(row)}"
    for step, error in point.tangent_errors().items():
        yield f"differences of {step:g}: {error:.1e} of the tangent"


def _fields(state: Any) -> Iterator[str]:
    for name in state.dtype.names:
        yield f"    {name:22} {_text(state[name][0])}"


def _text(values: Any) -> str:
    """Numbers with all their digits."""
    return " ".join(repr(v) for v in values.ravel().tolist())
