"""A surface of the core beside formulas of its own, and how to move one."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base import registry
from anisocontact.base.array_types import Flags, Floats
from anisocontact.surfaces import Surface, make_surface

ORIGIN = np.array([0.3, -0.7, 1.1])
AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
START = np.array([1.0, 2.0, 0.0]) / np.sqrt(5.0)
AXES = np.stack([START, np.cross(AXIS, START), AXIS])
INFINITE = 1e4


@dataclass(frozen=True)
class SurfaceSample:
    """A surface of the core beside formulas of its own.

    Args:
        name: Name of the sample.
        shape: Name in the registry.
        parameters: Those of `make_surface`.
        size: A length of the surface.
        centre: A point the surface is about.
        window: Coordinates where it is regular, ((from, to), (from, to)).
        whole: All its coordinates, as far as they are looked at.
        local: rho in its own axes.
        curvature: Gauss and mean curvature in closed form, None where there is none.
        mirrored: Whether its second axis is reversed (the material outside).
        closed: Whether each coordinate may run past its ends.
        axis: Direction near which points are ambiguous or singular.
        lengths: Which coordinates are lengths; those without end if left out.
        breaks: Lines of each coordinate where the surface is less smooth, seams and poles included.
    """

    name: str
    shape: str
    parameters: dict[str, Any]
    size: float
    centre: Floats
    window: tuple[tuple[float, float], tuple[float, float]]
    whole: tuple[tuple[float, float], tuple[float, float]]
    local: Callable[[Floats, Floats], tuple[Floats, ...]]
    curvature: Callable[[Floats, Floats], tuple[Floats, Floats]] | None = None
    mirrored: bool = False
    closed: tuple[bool, bool] = (False, False)
    axis: Floats = field(default_factory=lambda: AXIS)
    lengths: tuple[bool, bool] | None = None
    breaks: tuple[tuple[float, ...], tuple[float, ...]] = ((), ())

    def make(self) -> Surface:
        """The surface of the core."""
        return make_surface(self.shape, **self.parameters)

    def position(self, xi: Floats) -> Floats:
        """rho at coordinates (..., 2), in NumPy."""
        y = np.stack(np.broadcast_arrays(*self.local(xi[..., 0], xi[..., 1])), axis=-1)
        return self.centre + y @ (AXES * [[1], [-1 if self.mirrored else 1], [1]])

    def coordinates(self, n: int, seed: int = 0) -> Floats:
        """Random coordinates in the window, (n, 2)."""
        lower, upper = np.transpose(self.window)
        return np.random.default_rng(seed).uniform(lower, upper, (n, 2))

    def smooth(self, xi: Floats, margin: float) -> Flags:
        """Which coordinates are farther from every break than a fraction of the range, (n,)."""
        clear = np.ones(len(xi), bool)
        for k in range(2):
            width = margin * np.diff(self.whole[k])[0]
            for line in self.breaks[k]:
                clear &= np.abs(xi[:, k] - line) > width
        return clear

    def scaled(self, xi: Floats, scale: float) -> Floats:
        """The coordinates, (n, 2), of the same points where the unit of length is another one."""
        endless = [high == INFINITE for _, high in self.whole]
        return xi * np.where(self.lengths or endless, scale, 1.0)

    def bore(self) -> SurfaceSample:
        """The same with the slave inside: the angle runs the other way, curvatures change sign."""
        curvature = self.curvature

        def turned(u: Floats, v: Floats) -> tuple[Floats, Floats]:
            gauss, mean = curvature(u, v)
            return gauss, -mean

        return replace(
            self,
            name=f"{self.name}-bore",
            parameters=self.parameters | {"inside": True},
            curvature=turned if curvature else None,
            mirrored=True,
        )


def moved(parameters: dict[str, Any], shape: str, q: Floats, t: Floats, scale: float) -> Any:
    """Parameters of the surface whose points are t + scale Q rho."""
    entry = registry.entry(registry.surfaces(), shape)
    units = {p.name: (p.kind, p.unit) for p in entry.parameters}
    result = {}
    for name, value in parameters.items():
        kind, unit = units[name]
        lengths = name in ("semi_axes", "profile", "rounding") or kind == "scalar"
        if lengths and unit == "length":
            result[name] = scale * np.asarray(value)
        elif unit == "length":
            result[name] = (t + scale * np.reshape(value, (-1, 3)) @ q.T).ravel()
        elif kind == "vector":
            result[name] = q @ np.asarray(value)
        else:
            result[name] = value
    return result


def rotation(axis: npt.ArrayLike, angle: float) -> Floats:
    """Rotation matrix."""
    a = np.asarray(axis, float) / np.linalg.norm(axis)
    k = np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


PI = np.pi
ROUND = ((-PI, PI), (-PI / 2, PI / 2))
PLACED: dict[str, Any] = {"axis": AXIS, "start": START}
