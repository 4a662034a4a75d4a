"""`checkpoint.npz`: all that a run needs to go on, written after each accepted increment.

Arrays are those of all ranks one after the other, with the positions in the reference configuration
that they belong to, so that another number of ranks finds its own among them.
"""

from __future__ import annotations

import json
import os
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.contact.facet_mesh import node_positions
from anisocontact.errors import InputError
from anisocontact.mesh import Model
from anisocontact.results.files import replacing
from anisocontact.solver.persistent import Arrays, Persistent, under

__all__ = ["NAME", "Stored", "distribute", "gathered", "load_checkpoint", "save_checkpoint"]

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

NAME = "checkpoint.npz"
#: Changes with the meaning of the file.
FORMAT = 4
#: Distance within which two positions are the same, over the size of the mesh.
SAME = 1e-9


@dataclass(frozen=True)
class Stored:
    """Content of a checkpoint.

    Attributes:
        arrays: All arrays by name, those of all ranks joined.
        facts: Nested text and numbers beside them.
    """

    arrays: Arrays
    facts: dict[str, Any]


def gathered(model: Model, kept: Persistent) -> Arrays:
    """Arrays of all ranks joined, under the names they have in the file.

    Args:
        model: The mesh.
        kept: State of this rank; the call is collective.

    Returns:
        The arrays; none but on the first rank.
    """
    local = _named(kept, _where(model))
    parts = model.mesh.comm.gather(local)
    if parts is None:
        return {}
    joined = {name: np.concatenate([part[name] for part in parts]) for name in local}
    joined |= {f"common/{name}": values for name, values in kept.common.items()}
    return joined | {f"strategy/{name}": values for name, values in kept.strategy.items()}


def save_checkpoint(folder: Path, arrays: Arrays, facts: dict[str, Any]) -> None:
    """Write a checkpoint at once: a reader finds the old one or this one.

    Args:
        folder: Results folder.
        arrays: As of `gathered`.
        facts: What else is to be kept, as JSON can have it.

    Raises:
        OSError: It cannot be written; the old one is still there.
    """
    text = json.dumps(facts | {"format": FORMAT})
    named = arrays | {"facts": np.frombuffer(text.encode(), dtype=np.uint8)}
    with replacing(folder / NAME) as draft, draft.open("wb") as file:
        np.savez(file, **named)  # type: ignore[arg-type]
        file.flush()
        os.fsync(file.fileno())


def load_checkpoint(folder: Path) -> Stored | None:
    """Read a checkpoint.

    Args:
        folder: Results folder.

    Returns:
        Its content; None where there is none.

    Raises:
        InputError: It is damaged or of another version.
    """
    path = folder / NAME
    if not path.is_file():
        return None
    try:
        with path.open("rb") as opened, np.load(opened) as file:
            arrays = dict(file)
        facts = json.loads(arrays.pop("facts").tobytes())
    except (OSError, ValueError, KeyError, zipfile.BadZipFile) as error:
        raise InputError(f"'{path}' cannot be read: {error}") from None
    if facts.get("format") != FORMAT:
        raise InputError(
            f"'{path}' has format {facts.get('format')!r}, this version reads {FORMAT}"
        )
    return Stored(arrays, facts)


def distribute(stored: Stored, model: Model, like: Persistent) -> Persistent:
    """The part of a checkpoint that belongs to this rank.

    Args:
        stored: The checkpoint, the same on every rank.
        model: The mesh.
        like: State of the problem as it was built.

    Returns:
        The state to go on from.

    Raises:
        InputError: The mesh or a contact is not that of the checkpoint.
    """
    where = _where(model)
    arrays = stored.arrays
    size = float(np.ptp(arrays["node/position"], axis=0).max(initial=0.0))
    nodes = model.space.dofmap.index_map.size_global
    passes = {name.split("/")[1] for name in arrays if name.startswith("points/")}
    if len(arrays["node/position"]) != nodes or len(passes) != len(like.points):
        raise InputError("the mesh or the contacts are not those of the run that is to go on")
    rows = _matched(arrays["node/position"], arrays["node/body"], *where, SAME * size)
    nodal = {name: values[rows] for name, values in under("nodal/", arrays).items()}
    points = [
        _points_of(arrays, f"points/{i}/", part, SAME * size) for i, part in enumerate(like.points)
    ]
    # numbers of unknowns mean something only where they are those of the run that wrote them
    same = model.mesh.comm.size == 1 and np.array_equal(rows, np.arange(nodes))
    strategy = under("strategy/", arrays) if same else {}
    return Persistent(nodal, points, under("common/", arrays), strategy)


def _points_of(arrays: Arrays, prefix: str, like: Arrays, near: float) -> Arrays:
    """Values of this rank's slave points of one pass."""
    stored = under(prefix, arrays)
    for name, values in like.items():
        if name not in stored or stored[name].dtype.names != values.dtype.names:
            raise InputError("the states of points are not those of this version")
    here, there = like["reference"], stored["reference"]
    one = [np.zeros(len(x), dtype=np.int64) for x in (there, here)]
    rows = _matched(there, one[0], here, one[1], near)
    # Joining records packs them; the core wants its own layout.
    return {name: values[rows].astype(like[name].dtype) for name, values in stored.items()}


def _named(kept: Persistent, where: tuple[Floats, Ints]) -> Arrays:
    """Arrays of this rank under the names they have in the file."""
    named: Arrays = {"node/position": where[0], "node/body": where[1]}
    named |= {f"nodal/{name}": values for name, values in kept.nodal.items()}
    for i, part in enumerate(kept.points):
        named |= {f"points/{i}/{name}": values for name, values in part.items()}
    return named


def _where(model: Model) -> tuple[Floats, Ints]:
    """Position of each node this rank owns, and the first body it belongs to."""
    index_map = model.space.dofmap.index_map
    owned = index_map.size_local
    body = np.full(owned + index_map.num_ghosts, len(model.body_names()), dtype=np.int64)
    for number, name in reversed(list(enumerate(model.body_names()))):
        body[model.space.dofmap.list[model.cells(name)]] = number
    return node_positions(model.space)[:owned].copy(), body[:owned]


def _matched(there: Floats, kind_there: Ints, here: Floats, kind_here: Ints, near: float) -> Ints:
    """Rows of `there` with the positions `here`, both of the same kind.

    Raises:
        InputError: A position is not among them.
    """
    if np.array_equal(there, here) and np.array_equal(kind_there, kind_here):
        return np.arange(len(here))
    from scipy.spatial import cKDTree  # slow to import, and needed on other meshes only

    rows = np.full(len(here), -1, dtype=np.int64)
    for kind in np.unique(kind_here):
        mine = np.flatnonzero(kind_here == kind)
        theirs = np.flatnonzero(kind_there == kind)
        if not len(theirs):
            continue
        distance, found = cKDTree(there[theirs]).query(here[mine])
        rows[mine] = np.where(distance <= near, theirs[found], -1)
    if (rows < 0).any():
        at = ", ".join(f"{v:.6g}" for v in here[np.flatnonzero(rows < 0)[0]])
        raise InputError(f"the mesh is not that of the run that is to go on: nothing at ({at})")
    return rows
