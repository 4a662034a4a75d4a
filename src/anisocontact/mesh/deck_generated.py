"""Keywords of a deck that make nodes and elements out of others: `*NGEN`, `*NFILL`, `*ELGEN`.

As the manual of Abaqus has them. `BIAS` is the length of an interval over that of the next one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.mesh.deck import Card, real
from anisocontact.mesh.deck_contents import Deck
from anisocontact.mesh.placement import Rotation

#: Keywords that make or move nodes or elements in a way that is not read.
NOT_READ = ("NCOPY", "ELCOPY", "NMAP", "SYSTEM")
#: Share of a right angle or length that counts as none.
NO_SHARE = 1e-9


def generate_nodes(deck: Deck, card: Card) -> None:
    """Take `*NGEN`: nodes between two on a line, or on an arc about a centre.

    Raises:
        InputError: A node is not there, the numbers do not fit, or the line is another one.
    """
    _allow(card, ("NSET", "LINE"))
    found: list[int] = []
    for entries in card.rows():
        first, last = int(entries[0]), int(entries[1])
        step = int((*entries[2:3], "")[0] or "1")
        count = _count(last - first, step)
        shares = np.arange(count + 1) / count
        a, b = (_node(deck, number) for number in (first, last))
        if card.options.get("LINE", "L").upper() == "C":
            places = _arc(a, b, _centre(deck, entries), entries[7:10], shares)
        elif card.options.get("LINE", "L").upper() in ("", "L"):
            places = a + np.outer(shares, b - a)
        else:
            raise InputError("lines and arcs (LINE=C) are read")
        numbers = range(first, first + step * (count + 1), step)
        for number, place in zip(numbers, places.tolist(), strict=True):
            deck.nodes.setdefault(number, place)
        found += numbers
    deck.add_nodes(card, found)


def fill(deck: Deck, card: Card) -> None:
    """Take `*NFILL`: nodes between those of two sets.

    Raises:
        InputError: The sets differ in size, or an option is not read.
    """
    _allow(card, ("NSET", "BIAS"))
    bias = real(card.options.get("BIAS") or "1")
    found: list[int] = []
    for entries in card.fields():
        ends = [deck.bound(entry) for entry in entries[:2]]
        if not ends[0] or len(ends[0]) != len(ends[1]):
            raise InputError(f"{entries[0]} has {len(ends[0])} nodes, {entries[1]} {len(ends[1])}")
        count, step = int(entries[2]), int(entries[3]) if len(entries) > 3 else 1
        lengths = bias ** -np.arange(count, dtype=float)
        shares = np.concatenate(([0.0], np.cumsum(lengths) / lengths.sum()))
        for first, last in zip(*ends, strict=True):
            a, b = _node(deck, first), _node(deck, last)
            for k in range(1, count):
                deck.nodes[first + k * step] = (a + shares[k] * (b - a)).tolist()
            found += [*range(first, first + count * step, step), last]
    deck.add_nodes(card, found)


def generate_elements(deck: Deck, card: Card) -> None:
    """Take `*ELGEN`: rows, layers and blocks of an element.

    Raises:
        InputError: The element is not there.
    """
    _allow(card, ("ELSET",))
    found: list[int] = []
    for entries in card.rows():
        master, *rest = (int(entry or "0") for entry in entries)
        if master not in deck.elements:
            raise InputError(f"element {master} is not there, or no solid")
        kind, nodes = deck.elements[master]
        for more, by in _copies(rest):
            deck.elements[master + more] = kind, tuple(node + by for node in nodes)
            found.append(master + more)
    deck.add_elements(card, found)


def _copies(rest: Sequence[int]) -> Iterator[tuple[int, int]]:
    """What is added to the number of an element and to its nodes, for all of its copies."""
    made = [(0, 0)]
    for k in range(0, len(rest), 3):
        count, by, more = (*rest[k : k + 3], 1, 1)[:3] if len(rest) > k + 1 else (rest[k], 1, 1)
        made = [
            (element + n * (more or 1), node + n * (by or 1))
            for n in range(max(count, 1))
            for element, node in made
        ]
    yield from made


def _allow(card: Card, options: Sequence[str]) -> None:
    for option in card.options:
        if option not in options:
            raise InputError(f"the option {option} is not read; write nodes and elements out")


def _count(span: int, step: int) -> int:
    """Intervals between two numbers."""
    if step == 0 or span % step or span // step < 1:
        raise InputError(f"numbers {span} apart are not reached in steps of {step}")
    return span // step


def _node(deck: Deck, number: int) -> Floats:
    if number not in deck.nodes:
        raise InputError(f"node {number} is not there")
    return np.array(deck.nodes[number])


def _centre(deck: Deck, entries: Sequence[str]) -> Floats:
    if len(entries) > 3 and entries[3]:
        return _node(deck, int(entries[3]))
    given = [real(entry or "0") for entry in entries[4:7]]
    if not given:
        raise InputError("an arc needs its centre, as a node or by its place")
    return np.array([*given, 0.0, 0.0][:3])


def _arc(a: Floats, b: Floats, centre: Floats, given: Sequence[str], shares: Floats) -> Floats:
    """Places on an arc from one node to another; radii that differ go over linearly."""
    normal = np.array([*(real(entry or "0") for entry in given), 0.0, 0.0, 0.0][:3])
    across = np.cross(a - centre, b - centre)
    size = np.linalg.norm(a - centre) * np.linalg.norm(b - centre)
    if not normal.any():
        if not np.linalg.norm(across) > NO_SHARE * size:
            raise InputError("an arc of 180 or 360 degrees needs the normal of its plane")
        normal = across
    normal = normal / np.linalg.norm(normal)
    angle = np.arctan2(across @ normal, (a - centre) @ (b - centre))
    if angle <= NO_SHARE:
        angle += 2.0 * np.pi
    start, end = (np.linalg.norm(one - centre) for one in (a, b))
    turn = Rotation(tuple(normal), angle_deg=float(np.degrees(angle)), point=tuple(centre))
    turned = [turn.apply(a[None], float(share))[0] - centre for share in shares]
    radii = start + shares * (end - start)
    places = centre + np.array(turned) * (radii / start)[:, None]
    places[-1] = b
    return places


#: Keyword -> what takes it.
GENERATORS: dict[str, Callable[[Deck, Card], None]] = {
    "NGEN": generate_nodes,
    "NFILL": fill,
    "ELGEN": generate_elements,
}
