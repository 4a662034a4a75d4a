"""Elasticity with directions against the tensor turned in NumPy, and tubes in closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.verification.bulk_tangent import ratio_of_errors

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.bulk import LinearBulk, LinearElastic, NonlinearBulk, make_material
from anisocontact.mesh import Body, BoxSpec, RingSpec, build_box, build_mesh, node_near
from anisocontact.results.paraview import BodyGrid
from anisocontact.solver import Problem, Solver, Step

#: Spruce, N/mm2: E along the grain, outwards, around.
SPRUCE: dict[str, Any] = {
    "E": (11e3, 900.0, 500.0),
    "nu": (0.37, 0.42, 0.47),
    "G": (700.0, 620.0, 40.0),
}
FIBRE: dict[str, Any] = {
    "E_along": 140e3,
    "E_across": 9e3,
    "nu_along": 0.3,
    "nu_across": 0.45,
    "G_along": 5e3,
}
PAIRS = ((0, 1), (0, 2), (1, 2))
#: Young's modulus of a bar.
E_BAR = 100.0


def tensor(moduli: Any, ratios: Any, shears: Any, axes: Any) -> Any:
    """C_ijkl in space, from the compliance written out in full and turned index by index."""
    compliance = np.zeros((3, 3, 3, 3))
    for i in range(3):
        compliance[i, i, i, i] = 1.0 / moduli[i]
    for (i, j), nu, g in zip(PAIRS, ratios, shears, strict=True):
        compliance[i, i, j, j] = compliance[j, j, i, i] = -nu / moduli[i]
        for a, b in ((i, j), (j, i)):
            for c, d in ((i, j), (j, i)):
                compliance[a, b, c, d] = 0.25 / g
    # inverse on symmetric tensors, in an orthonormal basis of them
    basis = [np.outer(e, e) for e in np.eye(3)]
    for i, j in PAIRS:
        m = np.zeros((3, 3))
        m[i, j] = m[j, i] = np.sqrt(0.5)
        basis.append(m)
    b = np.array(basis)
    flat = np.einsum("aij,ijkl,bkl->ab", b, compliance, b)
    stiff = np.einsum("aij,ab,bkl->ijkl", b, np.linalg.inv(flat), b)
    return np.einsum("ia,jb,kc,ld,abcd->ijkl", axes, axes, axes, axes, stiff)


def axes_of(first: Any, second: Any) -> Any:
    q, _ = np.linalg.qr(np.column_stack([first, second, np.cross(first, second)]))
    return q * np.sign(np.diag(q.T @ np.column_stack([first, second, np.cross(first, second)])))


def virtual_work(material: Any, gradient: Any, virtual: Any) -> float:
    """Stress of a homogeneous deformation times a homogeneous virtual one, of a unit volume."""
    spec = BoxSpec((0.3, -0.2, 0.1), (1, 1, 1), (2, 1, 1))
    model = build_box({"cube": spec})
    bulk = (LinearBulk if material.linear else NonlinearBulk)(model, {"cube": material})
    x = model.space.tabulate_dof_coordinates()
    u, v = bulk.stiffness.createVecRight(), bulk.stiffness.createVecRight()
    u.array[:], v.array[:] = (x @ gradient.T).ravel(), (x @ virtual.T).ravel()
    return float(v.dot(bulk.force(u)))


RNG = np.random.default_rng(7)
GRADIENT, VIRTUAL = 0.1 * RNG.normal(size=(3, 3)), RNG.normal(size=(3, 3))
FIRST, SECOND = (1.0, 2.0, -0.5), (0.3, 0.1, 1.0)


def _stress(c: Any, strain: str) -> Any:
    """Stress of the first kind of Piola and Kirchhoff at the gradient, (3, 3)."""
    f = np.eye(3) + GRADIENT
    if strain == "small":
        return np.einsum("ijkl,kl->ij", c, 0.5 * (GRADIENT + GRADIENT.T))
    return f @ np.einsum("ijkl,kl->ij", c, 0.5 * (f.T @ f - np.eye(3)))


@pytest.mark.parametrize("strain", ["small", "green-lagrange"])
def test_orthotropic_stress_in_any_position(strain: str) -> None:
    """Requirement: stress of axes anywhere in space. Source: the tensor turned in NumPy, which
    shares nothing with the code. Tolerance: rounding of 1e4 times the softest modulus."""
    material = make_material("orthotropic", **SPRUCE, first=FIRST, second=SECOND, strain=strain)
    assert material.linear == (strain == "small")
    c = tensor(SPRUCE["E"], SPRUCE["nu"], SPRUCE["G"], axes_of(FIRST, SECOND))
    wanted = float((_stress(c, strain) * VIRTUAL).sum())
    assert virtual_work(material, GRADIENT, VIRTUAL) == pytest.approx(wanted, rel=1e-11)


@pytest.mark.parametrize("strain", ["small", "green-lagrange"])
@pytest.mark.parametrize("along", [(1.0, 0.0, 0.0), (0.2, -1.0, 0.4)])
def test_transversely_isotropic_is_the_orthotropic_of_equal_axes(along: Any, strain: str) -> None:
    """Source: the orthotropic tensor of E2 = E3, nu12 = nu13 and G23 = E2 / (2 (1 + nu23)), which
    does not depend on the second axis; tolerance: rounding."""
    material = make_material("transversely-isotropic", **FIBRE, along=along, strain=strain)
    across, ratio = FIBRE["E_across"], FIBRE["nu_across"]
    shears = (FIBRE["G_along"], FIBRE["G_along"], across / (2 * (1 + ratio)))
    moduli = (FIBRE["E_along"], across, across)
    c = tensor(moduli, (0.3, 0.3, ratio), shears, axes_of(along, (0.5, 0.4, -0.9)))
    wanted = float((_stress(c, strain) * VIRTUAL).sum())
    assert virtual_work(material, GRADIENT, VIRTUAL) == pytest.approx(wanted, rel=1e-11)


def test_equal_constants_are_isotropic() -> None:
    """Source: Hooke's law; tolerance: rounding."""
    young, nu = 210.0, 0.3
    shear = young / (2 * (1 + nu))
    same = make_material("orthotropic", E=(young,) * 3, nu=(nu,) * 3, G=(shear,) * 3, first=FIRST)
    wanted = virtual_work(LinearElastic(E=young, nu=nu), GRADIENT, VIRTUAL)
    assert virtual_work(same, GRADIENT, VIRTUAL) == pytest.approx(wanted, rel=1e-12)


