"""Surface and laws together: one contact interface, asked for a batch of points."""

from anisocontact.interface.augmentation import Augmentation
from anisocontact.interface.interface import VECTOR_FORMS, Interface, PairLaw
from anisocontact.interface.python_law import (
    LawInSeries,
    LawKinematics,
    LawResult,
    LawState,
    PythonInterface,
    TangentialLaw,
)
from anisocontact.interface.python_pair import PythonPairLaw
from anisocontact.interface.states import (
    FAILURE,
    STATE,
    STATUS,
    Response,
    SlaveSurface,
    State,
    as_state,
    raw_state,
)

__all__ = [
    "FAILURE",
    "STATE",
    "STATUS",
    "VECTOR_FORMS",
    "Augmentation",
    "Interface",
    "LawInSeries",
    "LawKinematics",
    "LawResult",
    "LawState",
    "PairLaw",
    "PythonInterface",
    "PythonPairLaw",
    "Response",
    "SlaveSurface",
    "State",
    "TangentialLaw",
    "as_state",
    "raw_state",
]
