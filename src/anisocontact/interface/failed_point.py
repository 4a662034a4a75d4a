"""A slave point at which the law failed, whole: it can be kept in a file and evaluated alone."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, cast, override

import numpy as np

from anisocontact import __version__
from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.whole_files import replacing
from anisocontact.interface import FAILURE, SlaveSurface, State
from anisocontact.interface.contact_law import FacetBatch
from anisocontact.interface.description import described, made
from anisocontact.surfaces import TOPOLOGIES, FacetSurface

#: Steps of the differences that the tangent is held against, over the size of the surroundings.
STEPS = (1e-4, 1e-5, 1e-6)


@dataclass(frozen=True)
class Evaluated:
    """What the law answers at one point.

    Attributes:
        failure: Why it has no answer; empty if it has one.
        state: Trial state, (1,).
        traction: On the slave, (3,), stress.
        tangent: Its change where all of the slave is moved, (3, 3), stress/length.
    """

    failure: str
    state: State
    traction: Floats
    tangent: Floats


@dataclass(frozen=True)
class FailedPoint:
    """A slave point at which the law failed, and all that decides what the law answers there.

    Attributes:
        contact: Name of the contact.
        point: Number of the point on the rank that had it.
        position: Where it was, (3,), length; in the frame of its master, which may move.
        failure: Why it failed.
        dt: Time increment.
        state: State of the last accepted increment, (1,).
        law: The laws; of an analytic master with its surface.
    """

    contact: str
    point: int
    position: Floats
    failure: str
    dt: float
    state: State
    law: Any

    def evaluate(self, shift: Floats | None = None) -> Evaluated:
        """Ask the law once more.

        Args:
            shift: Displacement of the slave from where it was, (3,), length.
        """
        raise NotImplementedError

    @property
    def size(self) -> float:
        """Length of the surroundings, for differences."""
        raise NotImplementedError

    def tangent_errors(self) -> dict[float, float]:
        """Tangent against central differences, by the step of these over `size`.

        Returns:
            Differences over the largest entry, for each of `STEPS` at which the law has an answer
            on all sides; none where it has none at the point.
        """
        found: dict[float, float] = {}
        here = self.evaluate()
        if here.failure:
            return found
        for step in STEPS:
            h = step * self.size
            ends = [[self.evaluate(s * h * e) for s in (1.0, -1.0)] for e in np.eye(3)]
            if any(end.failure for pair in ends for end in pair):
                continue
            slopes = np.array([(a.traction - b.traction) / (2.0 * h) for a, b in ends]).T
            error = np.abs(slopes - here.tangent).max()
            found[step] = float(error / max(np.abs(here.tangent).max(), np.finfo(float).tiny))
        return found

    def write(self, path: Path) -> None:
        """Keep it in a file, for `anisocontact replay`.

        Raises:
            InputError: A law in Python holds what cannot be written.
        """
        head = {"anisocontact": __version__, "kind": type(self).__name__}
        own = {f.name: getattr(self, f.name) for f in fields(self)}
        with replacing(path) as draft:
            draft.write_text(json.dumps(head | described(own), indent=1), encoding="utf-8")


@dataclass(frozen=True)
class OnSurface(FailedPoint):
    """A point on an analytic master.

    Attributes:
        slave: The slave there, where the laws see it.
    """

    slave: SlaveSurface | None

    @override
    def evaluate(self, shift: Floats | None = None) -> Evaluated:
        x = self.position[None] + (0.0 if shift is None else shift)
        r = self.law.update(self.state, x, self.dt, slave=self.slave)
        return Evaluated(FAILURE[r.failure[0]], r.state, r.traction[0], r.tangent[0])

    @property
    @override
    def size(self) -> float:
        return float(max(np.abs(self.position).max(), abs(float(self.state["gap"][0])), 1e-300))


@dataclass(frozen=True)
class OnFacets(FailedPoint):
    """A point that meets facets: those of its last and of its present place, with their nodes.

    Attributes:
        batch: Point and facets as the core takes them.
    """

    batch: FacetBatch

    @override
    def evaluate(self, shift: Floats | None = None) -> Evaluated:
        batch = self.batch if shift is None else self._moved(shift)
        law = self.law.on_facets()
        found = law.evaluate(self.state, "update", self.dt, batch)
        own = self.batch["slave_nodes"].shape[1]
        block = found["tangent"][0, : 3 * own, : 3 * own].reshape(own, 3, own, 3)
        tangent = -block.sum(axis=(0, 2)) / found["area"][0]
        failure = FAILURE[found["failure"][0]]
        return Evaluated(failure, found["state"], found["traction"][0], tangent)

    def _moved(self, shift: Floats) -> FacetBatch:
        """The batch with the slave elsewhere and its point projected on the facet anew."""
        batch = self.batch
        now = batch["now"].copy()
        now[batch["slave_nodes"][0]] += shift
        topology = list(TOPOLOGIES)[batch["topology"][0]]
        surface = FacetSurface(batch["now"], batch["connectivity"], topology, batch["flip"])
        hit = surface.project(self.position[None] + shift, batch["facet"])
        there = {name: getattr(hit, name) for name in ("facet", "xi", "feature", "edge")}
        return cast(FacetBatch, batch | there | {"now": now})

    @property
    @override
    def size(self) -> float:
        return float(np.ptp(self.batch["now"], axis=0).max())


def read_failed_point(path: Path) -> FailedPoint:
    """The point of a file that `FailedPoint.write` has written.

    A law in Python is made from the file that its class stood in, which is run.

    Raises:
        InputError: It cannot be read, is no such file, or its law cannot be imported.
    """
    try:
        text = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"'{path}' cannot be read: {error.strerror}") from None
    except ValueError:
        text = None
    kinds = {kind.__name__: kind for kind in (OnSurface, OnFacets)}
    kind = kinds.get(str(text.get("kind"))) if isinstance(text, dict) else None
    if kind is None:
        raise InputError(f"'{path}' is no failed point of this version")
    try:
        return kind(**{f.name: made(text[f.name]) for f in fields(kind)})
    except (KeyError, TypeError, ValueError) as error:
        said = error if isinstance(error, InputError) else f"{type(error).__name__}: {error}"
        raise InputError(f"'{path}' is no failed point of this version: {said}") from None


def one_point(batch: Mapping[str, Any], i: int, state: State) -> tuple[FacetBatch, State]:
    """A batch and its states cut down to one point, the facets that it knows and their nodes.

    Args:
        batch: Of n points.
        i: The point.
        state: Of all points, (n,).
    """
    own, here = state[i : i + 1].copy(), {k: batch[k][i : i + 1].copy() for k in _OF_POINTS}
    if not len(here["held"]):
        here["held"] = np.zeros((1, 3, 3))
    known = np.unique([f for f in (here["facet"][0], own["facet"][0]) if f >= 0])
    of_facets = {k: batch[k][known] for k in ("connectivity", "topology", "flip")}
    used = np.union1d(here["slave_nodes"], of_facets["connectivity"])
    used = used[used >= 0]
    for table, name in ((here, "slave_nodes"), (of_facets, "connectivity")):
        rows = table[name]
        number = np.searchsorted(used, rows).astype(rows.dtype)
        table[name] = np.where(rows >= 0, number, rows)
    for facets in (here["facet"], own["facet"]):
        facets[:] = np.where(facets >= 0, np.searchsorted(known, facets), facets)
    nodes = {k: batch[k][used] for k in ("now", "reference")}
    cut = {**batch, **here, **of_facets, **nodes, "tangent": True, "threads": 1}
    return cast(FacetBatch, cut), own


#: What of a batch belongs to points.
_OF_POINTS = (
    *("slave_nodes", "slave_shape", "slave_gradient", "weight"),
    *("facet", "xi", "feature", "edge", "held", "near"),
)