def tube_opening(cells: int, material: dict[str, Any], order: int) -> float:
    """Radial displacement of the bore of a tube in plane strain under an inner pressure of 1."""
    ring = RingSpec(1.0, 2.0, 0.1, (cells, 8 * cells, 1), order=order)
    # off the origin: the axis is a line, not a direction alone
    model = build_mesh([Body("tube", ring)])
    model.mesh.geometry.x[:] += [3.0, -1.0, 0.5]
    around = ((3.0, -1.0, 7.0), (0.0, 0.0, -2.0))
    name = "transversely-isotropic" if "E_along" in material else "orthotropic"
    problem = Problem(
        model, {"tube": make_material(name, **material, around=around)}, stabilised=False
    )
    held = {"tube.bottom": {"z": 0.0}, "tube.top": {"z": 0.0}}
    held |= {"tube.outer": {"x": 0.0, "y": 0.0}}
    step = Step("load", 1, held, pressure={"tube.inner": 1.0})
    for _ in Solver(problem, [step]).run():
        pass
    x = model.space.tabulate_dof_coordinates() - [3.0, -1.0, 0.5]
    bore = np.abs(np.hypot(x[:, 0], x[:, 1]) - 1.0) < 1e-9
    radial = (problem.u.x.array.reshape(-1, 3)[bore] * x[bore]).sum(axis=1)
    return float(radial.mean())


def closed_opening(moduli: Any, ratios: Any, shears: Any) -> float:
    """`u = A r^k + B r^-k`, `k^2 = C_tt / C_rr`, held outside [Lekhnitskii 1981, section 62]."""
    c = tensor(moduli, ratios, shears, np.eye(3))
    rr, tt, rt = c[0, 0, 0, 0], c[1, 1, 1, 1], c[0, 0, 1, 1]
    k = np.sqrt(tt / rr)
    at_bore = [rr * k + rt, -rr * k + rt]
    a, b = np.linalg.solve([at_bore, [2.0**k, 2.0**-k]], [-1.0, 0.0])
    return float(a + b)


def test_tube_of_wood() -> None:
    """Axes outwards, around and along: the bore of a tube that is held outside.

    Source: Lekhnitskii's solution. Tolerance: order 1 has to fall with the square of the cells
    (asserted: by 3.5 to 4.5 at half of them).
    """
    wanted = closed_opening(SPRUCE["E"], SPRUCE["nu"], SPRUCE["G"])
    errors = [tube_opening(n, SPRUCE, 1) - wanted for n in (3, 6)]
    assert 3.5 < errors[0] / errors[1] < 4.5
    assert abs(errors[1]) < 0.02 * wanted


