"""The benchmarks' own parts: what other codes print is read, records are kept, tables are made."""

import sys
from pathlib import Path
from types import ModuleType

import pytest

from anisocontact.base import registry

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
DAT = """
 total force (fx,fy,fz) for set TOP and time  0.2000000E+00

        8.335455E-14  8.336517E-14 -2.641706E+00

 total force (fx,fy,fz) for set TOP and time  0.4000000E+00

        1.346188E-10  1.722636E-10 -5.254782E+00
"""
STA = """SUMMARY OF JOB INFORMATION
  STEP      INC     ATT  ITRS     TOT TIME     STEP TIME      INC TIME
     1          1     1     7  0.200000E+00  0.200000E+00  0.200000E+00
     1          2     1     4  0.400000E+00  0.400000E+00  0.200000E+00
"""


@pytest.fixture
def benchmarks(monkeypatch: pytest.MonkeyPatch):
    """Imports a module of the benchmarks; none of them stays."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    before = set(sys.modules)

    def module(name: str) -> ModuleType:
        __import__(name)
        return sys.modules[name]

    yield module
    for name in set(sys.modules) - before:
        if str(BENCHMARKS) in str(getattr(sys.modules[name], "__file__", "")):
            del sys.modules[name]


def record(benchmarks, code: str, wall: float, note: str = "", date: str = "2026-01-01"):
    names = ("commit", "compiler", "python", "processor", "cores", "version", "solver")
    made = dict.fromkeys(names, "x")
    names = ("processor s", "peak MB", "unknowns", "iterations", "normal force pressed")
    values = dict.fromkeys((*names, "tangential force partly", "tangential force at the end"), 1.0)
    values |= {"wall s": wall}
    kept = benchmarks("records").Record
    return kept("blocks", "plane", 12, code, {} if note else values, made | {"date": date}, note)


def test_calculix_output_is_read(benchmarks, tmp_path):
    (tmp_path / "case.dat").write_text(DAT)
    (tmp_path / "case.sta").write_text(STA)
    found = benchmarks("blocks.calculix").increments(tmp_path)
    assert [(one.normal, one.iterations) for one in found] == [(2.641706, 7), (5.254782, 4)]


def test_calculix_input_names_every_cell_and_facet(benchmarks, tmp_path):
    benchmarks("blocks.calculix").command("block", 4, tmp_path)
    text = (tmp_path / "case.inp").read_text()
    # 4 x 4 x 2 cells on 6 x 6 x 1
    assert text.count(", S1\n") == 16
    assert text.count(", S2\n") == 36
    assert "\n68, " in text


def test_resultants_need_every_increment(benchmarks):
    runs, code = benchmarks("blocks.runs"), benchmarks("blocks.code")
    whole = [code.Increment(0.1 * k, -0.2 * k, 2) for k in range(15)]
    found = runs.forces(whole)
    # after 5 increments of pressing; the third of the drag is at 0.006
    assert found["normal force pressed"] == pytest.approx(-0.8)
    assert found["tangential force partly"] == pytest.approx(0.7)
    assert found["iterations"] == 30
    with pytest.raises(ValueError, match="14 increments given, 15 needed"):
        runs.forces(whole[:-1])


def test_a_code_that_is_absent_has_no_version_and_is_left_out(benchmarks, monkeypatch, capsys):
    code, runs = benchmarks("blocks.code"), benchmarks("blocks.runs")
    monkeypatch.setenv("BENCH_PYTHON", "/nowhere/python")
    absent = code.Script("blocks.none", "import no_such_code", "none")
    assert absent.version() == ""
    monkeypatch.setitem(runs.CODES, "none", absent)
    assert list(runs.everything([4], ["plane"], ["none"], 1.0)) == []
    assert "none: not installed, left out" in capsys.readouterr().err


def test_the_time_limit_ends_a_process(benchmarks, tmp_path):
    used = benchmarks("measure").run([sys.executable, "-c", "input()"], tmp_path, 1, 60.0)
    assert used.status == 1
    command = [sys.executable, "-c", "import time; time.sleep(60)"]
    used = benchmarks("measure").run(command, tmp_path, 1, 0.3)
    assert used.status < 0
    assert used.wall < 10.0


def test_a_run_that_takes_too_long_says_how_far_it_came(benchmarks, monkeypatch):
    code, runs = benchmarks("blocks.code"), benchmarks("blocks.runs")
    endless = "import time; print('increment 1 2 3\\nincrement 2 3 4', flush=True); time.sleep(60)"
    slow = code.Script("blocks.none", "print('1.0')", "none")
    monkeypatch.setattr(code.Script, "command", lambda *_: [sys.executable, "-c", endless])
    monkeypatch.setitem(runs.CODES, "slow", slow)
    assert runs.one("slow", "plane", 4, 1.0).note == "2 of 15 increments in 1 s"


def test_a_record_replaces_that_of_the_same_run_only(benchmarks, tmp_path):
    records, path = benchmarks("records"), tmp_path / "records.json"
    records.store(
        [record(benchmarks, "anisocontact", 2.0), record(benchmarks, "CalculiX", 9.0)], path
    )
    records.store([record(benchmarks, "anisocontact", 3.0)], path)
    found = {one.code: one.values["wall s"] for one in records.load(path)}
    assert found == {"anisocontact": 3.0, "CalculiX": 9.0}


def test_pages_have_ratios_and_say_where_figures_come_from(benchmarks, tmp_path):
    made = [
        record(benchmarks, "anisocontact", 2.0, date="2026-01-02"),
        record(benchmarks, "CalculiX", 9.0),
        record(benchmarks, "NGSolve", 0.0, note="4 of 15 increments in 3600 s"),
    ]
    benchmarks("pages").write(made, tmp_path, tmp_path)
    text = (tmp_path / "blocks.md.in").read_text()
    assert "| 12 | 1 | CalculiX, x | 9.0 | 4.5 |" in text
    assert "4 of 15 increments in 3600 s" in text
    assert "- a: 2026-01-01" in text and "- b: 2026-01-02" in text
    assert text.count("| b |") == 1
    assert (tmp_path / "benchmarks-blocks.png").stat().st_size > 10_000


def test_the_command_runs_and_keeps(benchmarks, tmp_path):
    """Requirement: forces of the coarse block to 1e-4. Source: CalculiX 2.20, same mesh: 22.8364
    and 6.4937. Tolerance: it balances to 0.5 % of the mean force, 2.3e-4 of the forces here.
    """
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    path = tmp_path / "records.json"
    arguments = ["4", "--only", "anisocontact", "--problems", "plane", "--records", str(path)]
    benchmarks("run").main(arguments)
    (found,) = benchmarks("records").load(path)
    assert found.note == ""
    assert found.values["normal force pressed"] == pytest.approx(22.83644, rel=3e-4)
    assert found.values["tangential force at the end"] == pytest.approx(6.493652, rel=3e-4)
    assert found.values["peak MB"] > 50.0


@pytest.mark.slow
def test_finite_strain_agrees_with_a_dolfinx_script(benchmarks):
    """Requirement: forces to 1e-7. Source: an independent script in UFL of the same equations
    and points. Tolerance: both balance to 1e-8 of the forces at work.
    """
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    runs = benchmarks("finite_strain.runs")
    done = {
        name: runs.one(name, "plane", 4, 300.0) for name, way in runs.WAYS.items() if way.present
    }
    script = done.pop("DOLFINx script")
    for ours in done.values():
        assert ours.values["factorisations"] <= ours.values["iterations"]
        for name in ("normal force pressed", "tangential force at the end"):
            assert ours.values[name] == pytest.approx(script.values[name], rel=1e-7)
        assert 0.0 < runs.share(ours, "contact") < 1.0


def test_finite_strain_has_two_kinds(benchmarks):
    """What is no kind is none of them in disguise."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    with pytest.raises(ValueError, match="'mortar' given, must be one of plane, pair"):
        benchmarks("finite_strain.ours").case_text("mortar", 4)


