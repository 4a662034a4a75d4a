"""Picture and numbers of the page on line contact in verification, at every slave node.

Run from the root of the repository: python -m docs.figures.line_contact
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from tests.verification.line_contact import test_line_friction as friction
from tests.verification.line_contact import test_line_hertz as hertz
from tests.verification.line_contact import test_rounded_punch as punch
from tests.verification.line_contact import test_spence as spence
from tests.verification.line_contact.conftest import Line

HERE = Path(__file__).parent

COUNTS = (3, 4, 6, 8, 12, 16, 24)
#: Error of the pressure by the facets across a.
FAMILIES: dict[str, tuple[tuple[int, ...], Callable[[int], float]]] = {
    "pair": (COUNTS, lambda n: hertz.pressed(Line, n, n + 1).largest),
    "pair, matching": (COUNTS, lambda n: hertz.pressed(Line, n, n).largest),
    "pair, swapped": (COUNTS, lambda n: hertz.pressed(Line, n, n + 1, swapped=True).largest),
    "rigid cylinder": (COUNTS, lambda n: hertz.pressed(Line, 0, n).largest),
    "pair, order 2": (COUNTS[:5], lambda n: hertz.pressed(Line, n, n + 1, order=2).largest),
    "rounded punch": (COUNTS[1:], lambda n: punch.pressed(Line, n, n + 1).largest),
    "rounded punch, order 2": ((4, 6, 8), lambda n: punch.pressed(Line, n, n + 1, 2).largest),
    "shift, $Q/\\mu P$ = 0.22": ((4, 6, 8), lambda n: friction.shifted(Line, n, 0.3).largest),
    "shift, $Q/\\mu P$ = 0.65": ((4, 6, 8), lambda n: friction.shifted(Line, n, 0.9).largest),
    "rolling": ((6, 8), lambda n: friction.rolled(Line, n).largest),
    "growing": (COUNTS[1:6], lambda n: spence.pressed(Line, n, spence.BETA, 8 * n).largest),
}


def draw_errors(axes: Axes) -> None:
    """Largest error within 0.8 a over the facets across a, and lines of a table."""
    for name, (counts, run) in FAMILIES.items():
        found = {n: run(n) for n in counts}
        cells = [f"{100.0 * found[n]:.2f}" if n in found else "" for n in COUNTS]
        print(f"| {name} | {' | '.join(cells)} |", flush=True)
        if name.startswith("pair") or name.startswith("rigid"):
            axes.loglog(counts, list(found.values()), "o-", label=name)
    axes.set_xticks(COUNTS, [str(n) for n in COUNTS])
    percents = [0.1, 0.2, 0.5, 1, 2]
    axes.set_yticks([0.01 * p for p in percents], [f"{p} %" for p in percents])
    axes.minorticks_off()
    axes.set(xlabel="facets across $a$", ylabel="largest error within $0.8\\,a$ over $p_0$")
    axes.legend(fontsize="small")


def draw_punch(axes: Axes) -> None:
    """Pressure under a rounded punch at 8 facets."""
    found = punch.pressed(Line, 8, 9)
    phi = np.linspace(0.0, 0.5 * np.pi, 600)
    axes.plot(np.sin(phi), punch.exact(phi, found.edge), color="0.4", label="Ciavarella et al.")
    axes.plot(found.place, found.found, "o", color="tab:blue", label="nodes")
    axes.set(xlim=(0.0, 1.3), ylim=(0.0, None), xlabel="$x/a$", ylabel="$a\\,p/P$")
    axes.legend(fontsize="small")


def draw_rolling(axes: Axes) -> None:
    """Shear of a cylinder that rolls under traction at 6 facets."""
    found = friction.rolled(Line, 6)
    print(f"rolling, Q / mu P = {found.share:.2f}: {100.0 * found.largest:.2f} %")
    x = np.linspace(-1.3, 1.3, 1301)
    exact = friction.closed_form(x, found.share, forward=True)
    axes.plot(x, exact, color="0.4", label="Carter")
    axes.plot(found.place, found.found, "o", color="tab:blue", label="nodes")
    axes.set(xlim=(-1.3, 1.3), ylim=(0.0, None), xlabel="$x/a$", ylabel="$q/\\mu p_0$")
    axes.legend(fontsize="small")


if __name__ == "__main__":
    figure = Figure(figsize=(12.0, 3.8), layout="constrained")
    first, second, third = figure.subplots(1, 3)
    draw_errors(first)
    draw_punch(second)
    draw_rolling(third)
    figure.savefig(HERE / "line-contact.png", dpi=100)
