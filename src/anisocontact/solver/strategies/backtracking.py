"""Corrections with multipliers that follow: whole, or shorter where they would lead astray."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.fenicsx import Vec
from anisocontact.solver.strategies.system import System
from anisocontact.solver.terms.contacts import Contacts, Marks

#: Residuals of which a correction must not exceed the largest: while points find their status it
#: rises now and then.
MEMORY = 3
#: Least share of a correction that is tried.
LEAST = 1.0 / 32.0
#: Share from which on a shorter correction is worth it while points keep their status.
HALF = 0.5


@dataclass(frozen=True)
class Begun:
    """What a search asks of the state that a correction begins at.

    Attributes:
        norm: Size of its residual.
        touches: Whether anything touches there.
        statuses: Status of the slave points of this rank.
    """

    norm: float
    touches: bool
    statuses: Locals

    @classmethod
    def of(cls, system: System) -> Begun:
        """Of the state of the last evaluation; collective."""
        contacts = system.contact_term
        return cls(system.balance.norm, contacts.touch(), contacts.statuses())


class Backtracking:
    """A line search that lets the residual rise for a while [Grippo Lampariello Lucidi 1986].

    Displacements and multipliers take the same share of a correction. The first share is taken of
    1, 1/2, 1/4 ... of it with which the forces balance no worse than in one of the last states; a
    state without an answer never is. Where nothing touches yet any balance will do: bodies that
    bend far come to their contact through it. Neither does the balance count where less than half
    would be taken though the whole correction changes the status of no point: slender bodies, whose
    membrane forces rise for one correction, would creep. Where no share will do it is taken whole,
    if there is an answer: the active set may have to change at once. Where that would end all
    contact, the largest share is taken that does not, since nothing may hold a body there. Two
    whole corrections in turn that leave what `condensed` keeps in reach are no overshoot: the
    second is taken, so that it widens the reach, in place of halves that would creep towards its
    end.

    Args:
        system: What is solved.

    Attributes:
        whole: Whether any balance will do, as where bodies want their corrections in full.
    """

    def __init__(self, system: System) -> None:
        self._system, self.whole = system, False
        self._known: deque[float] = deque(maxlen=MEMORY)
        self._tried: tuple[Marks, Floats, Floats] | None = None
        self._left = False

    @property
    def _contacts(self) -> Contacts:
        return self._system.contact_term

    def begin(self) -> None:
        """Take it that another iteration begins."""
        self._known.clear()
        self._tried, self._left = None, False

    def share(
        self,
        x: Vec,
        correction: Vec,
        largest: float,
        begun: Begun | None = None,
        ends: Marks | None = None,
    ) -> float:
        """Share of a correction to take; the multipliers have taken it then.

        Args:
            x: Where the correction begins.
            correction: What is to be subtracted from it.
            largest: Largest share that may be taken.
            begun: What is asked of `x`; that of the last evaluation if left out.
            ends: Where multipliers are at the end of a correction, if that is not where they come
                to by one: with less than the largest share they go there from `x`.
        """
        contacts, share = self._contacts, largest
        contacts.damp_correction(share)
        if not contacts.retraceable:
            return share
        begun = Begun.of(self._system) if begun is None else begun
        free = self.whole or not begun.touches
        self._known.append(begun.norm)
        bound = np.inf if free else max(self._known)
        marks, before = contacts.marks(), begun.statuses
        answers, settled, touches = True, False, 0.0
        while share >= LEAST * largest:
            # a number that is none compares as false
            if self._norm_at(share, x, correction, ends if share == largest else None) <= bound:
                self._left = self._left and share < largest
                return share
            answered = bool(np.isfinite(self._system.balance.norm))
            if not touches and answered and contacts.touch():
                touches = share
            if share == largest:
                answers = answered
                settled = answers and contacts.same(before)
                left, self._left = self._left, self._system.outgrown
                if left and self._left:
                    return share
            contacts.go_back(marks)
            share *= 0.5
            if settled and share < HALF * largest:
                break
        share = (touches or largest) if answers else share
        self._norm_at(share, x, correction, ends if share == largest else None)
        return share

    def _norm_at(self, share: float, x: Vec, correction: Vec, ends: Marks | None) -> float:
        """Size of the residual where a share is taken, which the multipliers take as well."""
        contacts, there = self._contacts, x.duplicate()
        marks, part = contacts.marks(), correction.copy()
        contacts.damp_correction(share)
        if ends is not None:
            contacts.go_back(ends)
            contacts.damp_correction(0.0)
        part.scale(share)
        there.waxpy(-1.0, part, x)
        self._tried = marks, np.array(there.array_r), self._system.evaluate(there)
        contacts.damp_correction(share)
        return float(self._system.balance.norm)

    def evaluated(self, x: Vec) -> Floats | None:
        """The residual, if it was evaluated last here for a share; multipliers follow only once."""
        if self._tried is None:
            return None
        (marks, there, residual), self._tried = self._tried, None
        elsewhere = not np.array_equal(there, x.array_r)
        if x.comm.tompi4py().allreduce(int(elsewhere)) == 0:
            return residual
        self._contacts.go_back(marks)
        return None
