"""Elements of a file by their kind, and what they have to be before they are a mesh."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError

#: A cell and how many nodes it has; nodes and body of each element.
type Kind = tuple[str, int]
type Elements = tuple[Ints, list[str]]

#: How many nodes elements of a kind may have, that of its corners first.
COUNTS = {
    "triangle": (3, 6),
    "quadrilateral": (4, 8, 9),
    "tetrahedron": (4, 10),
    "pyramid": (5, 13, 14),
    "prism": (6, 15, 18),
    "hexahedron": (8, 20, 27),
}


def check_elements(cell: str, nodes: Ints, bodies: Sequence[str]) -> None:
    """Refuse what a reader adds if it is no list of elements.

    Args:
        cell: Kind of the elements.
        nodes: Nodes of each, (n, k).
        bodies: Name of the body of each, (n,).

    Raises:
        InputError: An unknown kind, another number of nodes than its elements have, numbers that
            are not whole, or not a body for each element.

    Example:
        >>> check_elements("tetrahedron", np.array([[0, 1, 2]]), ["body"])
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: nodes: int64 of shape (1, 3) given, ...
    """
    if cell not in COUNTS:
        raise InputError(f"{cell!r} given, must be one of {', '.join(COUNTS)}", "cell")
    given = np.asarray(nodes)
    if given.ndim != 2 or given.dtype.kind not in "iu" or given.shape[1] not in COUNTS[cell]:
        allowed = " or ".join(map(str, COUNTS[cell]))
        text = f"{given.dtype} of shape {given.shape} given, whole numbers (n, {allowed}) needed"
        raise InputError(text, "nodes")
    if isinstance(bodies, str) or len(bodies) != len(given):
        of = repr(bodies) if isinstance(bodies, str) else f"{len(bodies)} names"
        raise InputError(f"{of} given, one for each of {len(given)} elements needed", "bodies")


def in_words(kinds: Iterable[Kind]) -> str:
    """Kinds of elements as a message has them.

    Example:
        >>> in_words([("tetrahedron", 4), ("hexahedron", 8)])
        'hexahedrons of 8 nodes and tetrahedrons of 4 nodes'
    """
    return " and ".join(f"{cell}s of {n} nodes" for cell, n in sorted(kinds))


def check_apart(kinds: Mapping[Kind, Elements]) -> None:
    """Refuse kinds of elements that share nodes: no mesh has cells of both.

    Args:
        kinds: Nodes and bodies of the elements, by cell and number of nodes.

    Raises:
        InputError: There are such elements, or elements of two kinds.
    """
    said = in_words(kinds)
    nodes = np.concatenate([np.unique(rows) for rows, _ in kinds.values()])
    if len(np.unique(nodes)) < len(nodes) or len({cell for cell, _ in kinds}) > 1:
        raise InputError(f"{said}: a mesh has cells of one kind")
    names = [name for _, labels in kinds.values() for name in dict.fromkeys(labels)]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"body {name!r} has {said}, one kind is needed")


def check_nodes(kinds: Mapping[Kind, Elements], points: Floats) -> None:
    """Refuse cells whose nodes are missing, or nowhere.

    Args:
        kinds: Nodes and bodies of the elements, by cell and number of nodes.
        points: Places of all nodes, (nodes, 3), length.

    Raises:
        InputError: There are such cells.
    """
    if np.ndim(points) != 2 or np.shape(points)[1] != 3:
        raise InputError(f"an array of shape {np.shape(points)} given, (nodes, 3) needed", "points")
    used = np.unique(np.concatenate([nodes.ravel() for nodes, _ in kinds.values()]))
    lost = used[(used < 0) | (used >= len(points))]
    if len(lost):
        raise InputError(f"a cell names node {lost[0]} counted from 0, there are {len(points)}")
    endless = used[~np.isfinite(points[used]).all(axis=1)]
    if len(endless):
        place = ", ".join(f"{x:g}" for x in points[endless[0]])
        raise InputError(
            f"{len(endless)} nodes have coordinates that are not finite, such as ({place})"
        )


def check_degenerate(kinds: Mapping[Kind, Elements]) -> None:
    """Refuse cells that name a node twice.

    Args:
        kinds: Nodes and bodies of the elements, by cell and number of nodes.

    Raises:
        InputError: There are such cells.
    """
    for (cell, _), (nodes, _) in kinds.items():
        twice = int((np.diff(np.sort(nodes, axis=1), axis=1) == 0).any(axis=1).sum())
        if twice:
            text = f"{twice} of {len(nodes)} {cell}s name a node twice"
            raise InputError(f"{text}; degenerate cells have to be wedges, pyramids, tetrahedra")


def check_single(kinds: Mapping[Kind, Elements]) -> None:
    """Refuse two cells of the same nodes, whose faces would lie inside.

    Args:
        kinds: Nodes and bodies of the elements, by cell and number of nodes.

    Raises:
        InputError: There are such cells.
    """
    for (cell, _), (nodes, _) in kinds.items():
        again = len(nodes) - len(np.unique(np.sort(nodes, axis=1), axis=0))
        if again:
            raise InputError(f"{again} of {len(nodes)} {cell}s have the nodes of another one")
