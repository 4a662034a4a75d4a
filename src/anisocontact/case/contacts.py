"""From the `[[contact]]` tables of a case to the contacts of the finite-element level."""

from __future__ import annotations

from collections.abc import Mapping

from anisocontact.base.errors import within
from anisocontact.bulk import Material
from anisocontact.case import law_file, objects
from anisocontact.case.contact_defaults import chosen, physical_adhesion
from anisocontact.case.model import AUGMENTED, Case, ContactSection
from anisocontact.contact import Contact, auto_penalty
from anisocontact.interface import ContactLaw, TangentialLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.mesh import Model
from anisocontact.rigid import MovingSurface, RigidBody

#: What a slave meets.
type AnyMaster = str | MovingSurface


def contact(
    case: Case,
    section: ContactSection,
    model: Model,
    materials: Mapping[str, Material],
    rigid: Mapping[str, RigidBody],
    place: str,
    given: TangentialLaw | None = None,
) -> Contact:
    """The contact of a table.

    Args:
        case: The whole case.
        section: The table.
        model: Mesh of the bodies.
        materials: Material of each body.
        rigid: Rigid body that carries a surface, by name of the surface.
        place: Path of the table, for messages.
        given: The Python law that the table names, if it does.

    Returns:
        The contact, before the first step.

    Raises:
        InputError: A group is missing, a value does not fit, or the contact cannot be meant as it
            is: see `check_start`.
    """
    sides = [("slave", section.slave)] + [("master", section.master)] * section.meshed
    bodies = [materials[model.body_of(group, f"{place}.{side}")] for side, group in sides]
    auto = min(
        auto_penalty(model, group, body) for (_, group), body in zip(sides, bodies, strict=True)
    )
    law = law_file.contact_law(section, place, auto, given)
    required = section.method == AUGMENTED or section.asks_for_multipliers
    section = chosen(section, model, bodies, law)
    with within(place):
        augmentation = _augmentation(section, required)
    if section.meshed:
        made = _made(section, model, section.master, law, place, augmentation)
    else:
        surface = objects.surface(case.surface[section.master], f"surface.{section.master}")
        interface = objects.interface(law, surface, place)
        moving = MovingSurface(interface, rigid.get(section.master))
        made = _made(section, model, moving, None, place, augmentation)
    made.physical_adhesion = physical_adhesion(section)
    made.physical_penalty = section.physical_penalty
    return made


def _made(
    section: ContactSection,
    model: Model,
    master: AnyMaster,
    law: ContactLaw | None,
    place: str,
    augmentation: Augmentation | None,
) -> Contact:
    on = "itself" if section.self_contact else section.master
    with within(place):
        return Contact(
            model,
            section.slave,
            master,
            law,
            degree=section.degree,
            augmentation=augmentation,
            adjust=section.adjust_gap if section.adjust else None,
            mortar=section.mortar,
            self_contact=section.self_contact,
            apart=section.apart,
            name=f"{section.slave} on {on}",
        )


def _augmentation(section: ContactSection, required: bool) -> Augmentation | None:
    """What the table asks for; a stiffness of adhesion that the user gave is physical.

    Args:
        section: The table, with what "auto" stands for.
        required: Whether the user asks for multipliers: else penalties hold where there are none.
    """
    if section.method != AUGMENTED:
        return None
    tolerance = Augmentation.tolerance if section.tolerance is None else section.tolerance
    tangential = not physical_adhesion(section)
    return Augmentation(tolerance, tangential, section.multipliers, required)
