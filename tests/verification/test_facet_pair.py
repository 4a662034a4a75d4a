"""Tangent of a slave point against a deforming facet, by order of convergence, and its invariances.

Requirement: the tangent is exact in every branch (open, stick, slip), for every pair of facets and
every sliding rule, with the change of normal, projection, metric, directions and slave area, and
with the facet on which the history was committed. Source: central differences of the nodal forces
with the projection solved anew; their error quarters as the step is halved.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from anisocontact import _core
from anisocontact.anisotropy import make_directions
from anisocontact.base import registry
from anisocontact.contact.plane_axes import unit_normal
from anisocontact.interface import STATE, ContactLaw, as_state, raw_state
from anisocontact.laws import Adhesion, Friction, NormalLaw

TOPOLOGIES = ("tri3", "tri6", "quad4", "quad8", "quad9")
RULES = tuple(e.name for e in registry.sliding_rules())
NODES = {
    "tri3": [(0, 0), (1, 0), (0, 1)],
    "quad4": [(0, 0), (1, 0), (0, 1), (1, 1)],
}
NODES["tri6"] = [*NODES["tri3"], (0.5, 0.5), (0, 0.5), (0.5, 0)]
NODES["quad8"] = [*NODES["quad4"], (0.5, 0), (0, 0.5), (1, 0.5), (0.5, 1)]
NODES["quad9"] = [*NODES["quad8"], (0.5, 0.5)]
POWERS = {
    "tri3": [(0, 0), (1, 0), (0, 1)],
    "tri6": [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)],
    "quad4": [(0, 0), (1, 0), (0, 1), (1, 1)],
    "quad8": [(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2), (2, 1), (1, 2)],
}
POWERS["quad9"] = [*POWERS["quad8"], (2, 2)]


def _monomials(topology: str, xi: np.ndarray, d: tuple[int, int] = (0, 0)) -> np.ndarray:
    """Derivative d of the monomials of a topology."""
    out = []
    for p in POWERS[topology]:
        value = 1.0
        for power, order, x in zip(p, d, xi, strict=True):
            factor = float(np.prod([power - i for i in range(order)]))
            value *= factor * (x ** (power - order) if power >= order else 0.0)
        out.append(value)
    return np.array(out)


def shape(topology: str, xi: np.ndarray, d: tuple[int, int] = (0, 0)) -> np.ndarray:
    """Shape functions by interpolation of monomials, written independently of the core."""
    return np.asarray(_monomials(topology, xi, d) @ _interpolation(topology))


@cache
def _interpolation(topology: str) -> np.ndarray:
    """Coefficients of the monomials in the shape functions."""
    vandermonde = np.array([_monomials(topology, np.array(n, float)) for n in NODES[topology]])
    return np.linalg.inv(vandermonde)


def project(topology: str, nodes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Coordinates of the closest point by Newton from the middle."""
    xi = np.array([0.3, 0.3])
    for _ in range(50):
        r = x - shape(topology, xi) @ nodes
        d = [shape(topology, xi, k) @ nodes for k in ((1, 0), (0, 1))]
        dd = [
            [shape(topology, xi, k) @ nodes for k in row]
            for row in (((2, 0), (1, 1)), ((1, 1), (0, 2)))
        ]
        f = np.array([r @ d[0], r @ d[1]])
        jac = np.array([[d[i] @ d[j] - r @ dd[i][j] for j in range(2)] for i in range(2)])
        step = np.linalg.solve(jac, f)
        xi = xi + step
        if np.abs(step).max() < 1e-15:
            break
    return xi


