"""Parts of a deck where their instances are, and names `INSTANCE.NUMBER` of an assembly.

An instance is a copy of its part, with what stands between `*INSTANCE` and `*END INSTANCE`: the
mesh of a part may be written there, as it is of independent instances.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.mesh.deck import Card, real
from anisocontact.mesh.deck_contents import Deck
from anisocontact.mesh.placement import Rotation

#: Keywords that nodes and elements stand in front of the end of, beside the assembly's own.
INSIDE = {"PART": "ENDPART", "INSTANCE": "ENDINSTANCE"}


def own_numbers(cards: Sequence[Card]) -> int:
    """Largest number of a node or element of an assembly itself, as of its reference points."""
    largest, end = 0, ""
    if any(card.name == "PART" for card in cards):
        for card in cards:
            end = ("" if card.name == end else end) if end else INSIDE.get(card.name, "")
            if card.name in ("NODE", "ELEMENT") and not end:
                firsts = (entries[0] for entries in card.fields() if entries)
                largest = max(largest, *(int(n) for n in firsts if n.isdigit()), 0)
    return largest


def begun(card: Card, parts: Mapping[str, Deck]) -> Deck:
    """What an instance has of its part, a copy.

    Raises:
        InputError: There is no such part.
    """
    if card.option("PART").upper() not in parts:
        raise InputError(f"there is no part {card.options['PART']!r}")
    part = parts[card.options["PART"].upper()]
    return replace(
        part,
        nodes=dict(part.nodes),
        elements=dict(part.elements),
        node_sets={name: list(found) for name, found in part.node_sets.items()},
        element_sets={name: list(found) for name, found in part.element_sets.items()},
        surfaces={name: list(found) for name, found in part.surfaces.items()},
        profiles=dict(part.profiles),
        sections=dict(part.sections),
        left_out=dict(part.left_out),
        absent=set(part.absent),
        cards=list(part.cards),
    )


def place(whole: Deck, card: Card, part: Deck) -> None:
    """Put an instance where it is; its sets and surfaces are named `INSTANCE.NAME` and `NAME`.

    Args:
        whole: The assembly.
        card: The `*INSTANCE`.
        part: What it has.
    """
    name = card.option("NAME")
    if name.upper() in whole.offsets:
        raise InputError(f"there is an instance {name!r} already")
    more = max((*whole.nodes, *whole.elements, whole.own))
    whole.offsets[name.upper()] = more
    moved_to = _placement(card)
    points = moved_to(np.array(list(part.nodes.values())).reshape(-1, 3))
    whole.nodes |= {
        more + number: place for number, place in zip(part.nodes, points.tolist(), strict=True)
    }
    for number, (kind, nodes) in part.elements.items():
        whole.elements[more + number] = kind, tuple(more + n for n in nodes)
    _name_sets(whole, name, part, more)
    _name_surfaces(whole, name, part, more)
    for key, profile in part.profiles.items():
        for full in (f"{name}.{key}".upper(), key):
            whole.profiles[full] = profile.placed(moved_to)
    for body, section in part.sections.items():
        only = len(part.sections) == 1
        moved_set = f"{name}.{section.elements}".upper()
        whole.sections[name if only else f"{name}_{body}"] = replace(section, elements=moved_set)
    whole.moved += part.moved
    whole.absent |= part.absent
    for element, count in part.left_out.items():
        whole.left_out[element] = whole.left_out.get(element, 0) + count
    for step, one in part.cards:
        whole.add_card(step, _of_instance(one, name, part, more))


def _name_sets(whole: Deck, name: str, part: Deck, more: int) -> None:
    """Sets of an instance whose numbers are `more` than those of its part, by both names."""
    for own, of_part in (
        (whole.node_sets, part.node_sets),
        (whole.element_sets, part.element_sets),
    ):
        for key, numbers in of_part.items():
            for full in (f"{name}.{key}".upper(), key):
                own.setdefault(full, []).extend(more + n for n in numbers)
            whole.of_parts.add(key)


def _name_surfaces(whole: Deck, name: str, part: Deck, more: int) -> None:
    """Surfaces of an instance in the same way, on its own sets and elements."""
    for key, faces in part.surfaces.items():
        moved = [
            (f"{name.upper()}.{s}" if s in part.element_sets else str(more + int(s)), face)
            for s, face in faces
        ]
        whole.surfaces[f"{name}.{key}".upper()] = moved
        whole.surfaces.setdefault(key, []).extend(moved)
        whole.of_parts.add(key)


def numbered(card: Card, offsets: Mapping[str, int]) -> Card:
    """A card with the numbers of the assembly where it has `INSTANCE.NUMBER`.

    Example:
        >>> numbered(Card("BOUNDARY", {}, ("Rod-1.12, 1, 3", "1.5, 2"), 1), {"ROD-1": 100}).data
        ('112, 1, 3', '1.5, 2')
    """

    def of(entry: str) -> str:
        instance, _, number = entry.strip().strip('"').rpartition(".")
        known = number.isdigit() and instance.upper() in offsets
        return str(offsets[instance.upper()] + int(number)) if known else entry

    if not offsets:
        return card
    data = tuple(",".join(map(of, line.split(","))) if "." in line else line for line in card.data)
    options = {key: of(value) for key, value in card.options.items()}
    return replace(card, data=data, options=options)


def _of_instance(card: Card, name: str, part: Deck, more: int) -> Card:
    """A card of a part with the names and numbers of an instance."""
    sets = {*part.node_sets, *part.element_sets, *part.surfaces, *part.profiles}

    def of(entry: str) -> str:
        key = entry.strip().strip('"')
        if key.upper() in sets:
            return f"{name}.{key}"
        return str(more + int(key)) if key.isdigit() else entry

    options = {key: of(value) for key, value in card.options.items()}
    firsts = (line.partition(",") for line in card.data)
    data = tuple("".join((of(first), *rest)) for first, *rest in firsts)
    return replace(card, options=options, data=data)


def _placement(card: Card) -> Callable[[Floats], Floats]:
    """Where the points of a part are in an instance: moved, then turned about an axis."""
    lines = [[real(v or "0") for v in entries] for entries in card.rows() if entries]
    move = np.array([*(lines[0] if lines else ()), 0.0, 0.0, 0.0][:3])
    if len(lines) < 2:
        return lambda points: points + move
    start, end, angle = np.array(lines[1][:3]), np.array(lines[1][3:6]), lines[1][6]
    if not (end - start).any():
        raise InputError("its two points of the axis are one")
    turn = Rotation(tuple(end - start), angle_deg=angle, point=tuple(start))
    return lambda points: turn.apply(points + move)
