"""What the user of a run should look at, a line each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from anisocontact.contact import AnyContact, initial_overlap
from anisocontact.interface import STATUS

__all__ = ["at_end", "at_start", "worst"]

#: Share of the facet size beyond which a penetration or an elastic slip is worth a warning.
DEEP = 0.05
#: Share of the external work beyond which energy of stabilisation, or of flow, is worth a warning.
STABILISED = 0.05


def at_start(contacts: Sequence[AnyContact], shown: Sequence[dict[str, Any]]) -> list[str]:
    """Contacts whose bodies overlap before the first step.

    Args:
        contacts: The contacts.
        shown: Their entries in the summary.
    """
    found = []
    for contact, entry in zip(contacts, shown, strict=True):
        overlap = initial_overlap(contact, entry["facet_size"])
        if overlap is not None:
            place = ", ".join(f"{v:.4g}" for v in overlap.point)
            found.append(
                f"{_pair(entry)}: the bodies overlap by {overlap.depth:.3g} at the start, "
                f"{100.0 * overlap.depth / entry['facet_size']:.2g}% of the facet size, "
                f"at {overlap.count} points, most at ({place}); the first increment pushes them "
                "apart, adjust = true lets them just touch"
            )
    return found


def worst(entry: Mapping[str, Any], before: Mapping[str, Any], time: float) -> dict[str, float]:
    """Largest penetration and elastic slip of a contact over the run, and when they occurred.

    Args:
        entry: Entry of the contact in the summary, with the largest of now.
        before: Its entry before, with the worst so far; empty at the start.
        time: Time of now.

    Returns:
        "worst_penetration", "worst_elastic_slip", length, and each with "_time".
    """
    found: dict[str, float] = {}
    for name in ("penetration", "elastic_slip"):
        key, when, now = f"worst_{name}", f"worst_{name}_time", entry[f"max_{name}"]
        grown = key not in before or now > before[key]
        found |= {key: now, when: time} if grown else {key: before[key], when: before[when]}
    return found


def at_end(
    contacts: Sequence[AnyContact], shown: Sequence[dict[str, Any]], energy: dict[str, float]
) -> list[str]:
    """What is too soft, does not touch, or was held by stabilisation.

    Args:
        contacts: The contacts.
        shown: Their entries in the summary.
        energy: Energies of the run.
    """
    found = []
    for contact, entry in zip(contacts, shown, strict=True):
        soft = [("penetration", "worst_penetration", "a larger normal penalty")]
        if not contact.physical_adhesion:
            soft.append(("elastic slip", "worst_elastic_slip", "a larger stiffness of adhesion"))
        for name, key, cure in soft:
            share = entry[key] / entry["facet_size"]
            if share > DEEP:
                found.append(
                    f"{_pair(entry)}: the {name} was up to {share:.0%} of the facet size, at time "
                    f"{entry[f'{key}_time']:.4g}; {cure} makes it smaller, "
                    'method = "augmented" takes it away'
                )
        if entry["points"]["open"] == sum(entry["points"][name] for name in STATUS):
            found.append(f"{_pair(entry)}: no point touches at the end")
    for name, text in _TAKEN.items():
        share = abs(energy[name]) / max(abs(energy["external"]), _TINY)
        if share > STABILISED:
            found.append(text.format(share))
    return found


_TINY = 1e-300
#: Energies that are no part of what was to be computed, and what is said of them.
_TAKEN = {
    "stabilisation": "stabilisation took up {:.0%} of the work from outside: bodies moved while "
    "nothing held them; let them touch at the start, or support them",
    "flow": "jumps set free {:.0%} of the work from outside: inertia, which is left out, would "
    "decide where the bodies come to rest",
}


def _pair(entry: dict[str, Any]) -> str:
    return f"contact of {entry['slave']} with {entry['master']}"
