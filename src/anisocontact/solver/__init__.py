"""Newton's method, load steps and what a run reports."""

from anisocontact.limits import Limits
from anisocontact.solver.attached import ElasticSupport, Spring
from anisocontact.solver.problem import Problem
from anisocontact.solver.solver import Solver
from anisocontact.solver.steps import Accepted, Culprit, Cut, Progress, Step, StoppedError
from anisocontact.solver.turn import Turn
from anisocontact.solver.user import ContactProblem

__all__ = [
    "Accepted",
    "ContactProblem",
    "Culprit",
    "Cut",
    "ElasticSupport",
    "Limits",
    "Problem",
    "Progress",
    "Solver",
    "Spring",
    "Step",
    "StoppedError",
    "Turn",
]
