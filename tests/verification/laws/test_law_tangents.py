"""Consistent tangents through the interface by order of convergence, in every branch.

Requirement: every tangent is exact, in stick and in slip, for every rule, with respect to the force
and to the pressure, through the Python interface. Source: calculus (checked by order: halving the
step quarters the error of a central difference, which no wrong derivative can do). The observed
order has to lie within 0.1 of 2; at the steps used the next term of the error is some percent.
"""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.contact.frames import Frames
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw, slide
from anisocontact.surfaces import make_surface

ORDER = (1.9, 2.1)


def orders(function, tangent, steps):
    """Observed order between each two steps of the error of central differences, root mean
    square."""
    errors = []
    for h in steps:
        difference = (function(h) - function(-h)) / (2.0 * h)
        errors.append(np.sqrt(np.mean((difference - tangent) ** 2)))
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def interface(surface, rule, stiffness=(4e2, 1e2)):
    along = make_directions("constant", vector=(1.0, 0.2, 0.1), angle=0.3)
    across = make_directions("constant", vector=(1.0, 0.2, 0.1), angle=-0.2)
    return Interface(
        surface,
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=stiffness, directions=along),
        Friction(
            coefficients=(0.4, 0.2), directions=across, sliding_rule=rule.name, **rule.parameters
        ),
    )


SURFACES = {
    "plane": {"point": (0, 0, 0), "normal": (0.1, -0.2, 1.0)},
    "cylinder": {"point": (0, 0, -2), "axis": (0, 1, 0), "radius": 2.0},
    "sphere": {"centre": (0, 0, -1.5), "radius": 1.5},
}


def foot(surface, x):
    """Closest point and normal there."""
    xi = surface.project(x).xi
    return surface.position(xi), surface.geometry(xi).normal


def committed(itf, n=40):
    """Points pressed and dragged into slip, and their state."""
    r = np.random.default_rng(7)
    x = np.column_stack([r.uniform(-0.3, 0.3, (n, 2)), 0.1 * np.ones(n)])
    position, normal = foot(itf.surface, x)
    x = position - 2e-3 * normal
    state = itf.initial_state(x)
    for step in (8e-3, 4e-3):
        drag = r.normal(size=(n, 3))
        position, normal = foot(
            itf.surface, x + step * drag / np.linalg.norm(drag, axis=1)[:, None]
        )
        x = position - 2e-3 * normal
        state = itf.update(state, x).state
    return state, x