def test_every_hard_case_is_a_case_file_that_says_what_is_hard(benchmarks, tmp_path):
    from anisocontact.case import load

    case = benchmarks("scoreboard.case")
    found = case.all_cases()
    assert len(found) >= 40
    for one in found:
        assert len(one.what) > 20
        for way in case.WAYS:
            path = tmp_path / "case.toml"
            path.write_text(one.written(way))
            read = load(path).case
            method = way.method.removeprefix("mortar-").replace("mortar", "penalty")
            assert {contact.method for contact in read.contact} == {method}, one.name
            mortar = way.method.startswith("mortar")
            assert {contact.mortar for contact in read.contact} == {mortar}, one.name
            assert read.solver.strategy == way.strategy


def outcome(benchmarks, **given):
    plain = {"case": "one", "method": "penalty", "strategy": "direct", "status": "done"}
    return benchmarks("scoreboard.outcome").Outcome(**plain | given)


def test_what_is_wrong_with_an_outcome(benchmarks):
    case, fault = benchmarks("scoreboard.case").HardCase, benchmarks("scoreboard.page").fault
    ends, stops = case("one", "# Ends.\n"), case("one", "# Slides.\n# stops: friction\n")
    assert fault(outcome(benchmarks), ends) == ""
    assert fault(outcome(benchmarks, status="refused"), ends) == ""
    assert fault(outcome(benchmarks, status="stopped", said="chattering"), ends)
    assert fault(outcome(benchmarks), stops)
    assert fault(outcome(benchmarks, status="stopped", said="friction holds 1"), stops) == ""
    assert fault(outcome(benchmarks, status="stopped", said="no convergence"), stops)
    assert fault(outcome(benchmarks, status="time", said="ended after 300 s"), stops)
    assert fault(outcome(benchmarks, energy=-0.06), ends)
    told = ("6 % of the energy is missing",)
    assert fault(outcome(benchmarks, energy=-0.06, warnings=told), ends) == ""


