"""What is said of contacts when cases are checked and run, in the command's own words."""

from __future__ import annotations

import json
import warnings
from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main

PAIR = """
[mesh.box.base]
origin = [-1, -1, -1]
size = [2, 2, 1]
cells = [1, 1, 1]

[mesh.box.pin]
origin = [-0.1, -0.1, 0]
size = [0.2, 0.2, 0.3]
cells = [2, 2, 1]

[material]
base = { model = "linear-elastic", E = 100, nu = 0.3 }
pin = { model = "linear-elastic", E = 100, nu = 0.3 }

[[contact]]
slave = "base.top"
master = "pin.bottom"
pass = "single"
friction = { coefficients = 0.3 }

[[step]]
name = "press"
increments = 1
[step.displacement]
"base.bottom" = { x = 0, y = 0, z = 0 }
"pin.top" = { x = 0, y = 0, z = -0.01 }

[output]
pictures = false
"""

#: A block on another one, supported or not.
STACK = """
[mesh.box.a]
origin = [0, 0, 0]
size = [1, 1, 0.5]
cells = [3, 3, 2]

[mesh.box.b]
origin = [0, 0, -0.5]
size = [1, 1, 0.5]
cells = [2, 2, 2]

[material]
a = {{ model = "linear-elastic", E = 1000, nu = 0.3 }}
b = {{ model = "linear-elastic", E = 1000, nu = 0.3 }}

[[contact]]
slave = "a.bottom"
master = "b.top"
friction = {{ coefficients = 0.3 }}

[[step]]
name = "press"
increments = 2
displacement = {{ {support}"a.top" = {{ x = 0, y = 0, z = -0.01 }} }}

[output]
pictures = false
"""


def _summary(tmp_path: Path, text: str) -> dict:
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(text)
    assert main(["run", str(case), "-o", str(out), "--overwrite"]) == 0
    return json.loads((out / "summary.json").read_text())


def test_check_and_run_say_it_and_say_it_again_where_nothing_touches(tmp_path, capsys):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        told = _summary(tmp_path, PAIR)["warnings"]
        assert main(["check", str(tmp_path / "case.toml")]) == 0
    at_start, at_end = told
    assert "swap slave and master" in at_start
    assert "no point touches at the end; the facets of the slave are 20 times" in at_end
    assert at_start in capsys.readouterr().out


@pytest.mark.parametrize("supported", [True, False])
def test_a_body_without_support_that_is_pushed_along_is_told_of(tmp_path, supported):
    """Requirement: who forgets the support of a body hears that the contact carries nothing.

    Source: a body that nothing holds is in equilibrium wherever it is pushed to, without forces.
    """
    support = '"b.bottom" = { x = 0, y = 0, z = 0 }, ' if supported else ""
    text = STACK.format(support=support)
    told = _summary(tmp_path, text)["warnings"]
    assert any("support is missing" in line for line in told) == (not supported)


@pytest.mark.parametrize(("angle", "told"), [(30, True), (0, False)])
def test_who_swaps_sides_is_told_of_angles(tmp_path, capsys, angle, told):
    """Requirement: the advice to swap sides says that angles of a texture change their signs.

    Source: direction-fields.md, angles are about the normal from the master to the slave. A block
    on a base that was swapped as advised had its lateral force the other way round.
    """
    field = f'{{ kind = "constant", vector = [1, 0, 0], angle_deg = {angle} }}'
    case = tmp_path / "case.toml"
    case.write_text(
        PAIR.replace("= 0.3 }\n\n[[step]]", f"= [0.3, 0.1], directions = {field} }}\n\n[[step]]")
    )
    assert main(["check", str(case)]) == 0
    (said,) = [line for line in capsys.readouterr().out.splitlines() if "swap slave" in line]
    assert said.endswith("change their signs then") == told


BLOCK = """
[mesh.box.block]
origin = [0, 0, {gap}]
size = [1, 1, 1]
cells = [4, 4, 4]

[material.block]
model = "linear-elastic"
E = 1000
nu = 0

[surface.table]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]

[[contact]]
slave = "block.bottom"
master = "table"
normal = {{ penalty = {penalty} }}
friction = {{ coefficients = 0 }}

[[step]]
name = "press"
increments = 2
displacement = {{ "block.top" = {{ x = 0, y = 0, z = {way} }} }}

[output]
pictures = false
"""


