"""Plane views of a contact: axes in its mean tangent plane, filled maps of point values."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt
from matplotlib.colors import ListedColormap

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.figure_style import STATUS_COLOURS
from anisocontact.base.peaks import PEAK
from anisocontact.results.dataset import DataSet
from anisocontact.results.report.contour import Contour, contour_of
from anisocontact.results.report.facet_map import FacetMap, polygons_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable

#: Component of a direction that its name has as 0.
UNSEEN = 5e-4
#: One less the cosine of the angle up to which directions are drawn as the same: 2.6 degrees.
ALIKE = 1e-3
#: Cosine of the angle up to which a contact is seen along an axis of space: 11 degrees.
NEARLY = 0.98
#: Length of the mean of the unit normals below which a master is closed.
CLOSED = 0.1
#: Pixels of a map along its longer side.
PIXELS = 500
#: Half the width of the strip that points on a line are seen as, over their length.
STRIP = 0.05
#: Share of the length of a line that parts two places on it.
SAME = 1e-9


@dataclass(frozen=True)
class Frame:
    """Two axes in a plane.

    Args:
        axes: Unit vectors, (2, 3).
        normal: Unit vector across them, (3,).
    """

    axes: Floats
    normal: Floats

    @classmethod
    def across(cls, normal: Floats) -> Frame:
        """Axes across a normal, the first one along x, or y where x is the normal."""
        n = normal / np.linalg.norm(normal)
        along = np.eye(3)[0 if abs(n[0]) < 0.9 else 1]
        first = along - (along @ n) * n
        first /= np.linalg.norm(first)
        second = np.cross(n, first)
        # Upwards in the picture is a positive direction, whichever side that shows.
        second *= np.sign(second[np.argmax(np.abs(second))])
        return cls(np.stack([first, second]), n)

    def names(self) -> tuple[str, str]:
        """What the axes are called: x, y, z where they are those, else their components."""
        first, second = (axis_name(axis) for axis in self.axes)
        return first, second

    @property
    def normal_name(self) -> str:
        """What the normal is called."""
        return axis_name(self.normal)

    def of(self, vectors: Floats) -> Floats:
        """Components of vectors along the axes, (..., 2)."""
        return np.asarray(vectors @ self.axes.T)


class ContactView:
    """The slave points of one contact, seen against the normal of the master.

    Where they go all around the master only those that face the viewer are kept.

    Args:
        points: All slave points of a run.
        number: Which contact.
        contour: The outline of the slave as it is seen at another moment; its own if left out.

    Attributes:
        closed: Whether the points go all around the master.
    """

    closed: bool

    def __init__(self, points: DataSet, number: int, contour: Contour | None = None) -> None:
        chosen = np.asarray(points.point_data["contact"]) == number
        self.data: dict[str, npt.NDArray[Any]] = {
            name: np.asarray(points.point_data[name])[chosen] for name in points.point_data
        }
        self.position: Floats = np.asarray(points.points, dtype=float)[chosen]
        self.frame = Frame.across(self._seen_against())
        if self.closed:
            facing = self.data["normal"] @ self.frame.normal > 0.0
            self.data = {name: values[facing] for name, values in self.data.items()}
            self.position = self.position[facing]
            chosen[chosen] = facing
        self.touching = self.data["status"] > 0
        if "covered" in self.data:
            self.touching &= self.data["covered"] > PEAK
        self._polygons = polygons_of(points, chosen)
        found = None if self.closed else contour or contour_of(points, chosen)
        self.contour = found if contour or found is None else found.opened(self.touching)

    def _seen_against(self) -> Floats:
        """Mean normal, or an axis of space where the master is closed and the mean means nothing.

        The mean is that of the points that touch, if any does. The axis is the one that most
        normals are along, the last one of several. Points far from a meshed master have no
        normal; where none has one, it is that of the plane through them.
        """
        normal = self.data["normal"]
        if not normal.any():
            self.closed = False
            away = self.position - self.position.mean(axis=0)
            across = np.linalg.svd(away, full_matrices=False)[2][-1]
            return np.asarray(across * np.sign(across[np.argmax(np.abs(across))]))
        total = np.asarray(normal.sum(axis=0))
        self.closed = bool(np.linalg.norm(total) < CLOSED * np.linalg.norm(normal, axis=1).sum())
        if not self.closed:
            near = np.asarray(normal[self.data["status"] > 0].sum(axis=0))
            seen = (
                near if np.linalg.norm(near) > CLOSED * (self.data["status"] > 0).sum() else total
            )
            return _straight(seen / np.linalg.norm(seen))
        share = np.mean(normal**2, axis=0)
        axis = np.flatnonzero(share >= 0.99 * share.max())[-1]
        return np.asarray(-np.eye(3)[axis] if axis == 1 else np.eye(3)[axis])

    @cached_property
    def _facets(self) -> FacetMap | None:
        """The facets between the points, where there are any."""
        return FacetMap(self.flat, self._polygons) if len(self._polygons) else None

    @cached_property
    def flat(self) -> Floats:
        """Positions along the axes of the frame, or along an outline that folds, (n, 2)."""
        flat = self.frame.of(self.position)
        if not self._folds:
            return flat
        assert self.contour is not None
        return np.column_stack([self.contour.way(self.position), np.zeros(len(flat))])

    @cached_property
    def _folds(self) -> bool:
        """Whether places along the first axis are those of several points of an outline."""
        along = self.frame.of(self.position)[:, 0]
        return self.contour is not None and self.contour.folds(along)

    def names(self) -> tuple[str, str]:
        """What the two coordinates of positions are called."""
        first, second = self.frame.names()
        return ("arc length along the slave", "across") if self._folds else (first, second)

    def mean_axes(self, law: str) -> Floats | None:
        """Axes of "adhesion" or "friction" in the frame, (2, 2); None where they vary."""
        axes = np.stack([self.data[f"direction_{law}_{i}"] for i in (1, 2)], axis=1)[self.touching]
        if not len(axes):
            return None
        mean = self.frame.of(axes.mean(axis=0))
        # The mean of equal unit vectors has length one; those that deforming bodies carry differ by
        # a degree or two, which no picture shows.
        return mean if np.all(np.linalg.norm(mean, axis=1) > 1.0 - ALIKE) else None

    @cached_property
    def level(self) -> float:
        """Size of the resultant of all pressures over their sum, 1 in a plane; 0 without any."""
        force = (self.data["pressure"] * self.data["area"])[:, None] * self.data["normal"]
        sizes = float(np.linalg.norm(force, axis=1).sum())
        return float(np.linalg.norm(force.sum(axis=0))) / sizes if sizes > 0.0 else 0.0

    @cached_property
    def box(self) -> Floats:
        """Lowest and highest position along the axes of the frame with a margin, (2, 2)."""
        low, high = self.flat.min(axis=0), self.flat.max(axis=0)
        extent = (high - low).max()
        size = 0.0 if self.on_line else np.sqrt(self.data["area"].max())
        margin = (STRIP if self.on_line else 0.04) * extent + size
        return np.stack([low - margin, high + margin])

    @cached_property
    def on_line(self) -> bool:
        """Whether the points lie on a line, as those of a mesh in the plane do: seen as a strip."""
        first, second = np.ptp(self.flat, axis=0)
        return bool(second < STRIP * first)

    @cached_property
    def one_curve(self) -> bool:
        """Whether the points lie on a line, each at its own place: values over it are a curve."""
        places = np.sort(self.flat[:, 0])
        apart = np.diff(places).min(initial=np.inf)
        return bool(self.on_line and apart > SAME * (places[-1] - places[0]))

    @property
    def aspect(self) -> float:
        """Height of a map over its width."""
        width, height = self.box[1] - self.box[0]
        return float(height / width)

    @cached_property
    def _nearest(self) -> tuple[Ints, Flags]:
        """The point nearest to each pixel and whether it is too far to speak for the pixel."""
        from scipy.spatial import KDTree  # slow to import, and points with facets do without

        size = self.box[1] - self.box[0]
        counts = np.maximum((PIXELS * size / size.max()).astype(int), 2)
        sides = [np.linspace(self.box[0, i], self.box[1, i], int(counts[i])) for i in (0, 1)]
        pixels = np.stack(np.meshgrid(*sides), axis=-1)
        if self.on_line:
            _, nearest = KDTree(self.flat[:, :1]).query(pixels[..., :1])
            return nearest, np.zeros(nearest.shape, dtype=bool)
        distance, nearest = KDTree(self.flat).query(pixels, p=np.inf)
        return nearest, distance > 1.2 * np.sqrt(self.data["area"])[nearest]

    def draw(self, axes: Axes, values: npt.NDArray[Any], **style: Any) -> ScalarMappable:
        """Draw values at the points as a filled map: every place shows the nearest point.

        Args:
            axes: Where.
            values: A value for each point, NaN where it is to be left blank, (n,).
            **style: Colours and their limits, as Matplotlib takes them.

        Returns:
            What a scale of colours is made of.
        """
        first, second = self.names()
        axes.set_xlabel(f"{first} [length]")
        axes.set_ylabel(f"{second} [length]")
        if self._facets is not None:
            self._frame_in(axes)
            return self._facets.by_node(axes, values.astype(float), **style)
        nearest, outside = self._nearest
        picked = values.astype(float)[nearest]
        (left, bottom), (right, top) = self.box.tolist()
        return axes.imshow(
            np.ma.masked_where(outside | np.isnan(picked), picked),
            origin="lower",
            extent=(left, right, bottom, top),
            interpolation="nearest",
            **style,
        )

    def draw_touching(self, axes: Axes, values: Floats, **style: Any) -> ScalarMappable:
        """Draw values that are zero where points are open, and open points in grey.

        On facets they fall to zero at the open nodes beside those that touch.
        """
        grey = ListedColormap([STATUS_COLOURS[0]])
        self.draw(axes, np.where(self.touching, np.nan, 0.0), cmap=grey)
        if self._facets is None:
            return self.draw(axes, np.where(self.touching, values, np.nan), **style)
        near = self._facets.beside(self.touching)
        shown = np.where(self.touching, values, np.where(near, 0.0, np.nan))
        return self._facets.smooth(axes, shown, **style)

    def _frame_in(self, axes: Axes) -> None:
        """Show the box of the view, true to scale; panels in common axes have an agreed one."""
        axes.set_aspect("equal")
        if len(axes.get_shared_x_axes().get_siblings(axes)) > 1:
            return
        (left, bottom), (right, top) = self.box.tolist()
        axes.set(xlim=(left, right), ylim=(bottom, top))


def _straight(normal: Floats) -> Floats:
    """A unit normal, or the axis of space that it is nearly along: pictures have x, y or z then."""
    main = int(np.argmax(np.abs(normal)))
    return np.sign(normal[main]) * np.eye(3)[main] if abs(normal[main]) > NEARLY else normal


def axis_name(axis: Floats) -> str:
    """Letter of a direction along an axis of space, or its components."""
    for letter, unit in zip("xyz", np.eye(3), strict=True):
        if abs(axis @ unit) > 1.0 - ALIKE:
            return letter if axis @ unit > 0.0 else f"-{letter}"
    shown = np.where(np.abs(axis) < UNSEEN, 0.0, axis)
    return f"({', '.join(f'{v:.3g}' for v in shown)})"
