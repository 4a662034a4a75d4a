"""Parameters of what is registered: their kinds, units and bounds, and values that fit them."""

from __future__ import annotations

import math
import reprlib
from collections.abc import Collection, Iterable, Mapping, Sequence, Set
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.base.sizes import LEAST, RANGE, out_of_range
from anisocontact.base.words import meant

_SIZES = {"scalar": 1, "integer": 1, "flag": 1, "choice": 1, "pair": 2, "vector": 3, "axis": 6}


class OfDegrees(float):
    """An angle in radian that was given in degrees, of which many turns are no slip.

    What `dataclasses.replace` makes of a rotation or a step is given the angle taken over.

    Example:
        >>> OfDegrees(20.0)
        20.0
    """


@dataclass(frozen=True)
class Parameter:
    """A parameter of an entry.

    Args:
        name: Identifier; with the unit "angle" it is in radian, `<name>_deg` is in degrees.
        kind: "scalar", "pair", "vector", "axis" (a point and a direction), "array", "integer",
            "integers", "flag" or "choice".
        unit: Dimension, such as "length" or "stress/length"; "1" where there is none.
        doc: One line.
        bound: "any", "nonzero", "positive" or "non-negative".
        required: Whether it must be given; never where there is a default.
        default: Value where it is not given.
        choices: The words a "choice" may be.
        count: How many numbers a list must have, if its kind does not say so.
        isotropic: What one number is multiplied with where it is given in the place of a list, to
            mean the same in all directions; (1, 1) of a pair.
    """

    name: str
    kind: str
    unit: str
    doc: str
    bound: str = "any"
    required: bool = True
    default: tuple[float, ...] = ()
    choices: tuple[str, ...] = ()
    count: int | None = None
    isotropic: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if self.default:
            object.__setattr__(self, "required", False)

    @property
    def alike(self) -> tuple[float, ...]:
        """Factors of the numbers of a list that one number stands for; none where it cannot."""
        return (1.0, 1.0) if self.kind == "pair" else self.isotropic

    def same_all_around(self, numbers: Sequence[float]) -> bool:
        """Whether values along two axes are the same along all others, so that axes do not count.

        Args:
            numbers: The numbers of the parameter.

        Returns:
            True where the parameter has no axes.

        Example:
            >>> mu = Parameter("mu", "pair", "1", "friction")
            >>> mu.same_all_around([0.3, 0.3]), mu.same_all_around([0.3, 0.1])
            (True, False)
        """
        if len(numbers) == 4 and self.alike:  # 2 x 2: what commutes with every rotation
            return numbers[0] == numbers[3] and numbers[1] == -numbers[2]
        return not self.alike or list(numbers) == [numbers[0] * k for k in self.alike]

    def shaped(self, numbers: Sequence[float]) -> Any:
        """A flat list of numbers in the form of the kind: a number, a word, a tuple."""
        if self.kind == "choice":
            return self.choices[int(numbers[0])]
        if self.kind == "flag":
            return bool(numbers[0])
        if self.kind in ("integer", "integers"):
            whole = tuple(int(v) for v in numbers)
            return whole[0] if self.kind == "integer" else whole
        return float(numbers[0]) if self.kind == "scalar" else tuple(float(v) for v in numbers)


@dataclass(frozen=True)
class Entry:
    """A registered surface, field, law or rule.

    Args:
        name: The name it is asked for by.
        kind: The registry it belongs to, such as "surface".
        doc: One line.
        parameters: Its parameters.
        directions: Of a friction model, how many direction fields it is built on.
    """

    name: str
    kind: str
    doc: str
    parameters: tuple[Parameter, ...]
    directions: int = 0


Value = float | int | bool | str | Sequence[float]


def values(
    e: Entry, given: Mapping[str, object], prefix: str = "", others: Collection[str] = ()
) -> dict[str, list[float]]:
    """Checked parameter values of an entry, as the core takes them.

    Args:
        e: The entry.
        given: Values by parameter name, angles also by `<name>_deg`; None counts as left out.
        prefix: Dotted path put before the parameter's name in messages.
        others: What else may be written beside the parameters, for the message of an unknown one.

    Returns:
        A list of numbers for every parameter, defaults filled in; angles in radian.

    Raises:
        InputError: A parameter is unknown, missing, of the wrong form or out of range.

    Example:
        >>> radius = Parameter("radius", "scalar", "length", "its radius", "positive")
        >>> values(Entry("ball", "surface", "a ball", (radius,)), {"radius": 2})
        {'radius': [2.0]}
    """
    path = f"{prefix}." if prefix else ""
    known = {p.name for p in e.parameters}
    given = in_radian(e.parameters, given, prefix)
    for name in given:
        if name not in known:
            names = sorted({*known, *others})
            near = meant(name, names)
            hint = f"; did you mean {near!r}?" if near else ""
            allowed = ", ".join(names) or "none"
            raise InputError(
                f"{e.kind} {e.name!r} has no parameter {name!r}, allowed: {allowed}{hint}",
                field=f"{path}{name}",
            )
    result = {}
    for p in e.parameters:
        v = given.get(p.name)
        if v is None:
            if p.required:
                raise InputError(
                    f"{e.kind} {e.name!r} needs {p.name} ({p.doc})", field=f"{path}{p.name}"
                )
            result[p.name] = list(p.default)
        else:
            result[p.name] = check(p, v, f"{path}{p.name}")
    return result


