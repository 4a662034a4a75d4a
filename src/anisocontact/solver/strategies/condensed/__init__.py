"""Linear bulk condensed on the unknowns that can be touched."""

from anisocontact.solver.condensed.condensed import Condensed
from anisocontact.solver.condensed.newton import CondensedNewton
from anisocontact.solver.condensed.reach import contact_unknowns

__all__ = ["Condensed", "CondensedNewton", "contact_unknowns"]
