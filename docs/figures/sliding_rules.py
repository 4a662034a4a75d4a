"""Tables of the page on the laws in verification, and the picture of the page on the sliding rules.

Run: python docs/figures/sliding_rules.py
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from anisocontact.laws import slide

HERE = Path(__file__).parent
PAGE = HERE.parent / "verification" / "laws.md"

COEFFICIENTS = np.array([0.3, 0.1])
FRICTION = np.diag(COEFFICIENTS**-2)
LENGTH = 0.01  # of the paths; N = 1, so that the elastic slip at the limit is some 0.003 to 0.0005
STEPS = (16, 64, 256, 1024)
FINE = 4096


@dataclass(frozen=True)
class Rule:
    """A sliding rule as it is drawn and tabulated."""

    name: str
    parameters: dict[str, object] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """Name, and the history of `explicit`."""
        history = self.parameters.get("history")
        return f"{self.name}, {history}" if history else self.name


RULES = (
    Rule("maximum-dissipation"),
    Rule("linear"),
    Rule("coaxial"),
    Rule("slip-ellipse", {"slip_axes": (2.0, 1.5), "slip_angle": 0.2}),
    Rule("radial"),
    Rule("explicit", {"history": "centre"}),
    Rule("explicit", {"history": "incremental"}),
    Rule("explicit", {"history": "kuhn-tucker"}),
)


def tensor(first: float, second: float, angle: float) -> np.ndarray:
    """Symmetric tensor with its first axis at `angle`."""
    c, s = np.cos(angle), np.sin(angle)
    q = np.array([[c, -s], [s, c]])
    return q @ np.diag([first, second]) @ q.T


STIFFNESS = tensor(200.0, 100.0, np.radians(30.0))


def drag(rule: Rule, path: np.ndarray, pressure: np.ndarray, stiffness: np.ndarray) -> np.ndarray:
    """Forces of a point without history that is led along a path, the law alone."""
    stored, forces = np.zeros((1, 2)), []
    for increment, n in zip(np.diff(path, axis=0)[:, None], pressure[1:], strict=True):
        r = slide(
            stiffness[None],
            FRICTION[None],
            stored - increment @ stiffness,
            [n],
            rule.name,
            increment=increment,
            tangent=False,
            threads=1,
            **rule.parameters,
        )
        stored = r.stored
        forces.append(r.traction[0])
    return np.array(forces)


def half_circle(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The direction turns all the time, N = 1."""
    path = LENGTH * np.stack([np.sin(np.pi * s), 1.0 - np.cos(np.pi * s)], -1)
    return path, np.ones_like(s)