@dataclass(frozen=True)
class Setting:
    """A slave facet above two master facets; the history was committed on the second."""

    core: _core.FacetInterface
    slave: str
    master: str
    now: np.ndarray
    reference: np.ndarray
    state: np.ndarray
    at: np.ndarray

    def update(
        self, now: np.ndarray, tangent: bool = True, repeat: int = 1, threads: int = 1
    ) -> dict[str, np.ndarray]:
        return self.ask(self.core.update, now, tangent, repeat, threads)

    def ask(
        self, ask: Callable[..., Any], now: np.ndarray, tangent: bool, repeat: int, threads: int
    ) -> dict[str, Any]:
        """What the core answers for the point, given several times."""
        ks, km = len(NODES[self.slave]), len(NODES[self.master])
        n, dn = (
            shape(self.slave, self.at),
            np.stack([shape(self.slave, self.at, k) for k in ((1, 0), (0, 1))], axis=1),
        )
        xi = project(self.master, now[ks : ks + km], n @ now[:ks])
        connectivity = np.arange(ks, ks + 2 * km, dtype=np.int32).reshape(2, km)
        return ask(
            raw_state(np.repeat(self.state, repeat)),
            0.5,
            np.tile(np.arange(ks, dtype=np.int32), (repeat, 1)),
            np.tile(n, (repeat, 1)),
            np.tile(dn, (repeat, 1, 1)),
            np.full(repeat, 0.7),
            True,
            now,
            self.reference,
            connectivity,
            np.full(2, TOPOLOGIES.index(self.master), dtype=np.int8),
            np.zeros(2, dtype=np.bool_),
            np.zeros(repeat, dtype=np.int32),
            np.tile(xi, (repeat, 1)),
            np.zeros(repeat, dtype=np.int8),
            np.zeros((repeat, 2)),
            np.zeros((0, 3, 3)),
            np.ones(repeat, dtype=np.bool_),
            tangent,
            threads,
        )


def _bumpy(nodes: list[tuple[float, float]]) -> np.ndarray:
    """A facet that is curved as far as its nodes let it."""
    return np.array([(u, v, 0.1 * np.sin(2 * u) - 0.08 * v * v + 0.05 * u * v) for u, v in nodes])


def make(
    slave: str,
    master: str,
    rule: str,
    status: str,
    seed: int = 0,
    on: tuple[str, str, str] = ("master", "master", "slave"),
    second: bool = False,
) -> Setting:
    """A random setting in which the point has the status asked for."""
    rng = np.random.default_rng(seed)
    upper, lower = (_bumpy(NODES[t]) for t in (slave, master))
    before = lower + np.array([0.02, -0.015, 0.0])
    at = np.array([0.28, 0.35])
    nodes = np.concatenate([upper, lower, before])
    nodes += rng.normal(0, 0.004, nodes.shape)
    ks, km = len(upper), len(lower)
    x, facet = shape(slave, at) @ nodes[:ks], nodes[ks : ks + km]
    foot = shape(master, project(master, facet, x)) @ facet
    nodes[:ks, 2] += foot[2] - x[2] + (0.05 if status == "open" else -0.03)
    reference = nodes + rng.normal(0, 0.02, nodes.shape)
    marks = make_directions("polar", axis=((-0.7, -0.4, 0), (0, 0.1, 1)))
    other = make_directions("constant", vector=(1, 0.3, 0), angle=0.5)
    mu = {"stick": 50.0}.get(status, 0.3)
    model = {"coefficients": (mu, 0.4 * mu)} if not second else {"alpha": (mu, 0.5 * mu, 0.3 * mu)}
    friction = Friction(
        "he-curnier" if second else "orthotropic",
        directions=other,
        directions_second=marks if second else None,
        directions_on=on[1],
        directions_second_on=on[2],
        sliding_rule=rule,
        **model,
        **_required(rule),
    )
    adhesion = Adhesion(stiffness=(60.0, 25.0), directions=marks, directions_on=on[0])
    core = ContactLaw(NormalLaw(penalty=100.0), adhesion, friction).on_facets().core
    state = np.zeros(1, dtype=STATE)
    state["facet"], state["status"], state["xi"] = 1, 1, (0.31, 0.27)
    state["stored"] = state["traction"] = rng.normal(0, 0.3, 2)
    state["elastic"] = rng.normal(0, 0.01, 2)
    state["gap"], state["pressure"] = -0.02, 2.0
    return Setting(core, slave, master, nodes, reference, state, at)


def _required(rule: str) -> dict[str, object]:
    entry = next(e for e in registry.sliding_rules() if e.name == rule)
    samples = {"pair": (0.4, 0.2), "scalar": 0.3}
    return {p.name: samples[p.kind] for p in entry.parameters if p.required}


def _errors(s: Setting, steps: tuple[float, ...]) -> list[float]:
    """Error of central differences along a random direction of all nodes."""
    r = s.update(s.now)
    rng = np.random.default_rng(9)
    d = rng.normal(size=s.now.shape)
    columns = np.concatenate([d[i] if i >= 0 else np.zeros(3) for i in r["nodes"][0]])
    exact = r["tangent"][0] @ columns
    out = []
    for h in steps:
        ends = [s.update(s.now + sign * h * d, False)["residual"][0] for sign in (1, -1)]
        out.append(float(np.linalg.norm((ends[0] - ends[1]) / (2 * h) - exact)))
    return out


