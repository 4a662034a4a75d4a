"""What Newton's method asks of a system of equations."""

from __future__ import annotations

from contextlib import AbstractContextManager
from typing import Any, Protocol

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import Mat, Vec
from anisocontact.bulk.followed_pressures import FollowedPressures
from anisocontact.solver.system.force_balance import ForceBalance
from anisocontact.solver.terms.contacts import Contacts


class System(Protocol):
    """What Newton asks of a system of equations; see `Problem`."""

    @property
    def balance(self) -> ForceBalance:
        """Forces of the last evaluation."""
        ...

    @property
    def contact_term(self) -> Contacts:
        """Its contacts, whose multipliers may follow every correction."""
        ...

    @property
    def outgrown(self) -> bool:
        """Whether the last evaluation left what the system keeps in reach."""
        ...

    @property
    def comm(self) -> Any:
        """Communicator of the unknowns."""
        ...

    def new_vector(self) -> Vec:
        """Vector of the unknowns."""
        ...

    def new_tangent(self) -> Mat:
        """Matrix for `tangent`."""
        ...

    def evaluate(self, x: Vec) -> Floats:
        """Residual of the unknowns this rank owns; NaN everywhere where a law has no answer."""
        ...

    def tangent(self, x: Vec, out: Mat) -> bool:
        """Write d residual / d x into a matrix of `new_tangent`; whether its pattern has grown.

        Raises:
            SingularError: It has no inverse.
        """
        ...

    def take_elastic_share(self, elastic_share: float) -> None:
        """Let the next tangents have a share of the elastic one where bodies flow."""
        ...

    def linearised(self) -> AbstractContextManager[None]:
        """Around evaluations and tangents in which bodies answer as their last tangent says."""
        ...

    @property
    def followed(self) -> FollowedPressures | None:
        """Pressures that follow corrections, if there are any."""
        ...

    def corrected(self, searching: bool) -> AbstractContextManager[bool]:
        """Around Newton's method: whether corrections are to be taken in full.

        Args:
            searching: Whether it has a line search of ours, without which pressures of bodies that
                penalties press do not follow corrections. Nor do those of metal, whose node at rest
                is hardly stiffer against changes of volume than of shape.
        """
        ...

    def improve(self, x: Vec) -> bool:
        """Take what the equilibrium `x` says of multipliers; whether it has to be found again.

        Raises:
            NotHeldError: They do not converge.
            LostError: A body has got where it cannot be.
        """
        ...

    def soften(self) -> bool:
        """After a solution that failed: take penalties that are easier; whether to try again."""
        ...
