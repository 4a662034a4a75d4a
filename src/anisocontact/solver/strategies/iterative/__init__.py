"""FGMRES on the whole system; what can be touched stays on the coarse level of two."""

from anisocontact.solver.strategies.iterative.newton import IterativeNewton
from anisocontact.solver.strategies.iterative.patch import Patch

__all__ = ["IterativeNewton", "Patch"]
