"""The whole interface at a point against an implementation in NumPy that shares no code with it.

Requirement: tractions, histories and energies of every evolution form, sliding rule, adhesion,
friction and normal law agree along paths over NURBS patches whose coordinate lines are oblique and
curved, with a gap that opens and closes, oblique axes of adhesion and of friction apart, and full,
unsymmetric tensors A, S, R; on a closed patch the paths cross the seam. Source: `law.py` beside
this file, from the equations. Tolerance: 1e-8 of the largest number of each kind over a path; the
foot that the core finds is right to some 1e-10, and slip forgets what rounding leaves.
"""

from __future__ import annotations

from collections import defaultdict

import numpy as np
import pytest
from tests.verification.independent import elements
from tests.verification.independent import law as numpy_law
from tests.verification.independent.patch import Patch, Place, skew_sheet, skew_tube

from anisocontact.anisotropy import make_directions
from anisocontact.base import registry
from anisocontact.interface import Interface, SlaveSurface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import make_surface

K, K1, TAU, ETA = np.array([[300, 120], [200, 90], [0.5, 1.1], [60, 25]])
SHEET, TUBE = skew_sheet(), skew_tube()
MARKS = numpy_law.Marks(np.array([0.8, -0.3, 0.4]), (0.3, 1.35))
BRUSHED = numpy_law.Marks(np.array([-0.2, 1.0, 0.3]), (0.2, 2.3))
SECOND = numpy_law.Marks(np.array([0.5, 0.7, 0.2]), (0.9, 2.0))
A = np.array([[1.3, 0.6], [-0.4, 0.9]])
S = np.array([[260.0, 50.0], [-30.0, 150.0]])
R = np.array([[90.0, 40.0], [-25.0, 60.0]])
REST, RELAXING = np.array([[80.0, 30.0], [30.0, 60.0]]), np.array([[150.0, -40.0], [-40.0, 90.0]])


def full(a, s, r, springs=None) -> tuple[str, dict[str, object], elements.Elements]:
    values = {"relaxation": a, "stiffness_instant": s, "stiffness_rate": r}
    given: dict[str, object] = {name: m.ravel().tolist() for name, m in values.items()}
    given["energy"] = "none" if springs is None else "stored"
    return "general-linear", given, elements.Elements(1.0, a, s, r, springs)


STRIP = np.array([0.0, 200.0])
ADHESION = {
    "elastic": ("elastic", {"stiffness": K}, elements.elastic(K)),
    "strip": ("elastic", {"stiffness": STRIP}, elements.elastic(STRIP)),
    "maxwell": ("maxwell", {"stiffness": K, "relaxation_time": TAU}, elements.maxwell(K, TAU)),
    "kelvin-voigt": (
        "kelvin-voigt",
        {"stiffness": K, "viscosity": ETA},
        elements.kelvin_voigt(K, ETA),
    ),
    "standard-linear-solid": (
        "standard-linear-solid",
        {"stiffness": K, "stiffness_maxwell": K1, "relaxation_time": TAU},
        elements.solid(K, K1, TAU),
    ),
    "full": full(A, S, R),
    "passive": full(A, REST + RELAXING, A @ REST, (REST, RELAXING)),
}
NORMAL = {
    "penalty": ({"penalty": 900.0}, elements.Pressure(0.0, 1.0, 0.0, 900.0)),
    "kelvin-voigt": (
        {"stiffness": 900.0, "viscosity": 40.0},
        elements.Pressure(0.0, 1.0, 40.0, 900.0),
    ),
    "maxwell": (
        {"stiffness": 900.0, "relaxation_time": 3.0},
        elements.Pressure(1.0, 1.0 / 3.0, 900.0, 0.0),
    ),
    "standard-linear-solid": (
        {"stiffness": 700.0, "stiffness_maxwell": 400.0, "relaxation_time": 0.7},
        elements.Pressure(1.0, 1.0 / 0.7, 1100.0, 1000.0),
    ),
    "general-linear": (
        {"a": 0.8, "b": 900.0, "c": 500.0},
        elements.Pressure(1.0, 0.8, 900.0, 500.0),
    ),
}
MU, ALPHA = np.array([0.35, 0.2]), np.array([0.15, 0.12, 0.08])
FRICTION = {
    "orthotropic": ({"coefficients": MU}, numpy_law.orthotropic(MU)),
    "he-curnier": ({"alpha": ALPHA}, numpy_law.he_curnier(ALPHA)),
}
DT = 0.2
REGISTERED = tuple(e.name for e in registry.evolution_forms())
#: A core without the name has "transport" of first order, and takes whole steps for laws in time.
SECOND_ORDER = "backward-euler" in REGISTERED