@pytest.mark.parametrize(("angle", "said"), [(0, False), (10, False), (50, True)])
def test_a_slip_ellipse_that_makes_points_jump_is_told(tmp_path, capsys, angle, said):
    """Where the symmetric part of F K has a negative eigenvalue, docs/theory/sliding-rules.md.

    With coefficients 0.4 and 0.1 the lesser one is 6.25, 5.5 and -6.1.
    """
    axes = "[1.0, 4.0]" if angle == 50 else "[1.0, 1.5]"
    rule = (
        f'coefficients = [0.4, 0.1], sliding_rule = "slip-ellipse", slip_axes = {axes}, '
        f"slip_angle_deg = {angle}, "
        'directions = {{ kind = "constant", vector = [1, 0, 0] }}'
    )
    case = tmp_path / "case.toml"
    text = BLOCK.replace("coefficients = 0", rule).format(gap=0.0, penalty=1e4, way=-0.006)
    case.write_text(text)
    assert main(["check", str(case)]) == 0
    assert ("points stick there and jump" in capsys.readouterr().out) is said


@pytest.mark.parametrize(
    ("stiffness", "rule", "said"),
    [
        ("[1e4, 3e4]", "explicit", True),
        ("[1.6e5, 1e4]", "explicit", False),
        ("[1e4, 3e4]", "maximum-dissipation", False),
    ],
)
def test_a_force_that_turns_where_sliding_begins_is_told(tmp_path, capsys, stiffness, rule, said):
    """The sliding force B F T is the trial force T turned, docs/theory/errata.md.

    With coefficients 0.4 and 0.1 it is not for stiffnesses of 16 to one.
    """
    axes = 'directions = {{ kind = "constant", vector = [1, 0, 0] }}'
    friction = f'coefficients = [0.4, 0.1], sliding_rule = "{rule}", {axes}'
    text = BLOCK.replace("coefficients = 0", friction)
    text = text.replace(
        "friction =", f"adhesion = {{{{ stiffness = {stiffness}, {axes} }}}}\nfriction ="
    )
    case = tmp_path / "case.toml"
    case.write_text(text.format(gap=0.0, penalty=1e4, way=-0.006))
    assert main(["check", str(case)]) == 0
    assert ("turn at once where sliding begins" in capsys.readouterr().out) is said


@pytest.mark.parametrize(("coefficients", "said"), [("[0.3, 1e-5]", True), ("[1e-4, 0.3]", False)])
def test_an_ellipse_too_thin_is_told(tmp_path, capsys, coefficients, said):
    """Below 1e-4 increments fail: measured on a block that is pressed and dragged, with slave nodes
    and points, multipliers and penalties, all are solved at 3e-4, some at 3e-5, none at 3e-6."""
    axes = 'directions = {{ kind = "constant", vector = [1, 0, 0] }}'
    text = BLOCK.replace("coefficients = 0", f"coefficients = {coefficients}, {axes}")
    case = tmp_path / "case.toml"
    case.write_text(text.format(gap=0.0, penalty=1e4, way=-0.006))
    assert main(["check", str(case)]) == 0
    assert ("0.3 and 1e-05, have a ratio of 3e-05: below" in capsys.readouterr().out) is said


@pytest.mark.parametrize(("coefficient", "said"), [("1e6", True), ("200", False)])
def test_friction_that_stands_for_no_slip_is_told(tmp_path, capsys, coefficient, said):
    """Where points open it cannot be followed, see `ROUGH`: 200 does what is meant."""
    text = BLOCK.replace("coefficients = 0", f"coefficients = {coefficient}")
    case = tmp_path / "case.toml"
    case.write_text(text.format(gap=0.0, penalty=1e4, way=-0.006))
    assert main(["check", str(case)]) == 0
    assert ("friction of 1e+06 lets points slip only where" in capsys.readouterr().out) is said


@pytest.mark.parametrize("gap", [0.0, 0.5])
def test_a_penetration_is_held_against_the_approach(tmp_path, gap):
    """Springs in series, E/L and eps: the penetration is 1/(1 + eps L/E) of the approach.

    At eps = 10 E / L that is 1/11 = 9 %, but 0.2 % of a facet; the way through a gap is no part of
    the approach. A hundred times stiffer nothing is said.
    """
    text = BLOCK.format(gap=gap, penalty=1e4, way=-gap - 0.006)
    (said,) = (line for line in _summary(tmp_path, text)["warnings"] if "penetration" in line)
    assert "the penetration was up to 9% of the 0.006 that the bodies came towards each" in said
    assert "penalty" in said and "augmented" in said
    assert said.endswith("; where it is the compression of a soft layer: physical_penalty = true")
    lined = text.replace("[[contact]]", "[[contact]]\nphysical_penalty = true")
    assert not any("penetration" in line for line in _summary(tmp_path, lined)["warnings"])
    text = BLOCK.format(gap=gap, penalty=1e6, way=-gap - 0.006)
    assert not any("penetration" in line for line in _summary(tmp_path, text)["warnings"])


