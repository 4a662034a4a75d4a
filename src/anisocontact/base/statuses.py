"""What a contact point can be."""

from __future__ import annotations

#: Names of the codes of a point's status.
STATUS = ("open", "stick", "slip")
#: The codes.
OPEN, STICK, SLIP = range(len(STATUS))