def directions(m: numpy_law.Marks):
    first, second = m.angles
    return make_directions("oblique", vector=m.vector, angle_first=first, angle_second=second)


def both(patch, evolution, adhesion, rule, normal="penalty", friction="orthotropic"):
    """The interface of the core and the law in NumPy."""
    model, given, elements = ADHESION[adhesion]
    of_rule, slide = numpy_law.RULES[rule]
    of_normal, pressure = NORMAL[normal]
    of_friction, limit = FRICTION[friction]
    second = {"directions_second": directions(SECOND)} if friction == "he-curnier" else {}
    core = Interface(
        make_surface("nurbs", **patch.parameters),
        NormalLaw(normal, **of_normal),
        Adhesion(model, directions=directions(MARKS), **given),
        Friction(
            friction,
            directions=directions(BRUSHED),
            sliding_rule=rule.split()[0],
            **of_friction,
            **of_rule,
            **second,
        ),
        evolution=evolution,
        threads=1,
    )
    form = evolution if SECOND_ORDER or evolution != "transport" else "backward-euler"
    axes = MARKS, BRUSHED, SECOND
    mine = numpy_law.Law(patch, form, pressure, elements, *axes, limit, slide, SECOND_ORDER)
    return core, mine


def path(patch: Patch) -> tuple[np.ndarray, np.ndarray]:
    """Feet, (steps, points, 2), and gaps, (steps, points): sticks, slides, turns, lifts off."""
    s = np.linspace(0.0, 2.0 * np.pi, 29)[:, None] + np.array([0.0, 1.1, 2.9])
    u = 0.5 + 0.12 * np.sin(s) + 0.05 * np.sin(3.0 * s)
    v = 0.5 + 0.1 * np.cos(s) * np.cos(0.5 * s)
    if patch.closed:
        u = u - 0.5  # over the seam at 0
    gap = -0.03 - 0.035 * np.sin(2.0 * s + 0.4)
    return np.stack([u, v], axis=-1), gap


class Compared:
    """Largest difference of each kind of number, over the largest such number."""

    def __init__(self) -> None:
        self.pairs: dict[str, list[tuple[object, object]]] = defaultdict(list)

    def add(self, name: str, core: object, mine: object) -> None:
        self.pairs[name].append((core, mine))

    def check(self, tolerance: float) -> None:
        for name, pairs in self.pairs.items():
            core, mine = (np.array(numbers) for numbers in zip(*pairs, strict=True))
            assert (np.isnan(core) == np.isnan(mine)).all(), name
            apart, size = (np.nanmax(np.abs([*a.flat, 0.0])) for a in (core - mine, mine))
            assert apart <= tolerance * size, name


def material(place: Place, k: int, inclined: float) -> np.ndarray:
    """Two tangents of a slave that turns and stretches, inclined to the plane, more and less."""
    t = place.frame(0.2 + 0.4 * np.sin(0.7 * k))
    stretch = np.array([[1.1, 0.2 + 0.01 * k], [0.1, 0.9]])
    flat = stretch @ t + 0.1 * place.normal
    angle = inclined + 0.2 * np.sin(0.5 * k)
    return np.array([numpy_law.about(t[0], angle, v) for v in flat])


def follow(core: Interface, mine: numpy_law.Law, inclined: float | None = None) -> np.ndarray:
    """Both along the path, beside a slave of any inclination or none; how often each status is."""
    patch = mine.patch
    feet, gaps = path(patch)
    found, statuses = Compared(), np.zeros(3, dtype=int)
    for point in range(feet.shape[1]):
        places = [patch.at(xi) for xi in feet[:, point]]
        x = np.array([p.x + g * p.normal for p, g in zip(places, gaps[:, point], strict=True)])
        state = core.initial_state(x[:1])
        history = numpy_law.History(feet[0, point], gaps[0, point])
        for k in range(1, len(x)):
            own = None if inclined is None else material(places[k], k, inclined)
            slave = None if own is None else SlaveSurface(x[k : k + 1], own[None], own[None])
            r = core.update(state, x[k : k + 1], DT, tangent=False, slave=slave)
            state, s = r.state, r.state[0]
            a = mine.step(history, feet[k, point], gaps[k, point], DT, own)
            history, here = a.history, places[k]
            assert s["status"] == history.status
            statuses[history.status] += 1
            found.add("traction", r.traction[0], a.traction)
            found.add("stored", s["stored"] @ here.dual, history.stored)
            found.add("elastic", s["elastic"] @ here.tangents, history.elastic)
            found.add("slip", s["slip"] @ here.tangents, a.slip)
            found.add("path", s["slip_accumulated"], history.length)
            found.add("pressure", s["pressure"], history.pressure)
            found.add("dissipation", s["dissipation"], history.dissipation)
            if mine.pressure.w == 0.0 and mine.pressure.b == 0.0:
                found.add("viscous", s["dissipation_viscous"], history.viscous)
            found.add("adhesion", s["energy_adhesion"], a.energy)
    found.check(1e-8)
    return statuses


