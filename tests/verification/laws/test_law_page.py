"""The page on the sliding rules shows what the code gives.

Requirement: the numbers of the documentation are asserted. The script that wrote the page runs
again and has to give the same text, whose tables have two to five digits; the paths of the
refinement are deterministic, and rounding moves none of these digits but by chance of a tie, which
would show here.
"""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[3] / "docs"


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location(
        "sliding_rules_page", DOCS / "figures" / "sliding_rules.py"
    )
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def page():
    return (DOCS / "verification" / "laws.md").read_text()


def rows(page, path):
    """Errors by rule of a path in the table of refinement."""
    found = re.findall(rf"^\| {re.escape(path)} \| `(.*?)` \| (.*) \|$", page, re.MULTILINE)
    return {rule: [float(x) for x in cells.split(" | ")] for rule, cells in found}


def test_page_is_what_the_script_gives(script, page):
    assert script.page() == page


@pytest.mark.parametrize("path", ["half circle", "corner, N falling"])
def test_orders_of_refinement(script, page, path):
    """First order, as backward Euler has, of every rule that converges: 0.8 to 1.15 at these steps,
    for the point changes from stick to slip once on the way. `incremental` has no order: its error
    does not fall."""
    table = rows(page, path)
    assert set(table) == {r.label for r in script.RULES}
    for rule, (*errors, order) in table.items():
        if rule == "explicit, incremental":
            assert errors[-1] > 0.9 * errors[0]
        elif rule == "explicit, kuhn-tucker":
            assert errors[-1] < 0.5 * errors[0]
        else:
            assert 0.8 < order < 1.15, rule
            assert errors[-1] < 0.1 * errors[0], rule
