"""What processes have of meshes that they share, for `test_mesh_on_ranks`.

Usage: `mpirun -n N python -m tests.unit.mesh_on_ranks FOLDER`

Meshes that the processes read or make together are compared with what one makes alone, and what
they hold is counted; rank 0 writes `FOLDER/counts.json`.
"""

from __future__ import annotations

import json
import sys
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI
from anisocontact.mesh import BallSpec, Body, BoxSpec, Model, Placement
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.gmsh import gmsh_arrays
from anisocontact.mesh.merge import merge

COMM = MPI.COMM_WORLD
#: Format, and whether it is binary.
FORMATS = [("4.1", False), ("4.1", True), ("2.2", False), ("2.2", True)]
CELLS = (14, 14, 12)


class Out:
    """Numbers as text or binary."""

    def __init__(self, binary: bool) -> None:
        self.binary = binary
        self.data = bytearray()

    def line(self, text: str) -> None:
        self.data += text.encode() + b"\n"

    def put(self, dtype: str, *numbers: Any) -> None:
        values = np.concatenate([np.atleast_1d(n) for n in numbers]).astype(dtype)
        if self.binary:
            self.data += values.tobytes()
        else:
            self.line(" ".join(repr(v) for v in values.tolist()))


def written(path: Path, version: str, binary: bool) -> Path:
    """A box of tetrahedra as volume "block" in two entities, with its bottom; nodes in disorder."""
    mesh = Body("block", BoxSpec((0, 0, 0), (1, 1, 1), CELLS, "tetrahedron")).arrays()
    order = np.random.default_rng(1).permutation(len(mesh.points))
    tags = 3 * order + 7
    half = len(mesh.cells) // 3
    blocks = [
        (2, 5, 2, tags[mesh.facets["block.bottom"]]),
        (3, 8, 4, tags[mesh.cells[:half]]),
        (3, 9, 4, tags[mesh.cells[half:]]),
    ]
    out = Out(binary)
    out.line(f"$MeshFormat\n{version} {int(binary)} 8")
    if binary:
        out.put("<i4", 1)
    out.line('$EndMeshFormat\n$PhysicalNames\n2\n2 1 "bottom"\n3 2 "block"\n$EndPhysicalNames')
    (_four if version == "4.1" else _two)(out, mesh.points, tags, blocks)
    path.write_bytes(bytes(out.data))
    return path


def _four(out: Out, points: np.ndarray, tags: np.ndarray, blocks: list[Any]) -> None:
    out.line("$Entities")
    out.put("<i8", 0, 0, 1, 2)
    for dim, tag, _, _ in blocks:
        out.put("<i4", tag)
        out.put("<f8", np.zeros(6))
        out.put("<i8", 1)
        out.put("<i4", dim - 1)
        out.put("<i8", 0)
    out.line("$EndEntities\n$Nodes")
    out.put("<i8", 2, len(points), tags.min(), tags.max())
    cut = len(points) // 5
    for tag, some in ((8, slice(0, cut)), (9, slice(cut, None))):
        out.put("<i4", 3, tag, 0)
        out.put("<i8", len(tags[some]))
        for number in tags[some]:
            out.put("<i8", number)
        for point in points[some]:
            out.put("<f8", point)
    out.line("$EndNodes\n$Elements")
    out.put("<i8", 3, sum(len(n) for *_, n in blocks), 1, 1)
    for dim, tag, kind, nodes in blocks:
        out.put("<i4", dim, tag, kind)
        out.put("<i8", len(nodes))
        for row in nodes:
            out.put("<i8", 1, row)
    out.line("$EndElements")


def _two(out: Out, points: np.ndarray, tags: np.ndarray, blocks: list[Any]) -> None:
    out.line(f"$Nodes\n{len(points)}")
    for tag, point in zip(tags, points, strict=True):
        if out.binary:
            out.put("<i4", tag)
            out.put("<f8", point)
        else:
            out.line(f"{tag} " + " ".join(map(repr, point.tolist())))
    out.line(f"$EndNodes\n$Elements\n{sum(len(n) for *_, n in blocks)}")
    for dim, tag, kind, nodes in blocks:
        if out.binary:
            out.put("<i4", kind, len(nodes), 2)
        for row in nodes:
            head = [1] if out.binary else [1, kind, 2]
            out.put("<i4", *head, dim - 1, tag, row)
    out.line("$EndElements")


