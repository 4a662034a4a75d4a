"""A run that others are compared with."""

from __future__ import annotations

import json
from contextlib import nullcontext

import pytest

from anisocontact.cli import main


@pytest.fixture(autouse=True)
def no_report(monkeypatch):
    """The pictures take longer than the run."""
    monkeypatch.setattr(
        "anisocontact.results.report_process.report_beside",
        lambda wanted: nullcontext(lambda folder: []),
    )


@pytest.fixture
def case_text(case_text):
    """With a penalty that is no reason for a warning: what is said here is about files."""
    return case_text.replace("penalty = 1e4", "penalty = 1e5")


@pytest.fixture
def case(tmp_path, case_text):
    path = tmp_path / "case.toml"
    path.write_text(case_text + '\n[solver]\nstrategy = "direct"\n')
    return path


@pytest.fixture
def whole(case):
    """Results of a run that nothing has disturbed."""
    folder = case.parent / "whole"
    assert main(["run", str(case), "-o", str(folder)]) == 0
    return folder


@pytest.fixture
def same():
    """Whether two runs left the same numbers and fields, bit by bit."""

    def alike(a, b):
        names = ["history.csv", "fields.pvd", "contact.pvd"]
        names += [f"{f}/{p.name}" for f in ("fields", "contact") for p in (a / f).iterdir()]
        summaries = [json.loads((f / "summary.json").read_text()) for f in (a, b)]
        for summary in summaries:
            del summary["wall_time_s"]
        return summaries[0] == summaries[1] and all(
            (a / n).read_bytes() == (b / n).read_bytes() for n in names
        )

    return alike
