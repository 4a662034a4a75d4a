"""Scripts: one import, which stays quick; steps with cuts, and going on from a file."""

from __future__ import annotations

import copy
import importlib
import pickle
import subprocess
import sys

import numpy as np
import pytest

import anisocontact
from anisocontact.base.errors import InputError


def test_names_are_those_of_their_packages():
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    for name, package in anisocontact._PACKAGE_OF.items():
        module = importlib.import_module(f"anisocontact.{package}")
        assert name in module.__all__
        assert getattr(anisocontact, name) is getattr(module, name)
    assert set(anisocontact.__all__) <= set(dir(anisocontact))
    with pytest.raises(AttributeError, match="no attribute 'Contract'"):
        _ = anisocontact.Contract
    assert anisocontact.__version__


@pytest.mark.parametrize(
    ("package", "before", "today"),
    [
        ("anisocontact", "Course", "LoadCurve"),
        ("anisocontact", "Expanding", "ThermalExpansion"),
        ("anisocontact.solver", "courses_of", "load_curves"),
        ("anisocontact.bulk", "bare", "without_expansion"),
        ("anisocontact.bulk", "Before", "PreviousState"),
        ("anisocontact.laws", "Carried", "CarriedDirections"),
        ("anisocontact.laws", "carried", "carried_directions"),
    ],
)
def test_names_of_before(package: str, before: str, today: str) -> None:
    """They are what they are called today, for one more version; others have not been there."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    module = importlib.import_module(package)
    with pytest.warns(DeprecationWarning, match=f"^{before} is now {today}$") as told:
        assert getattr(module, before) is getattr(module, today)
    # Python shows it only where the line is the script's own, not one of the package
    assert [one.filename for one in told] == [__file__]
    with pytest.raises(AttributeError, match="no attribute 'bare'"):
        _ = anisocontact.solver.bare


def test_a_module_of_before() -> None:
    """It has what is in that of today, by the names of before as well."""
    today = importlib.import_module("anisocontact.base.load_curve")
    with pytest.warns(DeprecationWarning, match="^anisocontact.base.course has moved: import from"):
        sys.modules.pop("anisocontact.base.course", None)
        before = importlib.import_module("anisocontact.base.course")
    with pytest.warns(DeprecationWarning, match="^Course is now LoadCurve$"):
        assert before.Course is today.LoadCurve


@pytest.mark.parametrize(
    ("before", "today"),
    [("inner_forces", "internal_forces"), ("flowed", "regularised"), ("guides", "inclined")],
)
def test_attributes_of_before(before: str, today: str) -> None:
    """As names: a problem has them by both, the one of before warns in the line of the script."""
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    problem = object.__new__(anisocontact.solver.Problem)
    vars(problem)[today] = "what it is today"
    with pytest.warns(
        DeprecationWarning, match=rf"^Problem\.{before} is now Problem\.{today}$"
    ) as t:
        assert getattr(problem, before) == "what it is today"
    assert [one.filename for one in t] == [__file__]


def test_an_import_brings_nothing_that_was_not_asked_for():
    """Points need no finite elements, and the package alone not even NumPy."""
    code = (
        "import sys, anisocontact; print('numpy' in sys.modules)\n"
        "anisocontact.Friction; print('dolfinx' in sys.modules, 'mpi4py' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout == "False\nFalse False\n"


@pytest.fixture
def pad():
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    import ufl
    from mpi4py import MPI

    from dolfinx import fem, mesh

    block = mesh.create_box(
        MPI.COMM_WORLD, [[0, 0, 0], [1, 1, 0.5]], [2, 2, 1], mesh.CellType.hexahedron
    )
    space = fem.functionspace(block, ("Lagrange", 1, (3,)))
    ends = [
        mesh.locate_entities_boundary(block, 2, lambda x, z=z: np.isclose(x[2], z))
        for z in (0.0, 0.5)
    ]
    facets = np.concatenate(ends)
    order = np.argsort(facets)
    values = np.repeat(np.array([3, 7], dtype=np.int32), [len(e) for e in ends])
    tags = mesh.meshtags(block, 2, facets[order], values[order])

    def problem(names=None):
        u, v = fem.Function(space), ufl.TestFunction(space)
        moved = fem.Constant(block, np.zeros(3))
        held = fem.dirichletbc(moved, fem.locate_dofs_topological(space, 2, ends[1]), space)
        strain = ufl.sym(ufl.grad(u))
        energy = 500.0 * ufl.inner(strain, strain) + 300.0 * ufl.tr(strain) ** 2
        residual = ufl.derivative(energy * ufl.dx, u, v)
        law = anisocontact.ContactLaw(
            anisocontact.NormalLaw(penalty=1e4),
            anisocontact.Adhesion(stiffness=1e4),
            anisocontact.Friction(coefficients=0.3),
        )
        plane = anisocontact.make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        if names is None:
            model, slave = anisocontact.Model.of(space, tags), "body.3"
        else:
            model, slave = anisocontact.Model.of(space, names, tags=tags), next(iter(names))
        contact = anisocontact.Contact(model, slave, plane, law, mortar=False)
        found = anisocontact.ContactProblem(residual, u, bcs=[held], contacts=[contact])
        return found, moved, contact

    return problem


def drag(moved):
    def lead(share):
        moved.value[:] = (0.01 * max(0.0, 2.0 * share - 1.0), 0.0, -0.01 * min(1.0, 2.0 * share))

    return lead


def test_steps_are_those_of_a_loop(pad, monkeypatch):
    """Requirement: increments by hand and by `solve_steps` give the same forces; one that fails is
    cut, and the callback hears of every part and may end the step."""
    by_hand, moved, contact = pad({"pad.sole": 3})
    for share in np.linspace(0.25, 1.0, 4):
        drag(moved)(share)
        by_hand.solve()
    force, _ = contact.resultant()
    assert contact.slave == "pad.sole"

    problem, moved, contact = pad()
    heard = []
    problem.solve_steps(drag(moved), 4, callback=lambda share, n: heard.append(share))
    assert heard == [0.25, 0.5, 0.75, 1.0]
    assert np.allclose(contact.resultant()[0], force, rtol=1e-9)

    problem, moved, contact = pad()
    solve, failures, heard = problem.solve, iter([True, False, True]), []

    def sometimes(dt):
        if next(failures, False):
            raise RuntimeError("no convergence")
        return solve(dt)

    monkeypatch.setattr(problem, "solve", sometimes)
    problem.solve_steps(
        drag(moved), 1, callback=lambda share, n: heard.append(share) or share > 0.5
    )
    assert heard[0] == 0.25
    assert heard == sorted(heard)
    assert 0.5 < heard[-1] < 1.0
    assert moved.value[0] == pytest.approx(0.01 * (2.0 * heard[-1] - 1.0))


def test_a_step_that_fails_leaves_what_was_accepted(pad, monkeypatch):
    problem, moved, _ = pad()

    def fails(dt):
        raise RuntimeError("no convergence")

    monkeypatch.setattr(problem, "solve", fails)
    limits = anisocontact.Limits(cuts=2)
    with pytest.raises(RuntimeError, match="no convergence"):
        problem.solve_steps(drag(moved), 2, limits=limits)
    assert not moved.value.any()
    with pytest.raises(InputError, match="increments: 0 given"):
        problem.solve_steps(drag(moved), 0)


@pytest.mark.parametrize("kind", [KeyboardInterrupt, MemoryError])
def test_whatever_ends_a_solution_leaves_what_was_accepted(pad, monkeypatch, kind):
    """Requirement: a script goes on from there also where it was no lack of convergence."""
    problem, moved, contact = pad()
    problem.solve_steps(drag(moved), 4)
    before, (force, _) = problem.u.x.array.copy(), contact.resultant()

    def breaks(x):
        problem.u.x.array[:] = np.nan
        raise kind

    with monkeypatch.context() as patch, pytest.raises(kind):
        patch.setattr(problem.newton, "solve", breaks)
        problem.solve()
    assert np.array_equal(problem.u.x.array, before)
    problem.solve()
    assert np.allclose(contact.resultant()[0], force, rtol=1e-9)


def test_goes_on_from_a_file(pad, tmp_path):
    """Requirement: with the history, sliding goes on as if nothing had come between."""
    path = tmp_path / "state.npz"
    problem, moved, contact = pad()
    problem.solve_steps(lambda s: drag(moved)(0.75 * s), 3)
    problem.save(path)
    drag(moved)(1.0)
    problem.solve()

    other, again, slave = pad()
    other.restore(path)
    drag(again)(1.0)
    other.solve()
    assert np.allclose(slave.resultant()[0], contact.resultant()[0], rtol=1e-9)
    assert np.allclose(slave.state["slip_accumulated"], contact.state["slip_accumulated"])
    np.savez(path, u=np.zeros(3))
    with pytest.raises(InputError, match="no state of a problem of this version"):
        other.restore(path)
    with pytest.raises(InputError, match="cannot be read"):
        other.restore(tmp_path / "none.npz")


@pytest.mark.parametrize("returned", [False, True])
@pytest.mark.parametrize("last", [2, 4])
def test_a_callback_that_restores_ends_the_step(pad, tmp_path, returned, last):
    """Requirement: a step does not go on from a state that is not its own.

    It went on behind its increments, with the history of an earlier one: the way between was done
    in one increment, without a word.
    """
    problem, moved, contact = pad()
    slips, path = [], tmp_path / "state.npz"

    def callback(share, _):
        slips.append(contact.state["slip_accumulated"].copy())
        if len(slips) == 1:
            problem.save(path)
        if len(slips) == last:
            problem.restore(path)
            return returned
        return False

    if returned or last == 4:
        problem.solve_steps(drag(moved), 4, callback=callback)
    else:
        with pytest.raises(InputError, match="callback: it restored a state, from which the step"):
            problem.solve_steps(drag(moved), 4, callback=callback)
    assert len(slips) == last
    assert np.array_equal(contact.state["slip_accumulated"], slips[0])


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04junk", b"\x93NUMPY"])
def test_a_file_that_is_none_is_one_line(pad, tmp_path, content):
    """Requirement: a state that was cut off, or is none, and a folder that is not there."""
    problem = pad()[0]
    (tmp_path / "state.npz").write_bytes(content)
    with pytest.raises(InputError, match=r"path: '.*state.npz' cannot be read"):
        problem.restore(tmp_path / "state.npz")
    with pytest.raises(InputError, match=r"path: '.*state.npz' cannot be written: No such file"):
        problem.save(tmp_path / "none" / "state.npz")


def test_laws_and_surfaces_go_to_other_processes():
    """Requirement: what a study hands to its workers can be copied and pickled, and answers alike.

    Source: the traction of a sliding point, the same bits.
    """
    pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)
    plane = anisocontact.make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    marks = anisocontact.make_directions("constant", vector=(1, 1, 0))
    friction = anisocontact.Friction(coefficients=(0.3, 0.1), directions=marks)
    adhesion = anisocontact.Adhesion(stiffness=50.0)
    made = anisocontact.Interface(plane, anisocontact.NormalLaw(penalty=100.0), adhesion, friction)
    answers = []
    for interface in (made, copy.deepcopy(made), pickle.loads(pickle.dumps(made))):
        start = interface.initial_state([[0.0, 0.0, -0.01]])
        answers.append(interface.update(start, [[0.1, 0.05, -0.01]]).traction.tobytes())
    assert len(set(answers)) == 1
