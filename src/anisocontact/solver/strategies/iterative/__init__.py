"""FGMRES on the whole system; what can be touched stays on the coarse level of two."""