def test_wound_tube() -> None:
    """Fibres around a tube: hoops carry the pressure.

    Source: Lekhnitskii's solution with the stiff axis around. Tolerance: order 2 at six cells
    through the wall, measured 2e-4.
    """
    across, ratio = FIBRE["E_across"], FIBRE["nu_across"]
    moduli = (across, FIBRE["E_along"], across)
    # nu_rt = nu_tr E_r / E_t: the strain around for one outwards
    turned = FIBRE["nu_along"] * across / FIBRE["E_along"]
    ratios = (turned, ratio, FIBRE["nu_along"])
    shears = (FIBRE["G_along"], across / (2 * (1 + ratio)), FIBRE["G_along"])
    wanted = closed_opening(moduli, ratios, shears)
    assert tube_opening(6, FIBRE, 2) == pytest.approx(wanted, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "given"), [("orthotropic", SPRUCE), ("transversely-isotropic", FIBRE)]
)
def test_tangent_by_order(name: str, given: dict[str, Any]) -> None:
    """Strain of Green and Lagrange: a quarter of the error of central differences at half the step
    (asserted between 3.7 and 4.3)."""
    model = build_box({"cube": BoxSpec((0, 0, 0), (1, 1, 1), (2, 1, 1))})
    wood = make_material(name, **given, around=((-1, 0, 0), (0, 1, 1)), strain="green-lagrange")
    bulk = NonlinearBulk(model, {"cube": wood})
    x, rng = bulk.stiffness.createVecRight(), np.random.default_rng(2)
    x.array[:] = 0.1 * rng.normal(size=x.getLocalSize())
    assert 3.7 < ratio_of_errors(bulk, x, rng.normal(size=x.getLocalSize())) < 4.3


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"nu": (1.2, 0.4, 6.0)}, "Poisson's ratios"),
        ({"E": (1.0, 1.0)}, "three numbers are needed"),
        ({"G": (1.0, -1.0, 1.0)}, "must be > 0"),
        ({"second": (2.0, 0.0, 0.0)}, "parallel"),
        ({"first": (0.0, 0.0, 0.0)}, "must not be zero"),
        ({"around": ((0, 0, 0), (0, 0, 0))}, "must not be zero"),
        ({"around": ((0, 0, 0), (0, 0, 1)), "second": (0, 1, 1)}, "second: given with around"),
        ({"strain": "large"}, "small, green-lagrange"),
    ],
)
def test_what_cannot_be_is_said(given: dict[str, Any], said: str) -> None:
    with pytest.raises(InputError, match=said):
        make_material("orthotropic", **SPRUCE | given, field="material.wood")


def test_a_ratio_that_no_stable_fibre_has_is_refused() -> None:
    with pytest.raises(InputError, match="scaled compliance"):
        make_material("transversely-isotropic", **FIBRE | {"nu_across": 0.999, "nu_along": 0.9})


@pytest.mark.parametrize("name", ["orthotropic", "hill"])
def test_stress_on_the_axis_of_the_directions(name: str) -> None:
    """Requirement: a node on the axis, where nothing is outwards, has a stress.

    A bar with equal constants is isotropic whatever its axes: the stress `E e` of tension, at every
    node, to Newton's tolerance.
    """
    equal = {
        "orthotropic": {"E": (E_BAR,) * 3, "nu": (0.3,) * 3, "G": (E_BAR / 2.6,) * 3},
        "hill": {"E": E_BAR, "nu": 0.3, "yield_stress": 1e9, "ratios": (1.0,) * 6},
    }
    bar = make_material(name, **equal[name], around=((0, 0, 0), (0, 0, 1)))
    model = build_box({"bar": BoxSpec((-1, -1, 0), (2, 2, 1), (2, 2, 1))})
    held = {"bar.bottom": {"z": 0.0}, "bar.top": {"z": 1e-3}}
    corners = {"a": (-1, -1, 0), "b": (1, -1, 0)}
    for node, place in corners.items():
        model.name_nodes(f"bar.{node}", node_near(model, "bar", place))
    problem = Problem(model, {"bar": bar})
    held |= {"bar.a": {"x": 0.0, "y": 0.0}, "bar.b": {"y": 0.0}}
    for _ in Solver(problem, [Step("pull", 1, held)]).run():
        pass
    exact = 1e-3 * E_BAR * (np.arange(6) == 2)
    assert np.abs(BodyGrid(problem).stress() - exact).max() < 1e-8 * exact.max()
