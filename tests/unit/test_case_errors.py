"""A wrong case file: one line for each mistake that names the field, and nothing written."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.case.petsc_options import check_options
from anisocontact.cli import main

CONSTANT = 'directions = { kind = "constant", vector = [1, 0, 0] } }\n\n'

# What is replaced, by what, the field that the line must begin with, what else it must say.
WRONG = [
    # unknown keys, with the near one
    ("title =", "titel =", "titel", 'did you mean "title"?'),
    ("order = 1", "oder = 1", "mesh.box.block.oder", 'did you mean "order"?'),
    ("coefficients", "coeficients", "contact[0].friction.coeficients", '"coefficients"?'),
    ("[output]", "[outptu]", "outptu", 'did you mean "output"?'),
    # words, with the near one
    ("[output]", '[solver]\nstrategy = "condensd"\n[output]', "solver.strategy", "'condensed'?"),
    ("[[contact]]", '[[contact]]\npass = "morter"', "contact[0].pass", "did you mean 'mortar'?"),
    # numbers: sign, bound, form
    ("[0.3, 0.1]", "[-0.3, 0.1]", "contact[0].friction.coefficients", "[-0.3, 0.1] given"),
    ("[0.3, 0.1]", "[0.3, 0]", "contact[0].friction.coefficients", "> 0"),
    ("[0.3, 0.1]", '"rough"', "contact[0].friction.coefficients", "'rough' given"),
    ("[0.3, 0.1]", "[nan, 0.1]", "contact[0].friction.coefficients", "finite"),
    ("[0.3, 0.1]", "[true, 0.1]", "contact[0].friction.coefficients", "True"),
    ("[0.3, 0.1]", "[0.3, 0.1, 0.2]", "contact[0].friction.coefficients", "two"),
    ("[4e3, 1e3]", "[-4e3, 1e3]", "contact[0].adhesion.stiffness", ">= 0"),
    ("[4e3, 1e3]", "[0, 0]", "contact[0].adhesion.stiffness", "0 along both axes"),
    ("penalty = 1e4", "penalty = 0", "contact[0].normal.penalty", "> 0"),
    ("penalty = 1e4", "penalty = inf", "contact[0].normal.penalty", "finite"),
    ("penalty = 1e4", 'penalty = "big"', "contact[0].normal.penalty", '"auto"'),
    # rounding of positions would be a force: states far from equilibrium would be taken for one
    ("penalty = 1e4", "penalty = 1e18", "contact 'block.bottom on plate'.normal.penalty",
     "a stiffness of 1e+18, must be at most "),
    ("[4e3, 1e3]", "[1e18, 1e3]", "contact 'block.bottom on plate'.adhesion.stiffness", "at most"),
    ("normal = { penalty = 1e4 }", 'method = "augmented"\ntolerance = 2', "contact[0].tolerance",
     "2.0 given, must be > 0 and < 1"),
    ("E = 1000", "E = -1000", "material.block.E", "-1000 given"),
    ("E = 1000", "E = 0", "material.block.E", "> 0"),
    ('model = "linear-elastic"\nE = 1000\nnu = 0.3', 'model = "orthotropic"\nE = [9, 3, 1]\n'
     "nu = [0.3, 0.3, 9]\nG = [1, 1, 1]", "material.block", "the Poisson's ratios"),
    ("E = 1000", 'E = "stiff"', "material.block.E", "a number needed"),
    ("E = 1000", "E = 1979-05-27", "material.block.E", "number"),
    ("E = 1000", f"E = 1{'0' * 400}", "material.block.E", "given"),
    ("nu = 0.3", "nu = 0.5", "material.block.nu", "< 0.5"),
    ("nu = 0.3", "nu = -1.0", "material.block.nu", "> -1"),
    ("size = [1, 1, 0.5]", "size = [1, 0, 0.5]", "mesh.box.block.size", "> 0"),
    ("cells = [3, 3, 2]", "cells = [3, 3, 2.5]", "mesh.box.block.cells", "whole"),
    ("cells = [3, 3, 2]", "cells = [3, 3]", "mesh.box.block.cells", "3 whole numbers"),
    ("cells = [3, 3, 2]", "cells = [3, 30000, 2000000]", "mesh.box.block.cells", "at most 1e+08"),
    ("cells = [3, 3, 2]", "cells = [3, 3377478169, 2]", "mesh.box.block.cells", "at most 1e+07"),
    ("order = 1", "order = 3", "mesh.box.block.order", "at most 2"),
    ("[mesh.box.block]", "[mesh]\norder = 2\n[mesh.box.block]", "mesh.order",
     "order of the cells in the file: write it with cells of order 2 (in gmsh Mesh.ElementOrder"),
    ("[mesh.box.block]", '[mesh.files.f]\npath = "f.msh"\norder = 2\n[mesh.box.block]',
     "mesh.files.f.order", "the displacement has the order of the cells in the file"),
    ('cell = "hexahedron"', 'cell = "hexaeder"', "mesh.box.block.cell", "tetrahedron"),
    ("increments = 4", "increments = 0", "step[1].increments", "> 0"),
    ("increments = 4\n", "", "step[1].increments", "missing"),
    ("increments = 4", "increments = 20000000", "step[1].increments", "at most 1e+07"),
    ('name = "drag"', 'name = " "', "step[1].name", "a name of one letter or more needed"),
    ("[0.3, 0.1]", "[1e-60, 0.1]", "contact[0].friction.coefficients", "from 1e-50 to 1e+50"),
    ("title =", 'symmetry = ["block.bottom"]\ntitle =', "symmetry",
     "'block.bottom' given, the slave of contact 'block.bottom on plate': held along its normal"),
    ("increments = 4", "increments = 4.5", "step[1].increments", "whole"),
    ("x = 0.02", 'x = "far"', 'step[1].displacement."block.top".x', "'far' given"),
    ("x = 0.02", "u = 0.02", 'step[1].displacement."block.top".u', "allowed: x, y, z"),
    ("[[contact]]", "[[contact]]\nphysical_penalty = 1", "contact[0].physical_penalty", "true"),
    ("normal = { penalty = 1e4 }", "physical_penalty = true", "contact[0].physical_penalty",
     "without the stiffness"),
    ("[[contact]]", '[[contact]]\nmethod = "augmented"\nphysical_penalty = true',
     "contact[0].physical_penalty", "which has no compliance"),
    ("[[contact]]", "[[contact]]\nphysical_penalty = true\ntolerance = 1e-6",
     "contact[0].physical_penalty", "which has no compliance"),
    ("every = 3", "every = -3", "output.every", "> 0"),
    ("every = 3", "every = 3\ntimes = [-1]", "output.times[0]", ">= 0"),
    # words and tables
    ('"linear-elastic"', '"linear-elastik"', "material.block.model", '"linear-elastic"?'),
    ('model = "linear-elastic"\n', "", "material.block.model", "missing"),
    ('shape = "plane"', 'shape = "plain"', "surface.plate.shape", '"plane"?'),
    ("title = ", "title = 3 #", "title", "a text in quotes"),
    ('displacement = { "block.top" = { x = 0.02, y = 0.01 } }', "displacement = 3",
     "step[1].displacement", "a table"),
    ('{ "block.top" = { x = 0.02, y = 0.01 } }', "{ block.top = { x = 0.02 } }",
     "step[1].displacement.block.top", "in quotes"),
    ('{ x = 0.02, y = 0.01 }', "{ }", 'step[1].displacement."block.top"', "at least one"),
    (CONSTANT, 'directions = { kind = "constant", vector = [1, 0, 0], angle = 3 } }\n\n',
     "contact[0].friction.directions.angle", 'did you mean "angle_deg"?'),
    # directions
    (", " + CONSTANT, "}\n\n", "contact[0].friction.directions", "0.3"),
    (CONSTANT, 'directions = { kind = "constant", vector = [0, 0, 0] } }\n\n',
     "contact[0].friction.directions.vector", "zero"),
    (CONSTANT, 'directions = { kind = "constant", vector = [0, 0, 2] } }\n\n',
     "contact[0].friction.directions", "parallel to its normal"),
    ("normal = [0, 0, 1]", "normal = [0, 0, 0]", "surface.plate.normal", "zero"),
    # names
    ('slave = "block.bottom"', 'slave = "block.botom"', "contact[0].slave", "block.bottom"),
    ('slave = "block.bottom"', 'slave = "blok.bottom"', "contact[0].slave", '"block"?'),
    ('slave = "block.bottom"', 'slave = "bottom"', "contact[0].slave", "body.group"),
    ('master = "plate"', 'master = "plat"', "contact[0].master", '"plate"?'),
    ('{ x = 0.02, y = 0.01 } }', '{ x = 0.02, y = 0.01 }, "block.tap" = { x = 1 } }',
     "step[1].displacement", "block.top"),
    ('name = "drag"', 'name = "press"', "step[1].name", "step[0]"),
    ("[material.block]", "[material.blok]", "material.blok", 'did you mean "block"?'),
    # the mesh
    ("[mesh.box.block]\norigin = [0, 0, 0]\nsize = [1, 1, 0.5]\ncells = [3, 3, 2]\n"
     'cell = "hexahedron"\norder = 1', '[mesh]\nfile = "none.msh"', "mesh.file", "none.msh"),
    ("[mesh.box.block]\norigin = [0, 0, 0]\nsize = [1, 1, 0.5]\ncells = [3, 3, 2]\n"
     'cell = "hexahedron"\norder = 1', "[mesh]", "mesh", "nothing given"),
    ("[mesh.box.block]", '[mesh]\nfile = "b.msh"\n[mesh.box.block]', "mesh.file", "b.msh"),
    ("[mesh.box.block]", "[mesh.box.block]\nplanes_x = [0, 0.5, 1]", "mesh.box.block.planes_x",
     "3 given, 4 needed for 3 cells"),
    ("[mesh.box.block]", "[mesh.box.block]\nplanes_x = [0, 0.7, 0.5, 1]",
     "mesh.box.block.planes_x", "must rise from 0 to 1"),
    ("[mesh.box.block]", "[mesh.box.block]\nratio = [1, 0, 1]", "mesh.box.block.ratio", "> 0"),
    ("[mesh.box.block]", "[mesh.box.block]\nscale = 0", "mesh.box.block.scale", "> 0"),
    ("[mesh.box.block]", "[mesh.box.block]\nrotate = { axis = [0, 0, 0], angle_deg = 3 }",
     "mesh.box.block.rotate.axis", "zero"),
    ("[mesh.box.block]", "[mesh.boxx.block]", "mesh.boxx", 'did you mean "box"?'),
    ("[mesh.box.block]", "[mesh.cylinder.block]\nradius = 1\nlength = 1\ncells = [6, 1, 1]\n"
     "[mesh.box.other]", "mesh.cylinder.block.cells", "a multiple of 4 is needed"),
    ("[mesh.box.block]", "[mesh.cylinder.block]\nradius = 1\nlength = 1\ncells = [8, 1, 1]\n"
     "[mesh.box.block]", "mesh.cylinder.block", "mesh.box.block has that name already"),
    ("[mesh.box.block]", '[mesh.files.other]\npath = "c.msh"\n[mesh.box.block]',
     "mesh.files.other.path", "c.msh"),
]  # fmt: skip


def run_wrong(tmp_path, capsys, text: str) -> list[str]:
    """The lines on stderr of a run of this case file, which must fail and write nothing."""
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(text)
    code = main(["run", str(case), "-o", str(out)])
    captured = capsys.readouterr()
    assert code == 2
    assert not out.exists()
    assert captured.out == ""
    return captured.err.splitlines()


@pytest.mark.parametrize(("old", "new", "field", "says"), WRONG)
def test_wrong_value(tmp_path, capsys, case_text, old, new, field, says):
    """One mistake makes one line: the path of the field, what was given, what is allowed."""
    assert old in case_text
    head, _, tail = case_text.rpartition(old)
    lines = run_wrong(tmp_path, capsys, head + new + tail)
    mine = [line for line in lines if line.startswith(f"error: {field}: ")]
    assert mine, lines
    assert says in mine[0]
    assert all(line.startswith("error: ") for line in lines)
    # A name that is wrong in one place may be missed in another, such as a body without material.
    assert len(lines) == 1 or "material" in old or "other" in new


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("[[contact]]", "[contact]", ["contact: ", "a list needed, [[contact]]"]),
        (
            "every = 3",
            "every = 3\n[solver]\noptions = { snes_max_it = [1] }",
            ["solver.options.snes_max_it: [1] given, a text, a number, true or false needed"],
        ),
    ],
)
def test_wrong_form(tmp_path, capsys, case_text, old, new, says):
    """What is no value at all, or one level too high, makes one line as well."""
    lines = run_wrong(tmp_path, capsys, case_text.replace(old, new))
    assert len(lines) == 1
    for text in says:
        assert text in lines[0]


def test_choosing_key_written_wrong(tmp_path, capsys, case_text):
    lines = run_wrong(tmp_path, capsys, case_text.replace("shape =", "shap ="))
    assert lines[0].startswith('error: surface.plate.shape: missing, "shap" given; allowed: plane')


@pytest.mark.parametrize("given", ["nan", "inf", "[]", "2.5", "0"])
def test_increments_of_a_trace(tmp_path, capsys, given):
    case = tmp_path / "case.toml"
    trace = (
        Path(__file__).parents[2] / "examples" / "point" / "orthotropic_plane.toml"
    ).read_text()
    case.write_text(trace.replace("increments = 80", f"increments = {given}"))
    assert main(["trace", str(case), "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"error: load.increments: {given} given, a number or a list of numbers")
    assert said.endswith("needed, whole numbers > 0\n")


@pytest.mark.parametrize(
    ("displacement", "says"),
    [
        (
            '"block.top" = { x = 0.02 }, "block.left" = { x = 0.5 }',
            "step 'drag'.displacement: 'block.top' prescribes 0.02 and 'block.left' 0.5 for x on ",
        ),
        ('"block.tpo" = { x = 0.02 }', "step[1].displacement: no facet group 'block.tpo'"),
    ],
)
def test_mistake_of_a_step_names_the_step(tmp_path, capsys, case_text, displacement, says):
    text = case_text.replace('"block.top" = { x = 0.02, y = 0.01 }', displacement)
    lines = run_wrong(tmp_path, capsys, text)
    assert len(lines) == 1
    assert lines[0].startswith(f"error: {says}")


def test_no_step_in_the_list(tmp_path, capsys, case_text):
    text = "step = []\n" + case_text[: case_text.index("[[step]]")]
    assert run_wrong(tmp_path, capsys, text) == ["error: step: [] given, at least one entry needed"]


def test_case_of_the_other_command(tmp_path, capsys, case_text):
    """A case of `trace` given to `run`, and the other way round: one line, not one for each key."""
    trace = (Path(__file__).parents[2] / "examples" / "point" / "sledge.toml").read_text()
    lines = run_wrong(tmp_path, capsys, trace)
    assert lines == ["error: load given and no mesh: this is a case of `anisocontact trace`"]
    (tmp_path / "case.toml").write_text(case_text)
    assert main(["trace", str(tmp_path / "case.toml"), "-o", str(tmp_path / "out")]) == 2
    said = capsys.readouterr().err
    assert said == "error: mesh given and no load: this is a case of `anisocontact run`\n"


def test_mark_of_the_byte_order_is_passed_over(tmp_path, capsys, case_text):
    (tmp_path / "case.toml").write_bytes(b"\xef\xbb\xbf" + case_text.encode())
    assert main(["check", str(tmp_path / "case.toml")]) == 0


def test_all_mistakes_of_a_file_are_listed(tmp_path, capsys, case_text):
    text = case_text.replace("E = 1000", "E = -1").replace("increments = 4", "increments = 0")
    lines = run_wrong(tmp_path, capsys, text.replace('shape = "plane"', 'shape = "disc"'))
    assert [line.split(": ")[1] for line in lines] == [
        "material.block.E",
        "surface.plate.shape",
        "step[1].increments",
    ]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("title = \n", "line 1, column 9"),
        ("E = 210 GPa\n", "(at line 1, column 9): E = 210 GPa"),
        (f"a = {list(range(40))}, 2\n", "): ... 30, 31, 32, 33, 34, 35, 36, 37, 38, 39], 2"),
        ("a = [1, 2\nb = 3\n", "line 2"),
        ("a = 1\na = 2\n", "line 2, column 6): a = 2"),
        ("[step]\n[step]\n", "[step]; where there are several each is [[step]]"),
        (f"a = {'9' * 5000}\n", "not TOML"),
        ("a = " + "[" * 5000, "case.toml"),
    ],
)
def test_not_toml(tmp_path, capsys, text, says):
    lines = run_wrong(tmp_path, capsys, text)
    assert len(lines) == 1
    assert says in lines[0]
    assert "case.toml" in lines[0]


def test_not_text(tmp_path, capsys):
    (tmp_path / "case.toml").write_bytes(b"title = '\xff'")
    assert main(["check", str(tmp_path / "case.toml")]) == 2
    assert "UTF-8" in capsys.readouterr().err


def test_missing_file_and_folder_in_its_place(tmp_path, capsys):
    assert main(["run", str(tmp_path / "none.toml")]) == 2
    assert "does not exist" in capsys.readouterr().err
    assert main(["run", str(tmp_path)]) == 2
    assert "cannot be read" in capsys.readouterr().err


def test_corrupt_mesh(tmp_path, capsys, case_text):
    (tmp_path / "block.msh").write_bytes(b"$MeshFormat\n4.1 0 8\nnonsense")
    start, end = case_text.index("[mesh"), case_text.index("[material")
    lines = run_wrong(
        tmp_path, capsys, case_text[:start] + '[mesh]\nfile = "block.msh"\n' + case_text[end:]
    )
    assert len(lines) == 1
    assert lines[0].startswith("error: mesh.file: ")
    assert "block.msh" in lines[0]


@pytest.mark.parametrize(
    ("strategy", "option", "said"),
    [
        ("auto", 'snes_type = "newtonx"', "newtonx"),
        ("direct", 'pc_factor_mat_solver_type = "mumpz"', "Could not locate solver type mumpz"),
        ("direct", 'mat_mumps_icntl_14 = "many"', "Input string many has no integer value"),
        ("direct", "mat_mumps_icntl14 = 50", "PETSc knows no such option"),
        ("iterative", 'coarse_pc_type = "gmag"', "Unable to find requested PC type gmag"),
        ("iterative", 'smoother_ksp_type = "cheby"', "Unable to find requested KSP type cheby"),
        ("iterative", "smoother_ksp_maxit = 4", "PETSc knows no such option"),
        ("auto", "snes_atol = -1.0", "solver.options.snes_atol: -1.0 given, must be >= 0"),
        ("iterative", "ksp_max_it = -5", "solver.options.ksp_max_it: -5 given, must be >= 0"),
        ("iterative", 'aggregates_pc_gamg_threshold = "a"', "has no numeric value"),
        ("auto", 'coarse_pc_precision = "half"', "allowed: single, double"),
    ],
)
def test_wrong_petsc_option(tmp_path, capsys, case_text, strategy, option, said):
    """Requirement: what PETSc refuses of any part of a solver is found before a run, by name."""
    options = f"snes_rtol = 1e-9, {option}"
    text = case_text + f'[solver]\nstrategy = "{strategy}"\noptions = {{ {options} }}\n'
    (line,) = run_wrong(tmp_path, capsys, text)
    assert line.startswith(f"error: solver.options.{option.split(' ')[0]}: ")
    assert said in line


@pytest.mark.parametrize(
    "name",
    ["smoother_ksp_chebyshev_esteig", "ksp_fgmres_modifypcnochange", "ksp_gmres_restart"],
)
def test_what_parts_of_iterative_read_is_known(name):
    """Requirement: no option is refused that the Krylov method of a part does read."""
    values = {"smoother_ksp_chebyshev_esteig": "0,0.1,0,1.1", "ksp_gmres_restart": 20}
    check_options({name: values.get(name, True)}, "iterative")


def test_monitors_are_switched_on_by_true():
    """Requirement: `true` is the option alone, as on a command line, for monitors as well."""
    check_options({"snes_monitor": True, "ksp_monitor": True, "ksp_max_it": 7}, "direct")
    check_options({"snes_view": True, "ksp_view": True, "snes_converged_reason": True}, "direct")


@pytest.mark.parametrize(
    ("strategy", "name", "more"),
    [
        ("iterative", "smother_ksp_max_it", ", smoother_, coarse_, aggregates_"),
        ("direct", "smoother_ksp_max_it", ""),
    ],
)
def test_petsc_option_that_nobody_reads(tmp_path, capsys, case_text, strategy, name, more):
    text = case_text + f'[solver]\nstrategy = "{strategy}"\noptions = {{ {name} = 4 }}\n'
    assert run_wrong(tmp_path, capsys, text) == [
        f"error: solver.options.{name}: no part of the solver reads it: names begin with one of "
        f"snes_, ksp_, pc_, mat_, vec_, sub_, mg_, fieldsplit_{more}"
    ]


def test_unknown_petsc_option(tmp_path, capsys, case_text):
    text = case_text + "[solver]\noptions = { snes_max_it = 30, snes_maxit = 30 }\n"
    assert run_wrong(tmp_path, capsys, text) == [
        "error: solver.options.snes_maxit: PETSc knows no such option"
    ]
