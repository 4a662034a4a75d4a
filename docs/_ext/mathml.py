"""Formulas as MathML, which browsers draw themselves: the built site needs no network.

docutils translates the LaTeX; what it does not know is a warning, hence an error of `make docs`.
Two things it reads otherwise than LaTeX without a warning are put in braces first.
"""

import re
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError, latex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.math import get_node_equation_number
from sphinx.writers.html5 import HTML5Translator

logger = logging.getLogger(__name__)

# The command with its argument: a group, with groups inside it, or a command or a character.
BOLD = re.compile(r"\\boldsymbol\s*(?:\{((?:[^{}]|\{[^{}]*\})*)\}|(\\[A-Za-z]+|[^\s\\{]))")
TWO_DIGITS = re.compile(r"(\\[td]?frac)\s*(\d)\s*(\d)")


def braced(latex: str) -> str:
    r"""Return a formula in which \boldsymbol ends with its argument and \frac12 is a half.

    docutils makes bold everything up to the end of the group, and reads 12 as one number.
    """
    latex = BOLD.sub(lambda m: rf"{{\boldsymbol{{{m[1] or m[2]}}}}}", latex)
    return TWO_DIGITS.sub(r"\1{\2}{\3}", latex)


def mathml(node: nodes.Element, *, as_block: bool) -> str:
    """Return the MathML of a formula."""
    latex = braced(node.astext())
    if as_block and r"\begin{" not in latex and r"\\" in latex:
        latex = rf"\begin{{align*}}{latex}\end{{align*}}"
    try:
        return latex2mathml.tex2mathml(latex, as_block=as_block)
    except (MathError, SyntaxError, IndexError) as error:
        logger.warning("formula %r: %s", latex, error, location=node)
        return f"<code>{latex}</code>"


def visit_inline(self: HTML5Translator, node: nodes.math) -> None:
    """Write a formula in a line."""
    self.body.append(mathml(node, as_block=False))
    raise nodes.SkipNode


def visit_block(self: HTML5Translator, node: nodes.math_block) -> None:
    """Write a displayed formula with its number."""
    self.body.append(self.starttag(node, "div", CLASS="math-block"))
    self.body.append(mathml(node, as_block=True))
    if node.get("number"):
        number = get_node_equation_number(self, node)
        self.body.append(f'<span class="eqno">({number})</span>')
    self.body.append("</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
