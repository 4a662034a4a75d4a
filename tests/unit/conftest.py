"""A small case that the tests of case file, command and results start from."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def case_text() -> str:
    """A block of 18 hexahedra, pressed and dragged askew to its marks; runs in a second."""
    return Path(__file__).with_name("small_block.toml").read_text()


@pytest.fixture(scope="session")
def unpictured(case_text: str) -> str:
    """The same without pictures, which take longer than the run."""
    return case_text.replace("[output]", "[output]\npictures = false")


@pytest.fixture
def refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """What `check` says of a case file with a word of it changed: one line, no internal error."""

    def said(text: str, old: str, new: str, count: int = -1) -> str:
        from anisocontact.cli import main

        path = tmp_path / "case.toml"
        assert old in text
        path.write_text(text.replace(old, new, count))
        assert main(["check", str(path)]) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith("error: ") and "internal" not in line
        return line

    return said


@pytest.fixture
def stop_after() -> Callable[..., None]:
    """Let runs get a signal, that of Ctrl-C, behind so many accepted increments."""

    def stop(patch: pytest.MonkeyPatch, count: int, number: int = signal.SIGINT) -> None:
        from anisocontact.results.writer import Writer

        keep = Writer.keep

        def interrupted(self: Writer, *arguments: object) -> None:
            keep(self, *arguments)  # type: ignore[arg-type]
            if self.summary["steps"] == count > 0:
                os.kill(os.getpid(), number)

        patch.setattr(Writer, "keep", interrupted)

    return stop


@pytest.fixture
def gone_on(
    monkeypatch: pytest.MonkeyPatch, stop_after: Callable[..., None]
) -> Callable[[Path, int], tuple[Path, Path]]:
    """Run a case, and again with a stop behind so many increments; the folders of both."""

    def both(case: Path, count: int) -> tuple[Path, Path]:
        from anisocontact.cli import main

        whole, out = case.parent / "whole", case.parent / "out"
        assert main(["run", str(case), "-o", str(whole)]) == 0
        with monkeypatch.context() as patch:
            stop_after(patch, count)
            assert main(["run", str(case), "-o", str(out)]) == 3
        assert main(["run", str(case), "-o", str(out), "--restart"]) == 0
        return whole, out

    return both
