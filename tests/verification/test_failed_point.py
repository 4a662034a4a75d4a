"""A slave point whose law fails: written out whole, it answers alone what it answered in the run.

Requirement: a file of the results folder replays the point, on analytic and meshed masters, with
laws of the core and in Python. Source: the contact itself, with all its points. Tolerance: none
for state and traction, the same numbers go through the same code; tangents against central
differences, whose best step leaves 1e-7 or so of the largest entry.
"""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from tests.verification.laws_in_python import RadialReturn

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.cli import main
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, Interface, PythonLaw
from anisocontact.interface.description import described
from anisocontact.interface.failed_point import read_failed_point
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver.stepping.convergence_diagnostics import failed_point
from anisocontact.surfaces import make_surface

ALONG = make_directions("constant", vector=(1.0, 0.2, 0.0), angle=0.4)
LAWS = (
    NormalLaw(penalty=1e3),
    Adhesion(stiffness=(4e2, 1e2), directions=ALONG, directions_on="slave"),
    Friction(coefficients=(0.3, 0.1), directions=ALONG, sliding_rule="explicit", history="centre"),
)
OWN = (LAWS[0], PythonLaw(RadialReturn((4e2, 1e2), (0.3, 0.1)), directions=ALONG))
CYLINDER = make_surface("cylinder", point=(0, 0, -4), axis=(0, 1, 0), radius=4)


def on_surface(law: str) -> Contact:
    model = build_box({"block": BoxSpec((-0.5, -0.5, 0.0), (1, 1, 0.5), (2, 2, 1))})
    interface = Interface(CYLINDER, ContactLaw(*(LAWS if law == "core" else OWN)))
    body = RigidBody("drum", (0.0, 0.0, -4.0))
    body.move(z=0.05, rz=0.1)
    return Contact(model, "block.bottom", MovingSurface(interface, body), mortar=False)


def on_facets(law: str, mortar: bool = False) -> Contact:
    boxes = {
        "block": BoxSpec((-0.5, -0.5, 0.0), (1, 1, 0.5), (2, 2, 1)),
        "base": BoxSpec((-1, -1, -1), (2, 2, 1), (3, 3, 1)),
    }
    laws = ContactLaw(*(LAWS if law == "core" else OWN))
    return Contact(build_box(boxes), "block.bottom", "base.top", laws, mortar=mortar)


def at_nodes(law: str) -> Contact:
    return on_facets(law, mortar=True)


def moved(contact: Contact, way: tuple[float, float, float]) -> Any:
    """Displacements that move the block and bend everything a little, (nodes, 3)."""
    x = contact.space.mesh.geometry.x
    nodes = contact.space.tabulate_dof_coordinates()
    assert len(x) == len(nodes)
    u = 0.01 * np.sin(nodes @ np.array([[1.0, 2.0, 0.5], [0.3, 1.0, 2.0], [1.5, 0.2, 1.0]]))
    u[nodes[:, 2] >= 0.0] += way
    return u


@pytest.mark.parametrize("law", ["core", "python"])
@pytest.mark.parametrize("make", [on_surface, on_facets])
def test_a_point_alone_answers_as_in_the_run(make: Any, law: str, tmp_path: Any) -> None:
    contact = make(law)
    contact.update(moved(contact, (0.0, 0.0, -0.05)), 0.5)
    contact.commit()
    u = moved(contact, (0.35, 0.1, -0.06))
    whole = contact.update(u, 0.25)
    touching = np.flatnonzero(whole.status)
    assert touching.size
    point = int(touching[0])
    said = {"contact": contact.name, "point": point, "failure": "none"}
    contact.master.failed_point(point, contact.state, 0.25, **said).write(tmp_path / "point.json")
    read = read_failed_point(tmp_path / "point.json")
    alone = read.evaluate()
    assert alone.failure == ""
    for name in alone.state.dtype.names or ():
        if name != "facet":  # numbered among those of the file
            assert np.array_equal(alone.state[name][0], whole.state[name][point]), name
    traction = contact.master.into_frame(whole.traction[point])
    assert alone.traction == pytest.approx(traction, rel=1e-14)
    assert min(read.tangent_errors().values()) < 1e-6


@pytest.mark.parametrize("make", [on_surface, on_facets, at_nodes])
def test_a_point_that_is_kept_changes_nothing(make: Any) -> None:
    """The contact answers afterwards as one of which no point was kept, to the last bit.

    Requirement: an increment in smaller parts, after one in which a law has failed, is that of a
    run in which none has. Slave nodes with the number of another one had its history.
    """
    reference, contact = make("core"), make("core")
    answers, u = [], moved(reference, (0.35, 0.1, -0.06))
    for one in (reference, contact):
        one.update(moved(one, (0.0, 0.0, -0.05)), 0.5)
        one.commit()
        touching = np.flatnonzero(one.update(u, 0.25).status)
        for point in touching.tolist() if one is contact else ():
            said = {"contact": one.name, "point": point, "failure": "none"}
            one.master.failed_point(point, one.state, 0.25, **said)
        answers.append(one.update(u, 0.25))
    assert np.array_equal(answers[0].traction, answers[1].traction)
    assert answers[0].state.tobytes() == answers[1].state.tobytes()


