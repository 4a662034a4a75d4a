"""What pages name in their text is there: classes, arguments of calls, commands with their options.

Blocks of Python and of case files run (`test_docs_blocks.py`); this is what stands between them.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import re
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli.main import build_parser

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", ROOT / "PACKAGE.md", *sorted((ROOT / "docs").rglob("*.md"))]
PAGES = [page for page in PAGES if not {"_build", "generated"} & set(page.parts)]
PACKAGES = "anisotropy bulk case contact interface laws mesh point results rigid solver surfaces"
REFERENCE = re.compile(r"\{py:\w+\}`~?([\w.]+)`")
INLINE = re.compile(r"(?<!`)`([A-Za-z_][\w.]*\([^`\n]*\))`(?!`)")
COMMAND = re.compile(r"^(?:\$ |srun )?anisocontact (.*?)(?:\s+#.*)?$", re.MULTILINE)


def text_between_blocks(page: Path) -> str:
    return re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)


def found(name: str) -> Any:
    """What a dotted name stands for."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        try:
            here = importlib.import_module(".".join(parts[:count]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[count:]:
            here = getattr(here, attribute)
        return here
    raise ModuleNotFoundError(name)


def callables() -> dict[str, Callable[..., Any]]:
    """What scripts may call, by its name."""
    packages = [importlib.import_module(f"anisocontact.{package}") for package in PACKAGES.split()]
    named = {name: getattr(package, name) for package in packages for name in package.__all__}
    return {name: value for name, value in named.items() if callable(value)}


def calls() -> Iterator[tuple[str, Callable[..., Any], list[str]]]:
    """Calls in the text of what is ours: as written, what is called, its keywords."""
    ours = callables()
    for page in PAGES:
        for written in INLINE.findall(text_between_blocks(page)):
            tree = ast.parse(re.sub(r",\s*\.\.\.(?=\))", "", written), mode="eval")
            for node in ast.walk(tree):
                if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                    keywords = [one.arg for one in node.keywords if one.arg]
                    if node.func.id in ours:
                        yield f"{page.name}: {written}", ours[node.func.id], keywords


def test_names_of_references_exist():
    names = {name for page in PAGES for name in REFERENCE.findall(page.read_text())}
    assert len(names) > 20
    for name in names:
        found(name)


def test_arguments_of_calls_exist():
    every = list(calls())
    assert len(every) > 40
    for written, function, keywords in every:
        parameters = inspect.signature(function).parameters.values()
        if all(one.kind is not one.VAR_KEYWORD for one in parameters):
            assert set(keywords) <= {one.name for one in parameters}, written


def test_commands_of_the_pages_are_understood():
    """Options exist, and example files are where the pages say."""
    pages = [(page.name, line) for page in PAGES for line in COMMAND.findall(page.read_text())]
    assert len(pages) > 15
    for name, line in pages:
        words = [word for word in shlex.split(line) if word != "$more"]
        arguments = build_parser().parse_args(words)
        for word in words:
            if word.startswith("examples/"):
                assert (ROOT / word).is_file(), f"{name}: {word}"
        assert arguments.command is not None
