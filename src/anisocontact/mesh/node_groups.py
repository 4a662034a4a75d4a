"""Groups of nodes that are no facets: points and edges of bodies, by where they are."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt
import scipy

from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.arrays import points
from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed

#: Distance from a line that is rounding of mesh files, over the size of the body.
ROUNDED = 1e-5
#: Difference of two distances over the size of the body below which both are the nearest.
SAME = 1e-9
#: Distance over the size of the body from which on a point is none of it: of other units, say.
FAR = 0.5


@typed
def node_near(model: Any, body: str, point: npt.ArrayLike, field: str = "") -> Locals:
    """The node of a body that is nearest to a point; collective.

    Args:
        model: The mesh, a `Model`.
        body: Name of the body.
        point: The point, (3,), length.
        field: Where it was written, for messages.

    Returns:
        Its local number on the rank that owns it, nothing on others.

    Raises:
        InputError: No mesh, no such body, a point far from it, or several nodes equally far.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> node = node_near(model, "block", (0.4, 0.0, 1.2))
        >>> (model.space.tabulate_dof_coordinates()[node] + 0.0).round(9).tolist()
        [[0.5, 0.0, 1.0]]
    """
    nodes, x, size = _nodes_of(model, body, field)
    away = np.linalg.norm(x - _place(point, field or "point"), axis=1)
    least = min(model.mesh.comm.allgather(float(away.min(initial=np.inf))))
    if least > FAR * size:
        text = f"the nearest node of {body!r} is {least:.4g} off, the body {size:.4g} large"
        raise InputError(f"{text}: a point at the body needed", field)
    found: Locals = nodes[away <= least + SAME * size]
    count = model.mesh.comm.allreduce(len(found))
    if count > 1:
        text = f"{count} nodes of {body!r} are {least:.4g} from it; give a point nearer to one"
        raise InputError(text, field)
    return found


@typed
def nodes_along(
    model: Any, body: str, start: npt.ArrayLike, end: npt.ArrayLike, field: str = ""
) -> Locals:
    """The nodes of a body on a straight line between two points; collective.

    Args:
        model: The mesh, a `Model`.
        body: Name of the body.
        start: Where the line begins, (3,), length.
        end: Where it ends, (3,), length.
        field: Where it was written, for messages.

    Returns:
        Their local numbers, those this rank owns.

    Raises:
        InputError: No mesh, no such body, no node on the line, or a line without length.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> len(nodes_along(model, "block", (0, 0, 1), (1, 0, 1)))
        3
    """
    nodes, x, size = _nodes_of(model, body, field)
    place = f"{field}." if field else ""
    first, last = (
        _place(given, f"{place}{name}") for name, given in (("start", start), ("end", end))
    )
    way = last - first
    length = float(np.linalg.norm(way))
    if not length > ROUNDED * size:
        raise InputError("start and end are one point", field)
    share = np.clip((x - first) @ way / length**2, 0.0, 1.0)
    off = np.linalg.norm(x - first - share[:, None] * way, axis=1)
    found: Locals = nodes[off <= ROUNDED * size]
    if not model.mesh.comm.allreduce(len(found)):
        least = min(model.mesh.comm.allgather(float(off.min(initial=np.inf))))
        raise InputError(
            f"no node of {body!r} is on the line, the nearest is {least:.4g} off", field
        )
    return found


def nodes_at(model: Any, body: str, places: Floats) -> Locals:
    """The nodes of a body at some places; collective.

    Args:
        model: The mesh, a `Model`.
        body: Name of the body.
        places: The places, (n, 3), length.

    Returns:
        Their local numbers, those this rank owns.
    """
    nodes, x, size = _nodes_of(model, body, "")
    distance, _ = scipy.spatial.KDTree(places).query(x)
    found: Locals = nodes[distance <= ROUNDED * size]
    return found


def _nodes_of(model: Any, body: str, field: str) -> tuple[Locals, Floats, float]:
    """Nodes of a body that this rank owns, where they are, and the size of the body."""
    if not hasattr(model, "space"):  # its type is made of this file
        raise InputError("no Model given", "model")
    space, comm = model.space, model.mesh.comm
    nodes = np.unique(space.dofmap.list[model.cells(body, field)])
    nodes = nodes[nodes < space.dofmap.index_map.size_local].astype(np.int32)
    x = np.asarray(space.tabulate_dof_coordinates())[nodes]
    low = np.min(comm.allgather(x.min(axis=0, initial=np.inf)), axis=0)
    high = np.max(comm.allgather(x.max(axis=0, initial=-np.inf)), axis=0)
    return nodes, x, float(np.max(high - low))


def _place(given: npt.ArrayLike, name: str) -> Floats:
    """A point, (3,).

    Raises:
        InputError: Another shape, or numbers that are not finite.
    """
    (point,) = points(given, 3, name, rows=1)
    if not np.isfinite(point).all():
        raise InputError(f"{point.tolist()} given, finite numbers needed", name)
    return np.asarray(point)
