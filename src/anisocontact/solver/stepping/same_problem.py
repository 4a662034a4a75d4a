"""What a problem was made of, kept beside its state: a state goes on in the same problem only."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.difference import first_difference
from anisocontact.base.errors import InputError
from anisocontact.contact import Contact
from anisocontact.interface.description import compared
from anisocontact.rigid import RigidBody
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.persistent import Arrays, Persistent
from anisocontact.solver.terms.step import Step

#: Difference of two parameters that are the same, over the larger of them: some, as the penalties
#: that suit a body, are sums that several processes take in another order.
NEAR = 1e-9
#: Distance within which two positions are the same, over the size of the mesh.
SAME = 1e-9


def described_contacts(contacts: Sequence[Contact]) -> dict[str, Any]:
    """What contacts were made of, by the names of the arguments."""
    names = [contact.name for contact in contacts]
    return {"contacts": names, "contact": [contact.made_of() for contact in contacts]}


def described_run(problem: Problem, steps: Sequence[Step]) -> dict[str, Any]:
    """What a problem and its steps were made of, by the names of the arguments."""
    return {
        **described_contacts(problem.contacts),
        "materials": compared(problem.materials),
        "rigid": [_rigid(body) for body in problem.rigid.bodies],
        "steps": compared(steps),
    }


def _rigid(body: RigidBody) -> dict[str, Any]:
    names = ("name", "reference", "free", "springs")
    told: dict[str, Any] = compared({name: getattr(body, name) for name in names})
    return told


def size_of(positions: Floats) -> float:
    """Largest extent of the nodes of a process, with those it shares with others, length."""
    return float(np.ptp(positions, axis=0).max()) if len(positions) else 0.0


def check_run(
    kept: Persistent, now: Mapping[str, Any], like: Persistent, begun: int, size: float
) -> None:
    """Refuse a state of another problem; steps that have not begun may be others.

    Args:
        kept: The state.
        now: What the problem is made of, see `described_run`.
        like: State of the problem as it is now.
        begun: Number of steps that had begun in the state.
        size: As of `size_of`.

    Raises:
        InputError: Names what differs.
    """
    if "problem" not in kept.common or "position" not in kept.nodal:
        raise InputError("no state of this version: it does not say of which problem it is")
    check_described(kept.common["problem"], now, {"steps": begun})
    check_positions(kept.nodal["position"], like.nodal["position"], "node", size)
    for one, given in zip(like.points, kept.points, strict=True):
        check_histories(given, one, size)


def as_array(description: Mapping[str, Any]) -> npt.NDArray[np.uint8]:
    """A description as files of arrays have it."""
    return np.frombuffer(json.dumps(description).encode(), dtype=np.uint8)


def check_described(
    kept: npt.NDArray[np.uint8], now: Mapping[str, Any], ends: Mapping[str, int] | None = None
) -> None:
    """Refuse a state of a problem that was made of something else.

    Args:
        kept: Its description, as `as_array` has given it.
        now: What the problem is made of.
        ends: How many entries of a list count, by its name.

    Raises:
        InputError: Names the first entry that is not the same.
    """
    before, given = json.loads(bytes(kept)), json.loads(json.dumps(now))
    _check_free(before.get("rigid", []), given.get("rigid", []))
    for name, count in (ends or {}).items():
        before[name], given[name] = before[name][:count], given[name][:count]
    if found := first_difference(before, given, NEAR):
        text = f"{found.new} given, the state is that of a problem with {found.old}"
        raise InputError(text, found.place)


def _check_free(kept: Sequence[Mapping[str, Any]], now: Sequence[Mapping[str, Any]]) -> None:
    """Refuse bodies that later steps free, or do not free any more: a state has their unknowns."""
    for old, new in zip(kept, now, strict=False):
        if old["name"] == new["name"] and old.get("free") != new["free"]:
            how = ("free in a step", "held in all steps")
            is_now, was = how if new["free"] else reversed(how)
            text = f"{is_now}, {was} of the run that is to go on: begin anew"
            raise InputError(text, f"rigid.{new['name']}")


def check_positions(kept: Floats, now: Floats, what: str, size: float) -> None:
    """Refuse a state of other nodes or points.

    Args:
        kept: Where they were in the reference configuration, (n, 3), length.
        now: Where they are there, (n, 3), length.
        what: Their name.
        size: As of `size_of`: a slave may be a single point.

    Raises:
        InputError: Says how many others there are, or names one that is elsewhere.
    """
    if kept.shape != now.shape:
        text = f"the state is that of a problem with {len(kept)} {what}s, there are {len(now)}"
        raise InputError(text)
    off = np.flatnonzero(~(np.abs(kept - now) <= SAME * size).all(axis=1))
    if len(off):
        first, second = (", ".join(f"{v:.6g}" for v in x[off[0]]) for x in (now, kept))
        raise InputError(
            f"{len(off)} of {len(now)} {what}s are not where the state has them, as one at "
            f"({first}), there at ({second})"
        )


def check_histories(kept: Arrays, now: Arrays, size: float) -> None:
    """Refuse histories of other points, or of laws that keep other variables.

    Args:
        kept: Those of a state.
        now: Those of the problem.
        size: As of `size_of`.

    Raises:
        InputError: They are.
    """
    places = kept.get("reference", np.zeros((0, 3)))
    check_positions(places, now["reference"], "slave point", size)
    for name, values in now.items():
        there = kept.get(name)
        if there is None or len(there) != len(values) or _fields(there) != _fields(values):
            raise InputError(f"the state is that of a law that keeps another {name!r} of points")


def _fields(values: npt.NDArray[Any]) -> list[tuple[str, tuple[int, ...]]]:
    """Fields of records with their shapes; how wide other rows are the processes decide."""
    return [(name, values.dtype[name].shape) for name in values.dtype.names or ()]


def numbering(space: Any) -> npt.NDArray[np.uint8]:
    """What tells meshes and elements apart whose nodes are at the same places, (16,)."""
    rows = np.ascontiguousarray(space.dofmap.list, dtype=np.int64)
    return np.frombuffer(hashlib.blake2b(rows.tobytes(), digest_size=16).digest(), dtype=np.uint8)
