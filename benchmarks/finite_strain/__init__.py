"""A block of rubber that is pressed and dragged: where the time goes at finite strain."""
