"""What scripts call refuses arguments of other types: one line that names the argument."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

import anisocontact
from anisocontact.base import fenicsx
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Entry
from anisocontact.base.typed import typed
from anisocontact.mesh import BoxSpec, build_box

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
    array: npt.NDArray[np.float64] | None = None,
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
    {"array": np.ones(3)},
    {"array": [1.0, 2.0]},
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
        ("array", 3, "3 given, an array needed"),
        ("array", "a", "'a' given, an array needed"),
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


@pytest.mark.parametrize(
    ("called", "given", "says"),
    [
        (
            _takes,
            "tabel",
            "_takes() got an unexpected keyword argument 'tabel': did you mean 'table'?",
        ),
        (
            anisocontact.Body,
            "order",
            "Body() got an unexpected keyword argument 'order': allowed: name, shape, placement",
        ),
        (
            anisocontact.Step,
            "displacements",
            "Step() got an unexpected keyword argument 'displacements': "
            "did you mean 'displacement'?",
        ),
    ],
)
def test_an_argument_that_there_is_not_is_told_beside_those_that_are(
    called: Callable[..., Any], given: str, says: str
) -> None:
    """Requirement: Python's own error, with the argument that is spelt like it, or with all."""
    with pytest.raises(TypeError) as caught:
        called(**{given: 1})
    assert str(caught.value) == says


def test_a_call_that_python_refuses_is_for_python() -> None:
    """An argument that is given twice is no matter of types."""
    with pytest.raises(TypeError, match="multiple values for argument 'name'"):
        anisocontact.Body(3, name="a")  # type: ignore[misc, call-arg, arg-type]


class _Half:
    """A strategy that says what it is and cannot solve."""

    entry = Entry("half", "strategy", "nothing", ())


class _Nameless:
    entry = "nameless"


@pytest.mark.parametrize("kind", ["amplitude", "material", "path", "strategy"])
@pytest.mark.parametrize(
    ("given", "shown"), [(int, "int"), (3, "3"), (None, "None"), (_Nameless, "_Nameless")]
)
def test_what_is_registered_is_a_class_with_an_entry(kind: str, given: Any, shown: str) -> None:
    """Requirement: what the class is to be, what was given, what is needed."""
    with pytest.raises(InputError) as caught:
        getattr(anisocontact, f"register_{kind}")(given)
    assert str(caught.value) == f"{kind}: {shown} given, a class with an 'entry' needed"


def test_a_strategy_that_lacks_parts_is_not_registered() -> None:
    """It would fail at its first run, after everything was built."""
    for _ in range(2):  # nothing of it is left
        with pytest.raises(InputError, match=r"^strategy: _Half given, Strategy, which has costs"):
            anisocontact.register_strategy(_Half)  # type: ignore[type-var]


@pytest.mark.parametrize(
    ("of", "given", "says"),
    [
        ("linear-elastic", {"material": 1}, "material: 1 given, a material needed"),
        ("linear-elastic", {"u": 1}, "u: 1 given, a UFL vector of 3 components needed"),
        ("neo-hookean", {"u": None}, "u: None given, a UFL vector of 3 components needed"),
        (
            "neo-hookean",
            {"pressure": 1.0},
            "pressure: given, NeoHookean keeps no change of volume apart",
        ),
        (
            "neo-hookean-incompressible",
            {"pressure": "a"},
            "pressure: 'a' given, a UFL expression of one number needed",
        ),
    ],
)
def test_a_stress_of_what_is_none_is_one_line(of: str, given: dict[str, Any], says: str) -> None:
    """Requirement: which argument, what was given, what is needed."""
    cube = BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))
    model = build_box({"block": cube})
    u = fenicsx.fem.Function(model.space)
    material = anisocontact.make_material(of, E=1.0, nu=0.3)
    with pytest.raises(InputError) as caught:
        anisocontact.cauchy_stress(**{"material": material, "u": u, **given})
    assert str(caught.value) == says


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"state": "s"}, "state: 's' given, an array needed"),
        ({"state": None}, "state: None given, an array needed"),
        ({"state": 3}, "state: 3 given, an array needed"),
        ({"x": None}, "x: None given, an array of numbers needed"),
        ({"dt": "a"}, "dt: 'a' given, a number needed"),
        ({"slave": 3}, "slave: 3 given, SlaveSurface needed"),
        ({"tangent": None}, "tangent: None given, True or False needed"),
    ],
)
def test_an_update_of_what_is_none_is_one_line(given: dict[str, Any], says: str) -> None:
    """Requirement: which argument, what was given, what is needed."""
    plane = anisocontact.make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    laws = (
        anisocontact.NormalLaw(penalty=1e3),
        anisocontact.Adhesion(stiffness=(1e3, 1e3)),
        anisocontact.Friction(coefficients=0.3),
    )
    interface = anisocontact.Interface(plane, *laws)
    x = [[0.0, 0.0, -1e-3]]
    state = interface.initial_state(x)
    assert interface.update(state, x).traction[0, 2] > 0.0
    with pytest.raises(InputError) as caught:
        interface.update(**{"state": state, "x": x, **given})
    assert str(caught.value) == says
    with pytest.raises(InputError, match=r"^state: no states given"):
        interface.update(state[None], x)


