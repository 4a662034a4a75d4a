"""Memory that factorisations take, and memory there is."""

from __future__ import annotations

import os
import resource
from collections.abc import Iterator
from pathlib import Path

#: Bytes for each entry of the dense matrix: S twice in double precision (MUMPS assembles it once
#: more), the factor of the tangent in single precision.
_DENSE = 2 * 8 + 4
#: Bytes of an entry of a factor: double precision, and a quarter for MUMPS' workspace.
_ENTRY = 1.25 * 8
#: Entries of LU factors of n unknowns of bodies in space over n^(4/3), the power of nested
#: dissection [George 1973]: of all unknowns, and with those that can be touched left to the end.
#: MUMPS, a block of 24 x 24 x 12 hexahedra (22,500 unknowns, 1,875 at the end): 35.3 and 44.1.
_WHOLE, _BORDER_LAST = 35.0, 44.0
#: Share of the free memory that dense matrices or a factor may take.
MEMORY_SHARE = 0.5


def factor_bytes(unknowns: int) -> float:
    """Memory for a factorisation of a whole system, bytes.

    Args:
        unknowns: Number of unknowns of the system.

    Example:
        >>> f"{factor_bytes(22500) / 1e6:.0f} MB"
        '222 MB'
    """
    return _ENTRY * _WHOLE * _n43(unknowns)


def memory_needed(unknowns: int, count: int) -> float:
    """Memory for condensing bodies, bytes.

    Args:
        unknowns: Number of unknowns of the bodies.
        count: Number of those that can be touched.

    Example:
        >>> f"{memory_needed(65445, 3198) / 1e9:.2f} GB"
        '1.36 GB'
    """
    return _DENSE * count**2 + _ENTRY * _BORDER_LAST * _n43(unknowns)


def free_memory() -> float:
    """Memory that this process may still take, bytes; no limit where nothing says one."""
    return min(_of_machine(), _of_process(), _of_group())


def too_large(what: str, needed: float) -> Iterator[str]:
    """Why something would not fit into memory, in a line; nothing where it does.

    Args:
        what: What it is.
        needed: Memory that it takes, bytes.
    """
    free = free_memory()
    if needed > MEMORY_SHARE * free:
        yield f"{what} needs {needed / 1e9:.1f} GB, {free / 1e9:.1f} GB are free"


def _n43(unknowns: int) -> float:
    return float(unknowns ** (4.0 / 3.0))


def _of_machine() -> float:
    try:
        with open("/proc/meminfo", encoding="ascii") as file:
            found = dict(line.split(":", 1) for line in file)
        return 1024.0 * float(found["MemAvailable"].split()[0])
    except (OSError, KeyError, ValueError):
        try:
            return float(os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
        except (ValueError, OSError):
            return float("inf")


def _of_process() -> float:
    """What the limit of the address space (`ulimit -v`) leaves."""
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return float("inf")
    try:
        pages = int(Path("/proc/self/statm").read_text(encoding="ascii").split()[0])
    except (OSError, ValueError, IndexError):
        pages = 0
    return float(max(limit - pages * resource.getpagesize(), 0))


def _of_group() -> float:
    """What the limit of a container or job leaves (control groups, version 2)."""
    try:
        limit, used = (
            int(Path(f"/sys/fs/cgroup/memory.{name}").read_text(encoding="ascii"))
            for name in ("max", "current")
        )
    except (OSError, ValueError):  # there is none, or it is "max"
        return float("inf")
    return float(max(limit - used, 0))
