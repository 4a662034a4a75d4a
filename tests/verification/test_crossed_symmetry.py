"""Bodies that go through a plane of symmetry, where nothing but a contact stops them, are told.

Requirement: a warning that names body and plane and how far the body is beyond it, in the increment
in which a part that the plane does not hold passes it, none before; none for a body that lies on
both sides of the plane from the start. Condensed bodies are looked at where contacts act on them.
Tolerance: what is prescribed, to rounding, and to the strain of a tip that nothing loads, 1e-6.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from anisocontact.base.errors import RunWarning
from anisocontact.case import load
from anisocontact.case.build import build

CASE = """
title = "Quarter of a ring"
symmetry = ["ring.start"{more}]
[idealisation]
kind = "plane-strain"
[mesh.annulus.ring]
inner = 0.8
outer = 1
start_deg = 0
end_deg = {end}
cells = [1, 12]
order = 2
[material.ring]
model = "{model}"
E = 1000
nu = 0.3
[surface.plate]
shape = "plane"
point = [0, {place}, 0]
normal = [0, {normal}, 0]
[[contact]]
slave = "{slave}"
master = "plate"
friction = {{ coefficients = 0 }}
[[step]]
name = "down"
increments = 2
displacement = {{ "ring.end" = {{ x = 0, y = {way} }} }}
"""


def crossed(path: Path, **given: object) -> list[dict[str, float]]:
    """How far the ring is beyond its planes in each increment."""
    case = {"more": "", "end": 90, "model": "neo-hookean", "way": -1.4}
    case |= {"slave": "ring.outer", "place": 2, "normal": -1} | given
    file = path / "case.toml"
    file.write_text(CASE.format(**case))
    return [part.crossed for part in build(load(file)).solver.run()]


@pytest.mark.filterwarnings("ignore:.*balance of energy")
def test_through_its_plane(tmp_path: Path) -> None:
    """The end at the top goes from 0.8 inside by 1.4, the first half of it within the plane."""
    text = "body 'ring' has gone through its plane of symmetry 'ring.start' by up to 0.6, "
    with pytest.warns(RunWarning, match=text):
        first, second = crossed(tmp_path)
    assert not first
    assert second == {"ring.start": pytest.approx(0.6, rel=1e-9)}


def test_bodies_that_are_condensed(tmp_path: Path) -> None:
    """Of a linear ring, all but closed, the outer side is known: its tip is at sin 2 degrees."""
    with pytest.warns(RunWarning, match="gone through its plane of symmetry"):
        _, second = crossed(tmp_path, end=178, model="linear-elastic", way=-0.1)
    assert second == {"ring.start": pytest.approx(0.1 - 0.034899497, rel=1e-6)}


def test_on_both_sides_from_the_start(tmp_path: Path) -> None:
    """A ring that reaches around its plane has no mirror image: the plane is a support."""
    assert crossed(tmp_path, end=200, model="linear-elastic", way=-0.1) == [{}, {}]


def test_little_counts_as_nothing(tmp_path: Path) -> None:
    """A tip that is beyond the plane by less than a twentieth of the facet of 0.2 in it."""
    part = {"end": 178, "model": "linear-elastic"}
    assert crossed(tmp_path, way=-0.044, **part)[-1] == {}
    with pytest.warns(RunWarning, match=r"up to 0\.0111"):
        assert crossed(tmp_path, way=-0.046, **part)[-1]
