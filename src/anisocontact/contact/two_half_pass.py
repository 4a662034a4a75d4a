"""Two bodies with the same part in their contact: half of the work is done from each side."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.augmentation import Augmentation
from anisocontact.contact.facet_contact import FacetContact
from anisocontact.contact.record import ContactRecord, Snapshot
from anisocontact.interface import PairLaw, Response
from anisocontact.mesh import Model

Floats = npt.NDArray[np.float64]


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
        law: Laws of the interface.
        degree: Degree of the quadrature; if not given twice the order of the displacement, with an
            augmentation the order.
        reach: Distance within which each searches the other, length; twice the size of the facets
            that search if not given.
        current_area: Whether tractions act on the area of now (finite strain) or of the reference.
        augmentation: How exactly both passes are to hold; by their penalties alone if not given.
        adjust: Gaps up to this one are closed and overlaps taken out before the first step, see
            `adjusted`, length; nothing if not given.
        name: Name in output; the slave if not given.

    Attributes:
        passes: Both passes.
        facet_of_point: Number of each point's facet in the group it lies on, (n,).

    Raises:
        InputError: As of `FacetContact`.
    """

    def __init__(
        self,
        model: Model,
        slave: str,
        master: str,
        *,
        law: PairLaw,
        degree: int | None = None,
        reach: float | None = None,
        current_area: bool = True,
        augmentation: Augmentation | None = None,
        adjust: float | None = None,
        name: str = "",
    ) -> None:
        self.master = master
        self.interface = law
        self.passes = tuple(
            FacetContact(
                model,
                on,
                against,
                law=law,
                degree=degree,
                reach=reach,
                current_area=current_area,
                augmentation=augmentation,
                adjust=adjust,
                weight=0.5,
                mirrored=mirrored,
                overlaps=True,
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

    def energies(self) -> dict[str, float]:
        """As of `ContactRecord`, with "transfer" of both passes, see `Transfer`."""
        transfer = sum(half.energies()["transfer"] for half in self.passes)
        return super().energies() | {"transfer": transfer}

    def add_force(self, out: Floats) -> None:
        """Add the forces of the trial on both bodies to the local nodes, (nodes, 3), force."""
        for half in self.passes:
            half.add_force(out)

    def add_lag(self, out: Floats) -> None:
        """As of `ContactRecord`."""
        for half in self.passes:
            half.add_lag(out)

    @property
    def follows(self) -> bool:
        """Whether multipliers follow every step of Newton's method."""
        return self.passes[0].follows

    def held(self) -> bool:
        """Whether multipliers that follow are what the trial answers to them, in both passes."""
        return all([half.held() for half in self.passes])

    def suit(self, diagonal: Floats) -> None:
        """Suit multipliers that follow to the bodies, see `ContactRecord.suit`."""
        for half in self.passes:
            half.suit(diagonal)

    def take_share(self, share: float) -> None:
        """Take only a share of the next step of multipliers that follow."""
        for half in self.passes:
            half.take_share(share)

    def improve(self) -> bool:
        """Better multipliers of both passes, see `ContactRecord.improve`."""
        return any([half.improve() for half in self.passes])

    def soften(self) -> bool:
        """Softer penalties of both passes after a solution that failed; whether any."""
        return any([half.soften() for half in self.passes])

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
