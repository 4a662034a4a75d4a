"""Names of contacts before there was one `Contact`: for one version, with a warning."""

from __future__ import annotations

from typing import Any, TypedDict, Unpack

import numpy as np
import numpy.typing as npt

from anisocontact.contact.contact import Contact
from anisocontact.contact.making import Options, facet_pass
from anisocontact.interface import ContactLaw
from anisocontact.mesh import Model

Ints = npt.NDArray[np.int32]


class _Given(TypedDict, total=False):
    """Arguments that `Contact` has as well."""

    degree: int | None
    reach: float | None
    current_area: bool | None
    adjust: float | None


class FacetContact(Contact):
    """`Contact(model, slave, master, law)` with a facet group as the master."""

    def __init__(
        self,
        model: Model,
        slave: str,
        master: str,
        *,
        law: ContactLaw,
        weight: float = 1.0,
        mirrored: bool = False,
        name: str = "",
        **options: Any,
    ) -> None:
        half = facet_pass(
            model, slave, master, law, Options(**options), weight=weight, mirrored=mirrored
        )
        self._compose((half,), name)


class TwoHalfPass(Contact):
    """`Contact(model, slave, master, law, two_half=True)`."""

    def __init__(
        self,
        model: Model,
        slave: str,
        master: str,
        *,
        law: ContactLaw,
        name: str = "",
        **options: Unpack[_Given],
    ) -> None:
        super().__init__(model, slave, master, law, two_half=True, name=name, **options)


class SelfContact(Contact):
    """`Contact(model, group, group, law, self_contact=True)`."""

    def __init__(
        self,
        model: Model,
        group: str,
        *,
        law: ContactLaw,
        degree: int | None = None,
        apart: float | None = None,
        reach: float | None = None,
        current_area: bool | None = None,
        name: str = "",
    ) -> None:
        super().__init__(
            model,
            group,
            group,
            law,
            degree=degree,
            apart=apart,
            reach=reach,
            current_area=current_area,
            self_contact=True,
            name=name,
        )
