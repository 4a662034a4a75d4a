"""Iterative strategy where memory does not do for a factor of the coarse level."""

from __future__ import annotations

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.verification.test_fe_iterative import PRESS, _counts, _pair, _same

from anisocontact.solver.strategies.iterative import factor


@pytest.mark.parametrize("mortar", [False, True])
def test_a_coarse_factor_without_room(monkeypatch: pytest.MonkeyPatch, mortar: bool) -> None:
    """Where memory would not do for it the coarse level is solved by multigrid.

    Requirement: the same answers with at most half more Krylov iterations; a line says so.
    """
    usual = _same(lambda: _pair(mortar=mortar), [PRESS])
    lack = "a factor of the coarse level needs 9.0 GB, 1.0 GB are free"
    monkeypatch.setattr(factor, "too_large", lambda *_: iter([lack]))
    notes = _same(lambda: _pair(mortar=mortar), [PRESS])
    assert sum(note.startswith(f"{lack}: it is solved by GMRES with ") for note in notes) == 1
    assert _counts(notes)[1] <= 1.5 * _counts(usual)[1]
