"""A right case file: what it becomes, and what its schema says."""

from __future__ import annotations

import math
import sys
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from anisocontact.anisotropy import make_directions
from anisocontact.base import registry
from anisocontact.base.registry import Entry, Parameter
from anisocontact.surfaces import make_surface

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case import json_schema, load, objects, validate
from anisocontact.case.model import case_type
from anisocontact.case.registries import Registries


def test_values_and_defaults(case_text):
    case = validate(tomllib.loads(case_text))
    assert case.mesh.box["block"].cells == (3, 3, 2)
    contact = case.contact[0]
    assert contact.normal.penalty == 1e4
    assert contact.adhesion.stiffness == (4e3, 1e3)
    assert contact.friction.sliding_rule == "maximum-dissipation"
    assert contact.friction.directions.angle_deg == 0.0
    assert case.step[1].displacement["block.top"].given() == {"x": 0.02, "y": 0.01}
    assert case.step[0].duration == 1.0


def test_angles_are_degrees_in_the_file_and_radians_in_python(case_text):
    text = case_text.replace(
        "vector = [1, 0, 0] } }\n\n", "vector = [1, 0, 0], angle_deg = 30 } }\n\n"
    )
    directions = validate(tomllib.loads(text)).contact[0].friction.directions
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    turned = make_directions("constant", vector=(1, 0, 0), angle=math.radians(30))
    for field in (objects.directions(directions, ""), turned):
        assert field.axes(plane, [[0, 0]])[0][0, 0] == pytest.approx((np.sqrt(0.75), 0.5, 0))


def test_one_number_stands_for_two_equal_ones_and_needs_no_direction(case_text):
    text = case_text.replace(
        'stiffness = [4e3, 1e3], directions = { kind = "constant", vector = [1, 0, 0] }',
        "stiffness = 2e3",
    )
    adhesion = validate(tomllib.loads(text)).contact[0].adhesion
    assert adhesion.stiffness == (2e3, 2e3)
    assert adhesion.directions is None


def test_stiffnesses_left_out_are_auto(case_text):
    text = "\n".join(
        line for line in case_text.splitlines() if not line.startswith(("normal = {", "adh"))
    )
    contact = validate(tomllib.loads(text)).contact[0]
    assert contact.normal.penalty == "auto"
    assert contact.adhesion.stiffness == "auto"


@pytest.mark.parametrize(
    ("file", "name"), [("case.toml", "folder"), ("milling.toml", "milling"), ("a.b.toml", "a.b")]
)
def test_name_of_a_case(tmp_path, case_text, file, name):
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / file).write_text(case_text)
    assert load(folder / file).name == name


def test_a_mesh_file_is_beside_the_case(tmp_path, case_text):
    path = tmp_path / "case.toml"
    path.write_text(case_text)
    assert load(path).resolve("block.msh") == tmp_path / "block.msh"
    assert load(path).resolve("/elsewhere/block.msh") == Path("/elsewhere/block.msh")


def keys_of(schema: dict) -> set[str]:
    """Every key that any table of a schema has."""
    return {key for table in schema["$defs"].values() for key in table.get("properties", ())}


def test_schema_names_every_registered_entry_and_parameter():
    schema = json_schema()
    constants = {
        value["const"]
        for table in schema["$defs"].values()
        for value in table.get("properties", {}).values()
        if "const" in value
    }
    known = Registries.current()
    written = schema["$defs"]["Output"]["properties"]["quantities"]["items"]["enum"]
    assert written == known.arrays
    for name, entries in vars(known).items():
        for entry in entries if name != "output_quantities" else ():
            if entry in registry.evolution_forms():
                assert entry.name in schema["$defs"]["Contact"]["properties"]["evolution"]["enum"]
                continue
            if entry.kind == "strategy":
                assert entry.name in schema["$defs"]["Solver"]["properties"]["strategy"]["enum"]
            elif entry.kind.startswith("shape"):
                assert entry.name in schema["$defs"]["Mesh"]["properties"]
            else:
                assert entry.name in constants
            for p in entry.parameters:
                key = f"{p.name}_deg" if p.unit == "angle" else p.name
                assert key in keys_of(schema)


def test_schema_has_units_bounds_and_descriptions():
    table = json_schema()["$defs"]["MaterialLinearElastic"]["properties"]
    assert table["E"]["unit"] == "stress"
    assert table["E"]["exclusiveMinimum"] == 0
    assert "Young" in table["E"]["description"]
    assert (
        json_schema()["$defs"]["DirectionsConstant"]["properties"]["angle_deg"]["unit"] == "degree"
    )


def test_schema_has_no_null():
    # TOML cannot write one, so that an editor must not offer it.
    assert "null" not in str(json_schema()).replace("nullable", "")
    assert "None" not in str(json_schema())


def test_a_new_registry_entry_needs_no_change_of_the_case_file(case_text):
    """A surface that somebody registers can be written in a case file."""
    dome = Entry(
        "dome",
        "surface",
        "Made up for this test.",
        (
            Parameter("height", "scalar", "length", "height of the dome", "positive"),
            Parameter(
                "lean", "scalar", "angle", "lean of the dome", required=False, default=(0.5,)
            ),
        ),
    )
    known = Registries.current()
    kind = case_type(replace(known, surfaces=(*known.surfaces, dome)))
    data = tomllib.loads(case_text)
    data["surface"]["plate"] = {"shape": "dome", "height": 2, "lean_deg": 90}
    plate = kind.model_validate(data).surface["plate"]
    assert plate.parameters() == {"height": 2.0, "lean_deg": 90.0}
    assert "SurfaceDome" in kind.model_json_schema()["$defs"]
    del data["surface"]["plate"]["lean_deg"]
    # Left out: the registry's default, 0.5 rad, goes through degrees and back.
    lean = kind.model_validate(data).surface["plate"].parameters()["lean_deg"]
    assert math.radians(lean) == pytest.approx(0.5, rel=1e-15)


def test_a_fault_of_our_own_is_no_lack_of_finite_elements(monkeypatch):
    """A material whose file imports in a circle is told: `info` was without materials."""
    monkeypatch.setitem(sys.modules, "anisocontact.bulk", None)
    with pytest.raises(ImportError, match=r"import of anisocontact.bulk halted"):
        Registries.current()
