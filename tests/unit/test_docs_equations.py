"""The theory pages: every equation has its row, and every name in them exists.

Requirement: docs/theory/equations.md lists equations 1 to 124, each with the code that implements
it, where that runs, and the test that pins it. What is said to run in a run can be reached by one,
what is said not to cannot, by the names in the text of the core and by imports.
docs/theory/notation.md and errata.md name what there is. Tests are looked up in their source, not
run.
"""

from __future__ import annotations

import ast
import importlib
import re
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from tests.unit import code_that_runs

from anisocontact.base import registry

ROOT = Path(__file__).parents[2]
THEORY = ROOT / "docs" / "theory"
HEADERS = ROOT / "cpp" / "include" / "anisocontact"
SOURCES = ROOT / "src" / "anisocontact"
TOKEN = re.compile(r"`([^`]+)`")
TEST = re.compile(r"^(test_\w+\.py)::(test_\w+)$")


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.strip().strip("|").split("|")]


def equations() -> list[list[str]]:
    """Rows of the table: number, meaning, code, where it runs, test."""
    lines = (THEORY / "equations.md").read_text().splitlines()
    return [cells(line) for line in lines if re.match(r"^\| \(\d+\) \|", line)]


ROWS = equations()


@cache
def header(name: str) -> str:
    """Code of a header, without its comments."""
    return re.sub(r"//[^\n]*", "", (HEADERS / name).read_text())


@cache
def identifiers(file: Path) -> frozenset[str]:
    """Names in a Python file: of definitions, arguments, variables and attributes."""
    found = set()
    for node in ast.walk(ast.parse(file.read_text())):
        for field in ("name", "id", "attr", "arg"):
            if isinstance(value := getattr(node, field, None), str):
                found.add(value)
    return frozenset(found)


@cache
def functions_of(file: str) -> frozenset[str]:
    """Names of the test functions of a file anywhere below tests/."""
    (path,) = (ROOT / "tests").rglob(file)
    functions = (n for n in ast.walk(ast.parse(path.read_text())) if isinstance(n, ast.FunctionDef))
    return frozenset(f.name for f in functions)


@cache
def registered() -> frozenset[str]:
    """Names of all registered entries and the words their choices may be."""
    entries = (
        *registry.surfaces(),
        *registry.direction_fields(),
        *registry.normal_laws(),
        *registry.adhesion_models(),
        *registry.friction_models(),
        *registry.sliding_rules(),
        *registry.evolution_forms(),
    )
    words = {choice for e in entries for p in e.parameters for choice in p.choices}
    return frozenset(words | {e.name for e in entries})


def declared(symbol: str, file: str) -> bool:
    """Whether a header declares `namespace::name`."""
    space, _, name = symbol.rpartition("::")
    text = header(file)
    inside = space == "anisocontact" or f"namespace anisocontact::{space} {{" in text
    form = rf"\b(?:struct|class|concept)\s+{name}\b|\busing\s+{name}\s*=|\b{name}\("
    return inside and re.search(form, text) is not None


def split(name: str) -> tuple[str, list[str]]:
    """Module and attributes of `package.module.Class.name`; the module may be a whole package."""
    parts = name.split(".")
    count = 0
    while count < len(parts) and (
        (path := SOURCES.joinpath(*parts[: count + 1])).is_dir()
        or path.with_suffix(".py").is_file()
    ):
        count += 1
    return ".".join(parts[:count]), parts[count:]


def python_object(name: str) -> tuple[Any, Path]:
    """An attribute of a module, and the file that defines it."""
    module, path = split(name)
    try:
        found = importlib.import_module(f"anisocontact.{module}")
    except ImportError as error:
        if error.name and error.name.startswith("anisocontact"):
            raise
        pytest.skip(f"{error.name} is not installed")
    file = found.__file__
    for attribute in path:
        found = getattr(found, attribute)
        file = getattr(sys.modules.get(getattr(found, "__module__", "")), "__file__", file)
    return found, Path(file or "")


def is_python(token: str) -> bool:
    return re.fullmatch(r"[a-z_]+(\.\w+)+", token) is not None and not token.endswith(".hpp")


def unknown(cell: str) -> Iterator[str]:
    """Yield every name of a code cell that does not exist."""
    tokens = TOKEN.findall(cell)
    files = [t for t in tokens if t.endswith(".hpp")]
    words: set[str] = set()
    for file in files:
        if not (HEADERS / file).is_file():
            yield file
            return
        words |= set(re.findall(r"\w+", header(file)))
    for token in filter(is_python, tokens):
        try:
            words |= identifiers(python_object(token)[1])
        except (ImportError, AttributeError):
            yield token
    for token in tokens:
        value = re.fullmatch(r'(?:\w+=)?"([\w-]+)"', token)
        if token in files or is_python(token):
            continue
        if value:
            ok = value[1] in registered()
        elif "::" in token:
            ok = any(declared(token, file) for file in files)
        else:
            ok = token in words or token == "spatial"
        if not ok:
            yield token


def missing_tests(text: str) -> Iterator[str]:
    """Yield every test that a text names and that does not exist."""
    for token in TOKEN.findall(text):
        if match := TEST.match(token):
            file, name = match.groups()
            if not list((ROOT / "tests").rglob(file)) or name not in functions_of(file):
                yield token


def test_every_equation_has_one_row() -> None:
    assert [row[0] for row in ROWS] == [f"({k})" for k in range(1, 125)]
    assert all(len(row) == 5 for row in ROWS)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_names_of_an_equation_exist(row: list[str]) -> None:
    """A meaning, a name in the code or the word none, and at least one test."""
    _, meaning, code, _, test = row
    assert meaning
    assert TOKEN.search(code) or code.startswith("none: ")
    assert list(unknown(code)) == []
    assert any(TEST.match(token) for token in TOKEN.findall(test))
    assert list(missing_tests(test)) == []


