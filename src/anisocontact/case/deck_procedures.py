"""What the steps of a deck solve: those that are static are kept, the others are told.

Vibrations, buckling, impacts and temperatures are no cases of this program. A static step that
would stand in their place has numbers without a meaning, so there is none.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from anisocontact.base.errors import InputError
from anisocontact.mesh.deck import Card

#: Keywords of steps that are solved; viscous ones are static steps of materials that know time.
STATIC = ("STATIC", "VISCO")
#: Keywords of those that are not.
OTHERS = (
    *("FREQUENCY", "COMPLEX FREQUENCY", "BUCKLE", "DYNAMIC", "MODAL DYNAMIC", "GREEN"),
    *("STEADY STATE DYNAMICS", "STEADY STATE TRANSPORT", "RANDOM RESPONSE", "RESPONSE SPECTRUM"),
    *("HEAT TRANSFER", "COUPLED TEMPERATURE-DISPLACEMENT", "UNCOUPLED TEMPERATURE-DISPLACEMENT"),
    *("ELECTROMAGNETICS", "CFD", "SENSITIVITY", "SUBSTRUCTURE GENERATE", "NO ANALYSIS"),
    *("GEOSTATIC", "SOILS", "MASS DIFFUSION", "CRACK PROPAGATION", "FEASIBLE DIRECTION"),
    *("ROBUST DESIGN", "DIRECT CYCLIC", "ANNEAL"),
)


def static_steps(cards: Sequence[tuple[int, Card]]) -> tuple[list[tuple[int, Card]], list[str]]:
    """The cards of a deck without the steps that are not static.

    Args:
        cards: The cards with the number of the step in which each stands, 0 in front of the first.

    Returns:
        Those that are left, steps numbered anew; a line for each step that is not.

    Raises:
        InputError: There are steps, and none is static.

    Example:
        >>> step, static, other = (Card(n, {}, (), 1) for n in ("STEP", "STATIC", "FREQUENCY"))
        >>> kept, lines = static_steps([(1, step), (1, static), (2, step), (2, other)])
        >>> [number for number, _ in kept], lines
        ([1, 1], ['step 2 is *FREQUENCY, not *STATIC'])
    """
    kept: list[tuple[int, Card]] = [(0, card) for number, card in cards if not number]
    left: list[tuple[int, str]] = []
    taken = 0
    for step in range(1, max((number for number, _ in cards), default=0) + 1):
        own = [card for number, card in cards if number == step]
        own = [replace(card, name=STATIC[0]) if _quasi_static(card) else card for card in own]
        why = _why_not(own, taken)
        if why:
            left.append((taken, f"step {step} is {why}"))
        else:
            taken += 1
            kept += [(taken, card) for card in own]
    if left and not taken:
        text = ", ".join(line for _, line in left)
        raise InputError(f"no step can be taken over: {text}; its mesh alone is read, see [mesh]")
    behind = "; steps behind it begin without what it does"
    return kept, [line + (behind if before < taken else "") for before, line in left]


def _quasi_static(card: Card) -> bool:
    """Whether a `*DYNAMIC` means the equilibrium without inertia."""
    return card.name == "DYNAMIC" and card.options.get("APPLICATION", "").upper() == "QUASI-STATIC"


def _why_not(cards: Sequence[Card], before: int) -> str:
    """What a step is that is not taken over; empty for one that is."""
    names = [card.name for card in cards]
    if not set(STATIC).isdisjoint(names):
        disturbs = any(card.name == "STEP" and "PERTURBATION" in card.options for card in cards)
        return "a PERTURBATION of the steps before" if before and disturbs else ""
    found = [name for name in OTHERS if name.replace(" ", "") in names]
    return f"*{found[-1]}, not *STATIC" if found else "not *STATIC"
