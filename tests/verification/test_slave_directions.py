"""Directions that the slave carries: a texture turns with the body it is on.

Requirement: the coefficients of friction and adhesion follow the texture of the body that has it.
Source: closed form on a plane; a slave that has turned by 90 degrees about the normal has its axes
exchanged, by any angle a its axes at a. Tolerances are rounding.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI
from anisocontact.contact.facet_mesh import FacetMesh, facet_rule, isoparametric
from anisocontact.contact.integration_points import IntegrationPoints
from anisocontact.interface import STATE, ContactLaw, Interface, SlaveSurface, as_state, raw_state
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

MU = (0.4, 0.1)
PRESSURE = 3.0


def laws(on: str) -> tuple[NormalLaw, Adhesion, Friction]:
    """Brush marks along x on the slave or on the master."""
    marks = make_directions("constant", vector=(1, 0, 0))
    return (
        NormalLaw(penalty=100.0),
        Adhesion(stiffness=(500.0, 500.0)),
        Friction(coefficients=MU, directions=marks, directions_on=on),
    )


def turned(angle: float) -> np.ndarray:
    """Rotation about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def surface(angle: float) -> SlaveSurface:
    """A flat slave that has turned."""
    t = np.array([[[0.3, 0.0, 0.0], [0.1, 0.2, 0.0]]])
    return SlaveSurface(np.zeros((1, 3)), t, t @ turned(angle).T)


def friction_at(angle: float, along: np.ndarray) -> np.ndarray:
    """Force of steady slip on an ellipse with axes at the angle, slip normal to it."""
    r = turned(angle)[:2, :2]
    squares = r @ np.diag(np.square(MU)) @ r.T  # F^-1
    return -PRESSURE * squares @ along / np.sqrt(along @ squares @ along)


@pytest.mark.parametrize("on", ["slave", "master"])
@pytest.mark.parametrize("angle", [0.0, np.pi / 2, 0.4])
def test_on_a_plane(on: str, angle: float) -> None:
    """Steady slip along x on a plane: the force of the ellipse that has turned with the slave."""
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    itf = Interface(plane, *laws(on))
    x = np.array([[0.0, 0.0, -PRESSURE / 100.0]])
    state = itf.initial_state(x)
    slave = surface(angle)
    for _ in range(60):
        x = x + np.array([1e-2, 0.0, 0.0])
        r = itf.update(state, x, slave=slave)
        state = r.state
    exact = friction_at(angle if on == "slave" else 0.0, np.array([1.0, 0.0]))
    assert r.status[0] == 2
    assert np.abs(r.traction[0, :2] - exact).max() < 1e-10 * PRESSURE


@pytest.mark.parametrize("angle", [np.pi / 2, 0.4])
@pytest.mark.parametrize("on", ["slave", "master"])
def test_between_facets(on: str, angle: float) -> None:
    """The same between two meshed squares."""
    square = np.array([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], dtype=np.float64) - 0.5
    reference = np.concatenate([0.4 * square, 4.0 * square])
    reference[:, 2] = 0.0
    nodes = np.array([[0, 1, 2, 3]], dtype=np.int32)
    facets, rule = FacetMesh("quad4", nodes, np.array([True])), facet_rule("quad4", 1)
    quadrature = isoparametric(facets, rule, reference)
    points = IntegrationPoints(quadrature, facets.flip, current_area=True, comm=MPI.COMM_SELF)
    core = ContactLaw(*laws(on)).on_facets().core
    n = len(points.nodes)
    state = np.zeros(n, dtype=STATE)
    state["facet"] = -1
    for k in range(60):
        now = reference.copy()
        now[:4] = now[:4] @ turned(angle).T + np.array([1e-2 * k, 0.0, -PRESSURE / 100.0])
        x = points.positions(now)
        xi = x[:, :2] / 4.0 + 0.5
        r = core.assemble(
            raw_state(state),
            1.0,
            points.nodes,
            points.shape,
            points.gradient,
            points.weight,
            True,
            now,
            reference,
            nodes + 4,
            np.full(1, 2, dtype=np.int8),
            np.zeros(1, dtype=np.bool_),
            np.zeros(n, dtype=np.int32),
            np.ascontiguousarray(xi),
            np.zeros(n, dtype=np.int8),
            np.zeros((n, 2)),
            np.zeros((0, 3, 3)),
            np.ones(n, dtype=np.bool_),
            False,
            1,
        )
        state = as_state(r["state"])
    exact = friction_at(angle if on == "slave" else 0.0, np.array([1.0, 0.0]))
    assert np.abs(r["traction"][:, :2] - exact).max() < 1e-10 * PRESSURE


def test_points_alone_carry_no_directions() -> None:
    """Slave points without a surface: one line that says which key."""
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    itf = Interface(plane, *laws("slave"))
    state = itf.initial_state([[0.0, 0.0, 0.0]])
    with pytest.raises(InputError, match="points alone") as error:
        itf.update(state, [[0.0, 0.0, -0.1]])
    assert error.value.field == "friction.directions_on"


def test_other_evolutions_take_the_master_only() -> None:
    """Forms in coordinates of the surface know no slave."""
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    with pytest.raises(InputError, match="covariant"):
        Interface(plane, *laws("slave"), evolution="covariant")


@pytest.mark.parametrize("given", ["both", "", "Slave"])
def test_unknown_side(given: str) -> None:
    """What is allowed is said."""
    with pytest.raises(InputError, match="allowed: master, slave"):
        laws(given)


def test_fields_by_coordinates_need_a_surface() -> None:
    """A mesh carries no field that goes by the coordinates of a surface."""
    lines = make_directions("coordinate-lines")
    normal, adhesion, _ = laws("master")
    for on in ("master", "slave"):
        friction = Friction(coefficients=MU, directions=lines, directions_on=on)
        with pytest.raises(InputError, match=f"coordinates of a surface, and the {on}") as error:
            ContactLaw(normal, adhesion, friction).check_meshed()
        assert error.value.field == "friction.directions"