def of_core(code: str) -> set[str]:
    """Names of the core in a cell, without their namespaces."""
    return {t.rpartition("::")[2] for t in TOKEN.findall(code) if "::" in t}


def in_a_run(token: str) -> bool:
    """Whether a run may reach a Python name: imports it, or its class, or names the method."""
    module, path = split(token)
    if module not in code_that_runs.modules():
        return False
    if len(path) == 1 and path[0][0].islower():
        return code_that_runs.imported(module, path[0])
    return len(path) == 1 or code_that_runs.named(path[-1])


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row[0])
def test_code_runs_where_it_says(row: list[str]) -> None:
    """Of the code of a run all of the core can be reached; of other code nothing can."""
    _, _, code, where, _ = row
    assert where in ("run", "run, scripts", "scripts", "pictures", "–")
    assert (where == "–") == code.startswith("none: ")
    core, python = of_core(code), set(filter(is_python, TOKEN.findall(code)))
    runs = core & code_that_runs.reached()
    if where == "run":
        assert runs == core
        assert core or any(map(in_a_run, python))
    elif where == "run, scripts":
        assert runs
    else:
        assert not runs
    if where == "pictures":
        assert not any(map(in_a_run, python))
        assert all(split(t)[0] in code_that_runs.in_pictures() for t in python)
    if where == "scripts":
        assert not any(in_a_run(t) for t in python if len(split(t)[1]) == 1)


def test_what_does_not_run_is_seen() -> None:
    """The way in which the column is checked: some that run, and some that only scripts call."""
    reached = code_that_runs.reached()
    assert {"update_pair", "CommittedPoint", "Covariant", "add_residual", "trial"} <= reached
    assert not {"spatial_basis", "convective_velocity", "pull_back_contra"} & reached
    assert not in_a_run("laws.domain.force_domain")
    assert not in_a_run("anisotropy.fields.tensor")
    assert in_a_run("contact.contact.Contact") and in_a_run("surfaces.analytic.Surface.project")


@pytest.mark.parametrize(
    "cell",
    [
        "`law::no_such_thing` in `law/slide.hpp`",
        "`kernel::friction_norm` in `law/slide.hpp`",
        "`law::friction_norm` in `law/nothing.hpp`",
        "`law::friction_norm`",
        "`laws.NoLaw`",
        "`nothing.at_all`",
        '`"no-rule"`',
        "`no_member` of `law::Explicit` in `law/rules/explicit.hpp`",
    ],
)
def test_a_wrong_name_would_be_seen(cell: str) -> None:
    assert list(unknown(cell))


def test_a_wrong_test_would_be_seen() -> None:
    here = Path(__file__).name
    assert list(missing_tests(f"`{here}::test_nothing` `test_nothing.py::test_it`"))
    assert not list(missing_tests(f"`{here}::test_a_wrong_test_would_be_seen`"))


# --- errata ------------------------------------------------------------------------------------


def test_every_erratum_names_its_test() -> None:
    """Each section of the page has a test, and all of them exist."""
    page = (THEORY / "errata.md").read_text()
    assert list(missing_tests(page)) == []
    for section in re.split(r"^### ", page, flags=re.MULTILINE)[1:]:
        own = re.split(r"^## ", section, flags=re.MULTILINE)[0]
        assert any(TEST.match(token) for token in TOKEN.findall(own)), section.splitlines()[0]


def test_links_to_the_errata_have_targets() -> None:
    """Every errata.md#target of the theory pages is a label or a heading there."""
    page = (THEORY / "errata.md").read_text()
    labels = set(re.findall(r"^\(([\w-]+)\)=$", page, re.MULTILINE))
    for heading in re.findall(r"^#+ (.*)$", page, re.MULTILINE):
        labels.add(re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-"))
    for other in THEORY.glob("*.md"):
        wanted = re.findall(r"errata\.md#([\w-]+)\)", other.read_text())
        assert set(wanted) <= labels, other.name


# --- notation ----------------------------------------------------------------------------------


def notation() -> list[list[str]]:
    """Rows of the tables of symbols: symbol, name, file, meaning, dimension."""
    lines = (THEORY / "notation.md").read_text().splitlines()
    rows = [cells(line) for line in lines if line.startswith("|")]
    return [row for row in rows if len(row) == 5 and row[0] != "symbol" and "---" not in row[0]]


SYMBOLS = notation()


@pytest.mark.parametrize("row", SYMBOLS, ids=lambda row: row[1].strip("`"))
def test_name_of_a_symbol_exists(row: list[str]) -> None:
    """Requirement: symbols are identifiers; the file named has it, a member in its type."""
    name, file = row[1].strip("`"), row[2].strip("`")
    if file.endswith(".py"):
        assert name in identifiers(SOURCES / file)
        return
    owner, _, member = name.rpartition("::")
    assert re.search(rf"\b{member}\b", header(file))
    assert not owner or re.search(rf"\b(?:struct|class)\s+{owner}\b", header(file))


def test_symbols_and_names_are_one_to_one() -> None:
    assert len(SYMBOLS) > 60
    for column in (0, 1):
        values = [row[column] for row in SYMBOLS]
        assert len(values) == len(set(values))


def test_every_variable_of_a_state_has_a_symbol() -> None:
    """The fields of a committed point are in the table; `facet` is a number, no symbol."""
    fields = re.findall(r"^\s+FIELD\([\w:]+, (\w+),", header("kernel/state.hpp"), re.M)
    names = {row[1].strip("`").rpartition("::")[2] for row in SYMBOLS}
    assert {"xi", "slip", "status"} <= set(fields)
    assert set(fields) - names == {"facet"}
