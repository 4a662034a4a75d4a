"""Which slave nodes of a mortar contact count where tractions are largest."""

from __future__ import annotations

#: Share of its weight that has to be covered for the traction of a node to count among peaks: of
#: less the forces are next to nothing [Popp Seitz Gee Wall 2013].
PEAK = 0.05
