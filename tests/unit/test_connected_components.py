"""Bodies of several pieces that share no nodes: each of them is held, or said not to be."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from anisocontact.base.errors import InputError
from anisocontact.bulk import LinearElastic
from anisocontact.contact import Contact
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Body,
    BoxSpec,
    Model,
    Placement,
    Rotation,
    build_box,
    make_shape,
)
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.connected_components import unjoined_bodies
from anisocontact.mesh.described import SAME
from anisocontact.mesh.merge import merge
from anisocontact.rigid import RigidBody
from anisocontact.solver import CoupledFace, Problem, Solver, Step
from anisocontact.solver.terms.free_modes import bodies
from anisocontact.surfaces import make_surface

PRESS = Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
#: Two cubes and where they begin along x.
PLACES = {"left": 0, "right": 2}


def _arrays(gap: float = 0.0, halves: bool = False) -> MeshArrays:
    """A body that is two cubes on each other, two by two cells each, which share no node.

    The upper half of the upper one is a body of its own if `halves`.
    """
    shapes = [
        make_shape("box", origin=(0, 0, z), size=(1, 1, 1), cells=(2, 2, 2)) for z in (0, 1 + gap)
    ]
    parts = merge([Body(name, shape).arrays() for name, shape in zip("ab", shapes, strict=True)])
    names = {"bottom": "a.bottom", "low": "a.top", "high": "b.bottom", "top": "b.top"}
    facets = {f"block.{name}": parts.facets[of] for name, of in names.items()}
    high = parts.points[parts.cells].mean(axis=1)[:, 2] > (1.5 if halves else np.inf)
    named = {"block": np.flatnonzero(~high), **({"head": np.flatnonzero(high)} if halves else {})}
    if halves:
        facets["head.top"] = facets.pop("block.top")
    return replace(parts, bodies=named, facets=facets)


def _block(gap: float = 0.0, halves: bool = False) -> Model:
    """The model of these."""
    return Model.from_arrays(_arrays(gap, halves))


def _problem(model: Model, slave: str = "block.bottom") -> Problem:
    laws = NormalLaw(penalty=1e3), Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=(0.3, 0.3))
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(model, slave, Interface(plane, *laws))
    return Problem(model, {"block": LinearElastic(E=1e3, nu=0.3)}, [contact])


def test_pieces_are_bodies_of_their_own() -> None:
    """A support of the upper one does not hold the lower one, which contact alone can hold."""
    model = _block()
    lower, upper = bodies(model)
    assert [lower.name, upper.name] == [
        "block, the piece around (0.5, 0.5, 0.5)",
        "block, the piece around (0.5, 0.5, 1.5)",
    ]
    problem = _problem(model)
    Solver(problem, [PRESS])
    problem.begin(PRESS)
    assert [free.body.name for free in problem.stabilisation.loose] == [lower.name]


def test_a_body_beside_a_piece_of_another_is_no_whole() -> None:
    """The upper half of the upper cube shares nodes with one of two pieces of the block."""
    both = _block(halves=True)
    assert [body.name for body in bodies(both)] == [
        "block, the piece around (0.5, 0.5, 0.5)",
        "block + head, the piece around (0.5, 0.5, 1.5)",
    ]


def test_a_piece_that_nothing_holds_is_refused() -> None:
    """A part of the mesh that no support, contact or tie has to do with has no equilibrium."""
    said = r"step 'press': body 'block, the piece around \(0.5, 0.5, 0.5\)' is free to move"
    with pytest.raises(InputError, match=said):
        Solver(_problem(_block(0.1), "block.high"), [PRESS])


@pytest.mark.parametrize("gap", [0.0, 0.1 * SAME, 100.0 * SAME, 0.1])
def test_nodes_that_were_not_joined_are_told(gap: float) -> None:
    """Nine nodes of the upper cube are at the places of others; with a gap none is."""
    cautions = Solver(_problem(_block(gap)), [PRESS]).cautions
    found = [line for line in cautions if "2 pieces that share no node" in line]
    assert len(found) == (gap < SAME)
    assert all("9 nodes of one lie on nodes of another" in line for line in found)


def test_a_slit_in_a_piece_is_no_seam_between_pieces() -> None:
    """Nodes of its two sides are at one place, and of one piece."""
    parts = _arrays(0.1)
    slit = np.flatnonzero((parts.points == (0.5, 0.0, 0.5)).all(axis=1))
    left = parts.points[parts.cells].mean(axis=1)[:, 0] < 0.5
    cells = np.where(left[:, None] & (parts.cells == slit), len(parts.points), parts.cells)
    points = np.concatenate([parts.points, parts.points[slit]])
    model = Model.from_arrays(replace(parts, points=points, cells=cells))
    assert len(bodies(model)) == 2
    assert not unjoined_bodies(model)


def test_pieces_that_are_meant_to_touch_are_not_doubtful() -> None:
    """Nodes of contacts and ties lie on each other by intent."""
    model = _block()
    assert not unjoined_bodies(model, [model.facet_nodes("block.low")])


def test_what_contacts_meet_is_as_loose_as_what_meets_it() -> None:
    """A base that only the block above it touches, as the master of the one contact."""
    upper, lower = (
        BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1)),
        BoxSpec((-1, -1, -1), (3, 3, 1), (1,) * 3),
    )
    model = build_box({"block": upper, "base": lower})
    material = LinearElastic(E=1e3, nu=0.3)
    contact = Contact(model, "block.bottom", "base.top", Friction(coefficients=0.3))
    problem = Problem(model, {"block": material, "base": material}, [contact])
    problem.begin(PRESS)
    assert [free.body.name for free in problem.stabilisation.loose] == ["base"]


def test_bodies_that_follow_one_rigid_body_are_loose_as_one() -> None:
    """Two cubes under a head that nothing holds move with it, not each on its own."""
    boxes = {name: BoxSpec((x, 0, 0), (1, 1, 1), (1, 1, 1)) for name, x in PLACES.items()}
    model = build_box(boxes)
    surface = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    laws = NormalLaw(penalty=1e3), Adhesion(stiffness=(1e3, 1e3)), Friction(coefficients=(0.3, 0.3))
    contacts = [Contact(model, f"{name}.bottom", Interface(surface, *laws)) for name in PLACES]
    head = RigidBody("head", (1.5, 0.5, 1.0), free=True)
    faces = [CoupledFace(f"{name}.top", head) for name in PLACES]
    materials = {name: LinearElastic(E=1e3, nu=0.3) for name in PLACES}
    problem = Problem(model, materials, contacts, coupled=faces)
    free = {"head": {"z": None, "x": None}}
    problem.begin(Step("press", 1, motion=free, load={"head": {"z": -1.0}}))
    assert [free.body.name for free in problem.stabilisation.loose] == ["left + right"]


@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
@pytest.mark.parametrize("order", [1, 2])
def test_a_body_that_is_there_twice_is_told(cell: str, order: int) -> None:
    """Two drums of one body, the second in the first, a little beside it and up by half.

    Requirement: cells that are there twice are counted, also where both are round, and pieces that
    only touch are none. Force and stiffness were twice the right ones, with nothing told. Each drum
    has half of its cells in the other; middles of the next layer are outside by a quarter of it.
    """
    drum = make_shape("cylinder", radius=1.0, length=4.0, cells=(8, 2, 4), cell=cell, order=order)

    def told(up: float) -> list[str]:
        place = Placement(rotate=Rotation((0, 0, 1), 0.1), move=(0.01, 0.0, up))
        both = merge([Body("a", drum).arrays(), Body("b", drum, place).arrays()])
        body = {"block": np.arange(len(both.cells))}
        return unjoined_bodies(Model.from_arrays(replace(both, bodies=body, facets={})))

    (line,) = told(2.0)
    count = len(Body("a", drum).arrays().cells)
    assert line.startswith(f"body 'block': {count} of {2 * count} cells have their middle in anot")
    assert told(4.0 + 1e-3) == []
