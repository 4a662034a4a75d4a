"""Sliding: (96) against maximum dissipation with the numbers of the page, misprints of (94)-(111).

Requirements and numbers: the section on the sliding force of docs/theory/errata.md, whose tables
are read here and computed anew. Sources: [Konyukhov Schweizerhof 2006], section 4; normality of
slip for the closed forms. The displacement is driven by hand on a plane.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

from anisocontact.anisotropy import DirectionField, make_directions
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw, slide
from anisocontact.surfaces import make_surface

PAGE = Path(__file__).parents[2] / "docs" / "theory" / "errata.md"
PLANE = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
MU, N, PENALTY, SLIDE = (0.3, 0.1), 10.0, 1e5, 0.05
F = np.diag([MU[0] ** -2, MU[1] ** -2])


def unit(angle: float) -> np.ndarray:
    return np.array([np.cos(angle), np.sin(angle)])


def rotated(values: Iterable[float], angle: float) -> np.ndarray:
    """Q diag(values) Q^T, (41)."""
    e = unit(angle), unit(angle + 0.5 * np.pi)
    return sum(v * np.outer(d, d) for v, d in zip(values, e, strict=True))


def marks(angle: float) -> DirectionField:
    return make_directions("constant", vector=(1, 0, 0), angle=angle)


def drag(
    rule: str,
    corners: Iterable[np.ndarray],
    steps: int,
    stiffness: tuple[float, float] = (1e3, 1e3),
) -> np.ndarray:
    """-T/N at the end of a path from the origin over the corners, in `steps` increments each.

    The rule is its name, "explicit" with its history after a comma.
    """
    name, _, history = rule.partition(", ")
    itf = Interface(
        PLANE,
        NormalLaw(penalty=PENALTY),
        Adhesion(stiffness=stiffness, directions=marks(0.0)),
        Friction(
            coefficients=MU,
            directions=marks(0.0),
            sliding_rule=name,
            **({"history": history} if history else {}),
        ),
    )
    at = np.zeros(2)
    state = itf.initial_state([[0.0, 0.0, -N / PENALTY]])
    for corner in corners:
        for x in at + np.linspace(0.0, 1.0, steps + 1)[1:, None] * (corner - at):
            response = itf.update(state, [[*x, -N / PENALTY]], tangent=False)
            state = response.state
        at = corner
    return -response.traction[0, :2] / N


def degrees(t: np.ndarray) -> float:
    return float(np.degrees(np.arctan2(t[1], t[0])))


def table(heading: str) -> list[list[str]]:
    """Rows of the first table of the page whose head begins with `heading`."""
    lines = PAGE.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith(f"| {heading} |"))
    rows = []
    for line in lines[first + 2 :]:
        if not line.startswith("|"):
            break
        rows.append([c.strip() for c in line.strip("|").split("|")])
    return rows


def test_incremental_history_does_not_converge() -> None:
    """1. With (112) the force turns to the dominant eigenvector of SF as the steps are refined.

    The page's angles to 0.01 degree, its last digit; each refinement turns the force further, past
    89.9 degrees at 2,560 steps, although the slip stays at 45 degrees.
    """
    rows = table("increments")
    assert [row[0] for row in rows] == ["10", "40", "320", "2560"]
    path = [SLIDE * unit(np.pi / 4)]
    angles = [degrees(drag("explicit, incremental", path, int(r[0]))) for r in rows]
    assert angles == pytest.approx([float(r[1]) for r in rows], abs=0.0051)
    assert np.all(np.diff(angles) > 0.0)
    assert angles[-1] > 89.89
    for k, rule in ((2, "explicit, centre"), (3, "maximum-dissipation")):
        same = [degrees(drag(rule, path, int(r[0]))) for r in rows[:3]]
        assert same == pytest.approx([float(r[k]) for r in rows[:3]], abs=0.0051)
        assert np.ptp(same) < 1e-3


def jump(rule: str, stiffness: tuple[float, float]) -> float:
    """Angle by which the force turns between 1e-9 before and after the limit, in degrees."""
    direction = unit(np.pi / 4)
    s = np.diag(stiffness)
    limit = N / np.sqrt(s @ direction @ F @ s @ direction)
    before, after = (
        drag(rule, [(1.0 + x) * limit * direction], 1, stiffness) for x in (-1e-9, 1e-9)
    )
    return degrees(after) - degrees(before)


def test_force_jumps_from_stick_to_slip() -> None:
    """3. (96) is not continuous at the limit unless BF ~ I, whatever the history.

    Isotropic S, trial force at 45 degrees: the page's number to its last digit. Where there is no
    jump the two forces are 1e-9 apart, as the two points are.
    """
    (page,) = re.findall(r"by ([\d.]+)° in the example", PAGE.read_text())
    for history in ("centre", "incremental", "kuhn-tucker"):
        assert jump(f"explicit, {history}", (1e3, 1e3)) == pytest.approx(float(page), abs=0.0051)
        assert abs(jump(f"explicit, {history}", (9e4, 1e4))) < 1e-6
    assert abs(jump("maximum-dissipation", (1e3, 1e3))) < 1e-6


def test_kuhn_tucker_history_freezes_the_force() -> None:
    """4. Slip along the displacement, (108)-(111), leaves the elastic force as it is.

    A path with a corner: the steps refined, the force at the end tends to that at the corner, as
    if the second leg were not there (first order: error halved, 1.8 to 2.2), while the history of
    centres follows it. The page's numbers to their last digit.
    """
    corners = [np.array([0.02, 0.005]), np.array([0.022, 0.012])]
    rows = table("history")
    for row, name in zip(rows, ("kuhn-tucker", "centre"), strict=True):
        assert row[0] == f"`{name}`"
        corner = degrees(drag(f"explicit, {name}", corners[:1], 2560))
        end = [degrees(drag(f"explicit, {name}", corners, n)) for n in (160, 640, 2560)]
        assert [corner, *end] == pytest.approx([float(c) for c in row[1:]], abs=0.0051)
    end = [degrees(drag("explicit, kuhn-tucker", corners, n)) for n in (1280, 2560)]
    corner = degrees(drag("explicit, kuhn-tucker", corners[:1], 2560))
    assert 1.8 < (end[0] - corner) / (end[1] - corner) < 2.2


def test_which_force_dissipates_most() -> None:
    """Of all admissible forces that of maximum dissipation has the largest -T.dxi_sl.

    100 random problems, 3,600 forces of the ellipse each: none beats that of the rule on its own
    slip (1e-12), while (96) is beaten by more than 1 % on its own in most problems.
    """
    rng = np.random.default_rng(11)
    angle = np.linspace(0.0, 2.0 * np.pi, 3600)
    ellipse = np.stack([MU[0] * np.cos(angle), MU[1] * np.sin(angle)], axis=1)
    trial = rng.normal(size=(100, 2)) + 1.0
    s = np.broadcast_to(np.diag([2.0, 0.5]), (100, 2, 2))
    f = np.broadcast_to(F, (100, 2, 2))
    ratio = {}
    for rule in ("maximum-dissipation", "explicit"):
        r = slide(s, f, trial, np.full(100, 0.1), rule)
        own = -np.einsum("ni,ni->n", r.traction, r.slip)
        ratio[rule] = (0.1 * ellipse @ -r.slip.T).max(axis=0)[r.slides] / own[r.slides]
    assert ratio["maximum-dissipation"].max() < 1.0 + 1e-12
    assert (ratio["explicit"] > 1.01).mean() > 0.5


def test_table_of_steady_slip() -> None:
    """The page's table of maximum dissipation against the closed form and a long slide.

    Slip at q: T/N = -(m1^2 cos q, m2^2 sin q)/h with h the drag; 1,000 elastic lengths in 200
    steps leave nothing of the start. Numbers of the page to their last digit.
    """
    rows = table("slip")
    assert len(rows) == 4
    for q, force, drag_, lateral in rows:
        e = unit(np.radians(float(q)))
        t = drag("maximum-dissipation", [0.05 * e], 200, (2e5, 5e4))
        c, s = e
        h = np.hypot(MU[0] * c, MU[1] * s)
        np.testing.assert_allclose(t, np.array([MU[0] ** 2 * c, MU[1] ** 2 * s]) / h, atol=1e-12)
        slope = (MU[1] ** 2 - MU[0] ** 2) * s * c / h
        assert t @ np.array([-s, c]) == pytest.approx(slope, abs=1e-12)
        assert degrees(t) == pytest.approx(float(force), abs=5.1e-4)
        assert t @ e == pytest.approx(float(drag_), abs=5.1e-6)
        assert slope == pytest.approx(float(lateral), abs=5.1e-6)


def test_tangents_in_closed_form() -> None:
    """Consistent tangents of the page: maximum dissipation by G, n; the explicit rule by h, s.

    dT = -[G - Gn (x) nG/(n.Gn)] dxi + N Gn/(n.Gn) dN with G = (S^-1 + l F)^-1, n = F T, and
    dT = -(N/s)(I - h (x) Fh/s^2) BF dT_tr - (h/s) dN with h = BFT_tr. 200 random symmetric S.
    """
    rng = np.random.default_rng(13)
    root = rng.normal(size=(200, 2, 2))
    s = root @ root.transpose(0, 2, 1) + 0.1 * np.eye(2)
    f = np.broadcast_to(F, s.shape)
    trial = rng.normal(size=(200, 2))
    n = 0.3 * np.sqrt(np.einsum("ni,nij,nj->n", trial, f, trial))
    r = slide(s, f, trial, n)
    e = slide(s, f, trial, n, "explicit")
    for k in range(200):
        normal = F @ r.traction[k]
        multiplier = -(r.slip[k] @ normal) / (normal @ normal)
        g = np.linalg.inv(np.linalg.inv(s[k]) + multiplier * F)
        gn = g @ normal
        by_slip = g - np.outer(gn, gn) / (normal @ gn)
        scale = np.abs(s[k]).max()
        np.testing.assert_allclose(r.d_trial[k] @ s[k], by_slip, atol=1e-10 * scale)
        np.testing.assert_allclose(r.d_pressure[k], n[k] * gn / (normal @ gn), atol=1e-10)
        h = -s[k] @ F @ trial[k]
        size = np.sqrt(h @ F @ h)
        by_trial = n[k] / size * (np.eye(2) - np.outer(h, F @ h) / size**2) @ s[k] @ F
        np.testing.assert_allclose(e.d_trial[k], by_trial, atol=1e-10 * np.abs(by_trial).max())
        np.testing.assert_allclose(e.d_pressure[k], -h / size, atol=1e-12)


# --- misprints of (94) to (111) ----------------------------------------------------------------


def test_sliding_force_is_proportional_to_the_pressure() -> None:
    """(99) prints the force without |N|; with it, as in (96), T.FT = N^2 and T doubles with N."""
    s, f = rotated((2.0, 0.5), 0.3), rotated((1 / 0.09, 1 / 0.01), 0.9)
    trial = np.array([4.0, 3.0])
    r = slide([s] * 2, [f] * 2, [trial] * 2, [0.35, 0.7], "explicit")
    printed = s @ f @ trial / np.sqrt(s @ f @ trial @ f @ s @ f @ trial)
    np.testing.assert_allclose(r.traction, np.outer([0.35, 0.7], printed), rtol=1e-12)


def test_sliding_force_has_the_transpose_of_b() -> None:
    """(93) with (91) gives -lambda B^T F T_tr; (94) prints B, which differs for unsymmetric B.

    Unsymmetric S = -B by the general linear model without relaxation. The direction of (93) is
    taken from central differences of Phi by the slip, whose error is some (1e-6)^2.
    """
    s = np.array([[3e5, 1e5], [-5e4, 1e5]])
    itf = Interface(
        PLANE,
        NormalLaw(penalty=PENALTY),
        Adhesion(
            "general-linear",
            relaxation=[0.0] * 4,
            stiffness_instant=s.ravel(),
            energy="none",
            directions=marks(0.0),
        ),
        Friction(coefficients=(0.3, 0.1), directions=marks(0.5), sliding_rule="explicit"),
    )
    f = rotated((1 / 0.09, 1 / 0.01), 0.5)
    move = np.array([3e-4, 2e-4])
    depth = -N / PENALTY
    start = itf.initial_state([[0.0, 0.0, depth]])
    t = itf.update(start, [[*move, depth]], tangent=False).traction[0, :2]

    def phi(slip: np.ndarray) -> float:
        trial = -s @ (move - slip)
        return float(np.sqrt(trial @ f @ trial))

    step = 1e-6 * np.linalg.norm(move) * np.eye(2)
    slope = np.array([phi(h) - phi(-h) for h in step])
    by_93 = N * slope / np.sqrt(slope @ f @ slope)
    printed = s @ f @ (-s @ move)
    printed *= N / np.sqrt(printed @ f @ printed)
    np.testing.assert_allclose(t, by_93, atol=1e-8 * N)
    assert np.linalg.norm(t - printed) > 0.1 * np.linalg.norm(t)


def test_slip_is_the_smaller_root() -> None:
    """(111): both roots are positive in a slide from rest; the larger one would create energy.

    500 random tensors. The equation is that of T_tr; with T_(2), a force on the ellipse, its
    constant term would vanish and so would the smaller root. The code takes the smaller root:
    its slip is that root times the increment, shorter than it, and leaves the force on the ellipse.
    """
    rng = np.random.default_rng(7)
    eps, mu, angle = (rng.uniform(a, b, (500, 2)) for a, b in ((0.5, 4), (0.1, 0.5), (0, 3)))
    s = np.stack([rotated(e, a) for e, a in zip(eps, angle[:, 0], strict=True)])
    f = np.stack([rotated(m**-2.0, a) for m, a in zip(mu, angle[:, 1], strict=True)])
    d = rng.normal(size=(500, 2))
    trial = -np.einsum("nij,nj->ni", s, d)
    size = np.sqrt(np.einsum("ni,nij,nj->n", trial, f, trial))
    n = size * rng.uniform(0.1, 0.9, 500)
    r = slide(s, f, trial, n, "explicit", increment=d, history="kuhn-tucker")
    for k in range(500):
        sd = s[k] @ d[k]
        a, b = sd @ f[k] @ sd, trial[k] @ f[k] @ sd
        roots = np.sort(np.roots([a, 2 * b, size[k] ** 2 - n[k] ** 2]).real)
        assert 0.0 < roots[0] < 1.0 < roots[1]
        np.testing.assert_allclose(r.slip[k], roots[0] * d[k], rtol=1e-10)
        dissipated = [-(trial[k] + x * sd) @ (x * d[k]) for x in roots]
        assert dissipated[0] > 0.0 > dissipated[1]
    squared = np.einsum("ni,nij,nj->n", r.stored, f, r.stored)
    np.testing.assert_allclose(squared, n**2, rtol=1e-11)
