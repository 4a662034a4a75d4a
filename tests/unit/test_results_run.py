"""The folder of a run against the problem it came from."""

from __future__ import annotations

import json
import re
import shutil
import tomllib
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact import __version__
from anisocontact.base.errors import InputError
from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.results import Results
from anisocontact.results.deformed import SHOWN, magnification
from anisocontact.results.output_options import Labels
from anisocontact.results.report import maps, shape, write_report
from anisocontact.results.report.run_data import RunData
from anisocontact.results.report_process import report_beside
from anisocontact.results.solids import Solid
from anisocontact.results.writer import Writer

# Sums of a few dozen numbers of the size of the result: round-off, no more.
ROUND_OFF = 1e-12


def run_case(path, folder, pictures=True):
    """Run a case into a folder; the problem in its last state."""
    file = load(path)
    built = build(file)
    writer = Writer(
        folder,
        built.problem,
        built.steps,
        replace(file.case.output.options(), pictures=pictures),
        Labels(file.case.title, [contact.master for contact in file.case.contact]),
        case=path.read_text(),
    )
    accepted = []
    for increment in built.solver.run():
        writer.accept(increment)
        accepted.append(increment)
    return SimpleNamespace(
        built=built, problem=built.problem, writer=writer, accepted=accepted, folder=folder
    )


@pytest.fixture(scope="module")
def run(tmp_path_factory, case_text):
    """The small case, run to its end, with its report."""
    folder = tmp_path_factory.mktemp("run")
    (folder / "case.toml").write_text(case_text)
    done = run_case(folder / "case.toml", folder / "out")
    done.writer.close("done")
    done.results = Results(folder / "out")
    return done


def test_a_time_that_was_not_written(run):
    times = len(run.results.times)
    for index in (times, -times - 1):
        with pytest.raises(InputError, match=f"index: {index} given, .* lists {times} times"):
            run.results.fields(index)


def test_summary_has_the_promised_keys(run):
    summary = run.results.summary
    promised = {
        "status", "message", "version", "wall_time_s", "unknowns", "steps", "newton_iterations",
        "contacts", "reactions", "energy",
    }  # fmt: skip
    assert promised <= set(summary)
    assert (summary["status"], summary["message"]) == ("done", "")
    assert summary["version"] == __version__
    assert summary["unknowns"] == 144
    assert summary["steps"] == 6
    assert summary["newton_iterations"] == sum(a.iterations for a in run.accepted)
    contact = summary["contacts"][0]
    assert (contact["slave"], contact["master"]) == ("block.bottom", "plate")
    assert {"force", "moment", "max_pressure", "max_penetration"} <= set(contact)
    assert set(contact["points"]) == {"open", "stick", "slip"}
    energies = {"external", "elastic", "adhesion", "friction", "stabilisation", "regularisation"}
    assert energies | {"residual"} <= set(summary["energy"])


def test_warning_says_the_worst_of_the_run(tmp_path, case_text):
    """A block that is lifted at the end was deepest when it was pressed, and the summary knows it.

    Source: 0.01 of a block of height 0.5 on springs a hundredth as stiff as it: nearly all of it.
    """
    text = case_text.replace("normal = { penalty = 1e4 }", "normal = { penalty = 20.0 }")
    text = text.replace("z = -0.01", "z = -0.05").replace("x = 0.02, y = 0.01", "z = 0.01")
    (tmp_path / "case.toml").write_text(text)
    done = run_case(tmp_path / "case.toml", tmp_path / "out", pictures=False)
    done.writer.close("done")
    contact = done.writer.summary["contacts"][0]
    assert contact["max_penetration"] == 0.0
    assert contact["worst_penetration"] > 0.045
    assert contact["worst_penetration_time"] == 1.0
    (said,) = [line for line in done.writer.summary["warnings"] if "penetration" in line]
    assert "was up to 15% of the facet size, at time 1;" in said


