"""What a run reports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import by_place
from anisocontact.base.shown import shown
from anisocontact.interface.failed_point import FailedPoint
from anisocontact.solver.stepping.border_watch import WithoutSlip
from anisocontact.solver.stepping.moved_across import MovedAcross
from anisocontact.solver.stepping.rolling_watch import Stride
from anisocontact.solver.stepping.turned_faces import TurnedFace
from anisocontact.solver.system.culprit import Culprit
from anisocontact.solver.system.imbalance import Imbalance
from anisocontact.solver.system.rotations import BodyRotation
from anisocontact.solver.system.sides_kept import Behind


@dataclass(frozen=True)
class Progress:
    """A Newton iteration.

    Attributes:
        step: Name of the step.
        increment: Number of the increment in the step, from 1.
        iteration: Number of the iteration, from 0 (the start).
        residual: Residual over the forces at work, or over those whose rounding is a hundred
            millionth of them where next to none are.
        contacts: Number of "open", "stick" and "slip" points of each contact, by name.

    Example:
        >>> now = Progress("press", 1, 3, 1e-9, {"sole": {"open": 0, "stick": 9, "slip": 0}})
        >>> now.residual < 1e-8
        True
    """

    step: str
    increment: int
    iteration: int
    residual: float
    contacts: dict[str, dict[str, int]]


@dataclass(frozen=True, eq=False)
class Accepted:
    """An increment, or a sub-increment of it, that converged.

    Attributes:
        step: Name of the step.
        step_index: Number of the step, from 0.
        increment: Number of the increment in the step, from 1.
        done: Share of that increment that is done: below 1 where it was cut into sub-increments.
        time: Time that is reached.
        iterations: Newton iterations, with those of attempts that failed.
        residuals: Residual (out-of-balance force) over the forces at work, of the start and after
            each iteration of the attempt that converged.
        contacts: Number of "open", "stick" and "slip" points of each contact, by name.
        resultants: Force and moment about the origin on each slave, by name of the contact.
        reactions: Force of each support on the body, by facet group.
        energies: See `Problem.energies`.
        ran_off: Slave points that left the end of their master in it, by name of the contact, each
            (k, 3), length; contacts without any are left out.
        undetermined: Slave points that touch where supports hold both sides, by name of the
            contact; contacts without any are left out.
        turned: How far each body at small strain has turned, by name.
        imbalance: What is left open in the balance of energy.
        behind: Bodies of which a part lies behind their masters.
        past_cuts: Largest share of its weight by which a slave node has turned with a sector past
            the end of its master, by name of the contact; contacts without any are left out.
        relaxed: Whether penalties hold in it, as no multipliers were found.
        slivers: Slave nodes that touch on less than 5 % of their weight where penalties hold, by
            name of the contact; contacts without any are left out.
        rolled: How far rigid bodies that are free to turn have rolled in it, where that is past
            several slave nodes, by name of the contact.
        faces: Faces at small strain that have turned so far that their pressure has an arm which is
            not there, by name of the contact; contacts without any are left out.
        without_slip: Slave points that came to their master in it, or over its border, and carry
            no friction, by name of the contact; contacts without any are left out.
        crossed: How far bodies have gone through their planes of symmetry, by facet group, length.
        across: How far rigid bodies have moved across planes of symmetry where slaves touch them
            there, by name of the contact; contacts without any are left out.
        folded: Cells with a corner where `det F <= 0`, how many and where the first is, by body.
        unstable: Whether the equilibrium is not stable, as far as the strategy can tell.
        event: What has happened where an event ends the step here, in words.
        missed: What has not, where a step that waits for an event ends without it.

    Example:
        >>> from anisocontact.bulk import make_material
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> from anisocontact.solver import Problem, Solver, Step
        >>> model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 4), (1, 1, 1))})
        >>> problem = Problem(model, {"bar": make_material("linear-elastic", E=200.0, nu=0.0)})
        >>> held = {"bar.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}, "bar.top": {"z": 0.1}}
        >>> for found in Solver(problem, [Step("pull", 2, held)]).run():
        ...     force = found.reactions["bar.top"].round(6)
        ...     print(found.step, found.increment, found.time, force[2])
        pull 1 0.5 2.5
        pull 2 1.0 5.0
    """

    step: str
    step_index: int
    increment: int
    done: float
    time: float
    iterations: int
    residuals: list[float]
    contacts: dict[str, dict[str, int]]
    resultants: dict[str, tuple[Floats, Floats]]
    reactions: dict[str, Floats]
    energies: dict[str, float]
    ran_off: dict[str, Floats]
    undetermined: dict[str, int]
    turned: dict[str, BodyRotation]
    imbalance: Imbalance
    behind: tuple[Behind, ...] = ()
    past_cuts: dict[str, float] = field(default_factory=dict)
    relaxed: bool = False
    slivers: dict[str, int] = field(default_factory=dict)
    rolled: dict[str, Stride] = field(default_factory=dict)
    faces: dict[str, list[TurnedFace]] = field(default_factory=dict)
    without_slip: dict[str, WithoutSlip] = field(default_factory=dict)
    crossed: dict[str, float] = field(default_factory=dict)
    across: dict[str, list[MovedAcross]] = field(default_factory=dict)
    folded: dict[str, tuple[int, tuple[float, float, float]]] = field(default_factory=dict)
    unstable: bool = False
    event: str = ""
    missed: str = ""


@dataclass(frozen=True)
class Cut:
    """A cut-back: an increment that failed and is tried again in smaller sub-increments.

    Attributes:
        step: Name of the step.
        increment: Number of the increment in the step, from 1.
        time: Last accepted time.
        size: Share of the increment that was tried.
        next_size: Share that is tried next.
        reason: Why it failed.
        iterations: Newton iterations that were spent on it.
        count: How many places caused it, over all ranks.
        culprits: The first of them.

    Example:
        >>> print(Cut("drag", 3, 1.2, 1.0, 0.25, "the line search got stuck", 25, 0, ()))
        drag 3  cut from 1 to 0.25 of the increment after 25 iterations: the line search got stuck
    """

    step: str
    increment: int
    time: float
    size: float
    next_size: float
    reason: str
    iterations: int
    count: int
    culprits: tuple[Culprit, ...]

    def __str__(self) -> str:
        """One line."""
        return (
            f"{self.step} {self.increment}  cut from {self.size:.3g} to {self.next_size:.3g} of "
            f"the increment after {self.iterations} iterations: {self.reason}"
        )


class StoppedError(RuntimeError):
    """The run stopped before its end; what converged is kept.

    Args:
        step: Name of the step.
        increment: Number of the increment that failed.
        reason: Why, in a few words.
        culprits: The first places that caused it.
        points: Positions of all slave points at which the law failed, (n, 3), length.
        tried: What was tried, in a few words.

    Attributes:
        failed: A point at which the laws failed, whole, on the first rank that has one: its
            `evaluate` and `tangent_errors` say more, its `write` keeps it in a file.

    Example:
        >>> print(StoppedError("drag", 3, "no convergence in 25 Newton iterations"))
        step 'drag', increment 3: no convergence in 25 Newton iterations
    """

    failed: FailedPoint | None = None

    def __init__(
        self,
        step: str,
        increment: int,
        reason: str,
        culprits: Sequence[Culprit] = (),
        points: Floats | None = None,
        tried: str = "",
    ) -> None:
        self.points: Floats = np.zeros((0, 3)) if points is None else points
        where = ""
        if len(self.points):
            first = shown(self.points[by_place(self.points)[0]], 6)
            where = f"; {len(self.points)} slave points failed, the first at {first}"
        elif culprits and culprits[0].why not in reason:
            where = f"; {culprits[0]}"
        tried = f"; {tried}" if tried else ""
        super().__init__(f"step {step!r}, increment {increment}: {reason}{where}{tried}")
        self.step = step
        self.increment = increment
        self.reason = reason
        self.culprits = tuple(culprits)
