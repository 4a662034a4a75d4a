"""What an output quantity of slave points is made of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.array_types import Locals


@dataclass(frozen=True)
class SlavePoints:
    """The slave points of a contact on this rank, in the accepted state.

    Args:
        number: Which contact.
        contact: The contact.

    Example:
        Where points have slid most, as an array of one's own in `slave_points`:

        >>> from anisocontact import Adhesion, Contact, ContactLaw, Friction, NormalLaw
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> from anisocontact.surfaces import make_surface
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> adhesion, friction = Adhesion(stiffness=(1, 1)), Friction(coefficients=(0.3, 0.3))
        >>> law = ContactLaw(NormalLaw(penalty=100.0), adhesion, friction)
        >>> points = SlavePoints(0, Contact(model, "block.bottom", plane, law))
        >>> points.state["slip_accumulated"].tolist(), points.numbers.tolist()
        ([0.0, 0.0, 0.0, 0.0], [0, 0, 0, 0])
    """

    number: int
    contact: Any

    @property
    def last(self) -> Any:
        """Response of the laws: `gap`, `pressure`, `traction`, `status`, ..., (n, ...)."""
        return self.contact.last

    @property
    def state(self) -> Any:
        """History: records with `slip_accumulated`, `dissipation`, ..., (n,)."""
        return self.contact.state

    @property
    def numbers(self) -> Locals:
        """Number of the contact for each point, (n,)."""
        return np.full(len(self.contact.areas), self.number, dtype=np.int32)
