"""Facet groups made of others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.base.words import hint
from anisocontact.mesh.arrays import MeshArrays


def with_joined(mesh: MeshArrays, joined: Mapping[str, Sequence[str]]) -> MeshArrays:
    """A mesh with facet groups that have the facets of several others; collective.

    Args:
        mesh: The mesh.
        joined: "body.group" -> groups of that body; a facet that is in several counts once.

    Raises:
        InputError: A group is there already, or there is none to be joined.

    Example:
        >>> from anisocontact.mesh import Body, build_mesh, make_shape
        >>> box = make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(2, 2, 2))
        >>> ends = {"block.ends": ["block.left", "block.right"]}
        >>> build_mesh([Body("block", box)], joined=ends).count_facets("block.ends")
        8
    """
    facets = dict(mesh.facets)
    for name, parts in joined.items():
        if name in facets:
            raise InputError(f"{name!r} is a group already", name)
        if not parts:
            raise InputError("no group given, at least one needed", name)
        for part in parts:
            _check(part, name, [*facets])
        rows = np.concatenate(
            [np.concatenate(mesh.comm.allgather(facets[part])) for part in parts], dtype=np.int64
        )
        _, first = np.unique(np.sort(rows, axis=1), axis=0, return_index=True)
        facets[name] = np.array_split(rows[np.sort(first)], mesh.comm.size)[mesh.comm.rank]
    return replace(mesh, facets=facets)


def _check(part: str, name: str, known: Sequence[str]) -> None:
    """Refuse a group that is not there, or is one of another body."""
    if part not in known:
        there = hint(part, known, "the mesh has")
        raise InputError(f"no facet group {part!r} in the mesh; {there}", name)
    if part.rpartition(".")[0] != name.rpartition(".")[0]:
        raise InputError(f"{part!r} given, groups of the body of {name!r} needed", name)
