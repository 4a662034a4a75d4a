"""A user's own space and facets: what fits, and one line where it does not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from anisocontact.base.array_types import Locals
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import tags_of_mesh, vector_space
from anisocontact.mesh.node_unknowns import NodeUnknowns, PlacedUnknowns

_CELLS = ("tetrahedron", "hexahedron", "triangle", "quadrilateral")
_NEEDED = '("Lagrange", 1 or 2, (3,)) needed'
_IN_THE_PLANE = '("Lagrange", 1 or 2, (2,)) or (3,) needed'


def own_unknowns(space: Any) -> NodeUnknowns:
    """Where the displacement of nodes is among the unknowns of a space of the user's.

    Args:
        space: A DOLFINx function space, or a sub-space.

    Returns:
        The places; every node has three components, whatever the space has.

    Raises:
        InputError: No function space, cells other than tetrahedra, hexahedra, triangles and
            quadrilaterals, or no vector Lagrange space of order 1 or 2 with three components, in
            the plane two.
    """
    if not (hasattr(space, "element") and hasattr(space, "dofmap")):
        raise InputError(f"{type(space).__name__} given, a function space, {_NEEDED}", "space")
    if space.mesh.geometry.x.dtype != np.float64:
        text = f"a mesh of {space.mesh.geometry.x.dtype} given, float64 needed"
        raise InputError(text, "space")
    types = [cell.name for cell in space.mesh.topology.entity_types[-1]]
    if len(types) != 1 or types[0] not in _CELLS:
        text = f"a mesh of {' and '.join(types)} cells given, {' or '.join(_CELLS)} needed"
        raise InputError(text, "space")
    needed = _NEEDED if space.mesh.topology.dim == 3 else _IN_THE_PLANE
    try:
        element = space.element.basix_element
    except RuntimeError:  # DOLFINx: a mixed element has none
        text = f"a mixed element given, {needed}: name its displacement, as W.sub(0)"
        raise InputError(text, "space") from None
    components = space.num_sub_spaces if len(space.value_shape) == 1 else 1
    if components not in {3, space.mesh.topology.dim} or element.degree not in (1, 2):
        text = f"a space of degree {element.degree} with {components} components given, {needed}"
        raise InputError(text, "space")
    if element.family.name != "P" or element.discontinuous:
        kind = "discontinuous" if element.discontinuous else f"family {element.family.name}"
        raise InputError(f"an element that is {kind} given, continuous {needed}", "space")
    if not space.component() and components == 3:
        return NodeUnknowns(space)
    return PlacedUnknowns(vector_space(space.mesh, element.degree), space)


def named_facets(facets: Any, mesh: Any, tags: Any = None) -> dict[str, Locals]:
    """Facet groups by name, each facet once.

    Args:
        facets: "body.group" -> local facets, or their value in `tags`; MeshTags alone make a group
            "body.<value>" of each value.
        mesh: Mesh of the facets.
        tags: MeshTags of facets.

    Returns:
        The same as sorted arrays.

    Raises:
        InputError: No groups by name, a name without a body, or what is no list of facets.
    """
    if tags is None and _are_tags(facets):
        everywhere = set().union(*facets.topology.comm.allgather(set(facets.values.tolist())))
        facets, tags = {f"body.{value}": value for value in sorted(everywhere)}, facets
    if not isinstance(facets, Mapping):
        raise InputError(
            f'{type(facets).__name__} given, {{"body.group": facets}} needed, with facets as of '
            "MeshTags.find",
            "facets",
        )
    dim = mesh.topology.dim - 1
    if tags is not None and not (_are_tags(tags) and tags.dim == dim):
        text = f"{type(tags).__name__} given, MeshTags of facets (dimension {dim}) needed"
        raise InputError(text, "tags")
    if tags is not None and not tags_of_mesh(tags, mesh):
        raise InputError("MeshTags of another mesh than that of the space given", "tags")
    return {_name(name): _numbers(name, _found(name, g, tags)) for name, g in facets.items()}


def _are_tags(given: Any) -> bool:
    return hasattr(given, "find") and hasattr(given, "dim")


def _found(name: str, given: Any, tags: Any) -> Any:
    """Facets with a value in MeshTags, or what else was given."""
    if tags is None or not isinstance(given, int | np.integer):
        return given
    return tags.find(int(given))


def _name(name: object) -> str:
    body, dot, group = str(name).partition(".")
    if not (isinstance(name, str) and body and dot and group):
        raise InputError(f'{name!r} given, "body.group" needed', "facets")
    return name


def _numbers(name: str, given: Any) -> Locals:
    if _are_tags(given):
        what = "facets" if given.dim == 2 else f"entities of dimension {given.dim}"
        text = f"MeshTags of {what} given, an array of facets needed: facet_tags.find(value)"
        raise InputError(text, name)
    found = np.asarray(given)
    if found.size == 0:
        return np.zeros(0, dtype=np.int32)
    if isinstance(given, int | np.integer):
        text = f"{given} given without `tags`, MeshTags of facets that have this value"
        raise InputError(text, name)
    if found.ndim != 1 or found.dtype.kind not in "iu":
        shape = f"{found.ndim} axes of {found.dtype}"
        raise InputError(f"{shape} given, a list of facet numbers needed", name)
    return np.unique(found).astype(np.int32)
