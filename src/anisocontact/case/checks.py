"""What the file says as a whole: names that must exist, values that only an object can judge."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.base.words import meant
from anisocontact.case import law_file, objects
from anisocontact.case.load_curves import check_load_curves
from anisocontact.case.model import (
    AUGMENTED,
    MORTAR,
    PENALTY,
    Case,
    ContactSection,
    StepSection,
)
from anisocontact.case.output import check_output
from anisocontact.case.python_section import MaterialTable
from anisocontact.case.rigid_checks import check_rigid
from anisocontact.case.section import near
from anisocontact.case.ties import TieSection
from anisocontact.case.units import check_units
from anisocontact.interface.augmentation import AUTO as AUTO_MULTIPLIERS
from anisocontact.surfaces import Surface


def check(case: Case) -> Iterator[InputError]:
    """Mistakes that can be found without a mesh, each as an error that is not raised."""
    if wrong := list(_names(case)):  # of which all else would follow
        yield from wrong
        return
    yield from _mesh(case)
    for name, section in case.material.items():
        if not isinstance(section, MaterialTable):  # which `build` looks at
            _, error = _tried(objects.material, section, f"material.{name}")
            yield from error
    surfaces: dict[str, Surface | None] = {}
    for name, section in case.surface.items():
        surfaces[name], error = _tried(objects.surface, section, f"surface.{name}")
        yield from error
    pairs = [
        {contact.slave, contact.master} if contact.meshed else (contact.slave, contact.master)
        for contact in case.contact
    ]
    for i, contact in enumerate(case.contact):
        yield from _contact(case, contact, f"contact[{i}]", surfaces)
        if (first := pairs.index(pairs[i])) != i:
            yield InputError(f"same pair as contact[{first}]", field=f"contact[{i}]")
    yield from check_rigid(case)
    yield from _tied(case)
    yield from _held(case)
    yield from _points_and_faces(case)
    yield from _steps(case)
    yield from check_load_curves(case)
    yield from check_units(case.units)
    end = sum(step.duration for step in case.step)
    yield from check_output(case.output, [step.name for step in case.step], end)
    smallest, largest = case.solver.smallest_increment, case.solver.largest_increment
    if smallest > largest:
        text = f"{smallest!r} given, must be at most solver.largest_increment, {largest!r}"
        yield InputError(text, field="solver.smallest_increment")


def _mesh(case: Case) -> Iterator[InputError]:
    shaped = [
        (f"mesh.{shape}.{name}", name, section)
        for shape, bodies in case.mesh.shaped().items()
        for name, section in bodies.items()
    ]
    if not (shaped or case.mesh.from_files):
        text = "nothing given, mesh.file or a shape such as [mesh.box.<body>] needed"
        yield InputError(text, field="mesh")
    places: dict[str, str] = {}
    misspelt = _misspelt(case)
    for name, body in misspelt.items():
        yield InputError(f'no such body; did you mean "{body}"?', field=f"material.{name}")
    for place, name, section in shaped:
        yield from _tried(objects.body, section, name, place)[1]
        if (first := places.setdefault(name, place)) != place:
            yield InputError(f"{first} has that name already", field=place)
        if name not in case.material and name not in misspelt.values():
            yield InputError("missing; every body needs a material", field=f"material.{name}")
    if places and not case.mesh.from_files:
        for name in case.material:
            if name not in places and name not in misspelt:
                text = f"no such body; {near(name, list(places))}"
                yield InputError(text, field=f"material.{name}")


def _shaped(case: Case) -> list[str]:
    return [name for bodies in case.mesh.shaped().values() for name in bodies]


def _misspelt(case: Case) -> dict[str, str]:
    """Materials of bodies that there are not, each with the body without material it is meant for.

    The bodies of files are known by what contacts and steps name alone.
    """
    bodies = _shaped(case)
    if case.mesh.from_files:
        bodies += [name.partition(".")[0] for name in _named_groups(case) if "." in name]
    spare = [name for name in case.material if name not in bodies]
    lacking = [name for name in dict.fromkeys(bodies) if name not in case.material]
    found: dict[str, str] = {}
    for name in spare:
        close = meant(name, [body for body in lacking if body not in found.values()])
        if close is not None:
            found[name] = close
    return found


def _named_groups(case: Case) -> Iterator[str]:
    for contact in case.contact:
        yield from (contact.slave, contact.master)
    for step in case.step:
        yield from (group for _, group in step.groups())
    yield from (*case.symmetry, *case.elastic_support)
    yield from (group for body in case.rigid.values() for group in body.faces)
    for tie in case.tie:
        yield from (tie.slave, tie.master)
    for cut in case.cyclic:
        yield from (cut.slave, cut.master)
    for spring in case.spring.values():
        yield from (group for group in (spring.group, spring.to) if group is not None)


def _bodies(case: Case) -> list[str]:
    """Names that groups may begin with."""
    shaped = _shaped(case)
    if shaped and not case.mesh.from_files:
        return shaped
    return [*dict.fromkeys([*shaped, *case.material, *_misspelt(case).values()])]


def _names(case: Case) -> Iterator[InputError]:
    shaped = ((f"mesh.{shape}", bodies) for shape, bodies in case.mesh.shaped().items())
    for table, names in (
        *shaped,
        ("material", case.material),
        ("surface", case.surface),
        ("rigid", case.rigid),
    ):
        for name in names:
            if not name or "." in name:
                yield InputError(f'"{name}" given, a name without a dot needed', field=table)


def _contact(
    case: Case, contact: ContactSection, place: str, surfaces: dict[str, Surface | None]
) -> Iterator[InputError]:
    yield from _group(case, contact.slave, f"{place}.slave")
    yield from _method(contact, place)
    at_nodes = contact.mortar or contact.self_contact
    if at_nodes and contact.degree is not None:
        with_ = "self_contact" if contact.self_contact else f'pass "{MORTAR}"'
        text = f"given with {with_}, whose slave nodes have no quadrature of a degree"
        yield InputError(text, field=f"{place}.degree")
    if contact.apart is not None and not contact.self_contact:
        text = "given without self_contact = true, which it belongs to"
        yield InputError(text, field=f"{place}.apart")
    yield from _carriers(contact, place)
    if contact.meshed:
        yield from _meshed(case, contact, place)
        return
    if contact.self_contact:
        text = f'"{contact.master}" given, "{contact.slave}" needed: the slave is its own master'
        yield InputError(text, field=f"{place}.master")
        return
    master = surfaces.get(contact.master)
    if contact.master not in surfaces:
        text = f'"{contact.master}" given, no such surface; {near(contact.master, list(surfaces))}'
        yield InputError(text, field=f"{place}.master")
    elif master is not None:
        yield from _laws(contact, place, master)


def _carriers(contact: ContactSection, place: str) -> Iterator[InputError]:
    """Bodies that are to carry a direction field that is not there."""
    for law in ("adhesion", "friction", "python"):
        table = getattr(contact, law)
        kinds = {} if table is None else type(table).model_fields
        for key in (key for key in kinds if key.endswith("_on")):
            field = key.removesuffix("_on")
            if getattr(table, key) != kinds[key].default and getattr(table, field) is None:
                text = f"given without {field}, which it says the body of"
                yield InputError(text, field=f"{place}.{law}.{key}")


def _method(contact: ContactSection, place: str) -> Iterator[InputError]:
    if contact.adjust_gap > 0.0 and not contact.adjust:
        yield InputError("given without adjust = true", field=f"{place}.adjust_gap")
    if contact.adjust and contact.self_contact:
        yield InputError("given with self_contact, which has no adjust", field=f"{place}.adjust")
    if contact.physical_penalty:
        if contact.normal.parameters().get("penalty", "auto") == "auto":
            text = "given without the stiffness of the layer, normal.penalty"
            yield InputError(text, field=f"{place}.physical_penalty")
        if contact.method == AUGMENTED or contact.asks_for_multipliers:
            text = f'given with method "{AUGMENTED}", which has no compliance'
            yield InputError(text, field=f"{place}.physical_penalty")
    if contact.method == PENALTY:
        if contact.tolerance is not None:
            text = f'given with method "{PENALTY}", needs "{AUGMENTED}"'
            yield InputError(text, field=f"{place}.tolerance")
        if contact.multipliers != AUTO_MULTIPLIERS:
            text = f'given with method "{PENALTY}", needs "{AUGMENTED}"'
            yield InputError(text, field=f"{place}.multipliers")


def _meshed(case: Case, contact: ContactSection, place: str) -> Iterator[InputError]:
    if contact.self_contact:
        if contact.master != contact.slave:
            text = (
                f'"{contact.master}" given, "{contact.slave}" needed: the slave is its own master'
            )
            yield InputError(text, field=f"{place}.master")
    elif contact.master == contact.slave:
        text = (
            f'"{contact.master}" given, the same facets as the slave; '
            "a body that folds onto itself needs self_contact = true"
        )
        yield InputError(text, field=f"{place}.master")
    else:
        yield from _group(case, contact.master, f"{place}.master")
    yield from _laws(contact, place)


def _laws(
    contact: ContactSection, place: str, master: Surface | None = None
) -> Iterator[InputError]:
    """Laws of the core or one in Python, the latter as far as they are known without its file."""
    twice = [key for key in ("adhesion", "friction") if key in contact.model_fields_set]
    if contact.python is None and contact.friction is None:
        text = (
            "missing; yield ellipse and sliding rule, { coefficients = 0 } without friction "
            "(or python, a law of your own)"
        )
        yield InputError(text, field=f"{place}.friction")
    elif contact.python is not None and twice:
        text = "given with python, which is the whole tangential law"
        yield from (InputError(text, field=f"{place}.{key}") for key in twice)
    else:
        law, errors = _tried(law_file.contact_law, contact, place)
        yield from errors
        if master is not None and law is not None:
            yield from _tried(objects.interface, law, master, place)[1]


def _group(case: Case, name: str, field: str) -> Iterator[InputError]:
    body, dot, group = name.partition(".")
    if not (body and dot and group):
        yield InputError(f'"{name}" given, "body.group" needed', field=field)
    elif body not in (bodies := _bodies(case)):
        text = f'"{name}" given, no such body; {near(body, bodies)}'
        yield InputError(text, field=field)


def _held(case: Case) -> Iterator[InputError]:
    """Symmetry planes, elastic supports and springs."""
    for i, group in enumerate(case.symmetry):
        yield from _group(case, group, f"symmetry[{i}]")
        if group in case.symmetry[:i]:
            yield InputError(f'"{group}" given twice', field=f"symmetry[{i}]")
    for group, bed in case.elastic_support.items():
        yield from _group(case, group, "elastic_support")
        if bed.normal == bed.tangential == 0.0:
            text = "normal or tangential needed, a stiffness > 0"
            yield InputError(text, field=f'elastic_support."{group}"')
    for name, spring in case.spring.items():
        place = f"spring.{name}"
        for key in ("group", "to"):
            if (group := getattr(spring, key)) is not None:
                yield from _group(case, group, f"{place}.{key}")
        if spring.to == spring.group:
            yield InputError(f'"{spring.to}" given, the group itself', field=f"{place}.to")
        if not any(spring.stiffness):
            yield InputError("all components are 0", field=f"{place}.stiffness")


def _tied(case: Case) -> Iterator[InputError]:
    """Ties and cut faces of sectors."""
    for i, tie in enumerate(case.tie):
        yield from _tie(case, tie, f"tie[{i}]")
    for i, cut in enumerate(case.cyclic):
        for key, group in (("slave", cut.slave), ("master", cut.master)):
            yield from _group(case, group, f"cyclic[{i}].{key}")
        if cut.slave == cut.master:
            yield InputError(f'"{cut.master}" given, the slave itself', f"cyclic[{i}].master")


def _tie(case: Case, tie: TieSection, place: str) -> Iterator[InputError]:
    yield from _group(case, tie.slave, f"{place}.slave")
    if tie.master in case.surface:
        text = (
            f'"{tie.master}" given, a surface: facets that are bonded to a rigid body are its '
            f'faces, [rigid.<name>] faces = ["{tie.slave}"], or have a displacement in the steps'
        )
        yield InputError(text, field=f"{place}.master")
    elif tie.master == tie.slave:
        yield InputError(f'"{tie.master}" given, the slave itself', field=f"{place}.master")
    else:
        yield from _group(case, tie.master, f"{place}.master")
    for i, contact in enumerate(case.contact):
        if {contact.slave, contact.master} == {tie.slave, tie.master}:
            yield InputError(f"same pair as contact[{i}]: what is glued cannot slide", field=place)


def _points_and_faces(case: Case) -> Iterator[InputError]:
    """Points, edges, and faces that follow rigid bodies."""
    for name in case.nodes:
        yield from _group(case, name, "nodes")
    followed: dict[str, str] = {}
    for name, body in case.rigid.items():
        for i, group in enumerate(body.faces):
            place = f"rigid.{name}.faces[{i}]"
            yield from _group(case, group, place)
            if (first := followed.setdefault(group, place)) != place:
                yield InputError(f'"{group}" given, it is {first} already', field=place)


def _steps(case: Case) -> Iterator[InputError]:
    seen: dict[str, int] = {}
    for i, step in enumerate(case.step):
        if not step.name.strip():
            text = f'"{step.name}" given, a name of one letter or more needed'
            yield InputError(text, field=f"step[{i}].name")
        first = seen.setdefault(step.name, i)
        if first != i:
            text = f'"{step.name}" given, step[{first}] has that name already'
            yield InputError(text, field=f"step[{i}].name")
        for what, group in step.groups():
            yield from _group(case, group, f"step[{i}].{what}")
        yield from _prescribed_once(step, f"step[{i}]")
        grounded = [name for name, spring in case.spring.items() if spring.to is None]
        for name in step.anchor:
            if name not in grounded:
                text = f'"{name}" given, no such spring to ground; {near(name, grounded)}'
                yield InputError(text, field=f"step[{i}].anchor")
        yield from _gravity(case, step, f"step[{i}]")
        for body in step.body_force:
            if body not in (bodies := _bodies(case)):
                text = f'"{body}" given, no such body; {near(body, bodies)}'
                yield InputError(text, field=f"step[{i}].body_force")
        for body in step.temperature:
            expand = [name for name, given in case.material.items() if given.expansion]
            if body not in expand:
                text = f'"{body}" given, no such body whose material has an expansion; '
                yield InputError(text + near(body, expand), field=f"step[{i}].temperature")


def _prescribed_once(step: StepSection, place: str) -> Iterator[InputError]:
    pairs = (("rotation", "displacement"), ("rotation", "cylindrical"))
    for kind, other in (*pairs, ("cylindrical", "displacement")):
        for group in getattr(step, kind):
            if group in getattr(step, other):
                said = "a displacement" if other == "displacement" else other
                text = f"given with {said} of the same group, one of the two is allowed"
                yield InputError(text, field=f'{place}.{kind}."{group}"')


def _gravity(case: Case, step: StepSection, place: str) -> Iterator[InputError]:
    if step.gravity is None:
        return
    for name, section in case.material.items():
        if section.density is None:
            text = f"missing; gravity acts on the body in {place}, 0 if it has no weight"
            yield InputError(text, f"material.{name}.density")
        if name in step.body_force:
            text = "given with gravity, which acts on the body; one of the two is allowed"
            yield InputError(text, f"{place}.body_force.{name}")


def _tried(make: Callable[..., Any], *arguments: Any) -> tuple[Any, tuple[InputError, ...]]:
    """What `make` makes, or the error it raises."""
    try:
        return make(*arguments), ()
    except InputError as error:
        return None, (error,)
