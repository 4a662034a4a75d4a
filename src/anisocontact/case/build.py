"""From a case to the problem and the steps of the finite-element level."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import numpy as np

from anisocontact.base.errors import InputError, ModelWarning, within
from anisocontact.base.fenicsx import MPI
from anisocontact.base.limits import Limits
from anisocontact.bulk import Material, materials
from anisocontact.case import objects
from anisocontact.case.contacts import contact
from anisocontact.case.cyclic import CyclicSection
from anisocontact.case.law_file import law_of
from anisocontact.case.load_curves import CaseLoadCurves, cut_paths, idle_amplitudes
from anisocontact.case.loads import BodyForce, Gravity, accelerations
from anisocontact.case.material_file import material_of
from anisocontact.case.mesh import arrays_of, name_nodes
from anisocontact.case.model import MORTAR, Case
from anisocontact.case.petsc_options import check_options
from anisocontact.case.quantity import AUTO
from anisocontact.case.read import CaseFile
from anisocontact.case.steps import steps_of
from anisocontact.case.ties import close_gaps_of
from anisocontact.case.units import doubts
from anisocontact.case.unused import unused
from anisocontact.contact import Contact
from anisocontact.interface import TangentialLaw
from anisocontact.mesh import Model
from anisocontact.results.resultants import check_resultants
from anisocontact.rigid import RigidBody
from anisocontact.solver import (
    CoupledFace,
    CyclicSymmetry,
    ElasticSupport,
    Problem,
    Solver,
    Spring,
    Step,
    Tie,
)


def _at_points(case: Case, problem: Problem) -> Iterator[str]:
    """Contacts that "auto" has put at integration points as there are several processes."""
    count = problem.comm.size
    if count == 1 or problem.model.idealisation.dim == 3:
        return
    for i, section in enumerate(case.contact):
        if section.pass_ == AUTO and section.degree is None:
            yield (
                f"contact[{i}].pass: in two dimensions on {count} processes it is at integration "
                "points, on one at the slave nodes: forces differ, and a run of one process cannot "
                'go on; run on one, or name pass = "single"'
            )


@dataclass(frozen=True)
class Built:
    """What a case describes, ready to run.

    Args:
        file: The case.
        problem: Bodies, contacts and loads.
        steps: Load steps.
        solver: Runs the steps.
        adjusted: What ties have moved in the mesh, a line each.
        torn: Bodies that end where the mesh of their file goes on, a line each.
    """

    file: CaseFile
    problem: Problem
    steps: list[Step]
    solver: Solver
    adjusted: Sequence[str] = ()
    torn: Sequence[str] = ()

    def doubts(self) -> list[str]:
        """What is hardly meant: numbers in the units of the case, times; collective."""
        case, model = self.file.case, self.problem.model
        young = {name: material.young for name, material in self.problem.materials.items()}
        forces = [force for step in case.step for force in step.body_force.values()]
        given = [force for force in forces if force.density != 1.0]
        densities = [force.density for force in given]
        densities += [table.density for table in case.material.values() if table.density]
        weights: list[Gravity | BodyForce] = [*given]
        weights += [step.gravity for step in case.step if step.gravity is not None]
        x = model.mesh.geometry.x
        low, high = x.min(axis=0, initial=np.inf), x.max(axis=0, initial=-np.inf)
        low = np.min(self.problem.comm.allgather(low), axis=0)
        high = np.max(self.problem.comm.allgather(high), axis=0)
        size, gravity = float((high - low).max()), accelerations(weights)
        found = doubts(case.units, young, densities, size, gravity)
        found += [*self.torn, *_untimed(case), *idle_amplitudes(case), *cut_paths(case)]
        found += unused(self.file.text)
        found += _at_points(case, self.problem)
        return found + [
            f'contact[{i}].pass: "{section.pass_}" is "{MORTAR}" from now on; name that'
            for i, section in enumerate(case.contact)
            if section.of_before
        ]


def _untimed(case: Case) -> Iterator[str]:
    """Steps that are given no time beside a material that knows it, by the units of the entries."""
    timed = {e.name for e in materials() if any("time" in p.unit for p in e.parameters)}
    bodies = [name for name, table in case.material.items() if table.chosen["model"] in timed]
    steps = [repr(step.name) for step in case.step if "duration" not in step.model_fields_set]
    if bodies and steps:
        yield (
            f"{bodies[0]} knows time, and no duration is given for {', '.join(steps)}: they take 1"
        )


def build(file: CaseFile, python: bool = True) -> Built:
    """Mesh the bodies and put contacts, loads and solver together.

    Args:
        file: A checked case.
        python: Whether the Python files that the case names are run. Without their laws everything
            else can be checked, and nothing can be solved.

    Returns:
        The problem, its steps and a solver.

    Raises:
        InputError: The mesh is missing or damaged, or lacks a body or group that the case names.

    Example:
        >>> from anisocontact.case import load
        >>> build(load("no-such-case.toml"))
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: case file 'no-such-case.toml' does not exist
    """
    case = file.case
    own = [
        law_of(section, file.resolve, f"contact[{i}]", python)
        for i, section in enumerate(case.contact)
    ]
    arrays = arrays_of(file, MPI.COMM_WORLD)
    model = Model.from_arrays(
        arrays,
        idealisation=objects.idealisation(case),
        touching=[section.slave for section in case.contact],
    )
    for name in case.material:
        model.cells(name, f"material.{name}")
    adjusted = close_gaps_of(case.tie, model)
    name_nodes(case, model)
    materials = {
        name: material_of(section, file.resolve, f"material.{name}", python)
        for name, section in case.material.items()
    }
    bodies = _rigid_bodies(case)
    contacts = _contacts(case, model, materials, bodies, own)
    steps = steps_of(case, model, CaseLoadCurves(case, file.resolve, python))
    check_options(case.solver.options, case.solver.strategy)
    with _faces_by_key(case):
        problem = Problem(
            model,
            materials,
            contacts,
            _attached(case),
            case.symmetry,
            stabilised=case.solver.stabilisation,
            coupled=_faces(case, model, bodies),
            ties=[Tie(**section.given()) for section in case.tie],
            cyclic=[_sector(section, f"cyclic[{i}]") for i, section in enumerate(case.cyclic)],
        )
    _check_output(case, problem, steps)
    return Built(file, problem, steps, _solver(case, problem, steps), adjusted, arrays.torn)


def _contacts(
    case: Case,
    model: Model,
    materials: Mapping[str, Material],
    bodies: Mapping[str, RigidBody],
    laws: Sequence[TangentialLaw | None],
) -> list[Contact]:
    """The contacts, with the rigid bodies that carry their surfaces and the laws of files."""
    carriers = {
        surface: body
        for body in bodies.values()
        for surface in case.rigid[body.name].carries(body.name)
    }
    return [
        contact(case, section, model, materials, carriers, f"contact[{i}]", law)
        for i, (section, law) in enumerate(zip(case.contact, laws, strict=True))
    ]


def _check_output(case: Case, problem: Problem, steps: Sequence[Step]) -> None:
    """Refuse probes beside the mesh and resultants of groups that are not there, or not held."""
    for name, section in case.output.probe.items():
        section.probe().places(problem.model, f"output.probe.{name}")
    wanted = {name: one.resultant() for name, one in case.output.resultant.items()}
    check_resultants(wanted, problem, steps)


def _solver(case: Case, problem: Problem, steps: list[Step]) -> Solver:
    given = case.solver
    with within("solver"):
        limits = Limits(given.smallest_increment, given.largest_increment, given.cuts)
    try:
        with warnings.catch_warnings():  # runs and `check` say the same as lines
            warnings.simplefilter("ignore", ModelWarning)
            return Solver(
                problem, steps, options=given.options, limits=limits, strategy=given.strategy
            )
    except InputError as error:
        table, _, _ = error.field.partition(".")
        if table and table not in type(given).model_fields:  # of a step, a tie, a spring ...
            raise
        with within("solver"):
            raise


def _attached(case: Case) -> list[ElasticSupport | Spring]:
    beds = [
        ElasticSupport(group, bed.normal, bed.tangential)
        for group, bed in case.elastic_support.items()
    ]
    springs = [Spring(name, s.group, s.stiffness, s.to) for name, s in case.spring.items()]
    return [*beds, *springs]


def _rigid_bodies(case: Case) -> dict[str, RigidBody]:
    """The rigid bodies by name; free where a step frees them or faces follow them."""
    freed = {
        name
        for step in case.step
        for name, motion in step.motion.items()
        if None in motion.components().values()
    }
    bodies = {}
    for name, section in case.rigid.items():
        free = name in freed or bool(section.faces)
        with within(f"rigid.{name}"):
            springs = section.springs.given()
            bodies[name] = RigidBody(name, section.reference, free=free, springs=springs)
    return bodies


def _sector(section: CyclicSection, place: str) -> CyclicSymmetry:
    """Cut faces of a sector."""
    with within(place):
        return CyclicSymmetry(**dict(section))


@contextmanager
def _faces_by_key(case: Case) -> Iterator[None]:
    """Name coupled faces by their keys in the case file, where a script names its argument."""
    try:
        yield
    except InputError as error:
        keys = {
            f"coupled.{group}": f"rigid.{name}.faces[{i}]"
            for name, section in case.rigid.items()
            for i, group in enumerate(section.faces)
        }
        if error.field not in keys:
            raise
        raise InputError(error.said, keys[error.field]) from None


def _faces(case: Case, model: Model, bodies: Mapping[str, RigidBody]) -> list[CoupledFace]:
    """Faces that follow rigid bodies."""
    found = []
    for name, section in case.rigid.items():
        for i, group in enumerate(section.faces):
            model.boundary(group, f"rigid.{name}.faces[{i}]")
            found.append(CoupledFace(group, bodies[name]))
    return found
