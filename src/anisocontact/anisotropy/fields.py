"""Direction fields: two axes in the tangent plane of a surface."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.base import registry
from anisocontact.base.array_types import Flags, Floats, Pair
from anisocontact.base.arrays import real
from anisocontact.base.copied_by_arguments import CopiedByArguments
from anisocontact.base.errors import InputError, ModelWarning, tell_script
from anisocontact.base.python_file import called
from anisocontact.base.read_only import read_only
from anisocontact.base.sampled import sampled
from anisocontact.base.shown import shown
from anisocontact.base.typed import typed
from anisocontact.surfaces import Surface, points

Directions = npt.ArrayLike | tuple[npt.ArrayLike, npt.ArrayLike]

#: Fields that are given by the coordinates of a surface: facets of a mesh have none of their own.
BY_COORDINATES = frozenset({"coordinate-lines", "tabulated-grid"})
#: Angle by which a sampled field may be off within a cell, radian; and the share of cells in which
#: it may be off by more, as around poles and along the border of two textures.
_OFF, _MANY = np.radians(5.0), 0.1
#: More nodes than a field has use for; their directions take a quarter of a gigabyte.
_MOST_NODES = 10**7
#: Where in a cell that is looked at: what turns by a whole turn from node to node is right in the
#: middle of them, too, as a line.
_WITHIN = 0.38


class DirectionField(CopiedByArguments):
    """A direction field; make one with `make_directions`, `from_callable`, ...

    Args:
        name: Name in the registry.
        values: Its parameters as the core takes them.

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> rays = make_directions("polar", axis=((0, 0, 0), (0, 0, 1)))
        >>> axes, regular = rays.axes(plane, [[3.0, 4.0], [0.0, 0.0]])
        >>> axes[0, 0].round(6).tolist(), regular.tolist()  # along the ray; none in the pole
        ([0.6, 0.8, 0.0], [True, False])
    """

    def __init__(self, name: str, values: dict[str, list[float]]) -> None:
        self.name = name
        self.named = name, read_only(values)
        self.core = _core.Field(name, values)

    def __repr__(self) -> str:
        return f"DirectionField({self.name!r})"

    def axes(self, surface: Surface, xi: npt.ArrayLike) -> tuple[Floats, Flags]:
        """Unit axes at coordinates of a surface.

        Args:
            surface: The surface.
            xi: Coordinates, (n, 2).

        Returns:
            Axes e_1, e_2, (n, 2, 3), and whether the field is regular there, (n,).
        """
        r = self.core.axes(surface.core, points(xi, 2, "xi"))
        return r["e"], r["valid"]


@typed
def make_directions(name: str, **parameters: object) -> DirectionField:
    """A direction field of the registry.

    Args:
        name: Name in `registry.direction_fields()`.
        **parameters: Its parameters; angles in radians.

    Returns:
        The field.

    Raises:
        InputError: Unknown name or parameter, or a value out of range.

    Example:
        >>> marks = make_directions("constant", vector=(1, 0, 0), angle=np.pi / 2)
        >>> from anisocontact.surfaces import make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> np.round(marks.axes(plane, [[0, 0]])[0][0], 12).tolist()
        [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    """
    e = registry.entry(registry.direction_fields(), name, "kind")
    v = registry.values(e, parameters)
    try:
        return DirectionField(name, v)
    except ValueError as error:
        raise InputError(f"direction field {name!r}: {error}") from None


def require_regular(surface: Surface, xi: Floats, valid: Flags) -> None:
    """Refuse points at which a field has no direction.

    Args:
        surface: The surface.
        xi: Coordinates, (n, 2).
        valid: Whether the field is regular there, (n,).

    Raises:
        InputError: It is not somewhere; the first such point is named.

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> plate = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> require_regular(plate, np.zeros((1, 2)), np.array([False]))
        Traceback (most recent call last):
            ...
        anisocontact.base.errors.InputError: ...
    """
    wrong = np.flatnonzero(~valid)
    if wrong.size:
        where = xi[wrong[0]]
        raise InputError(
            f"no direction at {where.tolist()}, x = {surface.position(where)[0].tolist()}: the "
            "field is singular there, along the normal or out of its table",
            field="xi",
        )


@typed
def from_callable(
    surface: Surface,
    f: Callable[[Floats], Directions],
    *,
    counts: tuple[int, int] = (65, 65),
    lower: Pair | None = None,
    upper: Pair | None = None,
    interpolation: str = "bicubic",
) -> DirectionField:
    """A field sampled from any function of the position.

    The function is called at the nodes of a grid of the surface's coordinates; between them its
    directions are interpolated as lines, v and -v being the same. It is called once more within
    the cells, and a `ModelWarning` says where the grid is too coarse for it.

    Args:
        surface: The surface; its periodic coordinates stay so where the grid goes all around.
        f: Positions (n, 3) to directions (n, 3), or to two of them (n, 2, 3) for axes that are not
            orthogonal. They are projected on the tangent plane.
        counts: Number of nodes along each coordinate.
        lower: Coordinates of the first node; the surface's own ends if left out.
        upper: Coordinates of the last node.
        interpolation: "bicubic" (fourth order) or "bilinear" (second order).

    Returns:
        A field of the kind "tabulated-grid".

    Raises:
        InputError: The surface has no ends and none were given, or `f` has no direction somewhere.

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> rings = from_callable(
        ...     plane, lambda x: np.cross((0, 0, 1), x), lower=(1, -1), upper=(2, 1)
        ... )
        >>> rings.name
        'tabulated-grid'
    """
    grid = _Grid(surface, counts, lower, upper)

    def along(xi: Floats) -> Directions:
        return called(f, surface.position(xi), who="the function", field="f")

    return grid.table(along, interpolation)


@typed
def from_reparametrisation(
    surface: Surface,
    jacobian: Callable[[Floats], npt.ArrayLike],
    *,
    counts: tuple[int, int] = (65, 65),
    lower: Pair | None = None,
    upper: Pair | None = None,
    interpolation: str = "bicubic",
) -> DirectionField:
    """A field along the lines of a second coordinate system alpha^1, alpha^2 of the surface.

    The axes are along r_i = rho_j dxi^j/dalpha^i [Konyukhov Schweizerhof 2006, eq. (44)-(47)],
    sampled as in `from_callable`.

    Args:
        surface: The surface.
        jacobian: Coordinates xi (n, 2) to dalpha^i/dxi^j, (n, 2, 2), of the map (46).
        counts: Number of nodes along each coordinate.
        lower: Coordinates of the first node; the surface's own ends if left out.
        upper: Coordinates of the last node.
        interpolation: "bicubic" or "bilinear".

    Returns:
        A field of the kind "tabulated-grid".

    Raises:
        InputError: As `from_callable`, or the map is singular at a node.

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> skew = np.array([[1.0, -1.0], [0.0, 1.0]])  # alpha^1 = xi^1 - xi^2, alpha^2 = xi^2
        >>> lines = from_reparametrisation(
        ...     plane, lambda xi: np.tile(skew, (len(xi), 1, 1)), lower=(-1, -1), upper=(1, 1)
        ... )
        >>> lines.axes(plane, [[0.2, 0.3]])[0][0, 1].round(6).tolist()  # along xi^1 = xi^2
        [0.707107, 0.707107, 0.0]
    """
    grid = _Grid(surface, counts, lower, upper)

    def along(xi: Floats) -> Directions:
        j = sampled(jacobian, xi, (len(xi), 2, 2), field="jacobian")
        singular = np.flatnonzero(~(np.abs(np.linalg.det(j)) > 0.0))
        if singular.size:
            raise InputError(f"singular at xi = {xi[singular[0]].tolist()}", field="jacobian")
        return np.asarray(np.einsum("nji,njk->nik", np.linalg.inv(j), surface.jet(xi).d1))

    return grid.table(along, interpolation)


class _Grid:
    """Nodes of a grid of a surface's coordinates, `xi` (n, 2) with the second running fastest."""

    def __init__(
        self,
        surface: Surface,
        counts: tuple[int, int],
        lower: Pair | None,
        upper: Pair | None,
    ) -> None:
        ends = surface.domain
        self.surface, self.counts = surface, counts
        self.lower = tuple(float(v) for v in (ends[0] if lower is None else lower))
        self.upper = tuple(float(v) for v in (ends[1] if upper is None else upper))
        for name, values in (("lower", self.lower), ("upper", self.upper)):
            if len(values) != 2 or not np.isfinite(values).all():
                raise InputError(
                    f"{values} is where the surface ends, two finite numbers needed", field=name
                )
        if not all(n >= 1 for n in counts):
            raise InputError(f"{counts} given, must be > 0", "counts")
        if (count := counts[0] * counts[1]) > _MOST_NODES:
            text = f"{counts} given, {count:.1e} nodes, at most {_MOST_NODES:.0e} allowed"
            raise InputError(text, "counts")
        whole = np.isclose(np.subtract(self.upper, self.lower), np.subtract(ends[1], ends[0]))
        self.periodic = [bool(p and w) for p, w in zip(ends[2], whole, strict=True)]
        lines = [
            np.linspace(a, b, n, endpoint=not p)
            for a, b, n, p in zip(self.lower, self.upper, counts, self.periodic, strict=True)
        ]
        self.xi = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)

    def table(self, along: Callable[[Floats], Directions], interpolation: str) -> DirectionField:
        """The tabulated field of a function of the coordinates.

        Warns where cells have other directions than those between their nodes.
        """
        field = self._field(along(self.xi), interpolation)
        xi = self._within()
        try:
            tangential, size = self._tangential(xi, along(xi))
        except InputError:  # a function that knows the nodes alone
            return field
        axes, known = field.axes(self.surface, xi)
        told = (size > 0.0).all(axis=1)
        if not told.any():
            return field
        v = tangential[told] / size[told][..., None]
        cosines = np.abs(np.einsum("nak,nak->na", v, axes[told, : v.shape[1]])).min(axis=1)
        off = ~known[told] | (cosines < np.cos(_OFF))
        if off.mean() > _MANY:
            where = shown(self.surface.position(xi[told][off.argmax()])[0])
            tell_script(
                f"counts: {self.counts} given, too few for these directions: within "
                f"{off.mean():.0%} of the cells they are more than {np.degrees(_OFF):.0f} degrees "
                f"off what is interpolated, as at x = {where}; more of them follow it",
                ModelWarning,
            )
        return field

    def _within(self) -> Floats:
        """Coordinates of a point of each cell, (m, 2)."""
        lines = []
        for a, b, n, p in zip(self.lower, self.upper, self.counts, self.periodic, strict=True):
            size = (b - a) / (n if p else n - 1)
            lines.append(a + size * (np.arange(n if p else n - 1) + _WITHIN))
        return np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)

    def _tangential(self, xi: Floats, directions: Directions) -> tuple[Floats, Floats]:
        """Directions along the surface, (n, 1 or 2, 3), and their lengths over those given."""
        n = len(xi)
        v = real(directions)
        if v is None:
            text = " ".join(f"{directions!r:.60}".split())
            raise InputError(f"{text} given, an array of real numbers needed", "directions")
        if isinstance(directions, tuple) and v.shape == (2, n, 3):
            v = v.transpose(1, 0, 2)
        if v.shape == (n, 3):
            v = v[:, None]
        if v.shape not in ((n, 1, 3), (n, 2, 3)):
            raise InputError(f"directions of shape {v.shape} given, (n, 3) or (n, 2, 3) needed")
        normal = self.surface.geometry(xi).normal
        tangential = v - np.einsum("nak,nk->na", v, normal)[..., None] * normal[:, None]
        size = np.linalg.norm(tangential, axis=2)
        return tangential, np.where(size > 1e-8 * np.linalg.norm(v, axis=2), size, 0.0)

    def _field(self, directions: Directions, interpolation: str) -> DirectionField:
        """The tabulated field of directions at the nodes."""
        tangential, size = self._tangential(self.xi, directions)
        wrong = np.flatnonzero(~(size > 0.0).all(axis=1))
        if wrong.size:
            where = self.surface.position(self.xi[wrong[0]])[0].tolist()
            raise InputError(f"no direction along the surface at x = {where}", field="directions")
        second = {"second_vectors": tangential[:, 1]} if tangential.shape[1] == 2 else {}
        return make_directions(
            "tabulated-grid",
            lower=self.lower,
            upper=self.upper,
            counts=self.counts,
            vectors=tangential[:, 0],
            periodic=("none", "first", "second", "both")[self.periodic[0] + 2 * self.periodic[1]],
            interpolation=interpolation,
            **second,
        )
