"""Wrong arguments in a script: one line that names the argument, what was given, what is needed."""

from __future__ import annotations

import re
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from mpi4py import MPI

import anisocontact
from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError, RunWarning
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.bulk import UserEnergy, make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Body,
    BoxSpec,
    Model,
    build_box,
    make_shape,
    node_near,
    nodes_along,
    read_gmsh,
)
from anisocontact.point import DeadLoad, PrescribedPath
from anisocontact.rigid import RigidBody
from anisocontact.solver import ContactProblem, Problem, Solver, Step, Until
from anisocontact.surfaces import make_surface

from dolfinx.mesh import create_unit_cube, meshtags

PLANE = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
LAWS = (
    NormalLaw(penalty=1e3),
    Adhesion(stiffness=(10, 10)),
    Friction(coefficients=(0.3, 0.3)),
)
INTERFACE, PAIR = Interface(PLANE, *LAWS), ContactLaw(*LAWS)
START = INTERFACE.initial_state([[0, 0, 0]])
KNOTS = [(0, 0, 0), (1, 0, 0)]
STEEL = make_material("linear-elastic", E=1.0, nu=0.3)


HELD = {f"{body}.top": {"x": 0.0, "y": 0.0, "z": 0.0} for body in ("block", "base")}


def held(model: Model) -> Problem:
    """Bodies of steel without contact."""
    return Problem(model, dict.fromkeys(model.body_names(), STEEL))


def _tags_of_another_mesh() -> object:
    other = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))}).mesh
    one = np.ones(1, dtype=np.int32)
    return meshtags(other, 2, one, one)


def _space(kind: type = np.float64) -> Any:
    return fem.functionspace(create_unit_cube(MPI.COMM_WORLD, 1, 1, 1, dtype=kind), ("P", 1, (3,)))


def _finer(u: Any) -> Any:
    return fem.functionspace(u.function_space.mesh, ("P", 2, (3,)))


def _script(residual: Any, with_j: bool = False) -> object:
    u = fem.Function(_space())
    form = residual(u, ufl.TestFunction(u.function_space))
    return ContactProblem(form, u, J=form if with_j else None)


def _touching(residual: Any, model: Model) -> object:
    u = fem.Function(model.space)
    contact = Contact(model, "block.bottom", PLANE, Friction(coefficients=0.3))
    return ContactProblem(residual(u, ufl.TestFunction(model.space)), u, contacts=[contact])


@pytest.fixture(scope="module")
def model() -> Model:
    lower = BoxSpec((0, 0, -1), (1, 1, 1), (1, 1, 1))
    return build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1)), "base": lower})


UP = (0, 0, 1)

