"""What a case file says of rigid bodies as a whole."""

from __future__ import annotations

from collections.abc import Iterator

from anisocontact.base.errors import InputError
from anisocontact.case.load_curves import prescribed_axes
from anisocontact.case.model import Case, StepSection
from anisocontact.case.section import near


def check_rigid(case: Case) -> Iterator[InputError]:
    """Mistakes in rigid bodies, their motion and their loads, each as an error not raised."""
    yield from _surfaces(case)
    free: dict[str, set[str]] = {name: set() for name in case.rigid}
    ever = set()
    for i, step in enumerate(case.step):
        yield from _step(case, step, f"step[{i}]", free)
        ever |= {name for name, components in free.items() if components}
    for name, section in case.rigid.items():
        if section.springs.given() and name not in ever:
            text = 'given, but no step frees a component of the body: motion = "free" needed'
            yield InputError(text, field=f"rigid.{name}.springs")


def _surfaces(case: Case) -> Iterator[InputError]:
    masters = {contact.master for contact in case.contact}
    carried: dict[str, str] = {}
    for name, section in case.rigid.items():
        place = f"rigid.{name}" + ("" if section.surfaces is None else ".surfaces")
        surfaces = section.carries(name)
        if not surfaces and not section.faces:
            yield InputError("empty, at least one surface needed", field=place)
        for surface in surfaces:
            if surface not in case.surface:
                text = f'"{surface}" is no surface; {near(surface, list(case.surface))}'
                yield InputError(text, field=place)
            elif surface in carried:
                other = carried[surface]
                yield InputError(f'"{surface}" belongs to rigid.{other} already', field=place)
            carried.setdefault(surface, name)
        if (
            surfaces
            and not section.faces
            and not masters.intersection(surfaces)
            and set(surfaces) <= set(case.surface)
        ):
            yield InputError("no contact has a surface of this body as its master", field=place)


def _step(
    case: Case, step: StepSection, place: str, free: dict[str, set[str]]
) -> Iterator[InputError]:
    turned = [name for name in step.rotation if "." not in name]
    for what, names in (("motion", step.motion), ("load", step.load), ("rotation", turned)):
        for name in names:
            if name not in case.rigid:
                yield InputError(_unknown(case, name), field=f"{place}.{what}")
    for name in turned:
        free[name] = set()
        if name in step.motion:
            text = "given with a motion of the same body, one of the two is allowed"
            yield InputError(text, field=f"{place}.rotation.{name}")
    for name, motion in step.motion.items():
        for component, value in motion.components().items():
            change = free.setdefault(name, set())
            (change.add if value is None else change.discard)(component)
        free[name] -= set(prescribed_axes(case, motion.path))
    for name, load in step.load.items():
        for component in load.given():
            if name in case.rigid and component not in free[name]:
                key = f"{component}_deg" if component.startswith("r") else component
                text = f'the component is fixed; motion.{name}.{key} = "free" lets a load act on it'
                yield InputError(text, field=f"{place}.load.{name}.{component}")


def _unknown(case: Case, name: str) -> str:
    if name in case.surface:
        return f'surface "{name}" rests; a table [rigid.{name}] with a reference point moves it'
    return f'"{name}" given, no such rigid body; {near(name, list(case.rigid))}'
