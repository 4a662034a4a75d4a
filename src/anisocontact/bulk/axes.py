"""Three orthogonal axes of a material: the same everywhere, or those of a cylinder."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.base.registry import Parameter

SECOND = Parameter(
    "second",
    "vector",
    "1",
    "second axis, made orthogonal to the first",
    "nonzero",
    False,
    (0.0, 1.0, 0.0),
)
AROUND = Parameter(
    "around",
    "axis",
    "length",
    "axis of a cylinder: the first axis is then outwards from it, the second around it, the third "
    "along it",
    "nonzero",
    False,
)


def first_axis(name: str, doc: str) -> Parameter:
    """The parameter of the first axis, under a name of its own."""
    return Parameter(name, "vector", "1", doc, "nonzero", False, (1.0, 0.0, 0.0))


def check_axes(parameters: Sequence[Parameter], given: Mapping[str, Any], field: str = "") -> None:
    """Refuse axes that are given twice, by name and around a line.

    Args:
        parameters: Parameters of the material.
        given: Their values as the user wrote them; those of the case file have the defaults too.
        field: Where it was written, for messages.

    Raises:
        InputError: They are.
    """
    twice = [
        p.name
        for p in parameters
        if p.name in ("first", "second", "along")
        and given.get(p.name) is not None
        and tuple(given[p.name]) != p.default
    ]
    if twice and given.get("around") is not None:
        path = f"{field}.{twice[0]}" if field else twice[0]
        raise InputError("given with around, one of the two is allowed", path)


class MaterialAxes:
    """Axes of a material, in the reference configuration.

    Args:
        first: First axis, of any length.
        second: Second axis, made orthogonal to the first.
        around: A point and a direction: axes outwards from this line, around it and along it;
            nothing for those of before. On the line itself one of these directions is taken.
        field: Where the material was written, for messages.

    Raises:
        InputError: Both axes are parallel.

    Example:
        >>> MaterialAxes([2, 0, 0], [1, 1, 0], []).at(np.zeros((1, 3)))[0].round(12).tolist()
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    """

    def __init__(self, first: Any, second: Any, around: Any, field: str = "") -> None:
        first, second = (np.array(v, dtype=float) / np.linalg.norm(v) for v in (first, second))
        across = second - (second @ first) * first
        if np.linalg.norm(across) < 1e-6:
            text = "second is parallel to the first axis, another direction is needed"
            raise InputError(text, field=f"{field}.second" if field else "second")
        across /= np.linalg.norm(across)
        self._constant = np.column_stack([first, across, np.cross(first, across)])
        self._around = np.array(around, dtype=float).reshape(-1, 3)

    def form(self, u: Any) -> Any:
        """The axes as columns at a point of the reference configuration, UFL."""
        domain = ufl.domain.extract_unique_domain(u)
        if not len(self._around):
            return fem.Constant(domain, self._constant)
        point, axis = self._around
        along = fem.Constant(domain, axis / np.linalg.norm(axis))
        arm = ufl.SpatialCoordinate(domain) - fem.Constant(domain, point)
        away = arm - ufl.dot(arm, along) * along
        on_axis = ufl.eq(ufl.dot(away, away), 0.0)
        out = ufl.conditional(on_axis, fem.Constant(domain, _across(axis)), away)
        out = out / ufl.sqrt(ufl.dot(out, out))
        around = ufl.cross(along, out)
        return ufl.as_matrix([[out[i], around[i], along[i]] for i in range(3)])

    def at(self, places: Floats) -> Floats:
        """The axes as columns at places, (n, 3, 3), or (1, 3, 3) where they are all the same."""
        if not len(self._around):
            return self._constant[None]
        point, axis = self._around
        along = np.broadcast_to(axis / np.linalg.norm(axis), places.shape)
        arm = places - point
        out = arm - np.sum(arm * along, axis=1, keepdims=True) * along
        out[~out.any(axis=1)] = _across(axis)
        out = out / np.linalg.norm(out, axis=1, keepdims=True)
        return np.stack([out, np.cross(along, out), along], axis=-1)


def _across(axis: Floats) -> Floats:
    """Direction for points on the axis, where none is outwards: one of those that are."""
    found = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    return np.asarray(found / np.linalg.norm(found))
