"""Materials by a class of the user's: an energy, a stress, or a law of points."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from typing import Any, cast

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import answered, read_only_view
from anisocontact.base.errors import InputError
from anisocontact.base.python_file import where_failed
from anisocontact.base.typed import is_number
from anisocontact.bulk.hyperelastic import UserEnergy, UserStress
from anisocontact.bulk.materials import Material
from anisocontact.bulk.point_law import PointLaw, PointResult, PointState
from anisocontact.bulk.strain import STRAINS

#: Difference of components that have to be the same, over the largest one.
_SYMMETRIC = 1e-8


class UserLaw:
    """A stress update of the user's, whose results are checked.

    Args:
        law: Object with `update(state)` and `young`, and `strain` and `history` if it is not at
            small strain or remembers anything, and `elastic_tangent` if it flows; see `PointLaw`.

    Raises:
        InputError: It has no such attributes, or fails at rest.
    """

    linear = False

    def __init__(self, law: Any) -> None:
        self._law = law
        self.young: float = law.young
        self.strain: str = getattr(law, "strain", "small")
        if self.strain not in STRAINS:
            text = f"{self.strain!r} given, allowed: {', '.join(STRAINS)}"
            raise InputError(text, f"{type(law).__name__}.strain")
        self.history = _checked_history(getattr(law, "history", {}), type(law).__name__)
        elastic, who = getattr(law, "elastic_tangent", None), f"the law {type(law).__name__}"
        self.elastic_tangent: Floats | None = (
            None if elastic is None else answered(elastic, (3, 3, 3, 3), who, "elastic_tangent")
        )
        before = {name: np.zeros((2, *shape)) for name, shape in self.history.items()}
        rest = self.update(PointState(np.zeros((2, 3, 3)), before, 0.0, np.zeros((2, 3))))
        if not np.isfinite(rest.stress).all():
            text = f"the law {type(law).__name__} returned numbers that are not finite at rest"
            raise InputError(text, "stress")

    def update(self, state: PointState) -> PointResult:
        """As of `PointLaw`.

        Raises:
            InputError: The law fails, or returns something else.
        """
        name, n = type(self._law).__name__, len(state.strain)
        before = {name: read_only_view(values) for name, values in state.before.items()}
        strain, place = read_only_view(state.strain), read_only_view(state.place)
        try:
            result = self._law.update(PointState(strain, before, state.dt, place))
        except (Exception, SystemExit) as error:
            raise InputError(f"the law {name} failed: {where_failed(error)}") from error
        if not isinstance(result, PointResult):
            text = f"the law {name} returned a {type(result).__name__}, a PointResult needed"
            raise InputError(text)
        after: Any = result.after
        names = set(after) if isinstance(after, Mapping) else set()
        if names != set(self.history):
            text = f"{', '.join(map(str, names)) or 'none'} given, {', '.join(self.history)} needed"
            raise InputError(f"the law {name} returned other variables: {text}", "after")
        right = partial(answered, who=f"the law {name}")
        energies = {
            part: right(getattr(result, part), (n,), part=part)
            for part in ("stored", "dissipated")
            if getattr(result, part) is not None
        }
        found = PointResult(
            right(result.stress, (n, 3, 3), part="stress"),
            right(result.tangent, (n, 3, 3, 3, 3), part="tangent"),
            {v: right(after[v], (n, *s), part=v) for v, s in self.history.items()},
            **energies,
        )
        _check_answer(found, state, f"the law {name}")
        return found


def _checked_history(given: Any, name: str) -> Mapping[str, tuple[int, ...]]:
    """Variables of a law with their shapes."""
    shapes = given.values() if isinstance(given, Mapping) else [None]
    for shape in shapes:
        if not (isinstance(shape, tuple | list) and all(type(k) is int and k > 0 for k in shape)):
            text = f"{given!r:.60} given, shapes by name needed, () of a number"
            raise InputError(text, f"{name}.history")
    return {str(variable): tuple(shape) for variable, shape in given.items()}


def _check_answer(found: PointResult, state: PointState, who: str) -> None:
    """Refuse answers that can be no law, at points whose strain and stress are numbers.

    A stress that is none is that of a trial which went too far: the increment is cut.
    """
    known = np.isfinite(state.strain).all(axis=(1, 2)) & np.isfinite(found.stress).all(axis=(1, 2))
    for part, values in {"tangent": found.tangent, **found.after}.items():
        if not np.isfinite(values[known]).all():
            raise InputError(f"{who} returned numbers that are not finite", part)
    pairs = (("stress", found.stress, (0, 2, 1)), ("tangent", found.tangent, (0, 1, 2, 4, 3)))
    for part, values, other in pairs:
        kept = values[known]
        apart = np.abs(kept - kept.transpose(other)).max(initial=0.0)
        if apart > _SYMMETRIC * np.abs(kept).max(initial=0.0):
            what = "symmetric" if part == "stress" else "symmetric in its last two indices"
            raise InputError(f"{who} returned one that is not {what}", part)


def user_material(given: Any) -> Material:
    """The material that an object of the user's describes.

    Args:
        given: What it has says what it is: with `linear` it is a `Material` as it stands; with
            `update(state)` a law of points in NumPy, `PointLaw`; with `energy(F)` an energy per
            reference volume, with `piola(F)` a first Piola-Kirchhoff stress of the deformation
            gradient, both in UFL. `young` is Young's modulus at rest.

    Returns:
        The material.

    Raises:
        InputError: It is none of these, or fails.

    Example:
        >>> import ufl
        >>> class Rubber:
        ...     young = 3.0
        ...     def energy(self, F):
        ...         return 0.5 * (ufl.inner(F, F) - 3.0 - 2.0 * ufl.ln(ufl.det(F)))
        >>> type(user_material(Rubber())).__name__
        'UserEnergy'
    """
    name = type(given).__name__
    young = getattr(given, "young", None)
    if not (is_number(young) and math.isfinite(young) and young > 0.0):
        text = f"{name}.young is {young!r}, Young's modulus at rest needed, > 0"
        raise InputError(text)
    if hasattr(given, "linear"):
        return cast(Material, given)
    if callable(getattr(given, "update", None)):
        law: PointLaw = UserLaw(given)
        return cast(Material, law)
    kinds: dict[str, Any] = {"energy": UserEnergy, "piola": UserStress}
    for method, kind in kinds.items():
        function = getattr(given, method, None)
        if callable(function):
            made = kind(function, float(young), name=f"{name}.{method}")
            return cast(Material, made)
    raise InputError(f"{name} has no method energy(F), piola(F) or update(state)")
