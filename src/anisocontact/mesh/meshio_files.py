"""Files of other codes by meshio: Nastran, Exodus, MED, VTK, XDMF, Medit and what it reads."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.mesh import exodus
from anisocontact.mesh.exodus import read_exodus
from anisocontact.mesh.meshio_patches import names_of_med, nastran
from anisocontact.mesh.torn import without_body
from anisocontact.mesh.whole import WholeMesh

#: Endings of names; gmsh's and Abaqus's have readers of their own.
SUFFIXES: tuple[str, ...] = (
    *(".bdf", ".nas", ".fem", *exodus.SUFFIXES, ".med", ".vtk", ".vtu", ".xdmf", ".xmf"),
    *(".mesh", ".meshb", ".cgns", ".h5m", ".hmf", ".avs", ".su2", ".ugrid", ".f3grid"),
    *(".vol", ".mdpa"),
)
#: Those of Nastran.
NASTRAN = (".bdf", ".nas", ".fem")
#: Beginning of the names of arrays that say which cells are in a group: 1 there, else 0.
GROUP = "group:"
#: Cells of meshio -> cell here; nodes are in the order of VTK.
SOLIDS = {
    "tetra": "tetrahedron",
    "tetra10": "tetrahedron",
    "hexahedron": "hexahedron",
    "hexahedron20": "hexahedron",
    "hexahedron27": "hexahedron",
    "wedge": "prism",
    "wedge15": "prism",
    "pyramid": "pyramid",
    "pyramid13": "pyramid",
}
#: Facets of meshio -> corners.
FACETS = {"triangle": 3, "triangle6": 3, "quad": 4, "quad8": 4, "quad9": 4}
#: The same of a mesh in the plane z = 0, whose facets are edges.
PLANE = {
    **dict.fromkeys(("triangle", "triangle6"), "triangle"),
    **dict.fromkeys(("quad", "quad8", "quad9"), "quadrilateral"),
}
EDGES = {"line": 2, "line3": 2}
#: Points and edges of meshio -> dimension.
LOWER = {"vertex": 0, "line": 1, "line3": 1}
#: Names under which formats keep the group of each cell as a number.
TAGS: tuple[str, ...] = (
    *("gmsh:physical", "medit:ref", "nastran:ref", "cell_tags", "ugrid:ref", "su2:tag"),
    *("avsucd:material", "flac3d:group", "netgen:index", "MaterialIds", "tags"),
    *("CellEntityIds", "PartId", "body"),
)


def read_by_meshio(path: Path) -> WholeMesh:
    """Solid cells and groups of a file that meshio reads.

    Returns:
        The mesh. Bodies are the sets of volume cells, or the numbers that the format gives them as
        `body1`, `body2` and so on, or all of them as `body`; facet groups are the sets or numbers
        (`surface1` ...) of surface cells, and sets of nodes that hold all corners of facets; other
        sets of nodes, and those of points and edges, are nodes with a name.

    Raises:
        InputError: meshio is not installed or cannot read the file, or no solid cell is in it.
    """
    given = _read(path)
    points = np.zeros((len(given.points), 3))
    if len(given.points):  # without nodes some readers of meshio give one axis
        points[:, : given.points.shape[1]] = given.points
    mesh = WholeMesh(points)
    dim = _dimension(given, points)
    solids, facets = (SOLIDS, FACETS) if dim == 3 else (PLANE, EDGES)
    names = _names(given, dim)
    for block, labels in zip(given.cells, names, strict=True):
        nodes = np.asarray(block.data, dtype=np.int64)
        if block.type in solids:
            bodies = [label[-1] if label else "" for label in labels]
            mesh.add_cells(
                solids[block.type], nodes, bodies if any(bodies) else ["body"] * len(nodes)
            )
            mesh.notes = (*mesh.notes, *_of_several(labels))
        elif block.type in LOWER and block.type not in facets:
            for name, own in _members(labels).items():
                before = mesh.node_sets.get(name, np.zeros(0, dtype=np.int64))
                mesh.node_sets[name] = np.union1d(before, nodes[own])
        elif block.type in facets:
            corners = nodes[:, : facets[block.type]]
            for name, own in _members(labels).items():
                mesh.surfaces.setdefault(name, []).append(corners[own])
    for name, parts in getattr(given, "sides", {}).items():
        mesh.surfaces.setdefault(_plain(name), []).extend(parts)
    if not mesh.cells:
        found = ", ".join(f"{len(b.data)} {b.type}" for b in given.cells) or "none at all"
        kinds = {block.type for block in given.cells}
        flat = "surfaces are bodies in the plane z = 0 alone; " if kinds & set(PLANE) else ""
        text = f"no solid cell ({', '.join(SOLIDS)}); {flat}there are: {found}"
        raise InputError(text)
    if all(set(labels) == {"body"} for labels in mesh.bodies):
        mesh.notes = (*mesh.notes, *_unread(given, solids))
    mesh.notes = (*mesh.notes, *without_body(mesh.bodies))
    for name, held in (*given.point_sets.items(), *_of_families(given)):
        before = mesh.node_sets.get(_plain(name), np.zeros(0, dtype=np.int64))
        nodes = np.asarray(held, dtype=np.int64).ravel()
        mesh.node_sets[_plain(name)] = np.union1d(before, nodes)
    return mesh


def _of_families(given: Any) -> Iterator[tuple[str, Ints]]:
    """Groups of nodes of MED, which keeps for each node the number of a family of them."""
    for number, names in getattr(given, "point_tags", {}).items():
        held = np.flatnonzero(np.asarray(given.point_data["point_tags"]) == number)
        yield from ((name, held) for name in names)


def _dimension(given: Any, points: Floats) -> int:
    """3, or 2 for a mesh in the plane z = 0."""
    kinds = {block.type for block in given.cells}
    return 2 if not kinds & set(SOLIDS) and kinds & set(PLANE) and not points[:, 2].any() else 3


def needed(path: Path) -> Any:
    """The package meshio, for a file.

    Raises:
        InputError: It is not installed.
    """
    try:
        import meshio
    except ImportError:
        raise InputError(
            f"files that end with {path.suffix} need meshio: pip install 'anisocontact[meshes]'"
        ) from None
    return meshio


def _read(path: Path) -> Any:
    """The mesh of meshio; what it prints and where it exits becomes one line."""
    if path.suffix.lower() in exodus.SUFFIXES:
        try:
            return read_exodus(path)
        except (AttributeError, IndexError, KeyError, ValueError) as problem:
            raise InputError(f"it is no Exodus file that can be read: {problem}") from None
    meshio = needed(path)
    said = io.StringIO()
    try:
        with redirect_stdout(said), redirect_stderr(said), names_of_med():
            return nastran(path) if path.suffix.lower() in NASTRAN else meshio.read(path)
    except InputError:
        raise
    except (Exception, SystemExit) as problem:
        words = f"{said.getvalue()} {problem if isinstance(problem, Exception) else ''}"
        text = " ".join(words.split()) or type(problem).__name__
        raise InputError(f"meshio cannot read it: {text}") from None


def _names(mesh: Any, dim: int) -> list[list[tuple[str, ...]]]:
    """Groups of each cell by their names, block by block; of a body the last one counts.

    Sets take the place of numbers.
    """
    found: list[list[tuple[str, ...]]] = [[()] * len(block.data) for block in mesh.cells]
    for name, parts in mesh.cell_data.items():
        if name.startswith(GROUP):
            for labels, part in zip(found, parts, strict=True):
                for k in np.flatnonzero(np.asarray(part)):
                    labels[k] += (name.removeprefix(GROUP),)
    for name, parts in mesh.cell_sets.items():
        if name.startswith("gmsh:"):
            continue
        for labels, part in zip(found, parts, strict=True):
            for k in np.asarray(part if part is not None else [], dtype=np.int64):
                labels[k] += (_plain(name),)
    return [
        [label or number for label, number in zip(labels, numbers, strict=True)]
        for labels, numbers in zip(found, _tags(mesh, dim), strict=True)
    ]


def _members(labels: Sequence[tuple[str, ...]]) -> dict[str, list[int]]:
    """Cells of each group."""
    found: dict[str, list[int]] = {}
    for k, names in enumerate(labels):
        for name in dict.fromkeys(names):
            found.setdefault(name, []).append(k)
    return found


def _of_several(labels: Sequence[tuple[str, ...]]) -> Iterator[str]:
    """Lines on cells of bodies that are in several groups."""
    for names in dict.fromkeys(label for label in labels if len(label) > 1):
        count, (*others, own) = labels.count(names), names
        yield f"{count} cells in {', '.join(others)} and {own}: they are of the body {own!r}"


def _tags(mesh: Any, of_bodies: int) -> Iterator[list[tuple[str, ...]]]:
    """Names of the numbers that a format gives its cells, block by block; empty without numbers."""
    key = next((key for key in TAGS if key in mesh.cell_data), None)
    known = {
        (int(value[1]), int(value[0])): _plain(name)
        for name, value in mesh.field_data.items()
        if np.size(value) == 2
    }
    of_med = {  # the first name of cells is that of their body
        number: tuple(map(_plain, reversed(names)))
        for number, names in getattr(mesh, "cell_tags", {}).items()
        if names
    }
    for k, block in enumerate(mesh.cells):
        if key is None:
            yield [()] * len(block.data)
            continue
        dim = 3 if block.type in SOLIDS else LOWER.get(block.type, 2)
        word = ("edge", "surface", "body")[max(dim - of_bodies, -2) + 2]
        numbers = _whole(mesh.cell_data[key][k], key)
        names = {
            n: of_med.get(n)
            or tuple(one for one in [known.get((dim, n))] if one)
            or ((f"{word}{n}",) if n or dim == of_bodies else ())
            for n in set(numbers)
        }
        yield [names[n] for n in numbers]


def _whole(given: Any, name: str) -> list[int]:
    """Numbers of bodies or surfaces, which some formats keep as floats.

    Raises:
        InputError: One of them is not whole: the array is another quantity, or damaged.
    """
    values = np.asarray(given).ravel()
    with np.errstate(invalid="ignore"):
        numbers = values.astype(np.int64)
    wrong = np.flatnonzero(numbers != values)
    if len(wrong):
        raise InputError(
            f"cells are numbered by {name!r}, of which {len(wrong)} of {len(values)} values are no "
            f"whole numbers, the first {values[wrong[0]]:g}; give whole ones, or rename the array"
        )
    return numbers.tolist()


def _unread(mesh: Any, solids: Mapping[str, str]) -> Iterator[str]:
    """Lines on arrays of numbers that look as if they were bodies, and are not read as such."""
    kept = [k for k, block in enumerate(mesh.cells) if block.type in solids]
    for name, parts in mesh.cell_data.items():
        values = [np.asarray(parts[k]) for k in kept]
        if name in TAGS or any(value.ndim != 1 for value in values):
            continue
        given = np.concatenate(values)
        count = len(np.unique(given))
        if 1 < count < len(given) and np.all(given == np.round(given)):
            text = f"are numbered from {given.min():g} to {given.max():g} by {name!r}"
            yield f"{text}, which is not read; bodies are numbered by {', '.join(TAGS)}"


def _plain(name: str) -> str:
    """A name without the dot, which parts a body from its group, and without blanks around it."""
    return str(name).strip().replace(".", "_")
