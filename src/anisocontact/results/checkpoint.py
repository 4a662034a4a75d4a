"""`checkpoint.npz`: all that a run needs to go on from an accepted increment.

On several processes each writes the arrays of its own nodes and points into a file of the folder
`checkpoint`, and `checkpoint.npz` names these files and has what all have in common. Beside its
arrays a file has the positions in the reference configuration that they belong to, so that another
number of processes finds its own among them.
"""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from numpy.lib.recfunctions import repack_fields

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.shown import shown
from anisocontact.base.whole_files import replacing
from anisocontact.mesh import Model
from anisocontact.results.files import Disk
from anisocontact.solver.terms.persistent import Arrays, Persistent, under

NAME = "checkpoint.npz"
#: Folder of the pieces of several processes.
PIECES = "checkpoint"
#: Changes with the meaning of the file.
FORMAT = 26
#: Distance within which two positions are the same, over the size of the mesh.
SAME = 1e-9
#: What is said where points are not found by another number of processes.
_OF_PROCESSES = (
    "; it had another number of processes, on which contacts in the plane and at cut faces of "
    "sectors have other points: go on with that number"
)


@dataclass(frozen=True)
class Stored:
    """Content of a checkpoint.

    Attributes:
        arrays: Arrays by name; of a run on several processes those that they have in common.
        facts: Nested text and numbers beside them.
        pieces: Files with the arrays of each process; none of a run on one.
    """

    arrays: Arrays
    facts: dict[str, Any]
    pieces: tuple[Path, ...] = ()

    def search(self, first: int, look: Callable[[Mapping[str, Any]], bool]) -> None:
        """Go through the arrays of one process after the other, never all of them at a time.

        Args:
            first: The piece to begin with.
            look: Takes the arrays of a piece; whether it has all it needs.

        Raises:
            InputError: A piece is missing or damaged.
        """
        if not self.pieces:
            look(self.arrays)
            return
        first %= len(self.pieces)
        for path in (*self.pieces[first:], *self.pieces[:first]):
            with _readable(path), path.open("rb") as opened, np.load(opened) as file:
                if look(file):
                    return


def own_arrays(model: Model, kept: Persistent) -> tuple[Arrays, Arrays]:
    """What a checkpoint has of this process, and what all processes have in common.

    Args:
        model: The mesh.
        kept: State of this process; the call is collective.

    Returns:
        Both under the names they have in the file.
    """
    position, body = _where(model)
    comm = model.mesh.comm
    ends = [position.min(axis=0, initial=np.inf), -position.max(axis=0, initial=-np.inf)]
    low, high = np.min(comm.allgather(ends), axis=0) * [[1.0], [-1.0]]
    common = {f"common/{name}": values for name, values in kept.common.items()}
    common |= {f"strategy/{name}": values for name, values in kept.strategy.items()}
    counts = np.array([model.space.dofmap.index_map.size_global, len(kept.points)])
    common |= {"mesh/counts": counts, "mesh/extent": high - low}
    return _named(kept, body), common


def keep_checkpoint(
    folder: Path, disk: Disk, number: int, model: Model, kept: Persistent, facts: dict[str, Any]
) -> None:
    """Write a checkpoint, whenever the run is killed there is the one before or this one.

    The pieces have names of their own; they count from when `checkpoint.npz` names them.

    Args:
        folder: Results folder.
        disk: Where failures go.
        number: A number that the checkpoint before does not have.
        model: The mesh.
        kept: State of this process; the call is collective.
        facts: What else is to be kept, as JSON can have it.

    Raises:
        WriteError: It cannot be written; the one before is still there.
    """
    comm = model.mesh.comm
    own, common = own_arrays(model, kept)
    pieces: list[str] = []
    if comm.size > 1:
        pieces = [f"{number:06d}.{rank}.npz" for rank in range(comm.size)]
        disk.write(lambda: (folder / PIECES).mkdir(exist_ok=True))
        disk.check()
        disk.write_each(lambda: _save(folder / PIECES / pieces[comm.rank], own))
        disk.check()
    arrays = common if pieces else own | common
    disk.write(lambda: save_checkpoint(folder, arrays, facts | {"pieces": pieces}))
    disk.write(lambda: _tidy(folder / PIECES, pieces))
    disk.check()


