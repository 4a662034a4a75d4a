"""Bodies with motions that neither supports nor springs hold."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NoReturn

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.contact import Contact, facet_size
from anisocontact.mesh import Model
from anisocontact.solver.terms.attachments import Attachments
from anisocontact.solver.terms.free_body import FreeBody
from anisocontact.solver.terms.free_modes import (
    ConnectedBody,
    Supported,
    SupportedFrame,
    bodies,
    free_modes,
    joined,
    named,
    sides_of,
)
from anisocontact.solver.terms.holding import NOTHING, stiffness, unsupported, work

#: Sizes of a body by which the loads may carry it on its springs: beyond, contact is to hold it, or
#: where there is none the springs count as none.
FAR, LOST = 2.0, 100.0


class UnsupportedBodies:
    """Finds what a step leaves without support.

    Args:
        model: Mesh of the bodies.
        contacts: The contacts.
        scale: Mean diagonal of the stiffness of the bulk, force/length.
        attached: Springs and elastic supports; none if left out.
        sprung: Bodies that they act on.
        coupled: Facet groups that move together, a few each.
    """

    def __init__(
        self,
        model: Model,
        contacts: Sequence[Contact],
        scale: float,
        attached: Attachments | None,
        sprung: Iterable[str],
        coupled: Sequence[Sequence[str]],
    ) -> None:
        self._model, self._sprung = model, set(sprung)
        self._comm, self._least = model.mesh.comm, NOTHING * scale
        self._bodies = bodies(model, coupled)
        self._joined = joined(model, contacts, coupled)
        self._contacts = _contacts_of(self._bodies, contacts)
        self._contacts |= _contacts_of(self._joined, contacts)
        shape = np.shape(model.space.tabulate_dof_coordinates())
        self._springs, self._joined_springs = (
            np.zeros((6 * len(group), 6 * len(group)))
            if attached is None or not attached
            else stiffness(attached, group, shape, self._comm)
            for group in (self._bodies, self._joined)
        )

    def found(
        self,
        supported: Sequence[Supported],
        step: str,
        load: Floats | None,
        frames: Sequence[SupportedFrame],
    ) -> Iterator[FreeBody]:
        """Bodies that only contact can hold.

        Args:
            supported: Nodes and directions that are held.
            step: Name of the step.
            load: Forces at its end, contributions of this rank to the local nodes, (nodes, 3);
                springs are weighed against them.
            frames: What is held of faces that follow rigid bodies.

        Raises:
            InputError: A body is free and nothing can hold it.
        """
        free = [free_modes(body, supported, self._comm, frames) for body in self._joined]
        for far in (np.inf, LOST):
            loose = self._unsupported(self._joined, free, self._joined_springs, load, far)
            for body, modes in zip(self._joined, loose, strict=True):
                if len(modes):
                    self._refuse(body, named(modes), step, weak=far == LOST)
        free = [free_modes(body, supported, self._comm, frames) for body in self._bodies]
        loose = self._unsupported(self._bodies, free, self._springs, load, FAR)
        for i, (body, modes) in enumerate(zip(self._bodies, loose, strict=True)):
            if len(modes) and self._contacts[body]:
                own = self._springs[6 * i : 6 * i + 6, 6 * i : 6 * i + 6]
                yield self._free(body, modes, free[i], own, frames)

    def _free(
        self,
        body: ConnectedBody,
        left: Floats,
        motions: Floats,
        springs: Floats,
        frames: Sequence[SupportedFrame],
    ) -> FreeBody:
        contacts = self._contacts[body]
        size = min(facet_size(self._model, c.slave) for c in contacts)
        led = any([len(frame.rows(body, self._comm)) > 0 for frame in frames])
        weighed = led or bool(self._sprung & set(body.parts))
        sprung = motions @ springs @ motions.T if weighed else None
        return FreeBody(body, named(left), contacts, size, motions, left, sprung, self._least)

    def _unsupported(
        self,
        group: list[ConnectedBody],
        free: list[Floats],
        springs: Floats,
        load: Floats | None,
        far: float,
    ) -> list[Floats]:
        """Motions of bodies that neither supports nor springs hold, see `unsupported`."""
        if not springs.any():
            return free
        force = np.zeros(len(springs))
        if load is not None:
            force = self._comm.allreduce(work(group, load))
        return unsupported(group, free, springs, force, self._least, far)

    def _refuse(self, body: ConnectedBody, modes: str, step: str, weak: bool) -> NoReturn:
        several = len(body.parts) > 1
        if not self._contacts[body]:
            why = "it is in no contact"
        elif several:
            why = "its parts touch nothing but each other"
        else:
            why = "it touches nothing but itself"
        if weak:
            why += (
                f", and its springs give way to the loads by more than {LOST:g} times its size: it"
            )
        elif self._sprung & set(body.parts):
            why += ", and its springs do not hold that: it"
        else:
            why += ", it" if several else " and"
        text = f"body {body.name!r} is free to move: {modes}; {why} needs a support"
        raise InputError(text, f"step {step!r}")


def _contacts_of(
    bodies: Sequence[ConnectedBody], contacts: Sequence[Contact]
) -> dict[ConnectedBody, list[Contact]]:
    """Contacts of each of some bodies that share no nodes; collective."""
    return {
        body: [one for one, sides in zip(contacts, of, strict=True) if any(sides)]
        for body, of in zip(bodies, sides_of(bodies, contacts), strict=True)
    }
