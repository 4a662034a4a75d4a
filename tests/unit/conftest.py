"""A small case that the tests of case file, command and results start from."""

from __future__ import annotations

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