def save_checkpoint(folder: Path, arrays: Arrays, facts: dict[str, Any]) -> None:
    """Write the file of a checkpoint at once: a reader finds the old one or this one.

    Args:
        folder: Results folder.
        arrays: As of `own_arrays`.
        facts: What else is to be kept, as JSON can have it.

    Raises:
        OSError: It cannot be written; the old one is still there.
    """
    text = json.dumps(facts | {"format": FORMAT})
    _save(folder / NAME, arrays | {"facts": np.frombuffer(text.encode(), dtype=np.uint8)})


def _save(path: Path, arrays: Arrays) -> None:
    with replacing(path) as draft, draft.open("wb") as file:
        np.savez(file, **arrays)  # type: ignore[arg-type]
        file.flush()
        os.fsync(file.fileno())


def _tidy(folder: Path, pieces: Sequence[str]) -> None:
    """Remove pieces that no checkpoint names."""
    for path in folder.glob("*.npz"):
        if path.name not in pieces:
            path.unlink()


@contextmanager
def _readable(path: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"'{path}' cannot be read: {error}") from None


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
    with _readable(path):
        if not zipfile.is_zipfile(path):
            raise ValueError("it is no archive of arrays")
        with path.open("rb") as opened, np.load(opened) as file:
            arrays = dict(file)
        if "facts" not in arrays:
            raise ValueError("it is no checkpoint of a run, but other arrays")
        facts = json.loads(arrays.pop("facts").tobytes())
    if facts.get("format") != FORMAT:
        raise InputError(
            f"'{path}' has format {facts.get('format')!r}, this version reads {FORMAT}"
        )
    pieces = tuple(folder / PIECES / name for name in facts.get("pieces", ()))
    return Stored(arrays, facts, pieces)


def distribute(stored: Stored, model: Model, like: Persistent) -> Persistent:
    """The part of a checkpoint that belongs to this process.

    Args:
        stored: The checkpoint, the same on every process.
        model: The mesh.
        like: State of the problem as it was built.

    Returns:
        The state to go on from.

    Raises:
        InputError: The mesh or a contact is not that of the checkpoint, or a piece is damaged.
    """
    nodes = model.space.dofmap.index_map.size_global
    if stored.arrays["mesh/counts"].tolist() != [nodes, len(like.points)]:
        raise InputError("the mesh or the contacts are not those of the run that is to go on")
    near = SAME * float(stored.arrays["mesh/extent"].max())
    nodal = _MatchedRows("nodal/", *_where(model), near)
    points = [
        _MatchedRows(
            f"points/{i}/", part["reference"], np.zeros(len(part["reference"])), near, part
        )
        for i, part in enumerate(like.points)
    ]

    def look(part: Mapping[str, Any]) -> bool:
        nodal.look("nodal/position", part, part["node/body"])
        for rows in points:
            rows.look(f"{rows.prefix}reference", part)
        return not any(len(rows.missing) for rows in (nodal, *points))

    stored.search(model.mesh.comm.rank, look)
    nodal.check("the mesh is")
    before, now = len(stored.pieces) or 1, model.mesh.comm.size
    for rows in points:
        rows.check("points of a contact or a material are", _OF_PROCESSES if before != now else "")
    # numbers of unknowns mean something only where they are those of the run that wrote them
    same = model.mesh.comm.size == 1 and nodal.in_order
    return Persistent(
        nodal.values,
        [rows.values for rows in points],
        under("common/", stored.arrays),
        under("strategy/", stored.arrays) if same else {},
    )


