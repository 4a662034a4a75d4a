"""What a factorisation of the whole system costs, from the number of unknowns."""

from __future__ import annotations

#: Bytes of an LU factorisation of N unknowns of bodies in space over N^(4/3), with its workspace,
#: measured on blocks of hexahedra; nested dissection [George 1973] has that power.
FACTOR_BYTES = 350.0


def factor_bytes(unknowns: int) -> float:
    """Memory that a factorisation needs, bytes.

    Args:
        unknowns: Number of unknowns N.
    """
    return float(FACTOR_BYTES * unknowns ** (4.0 / 3.0))
