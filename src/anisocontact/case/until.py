"""Table of the event at which a step ends."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from anisocontact.base.until import CONTACT_EVENTS, Until
from anisocontact.case.quantity import number, word
from anisocontact.case.section import Section

__all__ = ["UntilSection"]

_EVENTS = "; ".join(f"{name}: {text}" for name, text in CONTACT_EVENTS.items())


class UntilSection(Section):
    """Event at which a step ends before its end; what it leads then stays where it is."""

    contact: str | None = Field(
        None,
        description='slave of a contact, "slave on master" where there are several: its event, or '
        "the force on it that is reached",
    )
    reaction: str | None = Field(
        None, description='facet group with supports, "body.group": their force that is reached'
    )
    displacement: str | None = Field(
        None,
        description='facet group, or [nodes], "body.group": the mean displacement that is reached',
    )
    event: Annotated[
        str | None, word(f"what becomes of the contact ({_EVENTS})", *CONTACT_EVENTS)
    ] = None
    value: Annotated[
        float | None, number("scalar", "force or length", "value that is reached, from either side")
    ] = None
    along: Annotated[
        tuple[float, float, float] | None,
        number("vector", "1", "direction of the component that is meant; the norm if left out"),
    ] = None
    tolerance: Annotated[
        float,
        number(
            "scalar",
            "1",
            "of the value, relative; for events of a contact the share of an increment within "
            "which they happen",
            "positive",
            most=1.0,
        ),
    ] = Until.tolerance
