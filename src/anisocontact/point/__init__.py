"""The point driver: a point, or several that are rigidly linked, through an interface.

`drive` moves a slave point over a surface under a load and records what it meets:

>>> import numpy as np
>>> from anisocontact.anisotropy import make_directions
>>> from anisocontact.interface import Interface
>>> from anisocontact.laws import Adhesion, Friction, NormalLaw
>>> from anisocontact.surfaces import make_surface
>>> marks = make_directions("constant", vector=(1, 0, 0))
>>> interface = Interface(
...     make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)),
...     NormalLaw(penalty=1e5),
...     Adhesion(stiffness=(2e5, 5e4), directions=marks),
...     Friction(coefficients=(0.3, 0.1), directions=marks),
... )
>>> path = PrescribedPath([(0, 0, 0), (1e-3, 0, 0)], pressure=10.0, increments=4)
>>> drive(interface, path).points["traction"][-1, 0].round(9).tolist()
[-3.0, 0.0, 10.0]
"""

from anisocontact.point.driver import drive
from anisocontact.point.group import Group
from anisocontact.point.history import History, StoppedError
from anisocontact.point.loads import DeadLoad, DraggingSpring, Load, PrescribedPath, Push

__all__ = [
    "DeadLoad",
    "DraggingSpring",
    "Group",
    "History",
    "Load",
    "PrescribedPath",
    "Push",
    "StoppedError",
    "drive",
]
