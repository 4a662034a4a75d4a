"""Bodies that springs and contact hold together: pressed, dragged, refused where neither does."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Cut, ElasticSupport, Problem, Solver, Spring, Step
from anisocontact.surfaces import make_surface

type Attached = Sequence[Spring | ElasticSupport]

YOUNG, PENALTY = 1000.0, 1e4
MU, ANGLE = (0.2, 0.4), np.radians(30.0)
STRATEGIES = ("direct", "condensed", "iterative")
CLAMP = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
ALONG_X = Spring("pull", "block.right", (20.0, 0.0, 0.0))


def _laws(coefficients: tuple[float, float], stiffness: float) -> tuple[Any, ...]:
    axes = make_directions("constant", vector=(1, 0, 0), angle=ANGLE)
    return (
        NormalLaw(penalty=PENALTY),
        Adhesion(stiffness=(stiffness, stiffness)),
        Friction(coefficients=coefficients, directions=axes),
    )


def _on_plane(
    attached: Attached,
    coefficients: tuple[float, float] = MU,
    stiffness: float = PENALTY,
    young: float = YOUNG,
    height: float = 0.0,
    **options: Any,
) -> Problem:
    """A free block over a plane, on springs."""
    order = options.pop("order", 1)
    cell = options.pop("cell", "hexahedron")
    spec = BoxSpec((0, 0, height), (1, 1, 0.5), (2, 2, 1), cell, order)
    model = build_box({"block": spec})
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(
        model, "block.bottom", Interface(plane, *_laws(coefficients, stiffness)), mortar=False
    )
    elastic = make_material("linear-elastic", E=young, nu=0.3)
    return Problem(model, {"block": elastic}, [contact], attached, **options)


def _on_plate(attached: Attached, stacked: bool = False) -> Problem:
    """A free block on a meshed plate, or two of them."""
    boxes = {
        "block": BoxSpec((0, 0, 0), (1, 1, 0.5), (2, 2, 1)),
        "base": BoxSpec((-0.7, -0.7, -0.5), (2.4, 2.4, 0.5), (5, 5, 1)),
    }
    pairs = [("block.bottom", "base.top")]
    if stacked:
        boxes["upper"] = BoxSpec((0.1, 0.1, 0.5), (0.8, 0.8, 0.4), (3, 3, 1))
        pairs.append(("upper.bottom", "block.top"))
    model = build_box(boxes)
    law = ContactLaw(*_laws(MU, PENALTY))
    contacts = [Contact(model, a, b, law=law, current_area=False, mortar=False) for a, b in pairs]
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    return Problem(model, dict.fromkeys(boxes, elastic), contacts, attached)


def _press_and_drag(
    anchor: dict[str, float], increments: int = 6, top: str = "block"
) -> list[Step]:
    return [
        Step("press", 1, force={f"{top}.top": {"z": -1.0}}),
        Step("drag", increments, anchor={"pull": anchor}),
    ]


def _ended(problem: Problem, steps: list[Step], strategy: str = "direct") -> list[Any]:
    """All increments of a run that needs no cut."""
    cuts: list[Cut] = []
    accepted = list(Solver(problem, steps, strategy=strategy).run(on_cut=cuts.append))
    assert cuts == []
    return accepted


def _limit(along: np.ndarray) -> float:
    """Friction along a direction of the plane per pressure, `1 / |(d_i / mu_i)|`."""
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    in_axes = np.array([[c, s], [-s, c]]) @ along
    return float(1.0 / np.linalg.norm(in_axes / np.array(MU)))


def _drift(along: np.ndarray) -> np.ndarray:
    """Direction of slip where the force acts along a direction: normal to the ellipse."""
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    axes = np.array([[c, s], [-s, c]])
    slip = axes.T @ ((axes @ along) / np.array(MU) ** 2)
    return np.asarray(slip / np.linalg.norm(slip))


@pytest.mark.parametrize("strategy", STRATEGIES)
@pytest.mark.parametrize("make", [_on_plane, _on_plate])
def test_dragged_along_a_stiff_axis(make: Any, strategy: str) -> None:
    """A block pressed by a force and dragged by a spring that is stiff along x alone.

    Requirement: the spring carries the limit of friction along x, and the block drifts along the
    normal of the friction ellipse. Source: in steady sliding there is no force along y, so the
    friction acts along x; associated sliding. Tolerance 1e-6 of the force on the plane, of which
    1e-7 are left to stabilisation; 5e-4 on the plate, whose surface is not flat under the block.
    2 % of the drift, which has the way before all points slide in it.
    """
    problem = make([ALONG_X])
    steps = _press_and_drag({"x": 0.1})
    steps[0] = Step("press", 1, {} if make is _on_plane else CLAMP, force=steps[0].force)
    accepted = _ended(problem, steps, strategy)
    x = np.array([1.0, 0.0])
    share = 1e-6 if make is _on_plane else 5e-4
    assert accepted[-1].reactions["pull"][0] == pytest.approx(_limit(x), rel=share)
    way = problem.u.x.array.reshape(-1, 3)
    here = problem.model.space.tabulate_dof_coordinates()[:, 2] >= 0.5
    slip = way[here].mean(axis=0)[:2]
    assert slip[1] / slip[0] == pytest.approx(_drift(x)[1] / _drift(x)[0], rel=0.02)


@pytest.mark.parametrize("turn", [0.0, 40.0, 125.0])
def test_dragged_along_any_direction(turn: float) -> None:
    """A spring as stiff along x as along y, led in a direction of the plane.

    Requirement: in the end the block follows its anchor, and the force is the one whose slip is
    along the way. Source: the point of the ellipse with the normal d, `mu_i^2 d_i / |mu_i d_i|` in
    its axes. It pulls at the bottom, so that the pressure is even and nothing turns the block.
    Tolerance 1e-6: the difference falls by e with every `r N / k` of the way, r the radius of
    curvature of the ellipse, at most 0.8: here 40 of them in 30 increments.
    """
    problem = _on_plane([Spring("pull", "block.bottom", (20.0, 20.0, 0.0))])
    d = np.array([np.cos(np.radians(turn)), np.sin(np.radians(turn))])
    accepted = _ended(problem, _press_and_drag({"x": 1.6 * d[0], "y": 1.6 * d[1]}, 30))
    c, s = np.cos(ANGLE), np.sin(ANGLE)
    axes = np.array([[c, s], [-s, c]])
    inside = np.array(MU) * (axes @ d)
    needed = axes.T @ (np.array(MU) * inside / np.linalg.norm(inside))
    np.testing.assert_allclose(accepted[-1].reactions["pull"][:2], needed, atol=1e-6)


@pytest.mark.parametrize("spring", [0.2, 20.0, 2e3])
def test_slope_before_it_slides(spring: float) -> None:
    """Spring and contact one behind the other.

    Requirement: force `k a / (1 + k / k_c)` at an anchor a. Source: both carry the same force; k_c
    is the stiffness of adhesion times the area of 1, the block is 1e5 times as stiff. Tolerance
    1e-3: the block is not rigid, and tilts by what the spring pulls above the plane.
    """
    stiffness = 500.0
    pull = Spring("pull", "block.bottom", (spring, 0.0, 0.0))
    problem = _on_plane([pull], (0.5, 0.5), stiffness, young=1e7)
    reach = 0.2 * (1.0 / spring + 1.0 / stiffness)
    accepted = _ended(problem, _press_and_drag({"x": reach}, 2))
    needed = [spring * a / (1.0 + spring / stiffness) for a in (0.5 * reach, reach)]
    found = [one.reactions["pull"][0] for one in accepted[1:]]
    np.testing.assert_allclose(found, needed, rtol=1e-3)


BEDS: dict[str, tuple[Attached, dict[str, Any]]] = {
    "gap": ([ALONG_X], {"height": 0.2}),
    "overlap": ([ALONG_X], {"height": -1e-4}),
    "touching, without stabilisation": ([ALONG_X], {"height": -1e-4, "stabilised": False}),
    "bed along the normal": ([ALONG_X, ElasticSupport("block.top", 0.0, 1e-6)], {}),
    "bed across it": ([ALONG_X, ElasticSupport("block.left", 1e-6)], {}),
    "several springs": (
        [ALONG_X, Spring("up", "block.top", (0, 0, 1e-6)), Spring("y", "block.left", (0, 1e-6, 0))],
        {},
    ),
    "tetrahedra of order 2": ([ALONG_X], {"cell": "tetrahedron", "order": 2}),
}


@pytest.mark.parametrize("name", list(BEDS))
def test_however_it_is_held(name: str) -> None:
    """The same force in steady sliding, whatever else weakly holds the block.

    Source: as above; beds and springs of 1e-6 carry less than 1e-6. Tolerance 2e-6 for that.
    """
    attached, options = BEDS[name]
    problem = _on_plane(attached, **options)
    accepted = _ended(problem, _press_and_drag({"x": 0.04}, 3))
    limit = _limit(np.array([1.0, 0.0]))
    assert accepted[-1].reactions["pull"][0] == pytest.approx(limit, abs=2e-6)


def test_no_stabilisation_where_it_slides_on() -> None:
    """A soft spring: the block lets go in an increment that is stabilised, and slides on.

    Requirement: at most the increment in which it lets go is stabilised; contact, spring and
    friction across the way have stiffness in all motions after it.
    """
    problem = _on_plane([Spring("pull", "block.right", (1.0, 0.0, 0.0))], (0.3, 0.3))
    steps = _press_and_drag({"x": 1.5}, 8)
    solver = Solver(problem, steps, strategy="direct")
    accepted = []
    for one in solver.run():
        problem.stabilisation.trust.careful = (
            problem.stabilisation.trust.careful or len(accepted) == 1
        )
        accepted.append(one)
    taken = [one.energies["stabilisation"] for one in accepted]
    assert taken[-1] == taken[-5]
    assert sum(one.iterations for one in accepted[-5:]) <= 15


def test_a_spring_at_a_corner() -> None:
    """A spring at one side of the top turns the block about its normal while it slides.

    Requirement: force and moment of contact are those of the spring and the load, for a linear body
    where it was at first. Tolerance 1e-6: what stabilisation leaves.
    """
    pull = Spring("pull", "block.front", (20.0, 0.0, 0.0))
    problem = _on_plane([pull], (0.3, 0.3))
    accepted = _ended(problem, _press_and_drag({"x": 0.04}, 4))
    contact = problem.contacts[0]
    forces = contact.areas[:, None] * contact.last.traction
    force = forces.sum(axis=0)
    moment = np.cross(contact.quadrature.reference, forces).sum(axis=0)
    spring = accepted[-1].reactions["pull"]
    np.testing.assert_allclose(force + spring, [0.0, 0.0, 1.0], atol=1e-6)
    assert np.ptp(problem.u.x.array.reshape(-1, 3)[:, 1]) > 1e-3  # it turns
    of_spring = np.cross([0.5, 0.0, 0.25], spring)
    of_load = np.cross([0.5, 0.5, 0.5], [0.0, 0.0, -1.0])
    np.testing.assert_allclose(moment + of_spring + of_load, 0.0, atol=1e-6)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_two_blocks_and_a_spring_between(strategy: str) -> None:
    """A stack: the upper block is dragged on the lower one, which a spring ties to it.

    Requirement: nothing of the two is held but by contact and springs, and the spring to ground
    carries what friction on the base does. Tolerance 1e-6, what stabilisation leaves.
    """
    tie = Spring("tie", "upper.right", (5.0, 5.0, 0.0), to="block.right")
    problem = _on_plate([Spring("pull", "upper.right", (20.0, 0.0, 0.0)), tie], stacked=True)
    press, drag = _press_and_drag({"x": 0.02}, 2, top="upper")
    steps = [Step("press", 1, CLAMP, force=press.force), drag]
    accepted = _ended(problem, steps, strategy)
    below, _ = problem.contacts[0].resultant()
    np.testing.assert_allclose(below, [-accepted[-1].reactions["pull"][0], 0.0, 1.0], atol=1e-6)


def _alone(attached: Attached) -> Problem:
    model = build_box({name: BoxSpec((x, 0, 0), (1, 1, 1), (1, 1, 1)) for name, x in FARAPART})
    elastic = make_material("linear-elastic", E=YOUNG, nu=0.3)
    return Problem(model, {name: elastic for name, _ in FARAPART}, [], attached)


FARAPART = (("a", 0.0), ("b", 3.0))
REFUSED: dict[str, tuple[Attached, str]] = {
    "one axis": (
        [Spring("pull", "b.right", (10.0, 0.0, 0.0))],
        "body 'b' is free to move: translation along y and z, rotation about x, y and z; "
        "it is in no contact, and its springs do not hold that: it needs a support",
    ),
    "a bed along its normal": (
        [ElasticSupport("b.bottom", 1.0)],
        "body 'b' is free to move: translation along x and y, rotation about z;",
    ),
    "to a body that nothing holds": (
        [Spring("tie", "a.right", (10.0, 10.0, 10.0), to="b.left")],
        "body 'b' is free to move:",
    ),
    "too weak for the load": (
        [ElasticSupport("b.bottom", 1e-6, 1e-6)],
        "body 'b' is free to move: translation along z; it is in no contact, and its springs give "
        "way to the loads by more than 100 times its size: it needs a support",
    ),
    "no stiffness": ([ElasticSupport("b.bottom", 1e-16, 1e-16)], "body 'b' is free to move:"),
}


@pytest.mark.parametrize("name", list(REFUSED))
def test_what_nothing_holds_is_refused_before_the_run(name: str) -> None:
    """Bodies in no contact: springs count in the directions in which they have stiffness.

    Requirement: an error that names step, body and motions; it had ended as done at coordinates of
    1e8.
    """
    attached, said = REFUSED[name]
    held = (
        {"a.left": {"x": 0.0, "y": 0.0, "z": 0.0}} if name != "to a body that nothing holds" else {}
    )
    step = Step("pull", 1, held, force={"b.top": {"z": -1.0}})
    with pytest.raises(InputError) as error:
        Solver(_alone(attached), [step])
    assert said.replace("body 'b'", "body 'a'" if not held else "body 'b'") in str(error.value)


def test_springs_that_hold_a_body_are_enough() -> None:
    """A bed with both stiffnesses holds all motions: nothing is stabilised, contact or not.

    Source: the body goes down by the load over the stiffness. Tolerance: that of Newton's method.
    """
    step = Step("press", 1, {"a.left": {"x": 0.0, "y": 0.0, "z": 0.0}}, {"b.top": {"z": -1.0}})
    problem = _alone([ElasticSupport("b.bottom", 50.0, 5.0)])
    (accepted,) = Solver(problem, [step]).run()
    assert accepted.reactions["b.bottom"][2] == pytest.approx(1.0, rel=1e-7)
    assert not problem.stabilisation.watches
