"""Memory and time that factorisations take, and memory there is."""

from __future__ import annotations

import os
import resource
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

#: Bytes of an entry of LU of a whole system: double precision, and a quarter for MUMPS' workspace.
_ENTRY = 1.25 * 8
#: Its entries for n unknowns of bodies in space over n^(4/3), the power of nested dissection
#: [George 1973]. MUMPS, a block of 24 x 24 x 12 hexahedra (22,500 unknowns): 35.3.
_WHOLE = 35.0
#: Factor of MUMPS with its workspace over the entries, beside copies of the border: LDL^T by blocks
#: (0.9 and 1.2 for two bodies of 22,500 and 36,963 unknowns), and LU.
_WORK, _WORK_LU = 1.15, 1.3
#: Bytes for each entry of a stiffness: a sparse matrix; what MUMPS is given, with its own copy of a
#: triangle, 16 bytes for an entry of that, which stays; and what else Newton's method has where all
#: of it changes.
_STORED, _GIVEN, _LEFT, _CHANGING = 12, 20, 8, 55
#: Bytes for each entry of the dense matrix of all contact unknowns, in single precision: the matrix
#: and its factor, or what it is cut into where masters are eliminated.
_DENSE = 2 * 4
#: Libraries that are loaded when the first system is solved, bytes.
_LIBRARIES = 13e6
#: Bytes of a block of the tangent of a contact, and of its entries in a sparse matrix.
_BLOCK = 2 * 9 * 8
#: Floating-point operations of a dense or sparse factorisation in the time in which a solution
#: reads one entry of a factor, and solutions in the time in which fronts are put together: MUMPS
#: and OpenBLAS on one core, in the plane and in space, 8,000 to 31,000 unknowns, within 10 %.
_OPERATIONS_PER_ENTRY, _FILLING = 40.0, 5.0
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


def operation_cost(operations: float) -> float:
    """Time of floating-point operations, as the number of entries that a solution reads in it.

    Args:
        operations: Their number, half of it where they are in single precision and solutions not.
    """
    return operations / _OPERATIONS_PER_ENTRY


def factorisation_cost(entries: float, operations: float) -> float:
    """Time of a sparse factorisation, as the number of entries that a solution reads in it.

    Args:
        entries: Of the factor.
        operations: Floating-point operations.

    Example:
        >>> factorisation_cost(entries=1e6, operations=4e8) / 1e6
        15.0
    """
    return operation_cost(operations) + _FILLING * entries


@dataclass(frozen=True)
class Part:
    """A body to be condensed.

    Attributes:
        unknowns: Those that are not prescribed.
        touched: Those of them that can be touched.
        entries: Entries of LDL^T, those that can be touched last.
    """

    unknowns: int
    touched: int
    entries: float


@dataclass(frozen=True)
class Condensable:
    """Bodies to be condensed.

    Attributes:
        parts: The bodies.
        stored: Entries of the stiffness of all.
        blocks: Blocks of 3 x 3 in the tangents of the contacts.
        changing: Whether they are not linear: one LU of all in single precision then, else LDL^T of
            one after the other in double precision.
    """

    parts: Sequence[Part]
    stored: float
    blocks: float = 0.0
    changing: bool = False


def condensing_bytes(bodies: Condensable) -> float:
    """Most memory that a run takes to condense bodies and to solve for what is touched, bytes.

    It is that in which MUMPS has a front on its stack and a copy of its factor, or that in which
    the contact unknowns have a dense factor beside those of all bodies.

    Args:
        bodies: What is to be condensed.

    Example:
        >>> pair = Condensable([Part(32856, 1311, 18e6), Part(22500, 1875, 15e6)], stored=4.5e6)
        >>> f"{condensing_bytes(pair) / 1e6:.0f} MB"
        '619 MB'
    """
    count = sum(part.touched for part in bodies.parts)
    whole = max(sum(part.unknowns for part in bodies.parts), 1)
    size, matrices, work, parts = 8, _STORED, _WORK, bodies.parts
    if bodies.changing:
        size, matrices, work = 4, _STORED + _CHANGING, _WORK_LU
        parts = [Part(whole, count, 2.0 * sum(part.entries for part in parts))]
    most = kept = cut = 0.0
    for part in sorted(parts, key=lambda part: -part.unknowns):
        factor, border = size * part.entries, size * part.touched**2
        stored = bodies.stored * part.unknowns / whole
        most = max(most, kept + (work + 1.0) * factor + 2 * border + _GIVEN * stored)
        kept += work * factor + border + _LEFT * stored
        cut = _STORED * stored  # the heap still has it when the last body is done
    solving = kept + cut + _DENSE * count**2 + _BLOCK * bodies.blocks
    return _LIBRARIES + matrices * bodies.stored + max(most, solving)


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
