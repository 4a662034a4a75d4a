"""Abaqus and CalculiX input as a mesh: sections are bodies, surfaces and node sets facet groups.

Solid elements alone are taken; parts are put where their instances are. Loads, materials and steps
are not read: they stand in the case file.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.array_types import Ints
from anisocontact.base.errors import InputError
from anisocontact.mesh.deck_contents import IDEAL, KNOWN, PLANE, SOLIDS, Deck, SolidSection
from anisocontact.mesh.deck_reader import read_deck
from anisocontact.mesh.deck_supports import support_lines
from anisocontact.mesh.inside import SIDES
from anisocontact.mesh.tetrahedra import FACES
from anisocontact.mesh.whole import WholeMesh


def read_inp(path: Path) -> WholeMesh:
    """Solid elements, their sections and the named faces of an input file.

    Args:
        path: The file.

    Returns:
        The mesh. Bodies are the element sets of `*SOLID SECTION` (of a part with one section its
        instances), or all elements as one where there is none; facet groups are the surfaces, and
        node sets that hold all corners of faces at the boundary.

    Raises:
        InputError: There is no solid element, an element names a node that is not there, or a
            keyword generates nodes or elements.
        OSError: It cannot be read.
    """
    return _whole_mesh(read_deck(path))


def deck_supports(path: Path, groups: Iterable[str]) -> list[str]:
    """Supports of an input file as a step of a case file has them, a line for each.

    Args:
        path: The file.
        groups: Groups "body.set" of its mesh.

    Raises:
        InputError: As of `read_inp`.
        OSError: It cannot be read.
    """
    deck = read_deck(path)
    named = named_in(groups)
    return list(support_lines(deck.cards, deck.nodes_of, lambda n: named(deck.name_of(n))))


def named_in(groups: Iterable[str]) -> Callable[[str], list[str]]:
    """From the name of a set or surface in a deck to its groups "body.name" among some."""
    known = list(groups)

    def named(entry: str) -> list[str]:
        name = plain(entry)
        found = [one for one in known if one.partition(".")[2] == name]
        return found or [one for one in known if one == entry.lower()]

    return named


def _whole_mesh(deck: Deck) -> WholeMesh:
    """The deck in arrays, its names as a user may write them."""
    if not deck.elements:
        others = ", ".join(f"{n} {kind}" for kind, n in deck.left_out.items()) or "none at all"
        allowed = ", ".join([*SOLIDS, *IDEAL])
        raise InputError(f"no solid element ({allowed}); there are: {others}")
    if not deck.nodes:
        raise InputError("no node: *NODE has no data")
    numbers = np.array(list(deck.nodes), dtype=np.int64)
    order = np.argsort(numbers)
    by_kind: dict[str, list[int]] = {}
    for number, (kind, _) in deck.elements.items():
        by_kind.setdefault(kind, []).append(number)
    mesh = WholeMesh(np.array(list(deck.nodes.values()), dtype=np.float64).reshape(-1, 3)[order])
    elements_of_faces = _beside_solids(by_kind)
    mesh.notes = _notes(by_kind)
    bodies = bodies_of(deck)
    for kind, elements in by_kind.items():
        nodes = np.array([deck.elements[n][1] for n in elements], dtype=np.int64)
        places = np.searchsorted(numbers[order], nodes).clip(max=len(numbers) - 1)
        wrong = numbers[order][places] != nodes
        if wrong.any():
            row, column = np.argwhere(wrong)[0]
            element = elements[row]
            node = nodes[row, column] - (element - deck.as_written(element)[0])
            raise InputError(f"element {deck.told(element)} has node {node}, which is not there")
        cell, _ = KNOWN[kind]
        mesh.add_cells(cell, places, [bodies.get(n, "") for n in elements])
    for name, members in _once(deck, deck.node_sets):
        places = np.searchsorted(numbers[order], np.unique(members)).clip(max=len(numbers) - 1)
        known = np.isin(numbers[order][places], members)
        mesh.node_sets[plain(name)] = places[known]
    at = dict(zip(numbers[order].tolist(), range(len(numbers)), strict=True))
    for name, faces in _once(deck, deck.surfaces):
        found = _faces(deck, name, faces, at)
        mesh.surfaces[plain(name)], mesh.named[plain(name)] = found
    mesh.surfaces |= _of_faces(deck, mesh, elements_of_faces, at)
    mesh.notes = (*mesh.notes, *_odd(deck, mesh))
    mesh.left_out = deck.left_out
    return mesh


def without_section(deck: Deck) -> str:
    """Line on solids that no section names, which are no body; empty if there are none."""
    bodies, kinds = bodies_of(deck), {kind for kind, _ in deck.elements.values()}
    taken = set(SOLIDS) if kinds & set(SOLIDS) else kinds
    lost = [n for n, (kind, _) in deck.elements.items() if kind in taken and n not in bodies]
    if not lost:
        return ""
    return f"{len(lost)} elements, as {deck.told(lost[0])}, are in no *SOLID SECTION: left out"


def _odd(deck: Deck, mesh: WholeMesh) -> Iterator[str]:
    """What is legal in a deck and hardly meant."""
    if deck.moved:
        yield f"{deck.moved} nodes are given once more, at another place: the last one counts"
    if lost := without_section(deck):
        yield lost
    if deck.absent and not deck.left_out:  # elements that are not read take their sets along
        yield f"sets name others that are not there: {', '.join(sorted(deck.absent))}"
    for name, faces in mesh.surfaces.items():
        if not faces:
            yield f"surface {name!r} has no face of a solid: its set of elements is not there"


def _beside_solids(by_kind: dict[str, list[int]]) -> list[int]:
    """Elements of a plane that are beside solids, taken out: a mesher writes named faces so."""
    if not set(by_kind) & set(SOLIDS):
        return []
    return [number for kind in set(by_kind) & set(PLANE) for number in by_kind.pop(kind)]


def _of_faces(
    deck: Deck, mesh: WholeMesh, elements: list[int], at: Mapping[int, int]
) -> dict[str, list[Ints]]:
    """Sets of elements of a plane that are faces of solids, as surfaces."""
    found: dict[str, list[Ints]] = {}
    if not elements:
        return found
    known: dict[int, set[tuple[int, ...]]] = {3: set(), 4: set()}
    for cell, nodes in mesh.cells:
        for side in FACES[cell]:
            known[len(side)].update(map(tuple, np.sort(nodes[:, side], axis=1).tolist()))
    of_face = {
        number: [at[node] for node in deck.elements[number][1][: 3 + (kind in "48")]]
        for number in elements
        for kind in (deck.elements[number][0][-1],)
    }
    for name, members in deck.element_sets.items():
        rows = [of_face[number] for number in members if number in of_face]
        whole = rows and len(rows) == len(members) and plain(name) not in mesh.surfaces
        if whole and all(tuple(sorted(row)) in known[len(row)] for row in rows):
            sizes = sorted({len(row) for row in rows})
            found[plain(name)] = [np.array([r for r in rows if len(r) == n]) for n in sizes]
    mesh.notes = (*mesh.notes, f"{len(elements)} elements of a plane are named faces of solids")
    return found


def _once[T](deck: Deck, sets: Mapping[str, T]) -> Iterator[tuple[str, T]]:
    """Sets without `INSTANCE.NAME` where the instance is a body and `NAME` has the same there."""
    bodies = {body.upper() for body in deck.sections}
    for name, found in sets.items():
        instance, _, own = name.rpartition(".")
        if not (instance in bodies and own in sets and own in deck.of_parts):
            yield name, found


def ideals(kinds: Iterable[str]) -> set[str]:
    """What elements of a mesh in the plane are taken for."""
    return {IDEAL[kind[:3]] for kind in kinds if kind in PLANE}


def _notes(by_kind: dict[str, list[int]]) -> tuple[str, ...]:
    """What elements of a mesh in the plane ask a case file for.

    Raises:
        InputError: They are of several kinds.
    """
    in_plane = ideals(by_kind)
    if not in_plane:
        return ()
    if len(in_plane) > 1:
        text = f"elements of {' and '.join(sorted(in_plane))}: a mesh in the plane is one of them"
        raise InputError(text)
    (ideal,) = in_plane
    return (f'in the plane: a case needs [idealisation] kind = "{ideal}"',)


def bodies_of(deck: Deck) -> dict[int, str]:
    """Body of each element: of the last section that names it."""
    sections = deck.sections or _apart(deck) or {"body": SolidSection("")}
    found: dict[int, str] = {}
    for body, section in sections.items():
        key = section.elements
        members = deck.element_sets.get(key, list(deck.elements) if not key else [])
        found |= dict.fromkeys(members, plain(body))
    return found


def _apart(deck: Deck) -> dict[str, SolidSection]:
    """Sets that have every solid once and share no node: bodies where there are no sections.

    Where there are no solids it is the elements of a mesh in the plane.
    """
    kinds = {number: kind for number, (kind, _) in deck.elements.items()}
    solids = {number for number, kind in kinds.items() if kind in SOLIDS}
    solids = solids or {number for number, kind in kinds.items() if kind in PLANE}
    left, found = set(solids), []
    taken: set[int] = set()
    for name, members in reversed(deck.element_sets.items()):
        own = set(members)
        if own and own <= left and own != solids:
            nodes = {node for number in own for node in deck.elements[number][1]}
            if taken & nodes:
                return {}
            left, taken = left - own, taken | nodes
            found.append(name)
    return {} if left else {name: SolidSection(name) for name in reversed(found)}


def plain(name: str) -> str:
    """A name without the dot, which parts a body from its group, in small letters."""
    return name.replace(".", "_").lower()


def _faces(
    deck: Deck, name: str, faces: Iterable[tuple[str, str]], at: Mapping[int, int]
) -> tuple[list[Ints], list[Ints]]:
    """Faces of a surface by the number of corners: `WholeMesh.surfaces` and `WholeMesh.named`.

    Raises:
        InputError: It names a face that there is not, or of an element that there is not.
    """
    found: dict[int, list[list[int]]] = {}
    named: dict[int, list[tuple[int, int]]] = {}
    starts = np.array([0, *sorted(deck.offsets.values())])
    for entry, face in faces:
        for number in deck.members_of(entry):
            if number not in deck.elements:
                if not deck.left_out:
                    text = f"it names a face of element {deck.told(number)}, which is not there"
                    raise InputError(f"surface {name!r}: {text}")
                continue  # of an element that is no solid
            kind, nodes = deck.elements[number]
            sides = SIDES[KNOWN[kind][0]]
            known = ["", *(f"S{k + 1}" for k in range(len(sides)))]
            if face not in known:
                raise InputError(f"surface: face {face!r} given, S1 to S{len(sides)} are read")
            place = known.index(face)
            written = number - int(starts[np.searchsorted(starts, number) - 1])
            for side in [sides[place - 1]] if place else sides:
                found.setdefault(len(side), []).append([at[nodes[k]] for k in side])
                named.setdefault(len(side), []).append((written, place))
    return _arrays(found.values()), _arrays(named.values())


def _arrays(parts: Iterable[list[Any]]) -> list[Ints]:
    return [np.array(rows, dtype=np.int64) for rows in parts]