STATUS = {"open": 0, "stick": 1, "slip": 2}


@pytest.mark.parametrize("status", ["stick", "slip"])
@pytest.mark.parametrize("master", TOPOLOGIES)
@pytest.mark.parametrize("slave", TOPOLOGIES)
def test_tangent_of_every_pair(slave: str, master: str, status: str) -> None:
    """Halving the step quarters the error (asserted 3.6 to 4.4) for every pair of facets."""
    s = make(slave, master, "maximum-dissipation", status)
    assert as_state(s.update(s.now)["state"])["status"][0] == STATUS[status]
    e = _errors(s, (4e-4, 2e-4))
    assert 3.6 < e[0] / e[1] < 4.4


@pytest.mark.parametrize("status", ["stick", "slip"])
@pytest.mark.parametrize("master", TOPOLOGIES)
def test_slip_of_a_point_that_stays(master: str, status: str) -> None:
    """What slip and gap make of the nodal forces at one place: the same order.

    Source: friction follows slip through the trial force alone, the stored one less the stiffness
    times the slip, and the pressure the gap less its offset: these are changed instead.
    """
    s = make("quad4", master, "maximum-dissipation", status)
    r = s.update(s.now)
    km, axes = len(NODES[master]), r["adhesion_axes"][0]
    ahead = [(1, 0), (0, 1)]
    before = np.array([shape(master, s.state["xi"][0], k) @ s.now[4 + km :] for k in ahead])
    stiffness = np.einsum("a,ai,aj->ij", (60.0, 25.0), axes, axes)
    way = np.array([0.4, -0.7, 0.5])
    gap = r["normal"][0] @ way
    force = turned(stiffness @ way, r["normal"][0], unit_normal(before[None])[0])
    errors = []
    for h in (4e-3, 2e-3):
        ends = []
        for k in (h, -h):
            state = s.state.copy()
            state["stored"] -= k * before @ force
            state["offset"] -= k * gap
            ends.append(replace(s, state=state).update(s.now, False)["residual"][0])
        errors.append(np.linalg.norm((ends[0] - ends[1]) / (2 * h) - way @ r["by_slip"][0]))
    if status == "stick":
        assert max(errors) < 1e-9 * 60.0
    else:
        assert 3.6 < errors[0] / errors[1] < 4.4


def turned(v: np.ndarray, normal: np.ndarray, other: np.ndarray) -> np.ndarray:
    """A tangent vector turned with the least rotation from one normal to another."""
    return np.asarray(v - v @ other / (1.0 + normal @ other) * (normal + other))


@pytest.mark.parametrize("rule", RULES)
def test_tangent_of_every_rule(rule: str) -> None:
    """The same for every sliding rule in slip."""
    s = make("quad4", "quad9", rule, "slip")
    assert as_state(s.update(s.now)["state"])["status"][0] == STATUS["slip"]
    e = _errors(s, (4e-4, 2e-4))
    assert 3.6 < e[0] / e[1] < 4.4


@pytest.mark.parametrize("status", ["stick", "slip"])
@pytest.mark.parametrize(
    ("on", "second"),
    [
        (("slave", "master", "slave"), False),
        (("master", "slave", "slave"), False),
        (("master", "master", "slave"), True),
        (("slave", "slave", "master"), True),
    ],
)
def test_tangent_with_directions_on_the_slave(
    on: tuple[str, str, str], second: bool, status: str
) -> None:
    """The same where the slave carries directions, so that its tangents count, too."""
    s = make("quad9", "quad4", "maximum-dissipation", status, 0, on, second)
    assert as_state(s.update(s.now)["state"])["status"][0] == STATUS[status]
    e = _errors(s, (4e-4, 2e-4))
    assert 3.6 < e[0] / e[1] < 4.4


def test_open_point_has_no_force() -> None:
    """Above the facet: no force, no tangent, status open."""
    s = make("quad4", "tri6", "maximum-dissipation", "open")
    r = s.update(s.now)
    assert as_state(r["state"])["status"][0] == STATUS["open"]
    assert not r["residual"].any()
    assert not r["tangent"].any()


def _dense(blocks: tuple[Any, ...], nodes: int) -> np.ndarray:
    """Blocks as one matrix."""
    out = np.zeros((3 * nodes, 3 * nodes))
    for rows, columns, values in blocks:
        for r, c, block in zip(rows, columns, values, strict=True):
            i, j = ((3 * n[:, None] + np.arange(3)).ravel() for n in (r, c))
            np.add.at(out, (i[:, None], j[None, :]), block)
    return out


