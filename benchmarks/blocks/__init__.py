"""Block on plane and block on block, in this code and in others."""
