"""docs/theory/glossary.md: what it names exists, and a search of the sources for a term finds it.

Requirement: every class, module, file and folder in the column "where" is there, and one of them
has the term, so that who knows the word of the literature finds the place.
"""

import importlib
import inspect
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/theory/glossary.md").read_text().partition("\n## What other codes")[0]
ROOTS = (ROOT / "src/anisocontact", ROOT / "cpp/include/anisocontact")
ROWS = [
    [cell.strip() for cell in line.strip("|").split("|")]
    for line in PAGE.splitlines()
    if line.startswith("| ") and not line.startswith("| term")
]
WITH_PLACE = [row for row in ROWS if row[2]]
#: Words that no reader of the literature knows, and what stands for them.
RETIRED = {
    r"viscous(ly)? flow|bodies flow": "viscous regularisation",
    r"parts? of (an |one )?increments?|increment is cut into parts": "sub-increment",
    r"inside out": "inverted",
    r"points? that hop": "points that alternate",
    r"\binner forces?\b": "internal force",
    r"\blips?\b": "faces of a crack",
    r"\bCourse\b|\bcourses_of\b": "load curve",
}
PAGES = [p for p in (ROOT / "docs").rglob("*.md") if not {"_build", "generated"} & set(p.parts)]
#: What a rebuild must not lose: the words of the literature.
ASKED = (
    "contact frame",
    "trial state",
    "return mapping",
    "consistent tangent",
    "load factor",
    "active set",
    "primal-dual",
    "predictor",
    "static condensation",
    "node-to-surface",
    "surface-to-surface",
    "mortar",
    "closest point projection",
    "signed gap",
    "Karush-Kuhn-Tucker",
    "Signorini",
    "regularisation",
    "penalty",
    "augmented Lagrangian",
    "Uzawa",
    "elastic slip",
    "elastic traction",
    "stick",
    "slip",
    "associated slip rule",
    "non-associated slip rule",
    "parallel transport",
    "dissipation",
)


def files(where: str) -> list[Path]:
    """The source files of what a cell names.

    Raises:
        AssertionError: It is not there.
    """
    found = []
    for path in re.findall(r"`([a-z_/]+(?:\.[hp]+y?p?|/))`", where):
        (there,) = [root / path for root in ROOTS if (root / path).exists()]
        found += [f for f in there.iterdir() if f.is_file()] if there.is_dir() else [there]
    for name in re.findall(r"\{py:(?:class|func)\}`~?([\w.]+)`", where):
        pytest.importorskip("anisocontact.contact", exc_type=ImportError)
        module, _, last = name.rpartition(".")
        named = getattr(importlib.import_module(module), last)
        file = inspect.getsourcefile(inspect.unwrap(named))
        assert file is not None
        found.append(Path(file))
    return found


@pytest.mark.parametrize("row", WITH_PLACE, ids=lambda row: row[0])
def test_term_is_found_where_the_page_says(row: list[str]) -> None:
    places = files(row[2])
    assert places, row[2]
    terms = [term.strip().lower() for term in re.split(r"[,(]", row[0].rstrip(")"))]
    texts = [
        re.sub(r"\s+(//+ |# )?\s*", " ", file.read_text().lower()).replace("_", " ")
        for file in places
    ]
    assert any(term in text for term in terms for text in texts), terms


def test_every_word_is_explained() -> None:
    terms = "\n".join(row[0] for row in ROWS).lower()
    assert [word for word in ASKED if word.lower() not in terms] == []


@pytest.mark.parametrize("word", RETIRED)
def test_pages_speak_of(word: str) -> None:
    """Words of a private language do not come back: the glossary has the term that is meant."""
    found = [page.name for page in PAGES if re.search(word, " ".join(page.read_text().split()))]
    assert not found, f"{found}: {RETIRED[word]}"
