"""Updates per second and core of the core: sliding rules, projection, whole interface.

Run: python benchmarks/kernel_rates.py [-o FOLDER]

Prints a table and writes it as `kernel_rates.json` and `kernel_rates.md`. Rates are points per
second of processor time of one thread, the best of several passes, so that other work on the
machine matters little; arrays in and out of Python are part of it.
"""

from __future__ import annotations

import argparse
import json
import platform
import re
import subprocess
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

import anisocontact
from anisocontact import _core
from anisocontact.anisotropy import make_directions
from anisocontact.base import registry
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw, slide
from anisocontact.surfaces import make_surface

POINTS, PASSES = 100_000, 7
BAR = 4e6  # points per second and core, maximum-dissipation with tangent

RULES: dict[str, dict[str, object]] = {
    "maximum-dissipation": {},
    "linear": {},
    "coaxial": {},
    "slip-ellipse": {"slip_axes": (2.0, 1.0), "slip_angle": 0.3},
    "radial": {},
    "explicit": {"history": "centre"},
}
#: Control points of x and of x^2 on a Bezier curve of degree 2 over [-1, 1].
PARABOLA = ((-1.0, 1.0), (0.0, -1.0), (1.0, 1.0))
# Surfaces that touch the plane z = 0 from below at the origin, but for the ring and the thread.
SURFACES: dict[str, dict[str, object]] = {
    "plane": {"point": (0, 0, 0), "normal": (0, 0, 1)},
    "cylinder": {"point": (0, 0, -2), "axis": (0, 1, 0), "radius": 2.0},
    "sphere": {"centre": (0, 0, -2), "radius": 2.0, "axis": (1, 0, 0)},
    "cone": {"apex": (-2, 0, 0), "axis": (1, 0, -0.5), "angle": 0.4636476090008061},
    "torus": {"centre": (0, 0, -0.5), "axis": (0, 0, 1), "radius": 1.5, "tube": 0.5},
    "ellipsoid": {"centre": (0, 0, -1), "semi_axes": (3, 2, 1), "axis": (1, 0, 0)},
    "helicoid": {
        "point": (-1.5, 0, 1.25),
        "axis": (0, 0, 1),
        "lead": 5.0,
        "inner": 1.0,
        "outer": 2.0,
        "start": (0, 1, 0),
    },
    "revolution": {
        "point": (0, 0, -2),
        "axis": (0, 1, 0),
        "profile": (1.8, 1.0, 2.0, 0.0, 1.8, -1.0),
        "spline": True,
    },
    "nurbs": {
        "degrees": (2, 2),
        "knots_1": (0, 0, 0, 1, 1, 1),
        "knots_2": (0, 0, 0, 1, 1, 1),
        "points": [c for x, a in PARABOLA for y, b in PARABOLA for c in (x, y, -0.25 * (a + b))],
    },
}


@dataclass(frozen=True)
class Rate:
    """Points per second and core."""

    what: str
    value: float
    with_tangent: float


def rate(update: Callable[[], object], points: int) -> float:
    """Points per second of processor time, best pass."""
    best = np.inf
    for _ in range(PASSES):
        start = time.process_time()
        update()
        best = min(best, time.process_time() - start)
    return points / best


def tensors(r: np.random.Generator, low: float, high: float) -> np.ndarray:
    """Random positive tensors, (n, 2, 2)."""
    a = r.uniform(0.0, np.pi, POINTS)
    q = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]])
    return np.ascontiguousarray(
        np.einsum("ijn,nj,kjn->nik", q, r.uniform(low, high, (POINTS, 2)), q)
    )


def laws() -> list[Rate]:
    """Every sliding rule by itself, all points sliding, N from 0.1 to 0.9 of the trial force."""
    r = np.random.default_rng(1)
    s, f, t = tensors(r, 50.0, 400.0), tensors(r, 10.0, 100.0), r.normal(size=(POINTS, 2))
    n = r.uniform(0.1, 0.9, POINTS) * np.sqrt(np.einsum("ni,nij,nj->n", t, f, t))
    return [
        Rate(
            f"law: {name}",
            *(
                rate(
                    lambda name=name, p=p, tangent=tangent: slide(
                        s, f, t, n, name, tangent=tangent, threads=1, **p
                    ),
                    POINTS,
                )
                for tangent in (False, True)
            ),
        )
        for name, p in RULES.items()
    ]


