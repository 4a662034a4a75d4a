"""Surface and laws together: one contact interface, asked for a batch of points."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

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

if TYPE_CHECKING:
    from anisocontact.anisotropy import DirectionField
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.surfaces import Surface


def _python_interface(
    surface: Surface,
    normal: NormalLaw,
    law: TangentialLaw,
    *,
    directions: DirectionField | None = None,
    threads: int | None = None,
) -> Interface:
    return Interface(surface, normal, PythonLaw(law, directions=directions), threads=threads)


def _pair_law(
    normal: NormalLaw, adhesion: Adhesion, friction: Friction, *, evolution: str = "transport"
) -> ContactLaw:
    made = ContactLaw(normal, adhesion, friction, evolution=evolution)
    made.check_meshed()
    return made


def _python_pair_law(
    normal: NormalLaw,
    law: TangentialLaw,
    *,
    directions: DirectionField | None = None,
    directions_on: str = "master",
) -> ContactLaw:
    own = PythonLaw(law, directions=directions, directions_on=directions_on)
    made = ContactLaw(normal, own)
    made.check_meshed()
    return made


#: Names of before and what they were, which work for one more version.
_BEFORE = {
    "PairLaw": ("ContactLaw", _pair_law),
    "PythonInterface": ("Interface with a PythonLaw", _python_interface),
    "PythonPairLaw": ("ContactLaw with a PythonLaw", _python_pair_law),
}


def __getattr__(name: str) -> Any:
    if name not in _BEFORE:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    today, made = _BEFORE[name]
    warnings.warn(f"{name} is now {today}", DeprecationWarning, stacklevel=2)
    return made
