"""What the residuals of Newton's method say of whether to go on."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.fenicsx import PETSc
from anisocontact.solver.terms.contacts import Contacts

#: Residual over its smallest value at which an iteration is given up.
DIVERGED = 1e8
#: A line search whose residual keeps more than this share of itself over so many corrections
#: stands in front of a jump of the law, and would stay there.
STUCK, STUCK_OVER = 0.5, 8
#: With multipliers that follow a residual rises and falls while points find their status; it goes
#: round in circles where the least of so many is more than this share of the least before, while
#: no more points touch than before. Where none does bodies bend far; where ever fewer do they part.
#: With penalties of slender bodies forces balance before the points have their status, as gaps
#: count for next to nothing: what multipliers violate has to stay as well.
IDLE, IDLE_OVER = 0.5, 5
#: Share of the least residual so far that one which has come nearer keeps at most.
NEARER = 0.95
#: Corrections after which only a residual that falls is waited for.
PATIENCE = 25
#: Residuals that repeat every second time, to this share of them, are those of a cycle; so are
#: such as repeat after some more, up to the longest, three times with as many points in contact.
CYCLE, SAME = 5, 1e-3
LONGEST, TIMES = 6, 3


class ResidualHistory:
    """Residuals of one solution, with the contacts at each of them.

    Args:
        contacts: The contacts, whose multipliers may follow every correction.
        patience: Corrections after which only a residual that falls is waited for.

    Attributes:
        residuals: Residual over the forces at work, of the start and after each correction.
        violations: Norm of the same with the forces that are to take away what multipliers violate.
    """

    def __init__(self, contacts: Contacts, patience: float = PATIENCE) -> None:
        self._patience = patience
        self.residuals: list[float] = []
        self.violations: list[float] = []
        self._contacts = contacts
        self._begin, self._singly = 0, False
        self._touching: list[int] = []
        self._sticking: list[int] = []

    def divergence(self, searching: bool, damped: bool) -> PETSc.SNES.ConvergedReason | None:
        """Why no equilibrium can be expected any more; None where it can. Asked at each residual.

        Where corrections have gained too little they close one point at a time, and begin to count.

        Args:
            searching: Whether there is a line search.
            damped: Whether corrections are taken in shares.
        """
        reasons = PETSc.SNES.ConvergedReason
        self._touching.append(self._contacts.touching())
        self._sticking.append(self._contacts.sticking())
        if self.residuals[-1] > DIVERGED * min(self.residuals[1:], default=np.inf):
            return reasons.DIVERGED_DTOL
        if self._idles():
            sticks = max(self._sticking[-IDLE_OVER:]) > 0
            if not self._singly and self._few_touch() and self._contacts.close_singly(sticks):
                self._begin, self._singly = len(self.residuals) - 1, True
                return None
            return reasons.DIVERGED_LOCAL_MIN
        if not (searching or damped) and self._cycles():
            return reasons.DIVERGED_MAX_IT
        spent = len(self.residuals) - self._begin
        if spent > self._patience and not (self._falls() or self._moves_on()):
            return reasons.DIVERGED_MAX_IT
        return reasons.DIVERGED_LINE_SEARCH if searching and self._stuck() else None

    def _few_touch(self) -> bool:
        """Whether some points touched all the time, no more than corrections are waited for."""
        lately = self._touching[-IDLE_OVER:]
        return min(lately) > 0 and max(lately) <= self._patience

    def _idles(self) -> bool:
        """Whether the last corrections, with multipliers that follow, have gained too little."""
        if not self._contacts.simultaneous:
            return False
        if self._singly:
            # the residual is that of other points each time; without any the body has sprung away
            return self._touching[-1] == 0 or self._cycles()
        known, touching = self.residuals, self._touching
        if len(known) < IDLE_OVER + 3:
            return False
        before, lately = max(touching[1:-IDLE_OVER]), max(touching[-IDLE_OVER:])
        searches = lately > before or self._slips_on() or lately == 0
        if searches or self._falls() or self._recedes() or self._comes_nearer():
            return False
        return _keeps(known) and not (self._contacts.faint and not _keeps(self.violations))

    def _falls(self) -> bool:
        """Whether it falls with every correction, and by half over some.

        So it does where the edge of a contact runs along a slender body, which bends: by a point in
        each correction, as what opens next hangs on what has opened.
        """
        known = self.residuals
        halved = len(known) > STUCK_OVER and known[-1] <= STUCK * known[-1 - STUCK_OVER]
        return bool(halved and np.all(np.diff(known[-IDLE_OVER - 1 :]) < 0.0))

    def _comes_nearer(self) -> bool:
        """Whether each of the last corrections has brought forces nearer to balance than before.

        So it does where an edge of what sticks runs along a body while points behind it change to
        and fro: in circles it would have to come back.
        """
        known = np.array(self.residuals[-IDLE_OVER - 1 :])
        nearer = bool(np.all(known[1:] < NEARER * known[:-1]))
        return nearer and known[-1] < min(self.residuals[1:-1])

    def _recedes(self) -> bool:
        """Whether ever fewer points touch and the residual falls, by half over the last ones.

        As a contact recedes it rises first: the first correction has balanced forces with points
        that are to open. Bodies that part for good have no residual that falls.
        """
        fewer = np.diff(self._touching[-IDLE_OVER:])
        lately = np.array(self.residuals[-IDLE_OVER:])
        falls = bool(np.all(np.diff(lately) < 0.0)) and lately[-1] <= STUCK * lately[0]
        return bool(falls and np.all(fewer <= 0))

    def _slips_on(self) -> bool:
        """Whether the edge of what sticks moves on, by a point in nearly every correction.

        Or now and then by more than it comes back, with a smaller residual than ever.
        """
        change = np.diff(self._sticking[-IDLE_OVER - 1 :])
        steadily = bool(np.all(change <= 0) and np.sum(change < 0) >= IDLE_OVER - 2)
        return steadily or (_fewer(self._sticking[1:]) and self._nearer())

    def _moves_on(self) -> bool:
        """Whether fewer or more points touch or fewer stick than ever, with the least residual.

        So it is where the edge of a contact runs along a slender body, or that of what sticks along
        a long contact, by some points in a correction or two: a residual that rises and falls tells
        it from a cycle by its least alone.
        """
        if len(self.residuals) <= 2 * IDLE_OVER:
            return False
        touching = self._touching[1:]
        farther = _fewer(touching) or _fewer([-n for n in touching]) or _fewer(self._sticking[1:])
        return farther and self._nearer()

    def _nearer(self) -> bool:
        """Whether one of the last residuals is smaller than all before."""
        known = self.residuals[1:]
        return min(known[-IDLE_OVER:]) < NEARER * min(known[:-IDLE_OVER])

    def _cycles(self) -> bool:
        """Whether full steps go round a few states: nothing will end that."""
        if len(self.residuals) >= CYCLE and repeats(self.residuals[-CYCLE:]):
            return True
        return any(self._repeats_after(period) for period in range(CYCLE - 2, LONGEST + 1))

    def _repeats_after(self, period: int) -> bool:
        """Whether residuals and numbers of points that touch and stick are those before again."""
        count = TIMES * period
        if len(self.residuals) < count or not repeats(self.residuals[-count:], period):
            return False
        counts = np.array([self._touching[-count:], self._sticking[-count:]])
        return bool(np.all(counts[:, period:] == counts[:, :-period]))

    def _stuck(self) -> bool:
        """Whether a line search gains next to nothing."""
        known = self.residuals
        return len(known) > STUCK_OVER and known[-1] > STUCK * known[-1 - STUCK_OVER]


def _keeps(known: Sequence[float]) -> bool:
    """Whether the least of the last norms is more than a share of the least before."""
    return min(known[-IDLE_OVER:]) > IDLE * min(known[1:-IDLE_OVER])


def _fewer(counts: Sequence[int]) -> bool:
    """Whether one of the last numbers of points is smaller than all before."""
    return min(counts[-IDLE_OVER:]) < min(counts[:-IDLE_OVER])


def repeats(residuals: Sequence[float], period: int = 2) -> bool:
    """Whether each of some residuals is the one a period before it, to `SAME` of it.

    Args:
        residuals: The residuals.
        period: After how many corrections; the last but one if left out.

    Example:
        >>> repeats([0.3, 0.2, 0.3, 0.2]), repeats([0.3, 0.2, 0.3, 0.19])
        (True, False)
    """
    last = np.array(residuals)
    with np.errstate(invalid="ignore"):  # far off they are infinite
        return bool(np.all(np.abs(last[period:] - last[:-period]) <= SAME * last[period:]))
