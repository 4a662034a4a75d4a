"""What "auto" means for a contact: where its law is evaluated, and how exactly it holds."""

from __future__ import annotations

from collections.abc import Sequence

from anisocontact.base.errors import InputError
from anisocontact.bulk import Material
from anisocontact.case.model import AUGMENTED, MORTAR, PENALTY, SINGLE, ContactSection
from anisocontact.case.quantity import AUTO
from anisocontact.contact.augmentable_laws import check, simultaneous
from anisocontact.contact.defaults import takes_nodes
from anisocontact.interface import ContactLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.mesh import Model


def chosen(
    section: ContactSection, model: Model, materials: Sequence[Material], law: ContactLaw
) -> ContactSection:
    """The table with what "auto" stands for.

    Slave nodes and multipliers are exact where pressures at points matter, and are taken wherever
    they can be, docs/verification/mortar.md.

    Args:
        section: The table.
        model: Mesh of the bodies.
        materials: Material of the slave, and of the master if it is a body.
        law: Laws of the contact.

    Returns:
        The table, with names of a pass and of a method.
    """
    taken = section
    if section.pass_ == AUTO or section.of_before:
        nodes = section.pass_ != AUTO or _takes_nodes(section, model, materials)
        taken = section.model_copy(update={"pass": MORTAR if nodes else SINGLE})
    if taken.method == AUTO:
        taken = taken.model_copy(update={"method": _method(taken, law)})
    return taken


def physical_adhesion(section: ContactSection) -> bool:
    """Whether the stiffness of adhesion is given, not one that the run chooses."""
    python = section.python is not None
    return python or bool(section.adhesion.parameters().get("stiffness") != AUTO)


def _takes_nodes(section: ContactSection, model: Model, materials: Sequence[Material]) -> bool:
    """As of `takes_nodes`."""
    master = section.master if section.meshed else None
    young = (materials[0].young, materials[-1].young)
    return takes_nodes(model, section.slave, master, section.degree, young)


def _method(section: ContactSection, law: ContactLaw) -> str:
    """Multipliers at slave nodes, unless a penalty is given or the law has a say."""
    if section.asks_for_multipliers:
        return AUGMENTED
    if not section.mortar or section.normal.parameters().get("penalty") != AUTO:
        return PENALTY
    augmentation = Augmentation(tangential=not physical_adhesion(section))
    try:
        check(augmentation, law)
    except InputError:
        return PENALTY
    return AUGMENTED if simultaneous(augmentation, law) else PENALTY
