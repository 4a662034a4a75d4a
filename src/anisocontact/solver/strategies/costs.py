"""Memory that factorisations take, and memory there is."""

from __future__ import annotations

import math
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
#: Entries of LDL^T of a body in space with c unknowns left to the end, those that can be touched:
#: `(20 - 167 n^(-1/3)) n^(4/3) + 1.6 c^2`, at least 8 n^(4/3). Separators of small bodies have less
#: around them. MUMPS, twelve bodies of hexahedra of orders 1 and 2, n = 3,000 to 37,000: within
#: 5 %; tetrahedra have 10 to 16 % less.
_LARGE, _SMALL, _LEAST, _BORDER = 20.0, 167.0, 8.0, 1.6
#: The same of a mesh of two dimensions, over n log2(n): 5.2 to 5.7.
_FLAT = 5.5
#: Factor of MUMPS with its workspace over the entries, beside copies of the border: LDL^T by blocks
#: (0.9 and 1.2 for two bodies of 22,500 and 36,963 unknowns), and LU.
_WORK, _WORK_LU = 1.15, 1.3
#: Bytes for each entry of a stiffness: a sparse matrix; what MUMPS is given, of which about half
#: stays in use; and what else Newton's method has where all of it changes.
_STORED, _GIVEN, _LEFT, _CHANGING = 12, 20, 6, 55
#: Bytes for each entry of the dense matrix of all contact unknowns: single precision, its factor
#: and what is eliminated of it.
_DENSE = 3 * 4
#: Libraries that are loaded when the first system is solved, bytes.
_LIBRARIES = 18e6
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


@dataclass(frozen=True)
class Condensable:
    """Bodies to be condensed.

    Attributes:
        parts: Unknowns of each body that are not prescribed, and those that can be touched.
        stored: Entries of the stiffness of all.
        flat: Whether their mesh has two dimensions.
        changing: Whether they are not linear: one LU of all in single precision then, else LDL^T of
            one after the other in double precision.
    """

    parts: Sequence[tuple[int, int]]
    stored: float
    flat: bool = False
    changing: bool = False


def condensing_bytes(bodies: Condensable) -> float:
    """Most memory that a run takes to condense bodies and to solve for what is touched, bytes.

    It is that in which MUMPS has a front on its stack and a copy of its factor. Measured on linear
    blocks on blocks and sheets of 20,000 to 80,000 unknowns, in space and in the plane, and on one
    at finite strain: within 5 % of what they take, within 10 % below 10,000 unknowns; where a body
    is condensed anew while the run goes on, up to a quarter more is taken.

    Args:
        bodies: What is to be condensed.

    Example:
        >>> pair = Condensable([(36963, 1323), (22500, 1875)], stored=4.6e6)
        >>> f"{condensing_bytes(pair) / 1e6:.0f} MB"
        '642 MB'
    """
    count = sum(touched for _, touched in bodies.parts)
    whole = max(sum(unknowns for unknowns, _ in bodies.parts), 1)
    factors = [(n, _factor_entries(n, c, bodies.flat), c) for n, c in bodies.parts]
    size, matrices, work = 8, _STORED, _WORK
    if bodies.changing:
        size, matrices, work = 4, _STORED + _CHANGING, _WORK_LU
        factors = [(whole, 2.0 * sum(entries for _, entries, _ in factors), count)]
    most = kept = 0.0
    for n, entries, c in sorted(factors, reverse=True):
        factor, border, stored = size * entries, size * c**2, bodies.stored * n / whole
        most = max(most, kept + (work + 1.0) * factor + 2 * border + _GIVEN * stored)
        kept += work * factor + border + _LEFT * stored
    return _LIBRARIES + matrices * bodies.stored + max(most, kept + _DENSE * count**2)


def _factor_entries(unknowns: int, touched: int, flat: bool) -> float:
    """Entries of LDL^T of a body, see `Condensable`."""
    if flat:
        return float(_FLAT * unknowns * math.log2(max(unknowns, 2)))
    each = max(_LARGE - _SMALL * float(max(unknowns, 1)) ** (-1.0 / 3.0), _LEAST)
    return float(each * _n43(unknowns) + _BORDER * touched**2)


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
