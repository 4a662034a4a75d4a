"""The command `report`: folders that are whole, broken, or of a run that goes on."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main


@pytest.fixture
def case(tmp_path, unpictured):
    """The small case in a folder of its own."""
    path = tmp_path / "case.toml"
    path.write_text(unpictured)
    return path


@pytest.mark.parametrize("kind", ["none", "empty", "damaged", "trace"])
def test_report_of_no_results_is_one_line(capsys, tmp_path, kind):
    folder = tmp_path / "out"
    if kind != "none":
        folder.mkdir()
    if kind == "damaged":
        (folder / "summary.json").write_text("{")
    if kind == "trace":
        (folder / "trace.csv").write_text("")
    assert main(["report", str(folder)]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: ")
    assert str(folder) in error
    assert len(error.splitlines()) == 1


@pytest.fixture
def quick_pictures(monkeypatch):
    """Pictures in space by matplotlib, which is quicker for a body of a few cells."""
    from anisocontact.results.report import shape

    monkeypatch.setattr(shape, "start_vtk", lambda *_: None)


def test_a_picture_that_the_disk_has_no_room_for_is_an_error():
    """Requirement: no empty picture stands in a report without a word, as VTK leaves one."""
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full")
    code = (
        "from anisocontact.results.scene import Scene; scene = Scene(); scene.begin(60, 40)\n"
        "try: scene.write('/dev/full')\n"
        "except OSError as error: print(error.strerror)"
    )
    environment = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkEGLRenderWindow"} | os.environ
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env=environment)
    if done.returncode < 0:
        pytest.skip("no graphics")
    assert done.stdout == "No space left on device\n", done.stderr


def test_report_while_the_run_goes_on(quick_pictures, capsys, case, monkeypatch):
    """From another process at any moment: here before, at and after the first increments.

    Nothing of the run changes by it.
    """
    from anisocontact.results.writer import Writer

    out = case.parent / "out"
    keep, seen = Writer.keep, []

    def kept(self, *arguments):
        keep(self, *arguments)
        if self.summary["steps"] in (0, 1, 3):
            assert main(["report", str(out)]) == 0
            seen.append((out / "report.html").read_text())

    with monkeypatch.context() as patch:
        patch.setattr(Writer, "keep", kept)
        assert main(["run", str(case), "-o", str(out)]) == 0
    assert [text.count("data:image/png") > 0 for text in seen] == [False, False, True]
    assert all("the run still goes on or was killed" in text for text in seen)
    assert main(["run", str(case), "-o", str(case.parent / "alone")]) == 0
    for name in ("history.csv", "contact.pvd"):
        assert (out / name).read_bytes() == (case.parent / "alone" / name).read_bytes()


@pytest.mark.slow
def test_report_of_a_run_that_was_killed(capsys, tmp_path, case_text):
    """SIGKILL in the middle: a report of what converged, and a way to go on."""
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(case_text.replace("increments = 4", "increments = 400"))
    command = [sys.executable, "-m", "anisocontact", "run", str(case), "-o", str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as run:
        assert run.stdout is not None
        for line in run.stdout:
            if line.startswith("drag 5 "):
                break
        run.kill()
    assert main(["report", str(out)]) == 0
    assert "the run still goes on or was killed" in (out / "report.html").read_text()
    assert (out / "pictures" / "pressure.png").is_file()


#: What is done to a file, and what its report then says: one line that names the file.
BROKEN = {
    "summary.json": ["{", "[]", "{}", "\xff", '{"contacts": [], "title": ""}'],
    "history.csv": ["step,increment\npress,", "step,time\npress\n", "step,time\npress,x\n"],
    "fields.pvd": ["<VTKFile", "<VTKFile><DataSet/></VTKFile>"],
}


@pytest.mark.parametrize("name", BROKEN)
def test_report_of_a_broken_folder_is_one_line(quick_pictures, capsys, case, name):
    """A file that somebody has cut, emptied or written over: no traceback, nothing lost."""
    out = case.parent / "out"
    assert main(["run", str(case), "-o", str(out)]) == 0
    capsys.readouterr()
    whole = (out / name).read_bytes()
    for text in BROKEN[name]:
        (out / name).write_bytes(text.encode("latin-1"))
        code, said = main(["report", str(out)]), capsys.readouterr()
        if code == 0:  # a row that is being written does not count
            assert name == "history.csv"
            assert text == BROKEN[name][0]
            continue
        assert code == 2
        assert said.err.startswith("error: ") and str(out) in said.err
        assert len(said.err.splitlines()) == 1
    (out / name).write_bytes(whole)
    assert main(["report", str(out)]) == 0


@pytest.mark.parametrize(
    "missing", ["history.csv", "fields.pvd", "contact.pvd", "contact/0003.vtp"]
)
def test_report_of_what_is_left(quick_pictures, capsys, case, missing):
    """Files that are gone: the report says what could not be drawn, and is made all the same."""
    out = case.parent / "out"
    assert main(["run", str(case), "-o", str(out)]) == 0
    last = sorted((out / "contact").iterdir())[-1]
    (last if missing.startswith("contact/") else out / missing).unlink()
    capsys.readouterr()
    assert main(["report", str(out)]) == 0
    said = capsys.readouterr().err
    assert all(line.startswith("warning: picture ") for line in said.splitlines())
    assert bool(said) == missing.startswith("contact")
    assert "Small block on a turned plate" in (out / "report.html").read_text()


@pytest.mark.parametrize("content", [b"", b"<VTKFile type", None])
def test_a_file_of_fields_that_is_damaged_or_gone(tmp_path, content):
    """Requirement: named, where VTK gives an empty grid and pictures fail by what is not in it."""
    from anisocontact.base.errors import InputError
    from anisocontact.results.solids import read_solid

    path = tmp_path / "0001.vtu"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=r"0001\.vtu' cannot be read"):
        read_solid(path)
