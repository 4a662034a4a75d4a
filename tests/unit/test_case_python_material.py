"""Materials of a case file that are classes in a Python file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.cli import main
from anisocontact.results import Results
from anisocontact.results.no_energy import NO_ENERGY

FILE = """
import numpy as np
import ufl
from anisocontact.bulk import PointResult

class Energy:
    young = 3.0
    def energy(self, F):
        return ufl.inner(F, F) / 2 - 3 / 2 - ufl.ln(ufl.det(F))

class Stress:
    young = 3.0
    def piola(self, F):
        return F - ufl.inv(F).T

class Counting:
    history = {"times": ()}
    def __init__(self, young=3.0):
        self.young = young
    def update(self, state):
        eye = np.eye(3)
        unit = 0.5 * (np.einsum("ik,jl", eye, eye) + np.einsum("il,jk", eye, eye))
        stress = self.young * state.strain
        slope = np.tile(self.young * unit, (len(stress), 1, 1, 1, 1))
        after = {"times": state.before["times"] + 1.0}
        return PointResult(stress, slope, after)
"""
CASE = """
[mesh.box.bar]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [1, 1, 1]

[material.bar]
model = "python"
file = "own.py"
law = "{law}"
{more}

[[step]]
name = "pull"
increments = 2
[step.displacement]
"bar.bottom" = {{ z = 0 }}
"bar.left" = {{ x = 0 }}
"bar.front" = {{ y = 0 }}
"bar.top" = {{ z = 0.02 }}

[output]
pictures = false
"""


def _case(folder: Path, law: str, more: str = "", change: tuple[str, str] = ("", "")) -> str:
    (folder / "own.py").write_text(FILE.replace(*change))
    (folder / "case.toml").write_text(CASE.format(law=law, more=more))
    return str(folder / "case.toml")


@pytest.mark.parametrize("law", ["Energy", "Stress"])
def test_energy_and_stress(tmp_path: Path, law: str) -> None:
    """Uniaxial tension of `W = (tr C - 3 - 2 ln J)/2`: the sides stay, the force is `s - 1/s`.

    Tolerance: 1e-8, Newton's method. The energy of a stress is not known."""
    out = tmp_path / "out"
    assert main(["run", _case(tmp_path, law), "-o", str(out)]) == 0
    found = Results(out)
    force = found.history["reactions.bar.top.z"][-1]
    assert force == pytest.approx(1.02 - 1 / 1.02, rel=1e-8)
    stored = found.summary["energy"]["elastic"]
    if law == "Energy":
        assert stored == pytest.approx(0.5 * (1.02**2 - 1.0) - np.log(1.02), rel=1e-8)
    else:
        assert stored == NO_ENERGY


def test_law_of_points(tmp_path: Path) -> None:
    """A law at small strain without lateral contraction: `E e`, to Newton's tolerance."""
    out, case = tmp_path / "out", _case(tmp_path, "Counting", "arguments = { young = 5.0 }")
    assert main(["run", case, "-o", str(out)]) == 0
    force = Results(out).history["reactions.bar.top.z"]
    np.testing.assert_allclose(force, [0.05, 0.1], rtol=1e-8)


@pytest.mark.parametrize(
    ("law", "change", "said"),
    [
        ("Stres", ("", ""), "material.bar.law: \"Stres\" given, no such class in 'own.py'"),
        ("Stress", ("young = 3.0", "young = 0"), "Stress.young is 0, Young's modulus"),
        ("Stress", ("def piola", "def cauchy"), "Stress has no method energy(F), piola(F) or"),
        ("Stress", ("F - ufl.inv(F).T", "F - G"), "own.py, line 14: NameError"),
        ("Energy", ("ufl.inner(F, F) / 2", "F"), "Energy.energy failed"),
        ("Stress", ("F - ufl.inv(F).T", "ufl.det(F)"), "of shape (), (3, 3) needed"),
        ("Counting", ("self.young * state.strain", "np.zeros(2)"), "(2,), (2, 3, 3) needed"),
        ("Counting", ('["times"] + 1.0', '["turns"]'), "the law Counting failed: own.py, line"),
        ("Counting", ('after = {"times"', 'after = {"turns"'), "returned other variables: turns"),
        ("Counting", ("slope, after)", "slope, None)"), "returned other variables: none given"),
        ("Counting", ("return PointResult(stress, slope, after)", "return 1"), "returned a int"),
        ("Counting", ("history =", "strain = 'big'; history ="), "'big' given, allowed: small"),
        ("Counting", ("young=3.0", "E=3.0"), "own.py, line 19: NameError"),
        ("Counting", ("eye = np.eye(3)", "raise SystemExit(0)"), "own.py, line 21: SystemExit: 0"),
        ("Stress", ("return F -", "exit(0); F -"), "Stress.piola failed: own.py, line 14: System"),
        ("Counting", ("self.young * state", "1j * state"), "an array of real numbers needed"),
        ("Counting", ("eye = np.eye(3)", "state.strain[:] = 0"), "own.py, line 21: ValueError"),
    ],
)
def test_mistakes_are_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], law: str, change: tuple[str, str], said: str
) -> None:
    """What is wrong in the file is one line, before anything is solved."""
    assert main(["check", _case(tmp_path, law, change=change)]) != 0
    (told,) = capsys.readouterr().err.strip().splitlines()
    assert said in told


def test_not_run_when_asked_not_to(tmp_path: Path) -> None:
    """`check --no-python` looks at everything else."""
    case = _case(tmp_path, "Stress", change=("class Energy", "raise SystemExit\nclass Energy"))
    assert main(["check", case, "--no-python"]) == 0
    assert main(["check", case]) != 0


def test_changed_file_ends_a_restart(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A run does not go on with another material."""
    out, case = tmp_path / "out", _case(tmp_path, "Stress")
    assert main(["run", case, "-o", str(out)]) == 0
    _case(tmp_path, "Stress", change=("F - ufl", "2 * F - 2 * ufl"))
    assert main(["run", case, "-o", str(out), "--restart"]) != 0
    assert "material.bar.file: 'own.py' has changed" in capsys.readouterr().err


#: A spring that tells twice what it stores, and what is too much as dissipated below nothing.
GIVING = """        after = {"times": 0.5 * np.einsum("nij,nij->n", stress, state.strain)}
        grown = after["times"] - state.before["times"]
        return PointResult(stress, slope, after, (1.0 + MORE) * after["times"], -MORE * grown)"""


@pytest.mark.parametrize(("more", "told"), [("1.0", True), ("0.0", False)])
def test_a_material_that_gives_energy_is_told(tmp_path, capsys, more, told):
    """Requirement: dissipation below zero is a warning that names the body, though the balance of
    energy closes: what is stored is as much too large. Source: the second law.
    """
    end = '        after = {"times": state.before["times"] + 1.0}\n'
    end += "        return PointResult(stress, slope, after)"
    case = _case(tmp_path, "Counting", change=(end, GIVING.replace("MORE", more)))
    assert main(["run", case, "-o", str(tmp_path / "out")]) == 0
    said = "increment 1: body 'bar': its material gave "
    assert (said in capsys.readouterr().err) == told
    summary = Results(tmp_path / "out").summary
    assert any(said in line for line in summary["warnings"]) == told
    assert (summary["energy"]["inelastic"] < 0.0) == told
    assert summary["energy_residual"]["worst_share"] < 1e-8
