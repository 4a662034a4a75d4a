"""Block on plane and block on block in NGSolve: `python -m blocks.ngsolve_block kind n`.

`ContactBoundary` integrates a penalty over the block's bottom. It keeps no history at its points,
so friction is Coulomb's law of the slip s since the last increment, regularised:
t = mu p s / sqrt(|s|^2 + (mu p / eps)^2). Pardiso of MKL solves, the fastest of its solvers here;
Newton's step is halved until the residual falls.
"""

from __future__ import annotations

import os
import sys

import netgen.meshing as netgen
import ngsolve as ngs
import numpy as np

from blocks.code import show
from blocks.problem import FRICTION, KINDS, PENALTY, POISSON, YOUNG, Grid, grid, lower, path, upper

ITERATIONS, HALVINGS, TOLERANCE = 60, 8, 1e-8
SIDES = ("top", "bottom", "side")
#: Faces of a hexahedron whose nodes turn about its lower face, then its upper one.
FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def add(mesh: netgen.Mesh, body: int, box: Grid) -> None:
    """Put a box into the mesh: cells of material `body`, faces 3 body - 2 to 3 body."""
    node = [mesh.Add(netgen.MeshPoint(netgen.Pnt(*map(float, x)))) for x in box.points]
    low, high = box.points.min(axis=0), box.points.max(axis=0)
    for cell in box.cells:
        mesh.Add(netgen.Element3D(body, [node[i] for i in cell]))
        for face in FACES:
            ring = cell[list(face)]
            middle = box.points[ring].mean(axis=0)
            at_low, at_high = np.isclose(middle, low), np.isclose(middle, high)
            if (at_low | at_high).any():
                side = 1 if at_high[2] else 2 if at_low[2] else 3
                mesh.Add(netgen.Element2D(3 * (body - 1) + side, [node[i] for i in ring]))


def two_boxes(kind: str, n: int) -> ngs.Mesh:
    """The block and what lies below; the rigid plane is one cell that is held."""
    mesh = netgen.Mesh()
    mesh.dim = 3
    for k in range(6):
        mesh.Add(netgen.FaceDescriptor(surfnr=k + 1, domin=1 + k // 3, domout=0, bc=k + 1))
        mesh.SetBCName(k, ("block", "base")[k // 3] + "_" + SIDES[k % 3])
    cells = lower(n) if kind == KINDS[1] else (1, 1, 1)
    for body, box in enumerate(
        (grid((0, 0, 0), (1, 1, 0.5), upper(n)), grid((-0.5, -0.5, -0.5), (2, 2, 0.5), cells)), 1
    ):
        mesh.SetMaterial(body, ("block", "base")[body - 1])
        add(mesh, body, box)
    return ngs.Mesh(mesh)


class Model:
    """Displacements, energy and contact."""

    def __init__(self, kind: str, n: int) -> None:
        self.mesh = two_boxes(kind, n)
        rigid = "|base_top|base_side" if kind == KINDS[0] else ""
        self.space = ngs.VectorH1(self.mesh, order=1, dirichlet="block_top|base_bottom" + rigid)
        self.u, self.before = ngs.GridFunction(self.space), ngs.GridFunction(self.space)
        self.form = ngs.BilinearForm(self.space)
        u, v = self.space.TnT()
        strain = ngs.Sym(ngs.Grad(u))
        lame = YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON), YOUNG / (1 + POISSON)
        stress = lame[1] * strain + lame[0] * ngs.Trace(strain) * ngs.Id(3)
        self.form += ngs.InnerProduct(stress, ngs.Sym(ngs.Grad(v))) * ngs.dx
        self._contact(u, v)
        self.free = np.array(list(self.space.FreeDofs()))
        top = np.array(list(self.space.GetDofs(self.mesh.Boundaries("block_top"))))
        self.top = top.reshape(3, -1)
        self.residual = self.u.vec.CreateVector()

    def _contact(self, u: ngs.CF, v: ngs.CF) -> None:
        pair = ngs.ContactBoundary(
            self.mesh.Boundaries("block_bottom"), self.mesh.Boundaries("base_top")
        )
        place = ngs.CF((ngs.x, ngs.y, ngs.z))
        gap = (place + u - (place.Other() + u.Other()))[2]
        pressure = ngs.IfPos(-gap, -PENALTY * gap, 0)
        slip = (u - u.Other()) - (self.before - self.before.Other())
        slip, jump = ngs.CF((slip[0], slip[1])), v - v.Other()
        limit = FRICTION * pressure
        size = ngs.sqrt(slip * slip + (limit / PENALTY) ** 2 + 1e-24)
        drag = ngs.IfPos(-gap, limit / size, 0) * (slip[0] * jump[0] + slip[1] * jump[1])
        pair.AddIntegrator(drag - pressure * jump[2])
        pair.Update(self.u, bf=self.form, intorder=2, maxdist=0.2)

    def norm(self, of: np.ndarray) -> float:
        """Norm of a part of the residual at the displacements of now."""
        self.form.Apply(self.u.vec, self.residual)
        return float(np.linalg.norm(self.residual.FV().NumPy()[of]))

    def newton(self) -> int:
        """Balance; returns the iterations."""
        for iteration in range(ITERATIONS):
            self.form.AssembleLinearization(self.u.vec)
            free = self.norm(self.free)
            if free < TOLERANCE * (self.norm(~self.free) + 1e-12):
                return iteration
            step, start = self.u.vec.CreateVector(), self.u.vec.CreateVector()
            inverse = self.form.mat.Inverse(self.space.FreeDofs(), inverse="pardiso")
            step.data = inverse * self.residual
            start.data = self.u.vec
            for halving in range(HALVINGS):
                self.u.vec.data = start - 0.5**halving * step
                # the first step of an increment may raise the residual
                if self.norm(self.free) < free or iteration == 0:
                    break
        raise SystemExit("no balance")

    def increment(self, change: tuple[float, float, float]) -> None:
        """Move the top, balance and print."""
        move = ngs.GridFunction(self.space)
        move.Set(ngs.CF(change), definedon=self.mesh.Boundaries("block_top"))
        self.before.vec.data = self.u.vec
        self.u.vec.data += move.vec
        iterations = self.newton()
        force = self.residual.FV().NumPy().reshape(3, -1)
        total = [part[at].sum() for part, at in zip(force, self.top, strict=True)]
        show(total[0], -total[2], iterations)


def main(kind: str, n: int) -> None:
    """Solve and print."""
    ngs.SetNumThreads(int(os.environ.get("OMP_NUM_THREADS", "1")))
    model = Model(kind, n)
    with ngs.TaskManager():
        before = (0.0, 0.0)
        for now in path():
            model.increment((now[0] - before[0], 0.0, now[1] - before[1]))
            before = now


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
