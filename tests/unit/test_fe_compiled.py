"""Forms are compiled once, waited for, and compiled anew where a killed process left a mark."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time

import numpy as np
import pytest

from anisocontact.base.compiler import FAST, machine_key

_forms = pytest.importorskip("anisocontact.base.compiled_forms", exc_type=ImportError)
ufl = pytest.importorskip("ufl")
FormMatrix = pytest.importorskip("anisocontact.base.form_matrix", exc_type=ImportError).FormMatrix

ANSWER = "JIT compilation timed out, probably due to x. Try cleaning cache (e.g. remove {}) or so."


@pytest.mark.parametrize(("age", "waits"), [(2.0 * _forms.ABANDONED, 1), (1.0, 3)])
def test_marks_of_the_dead_are_removed_and_the_living_waited_for(tmp_path, monkeypatch, age, waits):
    mark = tmp_path / "libffcx_forms_1.c"
    mark.touch()
    os.utime(mark, (time.time() - age,) * 2)
    asked = []

    def form(what, jit_options):
        asked.append(what)
        if not mark.exists() or len(asked) > waits:
            return "compiled"
        raise TimeoutError(ANSWER.format(mark))

    monkeypatch.setattr(_forms.fem, "form", form)
    assert _forms.compiled("form", _forms.MPI.COMM_SELF) == "compiled"
    assert len(asked) == waits + 1
    assert mark.exists() == (age < _forms.ABANDONED)


def test_other_failures_stay_failures(monkeypatch):
    def form(_, jit_options):
        raise RuntimeError("no compiler")

    monkeypatch.setattr(_forms.fem, "form", form)
    with pytest.raises(RuntimeError, match="no compiler"):
        _forms.compiled("form", _forms.MPI.COMM_SELF)


def test_a_compiler_without_the_fast_arguments_compiles_with_those_of_dolfinx(monkeypatch):
    asked = []

    def form(what, jit_options):
        asked.append(jit_options)
        if "-march=native" in jit_options["cffi_extra_compile_args"]:
            raise OSError("unrecognised argument")
        return what

    monkeypatch.setattr(_forms.fem, "form", form)
    assert _forms.compiled("form", _forms.MPI.COMM_SELF) == "form"
    fast, plain = asked
    assert fast["cffi_extra_compile_args"] == list(FAST)
    assert fast["cache_dir"] == plain["cache_dir"] / machine_key()


def test_who_has_set_arguments_for_dolfinx_has_chosen(monkeypatch):
    given = {"cffi_extra_compile_args": ["-O1"], "cache_dir": "here"}
    monkeypatch.setattr(_forms.dolfinx.jit, "get_options", lambda: given)
    monkeypatch.setattr(_forms.fem, "form", lambda _, jit_options: jit_options)
    assert _forms.compiled("form", _forms.MPI.COMM_SELF) == given


def _hyperelastic():
    """Force and tangent forms of a cube of neo-Hookean rubber, and its displacement."""
    from anisocontact.bulk import make_material
    from anisocontact.mesh import BoxSpec, build_box

    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
    u = _forms.fem.Function(model.space)
    u.x.array[:] = 0.05 * np.random.default_rng(3).standard_normal(len(u.x.array))
    rubber = make_material("neo-hookean", E=1.0, nu=0.3)
    v, du = (f(model.space) for f in (ufl.TestFunction, ufl.TrialFunction))
    energy = sum(density for density, _ in rubber.energy(u)) * ufl.dx(degree=2)
    force = ufl.derivative(energy, u, v)
    return u, force, ufl.derivative(force, u, du)


def test_fast_forms_are_those_of_the_default_arguments_and_keep_what_is_no_number():
    """Sums in another order: a few roundings; what is no number reaches every node of its cells."""
    u, force, tangent = _hyperelastic()
    plain = _forms.fem.assemble_vector(_forms.fem.form(force)).array
    fast_form = _forms.compiled(force, u.function_space.mesh.comm)
    fast = _forms.fem.assemble_vector(fast_form).array
    assert np.abs(fast - plain).max() <= 64 * np.finfo(float).eps * np.abs(plain).max()
    matrices = [
        FormMatrix(_forms.compiled(tangent, u.function_space.mesh.comm)).matrix.getValuesCSR()[2],
        _forms.fem.assemble_matrix(_forms.fem.form(tangent)).to_scipy().tocsr(),
    ]
    difference = np.sort(matrices[0]) - np.sort(matrices[1].data)
    assert np.abs(difference).max() <= 64 * np.finfo(float).eps * np.abs(matrices[0]).max()
    u.x.array[0] = np.nan
    plain = _forms.fem.assemble_vector(_forms.fem.form(force)).array
    fast = _forms.fem.assemble_vector(fast_form).array
    assert np.isnan(plain).any() and np.array_equal(np.isnan(fast), np.isnan(plain))


@pytest.mark.parametrize(
    "name", ["neo-hookean", "neo-hookean-incompressible", "plastic", "an energy"]
)
def test_a_form_keeps_its_name_whatever_was_made_before(monkeypatch, name):
    """All that one more body needs was compiled for the one before, which is the same.

    Source: the signature of UFL, under which FFCx keeps what it compiles. The numbers of variables
    are in it, and grow with all that a process has made: every run would compile anew.
    """
    import ffcx.naming

    from anisocontact.base.fenicsx import ufl
    from anisocontact.bulk import UserEnergy, make_material
    from anisocontact.mesh import BoxSpec, build_box
    from anisocontact.results.paraview import BodyGrid
    from anisocontact.solver import Problem

    names, signature = [], ffcx.naming.compute_signature

    def noted(*given):
        names.append(signature(*given))
        return names[-1]

    monkeypatch.setattr(ffcx.naming, "compute_signature", noted)

    def made():
        names.clear()
        model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        more = {"yield_stress": 1.0} if name == "plastic" else {}
        if name == "an energy":
            law = UserEnergy(lambda f: 0.5 * ufl.inner(f, f) - ufl.ln(ufl.det(f)), young=2.0)
        else:
            law = make_material(name, E=1.0, nu=0.3, **more)
        BodyGrid(Problem(model, {"bar": law}))
        return set(names)

    first, second, third = made(), made(), made()
    # UFL sorts by texts: once in a while a count gets one more digit, and a sum another order
    assert second <= first or third <= second


@pytest.mark.slow
def test_a_run_after_one_that_was_killed_while_it_compiled(tmp_path, case_text):
    """FFCx waits ten seconds for the mark, then the form is compiled anew."""
    (tmp_path / "case.toml").write_text(case_text)
    check = [sys.executable, "-m", "anisocontact", "check", str(tmp_path / "case.toml")]
    environment = os.environ | {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    cache = tmp_path / "cache" / "fenics" / machine_key()
    subprocess.run(check, env=environment, check=True, capture_output=True)
    marks = list(cache.glob("libffcx_forms_*.c"))
    assert marks
    for path in cache.iterdir():
        if path.suffix != ".c":
            shutil.rmtree(path) if path.is_dir() else path.unlink()
    for mark in marks:
        os.utime(mark, (time.time() - 2.0 * _forms.ABANDONED,) * 2)
    subprocess.run(check, env=environment, check=True, capture_output=True)