def test_a_layer_between_the_surfaces_is_no_penetration(tmp_path, case_text):
    """Requirement: who says that the penalty is the stiffness of a lining hears of no penetration,
    and the force is that of springs in series, penalty and bar, without a contraction.

    Source: 1/k = 1/20 + 0.5/1000 over the unit area. Tolerance: that of Newton's method.
    """
    text = case_text.replace("{ penalty = 1e4 }", "{ penalty = 20.0 }\nphysical_penalty = true")
    text = text.replace("nu = 0.3", "nu = 0.0").replace("z = -0.01", "z = -0.05")
    (tmp_path / "case.toml").write_text(text)
    done = run_case(tmp_path / "case.toml", tmp_path / "out", pictures=False)
    done.writer.close("done")
    assert not [line for line in done.writer.summary["warnings"] if "penetration" in line]
    pressed = done.writer.summary["contacts"][0]["force"][2]
    assert pressed == pytest.approx(0.05 / (1.0 / 20.0 + 0.5 / 1000.0), rel=1e-8)


@pytest.mark.parametrize("strategy", ["direct", "condensed"])
def test_summary_says_what_is_out_of_balance(tmp_path, case_text, strategy):
    """A tolerance that accepts what is no equilibrium is a warning of the summary as well.

    Source: the limit of 1e-4 of the forces at work; with 1e30 every state is taken as it comes.
    """
    options = f'[solver]\nstrategy = "{strategy}"\noptions = {{ snes_atol = 1e30 }}\n'
    (tmp_path / "case.toml").write_text(case_text + options)
    done = run_case(tmp_path / "case.toml", tmp_path / "out", pictures=False)
    done.writer.close("done")
    summary = done.writer.summary
    assert summary["unbalanced"][0] == done.accepted[0].time
    (said,) = [line for line in summary["warnings"] if "out of balance" in line]
    assert f"in {len(summary['unbalanced'])} increments or sub-increments" in said


def test_summary_is_the_last_increment(run):
    """Numbers of the file against those of the solver, the same doubles."""
    summary, last = run.results.summary, run.accepted[-1]
    force, moment = run.problem.contacts[0].resultant()
    assert summary["contacts"][0]["force"] == force.tolist()
    assert summary["contacts"][0]["moment"] == moment.tolist()
    assert summary["reactions"] == {"block.top": last.reactions["block.top"].tolist()}
    assert summary["energy"] == last.energies


def test_supports_balance_the_contact(run):
    """Equilibrium: what the plate gives the block, the support takes; to the Newton tolerance."""
    summary = run.results.summary
    force = np.array(summary["contacts"][0]["force"])
    assert np.allclose(summary["reactions"]["block.top"], -force, atol=1e-6 * np.abs(force).max())


def test_history_has_a_row_for_each_increment(run):
    history = run.results.history
    assert history["step"].tolist() == ["press"] * 2 + ["drag"] * 4
    assert history["increment"].tolist() == [1, 2, 1, 2, 3, 4]
    assert history["newton_iterations"].tolist() == [a.iterations for a in run.accepted]
    assert history["contacts.0.force.z"].tolist() == [
        a.resultants["block.bottom on plate"][0][2] for a in run.accepted
    ]
    # The prescribed displacement, ramped: the mean over the facets up to round-off.
    assert np.allclose(history["displacements.block.top.x"], [0, 0, 0.005, 0.01, 0.015, 0.02])
    assert not any("wall" in name for name in history)


def test_equal_runs_give_equal_tables(run, tmp_path, case_text):
    (tmp_path / "case.toml").write_text(case_text)
    again = run_case(tmp_path / "case.toml", tmp_path / "out")
    table = (again.folder / "history.csv").read_bytes()
    assert table == (run.folder / "history.csv").read_bytes()


def test_fields_are_written_when_due(run):
    """Every third increment, at the end of each step, and the start: 0, 2, 3, 6."""
    assert run.results.times == pytest.approx([0.0, 1.0, 1.25, 2.0])
    assert np.all(run.results.fields(0).point_data["displacement"] == 0.0)


def test_displacement_of_the_grid(run):
    grid = run.results.fields()
    u = run.problem.u.x.array.reshape(-1, 3)
    x = run.problem.model.space.tabulate_dof_coordinates()
    assert np.array_equal(grid.points, x)
    assert np.array_equal(grid.point_data["displacement"], u)


