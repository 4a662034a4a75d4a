"""The documentation: every page is reachable, every tutorial runs, every reference page is made."""

import argparse
import fnmatch
import importlib
import math
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
TOCTREE = re.compile(r"```\{toctree\}\n(.*?)```", re.DOTALL)
NUMBERS = {"items": {"type": "number"}}
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


TABLE = re.compile(r"(?:^\|.*\n)+", re.MULTILINE)
RULE_OF_TABLE = re.compile(r"\|(?: *:?-+:? *\|)+")


def test_every_table_has_a_heading() -> None:
    """Rows behind an empty line are no table: they would be shown as text with bars."""
    found = []
    for page in sorted(pages()):
        for table in TABLE.finditer((DOCS / f"{page}.md").read_text()):
            rows = table[0].splitlines()
            if len(rows) < 2 or not RULE_OF_TABLE.fullmatch(rows[1]):
                found.append(f"{page}: {rows[0]}")
    assert found == []


WRITTEN = [ROOT / "README.md", *sorted(DOCS.glob("tutorials/*.md"))]
TUTORIALS = [page for page in WRITTEN if PYTHON_BLOCK.search(page.read_text())]


@pytest.mark.parametrize("page", TUTORIALS, ids=lambda p: p.stem)
def test_page_runs(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The Python blocks of a page run from top to bottom in an empty folder."""
    blocks = PYTHON_BLOCK.findall(page.read_text())
    monkeypatch.chdir(tmp_path)
    exec(compile("\n".join(blocks), str(page), "exec"), {"__name__": "__main__"})


@pytest.fixture
def extension(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], ModuleType]:
    """Import a module of the documentation's extensions."""
    pytest.importorskip("sphinx")
    monkeypatch.syspath_prepend(str(DOCS / "_ext"))
    return importlib.import_module


def test_case_page_shows_places_bounds_and_defaults(
    extension: Callable[[str], ModuleType],
) -> None:
    schema = {
        "properties": {
            "body": {"additionalProperties": {"$ref": "#/$defs/Body"}},
            "pair": {"type": "array", "items": {"$ref": "#/$defs/Pair"}},
        },
        "required": ["body"],
        "$defs": {
            "Body": {
                "properties": {
                    "E": {"type": "number", "exclusiveMinimum": 0, "description": "a | b"},
                    "on": {"type": "boolean", "default": True},
                    "axis": {"type": "array", "minItems": 3, "maxItems": 3} | NUMBERS,
                    "turn": {"type": "number", "default": math.degrees(math.radians(30.0))},
                    "pairs": {
                        "type": "array",
                        "items": {"anyOf": [{"type": "number"}, {"type": "array"} | NUMBERS]},
                    },
                }
            },
            "Pair": {"properties": {"law": {"anyOf": [{"$ref": "#/$defs/Soft"}, {"const": "no"}]}}},
            "Soft": {"properties": {"model": {"const": "soft"}}},
        },
    }
    page = extension("case_reference").CaseReference(schema).page()
    assert "| `body` | by name: [table](#body) | required |" in page
    assert "## `body.NAME`\n" in page
    assert r"| `E` | number > 0 |  | a \| b |" in page
    assert "| `on` | boolean | `true` |" in page
    assert "| `axis` | list of 3: number |" in page
    assert "| `turn` | number | `30.0` |" in page
    assert "| `pairs` | list of (number or list of number) |" in page
    assert '| `law` | [`"soft"`](#soft) or `"no"` |' in page
    assert '## `pair[].law`: `"soft"`\n' in page


def test_command_page_shows_every_subcommand(extension: Callable[[str], ModuleType]) -> None:
    parser = argparse.ArgumentParser("tool", description="A tool.")
    run = parser.add_subparsers().add_parser("run", description="Solve.")
    run.add_argument("case", help="the case")
    run.add_argument("-o", "--output", metavar="DIR", default="out", help="into (%(default)s)")
    page = extension("reference_pages").command_page(parser)
    assert "## run\n\nSolve." in page
    assert "$ tool run [-h] [-o DIR] case" in page
    assert "| `case` | the case |" in page
    assert "| `-o, --output DIR` | into (out) |" in page


def dead_links(site: Path) -> list[str]:
    """What the script that `make docs` calls finds."""
    script = str(ROOT / "tools" / "dead_links.py")
    command = [sys.executable, script, str(site)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == bool(done.stderr), done.stderr
    return done.stderr.splitlines()


def test_dead_links_are_found(tmp_path: Path) -> None:
    (tmp_path / "sub").mkdir()
    links = ["sub/", "sub/index.html#here", "#top", "https://example.org/x", "sub/a%20b.txt"]
    dead = ["none.html", "sub/index.html#there", "#bottom", "img/x.png"]
    anchors = "".join(f'<a href="{link}">x</a>' for link in [*links, *dead])
    (tmp_path / "index.html").write_text(f'<p id="top">{anchors}</p>')
    (tmp_path / "sub" / "index.html").write_text('<a name="here"></a>')
    (tmp_path / "sub" / "a b.txt").touch()
    assert dead_links(tmp_path) == [
        f"error: dead link: index.html: {link}" for link in sorted(dead)
    ]


@pytest.mark.slow
def test_site_builds_without_warnings(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", str(DOCS), str(tmp_path)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result.stderr
    assert dead_links(tmp_path) == []
