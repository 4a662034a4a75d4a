"""Hertz in plane strain with mortar multipliers: the pressure at every slave node.

Requirement: within 0.8 a the pressure at every node differs from the closed form by at most 6 % of
p0 at 4 facets per half-width and 2.5 % at 8, with elements of order 2 half of that, on a rigid
cylinder or plane 4 and 1 %; nowhere above 1.05 p0, and no alternation from node to node. Facets are
counted on the coarser side. Source: Hertz, in K. L. Johnson, Contact Mechanics, eqs. (4.43) to
(4.45), with the force P of the run per thickness,

    a = sqrt(4 P R / (pi E*)) ,    p0 = 2 P / (pi a) ,    p = p0 sqrt(1 - x^2 / a^2) .

Tolerance: as demanded. An alternation of amplitude A changes second differences of the error by
4 A; 1 % of p0 is allowed for A.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

from anisocontact.bulk import make_material
from anisocontact.contact import Augmentation, Contact
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.solver import Step
from anisocontact.surfaces import make_surface

Floats = npt.NDArray[np.float64]

RADIUS, E, NU = 400.0, 1000.0, 0.3
#: Approach of the far ends, times the radius: the half-width is about one.
APPROACH = {2: 2.5 / RADIUS, 1: 2.0 / RADIUS}
LAWS = NormalLaw(penalty=10.0 * E), Adhesion(stiffness=1.0), Friction(coefficients=0)


@dataclass(frozen=True)
class Pressure:
    """Pressure at the slave nodes.

    Attributes:
        place: x over a, (n,).
        found: Pressure over p0, (n,).
        iterations: Newton iterations, in one increment from no contact.
    """

    place: Floats
    found: Floats
    iterations: int

    @property
    def error(self) -> Floats:
        """What is too much, over p0, (n,)."""
        return np.asarray(self.found - np.sqrt(np.maximum(1.0 - self.place**2, 0.0)))

    @property
    def largest(self) -> float:
        """Largest error within 0.8 a, over p0."""
        return float(np.abs(self.error[self.place <= 0.8]).max())

    @property
    def alternation(self) -> float:
        """Amplitude of what alternates from node to node within 0.8 a, over p0."""
        error = self.error[np.argsort(self.place)]
        inner = error[np.sort(self.place) <= 0.8]
        return float(np.abs(np.diff(inner, 2)).max(initial=0.0) / 4.0)


def pressed(
    line: Any,
    upper: int,
    lower: int,
    *,
    moduli: tuple[float, float] = (E, E),
    swapped: bool = False,
    order: int = 1,
) -> Pressure:
    """A cylinder of `upper` facets a unit on a base of `lower`; none is a rigid plane or cylinder.

    The cylinder is the slave of two deformable bodies unless they are swapped.
    """
    facets = {name: n for name, n in (("upper", upper), ("lower", lower)) if n}
    model = line.half_planes(facets, height=lambda x: 0.5 * x**2 / RADIUS, order=order)
    sides: tuple[Any, ...] = ("upper.bottom", "lower.top")
    law: Any = ContactLaw(*LAWS)
    if not upper:
        # far from where a cylinder has no coordinates
        surface = make_surface("cylinder", point=(0, RADIUS, 0), axis=(0, 0, 1), radius=RADIUS)
        sides, law = ("lower.top", Interface(surface, *LAWS)), None
    elif not lower:
        plane = make_surface("plane", point=(0, 0, 0), normal=(0, 1, 0))
        sides, law = ("upper.bottom", Interface(plane, *LAWS)), None
    sides = sides[::-1] if swapped else sides
    contact = Contact(model, *sides, law, mortar=True, augmentation=Augmentation(tangential=False))
    far = {"upper": ("top", -1.0), "lower": ("bottom", 1.0 if not upper else 0.0)}
    held: dict[str, Any] = {f"{body}.left": {"x": 0.0} for body in facets}
    for body in facets:
        end, sign = far[body]
        held[f"{body}.{end}"] = {"y": sign * APPROACH[len(facets)]}
    of_body = dict(zip(("upper", "lower"), moduli, strict=True))
    materials = {b: make_material("linear-elastic", E=of_body[b], nu=NU) for b in facets}
    iterations = line.solved(model, materials, [contact], Step("press", 1, held))
    reduced = 1.0 / sum((1.0 - NU**2) / of_body[b] for b in facets)
    force = 2.0 * abs(contact.resultant()[0][1])
    a = np.sqrt(4.0 * force * RADIUS / (np.pi * reduced))
    peak = 2.0 * force / (np.pi * a)
    return Pressure(contact.points[:, 0] / a, contact.last.pressure / peak, iterations)


#: Ratio of the moduli of cylinder and base, and whether the base is the slave.
PAIRS: dict[str, dict[str, Any]] = {
    "equal": {},
    "stiff slave": {"moduli": (E, 0.01 * E)},
    "stiff master": {"moduli": (0.01 * E, E)},
    "swapped": {"swapped": True},
}


@pytest.mark.parametrize(("n", "bound"), [(4, 0.06), (8, 0.025)])
@pytest.mark.parametrize("which", PAIRS)
def test_pair(line: Any, which: str, n: int, bound: float) -> None:
    """Two deformable bodies whose meshes do not match."""
    p = pressed(line, n, n + 1, **PAIRS[which])
    assert p.largest < bound
    assert p.found.max() < 1.05
    assert p.alternation < 0.01


@pytest.mark.parametrize(("n", "bound"), [(4, 0.03), (8, 0.0125)])
def test_pair_of_order_two(line: Any, n: int, bound: float) -> None:
    """Elements of order 2, with edges that follow the cylinder."""
    p = pressed(line, n, n + 1, order=2)
    assert p.largest < bound
    assert p.found.max() < 1.05


def test_matching_pair(line: Any) -> None:
    """Nodes above nodes."""
    p = pressed(line, 4, 4)
    assert p.largest < 0.06
    assert p.found.max() < 1.05


@pytest.mark.parametrize(("n", "bound"), [(4, 0.04), (8, 0.01)])
@pytest.mark.parametrize("kind", ["cylinder", "plane"])
def test_rigid_surface(line: Any, kind: str, n: int, bound: float) -> None:
    """A rigid cylinder on a block, an elastic cylinder on a rigid plane."""
    p = pressed(line, *((0, n) if kind == "cylinder" else (n, 0)))
    assert p.largest < bound
    assert p.found.max() < 1.05
    assert p.alternation < 0.01


@pytest.mark.parametrize("order", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_error_falls(line: Any, order: int) -> None:
    """From 3 to 12 facets the largest error within 0.8 a falls with h^1.5 at least.

    Source: interpolation is of second order; the square root at the edge lies outside. What is left
    at 12 facets is below 0.2 % of p0: bodies of 60 half-widths, and what radiates from the edge.
    """
    coarse, fine = (pressed(line, n, n + 1, order=order).largest for n in (3, 12))
    assert np.log2(coarse / fine) / 2.0 > 1.5
