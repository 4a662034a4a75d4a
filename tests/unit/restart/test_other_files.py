"""A run that goes on needs the files that it began with, and its folder for itself."""

from __future__ import annotations

import errno
import fcntl
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.cli import main
from anisocontact.results.lock import locked

#: One hexahedron: body "block" with the facets "block.bottom" and "block.top" of unit size.
MESH = """$MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
3
2 1 "block.bottom"
2 2 "block.top"
3 3 "block"
$EndPhysicalNames
$Nodes
8
1 0 0 0
2 1 0 0
3 1 1 0
4 0 1 0
5 0 0 1
6 1 0 1
7 1 1 1
8 0 1 1
$EndNodes
$Elements
3
1 3 2 1 1 4 3 2 1
2 3 2 2 2 5 6 7 8
3 5 2 3 3 1 2 3 4 5 6 7 8
$EndElements
"""


@pytest.fixture(params=["file", "files"])
def meshed(request: pytest.FixtureRequest, case: Path) -> Path:
    """The case with a mesh file beside it, named in either way."""
    (case.parent / "block.msh").write_text(MESH)
    text = case.read_text()
    table = {
        "file": '[mesh]\nfile = "block.msh"\n',
        "files": '[mesh.files.b]\npath = "block.msh"\n',
    }
    first, last = text.index("[mesh.box.block]"), text.index("[material.block]")
    case.write_text(text[:first] + table[request.param] + text[last:])
    return case


def run(case: Path, *more: str) -> int:
    return main(["run", str(case), "-o", str(case.parent / "out"), *more])


def test_restart_with_another_mesh(meshed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A mesh file of which anything has changed is refused by its name, and before it is read.

    Here the facets get another order: the same nodes, the same positions.
    """
    assert run(meshed) == 0
    assert run(meshed, "--restart") == 0
    capsys.readouterr()
    mesh = meshed.parent / "block.msh"
    mesh.write_text(MESH.replace("1 4 3 2 1", "1 3 2 1 4"))
    assert run(meshed, "--restart") == 2
    error = capsys.readouterr().err
    assert error.startswith("error: mesh.file")
    assert "'block.msh' has changed since the run that is to go on began" in error
    mesh.unlink()
    assert run(meshed, "--restart") == 2
    assert "'block.msh' given, no such file" in capsys.readouterr().err
    mesh.write_text(MESH)
    assert run(meshed, "--restart") == 0


def test_a_case_file_that_is_read_once(meshed: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`run <(prepare.sh)`: a pipe has its text once, and a file may change while its case runs.

    Requirement: results and checkpoint have the text that was run.
    """
    text, folder = meshed.read_text().replace("block.msh", str(meshed.parent / "block.msh")), "out"
    ends = os.pipe()
    os.write(ends[1], text.encode())
    os.close(ends[1])
    out = meshed.parent / folder
    assert main(["run", f"/dev/fd/{ends[0]}", "-o", str(out)]) == 0
    os.close(ends[0])
    assert (out / "case.toml").read_text() == text
    meshed.write_text(text)
    assert run(meshed, "--restart") == 0
    meshed.write_text(text.replace("E = 1000", "E = 1001"))
    assert run(meshed, "--restart") == 2
    assert "material.block.E: 1001 given" in capsys.readouterr().err


#: One hexahedron in a deck whose faces are those of a file that it includes.
DECK = """*INCLUDE, INPUT=parts/nodes.inc
*ELEMENT, TYPE=C3D8, ELSET=block
1, 1, 2, 3, 4, 5, 6, 7, 8
*SOLID SECTION, ELSET=block
"""
INCLUDED = {
    "nodes.inc": "*NODE\n1,0,0,0\n2,1,0,0\n3,1,1,0\n4,0,1,0\n5,0,0,1\n6,1,0,1\n"
    "7,1,1,1\n8,0,1,1\n*INCLUDE, INPUT=faces.inc\n",
    "faces.inc": "*SURFACE, NAME=bottom\n1, S1\n*SURFACE, NAME=top\n1, S2\n",
}


@pytest.mark.parametrize("changed", sorted(INCLUDED))
def test_restart_with_another_file_of_a_deck(
    meshed: Path, capsys: pytest.CaptureFixture[str], changed: str
) -> None:
    """Requirement: a deck is what it includes, too, at any depth."""
    meshed.with_name("block.inp").write_text(DECK)
    parts = meshed.with_name("parts")
    parts.mkdir()
    for name, text in INCLUDED.items():
        (parts / name).write_text(text)
    meshed.write_text(meshed.read_text().replace("block.msh", "block.inp"))
    assert run(meshed) == 0
    assert run(meshed, "--restart") == 0
    capsys.readouterr()
    (parts / changed).write_text(INCLUDED[changed] + "** another\n")
    assert run(meshed, "--restart") == 2
    assert f"'parts/{changed}' has changed since the run" in capsys.readouterr().err


@pytest.mark.parametrize("content", [b"\xff\xfe binary", b"a\0b\n\xc3", b""])
def test_restart_with_a_table_that_is_none(
    meshed: Path, capsys: pytest.CaptureFixture[str], content: bytes
) -> None:
    """Requirement: one line that names the file, no internal error."""
    assert run(meshed) == 0
    table = meshed.parent / "out" / "history.csv"
    table.write_bytes(content)
    capsys.readouterr()
    assert run(meshed, "--restart") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"error: '{table}' ")
    assert line.endswith("put the file back, or run without --restart")
    assert table.read_bytes() == content


