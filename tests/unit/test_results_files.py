"""Files of a results folder: whole or not there, ours or untouched."""

from __future__ import annotations

import itertools
from types import SimpleNamespace

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.results import Results
from anisocontact.results.files import OWN, Disk, check_folder, clear, replacing, write_text
from anisocontact.results.history import HistoryTable, flat, read_history


def test_a_file_is_replaced_at_once_or_stays(tmp_path):
    path = tmp_path / "summary.json"
    write_text(path, "old")
    with pytest.raises(RuntimeError), replacing(path) as draft:
        draft.write_text("half of the n")
        raise RuntimeError
    assert path.read_text() == "old"
    assert [entry.name for entry in tmp_path.iterdir()] == ["summary.json"]
    write_text(path, "new")
    assert path.read_text() == "new"


def test_check_folder(tmp_path):
    check_folder(tmp_path / "none")
    check_folder(tmp_path)
    (tmp_path / "thesis.tex").touch()
    for overwrite in (False, True):
        with pytest.raises(InputError, match=r"holds no run \(it has thesis.tex\)"):
            check_folder(tmp_path, overwrite)
    (tmp_path / "run.log").touch()
    with pytest.raises(InputError, match="--overwrite"):
        check_folder(tmp_path)
    check_folder(tmp_path, overwrite=True)
    with pytest.raises(InputError, match="Not a directory"):
        check_folder(tmp_path / "run.log")


def test_a_folder_that_cannot_be_made(tmp_path, monkeypatch):
    """Known before anything is meshed; a superuser may write everywhere, so the answer is given."""
    monkeypatch.setattr("anisocontact.results.files.os.access", lambda *_: False)
    with pytest.raises(InputError, match="cannot be made: no permission to write in") as caught:
        check_folder(tmp_path / "new" / "results")
    assert str(tmp_path) in str(caught.value)
    assert not (tmp_path / "new").exists()


def test_a_table_that_is_gone_is_not_begun_without_its_header(tmp_path):
    """Requirement: removed while the run goes on, it is an error of the disk: its rows are lost."""
    path = tmp_path / "history.csv"
    history = HistoryTable(path)
    history.append({"step": "press", "time": 1.0})
    path.unlink()
    with pytest.raises(FileNotFoundError):
        history.append({"step": "press", "time": 2.0})
    assert not path.exists()


