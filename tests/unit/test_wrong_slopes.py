"""A law in Python whose derivatives are wrong is named where an increment fails."""

from __future__ import annotations

import re

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact import Contact, ContactLaw, ContactProblem, NormalLaw, PythonLaw, make_surface
from anisocontact.base.fenicsx import fem, ufl
from anisocontact.base.limits import Limits
from anisocontact.bulk import LinearElastic
from anisocontact.interface import LawKinematics, LawResult, LawState
from anisocontact.interface.wrong_slopes import wrong_slopes
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step
from anisocontact.solver.stepping.report import StoppedError

K, MU = 1e3, 0.3


class Radial:
    """Radial return with isotropic coefficients; `factors` of its blocks are wrong if not 1."""

    internal = 0

    def __init__(self, kind=np.float64, **factors):
        self.kind, self.factors = kind, factors

    def update(self, state, kinematics):
        n, eye = len(kinematics.pressure), np.eye(2)
        trial = state.traction - K * kinematics.increment
        size = np.maximum(np.linalg.norm(trial, axis=1), 1e-300)
        limit = MU * kinematics.pressure
        slides, along = size > limit, trial / size[:, None]
        cross = eye - along[:, :, None] * along[:, None, :]
        force = np.where(slides[:, None], limit[:, None] * along, trial).astype(self.kind)
        block = np.where(slides[:, None, None], (limit / size)[:, None, None] * cross, eye)
        slip = np.where(slides[:, None], kinematics.increment + (force - state.traction) / K, 0.0)
        by_pressure = np.where(slides[:, None], MU * along, 0.0)
        blocks = {
            "increment": -K * block,
            "pressure": by_pressure,
            "traction": block,
            "elastic": np.zeros((n, 2, 2)),
        }
        return LawResult(
            force.astype(float),
            slip,
            **{f"d_{name}": self.factors.get(name, 1.0) * b for name, b in blocks.items()},
            internal=state.internal,
            dissipation=-np.sum(force * slip, axis=1),
            energy=np.sum(force**2, axis=1) / (2.0 * K),
        )


def _points(n=200):
    """Points that stick, slide, and are on the limit within the differences."""
    rng = np.random.default_rng(1)
    pressure = rng.uniform(0.1, 10.0, n)
    stored = rng.uniform(-1.0, 1.0, (n, 2)) * (MU * pressure / np.sqrt(2.0))[:, None]
    increment = rng.uniform(-2e-3, 2e-3, (n, 2))
    increment[::4] = stored[::4] / K * (1.0 - MU * pressure / np.hypot(*stored.T))[::4, None]
    state = LawState(stored, 1e-4 * rng.normal(size=(n, 2)), np.zeros((n, 0)))
    none = np.zeros((n, 2))
    return state, LawKinematics(increment, pressure, -1e-3 * pressure, none, 1.0)


@pytest.mark.parametrize("kind", [np.float64, np.float32])
def test_right_derivatives_are_not_blamed(kind):
    """Requirement: neither at the limit of friction nor by rounding in single precision."""
    assert wrong_slopes(Radial(kind), *_points()) == ""
    at_rest = LawState(*np.zeros((2, 3, 2)), np.zeros((3, 0)))
    still = LawKinematics(np.zeros((3, 2)), np.ones(3), np.zeros(3), np.zeros((3, 2)), 1.0)
    assert wrong_slopes(Radial(kind), at_rest, still) == ""


@pytest.mark.parametrize("name", ["increment", "pressure", "traction"])
@pytest.mark.parametrize("factor", [-1.0, 0.0, 1.2])
def test_each_wrong_derivative_is_named(name, factor):
    """Requirement: the block, what it is and what it should be."""
    said = wrong_slopes(Radial(**{name: factor}), *_points())
    given, found = map(float, re.findall(rf"returns (\S+) in d_{name} .* give (\S+),", said)[0])
    assert given == pytest.approx(factor * found, rel=0.02)


def test_a_law_that_remembers_is_named():
    """Requirement: an answer that depends on how often it is asked is no function of the input."""

    class Counts(Radial):
        asked = 0

        def update(self, state, kinematics):
            self.asked += 1
            found = super().update(state, kinematics)
            return LawResult(**vars(found) | {"traction": self.asked * found.traction})

    assert "Counts gives another traction for the same input" in wrong_slopes(Counts(), *_points())


def _contact(model, law, exact):
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    tangential = PythonLaw(law)
    laws = tangential if exact else ContactLaw(NormalLaw(penalty=1e3), tangential)
    return Contact(model, "pad.bottom", plane, laws)


@pytest.mark.parametrize("exact", [True, False])
@pytest.mark.parametrize("increment", [1.0, -1.0])
def test_the_line_of_a_failure_in_a_case(exact, increment):
    """Requirement: it is said with a failure, and not where another thing is in the way.

    One correction does not find sliding even with right derivatives.
    """
    model = build_box({"pad": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    contact = _contact(model, Radial(increment=increment), exact)
    problem = Problem(model, {"pad": LinearElastic(E=100.0, nu=0.3)}, [contact])
    down = {"pad.top": {"x": 0.02, "y": 0, "z": -0.01}}
    steps, few = [Step("press", 1, displacement=down)], {"snes_max_it": 1}
    solver = Solver(problem, steps, options=few, limits=Limits(cuts=0))
    with pytest.raises(StoppedError) as stopped:
        list(solver.run())
    named = "the law Radial returns" in str(stopped.value)
    assert named == (increment < 0.0)


def test_the_line_of_a_failure_in_a_script():
    """Requirement: as in cases."""
    model = build_box({"pad": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    contact = _contact(model, Radial(increment=-1.0), exact=True)
    u, v = fem.Function(model.space), ufl.TestFunction(model.space)
    form = 100.0 * ufl.inner(ufl.sym(ufl.grad(u)), ufl.grad(v)) * ufl.dx
    down = fem.Constant(model.mesh, (0.02, 0.0, -0.01))
    top = fem.dirichletbc(down, model.nodes("pad.top"), model.space)
    few = {"snes_max_it": 1}
    problem = ContactProblem(form, u, bcs=[top], contacts=[contact], petsc_options=few)
    said = r"; contact 'pad\.bottom': the law Radial returns \S+ in d_increment where differences"
    with pytest.raises(RuntimeError, match=said):
        problem.solve()
