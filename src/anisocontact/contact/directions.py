"""Direction fields from functions on the facets of a body."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.anisotropy import DirectionField, make_directions
from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import facet_sides, fem
from anisocontact.base.processes import on_all
from anisocontact.base.sampled import sampled
from anisocontact.base.typed import typed
from anisocontact.contact.quadrature import facet_quadrature
from anisocontact.mesh import Model
from anisocontact.surfaces import PROJECTION_STATUS, Surface

#: Degree of the rule at whose points a function is sampled: nine on a quadrilateral.
SAMPLES = 4


@typed
def facet_directions(
    model: Model,
    group: str,
    f: Callable[[Floats], npt.ArrayLike] | fem.Function[Any] | DirectionField,
    *,
    surface: Surface | None = None,
    interpolation: str = "smooth",
) -> DirectionField:
    """A field sampled on a facet group in the reference configuration.

    Between the samples directions are interpolated as lines, v and -v being the same, so the group
    should be smooth: give each side of a sharp edge a group and a field of its own.

    Args:
        model: Mesh with the group.
        group: Facet group "body.group" that has the directions.
        f: Positions (n, 3) to directions (n, 3), or to two of them (n, 2, 3) for axes that are not
            orthogonal; or a DOLFINx function with three components on the same mesh; or a
            direction field that lies on `surface`. Directions are projected on the facets.
        surface: Analytic surface that the facets approximate: a field is taken at the points of it
            that are closest, so that fields in its coordinates ("coordinate-lines",
            "tabulated-grid") come to meshed bodies. Angles count about its normal.
        interpolation: "smooth" (second order in the size of the facets) or "nearest".

    Returns:
        A field of the kind "tabulated-points", the same on every rank.

    Raises:
        InputError: No such group or none of its facets, `f` gives anything but directions, or it
            is a field without a surface or has no direction at a sample.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((1, 1, 0), (1, 1, 1), (2, 2, 1))})
        >>> rings = facet_directions(model, "block.bottom", lambda x: np.cross((0, 0, 1), x))
        >>> rings.name
        'tabulated-points'
    """
    facets = np.sort(model.facets(group, "group"))
    if model.count_facets(group) == 0:
        raise InputError(f"facet group {group!r} has no facets", "group")
    quadrature = facet_quadrature(model.space, facets, SAMPLES, model.idealisation)
    x = quadrature.reference
    if isinstance(f, DirectionField):
        f = _on_surface(f, surface)
    ask = partial(_of_function, model, facets, f) if hasattr(f, "function_space") else f
    shapes = (len(x), 3), (len(x), 2, 3)
    values = on_all(model.mesh.comm, lambda: sampled(ask, x, *shapes, field="f"))
    comm = model.mesh.comm
    fields = np.moveaxis(values, 1, 0) if values.ndim == 3 else [values]
    points, first, *second = (
        np.concatenate(comm.allgather(part)).reshape(-1) for part in (x, *fields)
    )
    more = {"second_vectors": second[0]} if second else {}
    return make_directions(
        "tabulated-points", points=points, vectors=first, interpolation=interpolation, **more
    )


def _on_surface(field: DirectionField, surface: Surface | None) -> Callable[[Floats], Floats]:
    """Both axes of a field, (n, 2, 3), at the points of a surface that are closest."""
    if surface is None:
        raise InputError(f"missing; the field {field.name!r} lies on one", "surface")

    def axes(x: Floats) -> Floats:
        feet = surface.project(x, derivatives=False)
        found, valid = field.axes(surface, feet.xi)
        lost = feet.status >= PROJECTION_STATUS.index("ambiguous")
        wrong = np.flatnonzero(~valid | lost)
        if wrong.size:
            raise InputError(
                f"the field {field.name!r} has no direction at {x[wrong[0]].tolist()}", "f"
            )
        return found

    return axes


def _of_function(model: Model, facets: Locals, f: Any, x: Floats) -> Floats:
    """Values of a DOLFINx function at points of boundary facets, as many on each."""
    if len(x) == 0:
        return np.zeros((0, 3))
    cells, _ = facet_sides(model.mesh, facets)
    values = f.eval(x, np.repeat(cells, len(x) // len(cells)))
    return np.asarray(values).reshape(len(x), -1)
