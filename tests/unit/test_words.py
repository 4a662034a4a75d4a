"""Words of other codes and misspelt names: one line that names what is meant here."""

from __future__ import annotations

import tomllib

import pytest

from anisocontact.base.errors import InputError
from anisocontact.base.words import elsewhere, meant
from anisocontact.laws import Friction

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.bulk import make_material
from anisocontact.case import CaseError, validate

# What is replaced, by what, the field, and what the one line must say.
FOREIGN = [
    ("E = 1000", "youngs_modulus = 1000", "material.block.youngs_modulus", 'did you mean "E"?'),
    ("E = 1000", "young = 1000", "material.block.young", 'did you mean "E"?'),
    ("nu = 0.3", "poisson = 0.3", "material.block.poisson", 'did you mean "nu"?'),
    ("nu = 0.3", "nu = 0.3\nrho = 1", "material.block.rho", 'did you mean "density"?'),
    ("nu = 0.3", "nu = 0.3\nmu = 0.2", "material.block.mu", "coefficients"),
    ('"linear-elastic"', '"elastic"', "material.block.model", 'did you mean "linear-elastic"?'),
    ('"linear-elastic"', '"neo_hooke"', "material.block.model", 'did you mean "neo-hookean"?'),
    ("nu = 0.3", "nu = 0.3\nalpha = 1e-5", "material.block.alpha", 'did you mean "expansion"?'),
    ("nu = 0.3", "nu = 0.3\nD1 = 1e-3", "material.block.D1", "bulk_modulus is 2/D1"),
    ('"linear-elastic"', '"prony"', "material.block.model", 'did you mean "viscoelastic"?'),
    ('"linear-elastic"', '"j2"', "material.block.model", 'did you mean "plastic"?'),
    ("coefficients =", "mu =", "contact[0].friction.mu", 'did you mean "coefficients"?'),
    ("coefficients =", "static_friction =", "contact[0].friction.static_friction",
     '"coefficients"?'),
    ("coefficients =", "friction_coefficient =", "contact[0].friction.friction_coefficient",
     '"coefficients"?'),
    ("penalty =", "penalty_stiffness =", "contact[0].normal.penalty_stiffness", '"penalty"?'),
    ('slave = "block.bottom"', 'slave = "block.bottom"\nmu = 0.3', "contact[0].mu", "coefficients"),
    ('slave = "block.bottom"', 'slave = "block.bottom"\nfriction_coefficient = 0.3',
     "contact[0].friction_coefficient", "friction"),
    ("slave =", "secondary =", "contact[0].secondary", 'did you mean "slave"?'),
    ("increments = 4", "increments = 4\ngravity = [0, 0, -9.81]", "step[1].gravity",
     "a table needed"),
    ("increments = 4", "increments = 4\nboundary = 3", "step[1].boundary", '"displacement"?'),
    ("increments = 4", "increments = 4\nbc = 3", "step[1].bc", '"displacement"?'),
    ("increments = 4", "substeps = 4", "step[1].substeps", 'did you mean "increments"?'),
    ("increments = 4", "increments = 4\ntime_step = 0.1", "step[1].time_step", "duration"),
    ("increments = 4", "increments = 4\nnlgeom = true", "step[1].nlgeom", "finite strain"),
    ("[output]", "[gravity]\nz = -9.81\n[output]", "gravity", "a step has it: gravity"),
    ("[output]", "[bc]\nz = -9.81\n[output]", "bc", "displacement"),
    ("[output]", "[solver]\nnlgeom = true\n[output]", "solver.nlgeom", "finite strain"),
    ("[output]", "[solver]\nmax_iterations = 9\n[output]", "solver.max_iterations", "snes_max_it"),
    ("[output]", "[contacts]\nx = 1\n[output]", "contacts", 'did you mean "contact"?'),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "field", "says"), FOREIGN)
def test_a_word_of_another_code_is_answered_by_the_one_used_here(case_text, old, new, field, says):
    error = _refused(case_text.replace(old, new, 1))
    assert error.field == field
    assert says in str(error)


@pytest.mark.parametrize("name", ["blok", "Block", "blocks"])
def test_a_misspelt_body_of_a_material_is_one_line(case_text, name):
    """The groups and the body of the mesh are right: nobody is told to rename them."""
    error = _refused(case_text.replace("[material.block]", f"[material.{name}]"))
    assert str(error) == f'material.{name}: no such body; did you mean "block"?'


def test_a_misspelt_body_of_a_file_is_one_line(case_text):
    """Which bodies a file has is not known yet; contacts and steps name one without material."""
    boxed = case_text[case_text.index("[mesh.box.block]") : case_text.index("[material.block]")]
    text = case_text.replace(boxed, '[mesh]\nfile = "b.msh"\n\n')
    error = _refused(text.replace("[material.block]", "[material.blok]"))
    assert str(error) == 'material.blok: no such body; did you mean "block"?'


def test_a_missing_material_is_one_line(case_text):
    """A body without any material is no misspelt one."""
    table = case_text[case_text.index("[material.block]") : case_text.index("[surface.plate]")]
    error = _refused(case_text.replace(table, "[material]\n"))
    assert str(error) == "material.block: missing; every body needs a material"


def test_in_a_script():
    with pytest.raises(InputError, match="did you mean 'coefficients'"):
        Friction(mu=0.3)
    with pytest.raises(InputError, match="did you mean 'E'"):
        make_material("linear-elastic", youngs_modulus=1.0, nu=0.3)
    with pytest.raises(InputError, match="did you mean 'linear-elastic'"):
        make_material("elastic", E=1.0, nu=0.3)


def test_near_names_and_unknown_ones():
    assert meant("ordr", ["cell", "order"]) == "order"
    assert meant("Young's modulus", ["E", "nu"]) == "E"
    assert meant("zzz", ["E", "nu"]) is None
    assert elsewhere("zzz") is None


def test_a_case_without_friction(case_text):
    """`coefficients = 0`, one number, needs no directions and is frictionless."""
    wanted = case_text.replace("[0.3, 0.1], " + _CONSTANT, "0 }")
    assert wanted != case_text
    (contact,) = validate(tomllib.loads(wanted)).contact
    assert contact.friction.coefficients == (0.0, 0.0)


_CONSTANT = 'directions = { kind = "constant", vector = [1, 0, 0] } }'


def _refused(text: str) -> InputError:
    with pytest.raises(CaseError) as error:
        validate(tomllib.loads(text))
    (only,) = error.value.errors
    return only
