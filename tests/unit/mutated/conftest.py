"""Cases and meshes with mistakes in them, made at random from whole ones, by seed and number."""

from __future__ import annotations

import copy
import math
import random
import signal
import tomllib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import pytest

CASES = Path(__file__).parent / "cases"
NAMES = ("pair", "rigid", "held", "meshed")
#: Seconds after which a run counts as one that hangs; a healthy one takes a second.
PATIENCE = 120
#: Numbers of things: a large one is a large run, not a mistake.
COUNTS = {"cells", "increments", "degree", "degrees", "every", "cuts", "snes_max_it", "order"}

Place = tuple[Any, ...]

_NUMBERS = [0, 0.0, -0.0, 1, -1, 2.5, 1e-300, 1e300, -1e300, 1e-12, 1e12, 1e-6, 10**400, 2**63]
_NUMBERS += [math.nan, math.inf, -math.inf]
_WORDS = ["", " ", "auto", "free", "none", "x", "upper.top", "block.bottom", "block", "plate"]
_WORDS += ["wall", "a.msh", "../a.msh", ".", "/", "\0", "é", "\n", "x" * 5000, "{}", "block."]
_WORDS += ["single", "two-half", "augmented", "direct", "condensed", "mumps", "polar", "maxwell"]
_WORDS += ["total", "incremental", "explicit", "linear", "he-curnier", "kelvin-voigt", "both"]
_KEYS = ["x", "y", "z", "rx", "unknown", "penalty", "stiffness", "directions", "model", "kind"]
_KEYS += ["pass", "tolerance", "adjust", "self_contact", "apart", "ratio", "cell", "order", "é"]
_KEYS += ["symmetry", "spring", "rigid", "surface", "motion", "density", "history", "a.b", ""]
_OPTIONS = {"snes_type": "vinewtonrsls", "ksp_type": "gmres", "pc_type": "lu", "snes_rtol": 0.0}
_OPTIONS |= {"snes_atol": 1e300, "pc_factor_mat_solver_type": "petsc", "snes_max_it": 0}
_OPTIONS |= {"snes_monitor": True, "mat_mumps_icntl_14": -5, "help": True, "ksp_max_it": 0}
_OPTIONS |= {"snes_linesearch_type": "bt", "log_view": "x", "snes_stol": -1, "-snes_rtol": 1}


def places(node: Any, at: Place = ()) -> Iterator[Place]:
    """Paths of everything in nested tables and lists."""
    if at:
        yield at
    if isinstance(node, dict | list):
        for key, child in node.items() if isinstance(node, dict) else enumerate(node):
            yield from places(child, (*at, key))


