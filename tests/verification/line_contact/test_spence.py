"""Friction while a contact grows: stick and shear under a cylinder pressed on another material.

Two bodies of one shear modulus and unequal Poisson's ratio want to spread by different amounts as
they are pressed. Contact grows in proportion, so that the middle, |x| < c, has always stuck and the
rest has always slipped outwards, with the same c / a as under a flat punch [Spence 1973, 1975;
Johnson, Contact Mechanics, sections 5.1 and 5.4]. With Dundurs' constant beta

    K(sqrt(1 - k^2)) / K(k) = beta / mu ,    k = c / a .

Under the punch p = P / (pi sqrt(a^2 - x^2)), and stick in |x| < c is a singular integral equation
for what the shear is less than mu p, of which this is the solution that is bounded, with a = 1,
P = 1 and b(x) = sqrt(1 - x^2):

    q = mu / (pi b) + 2 x sqrt(k^2 - x^2) / pi^2
        int_0^k (g(t) - g(x)) / ((t^2 - x^2) sqrt(k^2 - t^2)) dt ,
    g(x) = -beta / b + mu / (pi b) ln((1 + b) / (1 - b)) .

A cylinder presses as punches of half-widths from 0 to a do, one after the other, each with a
force proportional to its half-width.

Requirement: as for other friction at the nodes, 12 % of mu p0 at 4 facets per half-width and 6 % at
6 within 0.8 a; status right within 0.95 a but for half a facet at the edge of stick. Tolerance: as
demanded. What the shear does to the pressure is left out of the closed form, a share of the order
of beta mu, here 0.3 %.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import ellipk
from tests.verification.line_contact.shear import Shear

from anisocontact.bulk import make_material
from anisocontact.contact import Augmentation, Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.solver import Step

RADIUS, G = 400.0, 400.0
RATIOS = {"upper": 0.25, "lower": 0.33}
BETA = 0.5 * (0.33 - 0.25) / (1.0 - 0.5 * (0.25 + 0.33))
REDUCED = 2.0 * G / sum(1.0 - nu for nu in RATIOS.values())


def stick(mu: float) -> float:
    """Half-width of stick over that of contact."""
    return float(
        brentq(lambda k: ellipk(1.0 - k * k) - BETA / mu * ellipk(k * k), 1e-9, 1.0 - 1e-12)
    )


def _under_a_punch(x: float, k: float, mu: float) -> float:
    """Shear under a punch of unit half-width and force, x in (0, 1)."""

    def mismatch(t: float) -> float:
        b = np.sqrt(1.0 - t * t)
        return float(-BETA / b + mu / (np.pi * b) * np.log((1.0 + b) / (1.0 - b)))

    slipping = float(mu / (np.pi * np.sqrt(1.0 - x * x)))
    if x >= k:
        return slipping

    def integrand(angle: float) -> float:
        t = k * np.sin(angle)
        return (mismatch(t) - mismatch(x)) / (t * t - x * x)

    inner = quad(integrand, 0.0, 0.5 * np.pi, points=[np.arcsin(x / k)], limit=200)[0]
    return slipping + 2.0 * x * float(np.sqrt(k * k - x * x)) / np.pi**2 * inner


def shear(x: float, k: float, mu: float) -> float:
    """Shear over mu p0 under a cylinder at x, over a, in (0, 1)."""
    if x >= k:
        return float(np.sqrt(1.0 - x * x))
    # punches of half-widths h = x / s: those that slip at x, then those that stick there
    slip = np.sqrt((x / k) ** 2 - x * x)
    inner = quad(lambda s: _under_a_punch(s, k, mu) * x / s**2, x, k, epsabs=1e-6)[0]
    return float(slip + np.pi / mu * inner)


def pressed(line: Any, n: int, mu: float, increments: int) -> Shear:
    """A cylinder of n facets a unit on a base of one more; equal growth in each increment."""
    facets = {"upper": n, "lower": n + 1}
    model = line.half_planes(facets, height=lambda x: 0.5 * x**2 / RADIUS)
    law = ContactLaw(NormalLaw(penalty=10.0 * G), Adhesion(stiffness=G), Friction(coefficients=mu))
    contact = Contact(
        model, "upper.bottom", "lower.top", law, mortar=True, augmentation=Augmentation()
    )
    held = {f"{body}.left": {"x": 0.0} for body in facets} | {"lower.bottom": {"y": 0.0}}
    steps = [
        Step(f"{i}", 1, {**held, "upper.top": {"y": -2.5 / RADIUS * (i / increments) ** 2}})
        for i in range(1, increments + 1)
    ]
    materials = {
        body: make_material("linear-elastic", E=2.0 * G * (1.0 + nu), nu=nu)
        for body, nu in RATIOS.items()
    }
    line.solved(model, materials, [contact], *steps)
    force = 2.0 * abs(contact.resultant()[0][1])
    a = np.sqrt(4.0 * force * RADIUS / (np.pi * REDUCED))
    limit = mu * 2.0 * force / (np.pi * a)
    x, k = contact.points[:, 0] / a, stick(mu)
    inside = (x > 1e-9) & (x < 1.0)
    exact = np.array([shear(s, k, mu) if i else 0.0 for s, i in zip(x, inside, strict=True)])
    found = np.abs(contact.last.traction[:, 0]) / limit
    told = (x <= 0.95) & (np.abs(x - k) > 0.5 / (n * a))
    return Shear(x, found, exact, told, (contact.last.status == 1, x < k))


@pytest.mark.parametrize(("n", "bound"), [(4, 0.12), (6, 0.06)])
@pytest.mark.parametrize("share", [0.8, 1.0, 1.3])
def test_pressed_with_friction(line: Any, share: float, n: int, bound: float) -> None:
    """Stick to 0.85, 0.71 and 0.49 of the half-width."""
    grown = pressed(line, n, BETA / share, 4 * n)
    assert grown.largest < bound
    grown.check_status()


@pytest.mark.parametrize(("increments", "bound"), [(1, 0.1), (4, 0.03)])
def test_few_increments(line: Any, increments: int, bound: float) -> None:
    """In one increment the shear is right to a tenth of mu p0, in four to 3 %, as root mean square.

    Source: points that touch and stick carry what their way against the gap gives, see
    `test_closing_increment`; of first order in what the contact grows by, 0.054 and 0.020 are left,
    and 0.007 in eight and more. Without friction in the increment of the touch it is 0.59 and 0.16.
    """
    assert pressed(line, 8, BETA, increments).mean < bound


@pytest.mark.slow
def test_error_falls(line: Any) -> None:
    """From 4 to 16 facets and 32 to 128 increments the mean error falls with h^0.8 at least.

    Source: nodes come into contact one after the other, and increments end between them, so that
    the slip before a node sticks is of first order in both. What is left is 0.7 % of mu p0, of
    which the closed form leaves out about 0.3.
    """
    coarse, fine = (pressed(line, n, BETA, 8 * n).mean for n in (4, 16))
    assert np.log2(coarse / fine) / 2.0 > 0.8
