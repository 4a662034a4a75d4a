"""Loads that friction cannot hold are named."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.verification.test_sides_kept import ANGLE, CLAMP, MU, _laws

from anisocontact.base.limits import Limits
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, Interface
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step, StoppedError
from anisocontact.surfaces import make_surface


def _flat(master: str, law: str, tilt: float) -> tuple[Problem, Rotation]:
    """A flat free block on a plane or a plate, all of it turned about x."""
    turn = Rotation.from_rotvec([np.radians(tilt), 0.0, 0.0])
    boxes = {"block": BoxSpec((0, 0, 0), (1, 1, 0.25), (1, 1, 1))}
    if master == "plate":
        boxes["base"] = BoxSpec((-0.7, -0.7, -0.5), (2.4, 2.4, 0.5), (3, 3, 1))
    model = build_box(boxes)
    model.mesh.geometry.x[:] = turn.apply(model.mesh.geometry.x)
    if master == "plate":
        contact = Contact(model, "block.bottom", "base.top", law=ContactLaw(*_laws()), mortar=False)
    else:
        plane = make_surface("plane", point=(0, 0, 0), normal=turn.apply([0.0, 0.0, 1.0]))
        contact = Contact(model, "block.bottom", Interface(plane, *_laws()), mortar=False)
    material = make_material(law, E=1000.0, nu=0.3)
    return Problem(model, dict.fromkeys(boxes, material), [contact]), turn


@pytest.mark.parametrize(
    ("master", "tilt", "law"),
    [
        ("plane", 0.0, "neo-hookean"),
        ("plane", 60.0, "linear-elastic"),
        ("plate", 0.0, "linear-elastic"),
        ("plate", 0.0, "neo-hookean"),
        pytest.param("plane", 0.0, "linear-elastic", marks=pytest.mark.slow),
        pytest.param("plane", 60.0, "neo-hookean", marks=pytest.mark.slow),
    ],
)
def test_loads_beyond_friction_are_named(master: str, tilt: float, law: str) -> None:
    """A free block pressed by 1 and pulled along x by 2, where friction holds 0.22.

    Requirement: the line tells the load of the increment, the direction, and `mu N` along it.
    Source: `mu` of the friction ellipse along x. The four digits that are shown.
    """
    problem, turn = _flat(master, law, tilt)
    normal = turn.apply([0.0, 0.0, -1.0])
    press = dict(zip("xyz", normal.tolist(), strict=True))
    steps = [
        Step("press", 1, CLAMP if master == "plate" else {}, force={"block.top": press}),
        Step("pull", 1, force={"block.top": {"x": 2.0}}),
    ]
    mu = 1.0 / np.hypot(np.cos(ANGLE) / MU[0], np.sin(ANGLE) / MU[1])
    with pytest.raises(StoppedError) as error:
        list(Solver(problem, steps, limits=Limits(smallest=0.25), strategy="direct").run())
    text = str(error.value)
    assert "the loads on body 'block' come to 2 along (1, 0, 0), and friction holds " in text
    assert "no convergence" not in text
    if master == "plane":
        assert f"holds {mu:.4g} there at most, {mu:.4g} of the normal force 1:" in text


def test_loads_that_friction_holds_are_not_to_blame() -> None:
    """A run that stops for another reason says that reason."""
    problem, _ = _flat("plane", "linear-elastic", 0.0)
    steps = [Step("press", 1, force={"block.top": {"z": -1.0, "x": 0.1}})]
    with pytest.raises(StoppedError, match="no convergence in 0 Newton iterations"):
        options = {"snes_max_it": 0}
        list(Solver(problem, steps, options=options, limits=Limits(smallest=0.5)).run())