def test_value_objects_keep_what_they_were_given():
    """Requirement: a step is what it was made of, also where a script goes on to write into that.

    Source: by hand. A loop that writes the next value into the dictionary or list of the last one
    made all its steps, bodies or turns those of the last value, without a word.
    """
    led, middle, way = {"block.top": {"z": 0.0}}, [0.0, 0.0, 0.0], np.zeros(3)
    steps, turns, places = [], [], []
    for i in range(3):
        led["block.top"]["z"] = middle[0] = way[0] = float(i)
        steps.append(anisocontact.Step(f"{i}", 1, led))
        turns.append(anisocontact.Turn(axis=(0, 0, 1), angle=0.1, point=middle))
        places.append(anisocontact.Placement(move=way))
    assert [step.displacement["block.top"]["z"] for step in steps] == [0.0, 1.0, 2.0]
    assert [turn.point[0] for turn in turns] == [0.0, 1.0, 2.0]
    assert [place.move[0] for place in places] == [0.0, 1.0, 2.0]


@pytest.mark.parametrize(
    "write",
    [
        lambda step: step.displacement["block.top"].update(z=-1.0),
        lambda step: step.displacement["block.top"].__setitem__("w", "up"),
        lambda step: step.traction.setdefault("block.bottom", {"z": 1.0}),
        lambda step: step.motion["tool"].pop("rx"),
        lambda step: step.rotation.clear(),
    ],
)
def test_nobody_writes_into_a_step(write: Any) -> None:
    """Requirement: what a step has was checked when it was made, and stays that.

    Source: by hand. A script that wrote an axis "w" or a text into the dictionary of a step, in the
    middle of a run, was not told: it was taken, or left out, without a word.
    """
    led: dict[str, dict[str, float | None]] = {"block.top": {"z": 0.0}}
    turn = {"disc": anisocontact.Turn(axis=[0, 0, 1], angle=0.1, point=[0, 0, 1])}
    step = anisocontact.Step("drag", 1, led, motion={"tool": {"rx_deg": 30.0}}, rotation=turn)
    before = repr(step)
    with pytest.raises(InputError, match=r"^read only, .* dataclasses.replace$"):
        write(step)
    with pytest.raises(TypeError, match="item assignment"):
        step.rotation["disc"].point[2] = 0.0  # type: ignore[index]
    assert repr(step) == before


def test_a_step_is_copied_and_changed_by_making_another() -> None:
    """Requirement: copies, pickles and `dataclasses.replace` of a step are steps like others."""
    step = anisocontact.Step("drag", 1, {"block.top": {"z": 0.0}}, motion={"tool": {"x": 1.0}})
    for copied in (copy.deepcopy(step), pickle.loads(pickle.dumps(step))):
        assert copied == step
        with pytest.raises(InputError, match=r"^read only"):
            copied.displacement["block.top"]["z"] = 1.0
    other = dataclasses.replace(step, displacement=step.displacement | {"block.bottom": {"x": 0}})
    assert list(other.displacement) == ["block.top", "block.bottom"]
    way = np.zeros(3)
    placed = anisocontact.Placement(move=way)
    with pytest.raises(ValueError, match="read-only"):
        placed.move[0] = 1.0  # type: ignore[index]
    way[0] = 1.0
    assert placed.move[0] == 0.0
