"""The state of a run through its file and back."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import ufl
from anisocontact.case import load
from anisocontact.case.build import build
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.results import checkpoint
from anisocontact.solver import Problem, Solver, Step


def test_another_order_of_nodes_finds_its_own(case, whole):
    """Other ranks number nodes and points in another order: they are found by their positions."""
    built = build(load(case))
    stored = checkpoint.load_checkpoint(whole)
    assert stored is not None
    like = built.solver.persistent()
    wanted = checkpoint.distribute(stored, built.problem.model, like)
    chance = np.random.default_rng(3)
    shuffled = {}
    order = {
        "n": chance.permutation(len(stored.arrays["node/body"])),
        "p": chance.permutation(len(stored.arrays["points/0/reference"])),
    }
    for name, values in stored.arrays.items():
        shuffled[name] = values[order[name[0]]] if name[0] in order else values
    found = checkpoint.distribute(
        checkpoint.Stored(shuffled, stored.facts), built.problem.model, like
    )
    assert all(np.array_equal(found.nodal[n], v) for n, v in wanted.nodal.items())
    assert all(np.array_equal(found.points[0][n], v) for n, v in wanted.points[0].items())
    shuffled["nodal/position"] = shuffled["nodal/position"] + 1e-3
    with pytest.raises(InputError, match="the mesh is not as in the run that is to go on"):
        checkpoint.distribute(checkpoint.Stored(shuffled, stored.facts), built.problem.model, like)


def test_points_of_another_number_of_processes_are_told(case, whole, tmp_path):
    """Requirement: where the points are others, not the mesh, the line says so and what to do."""
    built = build(load(case))
    stored = checkpoint.load_checkpoint(whole)
    assert stored is not None
    like, model = built.solver.persistent(), built.problem.model
    name = "points/0/reference"
    moved = stored.arrays | {name: stored.arrays[name] + 1e-3}
    wrong = "points of a contact or a material are not as in the run that is to go on: nothing was"
    with pytest.raises(InputError, match=wrong + r" at \([^)]*\)$"):
        checkpoint.distribute(checkpoint.Stored(moved, stored.facts), model, like)
    path = tmp_path / "piece.npz"
    np.savez(path, **moved)
    of_two = checkpoint.Stored(moved, stored.facts, (path, path))
    with pytest.raises(InputError, match=wrong + r" at .*; it had another number of processes"):
        checkpoint.distribute(of_two, model, like)


HISTORY = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [2, 2, 2]
order = 2
cell = "tetrahedron"
[material.block]
model = "viscoelastic"
E = 10
nu = 0.2
g = [0.3]
tau = [0.7]
strain = "logarithmic"
[[step]]
name = "press"
increments = 1
displacement = { "block.bottom" = { x = 0, y = 0, z = 0 }, "block.top" = { z = -0.01 } }
"""


def test_points_of_cells_that_meet_find_their_own(tmp_path):
    """Points of a rule of tetrahedra lie on their faces, two in one place with two histories.

    Other ranks number points in another order: on another number of processes a viscoelastic block
    went on with what its neighbours had gone through, 5e-5 off in the force.
    """
    path = tmp_path / "case.toml"
    path.write_text(HISTORY)
    built = build(load(path))
    model, kept = built.problem.model, built.solver.persistent()
    wanted = np.arange(1.0, 1.0 + len(kept.points[0]["stored"]))[:, None]
    kept.points[0]["stored"] = wanted
    own, common = checkpoint.own_arrays(model, kept)
    order = np.random.default_rng(3).permutation(len(wanted))
    shuffled = {n: v[order] if n.startswith("points/0/") else v for n, v in own.items()}
    stored = checkpoint.Stored(common | shuffled, {})
    found = checkpoint.distribute(stored, model, built.solver.persistent())
    assert np.array_equal(found.points[0]["stored"], wanted)


