"""What a function of a deformation gradient returns, looked at before it is compiled."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import ufl
from anisocontact.base.python_file import where_failed
from anisocontact.bulk.volume import derivative_at


def check_function(function: Callable[[Any], Any], name: str, shape: tuple[int, ...]) -> None:
    """Refuse a function that is no energy, or no stress.

    Args:
        function: Takes the UFL deformation gradient.
        name: Its name, for messages.
        shape: Of what it has to return, () of a number.

    Raises:
        InputError: It fails, or returns something else: of another shape, of numbers that are not
            finite or not real, or that does not depend on the deformation gradient.

    Example:
        >>> check_function(lambda F: F.T, "energy", ())
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: energy returned something of shape (3, 3), () needed
    """
    gradient = ufl.variable(ufl.Identity(3))
    try:
        answer = ufl.as_ufl(function(gradient))
    except (Exception, SystemExit) as error:
        raise InputError(f"{name} failed: {where_failed(error)}") from error
    if answer.ufl_shape != shape:
        raise InputError(f"{name} returned something of shape {answer.ufl_shape}, {shape} needed")
    for number in _numbers(answer):
        if isinstance(number, complex) or not math.isfinite(number):
            raise InputError(f"{name} returned something with {number!r}, finite numbers needed")
    if isinstance(derivative_at(function, ufl.Identity(3)), ufl.constantvalue.Zero):
        raise InputError(f"{name} returned something that does not depend on F, stiffness needed")


def _numbers(answer: Any) -> list[complex | float]:
    """All numbers that stand in an expression."""
    every = ufl.corealg.traversal.unique_pre_traversal(answer)
    return [one.value() for one in every if isinstance(one, ufl.constantvalue.ScalarValue)]
