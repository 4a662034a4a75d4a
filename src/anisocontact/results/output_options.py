"""What a run writes, and when; what its report is labelled with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

from anisocontact.results.probes import Probe
from anisocontact.results.resultants import Resultant


@dataclass(frozen=True)
class OutputOptions:
    """What a run writes beside its summary and its history, and when.

    Args:
        every: Fields are written every so many increments, and at the end of each step.
        steps: Names of the steps of which they are written; all if not given.
        times: Times from which on the next increment is written as well.
        quantities: Names of the arrays to write for ParaView; all if not given.
        probes: Places at which values are written after each increment, by name.
        resultants: Further forces and moments, by name.
        pictures: Whether the report with its pictures is made at the end.
        vtkhdf: Whether all states are also written as one file of each sort at the end.
        checkpoint_every: Wall-clock seconds between two checkpoints; 0: one after each increment.
    """

    every: int = 1
    steps: Sequence[str] = ()
    times: Sequence[float] = ()
    quantities: Sequence[str] = ()
    probes: Mapping[str, Probe] = field(default_factory=lambda: MappingProxyType({}))
    resultants: Mapping[str, Resultant] = field(default_factory=lambda: MappingProxyType({}))
    pictures: bool = True
    vtkhdf: bool = False
    checkpoint_every: float = 0.0


@dataclass(frozen=True)
class Labels:
    """What summary and report call the run and its parts.

    Args:
        title: Heading of the report.
        masters: Name of the master of each contact; the name of the contact if not given.
        units: What numbers are in, by dimension.
    """

    title: str = ""
    masters: Sequence[str] = ()
    units: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
