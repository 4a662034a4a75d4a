"""Supports of a deck as lines of a case file: `*BOUNDARY`, in the directions of `*TRANSFORM`.

The directions are as either manual has them: of TYPE=C the first is away from the axis through
the two points that are given, the second about it and the third along it; of TYPE=R the first is
towards the first point, the third normal to the plane with the second.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.mesh.deck import Card, real

#: Names of supports in the place of components.
NAMED = {
    "ENCASTRE": (1, 2, 3),
    "PINNED": (1, 2, 3),
    "XSYMM": (1,),
    "YSYMM": (2,),
    "ZSYMM": (3,),
    "XASYMM": (2, 3),
    "YASYMM": (1, 3),
    "ZASYMM": (1, 2),
}
#: Options of supports and loads that are read; FIXED in the first step holds what has not moved.
READ = {"AMPLITUDE", "OP", "FIXED"}
#: Single nodes that are named in a line.
SHOWN = 6
#: Share of a direction along an axis of space that counts as none.
NO_SHARE = 1e-9


@dataclass(frozen=True)
class Transform:
    """Directions of a set of nodes.

    Attributes:
        cylindrical: Whether they are those of cylinder coordinates, else the same at all nodes.
        axis: Direction of the axis, or rows of the three directions.
        point: A point of the axis.
    """

    cylindrical: bool
    axis: Floats
    point: Floats

    def entries(self, values: Mapping[int, float]) -> tuple[str, dict[str, object]] | None:
        """Key of a step and components for values of the directions 1 to 3; None if there are none.

        Example:
            >>> turned = transform_of("R", [0, 1, 0, -1, 0, 0])
            >>> turned.entries({1: 0.5, 2: 0.25})
            ('displacement', {'y': 0.5, 'x': -0.25})
        """
        if self.cylindrical:
            names = ("radial", "tangential", "axial")
            given: dict[str, object] = {names[k - 1]: v for k, v in values.items()}
            given["axis"] = [float(v) for v in self.axis]
            if self.point.any():
                given["point"] = [float(v) for v in self.point]
            return "cylindrical", given
        if np.any((np.abs(self.axis) > NO_SHARE).sum(axis=1) != 1):
            return None
        along = np.abs(self.axis).argmax(axis=1)
        signs = np.sign(self.axis[np.arange(3), along])
        return "displacement", {
            "xyz"[along[k - 1]]: v * float(signs[k - 1]) + 0.0 for k, v in values.items()
        }


def transform_of(kind: str, numbers: Sequence[float]) -> Transform:
    """Directions of a `*TRANSFORM`.

    Args:
        kind: Its TYPE: R or C.
        numbers: Its six numbers, two points.

    Raises:
        InputError: Another type, fewer numbers, or points that give no directions.
    """
    if kind not in ("R", "C") or len(numbers) < 6:
        raise InputError(f"TYPE={kind} with {len(numbers)} numbers given, R or C with 6 is read")
    a, b = np.array(numbers[:3]), np.array(numbers[3:6])
    if kind == "C":
        if not np.any(b - a):
            raise InputError("its two points are one")
        return Transform(True, b - a, a)
    third = np.cross(a, b)
    if not np.linalg.norm(third) > NO_SHARE * np.linalg.norm(a) * np.linalg.norm(b):
        raise InputError("its two points are on one line with the origin")
    rows = np.array([a, np.cross(third, a), third])
    return Transform(False, rows / np.linalg.norm(rows, axis=1)[:, None], np.zeros(3))


@dataclass(frozen=True)
class DeckSupport:
    """What a `*BOUNDARY` holds or leads of a set, or of a node by its number.

    Attributes:
        step: Number of the step, 0 in front of the first.
        entry: The set or node.
        groups: Groups "body.set" of the set.
        kind: Key of a step, "displacement" or "cylindrical".
        given: Components and directions.
        amplitude: Name of the amplitude that they follow; empty for none.
    """

    step: int
    entry: str
    groups: tuple[str, ...]
    kind: str
    given: Mapping[str, object]
    amplitude: str = ""

    @property
    def table(self) -> str:
        """Its components as a table of a case file."""
        return written({key: with_amplitude(v, self.amplitude) for key, v in self.given.items()})


@dataclass(frozen=True)
class Unread:
    """What a step of a deck has that could not be taken over, in words."""

    step: int
    text: str


def support_lines(
    cards: Sequence[tuple[int, Card]],
    members: Callable[[str], list[int]],
    named: Callable[[str], list[str]],
) -> Iterator[str]:
    """What a step of a case file needs for the supports of a deck, see `supports_of`.

    Yields:
        A line for each key of a step, to be copied as it is, and for what cannot be read.
    """
    lines: dict[tuple[int, str], dict[str, Mapping[str, object]]] = {}
    for one in supports_of(cards, members, named):
        if isinstance(one, Unread):
            lines[one.step, one.text] = {}
        elif one.entry.isdigit():
            key = f"{one.kind} {one.table}"
            lines.setdefault((one.step, key), {})[one.entry] = {}
        else:
            groups = lines.setdefault((one.step, one.kind), {})
            for group in one.groups:
                given = {key: with_amplitude(v, one.amplitude) for key, v in one.given.items()}
                groups[group] = {**groups.get(group, {}), **given}
    for (step, text), found in lines.items():
        if not found:
            yield f"{_where(step)}: {text}"
        elif all(group.isdigit() for group in found):
            yield f"{_where(step)}: {_nodes(list(found))}, which [nodes] can name: {text}"
        else:
            yield f"{_where(step)}: {text} = {written(found)}"


def supports_of(
    cards: Sequence[tuple[int, Card]],
    members: Callable[[str], list[int]],
    named: Callable[[str], list[str]],
) -> Iterator[DeckSupport | Unread]:
    """The supports of a deck.

    Args:
        cards: Its cards with the number of the step in which each stands, 0 in front of the first.
        members: Name of a node set, or number of a node -> numbers of its nodes.
        named: Name of a node set -> groups "body.set".

    Yields:
        What each set of nodes or node of a `*BOUNDARY` needs, and what cannot be read.
    """
    of_node: dict[int, Transform] = {}
    for step, card in cards:
        try:
            if card.name not in ("TRANSFORM", "BOUNDARY"):
                continue
            if card.name == "TRANSFORM":
                numbers = [real(v) for line in card.fields() for v in line]
                found = transform_of(card.options.get("TYPE", "R").upper(), numbers)
                of_node |= dict.fromkeys(members(card.option("NSET")), found)
            elif "FIXED" in card.options and step > 1:
                raise InputError("FIXED holds nodes where they are; give their displacements")
            else:
                check_options(card)
                amplitude = card.options.get("AMPLITUDE", "").lower()
                for entry, values in _entries(card, of_node):
                    directed = _directed(entry, values, of_node, members)
                    groups = tuple(named(entry))
                    if isinstance(directed, str):
                        yield Unread(step, directed)
                    elif groups or entry.isdigit():
                        yield DeckSupport(step, entry, groups, *directed, amplitude)
                    else:
                        yield Unread(step, f"{entry.lower()} is on no body")
        except (InputError, ValueError, IndexError) as error:
            said = error if isinstance(error, InputError) else "its data are of another kind"
            yield Unread(step, f"*{card.name} of line {card.line} is not read: {said}")


def _nodes(numbers: Sequence[str]) -> str:
    """Some nodes by their numbers."""
    more = f" and {len(numbers) - SHOWN} more" if len(numbers) > SHOWN else ""
    return f"node{'s'[: len(numbers) > 1]} {', '.join(numbers[:SHOWN])}{more}"


def _where(step: int) -> str:
    return f"step {step}" if step else "from the start"


def _values(card: Card) -> dict[str, dict[int, float]]:
    """Set or node -> direction -> displacement at the end of the step."""
    found: dict[str, dict[int, float]] = {}
    for entry, first, *rest in card.rows():
        if first.upper() in NAMED:
            found.setdefault(entry, {}).update(dict.fromkeys(NAMED[first.upper()], 0.0))
            continue
        last = int(rest[0]) if rest and rest[0] else int(first)
        value = real(rest[1]) if len(rest) > 1 else 0.0
        components = {k: value for k in range(int(first), last + 1) if k <= 3}
        if components:
            found.setdefault(entry, {}).update(components)
    return found


def supported_nodes(card: Card) -> dict[str, list[int]]:
    """Nodes by their numbers that a `*BOUNDARY` holds or leads alike, two or more, as node sets.

    Returns:
        Name of a set, by the line of the card -> numbers; none where the data cannot be read.

    Example:
        >>> supported_nodes(Card("BOUNDARY", {}, ("1, 1, 3", "2, 1, 3", "4, 2"), 12))
        {'HELD_12': [1, 2]}
    """
    alike: dict[tuple[tuple[int, float], ...], list[int]] = {}
    try:
        found = _values(card)
    except (ValueError, IndexError):
        return {}
    for entry, values in found.items():
        if entry.isdigit():
            alike.setdefault(tuple(sorted(values.items())), []).append(int(entry))
    several = [nodes for nodes in alike.values() if len(nodes) > 1]
    ends = ["", *(f"_{k + 2}" for k in range(len(several)))]
    return {f"HELD_{card.line}{end}": nodes for end, nodes in zip(ends, several, strict=False)}


def _entries(
    card: Card, of_node: Mapping[int, Transform]
) -> Iterator[tuple[str, dict[int, float]]]:
    """What a `*BOUNDARY` says of sets and nodes; nodes that are led alike are one set."""
    values = _values(card)
    for name, nodes in supported_nodes(card).items():
        if len({id(of_node.get(node)) for node in nodes}) == 1:
            alike = [values.pop(str(node)) for node in nodes]
            yield name, alike[0]
    yield from values.items()


def _directed(
    entry: str,
    values: Mapping[int, float],
    of_node: Mapping[int, Transform],
    members: Callable[[str], list[int]],
) -> tuple[str, dict[str, object]] | str:
    """Key and components of one support, or why it is none."""
    nodes = members(entry)
    space = Transform(False, np.eye(3), np.zeros(3))
    systems = {id(one): one for one in (of_node.get(node, space) for node in nodes or [0])}
    if len(systems) > 1:
        return f"the nodes of {entry.lower()} have several *TRANSFORM: give each a set of its own"
    found = next(iter(systems.values())).entries(values)
    if found is None:
        return (
            f"{entry.lower()} has directions that are no axes of space: symmetry, or turn the mesh"
        )
    return found


def check_options(card: Card) -> None:
    """Refuse a support or load whose numbers are made something else by an option.

    Raises:
        InputError: It has such an option.
    """
    if "TIMEDELAY" in card.options:
        raise InputError("TIME DELAY is not read; shift the times of the amplitude")
    for option, value in card.options.items():
        plain = option == "TYPE" and value.upper() == "DISPLACEMENT"
        if option not in READ and not plain:
            raise InputError(f"the option {option}{'=' * bool(value)}{value} is not read")


def with_amplitude(value: object, amplitude: str) -> object:
    """A number as a step has it that follows an amplitude, if there is one."""
    follows = amplitude and isinstance(value, float) and value != 0.0
    return {"amplitude": amplitude, "value": value} if follows else value


def key_of(name: str) -> str:
    """A name as a key of TOML.

    Example:
        >>> key_of("top"), key_of("b.top"), key_of("über")
        ('top', '"b.top"', '"über"')
    """
    plain = name.isascii() and name.replace("_", "").isalnum()
    return name if plain else json.dumps(name, ensure_ascii=False)


def written(value: object) -> str:
    """A value as a case file has it, tables in one line.

    Example:
        >>> written({"b.top": {"x": 0.5, "axis": [0.0, 0.0, 1.0]}})
        '{ "b.top" = { x = 0.5, axis = [0, 0, 1] } }'
    """
    if isinstance(value, Mapping):
        return f"{{ {', '.join(f'{key_of(k)} = {written(v)}' for k, v in value.items())} }}"
    if isinstance(value, list):
        return f"[{', '.join(map(written, value))}]"
    if isinstance(value, bool):
        return str(value).lower()
    # a string of JSON is one of TOML
    return json.dumps(value, ensure_ascii=False) if isinstance(value, str) else f"{value:.10g}"
