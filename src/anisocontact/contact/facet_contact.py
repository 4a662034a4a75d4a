"""Slave facets against the facets of another body: large sliding, both sides deforming."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.errors import InputError
from anisocontact.contact.adjust import adjusted
from anisocontact.contact.facet_answer import Question, ask
from anisocontact.contact.gathering import gather, gather_named
from anisocontact.contact.held_feet import HeldFeet, footing, on_held_facets
from anisocontact.contact.initial import check_start
from anisocontact.contact.layer import Layer
from anisocontact.contact.multipliers import Frames
from anisocontact.contact.penalty import facet_size
from anisocontact.contact.point_blocks import add_rows, point_blocks
from anisocontact.contact.point_tangent import PointTangent
from anisocontact.contact.quadrature import chosen_degree
from anisocontact.contact.reachable import NodePairs, reachable, slid
from anisocontact.contact.record import ContactRecord, Snapshot
from anisocontact.contact.semismooth import Base, Semismooth
from anisocontact.contact.sides import check_sides, initial_state, located, make_sides
from anisocontact.contact.transfer import Couplings, Transfer
from anisocontact.contact.transfer_work import transfer_work
from anisocontact.contact.whereabouts import Seen, Whereabouts, carried
from anisocontact.interface import ContactLaw, Response, State
from anisocontact.interface.augmentation import Augmentation
from anisocontact.interface.contact_law import FacetLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Model
from anisocontact.surfaces.facets import FacetProjections

Mask = npt.NDArray[np.bool_]
Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]


class FacetContact(ContactRecord):
    """Contact of a facet group with the facets of another group of the same mesh.

    At every quadrature point of the slave, `t = N n + T` from the closest point of the master where
    both are now; forces go to both bodies. The tangent holds the change of projection, normal,
    metric, directions and slave area, and of the facet on which the history was committed.

    Args:
        model: Mesh with both groups.
        slave: Facet group "body.group" that carries the quadrature points.
        master: Facet group "body.group" that is the surface.
        law: Laws, also one written in Python; directions are given in the reference configuration
            and carried by the body that is named, the master if none is.
        degree: Degree of the quadrature; if not given twice the order of the
            displacement, with an augmentation the order.
        reach: Distance within which the master is searched, length; twice the size of the slave's
            facets if not given.
        current_area: Whether tractions act on the area of now or of the reference; where it is not
            given on that of now, but for a problem whose bodies at this contact are linear.
        augmentation: How exactly the contact is to hold; by its penalties alone if not given.
        adjust: Gaps up to this one are closed and overlaps taken out before the first step, see
            `adjusted`, length; nothing if not given.
        weight: Share of the work of this pass: 0.5 for each of two half passes.
        mirrored: Whether angles of directions count about the normal of the slave, not of the
            master: the other way round.
        apart: Facets nearer to each other than this in the reference configuration, and neighbours,
            do not meet, length; needed where the groups share facets (see `SelfContact`).
        overlaps: Whether forces on the master are integrated over the overlaps of the facets (see
            `Transfer`) or act at the feet of the slave points.
        name: Name in output; the slave if not given.

    Raises:
        InputError: No such facet group, one without facets or with facets inside the body, or the
            same for both; a degree below 1, laws with a surface of their own, or a contact that
            cannot be meant, see `check_start`.

    Example:
        >>> from anisocontact.laws import Adhesion, Friction, NormalLaw
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> upper = BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))
        >>> lower = BoxSpec((-1, -1, -1), (3, 3, 1), (2, 2, 1))
        >>> model = build_box({"block": upper, "base": lower})
        >>> adhesion, friction = Adhesion(stiffness=(100, 100)), Friction(coefficients=(0.3, 0.3))
        >>> law = ContactLaw(NormalLaw(penalty=100.0), adhesion, friction)
        >>> pair = FacetContact(model, "block.bottom", "base.top", law=law)
        >>> len(pair.areas), round(float(pair.areas.sum()), 12), len(pair.master_facets)
        (4, 1.0, 4)
    """

    def __init__(
        self,
        model: Model,
        slave: str,
        master: str,
        *,
        law: ContactLaw,
        degree: int | None = None,
        reach: float | None = None,
        current_area: bool | None = None,
        augmentation: Augmentation | None = None,
        adjust: float | None = None,
        weight: float = 1.0,
        mirrored: bool = False,
        overlaps: bool = False,
        apart: float | None = None,
        name: str = "",
    ) -> None:
        check_sides(model, slave, master, apart)
        if not hasattr(law, "pairs"):
            text = f"{type(law).__name__} given, ContactLaw needed"
            raise InputError(text, "law")
        self.master, self.groups = master, (slave, master)
        self.interface: ContactLaw = law
        self._laws = self._stiff_laws = law
        self._area_told = current_area is not None
        self._mirrored = mirrored
        self._law = self._stiff = law.pairs(mirrored)
        self._base: Base | None = None
        self._linear: PointTangent | None = None
        self._lag: Floats = np.zeros((0, 0, 3))
        self._transferred = 0.0
        degree = chosen_degree(degree, model.order, augmentation is not None)
        self._sides = sides = make_sides(
            model, (slave, master), degree, reach, apart, current_area is not False, weight
        )
        self._points, self._gathered = sides.points, sides.gathered
        self.reach = sides.reach
        self._multipliers = self._layer = None
        self._now = sides.reference
        self._hint = sides.project(self._now)
        self._answer: dict[str, Any] = {}
        self._held = HeldFeet(len(self._points.nodes))
        self._transfer = Transfer(sides) if overlaps else None
        self._handed: Mask = np.zeros(len(self._points.nodes), dtype=bool)
        state = adjusted(initial_state(self._hint, law.dtype), adjust)
        start = self._respond(state, sides.reference, 1.0, tangent=False)
        self._committed = (self._gathered.local(self._now), self._hint)
        super().__init__(model.space, slave, name or slave, state, start, self._points.facet)
        if self._transfer is not None:
            self._transfer.place(sides.reference)
        self._master_size = facet_size(model, master)
        check_start(self, self._points.size)
        self._augment(augmentation, self._points.size, law)

    @property
    def passes(self) -> tuple[FacetContact, ...]:
        """The passes over slave points this contact is made of: itself."""
        return (self,)

    @property
    def had_facets(self) -> npt.NDArray[np.int64]:
        """Facets of the master that this rank has, numbers in the whole group."""
        return self._gathered.numbers

    @property
    def slave_facets(self) -> Ints:
        """Local nodes of the slave facet of each point, (n, k)."""
        return self._points.nodes

    @property
    def master_facets(self) -> Ints:
        """Local nodes of each master facet, (m, k)."""
        return self._sides.master.nodes

    def couplable(self) -> Ints:
        """Local nodes of slave and master; all ranks together have all of them."""
        return np.union1d(self._points.nodes, self._gathered.own.nodes).astype(np.int32)

    @property
    def facet_size(self) -> float:
        """Length of a slave facet: square root of the mean area."""
        return self._points.size

    @property
    def master_size(self) -> float:
        """Length of a master facet: square root of the mean area."""
        return self._master_size

    def feet(self) -> Ints:
        """Local nodes of the master facets that points of the trial have below them."""
        assert self._hint is not None
        return np.unique(self._sides.master.nodes[self._hint.facet[located(self._hint)]])

    @property
    def current_area(self) -> bool:
        """Whether tractions act on the area of now."""
        return self._points.current_area

    def suit_strain(self, finite: bool) -> None:
        """As of `ContactRecord`."""
        if not self._area_told:
            self._points.take_area(finite)

    def update(self, u: Floats, dt: float) -> Response:
        """Response to nodal displacements from the committed history, kept as the trial.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            dt: Time increment.

        Returns:
            The response; the committed history is unchanged.
        """
        self._keep_up(u)
        moved = np.array(self._gathered.everywhere(u))
        self._now = self._sides.reference + moved
        semismooth = self._semismooth
        if semismooth is None:
            self._trial = self._respond(self._start, self._now, dt, tangent=True)
        else:
            self._trial = self._linearised(semismooth, moved, dt)
        if self._transfer is not None:
            self._hand_over(self._transfer)
        return self._trial.response

    def _linearised(self, semismooth: Semismooth | Layer, moved: Floats, dt: float) -> Snapshot:
        """A trial to which the multipliers have followed, with the derivative of a Newton step."""
        hit = self._project(self._now)
        self._follow(semismooth, moved, hit)
        trial = self._ask(self._law, self._start, hit, dt, tangent=False)
        step = self._step(trial)
        state, slip = semismooth.stiff(step)
        answer = self._answer
        self._ask(self._stiff, state, hit, dt, tangent=True)
        stiff = self._unstiffened(self._answer["stiffness"], trial, dt)
        kept = {name: self._answer[name] for name in ("tangent", "nodes")}
        self._answer = answer | kept | {"stiffness": stiff}
        vector = semismooth.vector(step)
        self._linear = PointTangent(self._points, self._now, moved, self._answer, trial)
        self._base = Base(vector, trial.response.traction, self._linear.slipped(slip))
        self._lag = self._linear.forces(slip)
        return trial

    def _follow(self, semismooth: Semismooth | Layer, moved: Floats, hit: FacetProjections) -> None:
        """Let the multipliers follow a step of Newton's method."""
        if self._base is None or self._linear is None or self._linear.at(self._now):
            return
        there = self._start.copy()
        there["facet"], there["xi"] = np.where(located(hit), hit.facet, -1), np.nan_to_num(hit.xi)
        self._start = semismooth.advance(
            self._start,
            self._base.after(self._linear.change(self._now, moved), semismooth.share),
            Frames.of(self._tangents(there)),
            Frames.of(self._tangents(self._start)),
        )

    def commit(self) -> None:
        """Make the trial the history."""
        if self._trial is not None:
            lost = self._comm.allgather(self._sides.lost(self.state, self._trial))
            self.ran_off = np.concatenate(lost)
            if self._transfer is not None:
                step = self._now - self._gathered.everywhere(self._committed[0])
                ends = (self._accepted, self.current)
                work = transfer_work(self._sides, self._transfer, self._handed, step, ends)
                self._transferred += self._comm.allreduce(work)
                self._transfer.place(self._now)
        super().commit()
        self._committed = (self._gathered.local(self._now), self._hint)

    @property
    def retraceable(self) -> bool:
        """Never: projections start from the last ones, and could come back to another facet."""
        return False

    def energies(self) -> dict[str, float]:
        """As of `ContactRecord`; with overlaps also "transfer", see `Transfer`."""
        own = super().energies()
        return own if self._transfer is None else own | {"transfer": self._transferred}

    def roll_back(self) -> None:
        """Forget the trial; the surface goes back to where it was."""
        if self._trial is not None:
            place, self._hint = self._committed
            self._now = self._gathered.everywhere(place)
            self._sides.surface.update(self._now)
        if self._transfer is not None:
            self._transfer.roll_back()
        super().roll_back()

    def persistent(self) -> dict[str, npt.NDArray[Any]]:
        """As of `ContactRecord`, with the last projection: the next one starts from it."""
        kept = super().persistent()
        hint = self._committed[1]
        kept |= {f"projection.{f.name}": getattr(hint, f.name).copy() for f in fields(hint)}
        for facets in (kept["state"]["facet"], kept["projection.facet"]):
            facets[:] = self._gathered.globally(facets)
        everywhere = np.full(len(self._points.nodes), self._transferred)
        return kept | {
            "reference": self._points.positions(self._sides.reference),
            "transferred": everywhere,
        }

    def restore(self, kept: Mapping[str, npt.NDArray[Any]], u: Floats) -> None:
        """Go on from what `persistent` gave."""
        kept = {name: values.copy() for name, values in kept.items()}
        named = kept["state"]["facet"], kept["projection.facet"]
        now = self._gathered.local(self._sides.reference) + u
        self._sides = gather_named(self._sides, now, named, self._transfer)
        super().restore(kept, u)
        self._transferred = self.extreme(kept["transferred"]) - self.extreme(-kept["transferred"])
        names = [f.name for f in fields(FacetProjections)]
        self._hint = FacetProjections(*(np.array(kept[f"projection.{n}"]) for n in names))
        self._now = self._sides.reference + self._gathered.everywhere(u)
        self._committed = (self._gathered.local(self._now), self._hint)
        self._sides.surface.update(self._now)
        if self._transfer is not None:
            self._transfer.place(self._now)

    def _keep_up(self, u: Floats) -> None:
        """Have all facets of the master that the points can reach at these displacements."""
        if not self._gathered.distributed:
            return
        now = self._gathered.local(self._sides.reference) + u
        if self._sides.outrun(now):
            histories = (self.state, self._start, self.last.state)
            hints = (self._hint, self._committed[1], *self._held.hints)
            self._sides = gather(self._sides, now, histories, hints, self._transfer)
            self._linear = None

    def elastic_slip(self) -> Floats:
        """Elastic part of the relative displacement `e^i rho_i`, (n, 3), length."""
        return np.asarray(
            np.einsum("ni,nij->nj", self.state["elastic"], self._tangents(self.state))
        )

    def add_force(self, out: Floats) -> None:
        """Add the forces of the trial on both bodies to the local nodes, (nodes, 3), force."""
        total = self._gathered.zeros(out)
        if self._by_points:
            add_rows(self._answer, -self._answer["residual"], total)
        else:
            total += self._answer["force"]
        if self._transfer is not None:
            self._transfer.add_force(total)
        self._gathered.hand_back(total, out)

    def add_lag(self, out: Floats) -> None:
        """As of `ContactRecord`."""
        if self._linear is None or self._base is None:
            return
        total = self._gathered.zeros(out)
        forces = self._lag.copy()
        if self._transfer is not None:
            forces[self._handed, 3 * self._points.nodes.shape[1] :] = 0.0
            self._transfer.add_force(total, self.current.areas[:, None] * self._base.lag)
        add_rows(self._answer, forces, total)
        self._gathered.hand_back(total, out)

    def reachable(self, way: Floats, margin: float, hops: int) -> list[NodePairs]:
        """Nodes that `couplings` can name where the slave goes along a way, see `reachable`.

        Args:
            way: Displacement against the master at places along the way, of each point or one for
                all, (w, n or 1, 3), length.
            margin: How far beside the way a point can be, length.
            hops: Places along the way that an increment goes.
        """
        return reachable(self._sides, self._now, way, margin, hops, self._transfer is None)

    def slid(self) -> Floats:
        """How far the foot of each point has slid in the trial, (n, 3), length."""
        assert self._hint is not None
        return slid(self._sides, self.state, self._hint)

    def couplings(self) -> Sequence[Couplings]:
        """Where `-d force / d u` of the trial has entries, and the entries.

        Points of one slave facet share a block where they meet the same facet of the master.

        Returns:
            Each with nodes of the rows (p, r) and of the columns (p, c), numbered as
            `CoupledTangent` has them, -1 for none, and p blocks, (p, r, c, 3, 3) or (p, 3 r, 3 c).
        """
        named = self._gathered.coupled
        return [(named(rows), named(columns), k) for rows, columns, k in self._blocks()]

    def _blocks(self) -> Sequence[Couplings]:
        """`couplings` with the node numbers of the surface."""
        if not self._by_points:
            blocks: Sequence[Couplings] = self._answer["blocks"]
            return blocks
        touching, own = self.trial.status != 0, self._points.nodes.shape[1]
        return point_blocks(self._answer, touching, self._handed, own, self._transfer)

    def located(self, state: State) -> Mask:
        """Whether each point of a state has a facet below it, (n,)."""
        return np.asarray(state["facet"] >= 0)

    def outward(self) -> Floats:
        """Outward normals of the slave at its points in the reference configuration, (n, 3)."""
        return self._points.outward

    def whereabouts(self, u: Floats) -> Whereabouts:
        """Where the points of the trial are beside the master, in its frame; collective.

        Args:
            u: Displacement of the local nodes in the trial, (nodes, 3), length.
        """
        now = self._sides.reference + self._gathered.everywhere(u)
        then = self._gathered.everywhere(self._committed[0])
        nodes = np.unique(self._sides.master.nodes)
        trial = self.current
        return Whereabouts(
            before=carried(self.points, then[nodes], now[nodes]),
            now=trial.points,
            outward=self._points.outward_at(now),
            closed=trial.response.status != 0,
            located=self.located(trial.response.state),
            had=self.located(self.state),
            normal=trial.response.normal,
            areas=trial.areas,
            size=self._points.size,
            reach=self.reach,
            look=self._sides.look,
            comm=self._comm,
        )

    def look(self, x: Floats) -> Seen:
        """The master where it is now from points of space, (n, 3), length."""
        return self._sides.look(x)

    def probe(
        self, laws: tuple[NormalLaw, Adhesion, Friction], state: State
    ) -> npt.NDArray[np.int8]:
        """Why other laws would fail in the reference configuration, codes of `FAILURE`, (n,)."""
        kept = self._law, self._answer
        self._law = ContactLaw(*laws).pairs(self._mirrored)
        answer = self._respond(state, self._sides.reference, 1.0, tangent=False).response
        self._law, self._answer = kept
        return answer.failure

    def lever(self) -> float:
        """Forces that would move every point of the trial to the origin, norm over this rank."""
        stiff = self._answer["stiffness"]
        return float(np.linalg.norm(stiff * np.linalg.norm(self.current.points, axis=1)))

    def _respond(self, state: State, now: Floats, dt: float, *, tangent: bool) -> Snapshot:
        return self._ask(self._law, state, self._project(now), dt, tangent=tangent)

    @property
    def _by_points(self) -> bool:
        """Whether every point has a block, as it hands over its own force or has multipliers."""
        return self._transfer is not None or self._semismooth is not None

    def _ask(
        self, law: FacetLaw, state: State, hit: FacetProjections, dt: float, *, tangent: bool
    ) -> Snapshot:
        """What a law answers where the points are; forces and blocks go to `_answer`."""
        question = Question(state, hit, self._now, dt, tangent, self._by_points)
        self._answer, snapshot = ask(self._sides, law, question)
        return snapshot

    def _hand_over(self, transfer: Transfer) -> None:
        """Let the forces on the master act where the overlaps have them."""
        now, answer = self.current, self._answer
        force = now.areas[:, None] * now.response.traction
        self._handed = transfer.update(self._now, force, now.response.status != 0)
        answer["residual"][self._handed, 3 * self._points.nodes.shape[1] :] = 0.0

    def _stiffness(self, diagonal: Floats) -> float:
        """Of both surfaces, one behind the other."""
        return self._sides.stiffness(diagonal)

    def _stiffen(self, normal: float, tangential: float) -> None:
        """Multiply the penalties of the law."""
        self._law = self._with(self._laws, normal, tangential)
        if self._semismooth is not None:
            self._stiff = self._with(self._stiff_laws, *self._semismooth.stiff_factors)

    def _with(self, laws: ContactLaw, normal: float, tangential: float) -> FacetLaw:
        stiff = laws if self._multipliers is None else laws.stiffened(normal, tangential)
        return stiff.pairs(self._mirrored)

    def _forget_base(self) -> None:
        self._base = self._linear = None

    def _begin(self) -> None:
        super()._begin()
        self._held = HeldFeet(len(self._points.nodes))

    def _tangents(self, state: State) -> Floats:
        """Tangents of the master of now, (n, 2, 3), length; any where a point has no facet."""
        return self._sides.tangents(state)

    def _place(self, state: State) -> tuple[Floats, Floats]:
        return self._sides.place(state)

    def _project(self, now: Floats) -> FacetProjections:
        before = self._hint
        self._hint = self._sides.project(now, before)
        held = self._held.points
        if held.any():
            self._hint = on_held_facets(self._sides, now, self._hint, before.facet, held)
        return self._hint

    def footing(self) -> npt.NDArray[np.int64]:
        """As of `ContactRecord`."""
        return footing(self._hint, self._gathered.globally(self._hint.facet))

    def hold(self, points: Mask) -> None:
        """As of `ContactRecord`."""
        self._held.points |= points

    def improve(self) -> bool:
        """As of `ContactRecord`; then points that are held beside their closest ones are let go."""
        return super().improve() or self._anywhere(self._let_go())

    def soften(self) -> bool:
        """As of `ContactRecord`; before that points that were let go are held as they were."""
        before = self._held.again()
        if before is not None:
            self._hint = before
        return self._anywhere(before is not None) or super().soften()

    def _let_go(self) -> bool:
        # with multipliers the way back costs more than the thousandth of a facet that may be wrong
        if self._multipliers is not None or not self._held.points.any():
            return False
        return self._held.let_go(self._hint, self._sides.project(self._now, self._hint))

    def _anywhere(self, here: bool) -> bool:
        return bool(self._comm.allreduce(int(here)))

    def strayed(self) -> Floats:
        """As of `ContactRecord`."""
        held = self._held.points
        wrong = np.zeros(len(held))
        if held.any():
            closest = self._sides.project(self._now, self._hint)
            both = held & located(closest) & located(self._hint)
            wrong[both] = np.abs(closest.gap - self._hint.gap)[both]
        return wrong
