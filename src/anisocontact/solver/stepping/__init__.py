"""Load steps: increments and their cuts, Newton's method, what stands in the way."""
