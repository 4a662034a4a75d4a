"""Every registered direction field and friction model on every registered surface.

Requirement: unit axes in the tangent plane, a symmetric positive tensor, no change of what is
physical under a rigid motion, exact derivatives. Source: the definition of a field,
docs/theory/direction-fields.md. A field or model without a sample fails.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions, tensor, tensor_derivative
from anisocontact.base import registry
from anisocontact.laws import Friction
from anisocontact.surfaces import make_surface

VALUES = (4.0, 1.0)
SHIFT = np.array([2.0, -3.0, 1.5])


def inner(sample: Any, n: int = 400, seed: int = 1) -> Any:
    """Random coordinates in the middle half of a sample's window, (n, 2)."""
    lower, upper = np.transpose(sample.window)
    middle, quarter = 0.5 * (lower + upper), 0.25 * (upper - lower)
    return np.random.default_rng(seed).uniform(middle - quarter, middle + quarter, (n, 2))


def _axis(sample: Any) -> Any:
    """An axis that does not meet the sample and is not its own."""
    return np.array([sample.centre + sample.size * np.array([9.0, 7.0, -8.0]), [0.2, -0.5, 1.0]])


def _nodes(sample: Any, n: int) -> tuple[Any, Any, Any]:
    """Coordinates of a grid over the window, positions and a smooth direction at the nodes."""
    surface = sample.make()
    periodic = surface.domain[2]
    lines = [
        np.linspace(*ends, n, endpoint=not p)
        for ends, p in zip(sample.window, periodic, strict=True)
    ]
    xi = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1).reshape(-1, 2)
    d1 = surface.jet(xi).d1
    e = d1 / np.linalg.norm(d1, axis=2)[..., None]
    turn = 0.3 + 0.2 * np.sin(xi[:, :1] + 0.5)
    return xi, surface.position(xi), np.cos(turn) * e[:, 0] + np.sin(turn) * e[:, 1]


def _grid(sample: Any) -> dict[str, Any]:
    periodic = sample.make().domain[2]
    _, _, vectors = _nodes(sample, 24)
    lower, upper = np.transpose(sample.window)
    word = ("none", "first", "second", "both")[periodic[0] + 2 * periodic[1]]
    return {
        "lower": lower,
        "upper": upper,
        "counts": (24, 24),
        "vectors": vectors,
        "periodic": word,
    }


def _scattered(sample: Any) -> dict[str, Any]:
    _, x, vectors = _nodes(sample, 60)
    return {"points": x, "vectors": vectors}


#: Parameters of every registered field on a sample of a surface.
FIELDS: dict[str, Callable[[Any], dict[str, Any]]] = {
    "constant": lambda s: {"vector": (1.0, 0.3, 0.2), "angle": 0.4},
    "oblique": lambda s: {"vector": (1.0, 0.3, 0.2), "angle_first": 0.2, "angle_second": 1.3},
    "polar": lambda s: {"axis": _axis(s), "angle": 0.3},
    "spiral": lambda s: {"axis": _axis(s), "pitch": 20.0 * s.size},
    "coordinate-lines": lambda s: {"angle": 0.3},
    "from-vectors": lambda s: {"first": (1.0, 0.3, 0.2), "second": (-0.2, 1.0, 0.5)},
    "tabulated-grid": _grid,
    "tabulated-points": _scattered,
}

_M, _K = ((1.0, 0.3, 0.2), (-0.2, 1.0, 0.5))
#: Arguments of `Friction` for every registered friction model, the directions aside.
FRICTION: dict[str, dict[str, Any]] = {
    "orthotropic": {"coefficients": (0.3, 0.1)},
    "he-curnier": {"alpha": (0.3, -0.1, 0.15)},
}


