"""Mortar contact where the master ends within slave facets, or at nodes of the slave.

A node of which only a strip at the far end of its facets is covered would be held from where
nothing is: the dual functions of the strip extrapolate. Its weights go to the other nodes of the
facet, docs/theory/mortar.md.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from anisocontact.bulk import make_material
from anisocontact.contact import Augmentation, Contact
from anisocontact.contact.line_weights import LineWeights
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, BoxSpec, PlaneStrain, build_box, build_mesh
from anisocontact.mesh.shapes.plane import RectangleSpec
from anisocontact.solver import Problem, Solver, Step

E = 1000.0
STEEL = make_material("linear-elastic", E=E, nu=0.3)
LAW = ContactLaw(NormalLaw(penalty=10.0 * E), Adhesion(stiffness=E), Friction(coefficients=0.3))


def _pressed(model: Any, *sides: str) -> tuple[Contact, int, int]:
    """The block pressed on the base in one increment: the contact, iterations and cuts."""
    contact = Contact(model, *sides, LAW, mortar=True, augmentation=Augmentation())
    held = {"base.bottom": dict.fromkeys("xyz"[: model.mesh.topology.dim], 0.0)}
    up = "z" if model.mesh.topology.dim == 3 else "y"
    held["block.top"] = dict.fromkeys("xyz"[: model.mesh.topology.dim], 0.0) | {up: -0.002}
    cuts: list[Any] = []
    problem = Problem(model, {"block": STEEL, "base": STEEL}, [contact])
    run = Solver(problem, [Step("press", 1, held)]).run(on_cut=cuts.append)
    return contact, sum(one.iterations for one in run), len(cuts)


@pytest.mark.parametrize(("n", "bound"), [(4, 0.01), (6, 0.005), (8, 0.005)])
def test_nodes_on_the_border_of_the_master(n: int, bound: float) -> None:
    """A block on a larger base, the base as the slave, its nodes nowhere just beyond the edges.

    They are a half or a quarter of a facet beyond, or below the edges.

    Source: the same pair with the sides swapped, where no facet of the slave is covered in part.
    Requirement: no cut, ten iterations, the same force within 0.5 %, 1 % where four facets
    are an edge. As the surfaces spread, strips of 1e-3 of a facet come to be covered.
    """
    block = BoxSpec((0, 0, 0), (1, 1, 0.5), (n, n, 2))
    base = BoxSpec((-0.5, -0.5, -0.5), (2, 2, 0.5), (3 * n // 2, 3 * n // 2, 2))
    forces = []
    for sides in (("base.top", "block.bottom"), ("block.bottom", "base.top")):
        model = build_box({"block": block, "base": base})
        contact, iterations, cuts = _pressed(model, *sides)
        assert cuts == 0
        assert iterations <= 10
        forces.append(abs(contact.resultant()[0][2]))
    assert forces[0] == pytest.approx(forces[1], rel=bound)


def _punched(offset: float, n: int) -> float:
    """Force of a punch of unit width and n + 1 facets, moved aside, on n facets a unit."""
    base = RectangleSpec((-1.0, -1.0), (3.0, 1.0), (3 * n, n))
    block = RectangleSpec((offset, 0.0), (1.0, 0.5), (n + 1, n // 2))
    model = build_mesh([Body("block", block), Body("base", base)], idealisation=PlaneStrain())
    contact, _, cuts = _pressed(model, "base.top", "block.bottom")
    assert cuts == 0
    return abs(float(contact.resultant()[0][1]))


@pytest.mark.parametrize(("n", "bound"), [(4, 0.05), (16, 0.01)])
def test_force_of_a_punch_wherever_its_edges_are(n: int, bound: float) -> None:
    """Edges of a punch anywhere between two nodes of the slave.

    Source: the force at 32 facets. Requirement: within 5 % of it at 4 facets across the punch and
    1 % at 16, about what the mesh below it misses. As the covered strip goes to nothing, the force
    goes to that of no strip: 1e-5 at a strip of 1e-3 of a facet.
    """
    exact = _punched(0.0, 32)
    forces = [_punched(share / n, n) for share in (0.0, 1e-3, 0.1, 0.3, 0.4, 0.5, 0.8)]
    np.testing.assert_allclose(forces, exact, rtol=bound)
    assert forces[1] == pytest.approx(forces[0], rel=1e-5)


def _strip(up_to: float) -> LineWeights:
    """Weights of an edge of order 2 of length one, its first part covered by a straight master."""
    x, weight = np.polynomial.legendre.leggauss(4)
    t = 0.5 * (x + 1.0)
    place = up_to * t
    shape = np.array(
        [(1 - place) * (1 - 2 * place), place * (2 * place - 1), 4 * place * (1 - place)]
    )
    d_shape = np.array([4 * place - 3, 4 * place - 1, 4 - 8 * place]) * t
    area = 0.5 * up_to * shape @ weight
    d_area = 0.5 * (shape + up_to * d_shape) @ weight
    # dual functions are exact on a straight master: its mean is the node, here its two ends
    at = np.array([[1.0, 0.0], [0.0, 1.0], [0.5, 0.5]])
    slopes = d_area[None, :, None], (at * d_area[:, None])[None, ..., None]
    weights = area[None], (at * area[:, None])[None]
    return LineWeights(np.array([[0, 1]], dtype=np.int32), *weights, *slopes)


def test_weights_of_an_edge_that_is_handed_over() -> None:
    """A strip that grows along an edge of order 2: forces, what is met, and derivatives.

    Requirement: the whole weight stays; what a node that keeps some meets is the node, but for an
    eighth of the edge (0.123 at most); derivatives are those of central differences, wherever nodes
    hand over all, a part or nothing.
    """
    whole, h, in_part = np.array([1.0, 1.0, 4.0]) / 6.0, 1e-6, 0
    for up_to in np.linspace(0.05, 0.99, 95):
        before, now = _strip(up_to), _strip(up_to).handed_over(whole)
        assert now.area.sum() == pytest.approx(before.area.sum(), rel=1e-13)
        has = now.area[0] > 0.0
        in_part += int(has.all() and not np.allclose(now.area, before.area, rtol=1e-3))
        mean = now.weight[0, has] @ [0.0, 1.0] / now.area[0, has]
        assert np.abs(mean - np.array([0.0, 1.0, 0.5])[has]).max() < 0.125
        more, less = (_strip(up_to + way).handed_over(whole) for way in (h, -h))
        for name in ("area", "weight"):
            slope = (getattr(more, name) - getattr(less, name)) / (2.0 * h)
            np.testing.assert_allclose(getattr(now, f"d_{name}")[..., 0], slope, atol=1e-6)
    assert in_part > 0