VARIANTS = {
    "augmented": {"normal = { penalty = 1e5 }": 'method = "augmented"'},
    "finite strain": {'model = "linear-elastic"': 'model = "neo-hookean"'},
    "heated": {
        'model = "linear-elastic"': 'model = "linear-elastic"\nexpansion = 1e-3',
        'displacement = { "block.top" = { x = 0.02': (
            'temperature = { block = 3 }\ndisplacement = { "block.top" = { x = 0.02'
        ),
    },
    "heated, with a history": {
        'model = "linear-elastic"': (
            'model = "viscoelastic"\ng = [0.3]\nk = [0.2]\ntau = [0.5]\nexpansion = 1e-3'
        ),
        'displacement = { "block.top" = { x = 0.02': (
            'temperature = { block = 3 }\ndisplacement = { "block.top" = { x = 0.02'
        ),
    },
    "unsupported": {
        "origin = [0, 0, 0]": "origin = [0, 0, 0.05]",
        'displacement = { "block.top" = { x = 0, y = 0, z = -0.01 } }': (
            'force = { "block.top" = { z = -5 } }'
        ),
        'displacement = { "block.top" = { x = 0.02, y = 0.01 } }': (
            'force = { "block.top" = { x = 0.3 } }'
        ),
    },
}


@pytest.mark.parametrize("variant", VARIANTS)
@pytest.mark.parametrize("at", [0, 2])
def test_every_state_counts(case, variant, at):
    """Through the file and back: what follows is the same bit by bit, whatever has a history."""
    text = case.read_text()
    for old, new in VARIANTS[variant].items():
        assert old in text
        text = text.replace(old, new)
    case.write_text(text)
    first, second = build(load(case)), build(load(case))
    later = []
    for count, accepted in enumerate(first.solver.run()):
        if count == at:
            model = first.problem.model
            own, common = checkpoint.own_arrays(model, first.solver.persistent())
            checkpoint.save_checkpoint(case.parent, own | common, {})
        elif count > at:
            later.append(accepted)
    stored = checkpoint.load_checkpoint(case.parent)
    assert stored is not None
    like = second.solver.persistent()
    second.solver.restore(checkpoint.distribute(stored, second.problem.model, like))
    again = list(second.solver.run())
    assert len(again) == len(later) == 5 - at
    for a, b in zip(later, again, strict=True):
        assert (a.time, a.iterations, a.residuals) == (b.time, b.iterations, b.residuals)
        assert a.energies == b.energies
    assert np.array_equal(first.problem.u.x.array, second.problem.u.x.array)


class _Damped:
    """A spring beside a dashpot, whose force nothing but the increment tells."""

    linear, young = False, 1.0
    history: ClassVar = {"strain": (3, 3)}

    def advance(self, u, before):
        return {"strain": ufl.sym(ufl.grad(u))}

    def piola(self, u, before):
        strain = ufl.sym(ufl.grad(u))
        rate = ufl.conditional(ufl.gt(before.dt, 0.0), 1.0 / before.dt, 0.0)
        return strain + rate * (strain - before["strain"])


@pytest.mark.parametrize("anew", [True, False])
def test_internal_forces_of_a_state_that_is_restored(anew):
    """What cells carry in a state is the same once it is restored, in a new problem or its own.

    Requirement: bit by bit; the top carries spring and dashpot, 1e-9. Source: a uniform strain of
    0.05 and its rate, 0.1. Tolerance: Newton. A new problem told the spring alone, its own one what
    it had carried last.
    """

    def made():
        model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
        planes = ["bar.left", "bar.front", "bar.bottom"]
        problem = Problem(model, {"bar": _Damped()}, symmetry=planes)
        return Solver(problem, [Step("pull", 2, {"bar.top": {"z": 0.1}}), Step("hold", 1)])

    first = made()
    for count, _ in enumerate(first.run()):
        if count == 0:
            kept, wanted = first.persistent(), first.problem.internal_forces().copy()
    second = made() if anew else Solver(first.problem, first.steps)
    second.restore(kept)
    assert np.array_equal(second.problem.internal_forces(), wanted)
    top = first.problem.model.nodes("bar.top")
    assert wanted[top, 2].sum() == pytest.approx(-0.05 - 0.1, rel=1e-9)
