"""Why attempts found no equilibrium: the most severe of what was found, and how it is said."""

from __future__ import annotations

from collections.abc import Sequence

from anisocontact.contact import Contact
from anisocontact.solver.stepping.acceptance import INVERTED
from anisocontact.solver.system.culprit import Culprit

#: Kinds of culprits, the most severe first.
SEVERITY = ("law", "behind", "inverted", "chattering", "alternating facets", "residual")
#: Kinds that explain a failure by themselves; cells that are inverted do in an equilibrium that is
#: refused, and where corrections go too far they do not.
CONCLUSIVE = SEVERITY[:2]


def more_severe(before: list[Culprit], now: list[Culprit]) -> list[Culprit]:
    """The more severe one of two findings, the later one of equals."""
    if not before or not now:
        return now or before
    rank = SEVERITY.index
    return now if rank(now[0].kind) <= rank(before[0].kind) else before


def explained(reason: str, culprits: list[Culprit], contacts: Sequence[Contact]) -> str:
    """Why it failed, by what caused it."""
    kind = culprits[0].kind if culprits else ""
    if kind == "law":
        return culprits[0].why
    if kind == "inverted":
        # an equilibrium that is none, or a correction too far, which tells nothing of the cells
        return reason if reason == INVERTED else f"{reason}; {INVERTED} by corrections"
    if kind == "chattering":
        told = f"{reason}; the status of {len(culprits)} slave points alternates (chattering)"
        border = [culprit.contact for culprit in culprits if culprit.border]
        if not border:
            return told
        advice = _advice([one for one in contacts if one.name in border])
        return f"{told}, {len(border)} of them at the border of the master{advice}"
    if kind == "alternating facets":
        return f"{reason}; {len(culprits)} slave points alternate between facets"
    return reason


def _advice(contacts: Sequence[Contact]) -> str:
    """What helps where points go over the border of the master: what these contacts can have."""
    sides = all(contact.of_two_groups for contact in contacts)
    points = not any(contact.slave_points.at_nodes for contact in contacts)
    ways = ["take the other side as the slave"] * sides + ["take the pass mortar"] * points
    return f": {' or '.join(ways)}" if ways else ""
