"""What a pass over slave points is composed of, as its parts see each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol, Self

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Codes, Flags, Floats, Ints, Locals
from anisocontact.contact.history import Snapshot
from anisocontact.contact.quadrature import Couplings
from anisocontact.contact.reachable import NodePairs
from anisocontact.contact.side_of_master import Seen, SideOfMaster
from anisocontact.interface import Response, State
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.rigid import RigidBody

#: Local nodes that supports hold along a direction, (nodes,), and the direction, (3,).
type Resting = tuple[Flags, Floats]


class Answer(Protocol):
    """What laws answer at slave points at one state, as forces on nodes and their derivative."""

    @property
    def snapshot(self) -> Snapshot:
        """The points."""

    @property
    def stiffness(self) -> Floats:
        """Size of the derivative of the force of each point, (n,), force/length."""

    def add_force(self, out: Floats) -> None:
        """Add the forces on both bodies to the local nodes, (nodes, 3), force."""

    def couplings(self) -> list[Couplings]:
        """Where `-d force / d u` has entries, and the entries."""

    def by_derivative(self, other: Any, stiffness: Floats) -> Self:
        """The same with the derivative of another one.

        Args:
            other: The other.
            stiffness: Of the laws themselves, as of `stiffness`.
        """


class Linear(Protocol):
    """Linear change of the tractions about a trial, in the frame of the master."""

    def change(self) -> Floats | None:
        """Where the nodes have moved since, (n, 3), stress; None where they have not."""

    def slipped(self, slip: Floats) -> Floats:
        """With `slip` of points that stay where they are, (n, 3), stress.

        Args:
            slip: Along the surface, and along the normal of the gap, (n, 3), length.
        """

    def add_force(self, slip: Floats, out: Floats) -> None:
        """Add the forces on the nodes that belong to `slip`, (nodes, 3), force."""


class Master(Protocol):
    """What slave points meet, with the laws that are asked there: analytic, moving or meshed.

    It calculates in a frame of its own, that of the surface as it was drawn.

    Attributes:
        groups: Facet group of it, if it is one.
        body: Rigid body that carries it, if one does.
        size: Length of its facets, 0 if it has none.
        extent: Lengths that it is computed from beside places of nodes, to a share of which its own
            places are rounded.
        reach: Distance within which it is searched, length.
        retraceable: Whether it answers at any state from the accepted one as if nothing was before.
    """

    groups: tuple[str, ...] = ()
    body: RigidBody | None = None
    size: float = 0.0
    extent: float = 0.0
    reach: float = np.inf
    retraceable: bool = True

    def connected_to_slave(self) -> bool:
        """Whether a connected part of the mesh has facets of both sides; collective."""
        return False

    def initial_state(self) -> State:
        """State of the points before the first step, free of force."""

    def take(self, laws: Any, derivative: Any) -> None:
        """Let other laws answer, and others where `answer` is asked for the derivative."""

    def place(self, u: Floats, *histories: State) -> bool:
        """Go where nodes are displaced by u, (nodes, 3), length; collective.

        Args:
            u: Displacement of the local nodes.
            histories: Of the points, in which numbers of facets may have to be others.

        Returns:
            Whether linear changes of before are to be forgotten.
        """

    def answer(
        self,
        state: State,
        dt: float,
        *,
        tangent: bool = True,
        derivative: bool = False,
        separate: bool = False,
    ) -> Any:
        """What the laws answer where the nodes are; nothing is changed.

        Args:
            state: State to start from.
            dt: Time increment.
            tangent: Whether derivatives are needed.
            derivative: Whether the laws of the derivative are asked.
            separate: Whether every point has to have a force of its own, for `linear`.
        """

    def failed_point(self, i: int, state: State, dt: float, **of_point: Any) -> Any:
        """A point at which the laws fail where the nodes are, whole, see `FailedPoint`.

        Args:
            i: The point.
            state: State to start from, of all points.
            dt: Time increment.
            **of_point: What else is said of it.
        """

    def linear(self, answer: Any) -> Linear:
        """Linear change about an answer."""

    def here(self, state: State, dt: float) -> State:
        """A state at the coordinates where the points are."""

    def at(self, state: State) -> tuple[Floats, Floats]:
        """Its places at the coordinates of a state, (n, 3), and its tangents, (n, 2, 3), length."""

    def located(self, state: State) -> Flags:
        """Whether each point of a state has a surface below it, (n,)."""
        return np.ones(len(state), dtype=bool)

    def into_frame(self, vectors: Floats) -> Floats:
        """Vectors of space in the frame of the master, (..., 3)."""
        return vectors

    def out_of_frame(self, vectors: Floats) -> Floats:
        """Vectors of the frame of the master in space, (..., 3)."""
        return vectors

    def stiffness(self, diagonal: Floats) -> float:
        """Traction per displacement of a single node, mean over the surface, stress/length.

        Args:
            diagonal: Diagonal of the stiffness of the bodies, of the nodes this rank owns,
                (nodes, 3), force/length.
        """

    def yields(self, diagonal: Floats) -> float:
        """How many times as far as the slave it gives way; 0 for a surface.

        Args:
            diagonal: As of `stiffness`.
        """
        return 0.0

    def couplable(self) -> Locals:
        """Local nodes that the contact acts on; all ranks together have all of them."""

    def take_resting(self, resting: Sequence[Resting], state: State) -> None:
        """Learn which nodes are held along directions from now on.

        Args:
            resting: The nodes and directions.
            state: Committed state, whose coordinates lose what is along them.
        """
        return

    @property
    def held(self) -> Floats | None:
        """Projection on directions along which supports hold points and master, (n, 3, 3), if any.

        Tractions of the trial have nothing along them.
        """
        return None

    def resting(self, normal: Floats) -> Floats | None:
        """Projection on directions across which neither points nor master move, (n, 3, 3), if any.

        Tractions of the trial have what multipliers have along them.

        Args:
            normal: Of the surface, in its frame, (n, 3).
        """
        return None

    def take_fixed(self, fixed: Floats) -> None:
        """Learn along which directions local nodes are prescribed; collective.

        Args:
            fixed: Projections on these, (nodes, 3, 3).
        """
        return

    def immovable(self, normal: Floats) -> bool | Flags:
        """Whether it cannot give way, as a whole or along the normal of each point, (n, 3)."""
        return self.body is None or not self.body.free

    def local_names(self, nodes: Locals) -> Locals:
        """Nodes of the slave points as those of the mesh, of which they may be images."""
        return nodes

    def feet(self) -> Locals:
        """Nodes of the master below points of the trial, named as in `Couplings`."""
        return np.zeros(0, dtype=np.int32)

    def opposite(self) -> tuple[Locals, Locals, Floats] | None:
        """What each slave node is held against in the trial, where points are slave nodes.

        Returns:
            Local slave nodes (n,), those of the master (n, k), -1 for none, and the share of each
            in the place opposite; None where forces follow no such mean.
        """
        return None

    def below(self, state: State) -> Locals:
        """Nodes of the master below points of a state, named as in `Couplings`."""
        return np.zeros(0, dtype=np.int32)

    def reachable(self, way: Floats, margin: float, hops: int) -> list[NodePairs]:
        """Nodes that couplings can name where the slave goes along a way, see `reachable`.

        Args:
            way: Displacement against the master at places along the way, of each point or one for
                all, (w, n or 1, 3), length.
            margin: How far beside the way a point can be, length.
            hops: Places along the way that an increment goes.
        """
        return []

    def slid(self, state: State) -> Floats:
        """How far the foot of each point has slid since a state, (n, 3), length."""
        return np.zeros((len(state), 3))

    def look(self, x: Floats) -> Seen:
        """The master where it is now from points of space, (n, 3), length."""

    def side_of_master(
        self, u: Floats, before: Snapshot, state: State, now: Snapshot
    ) -> SideOfMaster:
        """Where points are beside the master, in its frame; collective.

        Args:
            u: Displacement of the local nodes in the trial, (nodes, 3), length.
            before: The points in the accepted state.
            state: Their state.
            now: The points in the trial.
        """

    def probe(self, laws: tuple[NormalLaw, Adhesion, Friction], state: State) -> Codes:
        """Why other laws would fail in the reference configuration, codes of `FAILURE`, (n,)."""

    def projected_facets(self, count: int) -> Ints:
        """The facet, or feature of one, below each point in the trial, a code (n,).

        Facets are numbered in the whole group; a smooth master is one.
        """
        return np.zeros(count, dtype=np.int64)

    def hold(self, points: Flags) -> None:
        """Hold points on the facet that they are on until the trial is kept or forgotten, (n,)."""
        return

    def facing(self, normal: Floats) -> Floats:
        """How much slave points face the master where they are, 1 for wholly, (n,).

        Args:
            normal: Outward normals of the master there, (n, 3). Facets that do not face each other
                do not meet.
        """
        return np.ones(len(normal))

    def strayed(self, count: int) -> Floats:
        """How wrong the gaps of held points are: against those of the closest points, (n,), length.

        It is zero where a point is above the facet on which it is held.
        """
        return np.zeros(count)

    def let_go(self) -> bool:
        """Let points go that are held beside their closest ones; whether there are any."""
        return False

    def hold_again(self) -> bool:
        """Hold what was let go, after a solution that failed; whether there was any."""
        return False

    def beyond(self, state: State) -> Flags:
        """Points of the accepted state, which is given, that are beyond its border, (n,)."""
        return np.zeros(len(state), dtype=bool)

    def from_afar(self, start: State) -> Flags:
        """Points of which nothing says how they slid to where they are now, (n,).

        Args:
            start: What trials start from.
        """
        return np.zeros(len(start), dtype=bool)

    def begin(self, state: State) -> State:
        """Take it that trials start from the accepted state.

        Args:
            state: The accepted state.

        Returns:
            What trials start from: points that no master was below can have a place as well.
        """
        return state

    def anchor(self, start: State) -> None:
        """Let points that came to lie in the trial count slip from there; collective.

        Args:
            start: What the next trials start from, which names where they are; changed where it is
                named otherwise from now on.
        """
        return

    def commit(self, before: Snapshot, state: State, now: Snapshot | None) -> Floats:
        """Make the trial the history; collective.

        Args:
            before: The points in the accepted state.
            state: Their state.
            now: The points in the trial, if there was one.

        Returns:
            Points that have left its end, of all ranks, (k, 3).
        """
        return np.zeros((0, 3))

    def roll_back(self, tried: bool) -> None:
        """Forget the trial, if there was one."""
        return

    def persistent(self, kept: dict[str, npt.NDArray[Any]]) -> dict[str, npt.NDArray[Any]]:
        """What the next increments depend on, an entry for each point.

        Args:
            kept: What the pass has, with copies of its own.
        """
        return kept

    def restore(
        self, kept: Mapping[str, npt.NDArray[Any]], u: Floats
    ) -> Mapping[str, npt.NDArray[Any]]:
        """Go on from what `persistent` gave; the same for the pass.

        Args:
            kept: The state.
            u: Displacement of the local nodes in that state, (nodes, 3), length.
        """
        return kept

    def axes(self, answer: Response) -> Floats:
        """Axes of adhesion in the frame of the master, (n, 2, 3)."""
        return self.into_frame(answer.directions_adhesion)
