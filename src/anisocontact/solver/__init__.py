"""Newton's method, load steps and what a run reports."""

from typing import Any

from anisocontact.base.amplitudes import (
    Amplitude,
    amplitudes,
    make_amplitude,
    register_amplitude,
)
from anisocontact.base.limits import Limits
from anisocontact.base.load_curve import LoadCurve, load_curves
from anisocontact.base.paths import Path, make_path, paths, register_path
from anisocontact.base.renamed import renamed
from anisocontact.base.until import Until
from anisocontact.solver.stepping.report import Accepted, Cut, Progress, StoppedError
from anisocontact.solver.stepping.script import ContactProblem
from anisocontact.solver.stepping.solver import Solver
from anisocontact.solver.strategies.choice import register_strategy
from anisocontact.solver.strategies.newton import Newton
from anisocontact.solver.strategies.strategy import Strategy, Task
from anisocontact.solver.system.culprit import Culprit
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.attached import ElasticSupport, Spring
from anisocontact.solver.terms.cyclic import CyclicSymmetry
from anisocontact.solver.terms.cylindrical import Cylindrical
from anisocontact.solver.terms.face_on_body import CoupledFace
from anisocontact.solver.terms.step import Step
from anisocontact.solver.terms.tied_faces import Tie
from anisocontact.solver.terms.turn import Turn

__all__ = [
    "Accepted",
    "Amplitude",
    "ContactProblem",
    "CoupledFace",
    "Culprit",
    "Cut",
    "CyclicSymmetry",
    "Cylindrical",
    "ElasticSupport",
    "Limits",
    "LoadCurve",
    "Newton",
    "Path",
    "Problem",
    "Progress",
    "Solver",
    "Spring",
    "Step",
    "StoppedError",
    "Strategy",
    "Task",
    "Tie",
    "Turn",
    "Until",
    "amplitudes",
    "load_curves",
    "make_amplitude",
    "make_path",
    "paths",
    "register_amplitude",
    "register_path",
    "register_strategy",
]


def __getattr__(name: str) -> Any:
    return renamed(__name__, name)
