"""The deck and the case of the page for users of other codes work as they stand there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.words import elsewhere
from anisocontact.cli import main
from anisocontact.results import Results

HOWTO = Path(__file__).parents[2] / "docs" / "howto"


def block(language: str) -> str:
    page = (HOWTO / "other-codes.md").read_text()
    (found, *_) = re.findall(rf"^```{language}\n(.*?)^```", page, re.DOTALL | re.MULTILINE)
    return found


def test_deck_is_looked_into_and_runs(tmp_path, capsys):
    """Requirement: what `check` prints, word for word, and the force of Coulomb while it slides.

    Every point has 0.3 of its pressure against its own slip; pressing has left these directions a
    little apart, so that their sum is less, by up to a per cent.
    """
    (tmp_path / "press.inp").write_text(block("text"))
    (tmp_path / "press.toml").write_text(f"{block('toml')}[output]\npictures = false\n")
    assert main(["check", str(tmp_path / "press.inp")]) == 0
    _, printed = block("console").split("\n", 1)
    assert capsys.readouterr().out == printed
    assert main(["run", str(tmp_path / "press.toml"), "-o", str(tmp_path / "out")]) == 0
    history = Results(tmp_path / "out").history
    normal, along = (history[f"contacts.0.force.{axis}"] for axis in "zx")
    assert normal[-1] > 0.0
    assert 0.297 < -along[-1] / normal[-1] < 0.3 * (1.0 + 1e-9)


def test_deck_is_converted(tmp_path, capsys, monkeypatch):
    """Requirement: what `convert` prints, word for word."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "press.inp").write_text(block("text"))
    command, printed = block("{code-block} console").split("\n", 1)
    assert main(command.split()[2:]) == 0
    assert capsys.readouterr().out == printed


def test_keys_of_the_tables_are_understood():
    """What the page says of words in messages."""
    assert "coefficients" in (elsewhere("mu") or "")
