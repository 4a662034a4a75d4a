"""Whether a master is the same in every plane, where a process has no slave points."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from mpi4py import MPI

from anisocontact.contact.symmetric import check_symmetry
from anisocontact.interface import Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Axisymmetric, PlaneStrain
from anisocontact.surfaces import make_surface


@pytest.mark.parametrize("idealisation", [PlaneStrain(), Axisymmetric()])
def test_a_process_without_slave_points_refuses_nothing(idealisation: Any) -> None:
    """As where all facets of a small slave are on another process."""
    floor = make_surface("plane", point=(0, 0, 0), normal=(0, 1, 0))
    law = NormalLaw(penalty=1.0), Adhesion(stiffness=(1.0, 1.0)), Friction(coefficients=0.3)
    none = SimpleNamespace(reference=np.zeros((0, 3)), tangents=np.zeros((0, 2, 3)))
    points: Any = SimpleNamespace(quadrature=none, size=1.0)
    check_symmetry(idealisation, Interface(floor, *law), points, MPI.COMM_SELF)
