"""What a problem is composed of: its unknowns, its bodies and what holds them."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any, override

import numpy as np

from anisocontact.base.array_types import Ints
from anisocontact.bulk import LinearBulk, NonlinearBulk
from anisocontact.bulk.followed_pressures import FollowedPressures
from anisocontact.mesh import Model
from anisocontact.solver.system.reported import ReportedSystem
from anisocontact.solver.terms.constraints import Constraints
from anisocontact.solver.terms.rigid import RigidBodies
from anisocontact.solver.terms.supports import Supports


class ComposedSystem(ReportedSystem):
    """A system that says which unknowns, bodies and supports it has.

    Attributes:
        model: Mesh with named bodies and facets.
        bulk: Forces inside the bodies.
        rigid: Rigid bodies of the contacts.
        supports: What is prescribed.
        constraints: What follows from other unknowns.
    """

    model: Model
    bulk: LinearBulk | NonlinearBulk
    rigid: RigidBodies
    supports: Supports
    constraints: Constraints

    @property
    def unknowns(self) -> int:
        """Number of unknowns over all ranks."""
        return int(self._accepted.x.getSize())

    @property
    def solved_for(self) -> int:
        """Number of unknowns over all ranks that do not follow from those of rigid bodies."""
        local = 0 if self.rigid.faces is None else len(self.rigid.faces.dependents)
        return self.unknowns - int(self.comm.allreduce(local))

    @property
    def comm(self) -> Any:
        """Communicator of the mesh."""
        return self.model.mesh.comm

    @property
    def linear(self) -> bool:
        """Whether all bodies are linear."""
        return isinstance(self.bulk, LinearBulk)

    @property
    def in_full(self) -> bool:
        """Whether corrections are taken in full, without a line search, see `corrected`."""
        volume = self.bulk.volume
        return volume is not None and volume.in_full and not self.linear

    @property
    def mixed_search(self) -> bool:
        """Whether a line search of the mixed form pays beside penalties, see `corrected`."""
        return self.bulk.volume is not None and self.bulk.volume.mixed_search

    @property
    @override
    def followed(self) -> FollowedPressures | None:
        return self.bulk.volume.followed if self.bulk.volume is not None else None

    @override
    def take_elastic_share(self, elastic_share: float) -> None:
        self.assembly.bodies.elastic_share = elastic_share

    @override
    def linearised(self) -> AbstractContextManager[None]:
        return self.assembly.bodies.linearised()

    def constrained(self) -> Ints:
        """Unknowns whose row says what they are, prescribed or constrained: local numbers."""
        of_bodies = self.assembly.prescribed_of_bodies()
        found = [self.supports.unknowns, self.constraints.dependents(), of_bodies]
        return np.unique(np.concatenate(found)).astype(np.int64)

    @property
    def holding(self) -> list[str]:
        """Names in `reactions` of what holds the bodies for the whole run."""
        return [*self.inclined.groups, *self.attached.names]

    @property
    def deformable(self) -> list[str]:
        """Names of the bodies that have a stiffness: not all of their nodes follow rigid ones."""
        rigid = [face.whole for face in self.rigid.faces.faces] if self.rigid.faces else []
        return [name for name in self.model.body_names() if name not in rigid]

    @property
    def coupled(self) -> list[str]:
        """Facet groups that follow rigid bodies."""
        return [face.group for faces in self.rigid.coupled.values() for face in faces]
