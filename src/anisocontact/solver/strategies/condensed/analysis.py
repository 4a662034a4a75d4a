"""What a factor will take, before it is made: MUMPS' analysis, of nodes instead of unknowns."""

from __future__ import annotations

import ctypes

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.array_types import Flags, Ints
from anisocontact.base.fenicsx import Mat, PETSc
from anisocontact.base.petsc_calls import call_petsc
from anisocontact.solver.strategies.condensed.factor import aij
from anisocontact.solver.strategies.condensed.mumps import reachable, unfactorised

#: MUMPS: what its analysis expects, entries of the factor, in millions where negative, and
#: floating-point operations.
_ENTRIES, _WORK = 20, 1
#: Operations of LU of a block of n unknowns over n^2, where nobody tells: MUMPS, 35 to 40.
_OPERATIONS = 37.0
#: Entries of a factor, beside its border, over those of `_typical`, at most: rods, sheets and cubes
#: of hexahedra and tetrahedra, of both orders, up to 89,000 unknowns, have 0.4 to 2.1 in all.
_MOST = 4.0
#: More than PETSc's `MatFactorInfo` has.
_INFO = ctypes.c_double * 32


def node_graph(stiffness: Mat) -> scipy.sparse.csr_array:
    """Which nodes a stiffness couples, an entry for each block of 3 x 3, (nodes, nodes)."""
    starts, columns = stiffness.getRowIJ()
    rows = scipy.sparse.csr_array((_ones(columns), columns, starts), shape=stiffness.getSize())
    return rows[::3][:, ::3].tocsr().astype(np.float64)


def _ones(entries: Ints) -> npt.NDArray[np.int8]:
    return np.ones(len(entries), dtype=np.int8)


def factor_entries(graph: scipy.sparse.csr_array, border: Flags, unknowns: int) -> float:
    """Entries of LDL^T of a body, those of its border last.

    METIS orders nodes: as their unknowns are alike, a factor has as many entries as that of the
    graph, times the square of the unknowns of a node. Blocks, sheets and a ball of hexahedra and
    tetrahedra of 7,000 to 33,000 unknowns: within 4 %, smaller ones 11 %, in a third of the time.

    Args:
        graph: Which of its nodes are coupled, (n, n).
        border: Nodes that can be touched, (n,).
        unknowns: Unknowns of all nodes that are not prescribed.
    """
    count = graph.shape[0]
    if border.all():
        return float(0.5 * unknowns**2)
    each = unknowns / count
    if not reachable():
        return _typical(unknowns) + 0.5 * float(each * np.count_nonzero(border)) ** 2
    entries, _ = _expected(graph, border)
    return float(each**2 * entries)


def most_entries(border: int, unknowns: int) -> float:
    """More entries than LDL^T of a body has, without an analysis.

    Args:
        border: Unknowns that can be touched.
        unknowns: All of them that are not prescribed.
    """
    return _MOST * _typical(unknowns) + 0.5 * float(border) ** 2


def whole_factor(graph: scipy.sparse.csr_array, unknowns: int) -> tuple[float, float]:
    """Entries of LU of a whole system and floating-point operations for it.

    Args:
        graph: Which nodes are coupled, (n, n).
        unknowns: Unknowns of all nodes.
    """
    if not reachable():
        return 2.0 * _typical(unknowns), _OPERATIONS * float(unknowns) ** 2
    each = unknowns / graph.shape[0]
    entries, operations = _expected(graph, np.zeros(graph.shape[0], dtype=np.bool_))
    return 2.0 * each**2 * entries, 2.0 * each**3 * operations


def _expected(graph: scipy.sparse.csr_array, border: Flags) -> tuple[float, float]:
    """Entries of LDL^T of a graph, and operations, as MUMPS expects them."""
    given, order = aij(graph), PETSc.IS().createStride(graph.shape[0], comm=PETSc.COMM_SELF)
    pc, factor = unfactorised(given, np.flatnonzero(border) if border.any() else np.array([0]))
    call_petsc("MatCholeskyFactorSymbolic", factor, given, order, ctypes.byref(_INFO()))
    entries = float(factor.getMumpsInfog(_ENTRIES))
    operations = float(factor.getMumpsRinfog(_WORK))
    for used in (pc, given, order):
        used.destroy()
    return entries if entries >= 0.0 else -1e6 * entries, operations


def _typical(unknowns: float) -> float:
    """Entries of LDL^T of blocks of hexahedra, where nobody tells."""
    return float(20.0 * unknowns ** (4.0 / 3.0))
