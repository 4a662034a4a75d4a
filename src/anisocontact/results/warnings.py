"""What the user of a run should look at, a line each."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from anisocontact.base.limits import FOLLOWED
from anisocontact.contact import Contact, coarse_slaves, doubtful_sides
from anisocontact.contact.field_hints import doubtful_fields
from anisocontact.contact.friction_hints import doubtful_friction
from anisocontact.contact.hidden_borders import BORDERS, hidden_borders
from anisocontact.contact.hints import (
    MISSED,
    faceted,
    overlapping,
    pressed_aside,
)
from anisocontact.contact.narrow import NARROW, pressed
from anisocontact.contact.tips import points_on_tips
from anisocontact.interface import STATUS
from anisocontact.solver import Accepted
from anisocontact.solver.stepping.cut_faces import PAST
from anisocontact.solver.stepping.increment_warnings import FAR, UNBALANCED
from anisocontact.solver.stepping.turn_watch import MARGIN
from anisocontact.solver.system.imbalance import LARGE
from anisocontact.solver.system.rotations import CURE, STRAINED, WARNED

#: Angle along a sub-increment beyond which it is worth a warning, radian.
TURNED = MARGIN * FOLLOWED
#: Share of the facet size beyond which a penetration or an elastic slip is worth a warning.
DEEP = 0.05
#: Share of the approach of the bodies beyond which a penetration is worth a warning.
SOFT = 0.04
#: Share of what bodies and penalties store beyond which it is where temperatures press the bodies,
#: whose groups move by them: force is off by more where bodies store what contact does not change.
STORED = 0.01
#: Share of the facet size that is rounding, or the tolerance of an augmented contact.
ROUNDING = 1e-5
#: What is too small where bodies penetrate.
NORMAL = "a larger normal penalty"
#: Share of the external work beyond which energy of stabilisation, or regularisation, is told.
STABILISED = 0.05
#: What is said of a contact whose points touch and carry nothing.
IDLE = (
    "points touch at the end, and carry no force: nothing presses the bodies together, as where a "
    "support is missing that would keep one of them from being pushed along"
)
#: What is said where everything is written but the report.
UNREPORTED = "no report: {lost}; where there is room: anisocontact report {folder}"
#: What the summary has the largest value over the run of, and the quantity that it is of.
_WORST = {
    "penetration": "max_penetration",
    "elastic_slip": "max_elastic_slip",
    "turn": "turn",
}


def at_start(contacts: Sequence[Contact], shown: Sequence[dict[str, Any]]) -> list[str]:
    """Contacts with a slave much coarser than its master, or whose bodies overlap at the start.

    Args:
        contacts: The contacts.
        shown: Their entries in the summary.
    """
    pairs = (
        (contact, _pair(entry), entry["facet_size"])
        for contact, entry in zip(contacts, shown, strict=True)
    )
    lines = [*doubtful_sides(contacts), *doubtful_friction(contacts), *doubtful_fields(contacts)]
    lines += points_on_tips(contacts)
    return [*lines, *overlapping(pairs, "adjust = true")]


def worst(
    entry: Mapping[str, Any],
    before: Mapping[str, Any],
    time: float,
    energy: Mapping[str, float],
) -> dict[str, float | None]:
    """Largest penetration, elastic slip and turn of a contact over the run, and when they occurred.

    Args:
        entry: Entry of the contact in the summary, with the largest of now.
        before: Its entry before, with the worst so far; empty at the start.
        time: Time of now.
        energy: Energies of now, where temperatures press the bodies.

    Returns:
        "worst_penetration", "worst_elastic_slip", length, "worst_turn", radian, and each with
        "_time"; the penetration also with "_approach", how far the bodies had come towards each
        other since they touched, and with "_stored", what penalties hold of all that is stored.
        What there is at the start is no equilibrium, and none of them.
    """
    first = before.get("initial_gap", entry["least_gap"])
    found: dict[str, float | None] = {"initial_gap": first}
    come, stored = "worst_penetration_approach", "worst_penetration_stored"
    if come not in before or entry["max_penetration"] > before["worst_penetration"]:
        approach = 0.0 if energy else entry["approach"] - first  # groups move as they warm
        found |= {come: approach, stored: _held_by_penalties(energy)}
    else:
        found |= {come: before[come], stored: before[stored]}
    for name, of_now in _WORST.items():
        key, when = f"worst_{name}", f"worst_{name}_time"
        now = entry[of_now] if before else 0.0
        grown = key not in before or now > before[key]
        found |= {key: now, when: time} if grown else {key: before[key], when: before[when]}
    return found


def _held_by_penalties(energy: Mapping[str, float]) -> float | None:
    """Share of the stored energy; None where it is not asked for, or no material tells it."""
    every = sum(energy.get(name, 0.0) for name in ("normal", "adhesion", "elastic"))
    return energy["normal"] / every if every > 0.0 else None


def worst_of_models(accepted: Accepted, before: Mapping[str, Any]) -> dict[str, Any]:
    """Largest turn of bodies at small strain, past cut faces, and residual of the energies so far.

    Args:
        accepted: An accepted increment.
        before: What this gave at the one before; empty at the start.

    Returns:
        "turned" and "strained", by body, "past_cuts", by contact, "energy_residual", "relaxed" and
        "unbalanced", as JSON can have them.
    """
    turned = dict(before.get("turned", {}))
    for name, now in accepted.turned.items():
        if name not in turned or now.angle > turned[name]["angle"]:
            entry = {"angle": now.angle, "strain": now.strain, "stress": now.stress}
            turned[name] = entry | {"time": accepted.time, "text": str(now)}
    far = dict(before.get("strained", {}))
    for name, now in accepted.turned.items():
        if now.strained > far.get(name, {}).get("strain", STRAINED):
            far[name] = {"strain": now.strained, "time": accepted.time}
    past = dict(before.get("past_cuts", {}))
    for name, lost in accepted.past_cuts.items():
        if lost > past.get(name, {}).get("share", 0.0):
            past[name] = {"share": lost, "time": accepted.time}
    left = dict(before.get("energy_residual", {}))
    share = accepted.imbalance.share
    if not left or share > left["worst_share"]:
        cause = accepted.imbalance.cause
        left |= {"worst_share": share, "worst_time": accepted.time, "cause": cause}
    so = {"relaxed": accepted.relaxed, "unbalanced": accepted.residuals[-1] > UNBALANCED}
    times = {key: [*before.get(key, []), *[accepted.time] * bool(now)] for key, now in so.items()}
    left |= {"share": share}
    return {"turned": turned, "strained": far, "past_cuts": past, "energy_residual": left, **times}


def of_models(summary: Mapping[str, Any]) -> list[str]:
    """Bodies that turned beyond small strain or past cut faces, lost balance, penalties.

    Args:
        summary: Content of the summary, with what `worst_of_models` gave.
    """
    found = [
        f"body {name!r}, at small strain, {turned['text']}, at time {turned['time']:.4g}; {CURE}"
        for name, turned in summary.get("turned", {}).items()
        if turned["angle"] > WARNED
    ]
    found += [
        f"{FAR.format(name=name, strain=far['strain'], cure=CURE)}, at time {far['time']:.4g}"
        for name, far in summary.get("strained", {}).items()
    ]
    found += [
        f"contact {name!r}: {PAST.format(past['share'])}, at time {past['time']:.4g}"
        for name, past in summary.get("past_cuts", {}).items()
    ]
    left = summary.get("energy_residual")
    if left and left["worst_share"] > LARGE:
        found.append(
            f"the balance of energy left {left['worst_share']:.0%} of the work open at time "
            f"{left['worst_time']:.4g}, {left['share']:.1%} at the end: {left['cause']}"
        )
    if relaxed := summary.get("relaxed"):
        found.append(
            f"penalties held in {len(relaxed)} increments or sub-increments, from time "
            f"{relaxed[0]:.4g} on, as multipliers did not converge: bodies overlap there by "
            "the penetrations of contacts"
        )
    if unbalanced := summary.get("unbalanced"):
        found.append(
            f"forces are out of balance in {len(unbalanced)} increments or sub-increments, from "
            f"time {unbalanced[0]:.4g} on: the options snes_rtol and snes_atol let them be"
        )
    return found


def narrow(shown: Sequence[dict[str, Any]]) -> list[str]:
    """Contacts too narrow for pressures at points, by their entries in the summary."""
    return [f"{_pair(entry)}: {NARROW}" for entry in shown if entry.get("narrow")]


def idle(contacts: Sequence[Contact], shown: Sequence[dict[str, Any]]) -> list[str]:
    """Contacts of a run that is done whose points touch and carry nothing.

    Args:
        contacts: The contacts.
        shown: Their entries in the summary.
    """
    return [
        f"{_pair(entry)}: {IDLE}"
        for contact, entry in zip(contacts, shown, strict=True)
        if entry["points"]["open"] < sum(entry["points"][name] for name in STATUS)
        if not contact.model.mesh.comm.allreduce(int(pressed(contact).any()))
    ]


def at_end(
    contacts: Sequence[Contact],
    shown: Sequence[dict[str, Any]],
    energy: dict[str, float],
    relaxed: bool = False,
    told: Sequence[str] = (),
) -> list[str]:
    """What is too soft, does not touch, is pressed aside, or was held by stabilisation.

    Args:
        contacts: The contacts.
        shown: Their entries in the summary.
        energy: Energies of the run.
        relaxed: Whether penalties held where there were no multipliers.
        told: What was said at the start.
    """
    found = []
    for contact, entry in zip(contacts, shown, strict=True):
        found += _too_soft(contact, entry, _exact(contact) and not relaxed)
        if entry["worst_turn"] > TURNED:
            found.append(
                f"{_pair(entry)}: normal, axes of adhesion or slave turned by "
                f"{math.degrees(entry['worst_turn']):.0f} degrees in one sub-increment, at "
                f"time {entry['worst_turn_time']:.4g}; friction follows up to "
                f"{math.degrees(FOLLOWED):.0f} well: more increments or cuts make it smaller, a "
                "finer or smooth master where its facets meet at such angles"
            )
        if entry["points"]["open"] == sum(entry["points"][name] for name in STATUS):
            swap = [line.partition(": ")[2] for line in coarse_slaves([contact], MISSED)]
            flat = _below_arcs(contact, entry["least_gap"])
            found.append("; ".join([f"{_pair(entry)}: no point touches at the end", *swap, *flat]))
        if not any(BORDERS in line for line in told if line.startswith(_pair(entry))):
            found += hidden_borders([contact])
    found += [*pressed_aside(contacts), *faceted(contacts)]
    for name, text in _TAKEN.items():
        taken, work = abs(energy[name]), abs(energy["external"])
        if taken > STABILISED * work:
            all_of_it = f"more than all ({taken:.3g} against {work:.3g})"
            share = f"{taken / work:.0%}" if taken <= work else all_of_it
            found.append(text.format(share))
    return found


def _too_soft(contact: Contact, entry: dict[str, Any], exact: bool) -> list[str]:
    """What is said of penetration and elastic slip that penalties left.

    Args:
        contact: A contact.
        entry: Its entry in the summary.
        exact: Whether multipliers held in all of the run.
    """
    soft = []
    if not (exact or contact.physical_penalty):
        soft.append(("penetration", "worst_penetration", NORMAL))
    if not (exact or contact.physical_adhesion):
        soft.append(("elastic slip", "worst_elastic_slip", "a larger stiffness of adhesion"))
    found = []
    for name, key, cure in soft:
        share = entry[key] / entry["facet_size"]
        if share > DEEP:
            found.append(
                f"{_pair(entry)}: the {name} was up to {share:.0%} of the facet size, at time "
                f"{entry[f'{key}_time']:.4g}; {_cure(contact, cure)}"
            )
    return found


def _below_arcs(contact: Contact, gap: float | None) -> list[str]:
    """What is said of bodies that do not touch as their facets are flat, if they are.

    Args:
        contact: A contact that is open.
        gap: Least gap of its points, length; none or not a number where none has a master.
    """
    least = math.nan if gap is None else gap
    arcs = contact.sagitta
    if not (arcs > ROUNDING * contact.facet_size and arcs > least >= 0.0):
        return []
    return [
        f"arcs over its facets are {arcs:.3g} high, more than the least gap, {least:.3g}: the "
        "round bodies that they stand for may touch; round cells (order 2) or finer facets show it"
    ]


def _exact(contact: Contact) -> bool:
    """Whether multipliers hold a contact: only how it was at the start is left to penetrate."""
    return contact.trials.augmented


def soft(
    contacts: Sequence[Contact], shown: Sequence[dict[str, Any]], relaxed: bool = False
) -> list[str]:
    """Penetrations that are a share of what pressed the bodies: forces are off by as much.

    Args:
        contacts: The contacts of a run that is done.
        shown: Their entries in the summary.
        relaxed: Whether penalties held where there were no multipliers.
    """
    found = []
    for contact, entry in zip(contacts, shown, strict=True):
        if contact.physical_penalty or (_exact(contact) and not relaxed):
            continue
        deep, size = entry["worst_penetration"], entry["facet_size"]
        said = not ROUNDING < deep / size <= DEEP  # nothing, or by its facets
        if said or contact.interface.normal.named[0] != "penalty":
            continue
        found += [
            f"{_pair(entry)}: {text}, at time {entry['worst_penetration_time']:.4g}, and the force "
            f"is off by about as much; {_cure(contact, NORMAL)}"
            for text in _share_of_way(entry, deep)
        ]
    return found


def _share_of_way(entry: Mapping[str, Any], deep: float) -> list[str]:
    """What is said of a penetration that is a large share of how bodies gave way, if it is."""
    come, stored = entry["worst_penetration_approach"], entry["worst_penetration_stored"]
    if stored is not None:
        held = f"penalties held {stored:.0%} of all that bodies and contacts store"
        return [held] if stored > STORED else []
    # less is no way that a body has come
    if not (SOFT * come < deep and come > ROUNDING * entry["facet_size"]):
        return []
    return [
        f"the penetration was up to {deep / come:.0%} of the {come:.3g} that the bodies came "
        "towards each other"
    ]


def _cure(contact: Contact, stiffer: str) -> str:
    """What helps against a penetration, or elastic slip, of penalties."""
    if _exact(contact):  # penalties held where no multipliers were found
        return "smaller increments, in which multipliers converge, remove it"
    layer = "; where it is the compression of a soft layer: physical_penalty = true"
    layer = layer if stiffer == NORMAL else ""
    return f'{stiffer} makes it smaller, method = "augmented" removes it{layer}'


#: Energies that are no part of what was to be computed, and what is said of them.
_TAKEN = {
    "stabilisation": "stabilisation took up {} of the work from outside: bodies moved while "
    "nothing held them; let them touch at the start, or support them",
    "regularisation": "jumps released {} of the work from outside: inertia, which is left out, "
    "would decide where the bodies come to rest",
}


def _pair(entry: Mapping[str, Any]) -> str:
    return f"contact of {entry['slave']} with {entry['master']}"