FORMS = tuple(name for name in REGISTERED if name != "total")


@pytest.mark.parametrize("rule", numpy_law.RULES)
@pytest.mark.parametrize("adhesion", ADHESION)
@pytest.mark.parametrize("evolution", FORMS)
def test_law_over_an_oblique_patch(evolution: str, adhesion: str, rule: str) -> None:
    statuses = follow(*both(SHEET, evolution, adhesion, rule))
    assert (statuses > 3).all()


@pytest.mark.parametrize("inclined", [0.0, 1.2, 0.5 * np.pi])
@pytest.mark.parametrize("adhesion", ["elastic", "full"])
def test_slave_that_turns(adhesion: str, inclined: float) -> None:
    """The slip of a step spans an arc where the slave turns against the master.

    Also where its facet is inclined to the contact plane, up to where it is seen from its side.
    """
    follow(*both(SHEET, "transport", adhesion, "maximum-dissipation"), inclined)


@pytest.mark.parametrize("rule", numpy_law.RULES)
@pytest.mark.parametrize("adhesion", ["elastic", "strip"])
def test_total_form(adhesion: str, rule: str) -> None:
    statuses = follow(*both(SHEET, "total", adhesion, rule))
    assert (statuses > 3).all()


@pytest.mark.parametrize("evolution", [*FORMS, "total"])
def test_over_the_seam_of_a_closed_patch(evolution: str) -> None:
    adhesion = "elastic" if evolution == "total" else "full"
    follow(*both(TUBE, evolution, adhesion, "maximum-dissipation"))


@pytest.mark.parametrize("normal", NORMAL)
@pytest.mark.parametrize("evolution", FORMS)
def test_normal_laws(evolution: str, normal: str) -> None:
    follow(*both(SHEET, evolution, "passive", "maximum-dissipation", normal))


@pytest.mark.parametrize("rule", numpy_law.RULES)
@pytest.mark.parametrize("evolution", ["transport", "covariant"])
def test_friction_of_two_surfaces(evolution: str, rule: str) -> None:
    follow(*both(SHEET, evolution, "full", rule, friction="he-curnier"))


@pytest.mark.parametrize("friction", FRICTION)
@pytest.mark.parametrize("rule", numpy_law.RULES)
@pytest.mark.parametrize(
    ("evolution", "adhesion"),
    [("transport", "full"), ("covariant", "full"), ("transport", "strip"), ("total", "elastic")],
)
def test_tangent(evolution: str, adhesion: str, rule: str, friction: str) -> None:
    """dt/dx against central differences of the law in NumPy, whose foot is sought anew.

    Four steps in which the point slips, and the step before each. Steps of 1e-5 in positions of
    size one leave some 1e-9 of third derivatives and 1e-9 of rounding, in all below 1e-6 of the
    largest entry.
    """
    core, mine = both(SHEET, evolution, adhesion, rule, friction=friction)
    feet, gaps = (a[:, 0] for a in path(SHEET))
    places = [SHEET.at(xi) for xi in feet]
    x = np.array([p.x + g * p.normal for p, g in zip(places, gaps, strict=True)])
    state = core.initial_state(x[:1])
    history = numpy_law.History(feet[0], gaps[0])
    h, found, slipped = 1e-5, Compared(), 0
    for k in range(1, 16):
        r = core.update(state, x[k : k + 1], DT)
        if k % 3 == 0 and r.status[0]:
            slipped += int(r.status[0] == 2)
            moved = [
                [
                    mine.step(history, *SHEET.foot(x[k] + step, feet[k]), DT).traction
                    for step in (h * e, -h * e)
                ]
                for e in np.eye(3)
            ]
            slopes = np.array([(a - b) / (2.0 * h) for a, b in moved]).T
            found.add("tangent", r.tangent[0], slopes)
        state = r.state
        history = mine.step(history, feet[k], gaps[k], DT).history
    assert slipped
    found.check(1e-6)


def test_everything_is_here() -> None:
    """Every registered form, rule, adhesion, normal and friction model is compared."""
    names = lambda entries: {e.name for e in entries}  # noqa: E731
    assert set(REGISTERED) <= {"transport", "backward-euler", "covariant", "incremental", "total"}
    assert names(registry.sliding_rules()) == {rule.split()[0] for rule in numpy_law.RULES}
    assert names(registry.adhesion_models()) == {model for model, _, _ in ADHESION.values()}
    assert names(registry.normal_laws()) == set(NORMAL)
    assert names(registry.friction_models()) == set(FRICTION)