def arguments(e: Entry, numbers: Mapping[str, Sequence[float]]) -> dict[str, Any]:
    """The way back from `values`: what a user would have given.

    Args:
        e: The entry.
        numbers: A list of numbers for every parameter.

    Returns:
        Values by parameter name; angles in radian.

    Example:
        >>> radius = Parameter("radius", "scalar", "length", "its radius", "positive")
        >>> arguments(Entry("ball", "surface", "a ball", (radius,)), {"radius": [2.0]})
        {'radius': 2.0}
    """
    return {p.name: p.shaped(numbers[p.name]) for p in e.parameters}


#: Angle in radian beyond which degrees must have been meant; rounding of a full turn is none.
FULL_TURN = 2.0 * math.pi * (1.0 + 1e-12)


def in_radian(
    parameters: Iterable[Parameter], given: Mapping[str, object], prefix: str = ""
) -> dict[str, Any]:
    """Values with angles in radian, of which those by `<name>_deg` were in degrees.

    Args:
        parameters: Those of the entry.
        given: Values by parameter name; others are passed on as they are.
        prefix: Dotted path put before the parameter's name in messages.

    Returns:
        The values, with no name in degrees left.

    Raises:
        InputError: An angle is given twice, is no number, or is in radian and more than a full
            turn: a slip of degrees.

    Example:
        >>> angle = Parameter("angle", "scalar", "angle", "an angle")
        >>> in_radian([angle], {"angle_deg": 180.0})
        {'angle': 3.141592653589793}
        >>> in_radian([angle], {"angle": 30.0})
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: angle: 30 given in radian, more than a full turn; ...
    """
    path = f"{prefix}." if prefix else ""
    result = dict(given)
    for p in parameters:
        if p.unit != "angle":
            continue
        degrees = result.pop(f"{p.name}_deg", None)
        radian = result.get(p.name)
        if degrees is not None and radian is not None:
            text = f"given with {p.name}_deg, one of the two is allowed"
            raise InputError(text, field=f"{path}{p.name}")
        if degrees is not None:
            checked = check(p, degrees, f"{path}{p.name}_deg")
            turned = [OfDegrees(math.radians(v)) for v in checked]
            result[p.name] = turned if p.kind == "array" else turned[0]
        elif radian is not None:
            for angle in check(p, radian, f"{path}{p.name}"):
                if not isinstance(radian, OfDegrees):
                    check_radian(angle, f"{path}{p.name}")
    return result


def check_radian(angle: float, field: str) -> None:
    """Refuse an angle in radian that must have been meant in degrees.

    Args:
        angle: The angle, radian.
        field: Dotted path for the message; its last part is the name of the angle.

    Raises:
        InputError: It is more than a full turn; the line says how degrees are written.
    """
    if abs(angle) > FULL_TURN and not isinstance(angle, OfDegrees):
        name = field.rpartition(".")[2]
        text = (
            f"{angle:g} given in radian, more than a full turn; {name}_deg = {angle:g} is degrees"
        )
        raise InputError(text, field=field)


def check(p: Parameter, given: object, field: str = "") -> list[float]:
    """One parameter's value as a list of numbers.

    Args:
        p: The parameter.
        given: What was given.
        field: Dotted path for the message.

    Returns:
        The numbers; of a choice its place among the choices.

    Raises:
        InputError: Not of the parameter's form, not finite, out of its bound, or too large or small
            to compute with.

    Example:
        >>> check(Parameter("radius", "scalar", "length", "radius", "positive"), 2)
        [2.0]
    """
    field = field or p.name
    if p.kind == "choice":
        if not isinstance(given, str) or given not in p.choices:
            near = meant(given, p.choices) if isinstance(given, str) else None
            hint = f"; did you mean {near!r}?" if near else ""
            text = f"{given!r} given, allowed: {', '.join(p.choices)}{hint}"
            raise InputError(text, field=field)
        return [float(p.choices.index(given))]
    numbers = _numbers(p, given, field)
    if not all(math.isfinite(v) for v in numbers):
        raise InputError(f"{reprlib.repr(given)} given, finite numbers are needed", field=field)
    _check_bound(p, numbers, given, field)
    for together in _together(p, numbers):
        none = p.unit == "angle" and max(map(abs, together), default=0.0) < LEAST  # turns nothing
        if out_of_range(*together) and not none:
            allowed = RANGE if p.bound in ("positive", "nonzero") else f"0, or {RANGE}"
            raise InputError(f"{reprlib.repr(given)} given, must be {allowed}", field=field)
    return numbers


