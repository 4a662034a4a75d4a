"""The documentation: every page is reachable, every tutorial runs, every reference page is made."""

import argparse
import fnmatch
import importlib.util
import re
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
TOCTREE = re.compile(r"```\{toctree\}\n(.*?)```", re.DOTALL)
PYTHON_BLOCK = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)


def pages() -> set[str]:
    """Return the names of all written pages; generated ones belong to the build."""
    found = (path.relative_to(DOCS).with_suffix("") for path in DOCS.rglob("*.md"))
    return {p.as_posix() for p in found if not {"_build", "generated"} & set(p.parts)}


def children(page: str, known: set[str]) -> set[str]:
    """Return the pages that the toctrees of a page name, globs resolved."""
    entries: list[str] = []
    for body in TOCTREE.findall((DOCS / f"{page}.md").read_text()):
        entries += [line for line in body.split() if not line.startswith(":")]
    folder = f"{Path(page).parent.as_posix()}/" if "/" in page else ""
    patterns = [f"{folder}{entry}" for entry in entries]
    return {name for name in known for pattern in patterns if fnmatch.fnmatch(name, pattern)}


def test_every_page_is_in_a_toctree() -> None:
    known = pages()
    reached, todo = set[str](), {"index"}
    while todo:
        page = todo.pop()
        reached.add(page)
        todo |= children(page, known) - reached
    assert known - reached == set()


WRITTEN = [ROOT / "README.md", *sorted(DOCS.glob("tutorials/*.md"))]
TUTORIALS = [page for page in WRITTEN if PYTHON_BLOCK.search(page.read_text())]


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda p: p.stem)
def test_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The Python blocks of a page run from top to bottom in an empty folder."""
    blocks = PYTHON_BLOCK.findall(page.read_text())
    monkeypatch.chdir(tmp_path)
    exec(compile("\n".join(blocks), str(page), "exec"), {"__name__": "__main__"})


@pytest.fixture
def reference() -> ModuleType:
    pytest.importorskip("sphinx")
    path = DOCS / "_ext" / "reference_pages.py"
    spec = importlib.util.spec_from_file_location("reference_pages", path)
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_case_page_shows_keys_bounds_and_defaults(reference: ModuleType) -> None:
    schema = {
        "description": "A case.",
        "properties": {"body": {"$ref": "#/$defs/Body"}, "note": {"type": "string", "default": ""}},
        "required": ["body"],
        "$defs": {
            "Body": {
                "properties": {
                    "E": {"type": "number", "exclusiveMinimum": 0, "description": "a | b"},
                    "kind": {"enum": ["x", "y"], "default": "x"},
                    "size": {
                        "type": "array",
                        "items": {"type": "number"},
                        "minItems": 3,
                        "maxItems": 3,
                    },
                }
            }
        },
    }
    page = reference.case_page(schema)
    assert "| `body` | [Body](#body) | required |" in page
    assert '| `note` | string | `""` |' in page
    assert r"| `E` | number > 0 |  | a \| b |" in page
    assert '| `kind` | `"x"`, `"y"` | `"x"` |' in page
    assert "| `size` | list of 3 number |" in page


def test_command_page_shows_every_subcommand(reference: ModuleType) -> None:
    parser = argparse.ArgumentParser("tool", description="A tool.")
    run = parser.add_subparsers().add_parser("run", description="Solve.")
    run.add_argument("case", help="the case")
    run.add_argument("-o", "--output", metavar="DIR", default="out", help="into (%(default)s)")
    page = reference.command_page(parser)
    assert "## run\n\nSolve." in page
    assert "$ tool run [-h] [-o DIR] case" in page
    assert "| `case` | the case |" in page
    assert "| `-o, --output DIR` | into (out) |" in page
