"""FGMRES on the whole system; what can be touched stays on all levels."""
