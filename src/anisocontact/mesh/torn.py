"""Cells of a file that are left out, and bodies that hang together with them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence

import numpy as np

from anisocontact.base.array_types import Ints
from anisocontact.base.errors import ModelWarning, tell_script


def torn(bodies: Collection[str], common: int, left: Collection[str]) -> tuple[str, ...]:
    """A line on bodies that end where the mesh of their file goes on.

    Args:
        bodies: Bodies that are taken.
        common: Nodes that they have in common with cells that are left out.
        left: Names of the bodies of these cells; empty where they are in none.

    Example:
        >>> torn(["shaft"], 0, [])
        ()
        >>> torn(["shaft"], 9, ["head"])[0][:79]
        "'shaft' ends where the mesh of its file goes on with cells of 'head', which are"
    """
    if not common:
        return ()
    names = ", ".join(map(repr, bodies))
    ends, file = ("ends", "its file") if len(bodies) == 1 else ("end", "their file")
    of = f"of {', '.join(map(repr, left))}" if left else "that are in no body"
    return (
        f"{names} {ends} where the mesh of {file} goes on with cells {of}, which are left out: "
        f"{common} nodes belong to both, and the surface there is free; take all of them as "
        "bodies, each with a material",
    )


def torn_cells(
    cells: Sequence[tuple[str, Ints]], bodies: Sequence[Sequence[str]], wanted: Collection[str]
) -> tuple[str, ...]:
    """The same of all cells of a file.

    Args:
        cells: Kind and nodes of the elements.
        bodies: Body of each element of each kind; "" for none.
        wanted: Bodies that are taken.
    """
    taken, left = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    owners: list[tuple[Ints, list[str]]] = []
    for (_, nodes), labels in zip(cells, bodies, strict=True):
        own = np.isin(np.array(labels), list(wanted))
        taken.append(nodes[own].ravel())
        left.append(nodes[~own].ravel())
        owners.append((nodes[~own], [name for name in labels if name not in wanted]))
    common = np.intersect1d(np.concatenate(taken), np.concatenate(left))
    names = {
        labels[k]
        for nodes, labels in owners
        for k in np.flatnonzero(np.isin(nodes, common).any(axis=1))
    }
    return torn(wanted, len(common), sorted(names - {""}))


def tell_torn(lines: Iterable[str]) -> None:
    """Warn a script of bodies that hang together with cells that are left out."""
    for line in lines:
        tell_script(line, ModelWarning)


def without_body(bodies: Sequence[Sequence[str]]) -> Iterator[str]:
    """A line on cells that are in no body, while others are.

    Args:
        bodies: Body of each element of each kind; "" for none.
    """
    lost = sum(labels.count("") for labels in map(list, bodies))
    if lost:
        yield f"{lost} of {sum(map(len, bodies))} cells are in no group of cells: left out"