class Mutation:
    """Mistakes in a case.

    Args:
        chance: Where they come from.
    """

    def __init__(self, chance: random.Random) -> None:
        self.chance = chance

    def case(self, data: dict[str, Any]) -> dict[str, Any]:
        """The case with one to three mistakes."""
        data = copy.deepcopy(data)
        for _ in range(self.chance.choice([1, 1, 2, 3])):
            place = self.chance.choice(list(places(data)) or [()])
            if place:
                self._one(data, place)
        return data

    def _one(self, data: dict[str, Any], place: Place) -> None:
        parent: Any = data
        for key in place[:-1]:
            parent = parent[key]
        key = place[-1]
        kinds = [self._change, self._change, self._swap, self._leave_out]
        if isinstance(parent[key], int | float):
            kinds += [self._scale] * 6
        if isinstance(parent[key], list):
            kinds += [self._lengthen]
        if isinstance(parent, dict):
            kinds += [self._rename, self._add]
        self.chance.choice(kinds)(data, parent, key, counted=bool(COUNTS & set(place)))

    def _value(self, counted: bool) -> Any:
        chance = self.chance
        if counted:
            return chance.choice([0, 1, 2, 3, -1, 2.5, math.nan, -math.inf, -(10**400), "x", True])
        return chance.choice(
            [
                chance.choice(_NUMBERS),
                chance.choice(_NUMBERS),
                chance.uniform(-2.0, 2.0),
                chance.choice(_WORDS),
                chance.choice([True, False, [], {}, [[]], [{}], [1, 2, 3], [0, 0, 0], ["a"]]),
                [chance.choice([*_NUMBERS, 1.0, 0.0, 0.5]) for _ in range(chance.randint(1, 4))],
                {chance.choice(_KEYS): chance.choice(_NUMBERS)},
            ]
        )

    def _change(self, data: Any, parent: Any, key: Any, counted: bool) -> None:
        parent[key] = self._value(counted)

    def _scale(self, data: Any, parent: Any, key: Any, counted: bool) -> None:
        factors = [-1, 0] if counted else [-1, 0, 1e-3, 0.5, 2, 10, 1e3, 1e6, 1e-9]
        parent[key] = parent[key] * self.chance.choice(factors)

    def _swap(self, data: Any, parent: Any, key: Any, counted: bool) -> None:
        """Something of the same kind from elsewhere: well formed, and often contradictory."""
        if counted:
            return
        others = [p for p in places(data) if not COUNTS & set(p)]
        alike = [v for p in others if type(v := _at(data, p)) is type(parent[key])]
        parent[key] = copy.deepcopy(self.chance.choice(alike))

    def _leave_out(self, data: Any, parent: Any, key: Any, counted: bool) -> None:
        del parent[key]

    def _lengthen(self, data: Any, parent: Any, key: Any, counted: bool) -> None:
        more = self._value(counted) if not parent[key] else copy.deepcopy(parent[key][-1])
        parent[key].append(more)

    def _rename(self, data: Any, parent: Any, key: Any, counted: bool) -> None:
        wrong = self.chance.choice([*_KEYS, key[:-1], key + "s", key.upper(), key[1:]])
        parent[wrong] = parent.pop(key)

    def _add(self, data: Any, parent: Any, key: Any, counted: bool) -> None:
        if "snes_max_it" in parent:
            name, value = self.chance.choice(list(_OPTIONS.items()))
            parent[name] = value
        else:
            parent[self.chance.choice(_KEYS)] = self._value(counted=True)


def _at(data: Any, place: Place) -> Any:
    for key in place:
        data = data[key]
    return data