def test_a_penetration_is_not_held_against_rounding(tmp_path):
    """A block that its own weight presses: no group of it is led, how far it came is not known.

    It sinks by 1e-5 of rho g L = 2 over 1e4, a share of some 1e12 of what rounding moves.
    """
    led = 'displacement = {{ "block.top" = {{ x = 0, y = 0, z = {way} }} }}'
    text = BLOCK.replace(led, "body_force.block.z = -2").replace("= 0 }}", "= 0.3 }}")
    text = text.format(gap=0.0, penalty=1e4)
    assert not any("pen" in line for line in _summary(tmp_path, text)["warnings"])


@pytest.mark.parametrize("penalty", [1e4, 1e6])
def test_penalties_that_give_way_as_temperatures_press_are_told(tmp_path, penalty):
    """Springs in series, E/L and eps, of a bar that warms between walls: no group of it is led.

    At eps = 10 E / L the force is 1/11 = 9 % too small, and penalties hold as much of the energy.
    A hundred times stiffer nothing is said.
    """
    led = 'displacement = {{ "block.top" = {{ x = 0, y = 0, z = {way} }} }}'
    sides = ("top.z", "left.x", "front.y")
    held = "\n".join(f'displacement."block.{one[:-2]}".{one[-1]} = 0' for one in sides)
    held += "\ntemperature.block = 1"
    text = BLOCK.replace(led, held).replace("nu = 0\n", "nu = 0\nexpansion = 1e-3\n")
    found = _summary(tmp_path, text.format(gap=0.0, penalty=penalty))["warnings"]
    said = [line for line in found if "penalties held 9% of all that bodies" in line]
    assert not any("towards each other" in line for line in found)
    assert len(said) == (penalty < 1e5)


PUNCH = """
[idealisation]
kind = "axisymmetric"

[mesh.rectangle.block]
origin = [0, -2]
size = [2, 2]
cells = [8, 8]
cell = "triangle"

[material.block]
model = "linear-elastic"
E = 1000
nu = 0.3

[surface.punch]
shape = "revolution"
point = [0, 0, 0]
axis = [0, 1, 0]
profile = [[0, 0], [1.01, 0], [1.01, 2]]
rounding = {rounding}

[rigid.punch]
reference = [0, 0, 0]

[[contact]]
slave = "block.top"
master = "punch"
friction = {{ coefficients = 0 }}

[[step]]
name = "press"
increments = 1
displacement."block.bottom" = {{ x = 0, y = 0 }}
motion.punch = {{ y = -0.05 }}

[output]
pictures = false
"""


@pytest.mark.parametrize("rounding", [0.0, 0.25])
def test_nodes_that_a_sharp_edge_pushes_aside_are_told(rounding: float, tmp_path: Path) -> None:
    """A node 0.01 within the edge of a punch that is pressed in by 0.05 meets its side."""
    told = _summary(tmp_path, PUNCH.format(rounding=rounding))["warnings"]
    aside = [line for line in told if "presses its points (1) aside" in line]
    assert len(aside) == (rounding == 0.0)


def test_check_says_what_tetrahedra_of_order_one_do(tmp_path, capsys) -> None:
    """A line, and none for hexahedra."""
    path = tmp_path / "case.toml"
    for cell, said in (("tetrahedron", True), ("hexahedron", False)):
        text = PAIR.replace('pass = "single"\n', "")
        path.write_text(text.replace("cells =", f'cell = "{cell}"\ncells ='))
        assert main(["check", str(path)]) == 0
        assert ("note      pressures at single nodes" in capsys.readouterr().out) is said


FIT = """
[mesh.ring.shaft]
inner = 4
outer = 10.01
length = 4
cells = [2, 36, 1]
[mesh.ring.hub]
inner = {bore}
outer = 20
length = 4
cells = [3, 48, 1]
[material.shaft]
model = "linear-elastic"
E = 210e3
nu = 0.3
[material.hub]
model = "linear-elastic"
E = 210e3
nu = 0.3
[[contact]]
slave = "shaft.outer"
master = "hub.inner"
friction = {{ coefficients = 0.2 }}
[[step]]
name = "shrink"
increments = 1
cylindrical = {{ "hub.outer" = {{ tangential = 0, axial = 0 }} }}
displacement = {{ "shaft.inner" = {{ x = 0, y = 0, z = 0 }} }}
[output]
pictures = false
"""


@pytest.mark.parametrize(("bore", "told"), [(10.0, True), (10.2, False)])
def test_facets_too_flat_to_touch_are_told(tmp_path: Path, bore: float, told: bool) -> None:
    """A press fit whose overlap is less than the arcs over its facets of order 1.

    Requirement: where no point touches it is said how high the arcs are, if they are higher than
    the gap that is left; not of a hub that is wider than that.
    """
    found = [
        line
        for line in _summary(tmp_path, FIT.format(bore=bore))["warnings"]
        if "at the end" in line
    ]
    assert len(found) == 1
    assert ("arcs over its facets" in found[0]) == told
