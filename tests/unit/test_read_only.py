"""What was read when it was made is not written into without a word."""

from __future__ import annotations

import copy
import dataclasses
import pickle
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

import anisocontact
from anisocontact.base.errors import InputError


@dataclasses.dataclass
class Made:
    """Things that a script has made, each of others."""

    steel: Any
    metal: Any
    ageing: Any
    friction: Any
    contact: Any
    problem: Any
    solver: Any


@pytest.fixture(scope="module")
def made() -> Made:
    box = anisocontact.make_shape("box", origin=(0, 0, 0), size=(1, 1, 1), cells=(1, 1, 1))
    model = anisocontact.build_mesh([anisocontact.Body("block", box)])
    steel = anisocontact.make_material("linear-elastic", E=210e3, nu=0.3)
    metal = anisocontact.make_material("plastic", E=210e3, nu=0.3, yield_stress=235.0)
    ageing = anisocontact.make_material("viscoelastic", E=1.0, nu=0.3, g=[0.5], tau=[1.0])
    friction = anisocontact.Friction(coefficients=0.3)
    plane = anisocontact.make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = anisocontact.Contact(model, "block.bottom", plane, friction)
    problem = anisocontact.Problem(model, {"block": steel}, [contact])
    step = anisocontact.Step("press", 1, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
    return Made(
        steel, metal, ageing, friction, contact, problem, anisocontact.Solver(problem, [step])
    )


WRITTEN: list[tuple[str, Callable[[Made], None]]] = [
    ("LinearElastic.E: ", lambda made: setattr(made.steel, "E", 70e3)),
    ("LinearElastic.young: ", lambda made: setattr(made.steel, "young", 70e3)),
    ("LinearElastic.nu: ", lambda made: delattr(made.steel, "nu")),
    ("Friction.coefficients: ", lambda made: setattr(made.friction, "coefficients", 0.1)),
    ("Friction.directions: ", lambda made: setattr(made.friction, "directions", None)),
    ("Contact.law: ", lambda made: setattr(made.contact, "law", made.friction)),
    ("Contact.current_area: ", lambda made: setattr(made.contact, "current_area", False)),
    ("Problem.contacts: ", lambda made: setattr(made.problem, "contacts", [])),
    ("Solver.limits: ", lambda made: setattr(made.solver, "limits", anisocontact.Limits())),
    ("read only", lambda made: made.problem.materials.update(block=made.steel)),
    ("Model.order: ", lambda made: setattr(made.problem.model, "order", 2)),
    ("read only", lambda made: made.friction.named[1].update(coefficients=[0.1, 0.1])),
    ("read only", lambda made: made.friction.rule[1].update(history=1.0)),
    ("read only", lambda made: made.contact.surface().named[1].update(point=[0, 0, 1])),
    ("read only", lambda made: made.ageing.history.update(strain=(6,))),
    ("read only", lambda made: made.metal.history.clear()),
]


@pytest.mark.parametrize(("said", "write"), WRITTEN)
def test_nobody_writes_into_what_has_been_read(
    made: Made, said: str, write: Callable[[Made], None]
) -> None:
    """Requirement: a value that nothing would follow is refused, with its name.

    Source: by hand. All of these were taken without a word, and changed nothing.
    """
    with pytest.raises(InputError, match=rf"^{said}.*read only|^read only"):
        write(made)


class Counting(anisocontact.LinearElastic):
    """A material of a script, which counts how often it is asked."""

    def __init__(self, **parameters: float) -> None:
        super().__init__(**parameters)
        self.asked = 0

    def stress(self, u: Any) -> Any:
        self.asked += 1
        return super().stress(u)


def test_classes_of_a_script_write_what_is_their_own(made: Made) -> None:
    """Requirement: what is derived from a class of the package has values of its own, and is told
    of those of the package."""
    counting = Counting(E=210e3, nu=0.3)
    anisocontact.Problem(made.problem.model, {"block": counting})
    assert counting.asked > 0
    with pytest.raises(InputError, match=r"^Counting\.E: read only"):
        counting.E = 70e3  # type: ignore[attr-defined]


def test_a_copy_is_made_of_what_was_given_then() -> None:
    """Requirement: a copy of a law is that law, whatever was written later into what it was given.

    Source: by hand. A copy of an adhesion of 1000 had the 5 that was written into its array.
    """
    stiffness, marks = np.array([1e3, 2e3]), [1.0, 0.0, 0.0]
    directions = anisocontact.make_directions("constant", vector=marks)
    adhesion = anisocontact.Adhesion(stiffness=stiffness, directions=directions)
    stiffness[:], marks[1] = 5.0, 1.0
    for copied in (copy.copy(adhesion), pickle.loads(pickle.dumps(adhesion))):
        assert copied.named[1]["stiffness"] == (1e3, 2e3)
        assert copied.directions.named == adhesion.directions.named


def test_numbers_of_what_was_made_stay(made: Made) -> None:
    """Requirement: nor is a number written into that something was made of.

    Source: by hand. The core had read the first point of a plane by the time a script wrote into
    its list; the `offset` of a solid was that of all meshes.
    """
    named = (made.friction.named, made.contact.surface().named, made.friction.rule)
    for part in (*named, anisocontact.make_directions("constant", vector=[1, 0, 0]).named):
        for numbers in part[1].values():
            with pytest.raises(TypeError, match="does not support item assignment"):
                numbers[0] = 1.0
    body = anisocontact.RigidBody("tool", (0, 0, 0), free=True, springs={"x": 1.0})
    solid, flat = made.problem.model.idealisation, anisocontact.PlaneStrain()
    arrays = (body.reference, body.springs, solid.offset, solid.turn, flat.offset, flat.turn)
    for array in (*arrays, anisocontact.Axisymmetric().turn):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0


def test_what_is_followed_may_be_written(made: Made) -> None:
    """Requirement: methods may be replaced, and what a class lets change; a copy is as its like."""
    made.contact.physical_adhesion = True
    made.problem.predict_contact = made.problem.predict_contact
    for copied in (copy.deepcopy(made.steel), pickle.loads(pickle.dumps(made.steel))):
        assert copied.young == made.steel.young
        with pytest.raises(InputError, match="read only"):
            copied.young = 1.0