WRONG = {
    "another law": (
        lambda m: Interface(PLANE, LAWS[1], LAWS[0], LAWS[2]),
        "normal: Adhesion given, NormalLaw or ContactLaw needed",
    ),
    "a name for a surface": (
        lambda m: Interface("plane", *LAWS),
        "surface: 'plane' given, Surface needed",
    ),
    "points of other states": (
        lambda m: INTERFACE.update(START, [[0, 0, 0], [1, 0, 0]]),
        r"x: an array of shape \(2, 3\) given, \(1, 3\) needed",
    ),
    "a word for the point of a moment": (
        lambda m: Contact(m, "block.bottom", PLANE, LAWS[2]).resultant("middle"),
        "about: 'middle' given, an array of real numbers needed",
    ),
    "threads below one": (
        lambda m: Interface(PLANE, *LAWS, threads=-1),
        "threads: -1 given, must be > 0",
    ),
    "threads of a projection below one": (
        lambda m: PLANE.project([[0, 0, 1]], threads=0),
        "threads: 0 given, must be > 0",
    ),
    "a node of a name": (
        lambda m: node_near("block", "block", (0, 0, 0)),
        "model: no Model given",
    ),
    "nodes of no mesh": (
        lambda m: nodes_along(None, "block", (0, 0, 0), (1, 0, 0)),
        "model: no Model given",
    ),
    "numbers for states": (
        lambda m: INTERFACE.update(np.zeros((1, 4)), [[0, 0, 0]]),
        "state: no states given",
    ),
    "words for points": (
        lambda m: INTERFACE.update(START, [["a", 0, 0]]),
        "x: .* given, an array of numbers needed",
    ),
    "points of which some are masked": (
        lambda m: INTERFACE.update(START, np.ma.array([[0, 0, -1.0]], mask=[[0, 0, 1]])),
        "x: an array with masked entries given, an array of numbers needed",
    ),
    "starting points of which some are masked": (
        lambda m: INTERFACE.initial_state(np.ma.array([[0, 0, -1.0]], mask=[[0, 0, 1]])),
        "an array with masked entries given, an array of",
    ),
    "pull on a point": (
        lambda m: PrescribedPath(KNOTS, pressure=-1.0),
        "pressure: -1 given, must be >= 0",
    ),
    "pull after a while": (
        lambda m: PrescribedPath(KNOTS, pressure=lambda t: 1.0 - 2.0 * t).pressure(1.0),
        "pressure: the function gives -1 at time 1, must be >= 0",
    ),
    "a list for a vector": (
        lambda m: Step("a", 1, {"block.top": [1, 2, 3]}),
        r"displacement.block.top: \[1, 2, 3\] given, values by axis needed",
    ),
    "a number for a motion": (
        lambda m: Step("a", 1, motion={"die": 0.1}),
        "motion.die: 0.1 given, values by axis needed",
    ),
    "no name of a step": (lambda m: Step("", 1), "name: '' given, a name of one letter or more"),
    "a body with a dot": (
        lambda m: Body("a.b", make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(1, 1, 1))),
        "name: 'a.b' given, a name without a dot needed",
    ),
    "no path": (lambda m: read_gmsh(None), "path: None given, .* needed"),
    "a folder for a file": (lambda m: read_gmsh("/"), "mesh file '/' is a folder"),
    "next to no friction along one axis": (
        lambda m: Friction(coefficients=(1e-60, 0.1)),
        r"coefficients: \(1e-60, 0.1\) given, must be 0, or from 1e-50",
    ),
    "a number for loads": (
        lambda m: Step("a", 1, load={"die": np.nan}),
        "load.die: nan given, values by axis needed",
    ),
    "a table for one number": (
        lambda m: Friction(coefficients=np.zeros((2, 2))),
        r"coefficients: .* given, one or two numbers are needed",
    ),
    "a table for a word": (
        lambda m: make_shape("disc", radius=1.0, cells=(8, 2), part=np.eye(2)),
        r"part: .* given, allowed: whole, half, quarter",
    ),
    "no whole number of cells": (
        lambda m: make_shape("disc", radius=1.0, cells=(8, np.nan)),
        r"cells: \(8, nan\) given, 2 whole numbers are needed",
    ),
    "a number beyond all floats": (
        lambda m: NormalLaw(penalty=10**400),
        r"penalty: 10+\.\.\.0+ given, finite numbers are needed",
    ),
    "a duration beyond all floats": (
        lambda m: Step("a", 1, duration=10**400),
        "duration: int given, a number needed",
    ),
    "one number for a way": (
        lambda m: DeadLoad(force=np.array(3.0), start=(0, 0, 0), pressure=1.0),
        "times: missing; times of start and end are needed",
    ),
    "a group for groups": (
        lambda m: Problem(m, dict.fromkeys(m.body_names(), STEEL), symmetry="block.left"),
        "symmetry: 'block.left' given, a list of texts needed",
    ),
    "one of a list that is something else": (
        lambda m: Problem(m, dict.fromkeys(m.body_names(), STEEL), [STEEL]),
        r"contacts\[0\]: LinearElastic given, Contact needed",
    ),
    "laws without a surface": (
        lambda m: Contact(m, "block.bottom", PAIR, mortar=False),
        "master: ContactLaw given, a text, Surface, Interface or MovingSurface needed",
    ),
    "no law": (
        lambda m: Contact(m, "block.bottom", PLANE),
        "law: nothing given, Friction, ContactLaw or another law needed",
    ),
    "laws with a surface": (
        lambda m: Contact(m, "block.bottom", "base.top", law=INTERFACE, mortar=False),
        "law: Interface given, ContactLaw, Friction, AdhesionAndFriction or PythonLaw needed",
    ),
    "no degree on a plane": (
        lambda m: Contact(m, "block.bottom", INTERFACE, degree=0),
        "degree: 0 given, must be >= 1",
    ),
    "no degree on facets": (
        lambda m: Contact(m, "block.bottom", "base.top", law=PAIR, degree=-1),
        "degree: -1 given, must be >= 1",
    ),
    "a word for yes or no": (
        lambda m: Contact(m, "block.bottom", INTERFACE, mortar="no"),
        "mortar: 'no' given, True or False needed",
    ),
    "a word for an area": (
        lambda m: Contact(m, "block.bottom", INTERFACE, current_area="reference", mortar=False),
        "current_area: 'reference' given, True or False needed",
    ),
    "a word for a gap": (
        lambda m: Contact(m, "block.bottom", INTERFACE, adjust="all", mortar=False),
        "adjust: 'all' given, a number needed",
    ),
    "half a degree": (
        lambda m: Contact(m, "block.bottom", INTERFACE, degree=2.5),
        "degree: 2.5 given, a whole number needed",
    ),
    "yes for an augmentation": (
        lambda m: Contact(m, "block.bottom", INTERFACE, augmentation=True, mortar=False),
        "augmentation: True given, Augmentation needed",
    ),
    "a name for an idealisation": (
        lambda m: Model.of(m.space, {}, "plane-strain"),
        "idealisation: 'plane-strain' given, Idealisation needed",
    ),
    "tags of another mesh": (
        lambda m: Model.of(m.space, {"pad.sole": 1}, tags=_tags_of_another_mesh()),
        "tags: MeshTags of another mesh than that of the space given",
    ),
    "a facet too far": (
        lambda m: Model.of(m.space, {"pad.sole": np.array([0, 9999], dtype=np.int32)}),
        r"pad.sole: facet 9999 given, the mesh has 0 to \d+",
    ),
    "single precision": (
        lambda m: Model.of(_space(np.float32), {}),
        "space: a mesh of float32 given, float64 needed",
    ),
    "an energy for a residual": (
        lambda m: _script(lambda u, v: ufl.inner(u, u) * ufl.dx),
        "F: a form with 0 arguments given, one with a test function needed",
    ),
    "a stiffness for a residual": (
        lambda m: _script(lambda u, v: ufl.inner(ufl.TrialFunction(u.function_space), v) * ufl.dx),
        "F: a form with 2 arguments given, one with a test function needed",
    ),
    "a residual of something else": (
        lambda m: _script(lambda u, v: ufl.inner(fem.Function(u.function_space), v) * ufl.dx),
        "F: does not depend on u: the residual at the function u needed",
    ),
    "a residual of the wrong sign": (
        lambda m: _touching(lambda u, v: -ufl.inner(ufl.grad(u), ufl.grad(v)) * ufl.dx, m),
        "F: a stiffness of -",
    ),
    "a residual that is no number": (
        lambda m: _touching(lambda u, v: ufl.inner(ufl.sqrt(u[0] - 1.0) * u, v) * ufl.dx, m),
        "F: a stiffness of nan at contact 'block.bottom'",
    ),
    "a test function of another space": (
        lambda m: _script(lambda u, v: ufl.inner(u, ufl.TestFunction(_finer(u))) * ufl.dx),
        "F: its test function is of another space than u",
    ),
    "a residual for its derivative": (
        lambda m: _script(lambda u, v: ufl.inner(u, v) * ufl.dx, with_j=True),
        "J: a form with 1 arguments given, one with a test function and a trial function needed",
    ),
    "an energy of a negative modulus": (
        lambda m: UserEnergy(lambda F: ufl.inner(F, F), young=-1.0),
        "young: -1.0 given, Young's modulus at rest needed, > 0",
    ),
    "a complex number": (
        lambda m: make_surface("plane", point=np.array([0.0, 1j, 0.0]), normal=(0, 0, 1)),
        "point: .* given, three numbers are needed",
    ),
    "a set, which has no order": (
        lambda m: make_surface("plane", point=(0, 0, 0), normal={0, 1, 2}),
        "normal: {0, 1, 2} given, three numbers are needed",
    ),
    "a masked number": (
        lambda m: make_surface("plane", point=np.ma.masked_array([0.0] * 3, [0, 1, 0]), normal=UP),
        "point: .* given, three numbers are needed",
    ),
    "masked numbers in a list": (
        lambda m: make_directions("polar", axis=np.ma.masked_less(np.eye(3)[:2], 0.5)),
        "axis: .* given, a point and a direction",
    ),
    "an event that is never reached": (
        lambda m: Until(reaction="block.top", value=np.inf),
        "until.value: inf given, a finite number needed",
    ),
    "a table for a state": (
        lambda m: Solver(held(m), [Step("a", 1, HELD)]).restore({}),
        "kept: {} given, Persistent needed",
    ),
    "nothing to solve": (lambda m: Solver(held(m), []), "steps: no step given, one or more needed"),
    "a number for what is called": (
        lambda m: Solver(held(m), [Step("a", 1, HELD)]).run(on_iteration=3),
        "on_iteration: 3 given, a function needed",
    ),
    "no number for a motion": (
        lambda m: RigidBody("die", reference=(0, 0, 0)).move(x=float("nan")),
        "x: nan given, needs a finite number",
    ),
}


