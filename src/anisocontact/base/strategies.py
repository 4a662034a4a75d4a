"""Names of the ways to solve the equations; no finite elements are needed to check them."""

AUTO, DIRECT, CONDENSED, ITERATIVE = "auto", "direct", "condensed", "iterative"
#: What may be asked for, the default first.
STRATEGIES = (AUTO, DIRECT, CONDENSED, ITERATIVE)
