"""Prescribed rotations of bodies at small strain: found before anything is solved."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.bulk import Material, small_strain
from anisocontact.mesh import Model
from anisocontact.solver.system.rotations import CURE, REFUSED, WARNED, spurious
from anisocontact.solver.terms.step import Step
from anisocontact.solver.terms.supports import Supports

#: Places along a step at which a turn is looked at.
_PLACES = 16
#: Share of the largest eigenvalue below which supports say nothing of a motion.
_UNSEEN = 1e-6
#: A limit that is met has not been passed, whatever rounding makes of the angle.
_ROUNDING = 1.0 + 1e-9


def prescribed_turns(
    model: Model, materials: Mapping[str, Material], steps: Sequence[Step]
) -> list[str]:
    """What steps prescribe beyond the range of small strain, a line for each body.

    Args:
        model: The mesh.
        materials: Body name -> material; those at small strain count.
        steps: The steps.

    Returns:
        Warnings: bodies that are turned by more than a degree.

    Raises:
        InputError: A body is turned by more than five degrees.
    """
    linear = [name for name, law in sorted(materials.items()) if small_strain(law)]
    largest: dict[str, tuple[float, str]] = {}
    for step, name, angle in _angles(model, linear, steps):
        if angle > largest.get(name, (WARNED * _ROUNDING, ""))[0]:
            largest[name] = angle, f"step {step.name!r}"
    for name, (angle, field) in largest.items():
        if angle > REFUSED * _ROUNDING:
            text = f"supports turn body {name!r}, at small strain, by {_said(angle)}; {CURE}"
            raise InputError(text, field)
    return [
        f"{field}: supports turn body {name!r}, at small strain, by {_said(angle)}"
        for name, (angle, field) in largest.items()
    ]


def _said(angle: float) -> str:
    return f"{np.degrees(angle):.3g} degrees, which makes a strain of {spurious(angle):.2g} there"


def _angles(
    model: Model, linear: Sequence[str], steps: Sequence[Step]
) -> Iterator[tuple[Step, str, float]]:
    """Angle by which the supports turn each body, along each step."""
    space = model.space
    reference = np.asarray(space.tabulate_dof_coordinates())
    nodes = {name: np.unique(space.dofmap.list[model.cells(name)]) for name in linear}
    supports, u = Supports(model), np.zeros(reference.size)
    for step in steps:
        supports.begin(step, u)
        held = supports.unknowns
        own = {name: np.isin(held // 3, nodes[name]) for name in linear}
        places = _PLACES if step.turned_groups() or step.load_curves() else 1
        for share in np.arange(1, places + 1) / places:
            supports.set_load_factor(float(share))
            u[held] = supports.values
            for name in linear:
                rows = held[own[name]]
                yield step, name, _turn(reference, rows, u[rows], model.mesh.comm)


def _turn(reference: Floats, unknowns: Ints, values: Floats, comm: Any) -> float:
    """Angle of the rigid motion that comes nearest to prescribed displacements, radian.

    Least squares of `a . (t + w x r) - u` over the prescribed components u along a, with the least
    w where several do. For a rotation by up to 90 degrees `|w|` is its sine.
    """
    places, axes = np.divmod(unknowns, 3)
    rows = np.column_stack(
        [np.cross(reference[places], np.eye(3)[axes]), values, np.ones(len(axes))]
    )
    sums = np.zeros((3, 5))
    np.add.at(sums, axes, rows)
    sums = comm.allreduce(sums)
    # the best t leaves the deviations from the mean of each axis
    means = sums / np.maximum(sums[:, 4:], 1.0)
    apart = (rows - means[axes])[:, :4]
    products = comm.allreduce(apart.T @ apart)
    sizes, vectors = np.linalg.eigh(products[:3, :3])
    seen = sizes > max(_UNSEEN * sizes[-1], np.finfo(float).tiny)
    w = vectors[:, seen] @ (vectors[:, seen].T @ products[:3, 3] / sizes[seen])
    return float(np.arcsin(min(float(np.linalg.norm(w)), 1.0)))
