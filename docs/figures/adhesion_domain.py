"""Pictures of the page on the adhesion domain, as figures 5 and 6 of the paper.

Run: python docs/figures/adhesion_domain.py
"""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from anisocontact.anisotropy import make_directions
from anisocontact.interface import Interface
from anisocontact.laws import (
    Adhesion,
    Friction,
    NormalLaw,
    adhesion_domain,
    draw_force_plane,
    draw_tangent_plane,
    force_domain,
)
from anisocontact.surfaces import make_surface

HERE = Path(__file__).parent
STIFFNESS, ALPHA = (2.0, 1.0), np.radians(15.0)  # MPa/mm
COEFFICIENTS, BETA = (0.3, 0.15), np.radians(50.0)
PRESSURE, PENALTY = 1.0, 1e3  # MPa, MPa/mm


def interface() -> Interface:
    """A plane with different directions for adhesion and friction."""

    def turned(angle):
        return make_directions("constant", vector=(1, 0, 0), angle=angle)

    return Interface(
        make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0)),
        NormalLaw(penalty=PENALTY),
        Adhesion(stiffness=STIFFNESS, directions=turned(ALPHA)),
        Friction(coefficients=COEFFICIENTS, directions=turned(BETA)),
    )


def drag(path):
    """Trial force, force and centre of the adhesion domain at each point of a path."""
    itf = interface()
    depth = -PRESSURE / PENALTY
    x = np.column_stack([path, np.full(len(path), depth)])
    state = itf.initial_state(x[:1])
    q = np.array([[np.cos(ALPHA), -np.sin(ALPHA)], [np.sin(ALPHA), np.cos(ALPHA)]])
    b = -q @ np.diag(STIFFNESS) @ q.T
    trials, forces, centres = [], [], [path[0]]
    for p in x:
        trials.append(b @ (p[:2] - centres[-1]))
        r = itf.update(state, p[None])
        state = r.state
        forces.append(r.traction[0, :2])
        centres.append(p[:2] - state["elastic"][0])
    return np.array(trials), np.array(forces), np.array(centres[1:])


def planes() -> Figure:
    """Figure 5: the domain of forces, of elastic slips, and the strip."""
    angle = np.radians(25.0)
    path = np.linspace(0.0, 0.3, 13)[:, None] * [np.cos(angle), np.sin(angle)]
    trial, force, centres = drag(path)
    figure = Figure(figsize=(12.6, 5.0), layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    draw_force_plane(
        force_domain(COEFFICIENTS, BETA, PRESSURE), trial=trial, force=force, unit="MPa", axes=left
    )
    left.set_title("Forces: semi-axes $\\mu_i N$, first at $\\beta$ = 50°")
    domain = adhesion_domain(STIFFNESS, ALPHA, COEFFICIENTS, BETA, PRESSURE)
    draw_tangent_plane(domain, path=path, centres=centres, unit="mm", axes=middle)
    middle.set_title("Elastic slips on the tangent plane, $\\alpha$ = 15°")
    strip = adhesion_domain((0.0, STIFFNESS[1]), ALPHA, COEFFICIENTS, BETA, PRESSURE)
    draw_tangent_plane(strip, unit="mm", axes=right)
    right.set_title("Strip, $\\varepsilon_1$ = 0: no force along $\\alpha$ = 15°")
    return figure


def update() -> Figure:
    """Figure 6: the centre follows the point while it slides."""
    out, back = np.linspace(0.0, 0.6, 13), np.linspace(0.0, 0.6, 13)[1:]
    path = np.concatenate(
        [np.column_stack([out, 0 * out]), np.column_stack([0.6 - 0.5 * back, 0.8 * back])]
    )
    _, _, centres = drag(path)
    domain = adhesion_domain(STIFFNESS, ALPHA, COEFFICIENTS, BETA, PRESSURE)
    figure = Figure(figsize=(6.6, 5.8), layout="constrained")
    ax = figure.add_subplot()
    draw_tangent_plane(domain, path=path, centres=centres, unit="mm", axes=ax)
    for name, point in (("A", path[0]), ("B", path[12]), ("C", path[-1])):
        ax.annotate(name, point, textcoords="offset points", xytext=(6, 6), weight="bold")
    ax.set_title("The centre follows the point from A over B to C")
    return figure


if __name__ == "__main__":
    planes().savefig(HERE / "adhesion-domain-planes.png", dpi=100)
    update().savefig(HERE / "adhesion-domain-update.png", dpi=100)
