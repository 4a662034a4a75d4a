"""Table of the event at which a step ends."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

from pydantic import Field

from anisocontact.base.errors import InputError
from anisocontact.base.until import CONTACT_EVENTS, Until
from anisocontact.case.output import ProbeSection
from anisocontact.case.quantity import number, shown, word
from anisocontact.case.section import Section, near

#: Where a value is looked at.
_PLACES = ("contact", "reaction", "displacement", "probe")
_EVENTS = "; ".join(f"{name}: {text}" for name, text in CONTACT_EVENTS.items())


class UntilSection(Section):
    """Event at which a step ends before its end; prescribed values then stay as they are."""

    contact: str | None = Field(
        None,
        description='slave of a contact, "slave on master" where there are several: its event, or '
        "the force on it that is reached",
    )
    reaction: str | None = Field(
        None,
        description='facet group with supports, elastic ones included, "body.group", or a spring: '
        "its force on the body that is reached",
    )
    displacement: str | None = Field(
        None,
        description='facet group, or [nodes], "body.group": the mean displacement that is reached',
    )
    probe: str | None = Field(
        None,
        description="table of [output.probe]: the value of a quantity there that is reached; of "
        "several points the one of largest size",
    )
    quantity: str | None = Field(
        None, description="quantity of nodes that is meant at the probe, von_mises if left out"
    )
    component: str | None = Field(
        None,
        description="component of the quantity: x, y, z of a displacement, XX, YY, ZZ, XY, YZ, XZ "
        "of the stress, 1, 2, 3 of principal stresses",
    )
    event: Annotated[
        str | None, word(f"what becomes of the contact ({_EVENTS})", *CONTACT_EVENTS)
    ] = None
    value: Annotated[
        float | None,
        number("scalar", "force, length or stress", "value that is reached, from either side"),
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

    def made(self, step: str, probes: Mapping[str, ProbeSection]) -> Until:
        """The event.

        Args:
            step: Name of the step, for messages.
            probes: The probes of the case, by name.

        Raises:
            InputError: There is no such probe, or something that does not go with others.
        """
        given = dict(self)
        places = [place for place in _PLACES if given[place] is not None]
        if len(places) != 1:
            text = f"{' and '.join(places) or 'nothing'} given, one of {', '.join(_PLACES)} needed"
            raise InputError(text, "until")
        name, quantity, component = (given.pop(k) for k in ("probe", "quantity", "component"))
        if name is None:
            for key, value in (("quantity", quantity), ("component", component)):
                if value is not None:
                    raise InputError(f"{value!r} given without a probe", f"until.{key}")
            return Until(**given)
        if name not in probes:
            text = f"{shown(name)} given, no such probe; {near(name, list(probes))}"
            raise InputError(text, "until.probe")
        from anisocontact.results.probes import Peak

        quantity = quantity or "von_mises"
        said = f"{quantity}{'' if component is None else f' {component}'} at probe {name!r}"
        peak = Peak(probes[name].probe(), quantity, component, f"step {step!r}.until")
        return Until(measure=peak, name=said, **given)
