"""Mutated case files: an error in one line each, or a case; never anything else."""

from __future__ import annotations

import copy
import tomllib
from datetime import date
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.case import CaseError, validate
from anisocontact.cli import main

CASE = Path(__file__).with_name("small_block.toml").read_text()
Place = tuple[Any, ...]

VALUES = st.one_of(
    st.floats(),
    st.integers(-3, 8),
    st.just(10**400),
    st.booleans(),
    st.text(max_size=8),
    st.sampled_from(["auto", "free", "block.top", "plate", "maximum-dissipation", "polar"]),
    st.just(date(1979, 5, 27)),
    st.lists(st.floats() | st.integers(-3, 8), max_size=4),
    st.dictionaries(st.text(max_size=5), st.integers(-3, 8), max_size=2),
)


def places(node: Any, at: Place = ()) -> list[Place]:
    """Paths of everything in nested tables and lists."""
    found = [at] if at else []
    if isinstance(node, dict | list):
        for key, child in node.items() if isinstance(node, dict) else enumerate(node):
            found += places(child, (*at, key))
    return found


PLACES = places(tomllib.loads(CASE))


@st.composite
def mutated(draw: st.DrawFn) -> dict[str, Any]:
    """The case with up to three values changed, left out or under another key."""
    data = copy.deepcopy(tomllib.loads(CASE))
    for place in draw(st.lists(st.sampled_from(PLACES), min_size=1, max_size=3, unique=True)):
        parent: Any = data
        try:
            for key in place[:-1]:
                parent = parent[key]
            old = parent[place[-1]]
        except (KeyError, IndexError, TypeError):
            continue  # an earlier change took it away
        if not isinstance(parent, dict | list):
            continue
        kind = draw(st.sampled_from(["change", "leave out", "rename"]))
        if kind == "change":
            parent[place[-1]] = draw(VALUES)
            continue
        del parent[place[-1]]
        if kind == "rename" and isinstance(parent, dict):
            parent[draw(st.text(max_size=6))] = old
    return data


@pytest.mark.parametrize("given", [1e300, 1e60, 1e-60, 5e-324])
@pytest.mark.filterwarnings("error")
def test_numbers_that_cannot_be_computed_with(given):
    """Requirement: each number whose products overflow or vanish is a line that names it; a list
    counts by its largest number."""
    tables = tomllib.loads(CASE)
    for place in PLACES:
        data = copy.deepcopy(tables)
        parent: Any = data
        for key in place[:-1]:
            parent = parent[key]
        if not isinstance(parent[place[-1]], int | float):
            continue
        parent[place[-1]] = given
        if given < 1.0 and isinstance(parent, list) and max(parent) >= 1e-50:
            continue
        with pytest.raises(CaseError) as caught:
            validate(data)
        assert place[0] in str(caught.value)


@settings(max_examples=400, deadline=None)
@given(data=mutated())
def test_mutated_tables(data):
    """Whatever stands in the file, the answer is a case or lines that each name something."""
    try:
        validate(data)
    except CaseError as error:
        assert error.errors
        for one in error.errors:
            assert str(one).isprintable()
            assert len(str(one)) < 1000


@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    at=st.integers(0, len(CASE) - 1),
    cut=st.integers(0, 30),
    put=st.text(max_size=10) | st.sampled_from(["\n", "=", "[", '"', "nan", "{", "-"]),
)
def test_mutated_text(tmp_path, capsys, at, cut, put):
    """The command never shows a traceback and writes nothing of its own."""
    path = tmp_path / "case.toml"
    path.write_text(CASE[:at] + put + CASE[at + cut :], encoding="utf-8", newline="")
    code = main(["check", str(path)])
    captured = capsys.readouterr()
    assert code in (0, 2), captured.err
    assert (code == 2) == bool(captured.err)
    assert all(line.startswith("error: ") for line in captured.err.splitlines())
    assert [entry.name for entry in tmp_path.iterdir()] == ["case.toml"]


@settings(max_examples=100, deadline=None)
@given(data=st.recursive(VALUES, lambda inner: st.dictionaries(st.text(max_size=4), inner)))
def test_anything_at_all(data):
    """Not even a table."""
    try:
        validate(data)
    except InputError:
        return
    pytest.fail("no case is as small as this")
