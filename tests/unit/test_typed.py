"""What scripts call refuses arguments of other types: one line that names the argument."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

import anisocontact
from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed

#: What scripts are given and do not make, materials, which are checked by what they register, and
#: what takes any class or function.
GIVEN = (
    "Accepted DirectionField Geometry History InputError LawKinematics LawResult LawState "
    "ModelWarning Newton PointResult PointState Pose Projection Response SlavePoints Surface "
    "WholeMesh cauchy_stress deformation_gradient from_mandel slope_from_mandel small_strain "
    "to_mandel register_amplitude register_material register_path register_reader register_strategy"
)
MATERIALS = (
    "Hill LinearElastic LinearElasticIncompressible MooneyRivlin NeoHookean "
    "NeoHookeanIncompressible Ogden Orthotropic Plastic StVenantKirchhoff TransverselyIsotropic "
    "Viscoelastic Yeoh"
)


def _arguments() -> list[tuple[str, str]]:
    """Names of what is called and of their arguments with a type."""
    found = []
    for name in anisocontact.__all__:
        called = getattr(anisocontact, name)
        other = name in f"{GIVEN} {MATERIALS} __version__".split()
        if other or not callable(called) or getattr(called, "_is_protocol", False):
            continue
        if name in ("Amplitude", "State"):  # types alone
            continue
        for p in inspect.signature(called).parameters.values():
            if p.kind in (p.VAR_KEYWORD, p.VAR_POSITIONAL) or p.annotation in ("Any", "object"):
                continue
            found.append((name, p.name))
    return found


@pytest.mark.parametrize(("name", "argument"), _arguments())
def test_everything_public_says_what_it_takes(name: str, argument: str) -> None:
    """Requirement: what is of no type that an argument may have is an `InputError` with its name,
    whatever is called. Source: the front door, whose list this goes through."""
    with pytest.raises(InputError) as caught:
        getattr(anisocontact, name)(**{argument: object()})
    assert str(caught.value).startswith(f"{argument}: object given, ")
    assert str(caught.value).endswith(" needed")


@typed
def _takes(
    number: float = 0.0,
    count: int = 0,
    yes: bool = False,
    text: str | None = None,
    path: Path = Path(),
    vector: Sequence[float] = (),
    three: tuple[float, float, float] = (0.0, 0.0, 0.0),
    names: Iterable[str] = (),
    table: Mapping[str, Sequence[str]] = {},
    deep: Mapping[str, Mapping[str, float]] = {},
    function: Callable[[float], float] = abs,
    kind: type[Any] = int,
    anything: Any = None,
) -> str:
    return "taken"


FITS: list[dict[str, Any]] = [
    {"number": 1},
    {"number": np.float32(1.0)},
    {"number": np.array(2.0)},
    {"count": np.int64(3)},
    {"yes": np.True_},
    {"text": None},
    {"path": "a"},
    {"vector": np.ones(3)},
    {"vector": [1, 2.0]},
    {"three": [1, 2, 3]},
    {"names": {"a", "b"}},
    {"names": (n for n in "ab")},
    {"table": {"a": ["b"]}},
    {"deep": {"a": 1.0}},
    {"function": max},
    {"kind": float},
    {"anything": object()},
]


@pytest.mark.parametrize("given", FITS)
def test_what_fits_is_taken(given: dict[str, Any]) -> None:
    """Numbers and lists of NumPy are numbers and lists; what is nested is for others to judge."""
    assert _takes(**given) == "taken"


@pytest.mark.parametrize(
    ("argument", "given", "says"),
    [
        ("number", True, "True given, a number needed"),
        ("number", float("nan"), "nan given, a number needed"),
        ("number", "1", "'1' given, a number needed"),
        ("count", 1.0, "1.0 given, a whole number needed"),
        ("yes", 1, "1 given, True or False needed"),
        ("text", 3, "3 given, a text needed"),
        ("vector", "123", "'123' given, a list of numbers needed"),
        ("vector", [1, "2"], "[1, '2'] given, a list of numbers needed"),
        ("vector", [[1], [2, 3]], "[[1], [2, 3]] given, a list of numbers needed"),
        ("vector", (v for v in (1, 2)), "generator given, a list of numbers needed"),
        ("vector", np.array(1.0), "ndarray given, a list of numbers needed"),
        ("three", (1, 2), "(1, 2) given, 3 numbers needed"),
        ("names", "ab", "'ab' given, a list of texts needed"),
        ("table", [("a", ["b"])], "[('a', ['b'])] given, values by name needed"),
        ("table", {3: ["b"]}, "{3: ['b']} given, values by name needed"),
        ("function", 3, "3 given, a function needed"),
        ("kind", 3, "3 given, type needed"),
    ],
)
def test_what_does_not_fit_is_one_line(argument: str, given: Any, says: str) -> None:
    """Requirement: the argument, what was given, what is needed."""
    with pytest.raises(InputError) as caught:
        _takes(**{argument: given})
    assert str(caught.value) == f"{argument}: {says}"


def test_a_value_by_name_that_does_not_fit_is_named() -> None:
    """Requirement: which of several values by name is wrong, and what it has to be."""
    with pytest.raises(InputError) as caught:
        _takes(table={"right": ["b"], "wrong": "b"})
    assert str(caught.value) == "table.wrong: 'b' given, a list of texts needed"


def test_a_call_that_python_refuses_is_for_python() -> None:
    """An argument that there is not is no matter of types."""
    with pytest.raises(TypeError, match="unexpected keyword argument 'colour'"):
        _takes(colour=1)  # type: ignore[call-arg]
