"""Bodies stay in front of their masters."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from anisocontact.anisotropy import make_directions
from anisocontact.base.fenicsx import Vec
from anisocontact.base.limits import Limits
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.contact.side_of_master import SideOfMaster
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import Problem, Solver, Spring, Step, StoppedError
from anisocontact.solver.strategies.newton import Newton, NewtonResult
from anisocontact.solver.system.culprit import Culprit
from anisocontact.solver.system.sides_kept import SidesKept
from anisocontact.surfaces import make_surface

type Floats = np.ndarray[Any, np.dtype[np.float64]]
type Move = Callable[[Floats], Floats]

MU, ANGLE = (0.2, 0.4), np.radians(30.0)
CLAMP = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}


def _laws(unit: float = 1.0, mu: tuple[float, float] = MU) -> tuple[NormalLaw, Adhesion, Friction]:
    axes = make_directions("constant", vector=(1, 0, 0), angle=ANGLE)
    return (
        NormalLaw(penalty=1e4 / unit),
        Adhesion(stiffness=(1e4 / unit, 1e4 / unit)),
        Friction(coefficients=mu, directions=axes),
    )


def _problem(
    master: str,
    unit: float = 1.0,
    cell: str = "hexahedron",
    order: int = 1,
    mu: tuple[float, float] = MU,
    law: str = "neo-hookean",
) -> Problem:
    """A block of unit size that stands at z = 0 on a master of this kind."""
    size = (unit, unit, unit)
    boxes = {"block": BoxSpec((0, 0, 0), size, (2, 2, 2), cell, order)}
    meshed = master.startswith("plate")
    thick = 0.05 * unit
    if meshed:
        corner = (-unit, -unit, -thick)
        boxes["base"] = BoxSpec(corner, (3 * unit, 3 * unit, thick), (6, 6, 1), cell, order)
    model = build_box(boxes)
    material = make_material(law, E=1000.0, nu=0.3)
    contact = _contact(model, master, unit, mu)
    return Problem(model, dict.fromkeys(boxes, material), [contact])


def _contact(model: Model, master: str, unit: float, mu: tuple[float, float]) -> Contact:
    laws = _laws(unit, mu)
    if master == "plate":
        return Contact(model, "block.bottom", "base.top", law=ContactLaw(*laws), mortar=False)
    if master == "plate at slave nodes":
        return Contact(model, "block.bottom", "base.top", law=ContactLaw(*laws), mortar=True)
    if master == "plane":
        surface = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        return Contact(model, "block.bottom", Interface(surface, *laws), mortar=False)
    centre = (0.5 * unit, 0.5 * unit, -0.4 * unit)
    roll = make_surface("cylinder", point=centre, axis=(0, 1, 0), radius=0.4 * unit)
    body = RigidBody("roll", centre) if master == "rigid roll" else None
    law = Interface(roll, *_laws(unit)[:2], Friction(coefficients=0.3))
    return Contact(model, "block.bottom", MovingSurface(law, body), mortar=False)


def _state(problem: Problem, move: Move) -> Vec:
    """All unknowns with the block moved and the rest where it was."""
    x = problem.new_vector()
    places = problem.model.space.tabulate_dof_coordinates()
    block = places[:, 2] > -1e-9 * np.ptp(places[:, 2])
    if "base" in problem.model.body_names():
        base = problem.model.space.dofmap.list[problem.model.cells("base")]
        block[np.unique(base)] = False
    u = np.zeros_like(places)
    u[block] = move(places[block]) - places[block]
    x.array[:] = u.reshape(-1)
    return x


def _said(problem: Problem, move: Move) -> str:
    x = _state(problem, move)
    problem.begin(Step("any", 1, CLAMP if "base" in problem.model.body_names() else {}))
    problem.set_load_factor(1.0, 1.0)
    found = problem.behind_a_master(x)
    problem.roll_back()
    return "" if found is None else f"{found.contact}: {found.why}"


def _turned(degrees: float, unit: float = 1.0, sink: float = 1e-3) -> Move:
    """Turned about the line y along one side of the bottom, and pressed in a little."""

    def move(x: Floats) -> Floats:
        turn = Rotation.from_rotvec([0.0, np.radians(degrees), 0.0])
        edge = np.array([unit, 0.0, 0.0])
        return np.asarray(turn.apply(x - edge) + edge - [0.0, 0.0, sink * unit])

    return move


def _shifted(*by: float) -> Move:
    return lambda x: x + np.array(by)


MASTERS = ("plane", "plate", "plate at slave nodes")


@pytest.mark.parametrize("master", MASTERS)
@pytest.mark.parametrize("unit", [1.0, 1e6])
def test_a_block_that_has_turned_over(master: str, unit: float) -> None:
    """Upside down below its master, with the slave's facets pressed from behind.

    Requirement: a state in balance of this kind is none; it is told with body, contact and how far
    behind. Source: a face in contact faces its master. The block is as high as one unit.
    """
    problem = _problem(master, unit)

    def over(x: Floats) -> Floats:
        return np.asarray(x * [1.0, -1.0, -1.0] + [0.0, unit, 1e-3 * unit * -1.0])

    said = _said(problem, over)
    assert "block.bottom: body 'block' has turned over: " in said
    assert f"the farthest of it {unit:.3g} behind" in said


@pytest.mark.parametrize("master", MASTERS)
def test_a_block_that_has_sunk_in(master: str) -> None:
    """Pressed into its master by 0.7 of its height, against a penalty that holds it there."""
    said = _said(_problem(master), _shifted(0, 0, -0.7))
    assert "body 'block' is behind its master with 67% of it, the farthest of it 0.7 behind" in said


@pytest.mark.parametrize("master", MASTERS)
def test_a_block_of_which_the_face_alone_is_known(master: str) -> None:
    """The same with displacements at the nodes that can be touched, as `condensed` has them.

    Requirement: the same words, whatever stands at the other nodes, and none where it may be.
    """
    for move, said in (
        (_shifted(0, 0, -0.7), "with 67% of it, the farthest of it 0.7"),
        (_turned(20.0), ""),
    ):
        problem = _problem(master)
        x = _state(problem, move)
        problem.begin(Step("any", 1, CLAMP if "base" in problem.model.body_names() else {}))
        problem.set_load_factor(1.0, 1.0)
        problem.behind_a_master(x)
        u = problem.nodal.copy()
        inside = np.ones(len(u), dtype=bool)
        inside[problem.contacts[0].couplable()] = False
        u[inside] = 5.0
        found = problem.sides.objection(u, whole=False)
        assert said in ("" if found is None else found.why)
        assert (found is None) == (said == "")


def test_a_slab_that_a_ball_dents_is_not_behind_it() -> None:
    """A ball pressed into a slab by a quarter of its height, where the top alone is known.

    Requirement: nothing is said. A rigid slab that went with its top would have its middle behind
    the ball, by 0.07 of its size; where it is, no node is, but by the tolerance of multipliers.
    """
    model = build_box({"slab": BoxSpec((0, 0, 0), (1, 1, 0.4), (4, 4, 2))})
    ball = RigidBody("ball", (0.5, 0.5, 1.1))
    surface = make_surface("sphere", centre=ball.reference, radius=0.7)
    contact = Contact(
        model, "slab.top", MovingSurface(surface, ball), law=Friction(coefficients=0.3)
    )
    material = make_material("linear-elastic", E=100.0, nu=0.0)
    problem = Problem(model, {"slab": material}, [contact])
    press = Step(
        "press", 4, {"slab.bottom": dict.fromkeys("xyz", 0.0)}, motion={"ball": {"z": -0.1}}
    )
    states = list(Solver(problem, [press], strategy="condensed").run())
    assert [one.behind for one in states] == [()] * 4


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
def test_a_block_that_sinks_in_is_not_done(strategy: str) -> None:
    """A force of 0.4 on a block of unit size; a penalty balances it 0.8 behind its master."""
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
    surface = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    laws = NormalLaw(penalty=0.5), Adhesion(stiffness=(0.5, 0.5)), Friction(coefficients=(0.0, 0.0))
    contact = Contact(model, "block.bottom", Interface(surface, *laws), mortar=False)
    material = make_material("linear-elastic", E=10.0, nu=0.3)
    hold = Spring("hold", "block.top", (0.0, 0.0, 1e-3))
    problem = Problem(model, {"block": material}, [contact], [hold])
    press = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0}}, force={"block.top": {"z": -0.4}})
    limits = Limits(smallest=1.0)
    with pytest.raises(StoppedError, match=r"body 'block' is behind its master with \d+% of it"):
        list(Solver(problem, [press], limits=limits, strategy=strategy).run())


@pytest.mark.parametrize("master", MASTERS)
def test_a_block_that_swings_through(master: str) -> None:
    """Tipped over an edge by 150 degrees: it hangs by that edge, its bottom above the master."""
    said = _said(_problem(master), _turned(150.0, sink=0.2))
    assert "body 'block' has turned over: " in said


@pytest.mark.parametrize("master", [*MASTERS[1:], "roll", "rigid roll"])
@pytest.mark.parametrize(("cell", "order"), [("hexahedron", 1), ("tetrahedron", 2)])
def test_a_block_that_has_gone_through(master: str, cell: str, order: int) -> None:
    """In one increment from above a thin plate, or a roll, to below: free of it on the other side.

    Requirement: the way of the points tells it, the closest point does not.
    """
    problem = _problem(master, cell=cell, order=order)
    assert "body 'block' has gone through its master: " in _said(problem, _shifted(0, 0, -2.5))


def _around(degrees: float) -> Move:
    """Turned about the axis of the roll."""

    def move(x: Floats) -> Floats:
        turn = Rotation.from_rotvec([0.0, np.radians(degrees), 0.0])
        axis = np.array([0.5, 0.0, -0.4])
        return np.asarray(turn.apply(x - axis) + axis)

    return move


ALLOWED: dict[str, tuple[tuple[str, ...], Move]] = {
    "pressed": (MASTERS, _shifted(0, 0, -0.01)),
    "lifted": (MASTERS, _shifted(0, 0, 3.0)),
    "tipped": (MASTERS, _turned(40.0)),
    "on its side": (MASTERS, _turned(89.0, sink=-1e-3)),
    "over an edge of the plate": (MASTERS[1:], _shifted(1.6, 0, -1e-3)),
    "beside the plate": (MASTERS[1:], _shifted(2.5, 0, -1e-3)),
    "around the roll": (("roll", "rigid roll"), _around(170.0)),
    "around it backwards": (("roll", "rigid roll"), _around(-100.0)),
}


@pytest.mark.parametrize("name", list(ALLOWED))
def test_where_a_block_may_be(name: str) -> None:
    """No alarm where bodies press, lift, tip, hang over an edge, lie beside, or go around."""
    masters, move = ALLOWED[name]
    for master in masters:
        assert _said(_problem(master), move) == ""


def test_beneath_the_plate_by_the_way_around() -> None:
    """Off the edge, down beside the plate, and beneath it: nothing is touched, nothing is said."""
    problem = _problem("plate")
    problem.begin(Step("any", 1, CLAMP))
    for by in ((2.5, 0, 0.0), (2.5, 0, -2.0), (0, 0, -2.0)):
        problem.set_load_factor(1.0, 1.0)
        x = _state(problem, _shifted(*by))
        assert problem.behind_a_master(x) is None
        problem.commit(x)


@pytest.mark.parametrize("strategy", ["direct", "iterative"])
def test_a_state_on_the_other_side_is_not_accepted(
    strategy: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A Newton method that turns the block over and calls that equilibrium: the run stops."""
    problem = _problem("plane")
    over = _state(problem, lambda x: x * [1.0, -1.0, -1.0] + [0.0, 1.0, -1e-3]).array.copy()

    def thrown(self: Newton, x: Vec, *_: Any, **__: Any) -> NewtonResult:
        x.array[:] = over
        return NewtonResult(1, [0.0], "")

    monkeypatch.setattr(Newton, "solve", thrown)
    step = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
    said = "contact 'block.bottom': body 'block' has turned over: .* farthest of it 1 behind"
    with pytest.raises(StoppedError, match=said):
        list(Solver(problem, [step], limits=Limits(smallest=0.25)).run())


