"""The law does not know which basis, axis order or units it is written in.

Requirement and source: the theory is covariant [Konyukhov Schweizerhof 2006, section 2]; a result
that changed with the frame, with the names of the axes or with the units would be wrong whatever
its value. 1e-12 relative: some 1e3 roundings at tensors of condition 10 in a basis of condition
below 10.
"""

from __future__ import annotations

import numpy as np

from anisocontact.anisotropy import make_directions
from anisocontact.base.registry import sliding_rules
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

POINTS = 500
CLOSE = {"rtol": 0.0, "atol": 1e-12}


def random_path(itf, rotate=None):
    """The last response on a path of four steps over a plane through the origin."""
    rotate = np.eye(3) if rotate is None else rotate
    r = np.random.default_rng(5)
    start = r.uniform(-1.0, 1.0, (50, 3)) * [1.0, 1.0, 0.0] - [0.0, 0.0, 2e-3]
    steps = r.normal(scale=3e-3, size=(4, 50, 3)) * [1.0, 1.0, 0.1]
    state = itf.initial_state(start @ rotate.T)
    for x in start + np.cumsum(steps, axis=0):
        response = itf.update(state, x @ rotate.T)
        state = response.state
    assert (response.status == 2).any() and not response.failed.any()
    return response


def interface(rule, rotate=None, *, swapped=False):
    """Axes of adhesion and friction apart; `swapped`: the same with the axes in the other order."""
    rotate = np.eye(3) if rotate is None else rotate
    order = -1 if swapped else 1
    parameters = dict(rule.parameters)
    if "slip_axes" in parameters:
        parameters["slip_axes"] = parameters["slip_axes"][::order]

    def field(angle):
        quarter = np.pi / 2 if swapped else 0.0
        return make_directions("constant", vector=rotate @ [1, 0, 0], angle=angle + quarter)

    return Interface(
        make_surface("plane", point=(0, 0, 0), normal=rotate @ [0, 0, 1]),
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(4e2, 1e2)[::order], directions=field(0.3)),
        Friction(
            coefficients=(0.4, 0.2)[::order],
            directions=field(-0.2),
            sliding_rule=rule.name,
            **parameters,
        ),
    )


def test_interface_in_a_turned_space(rule):
    """A rotation of surface, directions and path rotates tractions and tangent, history
    included."""
    r = np.random.default_rng(6)
    q = np.linalg.qr(r.normal(size=(3, 3)))[0]
    q *= np.sign(np.linalg.det(q))
    plain, turned = random_path(interface(rule)), random_path(interface(rule, q), q)
    np.testing.assert_array_equal(plain.status, turned.status)
    np.testing.assert_allclose(turned.traction @ q, plain.traction, **CLOSE)
    np.testing.assert_allclose(q.T @ turned.tangent @ q, plain.tangent, rtol=0, atol=1e-12 * 1e3)
    np.testing.assert_allclose(
        turned.state["dissipation"], plain.state["dissipation"], rtol=0, atol=1e-14
    )


def test_axes_in_the_other_order(rule):
    """(first, second) along (e_1, e_2) is (second, first) along (e_2, -e_1)."""
    plain, swapped = random_path(interface(rule)), random_path(interface(rule, swapped=True))
    np.testing.assert_array_equal(plain.status, swapped.status)
    np.testing.assert_allclose(swapped.traction, plain.traction, **CLOSE)
    np.testing.assert_allclose(swapped.tangent, plain.tangent, rtol=0, atol=1e-12 * 1e3)


def test_slip_angle_counts_towards_the_second_axis():
    """Two vectors and their mirror image answer as mirror images, with the same angle of slip.

    Requirement: the parameter says from which axis towards which its angle counts, so that it needs
    no sense of rotation about the normal. Source: a mirror changes no number of the theory that is
    measured between vectors.
    """
    (angle,) = [p for e in sliding_rules() if e.name == "slip-ellipse" for p in e.parameters][1:]
    assert "from the first friction axis, towards the second," in angle.doc
    mirror = np.diag([1.0, -1.0, 1.0])

    def sheared(by):
        """Axes that are 60 degrees apart."""
        pair = [by @ v for v in ([1.0, 0.0, 0.0], [0.5, np.sqrt(0.75), 0.0])]
        axes = make_directions("from-vectors", first=pair[0], second=pair[1])
        return Interface(
            make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)),
            NormalLaw(penalty=1e3),
            Adhesion(stiffness=(4e2, 1e2), directions=axes),
            Friction(
                coefficients=(0.4, 0.2),
                directions=axes,
                sliding_rule="slip-ellipse",
                slip_axes=(2.0, 1.5),
                slip_angle=0.4,
            ),
        )

    plain, mirrored = random_path(sheared(np.eye(3))), random_path(sheared(mirror), mirror)
    np.testing.assert_array_equal(plain.status, mirrored.status)
    np.testing.assert_allclose(mirrored.traction @ mirror, plain.traction, **CLOSE)
