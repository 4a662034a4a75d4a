"""Picture and numbers of the page on mortar contact in verification: Hertz at every slave node.

Run from the root of the repository: python -m docs.figures.mortar
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from tests.verification.half_space.conftest import HalfSpaces
from tests.verification.half_space.test_mortar_hertz import Pressure, pair, rigid

HERE = Path(__file__).parent

FACETS = (3, 4, 6, 8)
#: Largest and root mean square error over p0, and the iterations, by the facets across the radius.
FAMILIES: dict[str, tuple[tuple[int, ...], Callable[[int], Pressure]]] = {
    "pair": (FACETS, lambda n: pair(HalfSpaces, n, n + 1)),
    "pair, swapped": (FACETS, lambda n: pair(HalfSpaces, n, n + 1, swapped=True)),
    "pair, distorted by 0.2": (FACETS, lambda n: pair(HalfSpaces, n, n + 1, distorted=0.2)),
    "rigid sphere": ((*FACETS, 12), lambda n: rigid(HalfSpaces, "sphere", n)),
    "rigid plane": ((*FACETS, 12), lambda n: rigid(HalfSpaces, "plane", n)),
    "pair, order 2": ((2, 3, 4), lambda n: pair(HalfSpaces, n, n + 1, order=2)),
}


def draw_pressures(axes: Axes) -> None:
    """Pressure of a pair at 4 facets a radius: nodes of mortar contact, points of a single pass."""
    r = np.linspace(0.0, 1.0, 400)
    axes.plot(r, np.sqrt(1.0 - r**2), color="0.4", label="Hertz")
    points = pair(HalfSpaces, 4, 5, augmentation=None, mortar=False)
    nodes = pair(HalfSpaces, 4, 5)
    print(f"points, penalty, 4 on 5: {100.0 * points.largest:.1f} %")
    axes.plot(points.radius, points.found, "x", color="tab:red", label="single pass, points")
    axes.plot(nodes.radius, nodes.found, "o", color="tab:blue", label="mortar, nodes")
    axes.set(xlim=(0.0, 1.3), ylim=(0.0, 1.4), xlabel="$r/a$", ylabel="$p/p_0$")
    axes.legend()


def draw_errors(axes: Axes) -> None:
    """Largest error within 0.8 a over the facets across the radius, and lines of a table."""
    for name, (counts, run) in FAMILIES.items():
        found = [run(n) for n in counts]
        for n, p in zip(counts, found, strict=True):
            rms = np.sqrt(np.mean(p.error**2))
            print(
                f"| {name} | {n} | {100.0 * p.largest:.2f} | {100.0 * rms:.2f} "
                f"| {p.found.max():.3f} | {p.iterations} |",
                flush=True,
            )
        axes.loglog(counts, [p.largest for p in found], "o-", label=name)
    n = np.array([3.0, 12.0])
    axes.loglog(n, 0.6 / n**2, "--", color="0.6", label="second order")
    ticks = [2, 3, 4, 6, 8, 12]
    axes.set_xticks(ticks, [str(t) for t in ticks])
    percents = [0.3, 0.5, 1, 2, 4, 8]
    axes.set_yticks([0.01 * p for p in percents], [f"{p} %" for p in percents])
    axes.minorticks_off()
    axes.set(xlabel="facets across $a$", ylabel="largest error within $0.8\\,a$ over $p_0$")
    axes.legend(fontsize="small")


if __name__ == "__main__":
    figure = Figure(figsize=(10.0, 4.2), layout="constrained")
    left, right = figure.subplots(1, 2)
    draw_pressures(left)
    draw_errors(right)
    figure.savefig(HERE / "mortar-hertz.png", dpi=110)