def moved(kind: str, parameters: dict[str, Any], q: Any, t: Any) -> dict[str, Any]:
    """Parameters of the field that is turned by q and shifted by t with its surface."""
    result = dict(parameters)
    for p in registry.entry(registry.direction_fields(), kind).parameters:
        value = parameters.get(p.name)
        if value is None:
            continue
        if p.kind == "axis":
            result[p.name] = np.array([value[0] @ q.T + t, value[1] @ q.T])
        elif p.kind == "vector" or (p.kind == "array" and p.unit == "1"):
            result[p.name] = np.asarray(value) @ q.T + (t if p.unit == "length" else 0.0)
        elif p.kind == "array":
            result[p.name] = np.asarray(value) @ q.T + t
    return result


def turned_surface(sample: Any, surfaces: Any, q: Any) -> Any:
    """The surface of a sample, turned by q and shifted."""
    parameters = surfaces.moved(sample.parameters, sample.shape, q, SHIFT, 1.0)
    return make_surface(sample.shape, **parameters)


def regular(sample: Any, field: Any) -> Any:
    """Coordinates away from the points where a vector is normal to a closed surface.

    There the derivatives grow without bound; the tenth of the points where they are largest is
    left out.
    """
    surface, xi = sample.make(), inner(sample)
    xi = xi[field.axes(surface, xi)[1]]
    d = tensor_derivative(surface, xi, field, VALUES)
    keep = np.argsort(np.abs(d).max(axis=(1, 2, 3)))
    return xi[keep[: int(0.9 * len(keep))]]


@pytest.mark.parametrize("what", ["fields", "friction"])
def test_every_entry_has_a_sample(what: str) -> None:
    """Requirement: nothing is registered without being verified; source: the registries."""
    samples, entries = {
        "fields": (FIELDS, registry.direction_fields()),
        "friction": (FRICTION, registry.friction_models()),
    }[what]
    assert set(samples) == {e.name for e in entries}


@pytest.mark.parametrize("kind", FIELDS)
def test_axes_are_unit_tangents(sample: Any, kind: str) -> None:
    """Requirement: |e_a| = 1, e_a . n = 0, valid; source: `Axes`.

    Tolerance: 1e-13, some hundred roundings of numbers of size 1; polar and spiral fields take
    positions some 15 sizes from their axis, which costs another digit.
    """
    surface, xi = sample.make(), inner(sample)
    e, valid = make_directions(kind, **FIELDS[kind](sample)).axes(surface, xi)
    assert valid.mean() > 0.99, "the field is regular but for isolated points"
    e, normal = e[valid], surface.geometry(xi).normal[valid]
    assert np.abs(np.linalg.norm(e, axis=2) - 1.0).max() < 1e-13
    assert np.abs(np.einsum("nak,nk->na", e, normal)).max() < 1e-12


@pytest.mark.parametrize("kind", FIELDS)
def test_tensor_is_symmetric_positive(sample: Any, kind: str) -> None:
    """Requirement: A symmetric, positive definite, of the trace l_1 + l_2; source: eq. (48).

    Tolerance: 1e-12 of the trace, rounding of 3 x 3 products.
    """
    field = make_directions(kind, **FIELDS[kind](sample))
    surface = sample.make()
    a = tensor(surface, regular(sample, field), field, VALUES, "spatial")
    assert np.abs(a - a.transpose(0, 2, 1)).max() < 1e-12 * sum(VALUES)
    eigenvalues = np.linalg.eigvalsh(a)
    assert np.abs(eigenvalues[:, 0]).max() < 1e-12 * sum(VALUES)  # none along the normal
    assert eigenvalues[:, 1].min() > 0.0
    assert np.abs(eigenvalues.sum(axis=1) - sum(VALUES)).max() < 1e-12 * sum(VALUES)


