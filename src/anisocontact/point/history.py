"""What a drive has recorded."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.limits import FOLLOWED
from anisocontact.interface import STATUS, Response
from anisocontact.point.balance import GroupPose
from anisocontact.surfaces import Surface

Records = npt.NDArray[np.void]

#: Columns of a point; vectors in space (3), components in the convective basis or along axes (2).
POINT = np.dtype(
    [
        ("position", np.float64, 3),
        ("xi", np.float64, 2),
        ("gap", np.float64),
        ("pressure", np.float64),
        ("traction", np.float64, 3),  # t = N n + T
        ("traction_co", np.float64, 2),  # T_i
        ("traction_principal", np.float64, 2),  # along the friction axes
        ("elastic", np.float64, 3),  # elastic slip
        ("elastic_contra", np.float64, 2),
        ("slip", np.float64, 3),  # sliding increment
        ("slip_contra", np.float64, 2),
        ("slip_accumulated", np.float64),
        ("status", np.int8),
        ("dissipation", np.float64),
        ("dissipation_viscous", np.float64),
        ("energy_adhesion", np.float64),
        ("energy_normal", np.float64),
        ("normal", np.float64, 3),
        ("friction_axes", np.float64, (2, 3)),
        ("adhesion_axes", np.float64, (2, 3)),
    ]
)

#: Energies of the whole group since the beginning.
ENERGY = np.dtype(
    [
        ("external", np.float64),  # work of all devices
        ("spring", np.float64),
        ("adhesion", np.float64),
        ("normal", np.float64),
        ("friction", np.float64),
        ("viscous", np.float64),
        ("regularisation", np.float64),
        ("residual", np.float64),  # external less all others
    ]
)

#: Columns of a step.
STEP = np.dtype(
    [
        ("time", np.float64),
        ("reference", np.float64, 3),
        ("turn", np.float64),
        ("free_end", np.float64, 3),
        ("force", np.float64, 3),  # of all devices on the group
        ("moment", np.float64, 3),  # likewise, about the reference
        ("energy", ENERGY),
        ("iterations", np.int64),
        ("substeps", np.int64),
        ("residual", np.float64),  # of the equations, over the forces
    ]
)

_LETTERS = {3: "xyz", 2: "12"}


class History:
    """Table of a drive: the start, pressed, and every step that converged.

    Attributes:
        surface: The master.
        steps: One row a step, (m,) of `STEP`. In `steps["energy"]` the residual is the error of
            the time integration, of first order in the step.
        points: One row a step and point, (m, n) of `POINT`.
        areas: Area of each point, (n,).
        turn: Largest angle by which normal or axes of adhesion turned at a point in contact along
            one step, radian.

    Example:
        >>> from anisocontact.interface import Interface
        >>> from anisocontact.laws import Adhesion, Friction, NormalLaw
        >>> from anisocontact.point import PrescribedPath, drive
        >>> from anisocontact.surfaces import make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> stick, slip = Adhesion(stiffness=(10, 10)), Friction(coefficients=(1, 1))
        >>> interface = Interface(plane, NormalLaw(penalty=1e3), stick, slip)
        >>> history = drive(interface, PrescribedPath([(0, 0, -0.01), (0.1, 0, -0.01)]))
        >>> history.traction_t[-1, 0].round(9).tolist()
        [-1.0, 0.0, 0.0]
    """

    def __init__(
        self, surface: Surface, steps: Records, points: Records, areas: Floats, turn: float = 0.0
    ) -> None:
        self.surface, self.steps, self.points, self.areas = surface, steps, points, areas
        self.turn = turn

    def __len__(self) -> int:
        return len(self.steps)

    @property
    def traction_t(self) -> Floats:
        """Tangential traction T on the slave, (m, n, 3) [stress]."""
        return np.asarray(
            self.points["traction"] - self.points["pressure"][..., None] * self.points["normal"]
        )

    @property
    def feet(self) -> Floats:
        """Closest points of the surface, (m, n, 3) [length]."""
        return np.asarray(
            self.points["position"] - self.points["gap"][..., None] * self.points["normal"]
        )

    @property
    def warning(self) -> str:
        """What the user should look at, a line; empty if nothing."""
        if self.turn <= FOLLOWED:
            return ""
        return (
            f"normal or axes of adhesion turned by {math.degrees(self.turn):.0f} degrees in one "
            f"step; forces follow up to {math.degrees(FOLLOWED):.0f} well: take more steps"
        )

    def to_dict(self) -> dict[str, npt.NDArray[Any]]:
        """Columns by name, each (m n,), the points of a step one after the other.

        Vectors have the columns `.x`, `.y`, `.z`, components `.1` and `.2`; the status is a word.
        `pandas.DataFrame(history.to_dict())` makes a table of them.
        """
        m, n = self.points.shape
        found: dict[str, npt.NDArray[Any]] = {
            "step": np.repeat(np.arange(m), n),
            "point": np.tile(np.arange(n), m),
        }
        found |= dict(_flat(np.repeat(self.steps, n)))
        found |= dict(_flat(self.points.reshape(-1)))
        found["status"] = np.array([STATUS[s] for s in found["status"]])
        return found

    def to_csv(self, path: str | Path) -> None:
        """Write the columns of `to_dict`, a line for each step and point.

        Args:
            path: The file.
        """
        columns = self.to_dict()
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))

    def summary(self) -> dict[str, Any]:
        """Numbers of the end, plain, for a JSON file."""
        if not len(self):
            return {"steps": 0}
        last, at = self.steps[-1], self.points[-1]
        return {
            "steps": len(self) - 1,
            "newton_iterations": int(self.steps["iterations"].sum()),
            "time": float(last["time"]),
            "reference": last["reference"].tolist(),
            "force": last["force"].tolist(),
            "moment": last["moment"].tolist(),
            "max_pressure": float(self.points["pressure"].max()),
            "max_penetration": float(max(0.0, -self.points["gap"].min())),
            "points": {name: int((at["status"] == i).sum()) for i, name in enumerate(STATUS)},
            "traction": at["traction"].tolist(),
            "slip_accumulated": at["slip_accumulated"].tolist(),
            "energy": dict(zip(ENERGY.names or (), last["energy"].tolist(), strict=True)),
        }


class StoppedError(RuntimeError):
    """A drive that did not reach its end.

    Attributes:
        history: What converged.
    """

    def __init__(self, message: str, history: History) -> None:
        super().__init__(message)
        self.history = history


def point_rows(surface: Surface, pose: GroupPose, response: Response) -> Records:
    """Rows of all points of a step, (n,) of `POINT`."""
    s, n = response.state, len(response.state)
    rows: Records = np.zeros(n, dtype=POINT)
    d1 = surface.jet(s["xi"]).d1
    rows["position"] = pose.points
    for name in ("xi", "gap", "pressure", "slip_accumulated", "status", "dissipation"):
        rows[name] = s[name]
    for name in ("dissipation_viscous", "energy_adhesion", "energy_normal"):
        if name in (s.dtype.names or ()):
            rows[name] = s[name]
    rows["traction"] = response.traction
    rows["traction_co"] = s["traction"]
    rows["traction_principal"] = response.traction_principal
    for name in ("elastic", "slip"):
        rows[f"{name}_contra"] = s[name]
        rows[name] = np.einsum("ni,nij->nj", s[name], d1)
    rows["normal"] = response.normal
    rows["friction_axes"] = response.directions_friction
    rows["adhesion_axes"] = response.directions_adhesion
    return rows


def set_slip(surface: Surface, rows: Records, slip: Floats) -> None:
    """Replace the sliding increment of rows by the tangential part of vectors (n, 3)."""
    d1, g = surface.jet(rows["xi"]).d1, surface.geometry(rows["xi"])
    rows["slip_contra"] = np.einsum("nij,njk,nk->ni", g.a_contra, d1, slip)
    rows["slip"] = np.einsum("ni,nij->nj", rows["slip_contra"], d1)


def _flat(rows: Records, prefix: str = "") -> Iterator[tuple[str, npt.NDArray[Any]]]:
    """Columns of plain numbers with dotted names."""
    for name in rows.dtype.names or ():
        block = rows[name]
        path = f"{prefix}{name}"
        if block.dtype.names:
            yield from _flat(block, f"{path}.")
        elif block.ndim == 1:
            yield path, block
        elif block.ndim == 2:
            for i, letter in enumerate(_LETTERS[block.shape[1]]):
                yield f"{path}.{letter}", block[:, i]
        else:
            for i, j in np.ndindex(block.shape[1:]):
                yield f"{path}.{i + 1}.{'xyz'[j]}", block[:, i, j]
