"""A gmsh file as a model: volume groups are bodies, surface groups are facet groups.

Where a file has no volumes, surface groups are bodies in the plane and curve groups their facets.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI, cell_permutation
from anisocontact.base.given_file import why_no_file
from anisocontact.base.typed import typed
from anisocontact.base.words import hint
from anisocontact.mesh.arrays import MeshArrays, check_boundary, check_has_cells, facet_owners
from anisocontact.mesh.idealisation import SOLID, Idealisation
from anisocontact.mesh.model import Model
from anisocontact.mesh.msh import ElementBlock, MshFile, read_msh
from anisocontact.mesh.quality import check_cells
from anisocontact.mesh.split import Route, Split, arranged
from anisocontact.mesh.stream import MshError
from anisocontact.mesh.torn import tell_torn, torn
from anisocontact.mesh.whole import WholeMesh

# gmsh element type -> cell, degree
CELLS = {
    4: ("tetrahedron", 1),
    11: ("tetrahedron", 2),
    5: ("hexahedron", 1),
    12: ("hexahedron", 2),
    2: ("triangle", 1),
    9: ("triangle", 2),
    3: ("quadrilateral", 1),
    10: ("quadrilateral", 2),
}
#: gmsh element type -> cell and the order in which VTK has its nodes, of those that a mesh has only
#: after nodes are put in, or cells cut, and of what may stand beside them. Nodes inside are left.
_IN_VTK = {
    4: ("tetrahedron", [0, 1, 2, 3]),
    11: ("tetrahedron", [*range(8), 9, 8]),
    5: ("hexahedron", [*range(8)]),
    17: ("hexahedron", [*range(8), *(8, 11, 13, 9), *(16, 18, 19, 17), *(10, 12, 14, 15)]),
    6: ("prism", [*range(6)]),
    18: ("prism", [*range(6), 6, 9, 7, 12, 14, 13, 8, 10, 11]),
    7: ("pyramid", [*range(5)]),
    19: ("pyramid", [*range(5), 5, 8, 10, 6, 7, 9, 11, 12]),
    2: ("triangle", [*range(3)]),
    9: ("triangle", [*range(6)]),
    3: ("quadrilateral", [*range(4)]),
    10: ("quadrilateral", [*range(9)]),
    16: ("quadrilateral", [*range(8)]),
}
_IN_VTK |= {full: _IN_VTK[edges] for full, edges in ((12, 17), (13, 18), (14, 19))}
#: Those of them that are kept as they are where they are alone.
_AS_THEY_ARE = set(CELLS)
#: What groups of cells are of; without volumes surfaces are bodies in the plane.
_GROUPS = {3: "volume", 2: "the file has no volumes, and surface"}
#: What groups are of, by their dimension.
_OF = ("point", "curve", "surface", "volume")
#: Corners of facets by the gmsh element type of these.
_CORNERS = {1: 2, 8: 2, 2: 3, 9: 3}
#: Most groups that a line lists.
MOST = 5


@typed
def read_gmsh(
    path: str | Path,
    bodies: Sequence[str] | None = None,
    idealisation: Idealisation = SOLID,
) -> Model:
    """Model of a gmsh file.

    A surface group "block.bottom" belongs to body "block"; a group "bottom" gets the name of the
    body its facets bound (one group for each body where it bounds several). In a file without
    volumes the same holds of surface groups, which are bodies, and of curve groups. Groups of
    points and of curves in space are nodes with a name.

    Args:
        path: File in format 4.1 or 2.2, text or binary, coordinates in length.
        bodies: Volume groups to take; all of them if not given.
        idealisation: What a mesh of two dimensions is taken for.

    Returns:
        The model; the displacement has the order of the cells.

    Raises:
        InputError: The file is missing or damaged, names no volume, holds cells of several orders,
            or a group does not lie on the boundary of its body.

    Example:
        >>> read_gmsh("no-such-file.msh")
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: mesh.file: mesh file 'no-such-file.msh' does not exist
    """
    arrays = gmsh_arrays(Path(path), bodies, comm=MPI.COMM_WORLD)
    tell_torn(arrays.torn)
    return Model.from_arrays(arrays, idealisation=idealisation)


def check_file(path: Path, field: str) -> None:
    """Refuse what is no file.

    Args:
        path: Where a mesh file should be.
        field: Where the path was written, for messages.

    Raises:
        InputError: Nothing is there, a folder, or something that cannot be looked at.
    """
    if what := why_no_file(path):
        raise InputError(f"mesh file {str(path)!r} {what}", field)


def gmsh_arrays(
    path: Path,
    bodies: Sequence[str] | None = None,
    field: str = "mesh.file",
    comm: Any = MPI.COMM_SELF,
) -> MeshArrays:
    """Plain arrays of a gmsh file, see `read_gmsh`; `field` is where the path was written.

    Each process of `comm` gets its share of them.
    """
    check_file(path, field)
    try:
        msh = read_msh(path, comm)
        dim = 3 if any(block.dim == 3 for block in msh.blocks) else 2
        kinds = set().union(*comm.allgather({b.kind for b in msh.blocks if b.dim == dim}))
        if kinds <= set(_IN_VTK) and (len(kinds) > 1 or not kinds <= _AS_THEY_ARE):
            return _made_over(read_msh(path, MPI.COMM_SELF), dim, bodies).shared(comm)
        return _arrays(msh, dim, bodies, comm)
    except (MshError, OSError) as problem:
        raise InputError(
            f"mesh file {str(path)!r} is not a readable gmsh file: {problem}", field
        ) from None
    except InputError as problem:
        raise InputError(f"mesh file {str(path)!r}: {problem}", field) from None


def _arrays(msh: MshFile, dim: int, bodies: Sequence[str] | None, comm: Any) -> MeshArrays:
    volumes = _volumes(msh, dim, bodies)
    cell, degree = _kind([block for _, block in volumes])
    names = list(dict.fromkeys(name for name, _ in volumes))
    firsts = np.cumsum([0] + [block.count for _, block in volumes])
    numbers = np.concatenate([n + b.places for n, (_, b) in zip(firsts, volumes, strict=False)])
    labels = np.concatenate([np.full(len(b.nodes), names.index(name)) for name, b in volumes])
    cells = np.concatenate([block.nodes for _, block in volumes])
    cells, labels = arranged(comm, int(firsts[-1]), numbers, cells, labels)
    known = Split(comm, len(msh.points))
    _check_single(cells, known, comm)
    cells = cells[:, cell_permutation(cell, cells.shape[1])]
    used = known.marked(cells)
    kept = Split(comm, int(used.sum()))
    # Numbers of the nodes that are used; -1 for the others.
    compact = np.where(used, kept.first + np.cumsum(used) - 1, -1)
    cells = known.fetch(compact, cells)
    places = {name: np.flatnonzero(labels == i) for i, name in enumerate(names)}
    mesh = MeshArrays(
        *(cell, degree, msh.points[used], cells, places, {}, degree),
        notes=_without_name(msh, comm),
        torn=_torn(msh, dim, volumes, used, known, comm),
        comm=comm,
    )
    check_cells(mesh)
    surfaces: dict[str, list[Ints]] = {}
    for name, block in _named(msh, dim - 1):
        surfaces.setdefault(name, []).append(block.nodes)
    of_facets = {name: np.concatenate(parts) for name, parts in surfaces.items()}
    everywhere = known.marked(np.concatenate([b.nodes.ravel() for b in msh.blocks if b.dim == dim]))
    for name, nodes in of_facets.items():
        lost = int((~known.fetch(everywhere, nodes).all(axis=1)).sum())
        check_has_cells(name, mesh.sum(lost), mesh.sum(len(nodes)), mesh.bodies)
    groups = {name: known.fetch(compact, nodes) for name, nodes in of_facets.items()}
    mesh = replace(mesh, facets=_facet_groups(mesh, groups))
    lower: dict[str, list[Ints]] = {}
    for name, block in (one for below in range(dim - 1) for one in _named(msh, below)):
        lower.setdefault(name, []).append(known.fetch(compact, block.nodes).reshape(-1))
    return replace(mesh, nodes=_points_and_edges(mesh, lower))


def _made_over(msh: MshFile, dim: int, bodies: Sequence[str] | None) -> MeshArrays:
    """Cells of which nodes are put in, or which are cut, so that a mesh can have them."""
    mesh = WholeMesh(msh.points)
    mesh.notes = _without_name(msh, MPI.COMM_SELF)
    taken = _volumes(msh, dim, bodies)
    others = [("", b) for b in msh.blocks if b.dim == dim and all(b is not one for _, one in taken)]
    for name, block in taken + others:
        cell, order = _IN_VTK[block.kind]
        mesh.add_cells(cell, block.nodes[:, order], [name] * len(block.nodes))
    for name, block in _named(msh, dim - 1):
        corners = block.nodes[:, : _CORNERS.get(block.kind, 4)]
        mesh.surfaces.setdefault(name, []).append(corners)
    for name, block in (one for below in range(dim - 1) for one in _named(msh, below)):
        before = mesh.node_sets.get(name, np.zeros(0, dtype=np.int64))
        mesh.node_sets[name] = np.union1d(before, block.nodes)
    return mesh.arrays(bodies)


def _without_name(msh: MshFile, comm: Any) -> tuple[str, ...]:
    """A line on groups that have no name, of which nothing is made; collective."""
    own = {(b.dim, g) for b in msh.blocks if b.count for g in b.groups if g} - msh.names.keys()
    found = sorted(set().union(*comm.allgather(own)))
    if not found:
        return ()
    listed = ", ".join(f"{_OF[dim]} {group}" for dim, group in found[:MOST])
    more = f" and {len(found) - MOST} more" if len(found) > MOST else ""
    return (f"physical groups without a name are left out: {listed}{more}",)


def _torn(
    msh: MshFile,
    dim: int,
    taken: Sequence[tuple[str, ElementBlock]],
    used: Flags,
    nodes: Split,
    comm: Any,
) -> tuple[str, ...]:
    """Lines on bodies that share nodes with cells that are left out; collective."""
    others = [b for b in msh.blocks if b.dim == dim and all(b is not one for _, one in taken)]
    none = np.zeros(0, dtype=np.int64)
    left = nodes.marked(np.concatenate([none, *(block.nodes.ravel() for block in others)]))
    common = comm.allreduce(int((used & left).sum()))
    names = {name for name, block in _named(msh, dim) if any(block is one for one in others)}
    bodies = list(dict.fromkeys(name for name, _ in taken))
    return torn(bodies, common, sorted(set().union(*comm.allgather(names))))


def _points_and_edges(mesh: MeshArrays, groups: dict[str, list[Ints]]) -> dict[str, Floats]:
    """Places of the nodes of groups of points and curves by full name; -1 for no node of a body."""
    found = {}
    for body, cells in mesh.bodies.items():
        own = mesh.node_split.marked(mesh.cells[cells])
        for name, parts in groups.items():
            prefix, dot, _ = name.partition(".")
            if dot and prefix in mesh.bodies and prefix != body:
                continue
            nodes = np.unique(np.concatenate(parts))
            nodes = nodes[nodes >= 0]
            nodes = nodes[mesh.node_split.fetch(own, nodes)]
            places = mesh.node_split.fetch(mesh.points, nodes)
            places = np.unique(np.concatenate(mesh.comm.allgather(places)), axis=0)
            key = f"{body}.{name.removeprefix(f'{body}.')}"
            if len(places) and key not in mesh.facets:
                found[key] = places
    return found


def _volumes(
    msh: MshFile, dim: int, bodies: Sequence[str] | None
) -> list[tuple[str, ElementBlock]]:
    named = [(name, block) for name, block in _named(msh, dim) if block.count]
    if not named:
        empty = sorted(name for (of, _), name in msh.names.items() if of == dim and name)
        if empty:
            raise InputError(
                f"{_GROUPS[dim]} group {empty[0]!r} has no cells; in format 2.2 gmsh writes none "
                "into groups with Mesh.SaveAll"
            )
        raise InputError("no named volume group; give each body a physical volume with a name")
    if bodies is not None and not len(bodies):
        raise InputError("no volume group is taken: the list of bodies is empty")
    known = list(dict.fromkeys(name for name, _ in named))
    for name in known:
        if "." in name:
            text = "the name of a body has no dot; give it another name in the file"
            raise InputError(f"{_GROUPS[dim]} group {name!r}: {text}")
    for name in bodies or ():
        if name not in known:
            raise InputError(f"no volume group {name!r}; {hint(name, known)}")
    of_bodies = (b for b in msh.blocks if b.dim == dim)
    loose = [b for b in of_bodies if not any((dim, g) in msh.names for g in b.groups)]
    if loose and bodies is None:
        count = sum(b.count for b in loose)
        raise InputError(f"{count} cells are in no named volume group")
    return [(name, block) for name, block in named if bodies is None or name in bodies]


def _named(msh: MshFile, dim: int) -> Iterator[tuple[str, ElementBlock]]:
    for block in msh.blocks:
        if block.dim == dim:
            for group in block.groups:
                if (dim, group) in msh.names:
                    yield msh.names[dim, group], block


def _kind(blocks: list[ElementBlock]) -> tuple[str, int]:
    kinds = {block.kind for block in blocks}
    if not kinds <= set(CELLS):
        raise InputError(
            "a cell is neither a tetrahedron of 4 or 10 nodes nor a hexahedron of 8, 20 or 27 "
            "nodes, nor in the plane a triangle of 3 or 6 or a quadrilateral of 4, 8 or 9"
        )
    if len(kinds) > 1:
        found = ", ".join(f"{cell} of order {n}" for cell, n in (CELLS[k] for k in sorted(kinds)))
        raise InputError(f"cells of one kind only, not {found}")
    return CELLS[kinds.pop()]


def _check_single(cells: Ints, nodes: Split, comm: Any) -> None:
    rows = np.sort(cells, axis=1)
    rows = Route(comm, nodes.owner(rows[:, 0])).there(rows)
    twice = comm.allreduce(len(rows) - len(np.unique(rows, axis=0)))
    if twice:
        raise InputError(f"{twice} cells are in two volume groups")


def _facet_groups(mesh: MeshArrays, groups: dict[str, Ints]) -> dict[str, Ints]:
    """Surface groups by full name, from their nodes, -1 for one that no cell has."""
    names, labels = list(mesh.bodies), mesh.labels
    facets: dict[str, Ints] = {}
    for name, found in groups.items():
        # A group of a body that is not taken has nodes that are not used.
        nodes = found[(found >= 0).all(axis=1)]
        if not mesh.sum(len(nodes)):
            continue
        corners = nodes[:, : mesh.vertices_per_facet]
        if corners.shape[1] < mesh.vertices_per_facet:  # triangles, and the cells are hexahedra
            check_boundary(mesh, name, np.zeros(len(nodes), dtype=np.int64))
        owner, count = facet_owners(mesh, corners)
        check_boundary(mesh, name, count)
        bounded = mesh.cell_split.fetch(labels, owner)
        for full_name, mask in _prefixed(mesh, name, bounded, names):
            if full_name in facets:
                raise InputError(f"facet group {full_name!r} is given twice")
            facets[full_name] = nodes[mask]
    return facets


def _prefixed(
    mesh: MeshArrays, name: str, owners: Ints, bodies: list[str]
) -> Iterator[tuple[str, Flags]]:
    """Full names of a group, and which of its facets have each; `owners` are bodies by number."""
    prefix, dot, _ = name.partition(".")
    counts = [mesh.sum(int((owners == body).sum())) for body in range(len(bodies))]
    if dot and prefix in bodies:
        own = bodies.index(prefix)
        wrong = [body for body, count in enumerate(counts) if count and body != own]
        if wrong:
            raise InputError(
                f"facet group {name!r}: {sum(counts) - counts[own]} of {sum(counts)} facets "
                f"bound {bodies[wrong[0]]!r}, not {prefix!r}"
            )
        yield name, owners == own
        return
    for body, count in enumerate(counts):
        if count:
            yield f"{bodies[body]}.{name}", owners == body
