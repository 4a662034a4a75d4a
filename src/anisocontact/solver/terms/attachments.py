"""The elastic supports and springs of a problem, as one."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.errors import InputError
from anisocontact.base.load_curve import history_of
from anisocontact.mesh import Model
from anisocontact.solver.terms.attached import ElasticSupport, Spring
from anisocontact.solver.terms.step import AXES, Step
from anisocontact.solver.terms.term import TermGroup


class Attachments(TermGroup):
    """The elastic supports and springs of a problem, as one.

    Args:
        specs: What there is.
        model: Mesh with named facets.

    Attributes:
        coupling: Whether there are springs, which couple nodes that share no cell.
        supports: The elastic supports.
        supported: Their facet groups.

    Raises:
        InputError: An unknown facet group, or two of one name.
    """

    def __init__(self, specs: Sequence[ElasticSupport | Spring], model: Model) -> None:
        self._all = [spec.on(model) for spec in specs]
        super().__init__(self._all)
        springs = [spec for spec in specs if isinstance(spec, Spring)]
        self.supported = [spec.group for spec in specs if isinstance(spec, ElasticSupport)]
        self.supports = TermGroup([one for one in self._all if one.name in self.supported])
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
                    text = f"{history_of(value)} given, the spring has no stiffness along {axis}"
                    raise InputError(text, f"{place}.{name}.{axis}")

    @property
    def nodes(self) -> Locals:
        """Local nodes of the bodies that they act on."""
        return np.concatenate([np.zeros(0, dtype=np.int32), *(one.nodes for one in self._all)])

    def reactions(self, u: Floats, trial: bool) -> dict[str, Floats]:
        """Force of each on the bodies, by facet group of a support or name of a spring, (3,).

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            trial: Whether this is a trial at the load factor of now; else the accepted state.
        """
        return {one.name: one.reaction(u, trial) for one in self._all}

    def way(self) -> float:
        """Farthest that one of them can carry what it holds from the accepted state on, length.

        Its anchor has moved by so much since, or it was stretched by so much and lets go.
        """
        return max((one.way() for one in self._all), default=0.0)
