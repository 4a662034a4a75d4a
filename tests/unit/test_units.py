"""Units label what is shown, and a slip of a thousand is told; nothing is converted."""

from __future__ import annotations

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case.units import Units, check_units, doubts
from anisocontact.cli import main
from anisocontact.results.report.labels import in_units

CASE = """
{units}

[mesh.box.bar]
origin = [0, 0, 0]
size = [100, 100, 100]
cells = [1, 1, 1]

[material.bar]
model = "linear-elastic"
E = {young}
nu = 0.3

[[step]]
name = "hang"
increments = 1
displacement = {{ "bar.top" = {{ x = 0, y = 0, z = 0 }} }}
body_force = {{ bar = {{ z = -9810, density = {density} }} }}
"""


@pytest.mark.parametrize(
    ("given", "labels"),
    [
        ({"length": "mm", "force": "N"}, {"stress": "MPa"}),
        ({"length": "m", "force": "N"}, {"stress": "Pa"}),
        ({"length": "mm", "stress": "GPa"}, {"force": "kN"}),
        ({"length": "in", "force": "lbf"}, {"stress": "psi"}),
        ({"length": "cm", "force": "N"}, {"stress": "N/cm^2"}),
        ({"length": "um", "force": "uN", "time": "ms"}, {"stress": "MPa"}),
        ({}, {}),
    ],
)
def test_what_follows_from_what_is_given(given, labels):
    units = Units(**given)
    assert units.labels() == given | labels
    assert list(check_units(units)) == []


def test_stress_that_is_another():
    (error,) = check_units(Units(length="mm", force="N", stress="GPa"))
    assert str(error) == 'units.stress: "GPa" given, N and mm make MPa'


@pytest.mark.parametrize(
    ("units", "young", "densities", "size", "count"),
    [
        ({"length": "mm", "force": "kN", "time": "ms"}, 210.0, [7.85e-6], 100.0, 0),  # kg, GPa
        ({"length": "mm", "force": "kN"}, 210.0, [7.85e-6], 100.0, 1),
        ({"length": "mm", "force": "N"}, 210e3, [7.85e-9], 100.0, 0),
        ({"length": "mm", "force": "N"}, 210e9, [7.85e-9], 100.0, 1),
        ({"length": "mm", "force": "N"}, 210e3, [7850.0], 100.0, 1),
        ({"length": "m", "force": "N"}, 210e9, [7850.0], 0.1, 0),
        ({"length": "m", "force": "N"}, 210e9, [7850.0], 1e5, 1),
        ({"length": "m", "stress": "MPa"}, 2.0, [], 0.1, 0),
        ({}, 210e3, [7.85e-9], 100.0, 0),  # mm, N
        ({}, 210e9, [7850.0], 0.1, 0),  # m, N
        ({}, 30e6, [7.3e-4], 4.0, 0),  # in, lbf
        ({}, 210e9, [7.85e-9], 100.0, 1),
        ({}, 1.0, [], 1.0, 0),
    ],
)
def test_numbers_that_no_body_has(units, young, densities, size, count):
    found = doubts(Units(**units), {"bar": young}, densities, size)
    assert len(found) == count
    assert all("\n" not in line for line in found)


@pytest.mark.parametrize(
    ("units", "young", "density", "gravity", "said"),
    [
        ({"length": "mm", "force": "N"}, 210e3, 7.85e-9, 9810.0, None),
        ({"length": "mm", "force": "N"}, 210e3, 7.85e-9, 9.81, "gravity is 0.00981 m/s^2"),
        ({"length": "m", "force": "N"}, 210e9, 7850.0, 9810.0, "gravity is 9.81e+03 m/s^2"),
        ({"length": "mm", "force": "kN", "time": "ms"}, 210.0, 7.85e-6, 9.81e-3, None),
        ({"length": "mm", "force": "kN", "time": "ms"}, 210.0, 7.85e-6, 9.81, "mm, kN and ms"),
        ({}, 210e3, 7.85e-9, 9810.0, None),
        ({}, 210e3, 7.85e-9, 1e-3, "densities, gravity and the size of the bodies do not fit"),
    ],
)
def test_gravity_of_other_units(units, young, density, gravity, said):
    """Requirement: 9.81 beside lengths in mm and seconds is a slip of a thousand, and is told."""
    found = doubts(Units(**units), {"bar": young}, [density], 100.0, [gravity])
    assert len(found) == (said is not None)
    assert not said or said in found[0]