def test_clear_removes_what_a_run_wrote_and_nothing_else(tmp_path):
    for name in OWN:
        (tmp_path / name).mkdir() if "." not in name else (tmp_path / name).touch()
    (tmp_path / "fields" / "0000.vtu").touch()
    (tmp_path / "thesis.tex").touch()
    outside = tmp_path.parent / "outside"
    outside.mkdir()
    (outside / "kept").touch()
    (tmp_path / "pictures").rmdir()
    (tmp_path / "pictures").symlink_to(outside)
    clear(tmp_path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["thesis.tex"]
    assert (outside / "kept").exists()


def test_flat_names():
    nested = {"a": {"b": 1}, "c": [{"f": [1.0, 2.0, 3.0]}, {"f": [0.0, 0.0, 4.0]}], "d": [1.0, 2.0]}
    assert dict(flat(nested)) == {
        "a.b": 1,
        "c.0.f.x": 1.0,
        "c.0.f.y": 2.0,
        "c.0.f.z": 3.0,
        "c.1.f.x": 0.0,
        "c.1.f.y": 0.0,
        "c.1.f.z": 4.0,
        "d.0": 1.0,
        "d.1": 2.0,
    }


def test_history_reads_back_bit_for_bit(tmp_path):
    """Every number is written with as many digits as it needs to be the same number again."""
    values = np.random.default_rng(7).normal(size=(5, 3)) * 10.0 ** np.arange(-8, 7)[:15].reshape(
        5, 3
    )
    history = HistoryTable(tmp_path / "history.csv")
    for i, row in enumerate(values):
        history.append({"step": "drag, along x", "increment": i, "force": row.tolist()})
    table = read_history(tmp_path / "history.csv")
    assert table["step"].tolist() == ["drag, along x"] * 5
    assert table["increment"].tolist() == [0, 1, 2, 3, 4]
    assert np.array_equal(np.column_stack([table[f"force.{a}"] for a in "xyz"]), values)


def test_history_can_be_read_while_a_row_is_written(tmp_path):
    path = tmp_path / "history.csv"
    history = HistoryTable(path)
    history.append({"step": "a", "time": 1.0})
    with path.open("a") as file:
        file.write("a,2.")
    assert read_history(path)["time"].tolist() == [1.0]
    path.write_text("step,ti")
    assert read_history(path) == {}
    path.write_text("step,time\n")
    assert read_history(path)["time"].tolist() == []


def test_history_goes_on_with_other_columns(tmp_path):
    """Requirement: steps and resultants may be added to a run that goes on, and be taken out; no
    value of any of them is lost, and a run that is killed before its next checkpoint finds the
    rows of the one before in the table that has got columns since."""
    path = tmp_path / "history.csv"
    history = HistoryTable(path)
    history.append({"step": "a", "cut": 1.5, "top": 2.5})
    state = history.state()
    history.append({"step": "lost", "cut": 0.0, "top": 0.0})

    def goes_on(step: str) -> dict[str, list[object]]:
        again = HistoryTable(path)
        again.resume(state)
        again.append({"step": step, "top": 3.5, "right": 4.5})
        assert again.state()["size"] == path.stat().st_size
        return {name: column.tolist() for name, column in read_history(path).items()}

    for step in ("b", "c"):
        table = goes_on(step)
        assert list(table) == ["step", "cut", "top", "right"]
        assert table["step"] == ["a", step]
        np.testing.assert_equal(table["cut"], [1.5, np.nan])
        np.testing.assert_equal(table["right"], [np.nan, 4.5])
        assert table["top"] == [2.5, 3.5]


def test_results_of_a_folder_without_any(tmp_path):
    with pytest.raises(InputError, match="holds no results"):
        Results(tmp_path)


@pytest.mark.parametrize(("left", "rows"), [(None, 0), (0, 0), (1, 0), (2, 1)])
def test_a_table_that_has_lost_rows_does_not_go_on(tmp_path, left, rows):
    """As after a power cut; cut to its size the file had got zeros for what it lacks."""
    path = tmp_path / "history.csv"
    table = HistoryTable(path)
    for time in (1.0, 2.0):
        table.append({"time": time})
    lines = path.read_text().splitlines(keepends=True)
    if left is None:
        path.unlink()
    else:
        path.write_text("".join(lines[:left]))
    with pytest.raises(InputError, match=f"history.csv' has {rows} rows, .* written 2: put "):
        HistoryTable(path).resume(table.state())
    path.write_text("".join(lines))
    HistoryTable(path).resume(table.state())
    assert path.read_text().splitlines(keepends=True) == lines


def test_fields_of_a_time_that_a_sum_of_steps_meets_to_rounding(fe, tmp_path):
    """Requirement: fields are written at a time in `times` that an increment ends at.

    Eight steps of 0.1 end at 0.7999999999999999, which is the 0.8 of a user: by rounding alone the
    fields of the increment after it would be taken for those of this time.
    """
    from anisocontact.results.fields import FieldFiles
    from anisocontact.results.output_options import OutputOptions
    from anisocontact.solver import Step

    steps = [Step(f"s{k}", 1, duration=0.1) for k in range(9)]
    options = OutputOptions(steps=["s0"], times=[0.8])
    fields = FieldFiles(tmp_path, Disk(None), steps, {}, options)
    written, ends = [], list(itertools.accumulate([0.0] + [step.duration for step in steps]))
    fields.write = written.append
    for k in range(9):
        accepted = SimpleNamespace(step_index=k, increment=1, done=1.0, event="", time=ends[k + 1])
        fields.accept(accepted, ends[k])
    assert ends[8] != 0.8
    assert written == [ends[1], ends[8]]