def to_branch(branch, itf, state, x):
    """Points that stick, with less force in their state, or that have slid on."""
    if branch == "stick":
        state["stored"] *= 0.3
        state["elastic"] *= 0.3
        return x
    t = np.cross(foot(itf.surface, x)[1], [0.3, 1.0, 0.2])
    return x + 6e-3 * t / np.linalg.norm(t, axis=1)[:, None]


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("branch", ["stick", "slip"])
def test_interface(rule, name, branch):
    """The whole response dt/dx on plane and curved surfaces, from a state with history, along three
    directions that are none of the axes. In stick on a plane t is linear in x: the difference is
    then exact but for rounding, 1e-9 of the stiffness."""
    itf = interface(make_surface(name, **SURFACES[name]), rule)
    state, x = committed(itf)
    x = to_branch(branch, itf, state, x)
    r = itf.update(state, x)
    assert (r.status == (1 if branch == "stick" else 2)).all()
    for shift in np.linalg.qr([[1.0, 2.0, 3.0], [-2.0, 1.0, 1.0], [0.5, 1.0, -2.0]])[0]:
        exact = np.einsum("nij,j->ni", r.tangent, shift)
        h0 = 2e-4 if branch == "slip" else 1e-4

        def traction(h, shift=shift):
            moved = itf.update(state, x + h * shift)
            assert (moved.status == r.status).all()
            return moved.traction

        if branch == "stick" and name == "plane":
            difference = (traction(h0) - traction(-h0)) / (2.0 * h0)
            assert np.abs(difference - exact).max() < 1e-9 * 1e3
        else:
            found = orders(traction, exact, (h0, h0 / 2))
            assert ((found > ORDER[0]) & (found < ORDER[1])).all(), found


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.parametrize("branch", ["stick", "slip"])
def test_slip_of_a_point_that_stays(rule, name, branch):
    """The response to slip and gap at one place, where axes, normal and foot are what they are.

    Source: T follows slip through the trial force alone, which is the stored one less the stiffness
    times the slip, and N the gap less its offset: stored force and offset are changed instead. In
    stick that is linear, 1e-9 of the stiffness. The tangent by positions is another one wherever
    axes turn along the surface or the surface is curved.
    """
    stiffness = 4e2
    itf = interface(make_surface(name, **SURFACES[name]), rule, (stiffness, stiffness))
    state, x = committed(itf)
    x = to_branch(branch, itf, state, x)
    r = itf.update(state, x)
    assert (r.status == (1 if branch == "stick" else 2)).all()
    before, now = (Frames.of(itf.surface.jet(xi).d1) for xi in (state["xi"], r.state["xi"]))
    for shift in np.linalg.qr([[1.0, 2.0, 3.0], [-2.0, 1.0, 1.0], [0.5, 1.0, -2.0]])[0]:
        exact = np.einsum("nij,j->ni", r.tangent_slip, shift)
        gap = now.normal @ shift
        slip = now.turned_to(before, shift - gap[:, None] * now.normal)

        def traction(h, gap=gap, slip=slip):
            slid = state.copy()
            slid["stored"] -= h * stiffness * np.einsum("nid,nd->ni", before.tangents, slip)
            slid["offset"] -= h * gap
            answer = itf.update(slid, x)
            assert (answer.status == r.status).all()
            return answer.traction

        if branch == "stick":
            difference = (traction(1e-4) - traction(-1e-4)) / 2e-4
            assert np.abs(difference - exact).max() < 1e-9 * 1e3
        else:
            found = orders(traction, exact, (1e-4, 5e-5))
            assert ((found > ORDER[0]) & (found < ORDER[1])).all(), found


def test_closed_form_is_what_dual_numbers_give(rule):
    """On the plane dt/dx of the interface, from dual numbers, is the chain rule through the closed
    form of the rule: dT = -d_trial S dx_t - eps_N d_pressure dx_n. 1e-12 of the stiffness: the
    roundings of two formulas."""
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1), tangent=(1, 0, 0))
    itf = interface(plane, rule)
    state, x = committed(itf)
    x = x + np.array([6e-3, 2e-3, 0.0])
    r = itf.update(state, x)
    assert (r.status == 2).all()
    e, a = r.directions_friction[:, :, :2], r.directions_adhesion[:, :, :2]
    spatial = np.einsum("k,nki,nkj->nij", [4e2, 1e2], a, a)
    increment = np.einsum("nki,ni->nk", e, x[:, :2] - state["xi"])
    s = np.einsum("nki,nij,nlj->nkl", e, spatial, e)
    trial = np.einsum("nki,ni->nk", e, state["stored"]) - np.einsum("nkl,nl->nk", s, increment)
    f = np.broadcast_to(np.diag([1 / 0.16, 1 / 0.04]), s.shape)
    law = slide(s, f, trial, r.pressure, rule.name, increment=increment, **rule.parameters)
    np.testing.assert_allclose(law.traction, r.traction_principal, rtol=0, atol=1e-13)
    tangential = -np.einsum("nki,nkl,nlm,nmj->nij", e, law.d_trial, s, e)
    np.testing.assert_allclose(r.tangent[:, :2, :2], tangential, rtol=0, atol=1e-12 * 4e2)
    by_depth = -1e3 * np.einsum("nki,nk->ni", e, law.d_pressure)
    np.testing.assert_allclose(r.tangent[:, :2, 2], by_depth, rtol=0, atol=1e-12 * 1e3)
