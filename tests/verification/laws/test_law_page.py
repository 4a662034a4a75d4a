"""The page on the sliding rules shows what the code gives.

Requirement: the numbers of the documentation are asserted. The script that wrote the page runs
again; its text has to be the same and its numbers, too, to one unit of the last digit shown. The
paths of the refinement are deterministic, but the history `kuhn-tucker` lets roundings decide
whether a force that lies on the ellipse sticks, which is seen in the second digit.
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


NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]\d+)?")


def last_digit(number):
    """One unit of the last digit of a printed number."""
    mantissa, _, exponent = number.partition("e")
    return 10.0 ** (int(exponent or 0) - len(mantissa.partition(".")[2]))


def test_page_is_what_the_script_gives(script, page):
    computed = script.page()
    assert NUMBER.split(computed) == NUMBER.split(page)
    for a, b in zip(NUMBER.findall(computed), NUMBER.findall(page), strict=True):
        assert abs(float(a) - float(b)) <= 1.01 * last_digit(b), (a, b)


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
