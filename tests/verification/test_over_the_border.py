"""Slave points that slide on to a master of facets from beyond its border.

What they slip in the increment in which they come is the way from where they were: with it friction
has its size and direction from the first increment on.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from tests.conftest import errors_and_status

from anisocontact.anisotropy import make_directions
from anisocontact.base.array_types import Floats
from anisocontact.bulk import make_material
from anisocontact.contact import Augmentation, Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step, Tie
from anisocontact.solver.stepping.increment_warnings import IncrementWarnings

E, NU = 100.0, 0.3
ROUNDING = 1e-12
#: Normal penalty and adhesion along the first axis and across it, stress/length.
NORMAL, ALONG, ACROSS = 1e3, 300.0, 100.0
DIRECTIONS = make_directions("constant", vector=(1.0, 0.5, 0.0))


def _law(coefficients: tuple[float, float]) -> ContactLaw:
    return ContactLaw(
        NormalLaw(penalty=NORMAL),
        Adhesion(stiffness=(ALONG, ACROSS), directions=DIRECTIONS),
        Friction(coefficients=coefficients, directions=DIRECTIONS),
    )


def _beside_a_plate(
    coefficients: tuple[float, float], *, mortar: bool, order: int
) -> tuple[Contact, Any]:
    """A pad that ends 0.05 beyond the border x = 0 of a plate, which has 0.5 facets.

    Returns:
        The contact, and what gives displacements: of the pad against the plate, of both, (3,).
    """
    pad = BoxSpec((-0.45, 0.3, 0.0), (0.4, 0.4, 0.2), (2, 2, 1), order=order)
    plate = BoxSpec((0.0, 0.0, -0.5), (1.0, 1.0, 0.5), (2, 2, 1), order=order)
    model = build_box({"pad": pad, "plate": plate})
    contact = Contact(
        model, "pad.bottom", "plate.top", _law(coefficients), mortar=mortar, current_area=False
    )
    x = model.space.tabulate_dof_coordinates()
    on_pad = np.array([x[:, 0] < -0.01]).T

    def moved(by: Any, both: Any = (0.0, 0.0, 0.0)) -> Floats:
        return np.asarray(np.where(on_pad, by, 0.0) + np.asarray(both))

    return contact, moved


WAYS = pytest.mark.parametrize("mortar", [False, True], ids=["points", "nodes"])
ORDERS = pytest.mark.parametrize("order", [1, 2])


def _axes() -> tuple[Floats, Floats]:
    first = np.array([1.0, 0.5, 0.0]) / np.sqrt(1.25)
    return first, np.array([-first[1], first[0], 0.0])


@WAYS
@ORDERS
def test_slip_counts_from_where_a_point_was(mortar: bool, order: int) -> None:
    """A pad that is moved on to a plate sticks with the force of the whole way, or slides along it.

    Source: T = -B s with the slip s of the increment, while it is inside the bound; beyond it the
    end of an increment from no force, T = -Q s N / |Q^(1/2) s| by maximum dissipation with
    adhesion and friction of one shape. Everything moves besides, which is no slip. Tolerance:
    rounding.
    """
    first, second = _axes()
    way, sunk = np.array([0.3, -0.1, 0.0]), np.array([0.0, 0.0, -0.01])
    both = np.array([0.2, 0.4, -0.3])
    slip = np.array([way @ first, way @ second])
    stuck = -np.array([ALONG, ACROSS]) * slip
    friction = np.sqrt([0.3, 0.1])  # ellipses of adhesion and friction have one shape
    limit = NORMAL * 0.01 / np.sqrt((stuck**2 / friction**2).sum())
    for coefficients, force in (((1e3, 1e3), stuck), (tuple(friction), stuck * limit)):
        contact, moved = _beside_a_plate(coefficients, mortar=mortar, order=order)
        contact.update(moved(sunk), 1.0)
        assert not contact.trial.status.any()
        contact.commit()
        answer = contact.update(moved(way + sunk, both), 1.0)
        touching = answer.status > 0
        assert 0 < touching.sum() < len(touching) or order == 1
        expected = force[0] * first + force[1] * second
        tangential = answer.traction_t[touching]
        scale = np.linalg.norm(expected)
        np.testing.assert_allclose(
            tangential, np.tile(expected, (len(tangential), 1)), atol=ROUNDING * scale
        )


@WAYS
@ORDERS
def test_points_that_come_down_as_well(mortar: bool, order: int) -> None:
    """A pad that comes over the border and down on the plate sticks from where it touches it.

    Source: the way is straight, so that a share of 0.01 in 0.11 of it is in contact, as for points
    above the plate. Tolerance: rounding.
    """
    first, second = _axes()
    way, above, sunk = np.array([0.3, -0.1, 0.0]), 0.1, 0.01
    contact, moved = _beside_a_plate((1e3, 1e3), mortar=mortar, order=order)
    contact.update(moved((0.0, 0.0, above)), 1.0)
    contact.commit()
    answer = contact.update(moved(way - (0.0, 0.0, sunk)), 1.0)
    tangential = answer.traction_t[answer.status > 0]
    share = sunk / (above + sunk)
    expected = -share * (ALONG * (way @ first) * first + ACROSS * (way @ second) * second)
    assert len(tangential)
    np.testing.assert_allclose(tangential, np.tile(expected, (len(tangential), 1)), atol=1e-10)


@WAYS
def test_a_layer_behind_adhesion_leaves_out_points_that_come(mortar: bool) -> None:
    """They have no slip in that attempt, and all of it in the next one.

    Requirement: a layer shifts points that stick, and none where no master was.
    """
    contact, moved = _beside_a_plate((1e3, 1e3), mortar=mortar, order=2)
    sunk, way = (0.0, 0.0, -0.01), (0.3, -0.1, -0.01)
    contact.update(moved(sunk), 1.0)
    contact.commit()
    usual = contact.update(moved(way), 1.0).traction_t
    contact.trials.lay(1e-3, 1.0)
    layered = contact.update(moved(way), 1.0)
    touching = layered.status > 0
    assert touching.any()
    assert not layered.traction_t[touching].any()
    contact.trials.take_away()
    contact.roll_back()
    assert np.array_equal(contact.update(moved(way), 1.0).traction_t, usual)
    assert usual[touching, :2].all()


@WAYS
@ORDERS
def test_tangent_of_points_that_come(mortar: bool, order: int) -> None:
    """The tangent where points have come over the border, of which some stick and some slide.

    Requirement: halving the step of the central difference quarters its error against the tangent.
    Source: Taylor. Tolerance: as in `test_fe_tangent`.
    """
    contact, moved = _beside_a_plate((0.4, 0.15), mortar=mortar, order=order)
    model = contact.model
    material = make_material("neo-hookean", E=E, nu=NU)
    problem = Problem(model, {"pad": material, "plate": material}, [contact])
    held = {side: {"x": 0.0, "y": 0.0, "z": 0.0} for side in ("pad.top", "plate.bottom")}
    problem.begin(Step("slide", 1, held))
    problem.set_load_factor(1.0, 1.0)
    rng = np.random.default_rng(7)
    x = problem.accepted()

    def take(u: Floats) -> None:
        x.array[: u.size] = (u + 1e-3 * rng.standard_normal(u.shape)).reshape(-1)

    take(moved((0.0, 0.0, -0.01)))
    problem.commit(x)
    take(moved((0.3, -0.1, -0.01)))
    direction = problem.new_vector()
    direction.array[:] = rng.standard_normal(direction.getSize())
    steps = [1e-5, 5e-6, 2.5e-6]
    errors, same, status = errors_and_status(problem, contact, x, direction, steps)
    assert same
    assert 2 in status
    assert np.all(np.abs(errors[:-1] / errors[1:] - 4.0) < 0.15)


@WAYS
def test_places_beyond_the_border_are_in_a_checkpoint(mortar: bool) -> None:
    """A contact that goes on from what was kept answers with the same bits."""
    contact, moved = _beside_a_plate((0.4, 0.15), mortar=mortar, order=2)
    start = moved((0.01, 0.02, -0.01))
    contact.update(start, 1.0)
    contact.commit()
    other = _beside_a_plate((0.4, 0.15), mortar=mortar, order=2)[0]
    other.restore(contact.persistent(), start)
    found = [one.update(moved((0.3, -0.1, -0.01)), 1.0).traction for one in (contact, other)]
    assert np.abs(found[0][:, :2]).max() > 0.0
    assert np.array_equal(*found)


def _dragged(blocks: int, order: int, *, swapped: bool, **of_contact: Any) -> tuple[Floats, int]:
    """A pad that is dragged over a block, or over the joint of two that are tied.

    Returns:
        Forces on the pad at the end of each increment of the drag, (6, 3), and the most corrections
        in one of them.
    """
    boxes = {"pad": BoxSpec((-1.2, -0.5, 0.0), (1.0, 1.0, 0.6), (4, 3, 2), order=order)}
    width = 3.0 / blocks
    names = [f"block{i}" for i in range(blocks)]
    for i, name in enumerate(names):
        origin, size = (-1.5 + i * width, -0.8, -0.8), (width, 1.6, 0.8)
        boxes[name] = BoxSpec(origin, size, (10 // blocks, 4, 3))
    model = build_box(boxes)
    sides = [("pad.bottom", f"{name}.top") for name in names]
    contacts = [
        Contact(
            model, *(side[::-1] if swapped else side), _law((0.4, 0.2)), name=name, **of_contact
        )
        for name, side in zip(names, sides, strict=True)
    ]
    of = {name: make_material("neo-hookean", E=6.0 * E, nu=NU) for name in names}
    of["pad"] = make_material("neo-hookean", E=2.0 * E, nu=NU)
    ties = [Tie("block0.right", "block1.left")] if blocks == 2 else []
    problem = Problem(model, of, contacts, ties=ties)
    held = {f"{name}.bottom": {"x": 0.0, "y": 0.0, "z": 0.0} for name in names}
    steps = [
        Step("press", 3, held | {"pad.top": {"x": 0.0, "y": 0.0, "z": -0.03}}),
        Step("drag", 6, {"pad.top": {"x": 0.45, "y": 0.05, "z": -0.03}}),
    ]
    forces, most = [], 0
    for done in Solver(problem, steps).run():
        if done.step == "drag":
            sign = -1.0 if swapped else 1.0
            forces.append(sign * sum(one.resultant()[0] for one in contacts))
            most = max(most, done.iterations)
    return np.array(forces), most


EXACT = {"mortar": True, "augmentation": Augmentation()}
PHYSICAL = {"mortar": True, "augmentation": Augmentation(tangential=False)}


#: Contacts, and whether the blocks are their slaves.
JOINTS = [
    pytest.param(EXACT, False, id="exact nodes"),
    pytest.param(EXACT, True, id="exact nodes of blocks"),
    pytest.param({"mortar": True}, False, id="nodes"),
    pytest.param({"mortar": True}, True, id="nodes of blocks"),
    # points of the blocks would be told that the pad ends within their facets
    pytest.param({"mortar": False}, False, id="points"),
]


def _check_joint(order: int, of_contact: dict[str, Any], swapped: bool) -> None:
    one, _ = _dragged(1, order, swapped=swapped, **of_contact)
    two, most = _dragged(2, order, swapped=swapped, **of_contact)
    ratio, wanted = (
        np.linalg.norm(force[:, :2], axis=1) / np.abs(force[:, 2]) for force in (two, one)
    )
    np.testing.assert_allclose(ratio, wanted, rtol=0.01)
    along, wanted = (np.arctan2(force[:, 1], force[:, 0]) for force in (two, one))
    np.testing.assert_allclose(along, wanted, atol=0.01)
    assert most <= 12


@pytest.mark.parametrize(("of_contact", "swapped"), JOINTS)
@pytest.mark.parametrize("order", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_a_joint_of_two_blocks_is_not_felt(
    order: int, of_contact: dict[str, Any], swapped: bool
) -> None:
    """A pad dragged over the joint of two tied blocks, a third of a facet in an increment.

    Source: the same pad on one block. Requirement: friction over the pressure within 1 % of it in
    every increment, and its direction within 0.01 rad; at most 12 corrections in one. Without the
    way beyond the border friction is up to 21 % low in the increments in which points come.
    """
    _check_joint(order, of_contact, swapped)


@pytest.mark.parametrize("swapped", [False, True], ids=["pad", "blocks"])
def test_a_joint_under_physical_adhesion(swapped: bool) -> None:
    """The same of nodes that adhesion holds and multipliers press, order 1.

    Nodes of order 2 hover over the second block before they touch it: those that close a gap carry
    friction from the next increment on, see the page on the interface model.
    """
    _check_joint(1, PHYSICAL, swapped)


def test_friction_that_is_left_out_is_told() -> None:
    """Increments in which a pad that comes over a corner lacks friction have a warning, no other.

    Requirement: where iterations with the slip of points that come over the border fail, others
    leave their friction out, and the user hears how much of the normal force that concerns.
    Source: friction over the normal force does not change in steady sliding; where points with a
    share s of the normal force have none it is (1 - s) of that. Tolerance: 0.04, twice the scatter
    of 0.42 to 0.44 before any is left out.
    """
    law = _law((0.4, 0.2))
    pad = BoxSpec((-0.8, -0.8, 0.0), (1.0, 1.0, 0.4), (3, 3, 1), order=2)
    plate = BoxSpec((0.0, 0.0, -0.5), (2.0, 2.0, 0.5), (5, 5, 1), order=2)
    model = build_box({"pad": pad, "plate": plate})
    contact = Contact(model, "pad.bottom", "plate.top", law, augmentation=Augmentation())
    material = make_material("neo-hookean", E=200.0, nu=NU)
    problem = Problem(model, {"pad": material, "plate": material}, [contact])
    held = {"plate.bottom": dict.fromkeys("xyz", 0.0)}
    press = held | {"pad.top": {"x": 0.0, "y": 0.0, "z": -0.02}}
    drag = held | {"pad.top": {"x": 0.5, "y": 0.4, "z": -0.02}}
    found = []
    for accepted in Solver(problem, [Step("press", 2, press), Step("drag", 6, drag)]).run():
        force = contact.resultant()[0]
        ratio = float(np.linalg.norm(force[:2]) / abs(force[2]))
        told = accepted.without_slip.get(contact.name)
        found.append((ratio, 0.0 if told is None else told.share))
        if told is not None:
            (line,) = (one for one in IncrementWarnings().of(accepted) if "border" in one)
            assert f"{told.count} slave point" in line and f"{told.share:.2g}" in line
            break
    ratios, shares = np.array(found[2:]).T
    assert (shares > 0.0).any() and (shares == 0.0).any()
    steady = float(ratios[shares == 0.0].mean())
    assert ratios == pytest.approx((1.0 - shares) * steady, abs=0.04)


@pytest.mark.parametrize(
    ("way", "mortar", "told"),
    [
        ((0.7, 0.0, 0.0), True, True),
        ((0.7, 0.0, 0.0), False, True),
        ((0.25, 0.0, 0.0), True, False),
        ((0.0, 0.0, -0.7), True, False),
        ((0.1, 0.0, -0.7), True, True),
        ((0.1, 0.0, -0.3), True, False),
    ],
)
def test_points_from_afar_are_told(way: tuple[float, ...], mortar: bool, told: bool) -> None:
    """A pad that comes from farther than twice the size of its facets lacks friction: it is told.

    Requirement: the share of the normal force that has no friction, and no word where points come
    from nearer or straight down. Source: nothing says how points have slid that the search did not
    reach when the increment began, see the page on the interface model; all others slide, with
    friction 0.3. Tolerance: 0.01, of which nothing is said.
    """
    down = way[2]
    start = -0.1 - way[0] if down == 0.0 else 0.3
    pad = BoxSpec((start, 0.3, -0.001 - down), (0.4, 0.4, 0.2), (2, 2, 1))
    plate = BoxSpec((0.0, 0.0, -0.5), (1.0, 1.0, 0.5), (2, 2, 1))
    model = build_box({"pad": pad, "plate": plate})
    law = ContactLaw(
        NormalLaw(penalty=NORMAL), Adhesion(stiffness=NORMAL), Friction(coefficients=0.3)
    )
    contact = Contact(model, "pad.bottom", "plate.top", law, mortar=mortar)
    material = make_material("neo-hookean", E=E, nu=NU)
    problem = Problem(model, {"pad": material, "plate": material}, [contact])
    held = {"plate.bottom": dict.fromkeys("xyz", 0.0)}
    moved = {"pad.top": dict(zip("xyz", way, strict=True))}
    (accepted,) = Solver(problem, [Step("come", 1, held | moved)]).run()
    force = contact.resultant()[0]
    lacking = accepted.without_slip.get(contact.name)
    assert (lacking is not None) == told
    if told:
        (line,) = (one for one in IncrementWarnings().of(accepted) if "no friction" in one)
        assert "twice the size of their facets" in line
    if way[0] != 0.0:
        share = 0.0 if lacking is None else lacking.share
        ratio = np.linalg.norm(force[:2]) / abs(force[2])
        assert ratio == pytest.approx(0.3 * (1.0 - share), abs=0.01)
