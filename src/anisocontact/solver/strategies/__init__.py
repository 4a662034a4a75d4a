"""Ways to solve the equations: direct, condensed, iterative."""