@pytest.mark.parametrize(
    "weight",
    [
        "gravity = { z = -9.81 }",
        "body_force = { bar = { z = -9.81, density = 7.85e-9 } }",
        'gravity = { z = { amplitude = "on", value = -9.81 } }',
    ],
)
def test_gravity_of_a_case(tmp_path, capsys, weight):
    """Requirement: `check` says so of gravity and of body forces that have a density; of gravity
    that a step takes away it says nothing."""
    text = CASE.format(units='[units]\nlength = "mm"\nforce = "N"', young="210e3", density="1")
    head, _, _ = text.partition("body_force")
    head = head.replace("nu = 0.3", "nu = 0.3\ndensity = 7.85e-9")
    amplitude = '[amplitude.on]\nkind = "ramp"\nend = 1\n'
    (tmp_path / "case.toml").write_text(head + weight + "\n" + amplitude * ("on" in weight))
    assert main(["check", str(tmp_path / "case.toml")]) == 0
    assert "units: gravity is 0.00981 m/s^2 in mm and N" in capsys.readouterr().out
    off = head + "gravity = { z = -9810 }\n[[step]]\nname = 'off'\nincrements = 1\n"
    (tmp_path / "off.toml").write_text(off + "gravity = { z = 0 }\n")
    assert main(["check", str(tmp_path / "off.toml")]) == 0
    assert "units:" not in capsys.readouterr().out


@pytest.mark.parametrize(
    ("units", "young", "density", "said"),
    [
        ('[units]\nlength = "mm"\nforce = "N"', "210e3", "7.85e-9", None),
        ('[units]\nlength = "mm"\nforce = "N"', "210e3", "7.85e-6", "density is 7.85e+06 kg/m^3"),
        ("", "210e9", "7.85e-9", "do not fit together"),
        ("", "210e3", "7.85e-9", None),
    ],
)
def test_a_case_is_warned_of_in_one_line(tmp_path, capsys, units, young, density, said):
    path = tmp_path / "case.toml"
    path.write_text(CASE.format(units=units, young=young, density=density))
    assert main(["check", str(path)]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if "units" in line]
    assert len(lines) == (said is not None)
    assert not said or said in lines[0]


@pytest.mark.parametrize("timed", [False, True])
def test_a_material_that_knows_time_wants_durations(tmp_path, capsys, timed):
    text = CASE.format(units="", young="210e3", density="7.85e-9")
    relaxing = 'model = "viscoelastic"\ng = [0.5]\ntau = [1]'
    text = text.replace('model = "linear-elastic"', relaxing)
    if timed:
        text = text.replace("increments = 1", "increments = 1\nduration = 2")
    (tmp_path / "case.toml").write_text(text)
    assert main(["check", str(tmp_path / "case.toml")]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if "knows time" in line]
    assert len(lines) == (not timed)


def test_unknown_unit_is_one_line(tmp_path, capsys):
    path = tmp_path / "case.toml"
    path.write_text(CASE.format(units='[units]\nlength = "mile"', young="1", density="1"))
    assert main(["check", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: units.length: 'mile' given")


def test_labels():
    units = {"length": "mm", "force": "N", "stress": "MPa"}
    assert in_units("dissipated [stress length]", units) == "dissipated [MPa mm]"
    assert in_units("turn [rad], list[0], time [time]", units) == "turn [rad], list[0], time [time]"


def test_report_has_the_units(tmp_path):
    text = CASE.format(units='[units]\nlength = "mm"\nforce = "N"', young="210e3", density="1e-9")
    (tmp_path / "case.toml").write_text(text)
    assert main(["run", str(tmp_path / "case.toml"), "-o", str(tmp_path / "out")]) == 0
    page = (tmp_path / "out" / "report.html").read_text()
    assert "force z [N]" in page
    assert "largest equivalent stress (von Mises) [MPa]" in page
    assert "[length]" not in page
