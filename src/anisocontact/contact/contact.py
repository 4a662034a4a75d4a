"""Contact of a body: slave points, what they meet, and the laws there."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any, Unpack

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Flags, Floats, Ints, Locals
from anisocontact.base.arrays import points as points_of
from anisocontact.base.one_history import OneHistory
from anisocontact.base.sealed import unsealed
from anisocontact.base.statuses import OPEN
from anisocontact.base.typed import typed
from anisocontact.base.uncopied import Uncopied
from anisocontact.contact.beyond_cuts import Seam
from anisocontact.contact.contact_pair import ContactPair
from anisocontact.contact.defaults import WithoutPenalty, exact
from anisocontact.contact.history import Snapshot
from anisocontact.contact.options import ContactOptions
from anisocontact.contact.pair_parts import (
    DeprecatedArguments,
    SurfaceMaster,
    before_this,
    make_pair_parts,
)
from anisocontact.contact.quadrature import FacetQuadrature
from anisocontact.contact.sagitta import sagitta
from anisocontact.interface import STATUS, ContactLaw, Interface, Response
from anisocontact.interface.augmentation import Augmentation
from anisocontact.interface.description import compared
from anisocontact.mesh import Model
from anisocontact.mesh.at_rest import check_at_rest
from anisocontact.mesh.idealisation import ON_AXIS
from anisocontact.rigid import MovingSurface, RigidBody


@typed
class Contact(
    ContactPair,
    OneHistory,
    Uncopied,
    changing="accepted answer body_stiffness master_yields physical_adhesion physical_penalty "
    "ran_off without_slip",
):
    """Contact of a facet group with an analytic surface, one on a rigid body, or other facets.

    At every slave point `t = N n + T`, from what is opposite on the master. The
    residual gets `-integral of t . (delta u_slave - delta u_master)` over the slave area, the
    tangent its derivative: by projection, normal, metric, directions and, where the area is that of
    now, its change. The history advances with `commit` only.

    With `self_contact` a group folds onto itself: it is evaluated at the slave nodes, and of facets
    that face each other one is the slave, see `SelfContactSides`. Resultants are what the slaves
    get.

    Args:
        model: Mesh with the facet groups.
        slave: Facet group "body.group" that carries the slave points.
        master: A surface, one on a rigid body (`MovingSurface`), a surface that has its laws
            (`Interface`), or the facet group "body.group" that is met.
        law: `Friction` for a contact that holds exactly, by multipliers, as do an
            `AdhesionAndFriction` or a `PythonLaw`, whose elastic slip is physical. A `ContactLaw`
            has a law of the pressure, which holds as it is. Directions are given in the
            reference configuration and carried by the body that is named, the master if none is.
        degree: Degree of the quadrature on the facets, >= 1; if not given twice the order of the
            displacement, with an augmentation the order.
        current_area: Whether tractions act on the area of now or of the reference; where it is not
            given on that of now, but for a problem whose bodies at this contact are linear.
        augmentation: How exactly a contact is to hold that has a law of the pressure; by its
            penalties alone if not given.
        adjust: Gaps up to this one are closed and overlaps taken out before the first step, see
            `adjusted`, length; nothing if not given.
        reach: Distance within which facets are searched, length; twice the size of the slave's
            facets if not given.
        self_contact: Whether the slave is its own master, at its nodes.
        apart: Facets nearer to each other than this in the reference configuration that do not face
            each other there do not meet, nor do neighbours, length; in self-contact three facet
            sizes if not given.
        mortar: Whether the law is evaluated at the slave nodes, with dual mortar weights, see
            `MortarMaster`, against a surface with the integrals of their shape functions; or at
            integration points. If not given at the nodes, unless there is a `degree`, or a mesh of
            two dimensions on several processes.
        name: Name in output; the slave if not given.

    Attributes:
        slave: As given.
        name: Name in output.
        unknowns: Where the displacement of nodes is among the unknowns.
        space: Vector space of the displacement of nodes.
        master: What the slave points meet.
        slave_points: Where the laws are evaluated.
        sagitta: Height of the arcs over the facets of slave and master, length.
        nodes_of_groups: Local nodes, with ghosts, of each of `groups`.
        physical_adhesion: Whether the stiffness of adhesion is physical, so that elastic slip is
            none of its faults.
        physical_penalty: Whether the normal penalty is physical, so that the penetration is none.
        goes_on: Whether it meets what goes on beyond cut faces.
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
        >>> on_plane = Contact(model, "block.bottom", plane, law)  # at four nodes
        >>> down = np.tile([0.0, 0.0, -0.01], (len(model.space.tabulate_dof_coordinates()), 1))
        >>> on_plane.update(down, 1.0).pressure.round(12).tolist()
        [1.0, 1.0, 1.0, 1.0]
        >>> pair = Contact(model, "block.bottom", "base.top", friction)  # with multipliers
        >>> len(pair.areas), round(float(pair.areas.sum()), 12)
        (4, 1.0)
        >>> points = Contact(model, "block.bottom", "base.top", law, mortar=False)
        >>> len(points.areas), round(float(points.areas.sum()), 12)
        (4, 1.0)
    """

    def __init__(
        self,
        model: Model,
        slave: str,
        master: str | SurfaceMaster | None = None,
        law: ContactLaw | WithoutPenalty | None = None,
        *,
        degree: int | None = None,
        current_area: bool | None = None,
        augmentation: Augmentation | None = None,
        adjust: float | None = None,
        reach: float | None = None,
        self_contact: bool = False,
        apart: float | None = None,
        mortar: bool | None = None,
        name: str = "",
        **before: Unpack[DeprecatedArguments],
    ) -> None:
        master, of_before = before_this(master, before)
        law, augmentation = exact(law, augmentation)
        mortar = of_before if mortar is None else mortar
        options = ContactOptions(
            degree, current_area, augmentation, adjust, reach, self_contact, apart, mortar
        ).decided(model, slave, master if isinstance(master, str) else None)
        self._made_of = model, master, law, options
        check_at_rest(model, "model")
        parts = make_pair_parts(model, slave, master, law, options)
        super().__init__(model.unknowns, slave, name or slave, parts, options)
        self.sagitta = sum(sagitta(model, group) for group in self.groups)
        self.nodes_of_groups = tuple(model.facet_nodes(group) for group in self.groups)
        self.physical_adhesion, self.physical_penalty, self.goes_on = True, False, False
        self.facet_of_point = self.slave_points.facet

    def check_at_rest(self) -> None:
        """Refuse a mesh that was moved since the contact was made; collective.

        Raises:
            InputError: A node is elsewhere.
        """
        check_at_rest(self._made_of[0], f"contact {self.name!r}")

    def made_of(self) -> dict[str, Any]:
        """What it was made of, for another one to be compared with, see `compared`."""
        _, master, law, options = self._made_of
        told: dict[str, Any] = compared(
            {"slave": self.slave, "master": master, "law": law, **vars(options)}
        )
        if self.body is not None:
            told["body"] = {"name": self.body.name, "reference": self.body.reference.tolist()}
        return told

    @property
    def model(self) -> Model:
        """Mesh with the facet groups."""
        found: Model = self._made_of[0]
        return found

    def surface(self) -> Any:
        """The analytic surface that is met, where it was drawn."""
        master: Any = self._made_of[1]
        surface: Any = master.surface if isinstance(master, MovingSurface) else master
        return surface.surface if isinstance(surface, Interface) else surface

    def go_on_beyond(self, seams: Sequence[Seam]) -> None:
        """Meet what goes on beyond the cut faces of a sector, before the first step.

        Slave nodes on two cut faces are one node then, which the leading one stands for.

        Args:
            seams: Cut faces of slave and master, all with one turn, to either side.
        """
        model, master, law, options = self._made_of
        parts = make_pair_parts(model, self.slave, master, law, options, seams)
        with unsealed(self):
            ContactPair.__init__(self, model.unknowns, self.slave, self.name, parts, options)
            self.facet_of_point, self.goes_on = self.slave_points.facet, True

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
        return self.master.body

    @property
    def quadrature(self) -> FacetQuadrature:
        """Quadrature of the slave."""
        return self.slave_points.quadrature

    @property
    def current_area(self) -> bool:
        """Whether tractions act on the area of now."""
        return self.slave_points.current_area

    @property
    def facet_size(self) -> float:
        """Length of a slave facet: square root of the mean area."""
        return self.slave_points.size

    @property
    def master_size(self) -> float:
        """Length of a facet of the master; 0 for a surface."""
        return self.master.size

    def slip_stiffness(self, dt: float) -> float:
        """Largest stiffness of adhesion against slip, as of `Trials`.

        Args:
            dt: Time increment, time.

        Returns:
            The stiffness, stress/length; 0 where multipliers hold what sticks.
        """
        return self.trials.slip_stiffness(dt)

    @property
    def trial(self) -> Response:
        """Response of the last `update`, or of the accepted increment if there was none since."""
        return self.current.response

    def add_force(self, out: Floats) -> None:
        """Add the forces of the trial to the local nodes.

        Args:
            out: Nodal forces, (nodes, 3), force; added to.
        """
        self.answer.add_force(out)

    def couplable(self) -> Locals:
        """Local nodes that the contact acts on; all ranks together have all of them."""
        return self.master.couplable()

    def beside(self) -> tuple[Locals, Locals, Floats] | None:
        """What else the gap of each slave node is made of, see `slave_nodes.EDGE_SHARE`.

        Returns:
            Local slave nodes (n,), other slave nodes (n, k), and how the first follow them where
            no gap changes; None where a gap is that of one node, or of a point.
        """
        points = self.slave_points.quadrature
        count = points.rows or 1
        if not self.slave_points.at_nodes or count < 2:
            return None
        named, basis = self.master.local_names(points.nodes[:, :count]), points.basis[:, 0, :count]
        return named[:, 0], named[:, 1:], -basis[:, 1:] / basis[:, :1]

    def projected_facets(self) -> Ints:
        """As of `Master`."""
        return self.master.projected_facets(len(self.state))

    def located(self) -> Flags:
        """Whether each point of the trial has its master below it, (n,)."""
        return self.master.located(self.trial.state)

    def hold(self, points: Flags) -> None:
        """Hold points on their facets until the trial is kept or forgotten, as of `Master`.

        Args:
            points: Which of them, (n,).
        """
        self.master.hold(points)

    def strayed(self) -> Floats:
        """As of `Master`."""
        return self.master.strayed(len(self.state))

    def counts(self) -> dict[str, int]:
        """Number of open, sticking and slipping points of the trial, over all ranks."""
        local = np.bincount(self.trial.status, minlength=len(STATUS))
        total = self._comm.allreduce(local)
        return {name: int(n) for name, n in zip(STATUS, total, strict=True)}

    def resultant(self, about: npt.ArrayLike = (0.0, 0.0, 0.0)) -> tuple[Floats, Floats]:
        """Force and moment on the slave after the accepted increment.

        Around an axis the force along x is the radial one, summed, and the moment the torque alone:
        moments about other axes cancel.

        Args:
            about: Point of the moment, (3,), length.

        Returns:
            Force (3,) and moment (3,), force and force times length.

        Raises:
            InputError: The point is not three finite numbers.
        """
        (place,) = points_of(about, 3, "about", rows=1)
        total = self._comm.allreduce(self.wrench(self.accepted, place))
        return total[:3], total[3:] * self.model.idealisation.moments

    def wrench(self, now: Snapshot, about: Floats) -> Floats:
        """Force and moment on the slave in some state over the points of this rank, (6,).

        A node on an axis of revolution has a force along that alone, by symmetry: on the tip of a
        surface its normal is one of those around, by rounding.

        Args:
            now: The points.
            about: Point of the moment, (3,), length.

        Returns:
            The force, then the moment, (6,), force and force times length.
        """
        on_axis = self._on_axis
        if not on_axis.any():
            return now.wrench(about)
        traction = now.response.traction.copy()
        traction[on_axis] *= (0.0, 1.0, 0.0)
        return now.wrench(about, traction)

    @cached_property
    def _on_axis(self) -> Flags:
        """Slave points on the axis of a body of revolution, (n,)."""
        x = self.slave_points.quadrature.reference
        least = ON_AXIS * float(np.abs(self.model.mesh.geometry.x).max(initial=0.0))
        return np.asarray((x[:, 0] <= least) & self.model.idealisation.turn.any())

    def turn(self) -> float:
        """Angle by which normal, axes of adhesion or slave turn where friction acts, radian.

        `(sum T phi^3 / sum T)^(1/3)` of the angles phi and the tangential forces T of the points of
        the trial, over all ranks: what a step does not follow of the way of a point grows with the
        cube of its angle, and the force there is what it changes.
        """
        total, moment = self._comm.allreduce(self.current.turned_forces)
        return float(np.cbrt(moment / total)) if total > 0.0 else 0.0

    def extreme(self, values: Floats) -> float:
        """Largest of some numbers at points, over all ranks.

        Args:
            values: A number for each of some points of this rank, (n,).

        Returns:
            The largest; 0 without points, and where all are less.
        """
        return float(max(self._comm.allgather(float(np.max(values, initial=0.0)))))

    def peak(self, values: Floats) -> float:
        """Largest of one number at each point of the accepted increment, over all ranks.

        Nodes of a mortar of which the master covers next to nothing do not count: see
        `SlaveNodes.peaks`.

        Args:
            values: A number for each slave point of this rank, (n,).

        Returns:
            The largest; 0 without points, and where all are less.
        """
        return self.extreme(values[self.counted()])

    def counted(self) -> Flags:
        """Slave points of the accepted increment that count among peaks, (n,)."""
        return self.slave_points.peaks(self.areas)

    def slivers(self) -> int:
        """Slave points that touch without counting among peaks, over all ranks; collective."""
        touching = self.state["status"] != OPEN
        return int(self._comm.allreduce(int(np.count_nonzero(touching & ~self.counted()))))

    def touching(self) -> Floats:
        """Area of each slave point on which it touches, accepted increment, (n,), length^2."""
        return self.slave_points.touching(self.accepted)

    def covered(self) -> Floats:
        """Share of each slave point that a master was opposite to, accepted increment, (n,)."""
        return self.slave_points.covered(self.areas)
