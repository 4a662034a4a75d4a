"""Options of Krylov iterations, and for which bodies they solve the mixed form."""

from __future__ import annotations

from anisocontact.solver.strategies.database import OptionValue

DEFAULTS: dict[str, OptionValue] = {
    "ksp_type": "fgmres",
    "ksp_gmres_restart": 60,
    "ksp_max_it": 180,
    "ksp_atol": 0.0,  # a residual is small beside another one, in any units
    "pc_type": "python",
    # aggregates alone: they are smoothed with what is known of the patch
    "aggregates_pc_gamg_agg_nsmooths": 0,
    "aggregates_pc_gamg_coarse_eq_limit": 1000,
    "smoother_ksp_type": "chebyshev",
    "smoother_ksp_max_it": 2,
    "smoother_pc_type": "jacobi",
}
#: Stiffness against changes of volume over the rest from which on the mixed form is solved.
MIXED = 2.0
