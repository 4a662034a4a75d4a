"""Two bodies with the same part in their contact: half of the work is done from each side."""

from __future__ import annotations

from typing import TypedDict, Unpack

import numpy as np
import numpy.typing as npt

from anisocontact.contact.facet_contact import FacetContact
from anisocontact.contact.record import ContactRecord, Snapshot
from anisocontact.interface import ContactLaw, Response
from anisocontact.mesh import Model

Floats = npt.NDArray[np.float64]


class PassOptions(TypedDict, total=False):
    """Arguments of `FacetContact` that are the same for both passes."""

    degree: int | None
    reach: float | None
    current_area: bool | None
    adjust: float | None


class TwoHalfPass(ContactRecord):
    """Contact of two facet groups, integrated on both with half the weight.

    Two of `FacetContact` with swapped parts, each with half of the area, so that neither side is
    preferred. What it reports is seen from the slave: a point of the second pass counts at its foot
    on the slave, with the reaction that acts there, so that sums over all points are forces,
    moments and energies of the pair. Directions are those of the first pass in the reference
    configuration; each pass carries them with the body that is its master.

    Args:
        model: Mesh with both groups.
        slave: Facet group "body.group" of the first pass.
        master: Facet group "body.group" that it meets.
        law: Laws of the interface, as of `FacetContact`.
        name: Name in output; the slave if not given.
        options: `degree`, `reach`, `current_area` and `adjust` of both passes, as of
            `FacetContact`.

    Attributes:
        passes: Both passes.
        facet_of_point: Number of each point's facet in the group it lies on, (n,).

    Raises:
        InputError: As of `FacetContact`.

    Example:
        >>> from anisocontact.interface import ContactLaw
        >>> from anisocontact.laws import Adhesion, Friction, NormalLaw
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> upper = BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))
        >>> lower = BoxSpec((-1, -1, -1), (3, 3, 1), (2, 2, 1))
        >>> model = build_box({"block": upper, "base": lower})
        >>> adhesion, friction = Adhesion(stiffness=(100, 100)), Friction(coefficients=(0.3, 0.3))
        >>> law = ContactLaw(NormalLaw(penalty=100.0), adhesion, friction)
        >>> pair = TwoHalfPass(model, "block.bottom", "base.top", law=law)
        >>> [half.slave for half in pair.passes]
        ['block.bottom', 'base.top']
    """

    def __init__(
        self,
        model: Model,
        slave: str,
        master: str,
        *,
        law: ContactLaw,
        name: str = "",
        **options: Unpack[PassOptions],
    ) -> None:
        self.master, self.groups = master, (slave, master)
        self.interface: ContactLaw = law
        self.passes = tuple(
            FacetContact(
                model,
                on,
                against,
                law=law,
                weight=0.5,
                mirrored=mirrored,
                overlaps=True,
                **options,
            )
            for on, against, mirrored in ((slave, master, False), (master, slave, True))
        )
        start = self._joined()
        facets = np.concatenate([half.facet_of_point for half in self.passes])
        super().__init__(model.space, slave, name or slave, start.response.state, start, facets)

    def update(self, u: Floats, dt: float) -> Response:
        """Response to nodal displacements from the committed history, kept as the trial.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            dt: Time increment.

        Returns:
            The response of both passes as seen from the slave.
        """
        for half in self.passes:
            half.update(u, dt)
        self._trial = self._joined()
        return self._trial.response

    def suit(self, diagonal: Floats) -> None:
        """As of `ContactRecord`."""
        for half in self.passes:
            half.suit(diagonal)
        self.body_stiffness = self.passes[0].body_stiffness

    def lay(self, compliance: float, dt: float) -> None:
        """As of `ContactRecord`, behind both passes."""
        for half in self.passes:
            half.lay(compliance, dt)

    def take_away(self) -> None:
        """As of `ContactRecord`."""
        for half in self.passes:
            half.take_away()

    @property
    def follows(self) -> bool:
        """As of `ContactRecord`."""
        return any(half.follows for half in self.passes)

    def held(self) -> bool:
        """As of `ContactRecord`."""
        return all([half.held() for half in self.passes])

    def take_share(self, share: float) -> None:
        """As of `ContactRecord`."""
        for half in self.passes:
            half.take_share(share)

    def add_lag(self, out: Floats) -> None:
        """As of `ContactRecord`."""
        for half in self.passes:
            half.add_lag(out)

    def suit_strain(self, finite: bool) -> None:
        """As of `ContactRecord`."""
        for half in self.passes:
            half.suit_strain(finite)

    def commit(self) -> None:
        """Make the trial the history."""
        for half in self.passes:
            half.commit()
        # points of the second pass come from under an end of the slave whenever it moves
        self.ran_off = self.passes[0].ran_off
        super().commit()

    def roll_back(self) -> None:
        """Forget the trial."""
        for half in self.passes:
            half.roll_back()
        super().roll_back()

    def footing(self) -> npt.NDArray[np.int64]:
        """Of both passes, see `ContactRecord.footing`."""
        return np.concatenate([half.footing() for half in self.passes])

    def hold(self, points: npt.NDArray[np.bool_]) -> None:
        """In both passes, see `ContactRecord.hold`."""
        first = len(self.passes[0].state)
        for half, its in zip(self.passes, np.split(points, [first]), strict=True):
            half.hold(its)

    def improve(self) -> bool:
        """In both passes, see `FacetContact.improve`."""
        return any([half.improve() for half in self.passes])

    def soften(self) -> bool:
        """In both passes, see `FacetContact.soften`."""
        return any([half.soften() for half in self.passes])

    def strayed(self) -> Floats:
        """Of both passes, see `ContactRecord.strayed`."""
        return np.concatenate([half.strayed() for half in self.passes])

    @property
    def parts(self) -> tuple[ContactRecord, ...]:
        """Both passes."""
        return self.passes

    def rejoin(self) -> None:
        """Take over what both passes have restored."""
        self._trial = None
        self._accepted = self._joined()
        self.state = self.last.state

    def elastic_slip(self) -> Floats:
        """Elastic part of the displacement of the slave relative to the master, (n, 3), length."""
        first, second = self.passes
        return np.concatenate([first.elastic_slip(), -second.elastic_slip()])

    @property
    def retraceable(self) -> bool:
        """As of `ContactRecord`, of both passes."""
        return all(half.retraceable for half in self.passes)

    def energies(self) -> dict[str, float]:
        """As of `ContactRecord`, with "transfer" of both passes, see `Transfer`."""
        transfer = sum(half.energies()["transfer"] for half in self.passes)
        return super().energies() | {"transfer": transfer}

    def add_force(self, out: Floats) -> None:
        """Add the forces of the trial on both bodies to the local nodes, (nodes, 3), force."""
        for half in self.passes:
            half.add_force(out)

    def lever(self) -> float:
        """Forces that would move every point of the trial to the origin, norm over this rank."""
        first, second = self.passes
        return float(np.hypot(first.lever(), second.lever()))

    def _joined(self) -> Snapshot:
        """Points of both passes as seen from the slave."""
        a, b = (half.current for half in self.passes)
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
        return Snapshot(
            np.concatenate([a.points, feet]), np.concatenate([a.areas, b.areas]), response
        )