def toml(value: Any) -> str:
    """A value as TOML has it, tables inline."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{toml(str(k))} = {toml(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(toml(v) for v in value) + "]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        plain = value.isprintable() and not set(value) & set('"\\')
        return f'"{value}"' if plain else '"' + "".join(f"\\U{ord(c):08x}" for c in value) + '"'
    return repr(value)


def document(data: dict[str, Any]) -> str:
    """Tables as the text of a file."""
    return "".join(f"{toml(str(key))} = {toml(value)}\n" for key, value in data.items())


def mutated_text(chance: random.Random, text: str) -> bytes:
    """The text with a few bytes cut, put in or in another encoding."""
    data = text.encode()
    for _ in range(chance.randint(1, 3)):
        at = chance.randrange(len(data) + 1)
        put = [b"\n", b"=", b"[", b'"', b"nan", b"{", b"-", b"\0", b"\xff", b"[[", b"#", b"'''"]
        put += [b" ", b"0", b"1", b"9", b"e", b"_", b"\r\n", b"\t"]
        data = data[:at] + chance.choice([b"", *put]) + data[at + chance.choice([0, 0, 0, 1, 30]) :]
    encode = chance.choice([None, None, None, "utf-16", "utf-32", "latin-1"])
    return data.decode("utf-8", "replace").encode(encode, "replace") if encode else data


class MeshMutation:
    """Mistakes in a mesh file.

    Args:
        chance: Where they come from.
    """

    _TOKENS = ("nan", "inf", "-inf", "1e300", "1e-300", "x", "$End", "999999999999", '"top"', "")
    _TOKENS += ("0", "-1", "1", "2", "3", "4", "5", "15", "0.5", "é")

    def __init__(self, chance: random.Random) -> None:
        self.chance = chance

    def mesh(self, text: str) -> bytes:
        """The file with one to three mistakes."""
        lines = text.splitlines()
        kinds = (self._word, self._word, self._drop, self._double, self._exchange, self._section)
        kinds += (self._merge, *[self._move] * 6)
        for _ in range(self.chance.randint(1, 3)):
            if lines:
                self.chance.choice(kinds)(lines)
        data = ("\n".join(lines) + "\n").encode()
        rare = self.chance.random()
        if rare < 0.05:
            return data[: self.chance.randrange(len(data))]
        if rare < 0.08:
            return self.chance.randbytes(self.chance.randint(0, 3000))
        if rare < 0.12:
            head = data.replace(b"4.1 0 8", b"4.1 1 8", 1)
            return head[:60] + self.chance.randbytes(2000)
        return data

    def _line(self, lines: list[str]) -> int:
        return self.chance.randrange(len(lines))

    def _word(self, lines: list[str]) -> None:
        at = self._line(lines)
        words = lines[at].split(" ")
        words[self.chance.randrange(len(words))] = self.chance.choice(self._TOKENS)
        lines[at] = " ".join(words)

    def _drop(self, lines: list[str]) -> None:
        del lines[self._line(lines)]

    def _double(self, lines: list[str]) -> None:
        at = self._line(lines)
        lines.insert(at, lines[at])

    def _exchange(self, lines: list[str]) -> None:
        """Two words of a line: cells turn inside out, counts and tags change places."""
        at = self._line(lines)
        words = lines[at].split(" ")
        i, j = self.chance.randrange(len(words)), self.chance.randrange(len(words))
        words[i], words[j] = words[j], words[i]
        lines[at] = " ".join(words)

    def _section(self, lines: list[str]) -> None:
        """A section is left out or comes twice."""
        starts = [i for i, line in enumerate(lines) if line[:1] == "$" and line[:4] != "$End"]
        if not starts:
            return
        start = self.chance.choice(starts)
        ends = [i for i in range(start, len(lines)) if lines[i][:4] == "$End"]
        end = ends[0] + 1 if ends else len(lines)
        if self.chance.random() < 0.5:
            del lines[start:end]
        else:
            lines[start:start] = lines[start:end]

    def _points(self, lines: list[str]) -> list[int]:
        if "$Nodes" not in lines or "$EndNodes" not in lines:
            return []
        inside = range(lines.index("$Nodes"), lines.index("$EndNodes"))
        return [i for i in inside if len(lines[i].split()) == 3]

    def _merge(self, lines: list[str]) -> None:
        """Two nodes in one place."""
        if points := self._points(lines):
            lines[self.chance.choice(points)] = lines[self.chance.choice(points)]

    def _move(self, lines: list[str]) -> None:
        """A node somewhere else: cells that are flat, inverted, huge or only distorted."""
        if points := self._points(lines):
            at = self.chance.choice(points)
            size = self.chance.choice([0.01, 0.05, 0.2, 1.0, 1e8, 1e300])
            try:
                old = [float(word) for word in lines[at].split()]
            except ValueError:  # an earlier mistake is there
                old = [0.0, 0.0, 0.0]
            lines[at] = " ".join(str(x + self.chance.uniform(-size, size)) for x in old)


def whole_mesh() -> str:
    """A cube of a few tetrahedra, bodies "block", facet groups "bottom" and "top"."""
    return (CASES / "cube.msh").read_text()


def whole_case(name: str) -> dict[str, Any]:
    """One of the cases."""
    return tomllib.loads((CASES / f"{name}.toml").read_text())


@contextmanager
def patience() -> Iterator[None]:
    """A test that takes too long is a run that hangs."""

    def late(*_: object) -> None:
        raise TimeoutError(f"still running after {PATIENCE} s")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(PATIENCE)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


def check_streams(code: int, error: str) -> None:
    """One line for each mistake, each saying what it is; none is an error of the program."""
    assert code in (0, 2, 3), error
    lines = error.splitlines()
    assert all(
        line.startswith(("error: ", "warning: ", "to go on: "))
        and line.isprintable()
        and len(line) < 2000
        for line in lines
    ), error
    assert (code == 0) == (not any(line.startswith("error: ") for line in lines)), error


def check_run(path: Path, folder: Path, capsys: Any) -> tuple[int, str]:
    """Run, and hold the command to what it promises; the exit code and what it said."""
    from anisocontact.cli import main
    from anisocontact.results import Results

    with patience():
        code = main(["run", str(path), "-o", str(folder)])
    error = capsys.readouterr().err
    check_streams(code, error)
    if code == 2:
        assert not folder.exists()
        return code, error
    results = Results(folder)
    assert results.summary["status"] == {0: "done", 3: "stopped"}[code]
    assert len(results.history.get("time", ())) == results.summary["steps"]
    for index in range(len(results.times)):
        assert results.fields(index).n_points > 0
    assert (folder / "checkpoint.npz").is_file()
    assert not list(folder.rglob(".*"))
    return code, error


class Mutated:
    """Cases and meshes with mistakes, and what they have to come to.

    Args:
        folders: Makes a new folder.
        capsys: What the command prints.
    """

    names = NAMES

    def __init__(self, folders: Callable[[], Path], capsys: Any) -> None:
        self._folders = folders
        self._capsys = capsys

    def made(self, kind: str, seed: int, number: int) -> tuple[bytes, bytes]:
        """Case file and mesh file of a kind of mistake, a seed and a number."""
        chance = random.Random(f"{kind} {seed} {number}")
        name = NAMES[number % len(NAMES)]
        mesh = whole_mesh().encode()
        if kind == "mesh":
            return (CASES / "meshed.toml").read_bytes(), MeshMutation(chance).mesh(whole_mesh())
        if kind == "text":
            return mutated_text(chance, (CASES / f"{name}.toml").read_text()), mesh
        return document(Mutation(chance).case(whole_case(name))).encode(), mesh

    def check(self, kind: str, seed: int, number: int) -> None:
        """Run one of them."""
        case, mesh = self.made(kind, seed, number)
        folder = self._folders()
        (folder / "case.toml").write_bytes(case)
        (folder / "a.msh").write_bytes(mesh)
        try:
            self.run_in(folder)
        except AssertionError as error:
            raise AssertionError(f"{kind}, seed {seed}, number {number}, {folder}") from error

    def whole_case(self, name: str) -> dict[str, Any]:
        """One of the cases without a mistake."""
        return whole_case(name)

    def place(self, folder: Path, data: dict[str, Any] | None = None) -> None:
        """Write a case, "meshed" if none is given, and the mesh it may need."""
        text = document(whole_case("meshed") if data is None else data)
        (folder / "case.toml").write_text(text, encoding="utf-8", newline="")
        (folder / "a.msh").write_text(whole_mesh())

    def run(self, data: dict[str, Any]) -> int:
        """Run a case; the exit code."""
        folder = self._folders()
        self.place(folder, data)
        return self.run_in(folder)[0]

    def run_in(self, folder: Path) -> tuple[int, str]:
        """Run what is in a folder; the exit code and what was said."""
        return check_run(folder / "case.toml", folder / "out", self._capsys)


@pytest.fixture
def mutated(tmp_path_factory: pytest.TempPathFactory, capsys: Any) -> Mutated:
    """Cases and meshes with mistakes."""
    return Mutated(lambda: tmp_path_factory.mktemp("run"), capsys)


@pytest.fixture(autouse=True)
def no_report(monkeypatch: pytest.MonkeyPatch) -> None:
    """The pictures take longer than the run."""
    monkeypatch.setattr(
        "anisocontact.results.report_process.report_beside",
        lambda wanted: nullcontext(lambda folder: []),
    )