@pytest.mark.parametrize("where", ["header", "row"])
def test_restart_with_a_table_that_has_other_numbers(
    meshed: Path, capsys: pytest.CaptureFixture[str], where: str
) -> None:
    """Requirement: results never silently go on behind rows that the run has not written."""
    assert run(meshed) == 0
    table = meshed.parent / "out" / "history.csv"
    header, row, *more = table.read_text().splitlines(keepends=True)
    other = header.replace("time", "tame") if where == "header" else row.replace("0.0", "0.5", 1)
    assert other not in (header, row)
    content = "".join([other, row, *more] if where == "header" else [header, other, *more])
    table.write_text(content)
    capsys.readouterr()
    assert run(meshed, "--restart") == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line == (
        f"error: '{table}' is not as the run that is to go on has written it: "
        "put the file back, or run without --restart"
    )
    assert table.read_text() == content


def test_restart_with_a_table_that_another_system_has_saved(meshed: Path) -> None:
    """Requirement: other ends of lines, as a spreadsheet writes them, cut no row apart."""
    assert run(meshed) == 0
    table = meshed.parent / "out" / "history.csv"
    content = table.read_bytes()
    table.write_bytes(content.replace(b"\n", b"\r\n"))
    assert run(meshed, "--restart") == 0
    assert table.read_bytes() == content


def test_restart_with_ends_of_lines_in_a_name(meshed: Path) -> None:
    """Requirement: a name of a step with an end of a line in it stays what it is in the table."""
    text = meshed.read_text()
    assert 'name = "press"' in text
    meshed.write_text(text.replace('name = "press"', r'name = "a\rb\nc"'))
    assert run(meshed) == 0
    table = meshed.parent / "out" / "history.csv"
    content = table.read_bytes()
    assert b'"a\rb\nc",1' in content
    assert run(meshed, "--restart") == 0
    assert table.read_bytes() == content


@pytest.mark.parametrize("encoding", ["utf-8-sig", "crlf"])
def test_restart_with_a_case_file_of_another_system(meshed: Path, encoding: str) -> None:
    """Requirement: a mark of the byte order, or other ends of lines, keep no run from going on."""
    text = meshed.read_text()
    if encoding == "crlf":
        meshed.write_bytes(text.replace("\n", "\r\n").encode())
    else:
        meshed.write_text(text, encoding=encoding)
    assert run(meshed) == 0
    assert run(meshed, "--restart") == 0


#: Keeps a folder until it is told to end, or killed.
HOLDER = """
import sys
from pathlib import Path
from anisocontact.results.lock import locked
with locked(Path(sys.argv[1])) as warning:
    print("locked" + warning, flush=True)
    sys.stdin.read()
"""


def holder(folder: Path) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", HOLDER, str(folder)]
    pipe = subprocess.PIPE
    other = subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True)
    assert other.stdout is not None
    assert other.stdout.readline() == "locked\n"
    return other