class _MatchedRows:
    """Rows of nodes or points, found by their positions.

    Args:
        prefix: Of the names of the arrays.
        position: Where the rows are that are wanted, (n, 3), length.
        kind: Only rows of the same kind are the same, (n,).
        near: Distance within which two positions are the same, length.
        like: Arrays of the types that are wanted, where it matters.

    Attributes:
        prefix: As given.
        values: Arrays of the rows by name.
        missing: Rows that have not been found.
        in_order: Whether all were found at once, in the order in which they are wanted.
    """

    def __init__(
        self, prefix: str, position: Floats, kind: Any, near: float, like: Arrays | None = None
    ) -> None:
        self.prefix = prefix
        self.values: Arrays = {}
        self.missing = np.arange(len(position))
        self.in_order = False
        self._position, self._kind, self._near = position, kind, near
        self._like = like or {}

    def look(self, name: str, part: Mapping[str, Any], kind: Ints | None = None) -> None:
        """Take what is missing from a part of the checkpoint.

        Args:
            name: Its array of positions.
            part: Its arrays.
            kind: Kind of its rows; all of one kind if not given.

        Raises:
            InputError: Arrays have other fields than those of this version.
        """
        names = [n for n in part if n.startswith(self.prefix)]
        absent = {self.prefix + n for n in self._like}.difference(names)
        if absent:
            raise InputError("the states of points are not those of this version")
        there = part[name]
        kind = np.zeros(len(there), dtype=np.int64) if kind is None else kind
        wanted = self.missing
        rows = _matched(there, kind, self._position[wanted], self._kind[wanted], self._near)
        found = rows >= 0
        self.in_order = not self.values and np.array_equal(rows, np.arange(len(there)))
        if not self.values or found.any():
            for full in names:
                self._put(full.removeprefix(self.prefix), part[full], wanted[found], rows[found])
        self.missing = wanted[~found]

    def _put(self, name: str, values: npt.NDArray[Any], at: Ints, rows: Ints) -> None:
        # Records are packed in the file; the core wants its own layout.
        dtype = self._like[name].dtype if name in self._like else values.dtype
        if dtype.names != values.dtype.names:
            raise InputError("the states of points are not those of this version")
        if name not in self.values:
            self.values[name] = np.zeros((len(self._position), *values.shape[1:]), dtype)
        self.values[name][at] = values[rows].astype(dtype)

    def check(self, what: str, more: str = "") -> None:
        """Refuse to go on without some of the rows.

        Args:
            what: What they are of, with its verb.
            more: What may be the reason.

        Raises:
            InputError: Names one that was not found.
        """
        if len(self.missing):
            at = shown(self._position[self.missing[0]], 6)
            text = f"{what} not as in the run that is to go on: nothing was at {at}{more}"
            raise InputError(text)


def _named(kept: Persistent, body: Ints) -> Arrays:
    """Arrays of this rank under the names they have in the file."""
    named: Arrays = {"node/body": body}
    named |= {f"nodal/{name}": values for name, values in kept.nodal.items()}
    for i, part in enumerate(kept.points):
        # records have gaps in memory, which a file cannot have
        named |= {f"points/{i}/{name}": repack_fields(values) for name, values in part.items()}
    return named


def _where(model: Model) -> tuple[Floats, Ints]:
    """Position of each node this rank owns, and the first body it belongs to."""
    index_map = model.space.dofmap.index_map
    owned = index_map.size_local
    body = np.full(owned + index_map.num_ghosts, len(model.body_names()), dtype=np.int64)
    for number, name in reversed(list(enumerate(model.body_names()))):
        body[model.space.dofmap.list[model.cells(name)]] = number
    return model.positions[:owned].copy(), body[:owned]


def _matched(there: Floats, kind_there: Ints, here: Floats, kind_here: Ints, near: float) -> Ints:
    """Rows of `there` with the positions `here`, both of the same kind; -1 for none."""
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
    return rows