@pytest.mark.parametrize("committed", [0, 1])
@pytest.mark.parametrize("master", ["tri3", "quad8", "quad9"])
def test_blocks_of_facets(master: str, committed: int) -> None:
    """Summed by facets: the forces and tangents of the points, 1e-13 of the largest, rounding."""
    s = make("quad9", master, "maximum-dissipation", "slip")
    s.state["facet"] = committed
    one = s.update(s.now)
    three = s.ask(s.core.assemble, s.now, True, 3, 1)
    rows = 9 + len(NODES[master])
    nodes = one["nodes"][0]
    exact = _dense([(nodes[None, :rows], nodes[None], one["tangent"])], len(s.now))
    assert len(three["blocks"][0][0]) == 1
    assert np.abs(_dense(three["blocks"], len(s.now)) - 3 * exact).max() < 1e-13 * exact.max()
    force = np.zeros(s.now.shape)
    np.add.at(force, nodes[:rows], -3 * one["residual"][0].reshape(-1, 3))
    assert np.abs(three["force"] - force).max() < 1e-13 * force.max()


def test_threads_do_not_matter(monkeypatch: pytest.MonkeyPatch) -> None:
    """Thousands of points in one, two and five threads: the same bits."""
    s = make("quad4", "quad4", "maximum-dissipation", "slip")
    # nodes that turn round from point to point, so that every point counts as on another facet
    tile = np.tile

    def turning(a: np.ndarray, times: tuple[int, ...]) -> np.ndarray:
        out = tile(a, times)
        if len(out) == 3000 and out.shape[1] == 4:
            out[1::2] = out[1::2, ::-1]
        return out

    monkeypatch.setattr(np, "tile", turning)
    a, *others = (s.ask(s.core.assemble, s.now, True, 3000, t) for t in (1, 2, 5))
    assert len(a["blocks"][0][0]) == 3000
    for b in others:
        for name in ("state", "traction", "area", "force"):
            assert np.array_equal(a[name], b[name])
        for x, y in zip(a["blocks"], b["blocks"], strict=True):
            assert np.array_equal(x[2], y[2])


def test_action_is_reaction() -> None:
    """Forces on slave and master add up to zero: 1e-14 of their size, rounding."""
    s = make("quad9", "tri6", "maximum-dissipation", "slip")
    force = s.update(s.now)["residual"][0].reshape(-1, 3)
    assert np.abs(force.sum(axis=0)).max() < 1e-14 * np.abs(force).max()


@pytest.mark.parametrize("status", ["stick", "slip"])
@pytest.mark.parametrize("master", TOPOLOGIES)
def test_moments_balance(master: str, status: str) -> None:
    """Moments of the forces on slave and master add up to zero, with friction and penetration.

    Requirement: 1e-8 of the forces (lengths are of order 1); the couple of friction at the slave
    point and at its foot alone is above 1e-3 of them. Source: third law. Measured: 1e-15.
    """
    s = make("quad9", master, "maximum-dissipation", status)
    r = s.update(s.now)
    force = r["residual"][0].reshape(-1, 3)
    arms = s.now[: len(force)]
    size = np.abs(force).max()
    assert np.abs(np.cross(arms, force).sum(axis=0)).max() < 1e-8 * size
    state = as_state(r["state"])
    couple = r["area"] * np.linalg.norm(np.cross(state["gap"] * r["normal"], r["traction"]))
    assert couple[0] > 1e-3 * size


@pytest.mark.parametrize("status", ["stick", "slip"])
def test_rigid_rotation(status: str) -> None:
    """Rotating everything, directions too, rotates forces and tangent: 1e-12, rounding."""
    s = make("quad4", "quad9", "maximum-dissipation", status)
    q, _ = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))
    q *= np.sign(np.linalg.det(q))
    # the history turns with the bodies: all nodes of the committed state move alike, so the
    # directions, which live in the reference configuration, need not be turned
    turned = replace(s, now=np.ascontiguousarray(s.now @ q.T))
    a, b = s.update(s.now), turned.update(turned.now)
    force = a["residual"][0].reshape(-1, 3) @ q.T
    assert np.abs(b["residual"][0].reshape(-1, 3) - force).max() < 1e-12 * np.abs(force).max()
