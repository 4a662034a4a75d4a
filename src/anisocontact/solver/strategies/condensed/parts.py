"""The bulk cut into contact, prescribed and interior unknowns, each connected part by itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.solver.strategies.condensed.dense import blocks_times
from anisocontact.solver.strategies.condensed.eliminate import WholeBorder, chosen
from anisocontact.solver.strategies.condensed.factor import Eliminated


@dataclass(frozen=True)
class CondensedPart:
    """A connected part of the bulk with its interior eliminated.

    Attributes:
        free: Its unknowns that are not prescribed, increasing, (n,).
        border: Those of them that stay, numbers in the whole system, (c,).
        factor: Their Schur complement and solutions with the interior.
    """

    free: Ints
    border: Ints
    factor: Eliminated


class Condensation:
    """Schur complement of the bulk on its contact unknowns.

    With K cut into contact c, prescribed p and interior i, equilibrium of the interior leaves
    `S u_c = g + contact forces` with `S = K_cc - K_ci K_ii^-1 K_ic`, one block for each connected
    part. A part that nothing touches keeps one unknown. Parts whose unknowns are those of `before`
    are taken over from there.

    Args:
        stiffness: K, symmetric, (n, n).
        part_of: Connected part of each unknown, (n,).
        touched: Whether an unknown may be touched, (n,).
        prescribed: Whether it is prescribed, (n,); these are not contact unknowns.
        before: An earlier condensation of the same stiffness, which is used up.
        note: Called with a line for every factorisation.

    Attributes:
        contact: Numbers of the contact unknowns, part by part, (c,).
        prescribed: Numbers of the prescribed unknowns, increasing, (p,).
        blocks: Places among the contact unknowns and the block of S of each part.

    Raises:
        SingularError: An interior cannot be solved.
    """

    def __init__(
        self,
        stiffness: scipy.sparse.csr_array,
        part_of: Ints,
        touched: Flags,
        prescribed: Flags,
        before: Condensation | None = None,
        note: Callable[[str], None] = lambda _: None,
    ) -> None:
        self.stiffness = stiffness
        self.prescribed: Ints = np.flatnonzero(prescribed)
        self._note = note
        old: dict[int, CondensedPart] = {} if before is None else before._parts
        cuts: dict[int, tuple[Ints, Ints]] = {}
        for number in range(int(part_of.max()) + 1):
            free = np.flatnonzero((part_of == number) & ~prescribed)
            border = free[touched[free]]
            cuts[number] = free, border if len(border) else free[:1]
        made = {n: part for n, part in old.items() if _same(part, *cuts[n])}
        for number in old.keys() - made.keys():  # first of all: a new one needs their memory
            old.pop(number).factor.close()
        # the largest one first: while a part is factorised it needs most of its memory
        for number, (free, border) in sorted(cuts.items(), key=lambda part: -len(part[1][0])):
            if len(free) and number not in made:
                made[number] = self._part(free, border)
        self._parts: dict[int, CondensedPart] = dict(sorted(made.items()))
        parts = self._parts.values()
        self.contact: Ints = np.concatenate([np.zeros(0, np.int64), *(p.border for p in parts)])
        ends = np.cumsum([0, *(len(p.border) for p in parts)])
        self.blocks = [
            (slice(a, b), p.factor.schur) for a, b, p in zip(ends, ends[1:], parts, strict=False)
        ]

    def interior(self, forces: Floats) -> Floats:
        """Displacements of the interior under forces, all other unknowns held at zero.

        Args:
            forces: Forces on all unknowns, (n, k); those on other unknowns do not count.

        Returns:
            `K_ii^-1 f_i`, zero elsewhere, (n, k).
        """
        out = np.zeros(forces.shape)
        for part in self._parts.values():
            own = forces[part.free]
            loaded = np.flatnonzero(own.any(axis=0))
            if len(loaded):
                out[np.ix_(part.free, loaded)] = part.factor.interior(own[:, loaded])
        return out

    def schur_times(self, u: Floats) -> Floats:
        """`S u` for the contact unknowns, (c,)."""
        return blocks_times(self.blocks, u)

    def close(self) -> None:
        """Give back the memory of the factors."""
        for part in self._parts.values():
            part.factor.close()
        self._parts = {}

    def _part(self, free: Ints, border: Ints) -> CondensedPart:
        matrix = self.stiffness[free][:, free].tocsr()
        matrix.sort_indices()
        inside = np.searchsorted(free, border)
        if len(border) == len(free):
            return CondensedPart(free, border, WholeBorder(matrix.toarray()))
        name, way = chosen()
        self._note(
            f"condensing {len(free)} unknowns of a body on {len(border)} contact unknowns ({name})"
        )
        return CondensedPart(free, border, way(matrix, inside))


def _same(part: CondensedPart, free: Ints, border: Ints) -> bool:
    return np.array_equal(part.free, free) and np.array_equal(part.border, border)