def gathered(mesh: MeshArrays) -> MeshArrays:
    """All shares of a mesh."""
    together = [np.concatenate(COMM.allgather(a)) for a in (mesh.points, mesh.cells, mesh.labels)]
    points, cells, labels = together
    bodies = {name: np.flatnonzero(labels == i) for i, name in enumerate(mesh.bodies)}
    facets = {k: np.concatenate(COMM.allgather(v)) for k, v in mesh.facets.items()}
    return MeshArrays(
        mesh.cell, mesh.degree, points, cells, bodies, facets, mesh.order, mesh.linear
    )


def check_same(one: MeshArrays, other: MeshArrays) -> None:
    """The same points, cells and groups with the same numbers."""
    assert np.array_equal(one.points, other.points)
    assert np.array_equal(one.cells, other.cells)
    assert list(one.bodies) == list(other.bodies)
    assert all(np.array_equal(one.bodies[n], other.bodies[n]) for n in one.bodies)
    assert list(one.facets) == list(other.facets)
    for name in one.facets:
        rows = [x.facets[name][np.lexsort(x.facets[name].T)] for x in (one, other)]
        assert np.array_equal(*rows), name
    assert (one.order, one.linear, one.degree) == (other.order, other.linear, other.degree)


def measured(make: Callable[[Any], MeshArrays]) -> dict[str, float]:
    """Largest share of any process over what there is, and peak of memory over that of one."""
    peaks = []
    for comm in (COMM, MPI.COMM_SELF):
        tracemalloc.start()
        mesh = make(comm)
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
        if comm is COMM:
            shared = mesh
    check_same(gathered(shared), mesh)
    model, cells = Model.from_arrays(shared), len(mesh.cells)
    assert model.mesh.topology.index_map(3).size_global == cells
    kept = [len(shared.points) / len(mesh.points), len(shared.cells) / cells, peaks[0] / peaks[1]]
    return dict(zip(("nodes", "cells", "peak"), np.max(COMM.allgather(kept), axis=0), strict=True))


def bodies(comm: Any, n: int = 1) -> MeshArrays:
    """Curved and straight cells, two orders, blocks that close on each other."""
    ball = BallSpec(1.0, (8 * n, 2 * n), "half", "tetrahedron", 2)
    box = BoxSpec((-2, -2, -2), (4, 4, 1), (6 * n, 5 * n, 2 * n), "tetrahedron")
    up = Placement(move=(0.0, 0.0, 0.1))
    return merge([Body("ball", ball, up).arrays(comm), Body("box", box).arrays(comm)])


def damaged(path: Path) -> int:
    """How often a damaged file is refused: by all processes with one line, or by none."""
    data, chance, refused = path.read_bytes(), np.random.default_rng(5), 0
    for trial in range(30):
        text = bytearray(data)
        for place in chance.integers(len(data), size=5):
            text[place] = chance.integers(256)
        if trial % 2:
            del text[chance.integers(len(data)) :]
        other = path.with_suffix(f".{trial}.msh")
        if COMM.rank == 0:
            other.write_bytes(text)
        COMM.barrier()
        said = ""
        try:
            gmsh_arrays(other, comm=COMM)
        except InputError as error:
            said = str(error)
        assert len(set(COMM.allgather(said))) == 1
        refused += bool(said)
    return refused


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    found: dict[str, Any] = {}
    bodies(MPI.COMM_SELF)  # modules that are imported on the way are not memory of a mesh
    for version, binary in FORMATS:
        path = folder / f"{version}-{binary}.msh"
        if COMM.rank == 0:
            written(path, version, binary)
        COMM.barrier()
        found[f"{version} {'binary' if binary else 'text'}"] = measured(
            lambda comm, path=path: gmsh_arrays(path, comm=comm)
        )
    check_same(gathered(bodies(COMM)), bodies(MPI.COMM_SELF))
    found["shapes"] = measured(lambda comm: bodies(comm, 2))
    found["refused"] = [damaged(folder / f"{v}-{b}.msh") for v, b in FORMATS[:2]]
    if COMM.rank == 0:
        (folder / "counts.json").write_text(json.dumps(found))
