"""Formulas of the site: what docutils misreads without a warning is put right before."""

from pathlib import Path

import pytest

EXTENSIONS = Path(__file__).parents[2] / "docs" / "_ext"


@pytest.mark.parametrize(
    ("latex", "expected"),
    [
        (r"\boldsymbol\rho(\xi)+N", r"{\boldsymbol{\rho}}(\xi)+N"),
        (r"\boldsymbol{\rho}_i\cdot n", r"{\boldsymbol{\rho}}_i\cdot n"),
        (r"\boldsymbol x^2", r"{\boldsymbol{x}}^2"),
        (r"\Delta\boldsymbol\xi^{\mathrm{sl}}", r"\Delta{\boldsymbol{\xi}}^{\mathrm{sl}}"),
        (r"\boldsymbol{\hat{\xi}}a", r"{\boldsymbol{\hat{\xi}}}a"),
        (r"\tfrac12(a+b)", r"\tfrac{1}{2}(a+b)"),
        (r"\frac1{\mu^2}+\frac hd", r"\frac1{\mu^2}+\frac hd"),
    ],
)
def test_arguments_are_put_in_braces(
    latex: str, expected: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("sphinx")
    monkeypatch.syspath_prepend(str(EXTENSIONS))
    from mathml import braced

    assert braced(latex) == expected


def test_bold_and_halves_end_where_they_should(monkeypatch: pytest.MonkeyPatch) -> None:
    """The translation itself: N is not bold, 12 is no number."""
    pytest.importorskip("sphinx")
    monkeypatch.syspath_prepend(str(EXTENSIONS))
    from docutils.utils.math import latex2mathml

    from mathml import braced

    bold = latex2mathml.tex2mathml(braced(r"\boldsymbol\rho+N"))
    assert '<mi class="boldsymbol">ρ</mi>' in bold
    assert bold.count("boldsymbol") == 1
    half = latex2mathml.tex2mathml(braced(r"\tfrac12 a"))
    assert "12" not in half
