"""The elastic supports and springs of a problem, as one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Mat
from anisocontact.contact.transfer import Couplings
from anisocontact.mesh import Model
from anisocontact.solver.stepping.steps import AXES, Step
from anisocontact.solver.terms.attached import Anchored, Attached, ElasticSupport, Spring

Floats = npt.NDArray[np.float64]


class Attachments:
    """The elastic supports and springs of a problem, as one.

    Args:
        specs: What there is.
        model: Mesh with named facets.

    Attributes:
        coupling: Whether there are springs, which couple nodes that share no cell.

    Raises:
        InputError: An unknown facet group, or two of one name.
    """

    def __init__(self, specs: Sequence[ElasticSupport | Spring], model: Model) -> None:
        self._all: list[Attached] = []
        self._springs: list[Anchored] = []
        for spec in specs:
            if isinstance(spec, Spring):
                spring = spec.on(model)
                self._springs.append(spring)
                self._all.append(spring)
            else:
                self._all.append(spec.on(model))
        springs = [spec for spec in specs if isinstance(spec, Spring)]
        self._anchored = {one.name: one.stiffness for one in springs if one.to is None}
        self.coupling = bool(springs)
        #: Their names.
        self.names = [one.name for one in self._all]
        for name in self.names:
            if self.names.count(name) > 1:
                raise InputError(f"two elastic supports or springs have the name {name!r}")

    def check(self, step: Step) -> None:
        """Refuse the anchor of a spring that is not there, or that it does not feel.

        Raises:
            InputError: Names the springs there are, or the axis without stiffness.
        """
        for name, values in step.anchor.items():
            place = f"step {step.name!r}.anchor"
            if name not in self._anchored:
                known = ", ".join(self._anchored) or "none"
                raise InputError(f"no spring {name!r} to ground; there are: {known}", place)
            stiffness = dict(zip(AXES, self._anchored[name], strict=True))
            for axis, value in values.items():
                if value and not stiffness[axis]:
                    text = f"{value:g} given, the spring has no stiffness along {axis}"
                    raise InputError(text, f"{place}.{name}.{axis}")

    def begin(self, step: Step) -> None:
        """Take over a step."""
        for one in self._all:
            one.begin(step)

    def set_level(self, fraction: float) -> None:
        """Go to a fraction of the step."""
        for one in self._all:
            one.set_level(fraction)

    def add_force(self, u: Floats, out: Floats) -> None:
        """Add the forces on the bodies at the displacement `u`, both (local nodes, 3)."""
        for one in self._all:
            one.add_force(u, out)

    def add_tangent(self, matrix: Mat) -> None:
        """Add the part of `-d force / d u` that lies in the pattern of the bodies."""
        for one in self._all:
            one.add_tangent(matrix)

    def couplings(self) -> list[Couplings]:
        """The other part of `-d force / d u`."""
        return [found for one in self._all for found in one.couplings()]

    def blocks(self) -> list[Couplings]:
        """All of `-d force / d u`."""
        return [found for one in self._all for found in one.blocks()]

    @property
    def nodes(self) -> npt.NDArray[np.int32]:
        """Local nodes of the bodies that they act on."""
        return np.concatenate([np.zeros(0, dtype=np.int32), *(one.nodes for one in self._all)])

    def energy(self, u: Floats) -> float:
        """Stored energy, over all ranks, force times length."""
        return sum(one.energy(u) for one in self._all)

    def reactions(self, u: Floats) -> dict[str, Floats]:
        """Force of each on the bodies, by facet group of a support or name of a spring, (3,)."""
        return {one.name: one.reaction(u) for one in self._all}

    def way(self) -> float:
        """Farthest that one of them can lead what it holds from the accepted state on, length.

        Its anchor has moved by so much since, or it was stretched by so much and lets go.
        """
        return max((one.way() for one in self._all), default=0.0)

    def commit(self, u: Floats) -> float:
        """Accept a state; the work at the anchors since the last one (trapezoidal rule)."""
        return sum(one.commit(u) for one in self._all)

    def persistent(self) -> Floats:
        """Anchor and force of every spring in the accepted state, (springs, 2, 3)."""
        return np.array([spring.accepted for spring in self._springs]).reshape(-1, 2, 3)

    def restore(self, kept: Floats) -> None:
        """Go on from what `persistent` gave."""
        for spring, accepted in zip(self._springs, kept, strict=True):
            spring.accepted = accepted.copy()

    def __bool__(self) -> bool:
        return bool(self._all)
