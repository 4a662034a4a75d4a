"""Static condensation (Schur complement) of linear bulk on the unknowns that can be touched."""

from anisocontact.solver.strategies.condensed.condensed import Condensed
from anisocontact.solver.strategies.condensed.newton import CondensedNewton
from anisocontact.solver.strategies.condensed.reach import contact_unknowns

__all__ = ["Condensed", "CondensedNewton", "contact_unknowns"]
