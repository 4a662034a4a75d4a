"""Results of a run: `Results` reads a folder, `results.writer` writes one."""

from anisocontact.results.quantities import register_quantity
from anisocontact.results.read import Results
from anisocontact.results.slave_points import SlavePoints

__all__ = ["Results", "SlavePoints", "register_quantity"]
