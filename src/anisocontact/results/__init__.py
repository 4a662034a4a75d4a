"""Results of a run: `Results` reads a folder, `results.writer` writes one."""

from anisocontact.results.quantities import SlavePoints, register_quantity
from anisocontact.results.read import Results

__all__ = ["Results", "SlavePoints", "register_quantity"]
