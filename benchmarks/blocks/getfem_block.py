"""Block on plane and block on block in GetFEM: `python -m blocks.getfem_block kind n`.

Integral contact with multipliers (augmented Lagrangian, unsymmetric version; on the block by ray
tracing): the contact is hard, so its forces differ from those of a penalty by about two per cent.
MUMPS solves.
"""

from __future__ import annotations

import sys

import getfem
import numpy as np

from blocks.code import show
from blocks.problem import FRICTION, KINDS, POISSON, YOUNG, lower, path, upper

AUGMENTATION, REACH, TOLERANCE, ITERATIONS = 1e4, 0.2, 1e-7, 60
TOP, BOTTOM = 1, 2


class Body:
    """A box of trilinear hexahedra with its top and bottom as regions."""

    def __init__(
        self, low: tuple[float, ...], high: tuple[float, ...], cells: tuple[int, int, int]
    ) -> None:
        axes = [np.linspace(a, b, c + 1) for a, b, c in zip(low, high, cells, strict=True)]
        self.mesh = getfem.Mesh("cartesian", *axes)
        faces = self.mesh.outer_faces()
        normal = self.mesh.normal_of_faces(faces)
        self.mesh.set_region(TOP, faces[:, normal[2] > 0.5])
        self.mesh.set_region(BOTTOM, faces[:, normal[2] < -0.5])
        self.displacement = self.field(3)
        rule = getfem.Integ("IM_GAUSS_PARALLELEPIPED(3,3)")
        self.rule = getfem.MeshIm(self.mesh, rule)

    def field(self, components: int) -> getfem.MeshFem:
        """Trilinear functions on the mesh."""
        field = getfem.MeshFem(self.mesh, components)
        field.set_fem(getfem.Fem("FEM_QK(3,1)"))
        return field


def elastic(model: getfem.Model, name: str, body: Body) -> None:
    """A variable for the body's displacements, one for their last values, and its stiffness."""
    model.add_fem_variable(name, body.displacement)
    model.add_fem_data(f"{name}0", body.displacement)
    model.add_isotropic_linearized_elasticity_brick(body.rule, name, "lambda", "mu")


def build(kind: str, n: int) -> tuple[getfem.Model, list[Body]]:
    """The equations and the bodies, which have to outlive them, the block first."""
    model = getfem.Model("real")
    data = {
        "lambda": YOUNG * POISSON / (1 + POISSON) / (1 - 2 * POISSON),
        "mu": YOUNG / 2 / (1 + POISSON),
        "r": AUGMENTATION,
        "friction": FRICTION,
        "one": 1.0,
    }
    for name, value in data.items():
        model.add_initialized_data(name, [value])
    block = Body((0, 0, 0), (1, 1, 0.5), upper(n))
    bodies = [block]
    elastic(model, "u", block)
    model.add_initialized_data("moved", [0.0, 0.0, 0.0])
    model.add_Dirichlet_condition_with_multipliers(
        block.rule, "u", block.displacement, TOP, "moved"
    )
    model.add_filtered_fem_variable("traction", block.field(3), BOTTOM)
    if kind == KINDS[0]:
        height = block.field(1)
        model.add_initialized_fem_data("height", height, height.eval("z"))
        model.add_integral_contact_with_rigid_obstacle_brick(
            block.rule, "u", "traction", "height", "r", "friction", BOTTOM, 1, "one", "u0"
        )
    else:
        base = Body((-0.5, -0.5, -0.5), (1.5, 1.5, 0.0), lower(n))
        bodies.append(base)
        elastic(model, "v", base)
        model.add_Dirichlet_condition_with_multipliers(base.rule, "v", base.displacement, BOTTOM)
        # the brick for small sliding finds no inverse of a cell here
        pair = model.add_integral_large_sliding_contact_brick_raytracing(
            "r", REACH, "friction", "one", 0
        )
        slave = BOTTOM, "u", "traction", "u0"
        model.add_slave_contact_boundary_to_large_sliding_contact_brick(pair, block.rule, *slave)
        master = TOP, "v", "v0"
        model.add_master_contact_boundary_to_large_sliding_contact_brick(pair, base.rule, *master)
    return model, bodies


def main(kind: str, n: int) -> None:
    """Solve and print."""
    getfem.util("trace level", 0)
    model, bodies = build(kind, n)
    block = bodies[0]
    for x, z in path():
        model.set_variable("moved", [x, 0.0, z])
        options = ("max_res", TOLERANCE, "max_iter", ITERATIONS, "lsolver", "mumps")
        iterations, converged = model.solve(*options, "lsearch", "simplest")
        if not converged:
            raise SystemExit("no balance")
        total = [getfem.asm_generic(block.rule, 0, f"traction({c})", BOTTOM, model) for c in (1, 3)]
        show(-total[0], abs(total[1]), iterations)
        model.set_variable("u0", model.variable("u"))
        if kind == KINDS[1]:
            model.set_variable("v0", model.variable("v"))


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