@pytest.mark.parametrize("more", [[], ["--overwrite"], ["--restart"]])
def test_two_runs_into_one_folder(
    case: Path, more: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """The second one is refused in a line that names the first, whatever it wants to do there.

    A crash of the first one frees the folder.
    """
    out = case.parent / "out"
    if more:
        assert run(case) == 0
    files = {path.name for path in out.iterdir()} if more else set()
    with holder(out) as other:
        capsys.readouterr()
        assert run(case, *more) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith(
            f"error: results folder '{out}' is in use by process {other.pid} on "
        )
        other.send_signal(signal.SIGKILL)
    assert {path.name for path in out.iterdir()} == files | {".lock"}
    assert run(case, *more) == 0
    assert ".lock" not in {path.name for path in out.iterdir()}


def test_a_trace_has_its_folder_for_itself(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = Path(__file__).parents[3] / "examples" / "point" / "sledge.toml"
    arguments = ["trace", str(case), "-o", str(tmp_path / "out")]
    with holder(tmp_path / "out") as other:
        assert main(arguments) == 2
        assert f"is in use by process {other.pid} on " in capsys.readouterr().err
        other.communicate()
    assert main(arguments) == 0


def test_a_folder_that_was_made_for_nothing_goes_again(tmp_path: Path) -> None:
    with locked(tmp_path / "a" / "b"):
        assert (tmp_path / "a" / "b" / ".lock").is_file()
    assert not (tmp_path / "a").exists()
    with locked(tmp_path / "a" / "b"):
        (tmp_path / "a" / "mine").touch()
    assert [path.name for path in (tmp_path / "a").iterdir()] == ["mine"]


@pytest.mark.parametrize("command", ["run", "trace"])
def test_a_folder_in_which_no_file_can_be_made(
    case: Path, tmp_path: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Requirement: a name that allows no results is the user's mistake, said before anything is
    solved; so where the system has permission by name, and yet makes nothing."""
    sledge = Path(__file__).parents[3] / "examples" / "point" / "sledge.toml"
    file = str(case if command == "run" else sledge)
    assert main([command, file, "-o", "/proc/results/1"]) == 2
    shown = capsys.readouterr()
    assert shown.out == ""
    assert shown.err.splitlines() == [
        "error: results folder '/proc/results/1' cannot be written: No such file or directory; "
        "name another one with -o"
    ]


@pytest.mark.parametrize("number", [errno.EACCES, errno.ENOSPC])
def test_what_a_disk_lacks_is_no_fault_of_the_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, number: int
) -> None:
    """Requirement: on a full disk the writer says what is full, and the run is one that stopped."""

    def failing(*arguments: object) -> int:
        raise OSError(number, os.strerror(number), str(tmp_path))

    monkeypatch.setattr("anisocontact.results.lock.os.open", failing)
    if number == errno.ENOSPC:
        with locked(tmp_path / "a") as warning:
            assert warning == ""
    else:
        with (
            pytest.raises(InputError, match="/a' cannot be written: Permission denied; name"),
            locked(tmp_path / "a"),
        ):
            pytest.fail("it is not locked")
    assert not (tmp_path / "a").exists()


def test_one_after_the_other_from_many(tmp_path: Path) -> None:
    """However runs follow each other, there is never more than one: the file comes and goes."""
    inside, most, got = [0], [0], [0]

    def enter() -> None:
        for _ in range(200):
            try:
                with locked(tmp_path):
                    inside[0] += 1
                    most[0] = max(most[0], inside[0])
                    got[0] += 1
                    inside[0] -= 1
            except InputError:
                pass

    threads = [threading.Thread(target=enter) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == [1]
    assert got[0] > 0


def test_a_file_system_without_locks(
    case: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """It is said, and the run goes on."""

    def no_locks(number: int, operation: int) -> None:
        raise OSError(errno.ENOLCK, os.strerror(errno.ENOLCK))

    monkeypatch.setattr(fcntl, "flock", no_locks)
    assert run(case) == 0
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"warning: results folder '{case.parent / 'out'}' cannot be locked")
