"""Which code of the core and which modules a solver reaches, from the names in their text.

A definition of the core is reached where the text of one that is reached mentions its name. So
what is reached here may still not run (a name has several meanings, a branch is not taken), but
what is not reached cannot run.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
HEADERS = ROOT / "cpp" / "include" / "anisocontact"
SOURCES = ROOT / "src" / "anisocontact"
BINDINGS = ROOT / "cpp" / "python"
#: Bindings of what a solver calls; the others are functions of scripts and of pictures.
BOUND = ("interface", "facet_interface", "search")
#: Where a run goes through, and where it does not yet, or no more.
ENTRIES = ("case.build", "solver", "contact", "rigid", "interface")
BESIDE = ("results", "point", "base.figure_style", "cli")
NAMED = re.compile(r"\b(?:struct|class|concept|using)\s+(\w+)|\b(\w+)\s*\(")


def blocks(text: str) -> Iterator[str]:
    """Definitions at the level of a namespace, and lines of the preprocessor left out."""
    text = re.sub(r"//[^\n]*|^\s*#[^\n]*", "", text, flags=re.M)
    text = re.sub(r"\bnamespace\s+[\w:]*\s*{", "", text)
    depth, begin = 0, 0
    for at, c in enumerate(text):
        depth += (c == "{") - (c == "}")
        if depth < 0:  # the end of a namespace
            depth, begin = 0, at + 1
        elif depth == 0 and c in "};":
            yield text[begin : at + 1]
            begin = at + 1


@cache
def definitions() -> dict[str, frozenset[str]]:
    """Words of all definitions of the core, by their names."""
    found: dict[str, set[str]] = {}
    for file in (*HEADERS.rglob("*.hpp"), *(ROOT / "cpp" / "src").glob("*.cpp")):
        for block in blocks(file.read_text()):
            head = re.sub(r"template\s*<[^{;]*?>\s*(?=\w)|requires\b[^{;]*", "", block)
            if match := NAMED.search(head):
                name = match[1] or match[2]
                found.setdefault(name, set()).update(re.findall(r"\w+", block))
    return {name: frozenset(words) for name, words in found.items()}


@cache
def reached() -> frozenset[str]:
    """Names of definitions of the core that a solver can reach."""
    todo: list[str] = []
    for file in BINDINGS.iterdir():
        if file.stem in BOUND or file.suffix == ".hpp":
            todo += re.findall(r"\w+", file.read_text())
    seen: set[str] = set()
    while todo:
        name = todo.pop()
        if name not in seen:
            seen.add(name)
            todo += definitions().get(name, ())
    return frozenset(seen & definitions().keys())


def _statements(file: Path) -> Iterator[tuple[str, str | None]]:
    """Modules that a file imports, and the names that it takes from them."""
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield from ((node.module, alias.name) for alias in node.names)


@cache
def _exported(module: str) -> dict[str, str]:
    """Where a package has the names from that it exports."""
    init = SOURCES.joinpath(*module.removeprefix("anisocontact.").split("."), "__init__.py")
    if not init.is_file():
        return {}
    return {name: source for source, name in _statements(init) if name}


def _imports(file: Path) -> Iterator[str]:
    """Modules that a file imports, and names as `module.name` of the module that defines them."""
    for module, name in _statements(file):
        source = _exported(module).get(name or "", module)
        yield source
        if name:
            yield f"{source}.{name}"


def _files(module: str) -> Iterable[Path]:
    path = SOURCES.joinpath(*module.split("."))
    return [p for p in (path.with_suffix(".py"), path / "__init__.py") if p.is_file()]


def _closure(entries: Iterable[str], without: Iterable[str]) -> frozenset[str]:
    todo, seen = list(entries), set()
    while todo:
        module = todo.pop()
        if module in seen or any(f"{module}.".startswith(f"{w}.") for w in without):
            continue
        if not _files(module):
            continue
        seen.add(module)
        for file in _files(module):
            names = (n.removeprefix("anisocontact.") for n in _imports(file) if "anisocontact" in n)
            todo += names
    return frozenset(seen)


@cache
def modules() -> frozenset[str]:
    """Modules of the package that a run imports on its way, without results and pictures."""
    return _closure(ENTRIES, BESIDE)


@cache
def in_pictures() -> frozenset[str]:
    """Modules that pictures and reports import besides."""
    drawn = ("point.pictures", "results.report.curves", "results.report.maps")
    return _closure(drawn, ()) - modules()


@cache
def imported(module: str, function: str) -> bool:
    """Whether another module of a run imports a function, or its own one calls it."""
    full = f"anisocontact.{module}.{function}"
    others = (f for m in modules() if m != module for f in _files(m))
    if any(full in _imports(file) for file in others):
        return True
    trees = (ast.parse(file.read_text()) for file in _files(module))
    return any(
        isinstance(n, ast.Name) and n.id == function for tree in trees for n in ast.walk(tree)
    )


@cache
def named(attribute: str) -> bool:
    """Whether a module of a run has an attribute of this name taken of something."""
    trees = (ast.parse(file.read_text()) for m in modules() for file in _files(m))
    return any(
        isinstance(n, ast.Attribute) and n.attr == attribute for t in trees for n in ast.walk(t)
    )
