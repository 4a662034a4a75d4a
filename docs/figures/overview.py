"""Pictures of the overview of the theory.

Run: python docs/figures/overview.py
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from anisocontact.anisotropy import make_directions
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw, force_domain
from anisocontact.surfaces import make_surface

HERE = Path(__file__).parent
GROUND, GRID, THREAD = "#f1eee7", "#c9c4b8", "#8a8371"
INK, FIRST, SECOND, SLAVE = "#222222", "#1f5fa8", "#2f7d4f", "#d9622b"

RADIUS, PITCH = 1.0, 1.6
STIFFNESS, COEFFICIENTS, PRESSURE, PENALTY = (1e3, 1e3), (0.3, 0.1), 10.0, 1e5
RULES = {
    "maximum-dissipation": (FIRST, {}),
    "linear": (SECOND, {}),
    "coaxial": ("#7d4fa3", {}),
    "explicit": (SLAVE, {"history": "centre"}),
}


def kinematics() -> Figure:
    """A point of the slave, its closest point on a thread, tangent plane and axes."""
    master = make_surface(
        "cylinder", point=(0, 0, 0), axis=(0, 0, 1), start=(1, 0, 0), radius=RADIUS
    )
    thread = make_directions("spiral", axis=((0, 0, 0), (0, 0, 1)), pitch=PITCH)
    slave = np.array([1.75, 0.1, 0.95])
    foot = master.project([slave])
    c = master.position(foot.xi)[0]
    n = master.geometry(foot.xi).normal[0]
    e = thread.axes(master, foot.xi)[0][0]

    figure = Figure(figsize=(6.6, 5.6))
    ax = figure.add_axes((0.0, 0.0, 1.0, 1.0), projection="3d", computed_zorder=False)
    a, z = np.meshgrid(np.linspace(-1.75, 0.9, 41), np.linspace(0.0, 1.9, 21), indexing="ij")
    x = master.position(np.stack([a.ravel(), z.ravel()], axis=1)).T.reshape(3, *a.shape)
    ax.plot_surface(*x, color=GROUND, shade=False, linewidth=0, zorder=0)
    ax.plot_wireframe(*x, color=GRID, linewidth=0.4, rcount=12, ccount=8, zorder=1)
    for start in np.arange(-2.0, 5.0) * PITCH / 4:
        line = np.linspace(-1.75, 0.9, 100)
        height = PITCH * line / (2 * np.pi) + start
        on = (height > 0) & (height < 1.9)
        ax.plot(*master.position(np.stack([line, height], axis=1)[on]).T, color=THREAD, zorder=2)
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]]) * 0.42
    ax.plot(*(c + square @ e).T, color=INK, linewidth=0.9, zorder=3)
    ax.plot(*np.array([c, slave]).T, "--", color=INK, linewidth=0.9, zorder=4)
    for v, length, colour, label in (
        (e[0], 0.7, FIRST, "$\\mathbf{e}_1$, first axis"),
        (e[1], 0.7, SECOND, "$\\mathbf{e}_2$, second axis"),
        (n, 0.35, INK, ""),
    ):
        ax.quiver(*c, *(length * v), color=colour, linewidth=2.0, arrow_length_ratio=0.16, zorder=5)
        ax.text(*(c + 1.08 * length * v), label, color=colour, fontsize=11, zorder=6)
    ax.plot(*c, "o", color=INK, markersize=5, zorder=6)
    ax.plot(*slave, "o", color=SLAVE, markersize=8, zorder=6)
    for place, shift, label, colour in (
        (slave, (0.0, 0.0, 0.1), "slave $\\mathbf{x}$", SLAVE),
        (c, (-0.05, -0.17, -0.2), "$\\boldsymbol{\\rho}(\\xi^1, \\xi^2)$", INK),
        (c + 0.35 * n, (0.0, 0.0, 0.07), "$\\mathbf{n}$", INK),
        (0.45 * c + 0.55 * slave, (-0.02, -0.05, -0.22), "gap $\\xi^3$", INK),
    ):
        ax.text(*(place + np.array(shift)), label, color=colour, fontsize=12, zorder=7)
    ax.set_axis_off()
    ax.set_box_aspect((1, 1, 1.05), zoom=1.35)
    ax.set(xlim=(-0.4, 1.6), ylim=(-1.0, 1.0), zlim=(-0.05, 1.95))
    ax.view_init(elev=22, azim=-42)
    return figure


def steady(rule: str, q: np.ndarray, **parameters: str) -> np.ndarray:
    """-T/N of long slides at the angles q to the first axis, (n, 2)."""
    marks = make_directions("constant", vector=(1, 0, 0))
    itf = Interface(
        make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)),
        NormalLaw(penalty=PENALTY),
        Adhesion(stiffness=STIFFNESS, directions=marks),
        Friction(coefficients=COEFFICIENTS, directions=marks, sliding_rule=rule, **parameters),
    )
    depth = np.array([0.0, 0.0, -PRESSURE / PENALTY])
    way = np.stack([np.cos(q), np.sin(q), 0 * q], axis=1)
    state = itf.initial_state(0 * way + depth)
    for s in np.linspace(0.0, 0.2, 101)[1:]:
        r = itf.update(state, s * way + depth, tangent=False)
        state = r.state
    return -r.traction_principal / PRESSURE


def rules() -> Figure:
    """Forces of one direction of slip on the ellipse; their directions for all."""
    figure = Figure(figsize=(11.0, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=(1.25, 1))
    left.plot(*force_domain(COEFFICIENTS, 0.0, 1.0).points().T, color=INK, linewidth=1.0)
    left.plot([0, 0.2], [0, 0.2], "--", color=INK, linewidth=0.9)
    left.annotate("slip, 45°", (0.16, 0.16), xytext=(4, -12), textcoords="offset points")
    q = np.radians(np.linspace(0.0, 90.0, 181))
    for rule, (colour, parameters) in RULES.items():
        t = steady(rule, q, **parameters)
        at = t[90]
        left.annotate(
            "", at, (0, 0), arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 2.0}
        )
        left.plot(*at, "o", color=colour, markersize=4, label=rule)
        angle = np.degrees(np.arctan2(t[:, 1], t[:, 0]))
        right.plot(np.degrees(q), angle, color=colour, linewidth=1.6, label=rule)
    left.set(
        xlabel="force opposed along $\\mathbf{e}_1$, $-T_1/N$",
        ylabel="along $\\mathbf{e}_2$, $-T_2/N$",
        xlim=(-0.32, 0.32),
        ylim=(-0.13, 0.22),
        title="Steady slip at 45°: one limit, four forces",
    )
    left.set_aspect("equal")
    right.set(
        xlabel="direction of slip [°]",
        ylabel="direction of the force opposed [°]",
        xlim=(0, 90),
        ylim=(0, 90),
        xticks=range(0, 91, 15),
        yticks=range(0, 91, 15),
        title="Direction of the force over that of slip",
    )
    right.set_aspect("equal")
    for ax in (left, right):
        ax.grid(linewidth=0.4, alpha=0.5)
    left.legend(loc="upper left", fontsize="small")
    return figure


if __name__ == "__main__":
    kinematics().savefig(HERE / "overview-kinematics.png", dpi=100)
    rules().savefig(HERE / "overview-rules.png", dpi=100)
