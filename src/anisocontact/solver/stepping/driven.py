"""Bodies that loads may drive along their contacts, and what loads they have."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact import Contact
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.free_modes import ConnectedBody, sides_of


@dataclass(frozen=True)
class Driven:
    """A body that loads may drive along its contacts, or several as one.

    Attributes:
        names: In words, of each.
        contacts: Its contacts, each with 1 where the body is the slave, and -1 where the master.
        centre: Point that moments are about, (3,), length.
        size: Of the body, length.
        motions: Translations and turns times the size that only contact can hold, (k, 6).
        load: Force and moment over the size, (6,), at the fraction that is looked at.
        before: The same in the accepted state.
        loads: Sums of `f_i (x - centre)_j` over them, and of `f_i`, at that fraction, (3, 4).
        loads_before: The same in the accepted state.
        rigid: Whether it is a rigid surface.
    """

    names: Sequence[str]
    contacts: Sequence[tuple[Contact, float]]
    centre: Floats
    size: float
    motions: Floats
    load: Floats
    before: Floats
    loads: Floats
    loads_before: Floats
    rigid: bool = False

    @property
    def name(self) -> str:
        """All its names."""
        return " and ".join(self.names)

    @property
    def parts(self) -> frozenset[str]:
        """Its names as a set."""
        return frozenset(self.names)


def driven(problem: Problem, fraction: float, now: float) -> list[Driven]:
    """Deformable bodies and rigid surfaces, loaded as at a fraction of the step and as now."""
    return [*deformable(problem, fraction, now), *_rigid(problem, fraction, now)]


def deformable(problem: Problem, fraction: float, now: float) -> Iterator[Driven]:
    """Deformable bodies that only contact holds, with those that lead their faces."""
    x, u = problem.model.space.tabulate_dof_coordinates(), problem.u.x.array.reshape(-1, 3)
    for free in problem.stabilisation.loose:
        body = free.body
        arms = (x + u)[body.nodes] - body.centre
        sums = []
        for at in (fraction, now):
            problem.loads.set_load_factor(at, problem.dt)
            force = problem.layout.assembled(problem.loads.force(u)).reshape(-1, 3)[body.nodes]
            local = np.column_stack([force.T @ arms, force.sum(axis=0)])
            sums.append(problem.comm.allreduce(local) + _leads(problem, body, at))
        problem.loads.set_load_factor(problem.load_factor, problem.dt)
        (sides,) = sides_of([body], free.contacts)
        yield Driven(
            [f"body {body.name!r}"],
            [
                (contact, 1.0 if slave else -1.0)
                for contact, (slave, *masters) in zip(free.contacts, sides, strict=True)
                if not (slave and any(masters))
            ],
            body.centre,
            body.size,
            free.left,
            wrench(sums[0], body.size),
            wrench(sums[1], body.size),
            *sums,
        )


def _leads(problem: Problem, body: ConnectedBody, fraction: float) -> Floats:
    """Loads on rigid bodies that faces of a body follow, as of `Driven.loads`."""
    total = np.zeros((3, 4))
    for rigid, faces in problem.rigid.coupled.items():
        if any([body.has(problem.model.nodes(face.group), problem.comm) for face in faces]):
            force, moment = np.split(problem.rigid.load(rigid, fraction), 2)
            total += _sums(force, moment, rigid.position - body.centre)
    return total


def _sums(force: Floats, moment: Floats, arm: Floats) -> Floats:
    """As of `Driven.loads`, of a force with this arm and of a couple."""
    couple = 0.5 * np.cross(moment, np.eye(3)).T
    return np.column_stack([couple + np.outer(force, arm), force])


def wrench(loads: Floats, size: float) -> Floats:
    """As of `Driven.load`, of its `loads`.

    Args:
        loads: Sums as of `Driven.loads`, (3, 4).
        size: Of the body, length.
    """
    turn = (loads[:, :3] - loads[:, :3].T)[[2, 0, 1], [1, 2, 0]]
    return np.concatenate([loads[:, 3], turn / size])


def _rigid(problem: Problem, fraction: float, now: float) -> Iterator[Driven]:
    """Rigid surfaces that loads drive."""
    for body in problem.rigid.free:
        free = ~problem.rigid.holds(body)
        contacts = problem.rigid.contacts[body]
        if not (contacts and free.any()) or problem.rigid.coupled[body]:
            continue
        size = problem.rigid.length_of_turns(body)
        scale = np.repeat([1.0, 1.0 / size], 3)
        loads = [problem.rigid.load(body, at) * scale for at in (fraction, now)]
        sums = [_sums(load[:3], load[3:] * size, np.zeros(3)) for load in loads]
        yield Driven(
            [f"rigid body {body.name!r}"],
            [(contact, -1.0) for contact in contacts],
            body.position,
            size,
            np.eye(6)[free],
            loads[0],
            loads[1],
            sums[0],
            sums[1],
            rigid=True,
        )