def projections() -> list[Rate]:
    """Closest point on each surface, without and with its derivatives."""
    x = np.random.default_rng(2).uniform(-0.3, 0.3, (POINTS, 3))
    result = []
    for name, parameters in SURFACES.items():
        surface = make_surface(name, **parameters)
        rates = (
            rate(lambda s=surface, d=d: s.project(x, derivatives=d, threads=1), POINTS)
            for d in (False, True)
        )
        result.append(Rate(f"projection: {name}", *rates))
    return result


def interface(surface: str, rule: str) -> Interface:
    """Adhesion and friction with axes apart."""
    first = make_directions("constant", vector=(1.0, 0.2, 0.1), angle=0.3)
    second = make_directions("constant", vector=(1.0, 0.2, 0.1), angle=-0.2)
    return Interface(
        make_surface(surface, **SURFACES[surface]),
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(400.0, 100.0), directions=first),
        Friction(coefficients=(0.3, 0.1), directions=second, sliding_rule=rule, **RULES[rule]),
        threads=1,
    )


def update(surface: str, rule: str) -> Rate:
    """`Interface.update` of points that slide, from a state with history."""
    itf = interface(surface, rule)
    x = np.random.default_rng(3).uniform(-0.3, 0.3, (POINTS, 3))
    p = itf.surface.project(x)
    normal = itf.surface.geometry(p.xi).normal
    x = itf.surface.position(p.xi) - 1e-3 * normal
    along = np.cross(normal, [0.3, 1.0, 0.2])
    along *= 3e-3 / np.linalg.norm(along, axis=1)[:, None]
    state = itf.update(itf.initial_state(x), x + along).state
    moved = x + 2.0 * along
    sliding = (itf.update(state, moved).status == 2).mean()
    assert sliding > 0.99, (surface, rule, sliding)
    rates = (rate(lambda t=t: itf.update(state, moved, tangent=t), POINTS) for t in (False, True))
    return Rate(f"update: {surface}, {rule}", *rates)


def updates() -> list[Rate]:
    """Every rule on the plane, the default rule on every surface."""
    on_plane = [update("plane", rule) for rule in RULES]
    return on_plane + [update(s, "maximum-dissipation") for s in SURFACES if s != "plane"]


def first_line(command: list[str], pattern: str = "(.*)") -> str:
    """What a command prints, or "unknown"."""
    try:
        printed = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    except OSError:
        return "unknown"
    found = re.search(pattern, printed)
    return found[1].strip() if found else "unknown"


def compiler() -> str:
    """The compiler that the core itself names."""
    binary = Path(_core.__file__).read_bytes()
    found = re.search(rb"GCC: \([^)]*\) [\d.]+|clang version [\d.]+", binary)
    return found[0].decode() if found else "unknown"


def machine() -> dict[str, str]:
    """What the rates were measured on."""
    here = Path(__file__).parent
    return {
        "processor": first_line(["lscpu"], r"Model name:\s*(.*)"),
        "system": platform.platform(),
        "compiler": compiler(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "anisocontact": anisocontact.__version__,
        "commit": first_line(["git", "-C", str(here), "describe", "--always", "--dirty"]),
    }


def markdown(about: dict[str, str], rates: list[Rate]) -> str:
    """The table, in millions of points per second and core."""
    lines = [f"- {key}: {value}" for key, value in about.items()]
    lines += ["", "| million points per second and core | value | with tangent |", "|---|---|---|"]
    lines += [f"| {r.what} | {r.value / 1e6:.2f} | {r.with_tangent / 1e6:.2f} |" for r in rates]
    lines += ["", f"Bar for maximum-dissipation with tangent: {BAR / 1e6:.0f}."]
    for what in ("law: maximum-dissipation", "update: plane, maximum-dissipation"):
        found = next(r for r in rates if r.what == what).with_tangent
        lines.append(f"- {what}: {found / 1e6:.2f}, {'met' if found >= BAR else 'not met'}")
    return "\n".join(lines) + "\n"


def main() -> None:
    """Measures, prints and writes."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("-o", "--output", type=Path, default=Path("results/benchmarks"))
    folder = parser.parse_args().output
    for names, entries in ((RULES, registry.sliding_rules()), (SURFACES, registry.surfaces())):
        missing = [e.name for e in entries if e.name not in names]
        if missing:
            print(f"not measured: {', '.join(missing)}")
    about, rates = machine(), laws() + projections() + updates()
    text = markdown(about, rates)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "kernel_rates.md").write_text(text)
    content = {"machine": about, "rates": [asdict(r) for r in rates]}
    (folder / "kernel_rates.json").write_text(json.dumps(content, indent=2) + "\n")
    print(text, end="")


if __name__ == "__main__":
    main()
