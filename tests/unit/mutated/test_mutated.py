"""A thousand cases and meshes with mistakes: a clean result or lines that say what is wrong.

Requirement: never a traceback, a hang or a partial folder; exit codes hold. What is still a case
is run to its end. A failure names its seed and number, which make the same case again.
"""

from __future__ import annotations

import random

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

#: Seeds of the slow tests and what each makes: 600 cases, 300 meshes and 100 texts in all.
SEEDS = range(1, 21)
EACH = {"case": 30, "mesh": 15, "text": 5}
#: What the fast tests make of seed 0, and the tests that share it.
FEW, PARTS = {"case": 24, "mesh": 12, "text": 8}, 4


@pytest.fixture(params=EACH)
def kind(request):
    """What has the mistake."""
    return request.param


def test_the_whole_ones_are_done(mutated):
    for name in mutated.names:
        assert mutated.run(mutated.whole_case(name)) == 0, name


@pytest.mark.parametrize("part", range(PARTS))
def test_a_few(mutated, kind, part):
    for number in range(part, FEW[kind], PARTS):
        mutated.check(kind, 0, number)


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_a_thousand(mutated, kind, seed):
    for number in range(EACH[kind]):
        mutated.check(kind, seed, number)


def test_the_same_again(mutated):
    """A seed and a number are one case."""
    for kind in EACH:
        assert mutated.made(kind, 3, 4) == mutated.made(kind, 3, 4)
    assert mutated.made("case", 3, 4) != mutated.made("case", 3, 8)


@pytest.mark.parametrize("kind_of_file", ["folder", "missing", "binary", "empty", "unreadable"])
@pytest.mark.parametrize("which", ["case.toml", "a.msh"])
def test_files_that_are_none(mutated, tmp_path, which, kind_of_file):
    """A case or a mesh that cannot be read: one line that names the file."""
    mutated.place(tmp_path)
    path = tmp_path / which
    path.unlink()
    if kind_of_file == "folder":
        path.mkdir()
    elif kind_of_file == "binary":
        path.write_bytes(random.Random(1).randbytes(3000))
    elif kind_of_file == "empty":
        path.touch()
    elif kind_of_file == "unreadable":
        path.symlink_to(path)  # root may read any file; nobody reads a link to itself
    code, error = mutated.run_in(tmp_path)
    assert code == 2
    assert which in error or "missing" in error


def test_a_mistake_that_shows_on_the_way(mutated):
    """A step that begins where an earlier one has not led is a run that stops."""
    data = mutated.whole_case("held")
    data["step"][1]["rotation"] = {"tube.top": {"axis": [0, 0, 1], "angle_deg": 1}}
    assert mutated.run(data) == 3


def test_a_displacement_beyond_all_bounds(mutated):
    """It stops the run and is no warning of NumPy, or is refused where it is out of range."""
    data = mutated.whole_case("pair")
    for size, code in ((4e49, 3), (4e80, 2)):
        data["step"][1]["displacement"]["upper.top"]["x"] = size
        assert mutated.run(data) == code
