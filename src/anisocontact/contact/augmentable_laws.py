"""Which laws have penalties that an augmented Lagrangian can make exact."""

from __future__ import annotations

from anisocontact.base.errors import InputError
from anisocontact.interface import VECTOR_FORMS, ContactLaw, Interface
from anisocontact.interface.augmentation import NEWTON, Augmentation
from anisocontact.laws import EXPLICIT

#: Laws whose penalties can be augmented.
type AugmentedLaw = Interface | ContactLaw


def check(augmentation: Augmentation, law: AugmentedLaw) -> None:
    """Find out whether the parts to be augmented are penalties.

    Raises:
        InputError: The normal law has a time, the history enters in a form without vectors, or the
            sliding rule does not go with the way to the multipliers.
    """
    model = law.normal.named[0]
    if model != "penalty":
        raise InputError(
            f'"{model}" given, an augmented contact needs "penalty": other laws are physical',
            "normal.model",
        )
    if not augmentation.tangential:
        return
    if law.tangential.in_python:
        raise InputError(
            "a tangential law written in Python is physical: tangential=False needed", "method"
        )
    if law.tangential.model != "elastic":
        raise InputError(
            f'"{law.tangential.model}" given, an augmented contact needs "elastic"',
            "adhesion.model",
        )
    if not law.tangential.holds_all_ways():
        raise InputError(
            "0 along an axis, where nothing is to stick: such adhesion is physical, "
            "tangential=False needed",
            "adhesion.stiffness",
        )
    if law.evolution not in VECTOR_FORMS:
        allowed = " or ".join(f'"{name}"' for name in VECTOR_FORMS)
        raise InputError(
            f'"{law.evolution}" given, an augmented contact needs {allowed}', "evolution"
        )
    if augmentation.multipliers == NEWTON and not simultaneous(augmentation, law):
        raise InputError(
            f'"{NEWTON}" given, the sliding rule "{EXPLICIT}" needs "uzawa" or "auto"',
            "multipliers",
        )


def augmentable(law: AugmentedLaw) -> bool:
    """Whether a law is one of penalties alone, whose multipliers can follow the displacements."""
    try:
        check(Augmentation(multipliers=NEWTON), law)
    except InputError:
        return False
    return True


def simultaneous(augmentation: Augmentation, law: AugmentedLaw) -> bool:
    """Whether a law lets its multipliers be found together with the displacements."""
    if not augmentation.tangential or law.tangential.in_python:
        return True
    # its history is another force than the one that acts: no fixed point of a step
    return law.tangential.sliding_rule != EXPLICIT
