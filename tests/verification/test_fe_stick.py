"""Stick: adhesion and block in series, against a closed form and an independent solution."""

import numpy as np
import pytest

ANGLE = np.radians(30.0)
STIFFNESS = (4e3, 1e3)
PENALTY = 500.0
OVERLAP = 0.005
SHIFT = np.array([2e-3, -1e-3])
CELLS = [("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 1), ("tetrahedron", 2)]


def sticking(fe, cell, order):
    """Block whose sole lies below the plane: in contact everywhere, friction never reached."""
    interface = fe.interface(
        stiffness=STIFFNESS,
        coefficients=(50.0, 40.0),
        penalty=PENALTY,
        angle=ANGLE,
        point=(0.0, 0.0, OVERLAP),
        evolution="backward-euler",  # slip that turns with the slave is not linear
    )
    return fe.block(interface, cell=cell, order=order)


@pytest.mark.parametrize(("cell", "order"), CELLS)
def test_series_stiffness(fe, cell, order):
    """Top shifted while no side can rise: adhesion and the block's shear stiffness in series.

    Requirement: resultant within 0.5 % of T = -A (S^-1 + H/G)^-1 u, u the shift, H the height.
    Source: with w = 0 on the sides, simple shear solves the problem exactly (the sides carry the
    complementary shear stress as support), and the traction on the sole is uniform; pressing
    superposes without a tangential resultant as the problem is linear and symmetric about z.
    Tolerance: exact for every element that holds a linear field; 1e-8 is the tolerance of Newton.
    """
    from anisocontact.solver import Step

    block = sticking(fe, cell, order)
    height = 0.5
    no_rise = {f"block.{side}": {"z": 0.0} for side in ("left", "right", "front", "back")}
    x, y = SHIFT
    block.run(
        Step("press", 1, no_rise | {"block.top": {"x": 0.0, "y": 0.0, "z": 0.0}}),
        Step("shift", 2, {"block.top": {"x": x, "y": y}}),
        snes_rtol=1e-11,
    )
    force, _ = block.contact.resultant()

    adhesion = np.linalg.inv(fe.tensor(STIFFNESS, ANGLE))
    expected = -np.linalg.solve(adhesion + height / block.material.shear * np.eye(2), SHIFT)
    assert block.contact.counts() == {"open": 0, "stick": block.contact.areas.size, "slip": 0}
    assert np.linalg.norm(force[:2] - expected) < 1e-8 * np.linalg.norm(expected)


@pytest.mark.parametrize(("cell", "order"), CELLS)
def test_free_sides_against_an_elastic_support_in_ufl(fe, cell, order):
    """Block with free sides: the same displacements as an elastic support (Robin condition).

    Requirement: resultant in stick within 0.5 %. Source: in stick with the gap closed the interface
    is the linear support t = (eps_N n n + S)(u0 - u); it is solved here by UFL and DOLFINx alone,
    with the same quadrature. Tolerance: both solve the same linear system, up to the tolerance of
    Newton (1e-11) and round-off of the factorisation.
    """
    from anisocontact.base.fenicsx import fem, ufl
    from anisocontact.solver import Step

    from dolfinx.fem.petsc import LinearProblem

    block = sticking(fe, cell, order)
    shift = np.array([*SHIFT, -2e-3])
    block.run(Step("all", 2, {"block.top": dict(zip("xyz", shift, strict=True))}), snes_rtol=1e-11)
    assert block.contact.counts()["stick"] == block.contact.areas.size

    space, mesh = block.model.space, block.model.mesh
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    sole = fem.compute_integration_domains(
        fem.IntegralType.exterior_facet, mesh.topology, block.model.facets("block.bottom")
    )
    ds = ufl.Measure(
        "ds", domain=mesh, subdomain_data=[(1, sole)], metadata={"quadrature_degree": 2 * order}
    )(1)
    support = np.zeros((3, 3))
    support[:2, :2] = fe.tensor(STIFFNESS, ANGLE)
    support[2, 2] = PENALTY
    k = ufl.as_matrix(support.tolist())
    raised = ufl.as_vector([0.0, 0.0, OVERLAP])
    strain = ufl.sym(ufl.grad(v))
    a = ufl.inner(block.material.stress(u), strain) * ufl.dx + ufl.dot(k * u, v) * ds
    top = fem.locate_dofs_topological(space, 2, block.model.facets("block.top"))
    clamped = fem.dirichletbc(shift, top, space)
    problem = LinearProblem(
        a,
        ufl.dot(k * raised, v) * ds,
        bcs=[clamped],
        petsc_options_prefix="test_",
        petsc_options={"ksp_type": "preonly", "pc_type": "lu"},
    )
    expected = problem.solve().x.array
    assert np.abs(block.problem.u.x.array - expected).max() < 1e-9 * np.abs(expected).max()
