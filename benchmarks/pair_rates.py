"""Slave points per second and core of the contact of two meshed sheets.

Run: python benchmarks/pair_rates.py [cells of a side]

Two wavy sheets of the same facets meet and slide. The rates hold everything of one evaluation of
the contact: refit of the search tree, projection of every slave point from the place of the last
evaluation, laws, forces on the nodes and, with tangent, the blocks of the matrix. Processor time of
one thread, the best of several passes.
"""

from __future__ import annotations

import sys
import time
from dataclasses import dataclass

import numpy as np
from facet_grid import grid
from mpi4py import MPI

from anisocontact.anisotropy import make_directions
from anisocontact.base import registry
from anisocontact.contact.facet_mesh import FacetMesh, facet_rule, isoparametric
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.interface import STATE, ContactLaw, raw_state
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import TOPOLOGIES, FacetProjections, FacetSurface

PASSES = 7
#: Points of quadrature on a facet: degree of the rule, twice the order of the facet.
DEGREE = {"tri3": 2, "tri6": 4, "quad4": 2, "quad9": 4}
RULES: dict[str, dict[str, object]] = {
    "maximum-dissipation": {},
    "slip-ellipse": {"slip_axes": (2.0, 1.0), "slip_angle": 0.3},
}


def sheet(cells: int, topology: str) -> tuple[np.ndarray, np.ndarray]:
    """Points and facets of a wavy unit square."""
    x, y, facets = grid(cells, topology)
    height = 0.02 * np.sin(6.0 * x) * np.cos(5.0 * y)
    return np.column_stack((x, y, height)), facets.astype(np.int32)


def law(rule: str, mu: float) -> ContactLaw:
    """Adhesion and friction with axes apart."""
    first = make_directions("constant", vector=(1.0, 0.2, 0.1), angle=0.3)
    second = make_directions("polar", axis=((-1.0, -1.0, 0.0), (0.0, 0.1, 1.0)))
    return ContactLaw(
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(400.0, 100.0), directions=first),
        Friction(coefficients=(mu, 0.4 * mu), directions=second, sliding_rule=rule, **RULES[rule]),
    )


@dataclass
class Sheets:
    """A slave sheet that is pressed into a master sheet and moved along it."""

    topology: str
    cells: int
    law: ContactLaw

    def __post_init__(self) -> None:
        x, facets = sheet(self.cells, self.topology)
        self.size = 1.0 / self.cells
        self.count = len(x)
        lower = np.ascontiguousarray(facets)
        upper = np.ascontiguousarray(facets + self.count)
        flip = np.zeros(len(facets), dtype=np.bool_)
        # the slave is smaller, so that no point runs off the border
        above = np.array([0.05, 0.05, 0.0]) + x * np.array([0.9, 0.9, 1.0])
        above[:, 2] = 0.02 * np.sin(6.0 * above[:, 0]) * np.cos(5.0 * above[:, 1])
        above[:, 2] -= 2e-2 * self.size
        self.reference = np.concatenate([x, above])
        facets = FacetMesh(self.topology, upper, ~flip)
        rule = facet_rule(self.topology, DEGREE[self.topology])
        quadrature = isoparametric(facets, rule, self.reference)
        self.points = IntegrationPoints(
            quadrature, facets.flip, current_area=True, comm=MPI.COMM_SELF
        )
        self.surface = FacetSurface(self.reference, lower, self.topology)
        kind = list(TOPOLOGIES).index(self.topology)
        self.master = (lower, np.full(len(lower), kind, dtype=np.int8), flip)
        self.core = self.law.on_facets().core
        self.hint: FacetProjections | None = None
        self.state = np.zeros(len(self.points.nodes), dtype=STATE)
        self.state["facet"] = -1

    def moved(self, along: float) -> np.ndarray:
        """Nodes with the slave moved along the master by a share of a facet."""
        now = self.reference.copy()
        now[self.count :] += along * self.size * np.array([1.0, 0.4, 0.0])
        return now

    def evaluate(self, now: np.ndarray, tangent: bool) -> tuple[dict[str, object], float, float]:
        """One evaluation, and the seconds of search and kernel in it."""
        start = time.process_time()
        x = self.points.positions(now)
        self.surface.update(now)
        hit = self.surface.project(x, hint=self.hint, max_distance=2.0 * self.size, threads=1)
        found = time.process_time()
        self.hint = hit
        p = self.points
        answer = self.core.assemble(
            raw_state(self.state),
            1.0,
            p.nodes,
            p.shape,
            p.gradient,
            p.weight,
            True,
            now,
            self.reference,
            *self.master,
            np.maximum(hit.facet, 0),
            np.nan_to_num(hit.xi),
            np.where(hit.status == 0, hit.feature, np.int8(3)),
            hit.edge,
            np.zeros((0, 3, 3)),
            hit.gap <= 1e-6 * self.size,
            tangent,
            1,
        )
        return answer, found - start, time.process_time() - found


def rates(topology: str, rule: str, mu: float, cells: int) -> list[str]:
    """A row of the table."""
    s = Sheets(topology, cells, law(rule, mu))
    for step in (0.0, 0.02):
        s.state = s.evaluate(s.moved(step), False)[0]["state"].view(STATE).reshape(-1)
    now = s.moved(0.05)
    n = len(s.state)
    status = np.bincount(
        s.evaluate(now, False)[0]["state"].view(STATE).reshape(-1)["status"], minlength=3
    )
    row = [topology, rule, f"{100 * status[1] / n:.0f} %", f"{100 * status[2] / n:.0f} %"]
    for tangent in (False, True):
        times = np.array([s.evaluate(now, tangent)[1:] for _ in range(PASSES)]).min(axis=0)
        row += [f"{1e-6 * n / t:.2f}" for t in (times[1], times.sum())]
    return row


def main(cells: int = 100) -> None:
    """Print the table, in millions of points per second and core."""
    names = [e.name for e in registry.sliding_rules()]
    assert set(RULES) <= set(names)
    print("| facets | rule | stick | slip | laws | all | laws, tangent | all, tangent |")
    print("|---|---|---|---|---|---|---|---|")
    for topology in DEGREE:
        for rule in RULES:
            print(f"| {' | '.join(rates(topology, rule, 0.3, cells))} |")
        print(f"| {' | '.join(rates(topology, 'maximum-dissipation', 30.0, cells))} |")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
