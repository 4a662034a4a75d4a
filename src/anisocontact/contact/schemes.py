"""Ways to the multipliers of augmented contacts, by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from anisocontact.augmentation import AUTO, NEWTON, UZAWA, Augmentation
from anisocontact.contact.multipliers import AugmentedLaw, Multipliers, check, follows
from anisocontact.contact.semismooth import Semismooth
from anisocontact.contact.uzawa import Uzawa

#: Class of each way.
WAYS: Mapping[str, type[Multipliers]] = {NEWTON: Semismooth, UZAWA: Uzawa}


def make_multipliers(
    augmentation: Augmentation, law: AugmentedLaw, size: float, comm: Any
) -> Multipliers:
    """Multipliers for a law.

    Args:
        augmentation: What is asked for.
        law: The law.
        size: Facet size, length.
        comm: Communicator of the mesh.

    Raises:
        InputError: A part to be augmented is physical, see `check`.
    """
    if getattr(getattr(law, "friction", None), "frictionless", False):
        # there is no tangential force that a multiplier could be
        augmentation = replace(augmentation, tangential=False)
    check(augmentation, law)
    name = augmentation.multipliers
    if name == AUTO:
        name = NEWTON if follows(augmentation, law) else UZAWA
    return WAYS[name](augmentation, size, law.penalties(), comm)
