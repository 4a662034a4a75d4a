"""Runs problems of meshed pairs on the processes it is started on, for `test_pairs_on_ranks`.

Usage: `mpirun -n N python -m tests.verification.pairs_on_ranks FOLDER MODE CASE...`

MODE "whole" writes what there is after all increments to `FOLDER/CASE-N-whole.npz`, "stop" also
a checkpoint after the second one to the folder `FOLDER/CASE-N-stop`; "from:M" goes on from where M
processes have stopped and writes `FOLDER/CASE-N-from-M.npz`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from tests.conftest import make_interface
from tests.verification.laws_in_python import RadialReturn
from tests.verification.test_fe_self_contact import GAP, hairpin

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import Augmentation, ContactLaw, PythonLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays
from anisocontact.results.checkpoint import (
    distribute,
    keep_checkpoint,
    load_checkpoint,
    own_arrays,
)
from anisocontact.results.files import Disk
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import Accepted, Problem, Solver, Step

#: Accepted increments before a run is stopped.
STOP = 2
#: Tolerance of Newton's method; multipliers that follow leave more round-off.
TOLERANCE, FOLLOWING = 1e-13, 1e-12
#: Cases of them.
WITH_MULTIPLIERS = ("following", "following-plane", "mortar-following", "mortar-plane")
#: Distance of the block from the mat.
GAP_BELOW = 0.01

#: Sides of a quarter that lie in planes of symmetry, and what is held there.
PLANES = (("left", "x"), ("front", "y"))

type Made = tuple[Problem, list[Step]]


def _law(angle: float = 0.5, mu: tuple[float, float] = (0.2, 0.4)) -> ContactLaw:
    along = make_directions("constant", vector=(1, 0, 0), angle=angle)
    return ContactLaw(
        NormalLaw(penalty=20.0),
        Adhesion(stiffness=(8.0, 16.0), directions=along),
        Friction(coefficients=mu, directions=along),
    )


def _bodies(
    cell: str = "hexahedron",
    order: int = 1,
    gap: float = GAP_BELOW,
    cells: tuple[tuple[int, int], tuple[int, int]] = ((4, 3), (7, 6)),
) -> Any:
    """A block just above a mat; nothing touches by rounding alone."""
    upper, lower = cells
    return build_box(
        {
            "block": BoxSpec((-2, -2, gap), (4, 4, 2), (*upper, 2), cell, order),
            "mat": BoxSpec((-6, -5, -3), (12, 10, 3), (*lower, 2), cell, order),
        }
    )


def _dragged(model: Any, contacts: list[Any], material: str = "neo-hookean") -> Made:
    """Press the block down, then drag it over several facets of the mat."""
    materials = {
        "block": make_material(material, E=8.0, nu=0.3),
        "mat": make_material(material, E=3.0, nu=0.3),
    }
    held = {"mat.bottom": dict.fromkeys("xyz", 0.0)}
    steps = [
        Step("press", 2, held | {"block.top": {"x": 0.0, "y": 0.0, "z": -0.2}}),
        Step("drag", 2, held | {"block.top": {"x": 2.0, "y": 0.3, "z": -0.25}}),
    ]
    return Problem(model, materials, contacts), steps


def _single() -> Made:
    model = _bodies("tetrahedron")
    return _dragged(model, [Contact(model, "block.bottom", "mat.top", law=_law(), mortar=False)])


def _in_python() -> Made:
    """A law written in Python, with what it remembers of the points."""
    model = _bodies("tetrahedron")
    along = make_directions("constant", vector=(1, 0, 0), angle=0.5)
    own = RadialReturn((8.0, 16.0), (0.2, 0.4))
    law = ContactLaw(NormalLaw(penalty=20.0), PythonLaw(own, directions=along))
    return _dragged(model, [Contact(model, "block.bottom", "mat.top", law=law, mortar=False)])


def _second_order() -> Made:
    model = _bodies("hexahedron", 2, cells=((3, 2), (4, 4)))
    return _dragged(model, [Contact(model, "block.bottom", "mat.top", law=_law(), mortar=False)])


def _mortar_matching() -> Made:
    """All edges of the block lie on edges of the mat, until it is dragged."""
    model = _bodies(cells=((2, 4), (6, 10)))
    return _dragged(model, [Contact(model, "mat.top", "block.bottom", law=_law(), mortar=True)])


def _far(
    slave: str = "block.bottom",
    master: str = "mat.top",
    lengths: tuple[int, int] = (2, 16),
    mortar: bool = False,
) -> Made:
    """A block that is drawn along a strip: it meets facets that were far away at the start."""
    block, strip = lengths
    model = build_box(
        {
            "block": BoxSpec((-4.9, -1.05, GAP_BELOW), (block, 2, 1), (block, 3, 1)),
            "mat": BoxSpec((-6, -1.5, -1), (strip, 3, 1), (strip, 3, 1)),
        }
    )
    pair = Contact(model, slave, master, law=_law(), reach=0.4, mortar=mortar)
    problem, steps = _dragged(model, [pair])
    along = steps[0].displacement | {"block.top": {"x": 6.0, "y": 0.2, "z": -0.2}}
    return problem, [steps[0], Step("drag", 5, along)]


def _mortar() -> Made:
    """The slave is cut between processes, and so is what is around its nodes."""
    model = _bodies("tetrahedron")
    return _dragged(model, [Contact(model, "mat.top", "block.bottom", law=_law(), mortar=True)])


def _mortar_second_order() -> Made:
    model = _bodies("tetrahedron", 2, cells=((2, 2), (4, 3)))
    return _dragged(model, [Contact(model, "mat.top", "block.bottom", law=_law(), mortar=True)])


def _mortar_far() -> Made:
    return _far("mat.top", "block.bottom", lengths=(4, 12), mortar=True)


def _mortar_symmetric() -> Made:
    """A quarter of two bodies that slip: nodes of both rest across the planes of symmetry."""
    model = build_box(
        {
            "block": BoxSpec((0, 0, 0), (2, 2, 1), (3, 3, 1), order=2),
            "mat": BoxSpec((0, 0, -1), (3, 3, 1), (4, 4, 1), order=2),
        }
    )
    law = _law(mu=(0.02, 0.04))
    pair = Contact(model, "mat.top", "block.bottom", law=law, mortar=True)
    problem, _ = _dragged(model, [pair], "linear-elastic")
    planes = {f"{body}.{side}": {axis: 0.0} for body in ("block", "mat") for side, axis in PLANES}
    held = planes | {"mat.bottom": {"z": 0.0}}
    return problem, [
        Step("press", 2, held | {"block.top": {"z": -0.05}}),
        Step("on", 1, held | {"block.top": {"z": -0.1}}),
    ]


def _mortar_following() -> Made:
    """Multipliers at slave nodes that follow every correction."""
    model = _bodies(gap=0.0)
    exact = Augmentation(tangential=False, multipliers="newton")
    pair = Contact(model, "mat.top", "block.bottom", law=_law(), augmentation=exact, mortar=True)
    return _dragged(model, [pair], "linear-elastic")


def _augmented(multipliers: str = "uzawa") -> Made:
    model = _bodies(gap=0.0)
    exact = Augmentation(tangential=False, multipliers=multipliers)
    pair = Contact(model, "block.bottom", "mat.top", law=_law(), augmentation=exact, mortar=False)
    return _dragged(model, [pair], "linear-elastic")


def _following() -> Made:
    """Multipliers that follow every correction."""
    return _augmented("newton")


def _mortar_plane() -> Made:
    return _following_plane(mortar=True)


def _following_plane(mortar: bool = False) -> Made:
    """The same on an analytic surface, with multipliers of friction too."""
    model = build_box({"block": BoxSpec((-2, -2, 0), (4, 4, 2), (4, 3, 2))})
    plane = make_interface(stiffness=(8.0, 16.0), penalty=20.0, coefficients=(0.2, 0.4), angle=0.5)
    exact = Augmentation(multipliers="newton")
    pair = Contact(model, "block.bottom", plane, augmentation=exact, mortar=mortar)
    problem = Problem(model, {"block": make_material("linear-elastic", E=8.0, nu=0.3)}, [pair])
    steps = [
        Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.2}}),
        Step("drag", 2, {"block.top": {"x": 0.4, "y": 0.1, "z": -0.25}}),
    ]
    return problem, steps


def _mortar_under_a_lid() -> Made:
    return _under_a_lid(mortar=True)


def _under_a_lid(mortar: bool = False) -> Made:
    """A free rigid lid presses the block on the mat: unknowns beyond those of the mesh."""
    model = _bodies()
    lid = RigidBody("lid", (0, 0, 2), free=True, springs={"x": 4.0, "y": 4.0, "rz": 40.0})
    plane = make_interface(
        point=(0, 0, 2 + GAP_BELOW),
        normal=(0, 0, -1),
        stiffness=(10.0, 20.0),
        penalty=20.0,
        angle=0.3,
    )
    pair = Contact(model, "block.bottom", "mat.top", law=_law(), current_area=False, mortar=mortar)
    top = Contact(model, "block.top", MovingSurface(plane, lid), mortar=mortar)
    problem, _ = _dragged(model, [pair, top], "linear-elastic")
    held = {"mat.bottom": dict.fromkeys("xyz", 0.0)}
    free = {"lid": dict.fromkeys(("x", "y", "rz"))}
    steps = [
        Step("press", 2, held, motion={"lid": {"z": -0.2}}),
        Step("push", 2, held, motion=free, load={"lid": {"x": 1.0, "y": -0.5, "rz": 1.0}}),
    ]
    return problem, steps


def _mortar_folded() -> Made:
    """Each rank finds the same side of the fold to be the slave.

    It closes askew: states of nodes in front of an edge have their components in the axes of the
    one facet or of the other, by rounding.
    """
    model = hairpin(half=False)
    law = ContactLaw(
        NormalLaw(penalty=2e4),
        Adhesion(stiffness=(1e4, 1e4)),
        Friction(coefficients=(0.02, 0.02)),
    )
    inner = "pin.inner"
    contact = Contact(model, inner, inner, law, self_contact=True, mortar=True, apart=0.3)
    problem = Problem(model, {"pin": make_material("neo-hookean", E=1000.0, nu=0.3)}, [contact])
    depth = 0.5 * GAP + 2e-3
    ends = {
        "pin.upper": {"x": 0.1, "y": 0.007, "z": -depth},
        "pin.lower": {"x": 0.0, "y": 0.0, "z": depth},
    }
    return problem, [Step("close", 4, ends)]


def _mortar_crack() -> Made:
    """A crack whose faces slide: its front, which both have, bears nothing on any process."""
    cells, middle, front = (6, 3, 4), 2, 4
    axes = [np.linspace(0.0, 1.0, count + 1) for count in cells]
    x = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    below = np.arange(len(x)).reshape([len(axis) for axis in axes])
    above, opened = below.copy(), below[:front, :, middle]
    above[:front, :, middle] = len(x) + np.arange(opened.size).reshape(opened.shape)
    near, far = slice(None, -1), slice(1, None)
    halves = below[:, :, : middle + 1], above[:, :, middle:]
    corners = [
        [half[i, j, k].ravel() for k in (near, far) for j in (near, far) for i in (near, far)]
        for half in halves
    ]
    rows = np.concatenate([np.stack(half, axis=1) for half in corners])
    sides = rows[:, CELL_FACETS["hexahedron"]].reshape(-1, 4)
    named = {
        "c.lower": (0, below[: front + 1, :, middle]),
        "c.upper": (1, above[: front + 1, :, middle]),
        "c.bottom": (0, below[..., 0]),
        "c.top": (1, above[..., -1]),
    }
    of_half = np.split(sides, 2)
    facets = {
        name: of_half[half][np.isin(of_half[half], nodes).all(axis=1)]
        for name, (half, nodes) in named.items()
    }
    face = x[opened.ravel()]
    face[:, 2] += 2e-3 * (axes[0][front] - face[:, 0])
    points, body = np.concatenate([x, face]), {"c": np.arange(len(rows))}
    model = Model.from_arrays(MeshArrays("hexahedron", 1, points, rows, body, facets, 1))
    pair = Contact(model, "c.upper", "c.lower", _law(), mortar=True)
    problem = Problem(model, {"c": make_material("linear-elastic", E=8.0, nu=0.3)}, [pair])
    held = {"c.bottom": dict.fromkeys("xyz", 0.0)}
    return problem, [
        Step("press", 2, held | {"c.top": {"z": -0.02}}),
        Step("slide", 2, held | {"c.top": {"x": 0.05, "y": 0.01, "z": -0.02}}),
    ]


CASES: dict[str, Callable[[], Made]] = {
    "single": _single,
    "in-python": _in_python,
    "second-order": _second_order,
    "far": _far,
    "far-condensed": _far,
    "augmented": _augmented,
    "following": _following,
    "following-plane": _following_plane,
    "under-a-lid": _under_a_lid,
    "mortar": _mortar,
    "mortar-matching": _mortar_matching,
    "mortar-second-order": _mortar_second_order,
    "mortar-far": _mortar_far,
    "mortar-folded": _mortar_folded,
    "mortar-crack": _mortar_crack,
    "mortar-following": _mortar_following,
    "mortar-plane": _mortar_plane,
    "mortar-iterative": _mortar,
    "mortar-condensed": _mortar,
    "mortar-under-a-lid": _mortar_under_a_lid,
    "mortar-symmetric": _mortar_symmetric,
}


def _facets(problem: Problem) -> np.ndarray:
    """Slave and, if meshed, master facets of the first contact on every rank, (ranks, 1 or 2)."""
    pair = problem.contacts[0]
    model = problem.model
    own = [
        int(np.sum(model.facets(name) < model.mesh.topology.index_map(2).size_local))
        for name in pair.groups
    ]
    return np.array(problem.comm.allgather(own))


def _had(problem: Problem) -> np.ndarray:
    """Facets of the master that every rank has, of every contact, (ranks, contacts)."""
    own = [len(pair.master.numbers) for pair in problem.contacts if pair.meshed]
    return np.array(problem.comm.allgather(own))


def _save(path: Path, solver: Solver, **more: Any) -> None:
    problem = solver.problem
    facets, had = _facets(problem), _had(problem)
    own, common = own_arrays(problem.model, solver.persistent())
    parts = problem.comm.gather(own)
    if parts is not None:
        arrays = {name: np.concatenate([part[name] for part in parts]) for name in own} | common
        np.savez(path, facets=facets, had=had, **arrays, **more)


def totals(accepted: Accepted) -> np.ndarray:
    """Energies, forces and moments of contacts, and reactions of an increment."""
    wrench = [np.concatenate(pair) for pair in accepted.resultants.values()]
    energies = np.array(list(accepted.energies.values()))
    return np.concatenate([energies, *wrench, *accepted.reactions.values()])


def run(name: str, folder: Path, mode: str) -> None:
    """One of `CASES`."""
    problem, steps = CASES[name]()
    ranks = problem.comm.size
    tolerance = FOLLOWING if name in WITH_MULTIPLIERS else TOLERANCE
    strategy = next((s for s in ("iterative", "condensed") if name.endswith(s)), "direct")
    solver = Solver(problem, steps, options={"snes_rtol": tolerance}, strategy=strategy)
    if mode.startswith("from:"):
        stored = load_checkpoint(folder / f"{name}-{mode[5:]}-stop")
        assert stored is not None
        assert len(stored.pieces) == (int(mode[5:]) if mode[5:] != "1" else 0)
        solver.restore(distribute(stored, problem.model, solver.persistent()))
    rows = []
    for count, accepted in enumerate(solver.run(), 1):
        rows.append(totals(accepted))
        if mode == "stop" and count == STOP:
            stop, disk = folder / f"{name}-{ranks}-stop", Disk(problem.comm)
            disk.write(stop.mkdir)
            keep_checkpoint(stop, disk, count, problem.model, solver.persistent(), {})
    kind = mode.replace(":", "-") if mode.startswith("from") else "whole"
    _save(folder / f"{name}-{ranks}-{kind}.npz", solver, numbers=np.array(rows))


if __name__ == "__main__":
    for case in sys.argv[3:]:
        run(case, Path(sys.argv[1]), sys.argv[2])
