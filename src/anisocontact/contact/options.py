"""What may be said of a contact beside its sides and its laws."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.contact.defaults import takes_nodes
from anisocontact.contact.quadrature import chosen_degree
from anisocontact.interface.augmentation import Augmentation
from anisocontact.mesh import Model


@dataclass(frozen=True)
class ContactOptions:
    """Arguments of `Contact` that have a default."""

    degree: int | None = None
    current_area: bool | None = None
    augmentation: Augmentation | None = None
    adjust: float | None = None
    reach: float | None = None
    self_contact: bool = False
    apart: float | None = None
    mortar: bool | None = None

    def __post_init__(self) -> None:
        for name in ("adjust", "reach", "apart"):
            given = getattr(self, name)
            if given is not None and not np.isfinite(given):
                raise InputError(f"{given!r} given, a finite number needed", name)

    def decided(self, model: Model, slave: str, master: str | None) -> ContactOptions:
        """Options that say where the law is evaluated."""
        if self.mortar is not None and not self.self_contact:
            return self
        nodes = self.self_contact or takes_nodes(model, slave, master, self.degree)
        return replace(self, mortar=nodes)

    def chosen_degree(self, model: Model) -> int:
        """Degree of the quadrature."""
        return chosen_degree(self.degree, model.order, self.augmentation is not None)
