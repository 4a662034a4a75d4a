"""Quadrature on slave facets and what is assembled from it."""

import numpy as np
import pytest

from anisocontact.base.errors import InputError

CELLS = [("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 1), ("tetrahedron", 2)]


def skewed(points):
    """An affine map: facets stay flat and areas change."""
    matrix = np.array([[1.0, 0.2, 0.1], [-0.1, 0.9, 0.3], [0.2, -0.3, 1.1]])
    return points @ matrix.T


@pytest.fixture(params=CELLS, ids=[f"{c}-{o}" for c, o in CELLS])
def skew_block(fe, request):
    cell, order = request.param
    return fe.block(fe.interface(), cell=cell, order=order, move=skewed)


@pytest.mark.parametrize("group", ["left", "right", "front", "back", "bottom", "top"])
def test_points_lie_on_the_facets_and_integrate_polynomials(skew_block, group):
    """Points, areas and basis on every side of a skewed block.

    Requirement: quadrature of chosen degree on the facets. Source: on a parallelogram the moments
    of the affine coordinates are known. Tolerance: round-off.
    """
    from anisocontact.contact import facet_quadrature

    model = skew_block.model
    rule = facet_quadrature(model.space, model.facets(f"block.{group}"), degree=4)
    size = np.array([1.0, 1.0, 0.5])
    straight = rule.reference @ np.linalg.inv(skewed(np.eye(3)))
    axis, end = divmod(["left", "right", "front", "back", "bottom", "top"].index(group), 2)
    assert np.allclose(straight[:, axis], end * size[axis], atol=1e-14)
    first, second = (a for a in range(3) if a != axis)
    edges = skewed(np.diag(size))
    area = np.linalg.norm(np.cross(edges[first], edges[second]))
    assert rule.areas.sum() == pytest.approx(area, rel=1e-13)
    moment = rule.areas @ (straight[:, first] ** 2 * straight[:, second] ** 2)
    assert moment == pytest.approx(area * size[first] ** 2 * size[second] ** 2 / 9.0, rel=1e-12)
    nodes = model.space.tabulate_dof_coordinates()
    assert np.allclose(rule.at_points(nodes), rule.reference, atol=1e-14)


def test_forces_and_matrices_agree_with_sums_over_points(skew_block):
    """Forces on nodes and matrices of facets against plain loops."""
    rule = skew_block.contact.quadrature
    rng = np.random.default_rng(0)
    m, q, k = rule.basis.shape
    traction, stiffness = rng.random((m * q, 3)), rng.random((m * q, 3, 3))
    nodes = skew_block.model.space.dofmap.index_map.size_local
    forces, expected = np.zeros((nodes, 3)), np.zeros((nodes, 3))
    rule.to_nodes(traction, forces)
    blocks = rule.facet_matrices(stiffness)
    for f in range(m):
        matrix = np.zeros((k, 3, k, 3))
        for p in range(q):
            basis, area = rule.basis[f, p], rule.weights[f, p]
            expected[rule.nodes[f]] += area * np.outer(basis, traction[q * f + p])
            matrix += area * np.einsum("a,ij,b->aibj", basis, stiffness[q * f + p], basis)
        assert np.allclose(blocks[f], matrix.reshape(3 * k, 3 * k), rtol=1e-12)
    assert np.allclose(forces, expected, rtol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_a_process_without_facets_has_no_blocks(fe, order):
    """Requirement: a process that has no facet of a slave has no matrices of it, and goes on.

    Source: by hand. A body at finite strain on a rigid surface ended with an internal error where
    one of two processes had no facet of the contact.
    """
    from anisocontact.contact import facet_quadrature

    model = fe.block(fe.interface(), order=order).model
    rule = facet_quadrature(model.space, np.zeros(0, dtype=np.int32), 2)
    nodes = rule.basis.shape[2]
    assert rule.at_rest.area_matrices(np.zeros((0, 3))).shape == (0, 3 * nodes, 3 * nodes)
    assert rule.facet_matrices(np.zeros((0, 3, 3))).shape == (0, 3 * nodes, 3 * nodes)


def test_resultant_and_counts(fe):
    """Force and moment of a uniform overlap, closed form: eps d A, moment about the origin."""
    from anisocontact.solver import Step

    overlap, penalty = 1e-3, 1e4
    interface = fe.interface(penalty=penalty, point=(0.0, 0.0, overlap))
    block = fe.block(interface, young=1e12)
    block.run(Step("hold", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": 0.0}}))
    force, moment = block.contact.resultant()
    # The block is stiff, not rigid: 1e-8 is its compliance against that of the penalty.
    assert np.allclose(force, [0.0, 0.0, 10.0], rtol=1e-7, atol=1e-9)
    assert np.allclose(moment, [5.0, -5.0, 0.0], rtol=1e-7, atol=1e-9)
    energies = block.contact.energies()
    assert energies["normal"] == pytest.approx(0.5 * penalty * overlap**2, rel=1e-7)


def test_auto_penalty_scales_with_units(fe):
    """Requirement: the default penalty is E over facet size, the same stiffness in any units."""
    from anisocontact.contact import PENALTY_FACTOR, auto_penalty

    base = fe.block(fe.interface(), cells=(4, 4, 2))
    penalty = auto_penalty(base.model, "block.bottom", base.material)
    assert penalty == pytest.approx(PENALTY_FACTOR * 1000.0 / 0.25)
    # penalties of 1 m and Pa would be beyond rounding for 1000 m and a millionth of it
    soft = fe.interface(penalty=1e-5, stiffness=(4e-6, 1e-6))
    other = fe.block(soft, cells=(4, 4, 2), size=(1e3, 1e3, 5e2), young=1e-3)
    scaled = auto_penalty(other.model, "block.bottom", other.material)
    assert scaled == pytest.approx(penalty * 1e-6 / 1e3)


def test_misspelt_slave_suggests_the_near_one(fe):
    """Requirement: facet group absent from the mesh, one line with the near name."""
    from anisocontact.contact import Contact

    block = fe.block(fe.interface())
    with pytest.raises(InputError, match=r"no facet group 'block.botom'.*'block.bottom'"):
        Contact(block.model, "block.botom", fe.interface(), mortar=False)


def test_slave_without_facets(fe):
    """Requirement: a slave without facets is refused in one line."""
    from anisocontact.contact import Contact
    from anisocontact.mesh import Model

    mesh = fe.block(fe.interface()).model.mesh
    nothing = np.zeros(0, dtype=np.int32)
    model = Model(mesh, {"block": nothing}, {"block.bottom": nothing})
    with pytest.raises(InputError, match=r"facet group 'block.bottom' has no facets"):
        Contact(model, "block.bottom", fe.interface(), mortar=False)


def test_degree_below_one(fe):
    """Requirement: the degree of the quadrature is at least 1."""
    from anisocontact.contact import Contact

    block = fe.block(fe.interface())
    with pytest.raises(InputError, match="degree: 0 given, must be >= 1"):
        Contact(block.model, "block.bottom", fe.interface(), degree=0)


def test_problem_needs_materials_and_distinct_names(fe):
    """Requirement: a body without material, an unknown body, two contacts of one name."""
    from anisocontact.solver import Problem

    block = fe.block(fe.interface())
    with pytest.raises(InputError, match="body 'block' has no material"):
        Problem(block.model, {})
    with pytest.raises(InputError, match=r"no body 'blok' in the mesh; did you mean 'block'"):
        Problem(block.model, {"block": block.material, "blok": block.material})
    with pytest.raises(InputError, match=r"two contacts have the name 'block.bottom'"):
        Problem(block.model, {"block": block.material}, [block.contact, block.contact])
