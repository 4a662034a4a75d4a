"""What the driver finds does not depend on coordinates, place, orientation or units.

Source: covariance; every quantity compared is a vector in space or a scalar. Tolerance 1e-10 of
the largest value: rounding of some hundred steps, amplified by the solver's 1e-11.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from anisocontact.anisotropy import make_directions
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.point import (
    DeadLoad,
    DraggingSpring,
    Group,
    History,
    Load,
    PrescribedPath,
    Push,
    drive,
)
from anisocontact.surfaces import Surface, make_surface

TOLERANCE = 1e-10
VECTORS = ("position", "traction", "elastic", "slip")
SCALARS = ("gap", "pressure", "slip_accumulated", "dissipation", "energy_adhesion")
IDENTITY = Rotation.identity()


def _interface(
    surface: Surface, turn: Rotation = IDENTITY, length: float = 1.0, force: float = 1.0
) -> Interface:
    """Laws with different axes for adhesion and friction; lengths and forces scaled."""
    k = force / length**3
    first = make_directions("constant", vector=turn.apply([0.3, 1.0, 0.5]))
    second = make_directions("constant", vector=turn.apply([1.0, 0.2, -0.4]), angle=0.3)
    return Interface(
        surface,
        NormalLaw(penalty=1e4 * k),
        Adhesion(stiffness=(2e3 * k, 8e2 * k), directions=first),
        Friction(coefficients=(0.35, 0.15), directions=second),
    )


def _loads(
    turn: Rotation = IDENTITY, shift: Any = (0, 0, 0), length: float = 1.0, force: float = 1.0
) -> dict[str, Load]:
    """Loads near the point (2, 0, 0) on surfaces that pass through it with normal x."""

    def at(x: Any) -> np.ndarray:
        return turn.apply(length * np.asarray(x, dtype=float)) + shift

    n = 10.0 * force / length**2
    start, way = at([2, 0, 0]), [at([2, 0, 0]), at([2, 0.05, 0.02]), at([2, 0.01, 0.09])]
    along = turn.apply(np.array([0.1, 0.6, 0.8]))
    return {
        "path": PrescribedPath(way, pressure=[n, 0.6 * n, n], increments=25),
        "spring": DraggingSpring(way, 300.0 * force / length, pressure=n, increments=25),
        "push": Push(along, [0, 0.08 * length], start, pressure=n, increments=25),
        "dead-load": DeadLoad(
            np.outer([0.0, 6.0 * force], along),
            start,
            pressure=n,
            increments=25,
            viscosity=20.0 * force / length,
        ),
    }


KINDS = ("path", "spring", "push", "dead-load")


def _same(a: History, b: History, map_points: Callable[[Any], Any], map_vectors: Any) -> None:
    """The histories are equal after the map, relative to the largest value of each column."""
    assert len(a) == len(b)
    assert (a.points["status"] == b.points["status"]).all()
    for name in VECTORS:
        mapped = (map_points if name == "position" else map_vectors)(a.points[name].reshape(-1, 3))
        scale = np.abs(b.points[name]).max()
        assert np.abs(mapped - b.points[name].reshape(-1, 3)).max() <= TOLERANCE * scale, name
    for name in SCALARS:
        scale = np.abs(b.points[name]).max()
        assert np.abs(a.points[name] - b.points[name]).max() <= TOLERANCE * scale, name
    assert (a.points["status"] == 2).any()


def _identity(x: Any) -> Any:
    return x


SAME_SURFACES: dict[str, tuple[Surface, Surface]] = {
    "plane": (
        make_surface("plane", point=(2, 0, 0), normal=(1, 0, 0), tangent=(0, 1, 0)),
        make_surface("plane", point=(2, 3, -1), normal=(1, 0, 0), tangent=(0, 2, 1)),
    ),
    "cylinder": (
        make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=2, start=(1, 0, 0)),
        make_surface("cylinder", point=(0, 0, 5), axis=(0, 0, -1), radius=2, start=(1, 1, 0)),
    ),
    "sphere": (
        make_surface("sphere", centre=(0, 0, 0), radius=2, axis=(0, 0, 1)),
        make_surface("sphere", centre=(0, 0, 0), radius=2, axis=(1, 2, 1)),
    ),
    "sphere as ellipsoid": (
        make_surface("sphere", centre=(0, 0, 0), radius=2, axis=(0, 0, 1)),
        make_surface("ellipsoid", centre=(0, 0, 0), semi_axes=(2, 2, 2), axis=(0, 1, 1)),
    ),
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("surface", SAME_SURFACES)
def test_reparametrisation_changes_nothing(surface: str, kind: str) -> None:
    """The same surface with other coordinates: requirement of covariance."""
    one, other = SAME_SURFACES[surface]
    load = _loads()[kind]
    _same(drive(_interface(one), load), drive(_interface(other), load), _identity, _identity)


@pytest.mark.parametrize("kind", KINDS)
def test_rigid_motion_changes_nothing(kind: str) -> None:
    """Surface, directions, offsets and load turned and moved together: requirement of objectivity.

    A torus, whose curvature varies, and three points that turn with the surface.
    """
    turn, shift = Rotation.from_rotvec([0.7, -1.1, 0.4]), np.array([3.0, -2.0, 5.0])
    arms = np.array([[0, 0, 0], [0, 0.1, 0], [0, 0, 0.1]])
    form = {"radius": 1.5, "tube": 0.5}
    here = make_surface("torus", centre=(0, 0, 0), axis=(0, 0, 1), start=(1, 0, 0), **form)
    there = make_surface(
        "torus",
        centre=shift,
        axis=turn.apply([0, 0, 1]),
        start=turn.apply([1, 0, 0]),
        **form,
    )
    one = drive(_interface(here), _loads()[kind], Group(arms, orientation="surface"))
    other = drive(
        _interface(there, turn),
        _loads(turn, shift)[kind],
        Group(turn.apply(arms), orientation="surface"),
    )
    _same(one, other, lambda x: turn.apply(x) + shift, turn.apply)


@pytest.mark.parametrize("kind", KINDS)
def test_units_change_nothing(kind: str) -> None:
    """Lengths in another unit, forces in another: the same numbers times the units.

    Areas are 1, so that a stress is a force per new unit of area only if the areas are scaled.
    """
    length, force = 1e-3, 7.3
    one = drive(
        _interface(make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=2)),
        _loads()[kind],
    )
    cylinder = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=2 * length)
    other = drive(
        _interface(cylinder, length=length, force=force),
        _loads(length=length, force=force)[kind],
        Group(areas=length**2),
    )
    stress = force / length**2
    for name, unit in {
        "position": length,
        "slip": length,
        "elastic": length,
        "traction": stress,
        "dissipation": stress * length,
        "energy_normal": stress * length,
    }.items():
        scale = np.abs(other.points[name]).max()
        error = np.abs(unit * one.points[name] - other.points[name]).max()
        assert error <= TOLERANCE * scale, name
    for name in one.steps["energy"].dtype.names:
        error = np.abs(force * length * one.steps["energy"][name] - other.steps["energy"][name])
        scale = force * length * np.abs(one.steps["energy"]["external"]).max()
        assert error.max() <= TOLERANCE * scale, name
