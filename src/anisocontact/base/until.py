"""Events that end a step."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed

#: What can become of a contact, and the words for it.
CONTACT_EVENTS = {
    "closed": "contact begins",
    "lost": "contact is lost",
    "slipping": "the first point slips",
    "sliding": "all points in contact slip",
}
#: Where a value is looked at.
_PLACES = ("contact", "reaction", "displacement", "measure")

#: Value of the state in which a problem is, a trial in equilibrium or the accepted one; collective.
type Measure = Callable[[Any, bool], float]


@typed
@dataclass(frozen=True)
class Until:
    """An event at which a step ends: something becomes of a contact, or a value is reached.

    Args:
        contact: Name of a contact, or its slave if that has but one: its event, or the force on it.
        reaction: Facet group with supports, elastic ones included, or name of a spring: the force
            on the body, as `reactions` of the results have it.
        displacement: Facet group, or points and edges with a name: their mean displacement.
        measure: A function of the problem and of whether its state, which `problem.u` has, is a
            trial in equilibrium or the accepted one; it returns a number, the same on all
            processes. Reactions and other forces of the problem are those of that state, contacts
            have `last` of the accepted one. `anisocontact.results.probes.Peak` is one, of what
            probes see.
        event: One of "closed", "lost", "slipping", "sliding"; where that is so already it has to
            cease first.
        value: Force, displacement, or number of `measure` that is reached from either side.
        along: Direction of the component that is meant, of any size; the norm if not given. None of
            a measure.
        tolerance: Of the value relative to it; for events of a contact the share of an increment
            within which they happen.
        name: What messages call the measure.

    Raises:
        InputError: There is not exactly one place, or not one thing that can happen there.

    Example:
        >>> Until(contact="block.bottom", event="sliding").text
        "all points in contact slip at contact 'block.bottom'"
    """

    contact: str | None = None
    reaction: str | None = None
    displacement: str | None = None
    measure: Measure | None = None
    event: str | None = None
    value: float | None = None
    along: Sequence[float] | None = None
    tolerance: float = 1e-3
    name: str = "measure"

    def __post_init__(self) -> None:
        given = [name for name in _PLACES if getattr(self, name) is not None]
        if len(given) != 1:
            text = f"{' and '.join(given) or 'nothing'} given, one of {', '.join(_PLACES)} needed"
            raise InputError(text, "until")
        allowed = ("event", "value") if self.contact is not None else ("value",)
        if sum(getattr(self, name) is not None for name in ("event", "value")) != 1 or (
            self.event is not None and "event" not in allowed
        ):
            place = self.name if self.measure is not None else given[0]
            twice = "event and value given, " if self.event is not None is not self.value else ""
            text = f"{twice}with {place} one of {', '.join(allowed)} is needed"
            raise InputError(text, "until")
        if self.event is not None and self.event not in CONTACT_EVENTS:
            text = f"{self.event!r} given, must be one of {', '.join(CONTACT_EVENTS)}"
            raise InputError(text, "until.event")
        if self.along is not None and not (len(self.along) == 3 and math.hypot(*self.along) > 0.0):
            raise InputError(f"{self.along!r} given, three numbers, not all 0", "until.along")
        if self.measure is not None and self.along is not None:
            raise InputError("given with a measure, which is a number", "until.along")
        if self.value is not None and not math.isfinite(self.value):
            raise InputError(f"{self.value!r} given, a finite number needed", "until.value")
        is_norm = self.along is None and self.measure is None
        if self.value is not None and is_norm and not self.value >= 0.0:
            text = f"{self.value!r} given without along, so that it is a norm: must be >= 0"
            raise InputError(text, "until.value")
        if not 0.0 < self.tolerance < 1.0:
            text = f"{self.tolerance!r} given, must be > 0 and < 1"
            raise InputError(text, "until.tolerance")

    @property
    def text(self) -> str:
        """What happens, in words."""
        if self.event is not None:
            return f"{CONTACT_EVENTS[self.event]} at contact {self.contact!r}"
        if self.measure is not None:
            return f"{self.name} reaches {self.value:g}"
        kind = next(name for name in _PLACES if getattr(self, name) is not None)
        what = {"contact": "force of contact", "displacement": "displacement of"}.get(kind)
        what = what or "reaction of"
        along = "" if self.along is None else f" along ({', '.join(f'{v:g}' for v in self.along)})"
        return f"{what} {getattr(self, kind)!r}{along} reaches {self.value:g}"