def test_slave_points_carry_the_resultant(run):
    """Areas times tractions are the resultant; traction is N n + T, T from its components."""
    points, contact = run.results.contact(), run.problem.contacts[0]
    data = {name: np.asarray(points.point_data[name]) for name in points.point_data}
    force = data["area"] @ data["traction"]
    assert np.allclose(force, contact.resultant()[0], rtol=ROUND_OFF)
    whole = data["pressure"][:, None] * data["normal"] + data["traction_t"]
    assert np.allclose(whole, data["traction"], atol=ROUND_OFF * data["pressure"].max())
    axes = np.stack([data["direction_friction_1"], data["direction_friction_2"]], axis=1)
    rebuilt = np.einsum("ni,nij->nj", data["traction_principal"], axes)
    assert np.allclose(rebuilt, data["traction_t"], atol=ROUND_OFF * data["pressure"].max())
    # T = -S e with S along the axes of adhesion, stiffness 4e3 and 1e3 along x and y.
    assert np.allclose(
        data["elastic_slip"] * [-4e3, -1e3, 0.0],
        data["traction_t"],
        atol=ROUND_OFF * data["pressure"].max(),
    )
    assert np.array_equal(data["status"], contact.last.status)
    assert np.array_equal(points.points, contact.points)
    assert data["slip_accumulated"].max() > 0.0
    assert data["dissipation"].min() >= 0.0


def test_case_file_is_kept(run, case_text):
    assert (run.folder / "case.toml").read_text() == case_text


def test_log_ends_like_the_run(run):
    assert (run.folder / "run.log").read_text().startswith(f"anisocontact {__version__}")


def test_report_is_one_file_with_all_pictures(run):
    text = (run.folder / "report.html").read_text()
    names = (*SHOWN, "pressure", "status", "traction", "domain", "force")
    assert text.count("data:image/png;base64,") == len(names)
    for name in names:
        assert (run.folder / "pictures" / f"{name}.png").stat().st_size > 5000
    # Nothing is loaded from elsewhere.
    assert not re.search(r"""(src|href)\s*=\s*["'](?!data:)""", text)
    assert "@import" not in text
    assert "Small block on a turned plate" in text


@pytest.fixture
def quick(monkeypatch):
    """Pictures in space by matplotlib, which is quicker for a body of a few cells."""
    monkeypatch.setattr(shape, "start_vtk", lambda *_: None)


def test_report_can_be_made_again_from_the_folder(quick, run):
    picture = run.folder / "pictures" / "force.png"
    before = picture.read_bytes()
    picture.unlink()
    assert write_report(run.folder) == []
    assert picture.read_bytes() == before


def test_a_picture_that_fails_does_not_cost_the_report(run, monkeypatch):
    def broken(*_: object) -> None:
        raise RuntimeError("no ink")

    monkeypatch.setattr(shape.Drawings, "finish", broken)
    names = ["deformed", "von_mises", "principal_stress"]
    failed = [f"picture {name}: RuntimeError: no ink" for name in names]
    assert write_report(run.folder) == failed
    assert (run.folder / "report.html").read_text().count("data:image/png") == 5


def test_without_graphics_matplotlib_draws(run, monkeypatch, tmp_path):
    """A renderer that dies, as VTK does without any OpenGL, leaves the run alone."""
    monkeypatch.setattr(shape, "_RENDERER", "anisocontact.no_such_module")
    names = sorted(SHOWN)
    with shape.Drawings(run.results.fields_file(), tmp_path, names, {}) as drawings:
        for name in names:
            drawings.finish(name)
            assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    assert sorted(entry.stem for entry in tmp_path.iterdir()) == names
    # The largest movement is 0.025 of a body whose diagonal is 1.5: a round magnification of 5.
    assert magnification(Solid(run.results.fields())) == 5.0


