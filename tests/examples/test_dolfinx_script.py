"""The script of a user: contact added to a plain DOLFINx problem."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

SCRIPT = Path(__file__).parents[2] / "examples" / "dolfinx_script" / "rubber_pad.py"


@pytest.fixture(scope="module")
def forces() -> np.ndarray:
    spec = importlib.util.spec_from_file_location("rubber_pad", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.main()


def test_steady_slip(forces: np.ndarray) -> None:
    """Dragged by half its length, the pad slides as one: direction and size of the closed form
    of maximum dissipation, axes at 30 degrees, within 0.2 % (0.03 % measured)."""
    mu, angle = np.array([0.3, 0.6]), np.radians(30.0)
    axes = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    e = axes @ [1.0, 0.0]
    expected = -axes.T @ (mu**2 * e) / np.linalg.norm(mu * e)
    assert np.linalg.norm(forces[-1, :2] / forces[-1, 2] - expected) < 0.002 * np.linalg.norm(
        expected
    )


def test_contact_takes_three_lines() -> None:
    """No more than five lines besides the laws: here model, contact and problem."""
    lines = SCRIPT.read_text().splitlines()
    added = [
        line for line in lines if re.search(r"Model\.of|= Contact\(|ContactProblem\(|commit", line)
    ]
    assert len([line for line in added if not line.startswith(("from", "import"))]) == 3
