"""The first tutorial, followed to the letter in an empty folder."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main

PAGE = Path(__file__).parents[2] / "docs" / "tutorials" / "first-run.md"
BLOCK = re.compile(r"^```\{code-block\} (\w+)\n(?::caption: (\S+)\n)?(.*?)^```", re.M | re.S)


def shell(line: str) -> int:
    """A command of the page: ours, or `sed s/OLD/NEW/ FROM > TO`."""
    words = shlex.split(line)
    if words[0] == "anisocontact":
        return main(words[1:])
    sed, edit, source, into, target = words
    assert (sed, into) == ("sed", ">")
    _, old, new, _ = edit.split("/")
    Path(target).write_text(Path(source).read_text().replace(old, new))
    return 0


def matches(shown: str, printed: str) -> bool:
    """Whether a text is as shown, where `...` stands for anything."""
    pattern = ".*".join(re.escape(part) for part in shown.strip().split("..."))
    return re.fullmatch(pattern, printed.strip(), re.S) is not None


def test_the_first_tutorial(tmp_path, monkeypatch, capsys):
    """Files are saved, commands print what the page says, and the Python block's assert holds."""
    monkeypatch.chdir(tmp_path)
    kinds = []
    for kind, caption, body in BLOCK.findall(PAGE.read_text()):
        kinds.append(kind)
        if kind == "toml":
            Path(caption).write_text(body)
        elif kind == "console":
            for piece in re.split(r"^\$ ", body, flags=re.M)[1:]:
                command, _, shown = piece.partition("\n")
                code = shell(command)
                printed = "".join(capsys.readouterr())
                assert code == (2 if "error:" in shown else 0), printed
                assert matches(shown, printed), printed
        else:
            exec(compile(body, str(PAGE), "exec"), {})
    assert kinds == ["toml", "console", "console", "console", "python"]
    assert Path("results/first/report.html").is_file()
