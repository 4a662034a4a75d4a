"""Boundary conditions of one rigid body: components of its motion, loads on the others."""

from __future__ import annotations

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.rigid import COMPONENTS, RigidBody
from anisocontact.rigid.body import component_number
from anisocontact.solver.terms.prescribed_components import PrescribedComponents
from anisocontact.solver.terms.step import Step
from anisocontact.solver.terms.turn import Turn

#: Places along a step at which the pace of a rotation is looked at.
_PLACES = 64
#: Share of a load by which it may change along a step and still counts as one that stays.
FAINT = 0.01


def check_known(step: Step, names: list[str]) -> None:
    """Refuse motions and loads of rigid bodies that are not there.

    Args:
        step: What prescribes them.
        names: Of the bodies that are.

    Raises:
        InputError: Names the body.
    """
    given = (("motion", step.motion), ("load", step.load), ("rotation", step.turned_bodies()))
    for what, bodies in given:
        for name in bodies:
            if name not in names:
                raise InputError(
                    f"no contact has a rigid body {name!r}, allowed: {', '.join(names) or 'none'}",
                    f"step {step.name!r}.{what}",
                )


class RigidBoundaryConditions:
    """Motion and loads of one rigid body along the steps; at first all components are held.

    Attributes:
        prescribed: Which components are prescribed, (6,).
    """

    def __init__(self, body: RigidBody) -> None:
        self._body = body
        self.prescribed = np.ones(6, dtype=bool)
        self._turn: Turn | None = None
        self._motion, self._load = PrescribedComponents(6), PrescribedComponents(6)

    def begin(self, step: Step, values: Floats, reaction: Floats) -> None:
        """Take over a step; what it does not name stays where it is.

        Args:
            step: The step.
            values: Translation and turn at its beginning, (6,).
            reaction: Force and moment of the supports at its beginning, (6,). What is freed
                begins with that, and it goes to the load that is given, or to zero.

        Raises:
            InputError: A component is unknown, is freed though the body is not free, or is loaded
                though it is held.
        """
        was_prescribed = self.prescribed.copy()
        self._motion.begin(step.duration, values)
        self._turn = step.rotation.get(self._body.name)
        if self._turn is not None:
            self.prescribed[:] = True
        self._take_motion(step)
        loads, freed = self._load.end, was_prescribed & ~self.prescribed
        start = np.where(self.prescribed, 0.0, np.where(freed, reaction, loads))
        self._load.begin(step.duration, start)
        for i in np.flatnonzero(freed):
            self._load.prescribe(int(i), float(loads[i]))
        self._take_load(step)

    def values(self, fraction: float) -> Floats:
        """Translation and turn at a fraction of the step where they are prescribed, (6,)."""
        if self._turn is not None:
            place = self._body.reference + self._motion.start[:3]
            moved = self._turn.path(place[None], fraction)[0] - place
            change = np.concatenate([moved, self._turn.share(fraction) * self._turn.vector])
            return np.asarray(self._motion.start + change)
        return np.where(self.prescribed, self._motion.at(fraction), 0.0)

    def stop(self, fraction: float) -> None:
        """End the step at a fraction of it: loads stay as they are there."""
        self._load.stop(fraction)

    @property
    def rests(self) -> bool:
        """Whether no motion is prescribed along the step."""
        return self._turn is None and self._motion.rests

    def load_rests(self, scale: Floats) -> bool:
        """Whether the load stays as it is along the step, but for a share `FAINT` of it.

        A component that is let go begins with what held it, next to nothing where nothing pushed.

        Args:
            scale: What turns are taken for lengths by, 1 for translations, (6,).
        """
        if self._load.varies:
            return self._load.rests
        start, end = self._load.start / scale, self._load.end / scale
        size = max(np.linalg.norm(start), np.linalg.norm(end))
        return bool(np.linalg.norm(end - start) <= FAINT * size)

    @property
    def last_load(self) -> Floats:
        """Loads at the end of the step, from which the next one goes on, (6,)."""
        return self._load.end

    @last_load.setter
    def last_load(self, values: Floats) -> None:
        self._load.end = values.copy()

    def largest_turn(self) -> float:
        """Rotation along the step where it is prescribed, at its fastest pace, radian."""
        places = _PLACES if self._motion.varies else 1
        turns = np.array([self.values(k / places)[3:] for k in range(places + 1)])
        return places * float(np.linalg.norm(np.diff(turns, axis=0), axis=1).max())

    def load(self, fraction: float) -> Floats:
        """Force and moment at a fraction of the step, (6,)."""
        return self._load.at(fraction)

    def _take_motion(self, step: Step) -> None:
        name = self._body.name
        for component, given in step.motion.get(name, {}).items():
            where = f"step {step.name!r}.motion.{name}.{component}"
            i = component_number(component, where)
            if given is None and not self._body.free:
                raise InputError("the rigid body was not made free", where)
            self.prescribed[i] = given is not None
            self._motion.prescribe(i, 0.0 if given is None else given)

    def _take_load(self, step: Step) -> None:
        name = self._body.name
        for component, value in step.load.get(name, {}).items():
            where = f"step {step.name!r}.load.{name}.{component}"
            i = component_number(component, where)
            if self.prescribed[i]:
                raise InputError(
                    f"{COMPONENTS[i]} is fixed; a load acts on a component that motion frees",
                    where,
                )
            self._load.prescribe(i, value)
