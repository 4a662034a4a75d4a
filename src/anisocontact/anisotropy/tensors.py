"""Tensors on a direction field."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.anisotropy.fields import DirectionField, require_regular
from anisocontact.base.array_types import Floats, Pair
from anisocontact.base.errors import InputError
from anisocontact.surfaces import Surface, points

#: Placements of the components of a tensor: A_ij, A^ij, A^i_j, and the spatial 3 x 3 tensor.
PLACEMENTS = ("co", "contra", "mixed", "spatial")


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
        >>> from anisocontact.anisotropy import make_directions
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
        >>> from anisocontact.anisotropy import make_directions
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

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> tube = make_surface("cylinder", point=(0, 0, 0), axis=(0, 0, 1), radius=2.0)
        >>> xi = np.zeros((1, 2))
        >>> metric = tube.geometry(xi).a_co  # 4 along the circumference, 1 along the axis
        >>> components(tube, xi, metric, "mixed").tolist()
        [[[1.0, 0.0], [0.0, 1.0]]]
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


def _semidefinite(eigenvalues: Pair) -> tuple[float, float]:
    e = np.asarray(eigenvalues, dtype=np.float64)
    if e.shape != (2,) or not np.isfinite(e).all() or not e.any() or e[0] * e[1] < 0.0:
        raise InputError(
            f"{eigenvalues!r} given, two numbers of one sign needed, one of them may be zero",
            field="eigenvalues",
        )
    return float(e[0]), float(e[1])


def oblique_principal(values: npt.ArrayLike, angles: npt.ArrayLike) -> tuple[Floats, Floats]:
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
