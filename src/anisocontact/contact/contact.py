"""Contact of a body: slave points, what they meet, and the laws there, in one pass or two."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Self, Unpack

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.contact.history import Snapshot
from anisocontact.contact.making import Before, Options, SurfaceMaster, given_master, passes_of
from anisocontact.contact.master import Resting
from anisocontact.contact.one_pass import Pass
from anisocontact.contact.quadrature import FacetQuadrature
from anisocontact.interface import STATUS, ContactLaw, Response, State
from anisocontact.interface.augmentation import Augmentation
from anisocontact.interface.failed_point import FailedPoint
from anisocontact.mesh import Model
from anisocontact.rigid import RigidBody

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int32]
Mask = npt.NDArray[np.bool_]


class Contact:
    """Contact of a facet group with an analytic surface, one on a rigid body, or other facets.

    At every integration point of the slave `t = N n + T`, from the closest point of the master. The
    residual gets `-integral of t . (delta u_slave - delta u_master)` over the slave area, the
    tangent its derivative: by projection, normal, metric, directions and, where the area is that of
    now, its change. The history advances with `commit` only.

    With `two_half` both groups are slave and master for half of the work, so that neither is
    preferred; with `self_contact` a group folds onto itself, each side of the fold with half of the
    weight. Forces then act on the master by integrals over the overlaps of the facets. What two
    half passes report is seen from the slave: a point of the second pass counts at its foot on the
    slave, with the reaction that acts there. Of self-contact resultants are sums of what the points
    get as slaves, on both sides: what is left is small.

    Args:
        model: Mesh with the facet groups.
        slave: Facet group "body.group" that carries the integration points.
        master: A surface, one on a rigid body (`MovingSurface`), a surface that has its laws
            (`Interface`), or the facet group "body.group" that is met.
        law: Laws, also written in Python (`ContactLaw`); directions are given in the
            reference configuration and carried by the body that is named, the master if none is.
        degree: Degree of the quadrature on the facets, >= 1; if not given twice the order of the
            displacement, with an augmentation the order.
        current_area: Whether tractions act on the area of now or of the reference; where it is not
            given on that of now, but for a problem whose bodies at this contact are linear.
        augmentation: How exactly the contact is to hold; by its penalties alone if not given.
        adjust: Gaps up to this one are closed and overlaps taken out before the first step, see
            `adjusted`, length; nothing if not given.
        reach: Distance within which facets are searched, length; twice the size of the slave's
            facets if not given.
        two_half: Whether there are two half passes.
        self_contact: Whether the slave is its own master.
        apart: Facets nearer to each other than this in the reference configuration, and neighbours,
            do not meet, length; in self-contact three facet sizes if not given.
        overlaps: Whether forces on facets of a single pass are integrated over the overlaps too
            (see `Transfer`), or act at the feet of the slave points.
        mortar: Whether the law is evaluated at the slave nodes, with dual mortar weights, see
            `MortarMaster`; against a surface at the slave nodes with the integrals of their shape
            functions.
        name: Name in output; the slave if not given.

    Attributes:
        slave: As given.
        name: Name in output.
        space: Vector space of the displacement.
        passes: The passes over slave points: one, or two.
        physical_adhesion: Whether the stiffness of adhesion is physical, so that elastic slip is
            none of its faults.
        facet_of_point: Number of each point's facet in the group it lies on, (n,).

    Raises:
        InputError: No such facet group, one without facets or with facets inside the body, or the
            same for both; a degree below 1, laws that are missing or given twice, options that do
            not go together, or a contact that cannot be meant, see `check_start`.

    Example:
        >>> from anisocontact.interface import ContactLaw
        >>> from anisocontact.laws import Adhesion, Friction, NormalLaw
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> from anisocontact.surfaces import make_surface
        >>> upper = BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))
        >>> lower = BoxSpec((-1, -1, -1), (3, 3, 1), (2, 2, 1))
        >>> model = build_box({"block": upper, "base": lower})
        >>> adhesion, friction = Adhesion(stiffness=(100, 100)), Friction(coefficients=(0.3, 0.3))
        >>> law = ContactLaw(NormalLaw(penalty=100.0), adhesion, friction)
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> on_plane = Contact(model, "block.bottom", plane, law)
        >>> down = np.tile([0.0, 0.0, -0.01], (len(model.space.tabulate_dof_coordinates()), 1))
        >>> on_plane.update(down, 1.0).pressure.round(12).tolist()  # at four points
        [1.0, 1.0, 1.0, 1.0]
        >>> pair = Contact(model, "block.bottom", "base.top", law)
        >>> len(pair.areas), round(float(pair.areas.sum()), 12)
        (4, 1.0)
        >>> both = Contact(model, "block.bottom", "base.top", law, two_half=True)
        >>> [half.slave for half in both.passes]
        ['block.bottom', 'base.top']
    """

    def __init__(
        self,
        model: Model,
        slave: str,
        master: str | SurfaceMaster | None = None,
        law: ContactLaw | None = None,
        *,
        degree: int | None = None,
        current_area: bool | None = None,
        augmentation: Augmentation | None = None,
        adjust: float | None = None,
        reach: float | None = None,
        two_half: bool = False,
        self_contact: bool = False,
        apart: float | None = None,
        overlaps: bool = False,
        mortar: bool = False,
        name: str = "",
        **before: Unpack[Before],
    ) -> None:
        master = given_master(master, before)
        options = Options(
            degree,
            current_area,
            augmentation,
            adjust,
            reach,
            two_half,
            self_contact,
            apart,
            overlaps,
            mortar,
        )
        self._compose(passes_of(model, slave, master, law, options), name)

    @classmethod
    def of(cls, *passes: Pass, name: str = "") -> Self:
        """A contact of passes, of which the first says what it is of."""
        new = cls.__new__(cls)
        new._compose(passes, name)
        return new

    def _compose(self, passes: tuple[Pass, ...], name: str) -> None:
        first = passes[0]
        self.passes, self.slave, self.name = passes, first.slave, name or first.slave
        self.space = first.space
        self.physical_adhesion = True
        self._trial: Snapshot | None = None
        self.facet_of_point = np.concatenate([half.slave_points.facet for half in passes])
        self._comm = first.space.mesh.comm
        self._accept()

    @property
    def interface(self) -> Any:
        """The laws, with their surface if it has one."""
        return self.passes[0].interface

    @property
    def groups(self) -> tuple[str, ...]:
        """Facet group of the slave, and of the master if it is one."""
        return self.passes[0].groups

    @property
    def master(self) -> str:
        """Facet group of the master, "" for a surface."""
        return "".join(self.groups[1:])

    @property
    def meshed(self) -> bool:
        """Whether the master is facets of a mesh."""
        return len(self.groups) > 1

    @property
    def of_two_groups(self) -> bool:
        """Whether facets of one group meet those of another one."""
        return len(set(self.groups)) > 1

    @property
    def body(self) -> RigidBody | None:
        """Rigid body that carries the master, if one does."""
        return self.passes[0].master.body

    @property
    def quadrature(self) -> FacetQuadrature:
        """Quadrature of the slave, of the first pass."""
        return self.passes[0].slave_points.quadrature

    @property
    def current_area(self) -> bool:
        """Whether tractions act on the area of now."""
        return self.passes[0].slave_points.current_area

    @property
    def facet_size(self) -> float:
        """Length of a slave facet: square root of the mean area."""
        return self.passes[0].slave_points.size

    @property
    def master_size(self) -> float:
        """Length of a facet of the master; 0 for a surface."""
        return self.passes[0].master.size

    @property
    def body_stiffness(self) -> float:
        """As of `Pass`."""
        return self.passes[0].body_stiffness

    def slip_stiffness(self, dt: float) -> float:
        """As of `Trials`."""
        return self.passes[0].trials.slip_stiffness(dt)

    @property
    def ran_off(self) -> Floats:
        """Slave points that left the end of the master in the accepted increment, (k, 3)."""
        # points of a second pass come from under an end of the slave whenever it moves
        return self.passes[0].ran_off

    @property
    def points(self) -> Floats:
        """Slave points where they are after the accepted increment, (n, 3), length."""
        return self._accepted.points

    @property
    def areas(self) -> Floats:
        """Area of each slave point after the accepted increment, (n,), length^2."""
        return self._accepted.areas

    @property
    def last(self) -> Response:
        """Response of the accepted increment."""
        return self._accepted.response

    @property
    def current(self) -> Snapshot:
        """The trial, or the accepted increment if there was none since."""
        return self._trial or self._accepted

    @property
    def trial(self) -> Response:
        """Response of the last `update`, or of the accepted increment if there was none since."""
        return self.current.response

    @property
    def state(self) -> State:
        """Committed history, one record for each point."""
        if len(self.passes) == 1:
            return self.passes[0].state
        return np.concatenate([half.state for half in self.passes])

    def take_supports(self, fixed: Mask, resting: Sequence[Resting]) -> None:
        """As of `Pass`."""
        for half in self.passes:
            half.take_supports(fixed, resting)

    def update(self, u: Floats, dt: float) -> Response:
        """Response to nodal displacements from the committed history, kept as the trial.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            dt: Time increment.

        Returns:
            The response of all passes as seen from the slave; the committed history is unchanged.
        """
        for half in self.passes:
            try:
                half.update(u, dt)
            except InputError as error:  # a law in Python
                error.failed = half.unanswered(self.name)
                raise
        self._trial = seen_from_slave([half.current for half in self.passes])
        return self._trial.response

    def failed_point(self) -> FailedPoint | None:
        """The first point of this rank at which the laws have failed in the trial, if any has."""
        found = (half.failed_point(self.name) for half in self.passes)
        return next((point for point in found if point is not None), None)

    def commit(self) -> None:
        """Make the trial the history."""
        for half in self.passes:
            half.commit()
        self._accept()

    def roll_back(self) -> None:
        """Forget the trial."""
        for half in self.passes:
            half.roll_back()
        self._trial = None

    def restore(self, kept: Sequence[Mapping[str, npt.NDArray[Any]]], u: Floats) -> None:
        """Go on from what `Pass.persistent` gave.

        Args:
            kept: The state of each pass.
            u: Displacement of the local nodes in that state, (nodes, 3), length.
        """
        for half, its in zip(self.passes, kept, strict=True):
            half.restore(its, u)
        self._accept()

    def _accept(self) -> None:
        self._trial = None
        self._accepted = seen_from_slave([half.accepted for half in self.passes])

    def add_force(self, out: Floats) -> None:
        """Add the forces of the trial to the local nodes, (nodes, 3), force."""
        for half in self.passes:
            half.answer.add_force(out)

    def couplable(self) -> Ints:
        """Local nodes that the contact acts on; all ranks together have all of them."""
        return self.passes[0].master.couplable()

    def improve(self) -> bool:
        """As of `Trials`."""
        return any([half.trials.improve() for half in self.passes])

    def soften(self) -> bool:
        """As of `Trials`."""
        return any([half.trials.soften() for half in self.passes])

    def footing(self) -> npt.NDArray[np.int64]:
        """As of `Master`."""
        return np.concatenate([half.master.footing(len(half.state)) for half in self.passes])

    def hold(self, points: Mask) -> None:
        """As of `Master`."""
        ends = np.cumsum([len(half.state) for half in self.passes])
        for half, its in zip(self.passes, np.split(points, ends[:-1]), strict=True):
            half.master.hold(its)

    def strayed(self) -> Floats:
        """As of `Master`."""
        return np.concatenate([half.master.strayed(len(half.state)) for half in self.passes])

    def elastic_slip(self) -> Floats:
        """Elastic part of the displacement of the slave relative to the master, (n, 3), length."""
        slips = [half.elastic_slip() for half in self.passes]
        return np.concatenate([*slips[:1], *(-slip for slip in slips[1:])])

    def counts(self) -> dict[str, int]:
        """Number of open, sticking and slipping points of the trial, over all ranks."""
        local = np.bincount(self.trial.status, minlength=len(STATUS))
        total = self._comm.allreduce(local)
        return {name: int(n) for name, n in zip(STATUS, total, strict=True)}

    def resultant(self, about: npt.ArrayLike = (0.0, 0.0, 0.0)) -> tuple[Floats, Floats]:
        """Force and moment on the slave after the accepted increment.

        Args:
            about: Point of the moment, (3,), length.

        Returns:
            Force (3,) and moment (3,), force and force times length.
        """
        total = self._comm.allreduce(self._accepted.wrench(np.asarray(about)))
        return total[:3], total[3:]

    def energies(self) -> dict[str, float]:
        """As of `Pass`, the sum of all passes."""
        found = [half.energies() for half in self.passes]
        return {name: sum(one[name] for one in found) for name in found[0]}

    def extreme(self, values: Floats) -> float:
        """Largest of some numbers at points, over all ranks; 0 without points."""
        return float(max(self._comm.allgather(float(np.max(values, initial=0.0)))))

    def peak(self, values: Floats) -> float:
        """Largest of one number at each point of the accepted increment, over all ranks.

        Nodes of a mortar of which the master covers next to nothing do not count: see
        `SlaveNodes.peaks`.
        """
        return self.extreme(values[self.counted()])

    def counted(self) -> Mask:
        """Slave points of the accepted increment that count among peaks, (n,)."""
        return np.concatenate(
            [half.slave_points.peaks(half.accepted.areas) for half in self.passes]
        )

    def touching(self) -> Floats:
        """Area of each slave point on which it touches, accepted increment, (n,), length^2."""
        return np.concatenate([half.slave_points.touching(half.accepted) for half in self.passes])

    def covered(self) -> Floats:
        """Share of each slave point that a master was opposite to, accepted increment, (n,)."""
        return np.concatenate(
            [half.slave_points.covered(half.accepted.areas) for half in self.passes]
        )


def seen_from_slave(passes: Sequence[Snapshot]) -> Snapshot:
    """Points of one pass, or of both as seen from the slave of the first.

    A point of the second pass counts at its foot on that slave, with the reaction that acts there,
    so that sums over all points are forces and moments of the pair.
    """
    a, *rest = passes
    if not rest:
        return a
    (b,) = rest
    r, s = a.response, b.response
    feet = b.points - (s.gap + s.state["offset"])[:, None] * s.normal
    response = Response(
        traction=np.concatenate([r.traction, -s.traction]),
        tangent=np.empty((0, 3, 3)),
        state=np.concatenate([r.state, s.state]),
        normal=np.concatenate([r.normal, -s.normal]),
        directions_adhesion=np.concatenate([r.directions_adhesion, s.directions_adhesion]),
        directions_friction=np.concatenate([r.directions_friction, s.directions_friction]),
        failure=np.concatenate([r.failure, s.failure]),
    )
    areas = np.concatenate([a.areas, b.areas])
    return Snapshot(np.concatenate([a.points, feet]), areas, response)
