"""Newton's method, load steps and what a run reports."""

from anisocontact.base.limits import Limits
from anisocontact.solver.stepping.report import Accepted, Cut, Progress, StoppedError
from anisocontact.solver.stepping.script import ContactProblem
from anisocontact.solver.stepping.solver import Solver
from anisocontact.solver.strategies.choice import register_strategy
from anisocontact.solver.strategies.newton import Newton
from anisocontact.solver.strategies.strategy import Strategy, Task
from anisocontact.solver.system.culprit import Culprit
from anisocontact.solver.system.problem import Problem
from anisocontact.solver.terms.attached import ElasticSupport, Spring
from anisocontact.solver.terms.step import Step
from anisocontact.solver.terms.turn import Turn

__all__ = [
    "Accepted",
    "ContactProblem",
    "Culprit",
    "Cut",
    "ElasticSupport",
    "Limits",
    "Newton",
    "Problem",
    "Progress",
    "Solver",
    "Spring",
    "Step",
    "StoppedError",
    "Strategy",
    "Task",
    "Turn",
    "register_strategy",
]
