"""Surface and laws together: one contact interface, asked for a batch of points."""

from __future__ import annotations

from typing import Any

from anisocontact.base.renamed import renamed
from anisocontact.base.statuses import STATUS
from anisocontact.interface.augmentation import Augmentation
from anisocontact.interface.contact_law import VECTOR_FORMS, AdhesionAndFriction, ContactLaw
from anisocontact.interface.interface import Interface
from anisocontact.interface.law_in_series import LawInSeries
from anisocontact.interface.python_law import PythonLaw
from anisocontact.interface.states import (
    FAILURE,
    STATE,
    Response,
    SlaveSurface,
    State,
    as_state,
    raw_state,
)
from anisocontact.interface.tangential_law import (
    LawKinematics,
    LawResult,
    LawState,
    TangentialLaw,
)

__all__ = [
    "FAILURE",
    "STATE",
    "STATUS",
    "VECTOR_FORMS",
    "AdhesionAndFriction",
    "Augmentation",
    "ContactLaw",
    "Interface",
    "LawInSeries",
    "LawKinematics",
    "LawResult",
    "LawState",
    "PythonLaw",
    "Response",
    "SlaveSurface",
    "State",
    "TangentialLaw",
    "as_state",
    "raw_state",
]


def __getattr__(name: str) -> Any:
    return renamed(__name__, name)
