"""Hard cases of contact, run with every method and strategy that applies."""