def _together(p: Parameter, numbers: list[float]) -> list[list[float]]:
    """Numbers that count by the largest of them: components of a vector, not values of two axes."""
    if p.kind == "axis":
        return [numbers[:3], numbers[3:]]
    return [[number] for number in numbers] if p.kind == "pair" else [numbers]


def _numbers(p: Parameter, given: object, field: str) -> list[float]:
    if p.kind == "flag":
        if not isinstance(given, bool):
            raise InputError(f"{given!r} given, true or false is needed", field=field)
        return [float(given)]
    is_list = _is_list(given)
    if p.alike and not is_list:
        return [_number(p, given, given, field) * k for k in p.alike]
    if p.kind in ("axis", "array"):
        return _nested_numbers(p, given, field)
    items: list[Any] = list(given) if is_list else [given]  # type: ignore[call-overload]
    numbers = [_number(p, v, given, field) for v in items]
    size = _SIZES.get(p.kind, p.count)
    scalar_form = size == 1
    if scalar_form == is_list or (size is not None and len(numbers) != size):
        raise InputError(f"{given!r} given, {_form(p)} needed", field=field)
    if p.kind in ("integer", "integers") and not all(v.is_integer() for v in numbers):
        raise InputError(f"{given!r} given, {_form(p)} needed", field=field)
    return numbers


def _number(p: Parameter, one: Any, given: object, field: str) -> float:
    """One of the numbers given; not finite where it is beyond all that can be computed with."""
    # texts of NumPy and classes have what makes a number of them, too; rows of an array have it
    unfit = isinstance(one, bool | str | type) or np.iscomplexobj(one) or np.ma.is_masked(one)
    if hasattr(one, "__float__") and not unfit:
        with suppress(TypeError):
            try:
                return float(one)
            except OverflowError:
                return math.inf
    raise InputError(f"{given!r} given, {_form(p)} needed", field=field)


def _is_list(given: object) -> bool:
    """Whether there are several values; an array without axes is one."""
    if isinstance(given, np.ndarray):
        return given.ndim > 0
    return isinstance(given, Iterable) and not isinstance(given, str | bytes | Set | Mapping)


def _nested_numbers(p: Parameter, given: object, field: str) -> list[float]:
    """Numbers of a list that may be nested, as a list of points is, in the order they stand in."""
    try:
        a = np.asarray(given)
    except ValueError:  # rows of different lengths
        a = np.asarray(None)
    fits = not np.ma.is_masked(given) and (p.kind == "array" or a.shape in ((2, 3), (6,)))
    if not isinstance(given, np.ndarray):  # NumPy takes true for 1 where there are numbers beside
        each = np.asarray(given, dtype=object).ravel() if fits else ()
        fits = fits and not any(isinstance(one, bool | np.bool_) for one in each)
    if a.ndim == 0 or a.dtype.kind not in "iuf" or not fits:
        raise InputError(f"{reprlib.repr(given)} given, {_form(p)} needed", field=field)
    return [float(v) for v in a.ravel()]


def _form(p: Parameter) -> str:
    forms = {
        "scalar": "one number is",
        "pair": "one or two numbers are",
        "vector": "one or three numbers are" if p.alike else "three numbers are",
        "axis": "a point and a direction, [[x, y, z], [x, y, z]], are",
        "array": "one number or a list of them is" if p.alike else "a list of numbers is",
        "integer": "a whole number is",
        "integers": "a list of whole numbers is",
    }
    return f"{p.count} whole numbers are" if p.count else forms[p.kind]


def _check_bound(p: Parameter, numbers: list[float], given: object, field: str) -> None:
    wrong = {
        "any": False,
        "nonzero": not any(v != 0.0 for v in (numbers[3:] if p.kind == "axis" else numbers)),
        "positive": any(v <= 0.0 for v in numbers),
        "non-negative": any(v < 0.0 for v in numbers),
    }[p.bound]
    if wrong:
        bound = {"nonzero": "must not be zero", "positive": "must be > 0"}.get(
            p.bound, "must be >= 0"
        )
        if p.kind == "axis":
            bound = f"its direction {bound}"
        raise InputError(f"{given!r} given, {bound}", field=field)
