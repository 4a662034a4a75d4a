"""Direction fields: two axes in the tangent plane of a surface, and the tensors on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.surfaces import Floats, Surface, points

Pair = Sequence[float]

#: Placements of the components of a tensor: A_ij, A^ij, A^i_j, and the spatial 3 x 3 tensor.
PLACEMENTS = ("co", "contra", "mixed", "spatial")


#: Fields that are given by the coordinates of a surface: facets of a mesh have none of their own.
BY_COORDINATES = frozenset({"coordinate-lines", "tabulated-grid"})


class DirectionField:
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
        self.named = name, values
        self.core = _core.Field(name, values)

    def __repr__(self) -> str:
        return f"DirectionField({self.name!r})"

    def axes(self, surface: Surface, xi: npt.ArrayLike) -> tuple[Floats, npt.NDArray[np.bool_]]:
        """Unit axes at coordinates of a surface.

        Args:
            surface: The surface.
            xi: Coordinates, (n, 2).

        Returns:
            Axes e_1, e_2, (n, 2, 3), and whether the field is regular there, (n,).
        """
        r = self.core.axes(surface.core, points(xi, 2, "xi"))
        return r["e"], r["valid"]


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


def tensor(
    surface: Surface,
    xi: npt.ArrayLike,
    field: DirectionField,
    eigenvalues: Pair,
    placement: str = "co",
    *,
    basis: npt.ArrayLike | None = None,
) -> Floats:
    """A = lambda_1 e_1 (x) e_1 + lambda_2 e_2 (x) e_2 on the axes of a field.

    [Konyukhov Schweizerhof 2006, eq. (48), (55), (57)]. The adhesion tensor B has the values
    (-eps_1, -eps_2), the friction tensor F the values (1/mu_1^2, 1/mu_2^2).

    Args:
        surface: The surface.
        xi: Coordinates, (n, 2).
        field: The axes.
        eigenvalues: lambda_1, lambda_2, of one sign; one of them may be zero. They are the
            eigenvalues where the axes are orthogonal.
        placement: "co" A_ij, "contra" A^ij, "mixed" A^i_j or "spatial".
        basis: Two tangent vectors g_i that the components belong to, (2, 3) or (n, 2, 3); the
            basis rho_i of the surface if left out.

    Returns:
        Components, (n, 2, 2); the spatial tensor, (n, 3, 3).

    Raises:
        InputError: Eigenvalues of different signs, an unknown placement, or a point where the
            field has no direction.

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
        >>> marks = make_directions("constant", vector=(1, 0, 0))
        >>> tensor(plane, [[0, 0]], marks, (4.0, 1.0))[0].tolist()
        [[4.0, 0.0], [0.0, 1.0]]
    """
    if placement not in PLACEMENTS:
        raise InputError(f"{placement!r} given, allowed: {', '.join(PLACEMENTS)}", "placement")
    xi = points(xi, 2, "xi")
    r = field.core.tensor(surface.core, xi, _semidefinite(eigenvalues))
    require_regular(surface, xi, r["valid"])
    return components(surface, xi, r["co"], placement, basis)


def tensor_derivative(
    surface: Surface,
    xi: npt.ArrayLike,
    field: DirectionField,
    eigenvalues: Pair,
    placement: str = "co",
) -> Floats:
    """Derivatives of the components of `tensor` along the coordinates, exact by dual numbers.

    Args:
        surface: The surface.
        xi: Coordinates, (n, 2).
        field: The axes.
        eigenvalues: lambda_1, lambda_2.
        placement: "co" or "contra".

    Returns:
        dA_ij/dxi^k or dA^ij/dxi^k, k last, (n, 2, 2, 2).

    Raises:
        InputError: As `tensor`.

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> bar = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=2)
        >>> along = make_directions("constant", vector=(0, 0, 1))
        >>> tensor_derivative(bar, [[0.3, 1.0]], along, (2.0, 1.0)).shape
        (1, 2, 2, 2)
    """
    if placement not in PLACEMENTS[:2]:
        raise InputError(f"{placement!r} given, allowed: co, contra", "placement")
    xi = points(xi, 2, "xi")
    r = field.core.tensor(surface.core, xi, _semidefinite(eigenvalues))
    require_regular(surface, xi, r["valid"])
    derivative: Floats = r[f"d_{placement}"]
    return derivative


def components(
    surface: Surface,
    xi: Floats,
    co: Floats,
    placement: str,
    basis: npt.ArrayLike | None = None,
) -> Floats:
    """Components of a tensor in another placement, and in another basis.

    Args:
        surface: The surface.
        xi: Coordinates, (n, 2).
        co: A_ij in the basis rho_i, (n, 2, 2).
        placement: One of `PLACEMENTS`.
        basis: Two tangent vectors, (2, 3) or (n, 2, 3); rho_i if left out.

    Returns:
        Components, (n, 2, 2), or the spatial tensor, (n, 3, 3).

    Raises:
        InputError: The basis does not span the tangent plane.
    """
    rho = surface.jet(xi).d1
    a = rho @ rho.transpose(0, 2, 1)
    dual = np.linalg.solve(a, rho)  # rho^i
    spatial: Floats = np.einsum("nik,nij,njl->nkl", dual, co, dual)
    if placement == "spatial":
        return spatial
    if basis is not None:
        g = np.broadcast_to(np.asarray(basis, dtype=np.float64), rho.shape)
        co = np.einsum("nik,nkl,njl->nij", g, spatial, g)
        a = g @ g.transpose(0, 2, 1)
        normal = np.cross(rho[:, 0], rho[:, 1])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        lengths = np.linalg.norm(g, axis=2)
        off = np.abs(np.einsum("nik,nk->ni", g, normal)) > 1e-8 * lengths
        if off.any() or (np.linalg.det(a) <= 1e-16 * np.prod(lengths**2, axis=1)).any():
            raise InputError("two independent vectors of the tangent plane needed", field="basis")
    if placement == "co":
        return co
    mixed = np.linalg.solve(a, co)
    return mixed if placement == "mixed" else np.linalg.solve(a, mixed.transpose(0, 2, 1))


def require_regular(surface: Surface, xi: Floats, valid: npt.NDArray[np.bool_]) -> None:
    """Refuse points at which a field has no direction.

    Args:
        surface: The surface.
        xi: Coordinates, (n, 2).
        valid: Whether the field is regular there, (n,).

    Raises:
        InputError: It is not somewhere; the first such point is named.
    """
    wrong = np.flatnonzero(~valid)
    if wrong.size:
        where = xi[wrong[0]]
        raise InputError(
            f"no direction at {where.tolist()}, x = {surface.position(where)[0].tolist()}: the "
            "field is singular there, along the normal or out of its table",
            field="xi",
        )


def _semidefinite(eigenvalues: Pair) -> tuple[float, float]:
    e = np.asarray(eigenvalues, dtype=np.float64)
    if e.shape != (2,) or not np.isfinite(e).all() or not e.any() or e[0] * e[1] < 0.0:
        raise InputError(
            f"{eigenvalues!r} given, two numbers of one sign needed, one of them may be zero",
            field="eigenvalues",
        )
    return float(e[0]), float(e[1])


def oblique_principal(
    values: npt.ArrayLike, angles: npt.ArrayLike
) -> tuple[Floats, npt.NDArray[np.float64]]:
    """Eigenvalues of l_1 r_1 (x) r_1 + l_2 r_2 (x) r_2 on oblique unit vectors.

    The sum of two directions is an orthotropic tensor again, with the eigenvalues
    (l_1 + l_2)/2 +- 1/2 sqrt(l_1^2 + l_2^2 + 2 l_1 l_2 cos 2(a - b)), so that l_1 is not the
    stiffness along r_1 unless the two are orthogonal
    [Konyukhov Schweizerhof 2006, eq. (48), (58)-(60)].

    Args:
        values: l_1, l_2, (..., 2).
        angles: Angles a, b of r_1, r_2, (..., 2) [rad].

    Returns:
        Eigenvalues, the larger first, (..., 2), and the angle of the first's axis, (...) [rad].

    Example:
        >>> e, angle = oblique_principal((2.0, 2.0), (0.0, np.pi / 3))
        >>> e.round(12).tolist(), float(np.degrees(angle).round(12))
        ([3.0, 1.0], 30.0)
    """
    v, double = np.asarray(values, dtype=np.float64), 2.0 * np.asarray(angles, dtype=np.float64)
    sine = np.sum(v * np.sin(double), axis=-1)
    cosine = np.sum(v * np.cos(double), axis=-1)
    mean, half = 0.5 * v.sum(axis=-1), 0.5 * np.hypot(sine, cosine)
    return np.stack([mean + half, mean - half], axis=-1), 0.5 * np.arctan2(sine, cosine)


Directions = npt.ArrayLike | tuple[npt.ArrayLike, npt.ArrayLike]


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

    The function is called once, at the nodes of a grid of the surface's coordinates; between them
    its directions are interpolated as lines, v and -v being the same.

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
    return grid.field(f(surface.position(grid.xi)), interpolation)


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
    """
    grid = _Grid(surface, counts, lower, upper)
    j = np.asarray(jacobian(grid.xi), dtype=np.float64)
    if j.shape != (len(grid.xi), 2, 2):
        raise InputError(f"an array of shape {j.shape} given, (n, 2, 2) needed", field="jacobian")
    singular = np.flatnonzero(~(np.abs(np.linalg.det(j)) > 0.0))
    if singular.size:
        raise InputError(f"singular at xi = {grid.xi[singular[0]].tolist()}", field="jacobian")
    return grid.field(
        np.einsum("nji,njk->nik", np.linalg.inv(j), surface.jet(grid.xi).d1), interpolation
    )


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
        whole = np.isclose(np.subtract(self.upper, self.lower), np.subtract(ends[1], ends[0]))
        self.periodic = [bool(p and w) for p, w in zip(ends[2], whole, strict=True)]
        lines = [
            np.linspace(a, b, n, endpoint=not p)
            for a, b, n, p in zip(self.lower, self.upper, counts, self.periodic, strict=True)
        ]
        self.xi = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)

    def field(self, directions: Directions, interpolation: str) -> DirectionField:
        """The tabulated field of directions at the nodes."""
        n = len(self.xi)
        v = np.asarray(directions, dtype=np.float64)
        if isinstance(directions, tuple) and v.shape == (2, n, 3):
            v = v.transpose(1, 0, 2)
        if v.shape == (n, 3):
            v = v[:, None]
        if v.shape not in ((n, 1, 3), (n, 2, 3)):
            raise InputError(f"directions of shape {v.shape} given, (n, 3) or (n, 2, 3) needed")
        normal = self.surface.geometry(self.xi).normal
        tangential = v - np.einsum("nak,nk->na", v, normal)[..., None] * normal[:, None]
        size = np.linalg.norm(tangential, axis=2)
        wrong = np.flatnonzero(~(size > 1e-8 * np.linalg.norm(v, axis=2)).all(axis=1))
        if wrong.size:
            where = self.surface.position(self.xi[wrong[0]])[0].tolist()
            raise InputError(f"no direction along the surface at x = {where}", field="directions")
        second = {"second_vectors": tangential[:, 1]} if len(v[0]) == 2 else {}
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
