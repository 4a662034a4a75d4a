"""The steps of a case."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from anisocontact.base.errors import within
from anisocontact.case.amplitudes import times
from anisocontact.case.load_curves import CaseLoadCurves
from anisocontact.case.model import Case, StepSection
from anisocontact.mesh import Model
from anisocontact.solver import Cylindrical, Step, Turn, Until

#: Supports and loads that points and edges have as well as facet groups.
ON_NODES = ("displacement", "cylindrical", "rotation", "force")


def steps_of(case: Case, model: Model, curves: CaseLoadCurves) -> list[Step]:
    """The steps, with what each prescribes over its time.

    Args:
        case: The case.
        model: Its mesh, with the groups that steps name.
        curves: Amplitudes and paths of the case.

    Raises:
        InputError: A group is unknown, or a step cannot be.
    """
    steps, begun = [], 0.0
    for i, section in enumerate(case.step):
        place = f"step[{i}]"
        for what, group in section.groups():
            known = model.nodes if what in ON_NODES else model.facets
            known(group, f"{place}.{what}")
        with within(place):
            event, probes = section.until, case.output.probe
            until = None if event is None else event.made(section.name, probes)
            steps.append(_step(section, curves, begun, _weights(case, section), until))
        begun += section.duration
    return steps


def _weights(case: Case, section: StepSection) -> dict[str, dict[str, Any]]:
    """Forces per volume of gravity, by body; bodies without weight have none."""
    given = {} if section.gravity is None else section.gravity.given()
    heavy = {name: table.density for name, table in case.material.items() if table.density}
    return {
        name: {axis: times(value, density) for axis, value in given.items()}
        for name, density in heavy.items()
        if given
    }


def _cylinders(
    section: StepSection, curves: CaseLoadCurves, begun: float
) -> dict[str, Cylindrical]:
    """Displacements prescribed along cylindrical directions."""
    found = {}
    for name, given in section.cylindrical.items():
        with within(f"cylindrical.{name}"):
            values = curves.values(given.given(), None, begun)
            found[name] = Cylindrical(values, given.axis, given.point)
    return found


def _step(
    section: StepSection,
    curves: CaseLoadCurves,
    begun: float,
    weights: Mapping[str, Any],
    until: Until | None,
) -> Step:
    def prescribed(kind: str) -> dict[str, dict[str, Any]]:
        return {
            name: curves.values(given.given(), getattr(given, "path", None), begun)
            for name, given in getattr(section, kind).items()
        }

    turns = {}
    for name, table in section.rotation.items():
        given = dict(table)
        if table.amplitude is not None:
            given["amplitude"] = curves.amplitude(table.amplitude, begun)
        with within(f"rotation.{name}"):
            turns[name] = Turn(**given)
    kinds = ("displacement", "motion", "load", "traction", "force", "anchor")
    weights = {name: curves.values(given, None, begun) for name, given in weights.items()}
    return Step(
        section.name,
        section.increments,
        duration=section.duration,
        pressure={group: curves.value(v, begun) for group, v in section.pressure.items()},
        temperature={body: curves.value(v, begun) for body, v in section.temperature.items()},
        rotation=turns,
        cylindrical=_cylinders(section, curves, begun),
        body_force=prescribed("body_force") | weights,
        until=until,
        **{kind: prescribed(kind) for kind in kinds},
    )