def test_a_report_is_drawn_beside_the_run(run, tmp_path):
    """By a process that waits; where it has ended by this one. Both give the same."""
    names = [f"{name}.png" for name in ("pressure", "status", "force", "deformed")]
    folder = tmp_path / "out"
    shutil.copytree(run.folder, folder)

    def pictures():
        found = [(folder / "pictures" / name).read_bytes() for name in names]
        shutil.rmtree(folder / "pictures")
        (folder / "report.html").unlink()
        return found

    with report_beside() as reporter:
        assert reporter(folder) == []
        first = pictures()
        assert reporter(folder) == []  # it has ended: this process draws
    assert pictures() == first


def test_bodies_that_move_far_are_true_to_scale(run):
    grid = run.results.fields()
    grid.point_data["displacement"] = np.full((grid.n_points, 3), 10.0 * grid.length)
    assert magnification(Solid(grid)) == 1.0


def test_maps_of_a_slave_that_moves_far(run):
    """Every panel shows its own place; with axes in common one of them would be out of sight."""
    data = RunData(run.folder)
    first, last = (data.view(moment.index, 0) for moment in data.ends())
    last.position += 100.0
    panels = maps.pressure(data, 0).axes
    for view, axes in zip((first, last), panels, strict=False):
        assert np.allclose(axes.get_xlim(), view.box[:, 0])


def test_maps_of_a_slave_that_moves_a_little(run):
    """Panels in common axes show all places: the last picture does not cut the first."""
    data = RunData(run.folder)
    first, last = (data.view(moment.index, 0) for moment in data.ends())
    last.position += 0.2
    for axes in maps.pressure(data, 0).axes[:2]:
        low, high = axes.get_xlim()
        assert low == min(first.box[0, 0], last.box[0, 0])
        assert high == max(first.box[1, 0], last.box[1, 0])
        assert high > first.box[1, 0]


def test_steps_and_moments_of_the_report(run):
    data = RunData(run.folder)
    assert [name for name, _ in data.steps] == ["press", "drag"]
    assert [m.title for m in data.moments] == [
        "press, increment 2",
        "drag, increment 1",
        "drag, increment 4",
    ]
    label, distance = data.path_length()
    assert "block.top" in label
    # 0.01 down, then sqrt(0.02^2 + 0.01^2) along the plate
    assert distance[-1] == pytest.approx(0.01 + np.hypot(0.02, 0.01))


def test_a_folder_is_readable_while_the_run_goes_on(tmp_path, case_text):
    (tmp_path / "case.toml").write_text(case_text)
    built = build(load(tmp_path / "case.toml"))
    writer = Writer(tmp_path / "out", built.problem, built.steps)
    results = Results(tmp_path / "out")
    assert results.summary["status"] == "stopped"
    assert results.summary["steps"] == 0
    assert results.history == {}
    for count, accepted in enumerate(built.solver.run(), start=1):
        writer.accept(accepted)
        assert results.summary["steps"] == count == len(results.history["time"])
        assert results.fields(-1).n_points == 48
    assert not list((tmp_path / "out").rglob(".*"))


def test_two_contacts_of_one_body(quick, tmp_path, case_text):
    """Each contact has its own numbers and pictures: a block between two plates."""
    data = tomllib.loads(case_text)
    assert len(data["contact"]) == 1
    second = """
[surface.wall]
shape = "plane"
point = [1.0, 0, 0]
normal = [-1, 0, 0]

[[contact]]
slave = "block.right"
master = "wall"
friction = { coefficients = 0.2 }
"""
    (tmp_path / "case.toml").write_text(case_text + second)
    done = run_case(tmp_path / "case.toml", tmp_path / "out")
    done.writer.close("done")
    contacts = json.loads((tmp_path / "out" / "summary.json").read_text())["contacts"]
    assert [contact["master"] for contact in contacts] == ["plate", "wall"]
    assert contacts[1]["force"][0] < 0.0 < contacts[0]["force"][2]
    assert np.unique(Results(tmp_path / "out").contact().point_data["contact"]).tolist() == [0, 1]
    names = {path.stem for path in (tmp_path / "out" / "pictures").iterdir()}
    assert {"deformed", "status-0", "status-1", "domain-1"} <= names