@pytest.mark.parametrize("call", WRONG)
def test_wrong_argument(model, call):
    wrong, says = WRONG[call]
    with pytest.raises(InputError, match=says) as caught:
        wrong(model)
    assert "\n" not in str(caught.value)


def test_what_is_done_is_said(model):
    """Requirement: a run that has nothing left to solve is no silence."""
    solver = Solver(held(model), [Step("a", 1, HELD)])
    assert len(list(solver.run())) == 1
    with pytest.warns(RunWarning, match="all steps are done: nothing is left to solve"):
        assert not list(solver.run())


def test_solvers_that_take_turns_are_refused(model):
    """Requirement: two runs of one problem, as of two cells of a notebook, do not mix their steps;
    one after the other they go, and one that was left goes on as long as it is alone."""
    problem, steps = held(model), [Step("a", 2, HELD), Step("b", 1, HELD)]
    first, second = (Solver(problem, steps) for _ in range(2))
    next(first.run()), next(first.run())
    assert len(list(second.run())) == 3
    with pytest.raises(InputError, match="problem: another solver has begun a step of it since"):
        list(first.run())
    assert len(list(Solver(problem, steps).run())) == 3


def test_what_holds_arrays_is_compared_as_an_object():
    """Requirement: `==` of what scripts are given is an answer, where NumPy has none for arrays."""
    response = INTERFACE.update(START, [[0, 0, -1.0]])
    assert response != INTERFACE.update(START, [[0, 0, -1.0]])
    arrays = {"Floats", "Ints", "Flags", "Codes", "State"}
    for name in anisocontact.__all__:
        made = getattr(anisocontact, name)
        if is_dataclass(made) and any(
            arrays & set(re.findall(r"\w+", f.type)) for f in fields(made)
        ):
            assert made.__eq__ is object.__eq__, name