@pytest.mark.parametrize("master", ["plane", "plate"])
def test_a_block_that_its_load_tips_over(master: str) -> None:
    """A block of unit size under 1 from above and 0.8 from the side, both at its top.

    Requirement: equilibrium ends where the moment of the side load passes that of the weight, half
    of it; friction of 3 holds. The run stops, and says that the block goes over: not what Newton's
    method meets first.
    """
    problem = _problem(master, mu=(3.0, 3.0))
    steps = [
        Step("press", 1, CLAMP if master == "plate" else {}, force={"block.top": {"z": -1.0}}),
        Step("pull", 1, force={"block.top": {"x": 0.8}}),
    ]
    said = "viscous regularisation goes on until body 'block' (has turned|is behind)"
    with pytest.raises(StoppedError, match=said) as stopped:
        list(Solver(problem, steps, limits=Limits(smallest=0.1), strategy="direct").run())
    assert [culprit.kind for culprit in stopped.value.culprits] == ["behind"]


@pytest.mark.parametrize("strategy", ["direct", "condensed"])
def test_every_step_of_a_flow_is_looked_at(strategy: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Linear bodies of which one tips over and flows, said to be behind its master at once.

    Requirement: the flow is given up at its first step with every strategy, which without that
    takes 60 to say that it does not come to rest.
    """
    problem = _problem("plate", mu=(3.0, 3.0), law="linear-elastic")
    steps = [
        Step("press", 1, CLAMP, force={"block.top": {"z": -1.0}}),
        Step("pull", 1, force={"block.top": {"x": 0.8}}),
    ]
    asked: list[bool] = []

    def objection(self: SidesKept, *_: Any, **__: Any) -> Culprit | None:
        asked.append(problem.stabilisation.regularisation.active)
        return Culprit("behind", (0.0, 0.0, 0.0), "body 'block' is behind") if asked[-1] else None

    monkeypatch.setattr(SidesKept, "objection", objection)
    said = "equilibrium is lost, and viscous regularisation goes on until body 'block' is behind"
    with pytest.raises(StoppedError, match=said):
        list(Solver(problem, steps, limits=Limits(smallest=0.25), strategy=strategy).run())
    assert sum(asked) == 1


def test_a_few_points_inside_a_master_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    """One of nine slave points lies inside, which only `SideOfMaster.inside` tells.

    Requirement: the state is refused, and the line says how many points and how deep.
    """
    monkeypatch.setattr(SideOfMaster, "through", lambda self: (np.zeros(0, int), np.zeros(0)))
    place = _shifted(0.0, 0.0, -1e-3)
    assert _said(_problem("plane"), place) == ""
    monkeypatch.setattr(SideOfMaster, "inside", lambda self: (np.array([3]), np.array([0.4])))
    said = _said(_problem("plane"), place)
    assert "has gone through its master: 1 slave points are up to 0.4 behind it" in said


def test_the_first_point_by_its_place_is_named() -> None:
    """Of several that have gone through, the same on any number of processes."""
    sides = _problem("plate").sides
    (watched,) = sides._watched
    x = watched.one.current.points
    order = np.arange(len(x))
    for points in (order, order[::-1], np.roll(order, 5)):
        found = sides._culprit(watched, "it is behind", points)
        assert found.position == tuple(x[np.lexsort(np.round(x, 9).T[::-1])[0]])
