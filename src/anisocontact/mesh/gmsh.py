"""A gmsh file as a model: volume groups are bodies, surface groups are facet groups."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

from anisocontact._fenicsx import cell_permutation
from anisocontact.errors import InputError
from anisocontact.mesh.arrays import MeshArrays, check_boundary, facet_owners
from anisocontact.mesh.model import Model
from anisocontact.mesh.msh import Block, MshError, MshFile, read_msh
from anisocontact.mesh.quality import check_cells

Nodes = npt.NDArray[np.int64]

# gmsh element type -> cell, degree
VOLUMES = {
    4: ("tetrahedron", 1),
    11: ("tetrahedron", 2),
    5: ("hexahedron", 1),
    12: ("hexahedron", 2),
}


def read_gmsh(path: str | Path, bodies: Sequence[str] | None = None) -> Model:
    """Model of a gmsh file.

    A surface group "block.bottom" belongs to body "block"; a group "bottom" gets the name of the
    body its facets bound (one group for each body where it bounds several).

    Args:
        path: File in format 4.1 or 2.2, text or binary, coordinates in length.
        bodies: Volume groups to take; all of them if not given.

    Returns:
        The model; the displacement has the order of the cells.

    Raises:
        InputError: The file is missing or damaged, names no volume, holds cells of several kinds,
            or a group does not lie on the boundary of its body.

    Example:
        >>> read_gmsh("no-such-file.msh")
        Traceback (most recent call last):
        anisocontact.errors.InputError: mesh.file: mesh file 'no-such-file.msh' does not exist
    """
    return Model.from_arrays(gmsh_arrays(Path(path), bodies))


def gmsh_arrays(
    path: Path, bodies: Sequence[str] | None = None, field: str = "mesh.file"
) -> MeshArrays:
    """Plain arrays of a gmsh file, see `read_gmsh`; `field` is where the path was written."""
    if not path.is_file():
        raise InputError(f"mesh file {str(path)!r} does not exist", field)
    try:
        return _arrays(read_msh(path), bodies)
    except (MshError, OSError) as problem:
        raise InputError(
            f"mesh file {str(path)!r} is not a readable gmsh file: {problem}", field
        ) from None
    except InputError as problem:
        raise InputError(f"mesh file {str(path)!r}: {problem}", field) from None


def _arrays(msh: MshFile, bodies: Sequence[str] | None) -> MeshArrays:
    volumes = _volumes(msh, bodies)
    cell, degree = _kind([block for _, block in volumes])
    nodes: list[Nodes] = []
    ranges: dict[str, Nodes] = {}
    start = 0
    for name, block in volumes:
        place = np.arange(start, start + len(block.nodes))
        ranges[name] = np.concatenate([ranges.get(name, place[:0]), place])
        nodes.append(block.nodes)
        start += len(place)
    cells = np.concatenate(nodes)
    _check_single(cells)
    cells = cells[:, cell_permutation(cell, cells.shape[1])]
    used, compact = np.unique(cells, return_inverse=True)
    cells = compact.reshape(cells.shape)
    volumes_only = MeshArrays(cell, degree, msh.points[used], cells, ranges, {}, order=degree)
    check_cells(volumes_only)
    return replace(volumes_only, facets=_facet_groups(msh, volumes_only, used))


def _volumes(msh: MshFile, bodies: Sequence[str] | None) -> list[tuple[str, Block]]:
    named = [(name, block) for name, block in _named(msh, 3) if len(block.nodes)]
    if not named:
        raise InputError("no named volume group; give each body a physical volume with a name")
    if bodies is not None and not len(bodies):
        raise InputError("no volume group is taken: the list of bodies is empty")
    known = list(dict.fromkeys(name for name, _ in named))
    for name in known:
        if "." in name:
            raise InputError(f"volume group {name!r}: the name of a body has no dot")
    for name in bodies or ():
        if name not in known:
            near = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
            hint = f"did you mean {near[0]!r}?" if near else f"there are: {', '.join(known)}"
            raise InputError(f"no volume group {name!r}; {hint}")
    loose = [b for b in msh.blocks if b.dim == 3 and not any((3, g) in msh.names for g in b.groups)]
    if loose and bodies is None:
        count = sum(len(b.nodes) for b in loose)
        raise InputError(f"{count} cells are in no named volume group")
    return [(name, block) for name, block in named if bodies is None or name in bodies]


def _named(msh: MshFile, dim: int) -> Iterator[tuple[str, Block]]:
    for block in msh.blocks:
        if block.dim == dim:
            for group in block.groups:
                if (dim, group) in msh.names:
                    yield msh.names[dim, group], block


def _kind(blocks: list[Block]) -> tuple[str, int]:
    kinds = {block.kind for block in blocks}
    if not kinds <= set(VOLUMES):
        raise InputError(
            "a cell is neither a tetrahedron of 4 or 10 nodes nor a hexahedron of 8 or 27 nodes"
        )
    if len(kinds) > 1:
        found = ", ".join(f"{cell} of order {n}" for cell, n in (VOLUMES[k] for k in sorted(kinds)))
        raise InputError(f"cells of one kind only, not {found}")
    return VOLUMES[kinds.pop()]


def _check_single(cells: Nodes) -> None:
    unique = np.unique(np.sort(cells, axis=1), axis=0)
    if len(unique) != len(cells):
        raise InputError(f"{len(cells) - len(unique)} cells are in two volume groups")


def _facet_groups(msh: MshFile, mesh: MeshArrays, used: Nodes) -> dict[str, Nodes]:
    """Surface groups by full name; `used` are the numbers that the nodes have in the file."""
    body_of_cell = np.empty(len(mesh.cells), dtype=object)
    for name, place in mesh.bodies.items():
        body_of_cell[place] = name
    groups: dict[str, list[Nodes]] = {}
    for name, block in _named(msh, 2):
        groups.setdefault(name, []).append(block.nodes)
    facets: dict[str, Nodes] = {}
    for name, parts in groups.items():
        nodes = np.concatenate(parts)
        # A group of a body that is not taken has nodes that are not used.
        kept = np.isin(nodes, used).all(axis=1)
        if not kept.any():
            continue
        nodes = np.searchsorted(used, nodes[kept])
        owner, count = facet_owners(mesh.cell, mesh.cells, nodes[:, : mesh.vertices_per_facet])
        check_boundary(name, count)
        for full_name, mask in _prefixed(name, body_of_cell[owner], list(mesh.bodies)):
            if full_name in facets:
                raise InputError(f"facet group {full_name!r} is given twice")
            facets[full_name] = nodes[mask]
    return facets


def _prefixed(
    name: str, owners: npt.NDArray[np.object_], bodies: list[str]
) -> Iterator[tuple[str, npt.NDArray[np.bool_]]]:
    prefix, dot, _ = name.partition(".")
    if dot and prefix in bodies:
        wrong = owners != prefix
        if wrong.any():
            raise InputError(
                f"facet group {name!r}: {int(wrong.sum())} of {len(owners)} facets "
                f"bound {owners[wrong][0]!r}, not {prefix!r}"
            )
        yield name, ~wrong
        return
    for body in bodies:
        mask = owners == body
        if mask.any():
            yield f"{body}.{name}", mask
