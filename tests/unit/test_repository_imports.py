"""A package uses those below it and never one that uses it; no file uses one that uses it."""

import ast
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

import pytest

SOURCES = Path(__file__).parents[2] / "src" / "anisocontact"
#: From the bottom up, as `docs/dev/architecture.md` draws them.
PACKAGES = (
    *("base", "surfaces", "anisotropy", "laws", "interface", "point"),
    *("rigid", "mesh", "bulk", "contact", "solver", "results", "case", "cli"),
)
#: The same within the solver.
SOLVER = ("terms", "system", "strategies", "stepping")
MOST_PACKAGES = 14


def name_of(path: Path) -> str:
    """Dotted name of the module of a file."""
    parts = path.relative_to(SOURCES.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


@cache
def modules() -> Mapping[str, Path]:
    return {name_of(path): path for path in sorted(SOURCES.rglob("*.py"))}


def imported(path: Path) -> Iterator[str]:
    """Modules of the package that a file imports, wherever in it, also for types alone."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            for alias in node.names:
                whole = f"{node.module}.{alias.name}"
                yield whole if whole in modules() else node.module
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


@cache
def uses() -> Mapping[str, set[str]]:
    """Modules of the package that each module uses."""
    return {
        name: {m for m in imported(path) if m in modules()} - {name, "anisocontact"}
        for name, path in modules().items()
    }


def packages() -> Mapping[str, set[str]]:
    """Packages that each package uses."""
    found: dict[str, set[str]] = defaultdict(set)
    for name, used in uses().items():
        package = [*name.split("."), ""][1]
        found[package] |= {m.split(".")[1] for m in used} - {package}
    return found


def circles(graph: Mapping[str, set[str]]) -> set[frozenset[str]]:
    """Sets of more than one name that reach each other."""

    def reached(start: str) -> set[str]:
        seen: set[str] = set()
        todo = [start]
        while todo:
            todo += (new := graph[todo.pop()] - seen)
            seen |= new
        return seen

    closure = {name: reached(name) for name in graph}
    return {
        frozenset(m for m in closure[name] if name in closure[m])
        for name in graph
        if name in closure[name]
    }


def test_packages_are_few_and_known() -> None:
    """A new package is drawn in the architecture page before it is built."""
    present = {p.name for p in SOURCES.iterdir() if (p / "__init__.py").exists()}
    assert present == set(PACKAGES)
    assert len(present) <= MOST_PACKAGES
    assert {p.stem for p in SOURCES.glob("*.py")} == {"__init__", "__main__"}


def test_no_arrow_points_up() -> None:
    for package, used in packages().items():
        if package in PACKAGES:
            above = set(PACKAGES[PACKAGES.index(package) + 1 :])
            assert not used & above, f"{package} uses {sorted(used & above)} above it"


def test_no_arrow_points_up_in_the_solver() -> None:
    for i, package in enumerate(SOLVER):
        own, above = f"anisocontact.solver.{package}.", SOLVER[i + 1 :]
        used = {m for name, them in uses().items() if name.startswith(own) for m in them}
        wrong = {
            m for m in used if m.startswith("anisocontact.solver.") and m.split(".")[2] in above
        }
        assert not wrong, f"{package} uses {sorted(wrong)} above it"


def test_no_circle_of_files() -> None:
    """Also of files that name each other only for their types: one is in the wrong package."""
    assert [sorted(circle) for circle in circles(uses())] == []


@pytest.mark.parametrize(
    ("graph", "found"),
    [
        ({"a": {"b"}, "b": {"c"}, "c": set()}, set()),
        ({"a": {"b"}, "b": {"c"}, "c": {"b", "d"}, "d": set()}, {frozenset({"b", "c"})}),
    ],
)
def test_circles_are_seen(graph: Mapping[str, set[str]], found: set[frozenset[str]]) -> None:
    assert circles(graph) == found


def test_points_know_nothing_of_results() -> None:
    assert {"solver", "contact", "mesh"} <= packages()["case"]
    assert "results" not in packages()["point"]


def test_paths_of_before_name_those_of_today() -> None:
    """A module that has moved is imported by its old path, with a warning that names the new."""
    code = (
        "import warnings; warnings.simplefilter('error', DeprecationWarning)\n"
        "try:\n    import anisocontact.errors\n"
        "except DeprecationWarning as text:\n    print(text)\n"
        "warnings.simplefilter('ignore')\n"
        "from anisocontact.base.import_hooks import MOVED\n"
        "import importlib, anisocontact.base.errors, anisocontact.errors\n"
        "assert anisocontact.errors.InputError is anisocontact.base.errors.InputError\n"
        "for old, new in MOVED.items():\n"
        "    if 'fenicsx' not in new:\n"
        "        there = set(vars(importlib.import_module(old)))\n"
        "        assert {n for n in vars(importlib.import_module(new)) if n[:2] != '__'} <= there\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=SOURCES.parent
    )
    moved = "anisocontact.errors has moved: import from anisocontact.base.errors"
    assert done.stdout.strip() == moved


def test_laws_of_before_are_those_of_today() -> None:
    """Classes of laws by their names of before, also by the path of before, with a warning."""
    code = (
        "import warnings; warnings.simplefilter('ignore', DeprecationWarning)\n"
        "import numpy as np\n"
        "from anisocontact.interface import PairLaw, PythonInterface\n"
        "from anisocontact.python_pair import PythonPairLaw\n"
        "from anisocontact.laws import Adhesion, Friction, NormalLaw\n"
        "from anisocontact.surfaces import make_surface\n"
        "class Law:\n    internal, update = 2, None\n"
        "normal = NormalLaw(penalty=1.0)\n"
        "plane = make_surface('plane', point=(0, 0, 0), normal=(0, 0, 1))\n"
        "print(PairLaw(normal, Adhesion(stiffness=1.0), Friction(coefficients=0.3)).evolution)\n"
        "print(PythonPairLaw(normal, Law(), directions_on='slave').carried[0].on)\n"
        "print(PythonInterface(plane, normal, Law(), threads=1).dtype['internal'].shape)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=SOURCES.parent
    )
    assert done.stdout.split() == ["transport", "slave", "(2,)"]


#: Take longer to be imported than a small case to be solved: imported where they are used.
SLOW = ("scipy.", "pyvista", "vtk", "vtkmodules", "rich", "meshio", "h5py", "gmsh", "pandas")
#: Programs and pictures, which are imported late themselves.
LATE = (
    "anisocontact.results.report",
    "anisocontact.results.scene",
    "anisocontact.results.solids",
    "anisocontact.point.pictures",
)


def test_slow_packages_are_imported_where_they_are_used() -> None:
    """`import scipy` and `scipy.sparse.csr_array` where it is needed: SciPy imports it then."""
    early = {
        f"{name}: {module}"
        for name, path in modules().items()
        if not name.startswith(LATE)
        for node in ast.parse(path.read_text()).body
        for module in (
            [alias.name for alias in node.names]
            if isinstance(node, ast.Import)
            else [f"{node.module}." if node.module == "scipy" else str(node.module)]
            if isinstance(node, ast.ImportFrom)
            else []
        )
        if f"{module}.".startswith(tuple(s if s.endswith(".") else f"{s}." for s in SLOW))
        and module != "scipy"
    }
    assert early == set()
