"""Sectors with cyclic symmetry: what is refused or told, and what they are free to do."""

from __future__ import annotations

import re
from typing import Any

import pytest
from tests.verification.test_cyclic import STEEL, faces, ring

from anisocontact.base.errors import InputError
from anisocontact.solver import CyclicSymmetry, Problem, Solver, Step


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ({"sectors": 1}, "sectors: 1 given, a whole number >= 2 needed"),
        ({"sectors": 7}, "no facet of 'ring.end' lies within|both faces have to cover each other"),
        ({"point": (0.1, 0, 0)}, "both faces have to cover each other|no facet"),
        ({"slave": "ring.top"}, "no facet|both faces have to cover each other"),
    ],
)
def test_mistakes_of_the_sector(given: dict[str, Any], line: str):
    """Requirement: one line that says what is wrong, before the run."""
    wanted: Any = {"slave": "ring.end", "master": "ring.start", "sectors": 6} | given
    model = ring(6)
    with pytest.raises(InputError) as refused:
        sector = CyclicSymmetry(**wanted)
        Problem(model, {"ring": STEEL}, cyclic=[sector])
    assert re.search(line, str(refused.value))


@pytest.mark.parametrize(
    ("held", "line"),
    [
        ({"ring.top": {"x": 0.0, "z": 0.0}}, "only one component across the axis z is held"),
        ({"ring.top": {"x": 0.1, "y": 0.0, "z": 0.0}}, "other prescribed motions on the slave"),
        ({"ring.start": {"x": 0.0, "y": 0.0, "z": 0.0}}, "other prescribed motions on the slave"),
    ],
    ids=["sideways", "moved", "one face"],
)
def test_supports_that_are_not_those_of_a_sector(held: dict[str, Any], line: str):
    """Requirement: what is not the same in every sector is refused in one line."""
    problem = Problem(ring(6), {"ring": STEEL}, cyclic=faces(6))
    with pytest.raises(InputError, match=line):
        Solver(problem, [Step("hold", 1, held)])


def test_what_a_sector_is_free_to_do():
    """Requirement: a sector held by nothing is free along and about its axis alone, and said so."""
    problem = Problem(ring(6), {"ring": STEEL}, cyclic=faces(6))
    with pytest.raises(InputError, match="ring") as refused:
        Solver(problem, [Step("heave", 1, {"ring.top": {"z": 0.1}})])
    assert "turn" in str(refused.value) or "about" in str(refused.value)
    held = {"ring.top": {"x": 0.0, "y": 0.0, "z": 0.1}}
    Solver(problem, [Step("hold", 1, held)])
