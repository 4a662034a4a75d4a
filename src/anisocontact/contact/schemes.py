"""Ways to the multipliers of augmented contacts, by name."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from anisocontact.contact.multipliers import AugmentedLaw, Multipliers, check, simultaneous
from anisocontact.contact.nested import Nested
from anisocontact.contact.semismooth import Semismooth, Softer
from anisocontact.contact.uzawa import Penalties, Uzawa
from anisocontact.interface.augmentation import AUTO, NEWTON, UZAWA, Augmentation

#: Ways of an increment, the usual one and what is tried where that fails: with smaller penalties,
#: in cycles, and with penalties alone where multipliers are not required.
USUAL, SOFTER, IN_CYCLES, PENALTIES = "usual", "softer", "in cycles", "penalties"

#: Classes of the ways that a scheme has.
SCHEMES: Mapping[str, Mapping[str, type[Multipliers]]] = {
    NEWTON: {USUAL: Semismooth, SOFTER: Softer, IN_CYCLES: Nested},
    UZAWA: {USUAL: Uzawa},
}


def make_multipliers(
    augmentation: Augmentation, law: AugmentedLaw, size: float, comm: Any
) -> dict[str, Multipliers]:
    """Multipliers for a law, by the ways of an increment.

    Args:
        augmentation: What is asked for.
        law: The law.
        size: Facet size, length.
        comm: Communicator of the mesh.

    Raises:
        InputError: A part to be augmented is physical, see `check`.
    """
    check(augmentation, law)
    name = augmentation.multipliers
    if name == AUTO:
        name = NEWTON if simultaneous(augmentation, law) else UZAWA
    ways = dict(SCHEMES[name])
    if not augmentation.required:
        ways[PENALTIES] = Penalties
    return {way: kind(augmentation, size, law.penalties(), comm) for way, kind in ways.items()}