def test_outcomes_are_kept_and_the_page_is_made_from_them(benchmarks, tmp_path):
    kept = benchmarks("scoreboard.outcome")
    page, case = benchmarks("scoreboard.page"), benchmarks("scoreboard.case").HardCase
    found = [
        outcome(benchmarks, iterations=10, warnings=("hard",)),
        outcome(benchmarks, method="augmented", iterations=15, cuts=2),
        outcome(benchmarks, method="augmented", strategy="condensed", status="refused"),
        outcome(benchmarks, strategy="iterative", status="stopped", said="stuck"),
    ]
    kept.store({one.key: one for one in found}, {"commit": "x"}, tmp_path / "outcomes.json")
    read = kept.load(tmp_path / "outcomes.json")
    assert read == {one.key: one for one in found}
    page.write(read, [case("one", "# Ends.\n")], tmp_path)
    assert "| `one` | 10 | **stopped** | 15, 2 cuts | - |" in (tmp_path / "table.md.in").read_text()
    totals = (tmp_path / "totals.md.in").read_text()
    assert "| direct | augmented | 1 of 1 | 15 | 2 |" in totals
    assert "| condensed | augmented | 0 of 0 | 0 | 0 |" in totals
    assert (
        tmp_path / "faults.md.in"
    ).read_text() == "- `one`, penalty, iterative: stopped: stuck\n"


def test_rates_of_the_kernel_are_of_every_surface_and_rule(benchmarks, monkeypatch):
    rates = benchmarks("kernel_rates")
    monkeypatch.setattr(rates, "POINTS", 500)
    monkeypatch.setattr(rates, "PASSES", 1)
    assert {e.name for e in registry.sliding_rules()} == set(rates.RULES)
    assert {e.name for e in registry.surfaces()} == set(rates.SURFACES)
    # each says that its points slide, of which it is the rate
    assert len(rates.updates()) == len(rates.RULES) + len(rates.SURFACES) - 1
