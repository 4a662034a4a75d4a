"""Unknowns, what acts on them assembled, the accepted state."""
