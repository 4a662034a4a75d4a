"""What acts on the bodies: loads, supports, springs, ties, rigid bodies, stabilisation."""