def corner(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Along x, then along y, while N falls from 1 to 1/2."""
    path = LENGTH * np.stack([np.minimum(2 * s, 1.0), np.maximum(2 * s - 1.0, 0.0)], -1)
    return path, 1.0 - 0.5 * s


PATHS: dict[str, Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]] = {
    "half circle": half_circle,
    "corner, N falling": corner,
}


def refinement(rule: Rule, path: str) -> list[float]:
    """Largest difference of the force, over the path, from that of FINE steps, for STEPS."""

    def forces(n: int) -> np.ndarray:
        return drag(rule, *PATHS[path](np.linspace(0.0, 1.0, n + 1)), STIFFNESS)

    fine = forces(FINE)
    return [
        float(np.linalg.norm(forces(n) - fine[FINE // n - 1 :: FINE // n], axis=1).max())
        for n in STEPS
    ]


def order(errors: list[float]) -> float:
    """Observed order over the last quartering of the step but one."""
    return float(np.log2(errors[1] / errors[2]) / 2.0)


def degrees(t: np.ndarray) -> float:
    """Direction of a vector."""
    return float(np.degrees(np.arctan2(t[1], t[0])))


def incremental(steps: int) -> float:
    """Angle of the force of `incremental` after a slip of 0.05 at 45 degrees, isotropic S = 100
    N."""
    path = np.linspace(0.0, 0.05, steps + 1)[:, None] * [np.sqrt(0.5), np.sqrt(0.5)]
    return degrees(-drag(RULES[6], path, np.ones(steps + 1), 100.0 * np.eye(2))[-1])


def steady(rule: Rule, angle: float, stiffness: np.ndarray | None = None) -> np.ndarray:
    """Force against steady slip at an angle, N = 1."""
    s = 100.0 * np.eye(2) if stiffness is None else stiffness
    path = np.linspace(0.0, 0.2, 401)[:, None] * [np.cos(angle), np.sin(angle)]
    return -drag(rule, path, np.ones(401), s)[-1]


def refinement_table() -> list[str]:
    """Rows of the table of refinement."""
    head = [
        "| path | rule | " + " | ".join(f"{n} steps" for n in STEPS) + " | order |",
        "|---|---|" + "---|" * (len(STEPS) + 1),
    ]
    for path in PATHS:
        for rule in RULES:
            e = refinement(rule, path)
            numbers = " | ".join(f"{x:.1e}" for x in e)
            head.append(f"| {path} | `{rule.label}` | {numbers} | {order(e):.1f} |")
    return head


def steady_table() -> list[str]:
    """Rows of the table of steady slip: angle of the force and drag for each rule."""
    rules = [r for r in RULES if r.parameters.get("history") in (None, "centre")]
    angles = (15, 30, 45, 60, 75)
    head = [
        "| rule | " + " | ".join(f"{q}°" for q in angles) + " |",
        "|---|" + "---|" * len(angles),
    ]
    for rule in rules:
        cells = []
        for q in angles:
            t = steady(rule, np.radians(q))
            drag_part = t @ [np.cos(np.radians(q)), np.sin(np.radians(q))]
            cells.append(f"{degrees(t):.3f}°, {drag_part:.5f}")
        head.append(f"| `{rule.label}` | " + " | ".join(cells) + " |")
    return head


def incremental_table() -> list[str]:
    """Rows of the table of the history that does not converge."""
    counts = (10, 40, 320)
    return [
        "| steps | " + " | ".join(map(str, counts)) + " |",
        "|---|" + "---|" * len(counts),
        "| angle of the force | " + " | ".join(f"{incremental(n):.1f}°" for n in counts) + " |",
    ]


def page() -> str:
    """The page on the laws, its tables measured now."""
    text = (HERE / "sliding_rules.md.in").read_text()
    for name, rows in (
        ("refinement", refinement_table()),
        ("steady", steady_table()),
        ("incremental", incremental_table()),
    ):
        text = text.replace(f"@{name}@", "\n".join(rows))
    return text


def picture() -> Figure:
    """Direction and size of the steady force over the direction of slip."""
    figure = Figure(figsize=(10.4, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    angles = np.linspace(0.0, 90.0, 61)
    rules = (
        Rule("maximum-dissipation"),
        Rule("linear"),
        Rule("coaxial"),
        Rule("slip-ellipse", {"slip_axes": (1.0, 2.0)}),
        Rule("explicit", {"history": "centre"}),
    )
    for rule, style in zip(rules, ("-", "--", "-.", ":", (0, (5, 1, 1, 1, 1, 1))), strict=True):
        t = np.array([steady(rule, np.radians(q)) for q in angles])
        e = np.stack([np.cos(np.radians(angles)), np.sin(np.radians(angles))], -1)
        label = rule.label + (", $k_1/k_2$ = 1/2" if rule.name == "slip-ellipse" else "")
        turn = np.degrees(np.arctan2(t[:, 1], t[:, 0])) - angles
        left.plot(angles, turn, linestyle=style, label=label)
        right.plot(angles, (t * e).sum(1), linestyle=style, label=label)
    left.set_ylabel("angle of the friction force to $-$slip [°]")
    right.set_ylabel("drag / N")
    for axes in (left, right):
        axes.set_xlabel("angle of slip to the first axis [°]")
        axes.set_xlim(0.0, 90.0)
        axes.grid(alpha=0.3)
    right.legend(fontsize="small")
    left.set_title("Direction of the friction force")
    right.set_title("Drag along the slip")
    figure.suptitle("One friction ellipse, $\\mu_1$ = 0.3, $\\mu_2$ = 0.1; isotropic adhesion")
    return figure


if __name__ == "__main__":
    PAGE.write_text(page())
    picture().savefig(HERE / "sliding-rules.png", dpi=100)
