"""From the `[[contact]]` tables of a case to the contacts of the finite-element level."""

from __future__ import annotations

from collections.abc import Mapping

from anisocontact.bulk import Material
from anisocontact.case import law_file, objects
from anisocontact.case.model import AUGMENTED, Case, ContactSection
from anisocontact.case.quantity import AUTO
from anisocontact.contact import (
    AnyContact,
    Contact,
    FacetContact,
    SelfContact,
    TwoHalfPass,
    auto_penalty,
)
from anisocontact.interface import ContactLaw, Interface, TangentialLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.mesh import Model
from anisocontact.rigid import RigidBody

__all__ = ["contact"]


def contact(
    case: Case,
    section: ContactSection,
    model: Model,
    materials: Mapping[str, Material],
    rigid: Mapping[str, RigidBody],
    place: str,
    law: TangentialLaw | None = None,
) -> AnyContact:
    """The contact of a table.

    Args:
        case: The whole case.
        section: The table.
        model: Mesh of the bodies.
        materials: Material of each body.
        rigid: Rigid body that carries a surface, by name of the surface.
        place: Path of the table, for messages.
        law: The Python law that the table names, if it does.

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
    of_table = law_file.contact_law(section, place, auto, law)
    if section.meshed:
        made = _meshed(section, model, of_table, place)
    else:
        master = objects.surface(case.surface[section.master], f"surface.{section.master}")
        interface = objects.interface(of_table, master, place)
        made = _rigid(section, model, interface, rigid.get(section.master), place)
    made.physical_adhesion = not _auto_adhesion(section)
    return made


def _meshed(section: ContactSection, model: Model, law: ContactLaw, place: str) -> AnyContact:
    name = f"{section.slave} on {section.master}"
    with objects.within(place):
        if section.self_contact:
            return SelfContact(
                model,
                section.slave,
                law=law,
                degree=section.degree,
                apart=section.apart,
                name=f"{section.slave} on itself",
            )
        if section.half_passes:
            return TwoHalfPass(
                model,
                section.slave,
                section.master,
                law=law,
                degree=section.degree,
                adjust=_adjust(section),
                name=name,
            )
        return FacetContact(
            model,
            section.slave,
            section.master,
            law=law,
            degree=section.degree,
            augmentation=_augmentation(section),
            adjust=_adjust(section),
            name=name,
        )


def _rigid(
    section: ContactSection,
    model: Model,
    interface: Interface,
    body: RigidBody | None,
    place: str,
) -> AnyContact:
    with objects.within(place):
        return Contact(
            model,
            section.slave,
            interface,
            degree=section.degree,
            augmentation=_augmentation(section),
            adjust=_adjust(section),
            name=f"{section.slave} on {section.master}",
            body=body,
        )


def _augmentation(section: ContactSection) -> Augmentation | None:
    """What the table asks for; a stiffness of adhesion that the user gave is physical."""
    if section.method != AUGMENTED:
        return None
    tolerance = Augmentation.tolerance if section.tolerance is None else section.tolerance
    return Augmentation(tolerance, _auto_adhesion(section), section.multipliers)


def _auto_adhesion(section: ContactSection) -> bool:
    """Whether the stiffness of adhesion is one that the run chooses."""
    return section.python is None and bool(section.adhesion.parameters().get("stiffness") == AUTO)


def _adjust(section: ContactSection) -> float | None:
    return section.adjust_gap if section.adjust else None