@pytest.mark.parametrize("make", [on_surface, on_facets])
def test_the_first_point_by_its_place_is_kept(make: Any) -> None:
    """Of several that fail it is the same on any number of processes, whose points differ."""
    contact = make("core")
    failure = contact.update(moved(contact, (0.0, 0.0, -0.05)), 0.5).failure
    for some in (slice(None), slice(1, None, 2)):
        failure[:] = 0
        failure[some] = 1
        first = np.lexsort(np.round(contact.current.points[some], 8).T[::-1])[0]
        assert contact.failed_point().point == np.arange(len(failure))[some][first]


@pytest.mark.parametrize("rank", [0, 1])
def test_the_first_point_of_all_processes_is_kept(rank: int) -> None:
    """Requirement: of points on two processes the first by its place, on the process that has it.

    The process with the lower number has the one that is farther along x.
    """
    places = np.array([[2.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    told = [(number, *place) for number, place in enumerate(places.tolist())]
    contact = SimpleNamespace(
        failed_point=lambda: SimpleNamespace(point=0),
        current=SimpleNamespace(points=places[rank:]),
    )
    beside = SimpleNamespace(failed_point=lambda: None)
    answers = iter([[None, None], told])
    comm = SimpleNamespace(rank=rank, allgather=lambda own: next(answers))
    found = failed_point(SimpleNamespace(comm=comm, contacts=[beside, contact]))
    assert (found is not None) == (rank == 1)


def test_a_run_keeps_the_point_and_the_command_replays_it(
    tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    """Directions in a table that ends where the block is dragged to: the run stops there."""
    text = (Path(__file__).parents[1] / "unit" / "small_block.toml").read_text()
    table = (
        'kind = "tabulated-grid", counts = [2, 2], lower = [-2, -2], upper = [0.94, 2], '
        'interpolation = "bilinear", vectors = [1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0]'
    )
    text = text.replace('kind = "constant", vector = [1, 0, 0]', table)
    text = text.replace("normal = [0, 0, 1]", "normal = [0, 0, 1]\ntangent = [1, 0, 0]")
    text = text.replace("[[contact]]", '[[contact]]\npass = "single"')
    text = text.replace("[output]", "[solver]\ncuts = 0\n[output]\npictures = false")
    case, out = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(text)
    assert main(["run", str(case), "-o", str(out)]) == 3
    kept = out / "failed_point.json"
    assert f"anisocontact replay {kept}" in (out / "run.log").read_text()
    capsys.readouterr()
    assert main(["replay", str(kept), "--debug"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("point     ") and " of block.bottom on plate at 0.9" in lines[0]
    said = "the direction field has no direction there: singular, along the normal or out of its"
    assert sum(said in line for line in lines) == 2
    assert any(line.startswith("    traction ") for line in lines)
    case.write_text(text.replace("0.94, 2", "2, 2"))
    assert main(["run", str(case), "-o", str(out), "--overwrite"]) == 0
    assert not kept.exists()


LAW = """
import numpy as np
from anisocontact.interface import LawResult

class Fading:
    internal = 0

    def __init__(self, last):
        self.last = last

    def update(self, state, kinematics):
        n = len(kinematics.pressure)
        none, block = np.zeros((n, 2)), np.zeros((n, 2, 2))
        traction = np.where(kinematics.xi[:, :1] > self.last, np.nan, none)
        return LawResult(traction, none, block, none, block, block, state.internal, none[:, 0],
                         none[:, 0])
"""


def test_a_law_in_python_that_returns_no_number(
    tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    """The point is found among those that the law was evaluated for, and fails alone, too."""
    text = (Path(__file__).parents[1] / "unit" / "small_block.toml").read_text()
    first, last = text.index("adhesion ="), text.index("[[step]]")
    table = 'pass = "single"\n[contact.python]\nfile = "law.py"\nlaw = "Fading"\n'
    table += "arguments = { last = 0.94 }\n"
    text = text[:first] + table + "isotropic = true\n" + text[last:]
    text = text.replace("normal = [0, 0, 1]", "normal = [0, 0, 1]\ntangent = [1, 0, 0]")
    (tmp_path / "case.toml").write_text(text.replace("[output]", "[output]\npictures = false"))
    (tmp_path / "law.py").write_text(LAW)
    out = tmp_path / "out"
    assert main(["run", str(tmp_path / "case.toml"), "-o", str(out)]) == 3
    stopped = capsys.readouterr().err
    assert "traction: the law returned [nan, nan] at 6 of 36 points" in stopped
    assert main(["replay", str(out / "failed_point.json")]) == 2
    said = "error: traction: the law returned [nan, nan] at 1 of 1 points, finite numbers needed\n"
    assert capsys.readouterr().err == said


class Held:
    """A law that a file cannot keep."""

    def __init__(self) -> None:
        self.held = lambda: None


@pytest.mark.parametrize("text", ["", "[]", "{}", '{"kind": "OnSurface"}'])
def test_another_file_is_one_line(
    text: str, tmp_path: Any, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "other.json"
    path.write_text(text)
    assert main(["replay", str(path)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"error: '{path}' is no failed point of this version")


def test_a_law_that_no_file_can_keep() -> None:
    with pytest.raises(InputError, match="cannot be written to a file"):
        described(Held())