@pytest.mark.parametrize("kind", FIELDS)
def test_frame_indifference(sample: Any, surfaces: Any, kind: str) -> None:
    """Requirement: turning and moving everything turns the tensor; source: objectivity.

    Tolerance: 1e-10 of the largest eigenvalue, the requirement; positions are some ten sizes from
    the origin and axes some ten more, so that roundings grow by 1e3 at most.
    """
    q = surfaces.rotation((1.0, -2.0, 0.5), 1.1)
    parameters = FIELDS[kind](sample)
    before = make_directions(kind, **parameters)
    after = make_directions(kind, **moved(kind, parameters, q, SHIFT))
    xi = regular(sample, before)
    turned = turned_surface(sample, surfaces, q)
    a = tensor(sample.make(), xi, before, VALUES, "spatial")
    b = tensor(turned, xi, after, VALUES, "spatial")
    assert np.abs(b - q @ a @ q.T).max() < 1e-10 * max(VALUES)


@pytest.mark.parametrize("placement", ["co", "contra"])
@pytest.mark.parametrize("kind", FIELDS)
def test_derivative_by_order_of_convergence(sample: Any, kind: str, placement: str) -> None:
    """Requirement: dA_ij/dxi^k exact; source: central differences, whose error is O(h^2).

    Halving the step quarters the error. The median of the ratios is taken: a difference that
    reaches over a border of a tabulated field's cells has a lower order. Where the differences
    are as good as rounding lets them be (fields that do not change along the surface), they are
    compared with 1e-7, some eps^(1/2). The steps are shares of the range of the coordinates, so
    that those of a patch on the unit square are not longer than those of a full turn.
    """
    field, surface = make_directions(kind, **FIELDS[kind](sample)), sample.make()
    xi = regular(sample, field)
    exact = tensor_derivative(surface, xi, field, VALUES, placement)
    size = np.abs(tensor(surface, xi, field, VALUES, placement)).max(axis=(1, 2))

    def error(h: float) -> Any:
        e = np.zeros(len(xi))
        for k in range(2):
            step = h * np.eye(2)[k]
            plus, minus = (tensor(surface, xi + s, field, VALUES, placement) for s in (step, -step))
            e = np.maximum(e, np.abs((plus - minus) / (2 * h) - exact[..., k]).max(axis=(1, 2)))
        return e / size

    lower, upper, _ = surface.domain
    unit = min(1.0, *((b - a) / (2.0 * np.pi) for a, b in zip(lower, upper, strict=True)))
    coarse, fine = error(4e-3 * unit), error(2e-3 * unit)
    resolved = coarse > 1e-7
    assert np.all(fine[~resolved] < 1e-7)
    if resolved.sum() > 20:
        assert np.median(coarse[resolved] / fine[resolved]) == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("model", FRICTION)
def test_friction_tensor(sample: Any, surfaces: Any, model: str) -> None:
    """Requirement: F symmetric positive definite on the tangent plane and frame-indifferent.

    Source: thermodynamics, T.FT > 0 [Konyukhov Schweizerhof 2006, section 3.3]. Tolerance: 1e-10
    of F, the requirement.
    """
    m, k = ({"vector": v} for v in (_M, _K))
    entry = registry.entry(registry.friction_models(), model)

    def spatial(surface: Any, xi: Any, q: Any) -> Any:
        first, second = (
            make_directions("constant", **moved("constant", v, q, SHIFT)) for v in (m, k)
        )
        more = {"directions_second": second} if entry.directions == 2 else {}
        friction = Friction(model=model, directions=first, **more, **FRICTION[model])
        return friction.tensor(surface, xi, "spatial")

    xi = inner(sample)
    q = surfaces.rotation((1.0, -2.0, 0.5), 1.1)
    f = spatial(sample.make(), xi, np.eye(3))
    assert np.abs(f - f.transpose(0, 2, 1)).max() < 1e-10 * np.abs(f).max()
    eigenvalues = np.linalg.eigvalsh(f)
    assert np.all(eigenvalues[:, 1] > 0.1) and np.abs(eigenvalues[:, 0]).max() < 1e-9
    turned = spatial(turned_surface(sample, surfaces, q), xi, q)
    assert np.abs(turned - q @ f @ q.T).max() < 1e-10 * np.abs(f).max()
