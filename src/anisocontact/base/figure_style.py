"""How all pictures look, and how they are kept."""

from __future__ import annotations

import io
import warnings
from pathlib import Path
from typing import TYPE_CHECKING, Any

from anisocontact.base.errors import printable
from anisocontact.base.whole_files import replacing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GREY = "#6b7280"
ACCENT = "#b91c1c"
#: Open, stick, slip; told apart without colour vision as well.
STATUS_COLOURS = ("#d1d5db", "#1d4ed8", "#f59e0b")
#: One for each step, repeated where there are more.
STEP_COLOURS = ("#0f766e", "#7c3aed", "#c2410c", "#0369a1", "#a16207", "#be185d")


def new_figure(width: float, height: float) -> Figure:
    """A figure that needs no display.

    Args:
        width: Width, inches.
        height: Height, inches.

    Returns:
        The figure, empty.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained", dpi=120)
    FigureCanvasAgg(figure)
    return figure


def plain(text: str) -> str:
    """A name or a text of the user as Matplotlib shows it letter by letter.

    Two dollars would make a formula of what is between them.

    Returns:
        The text, for titles and labels.
    """
    return printable(text).replace("$", r"\$")


def png(figure: Figure) -> bytes:
    """A picture as PNG, without the date so that equal runs give equal files."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.image import imsave

    out = io.BytesIO()
    canvas: Any = FigureCanvasAgg(figure)
    told: Any = {"Software": None}
    _leave_out_spines(figure)
    with warnings.catch_warnings():
        # letters of a name that the font has not are drawn as boxes
        warnings.filterwarnings("ignore", r"Glyph \d+ .*missing from font", UserWarning)
        canvas.draw()  # `savefig` draws twice: once for the layout, once for the picture
    quick: Any = {"compress_level": 3}
    imsave(
        out,
        canvas.buffer_rgba(),
        format="png",
        dpi=figure.dpi,
        metadata=told,
        pil_kwargs=quick,
    )
    return out.getvalue()


def _leave_out_spines(figure: Figure) -> None:
    """Let a layout be found without spines, which lie on the border of their axes.

    Each would make the ticks of its axis once more to say where it ends.
    """
    for axes in figure.axes:
        for spine in axes.spines.values():
            spine.set_in_layout(False)


def save(figure: Figure, path: Path) -> None:
    """Write a picture as PNG.

    Args:
        figure: The picture.
        path: The file; it is written whole or not at all.
    """
    drawn = png(figure)
    with replacing(path) as draft:
        draft.write_bytes(drawn)
