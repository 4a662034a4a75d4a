"""Forces and tangent of the law of the page, by dolfinx-external-operator and by the project."""

# ruff: noqa: I001 (DOLFINx is found by the project; the package adds a type to UFL before all forms)
import anisocontact.base.fenicsx  # noqa: F401
import dolfinx_external_operator as package

import basix.ufl
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from test_external_operator import law

from anisocontact.bulk import NonlinearBulk, user_material
from anisocontact.mesh import Body, BoxSpec, build_mesh

shape = BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2), cell="tetrahedron")
model = build_mesh([Body("b", shape)])
bulk = NonlinearBulk(model, {"b": user_material(law())})
u = fem.Function(model.space)
u.x.array[:] = 5e-3 * np.random.default_rng(3).normal(size=len(u.x.array))


def epsilon(v):
    e = ufl.sym(ufl.grad(v))
    pairs = [(0, 1), (0, 2), (1, 2)]
    return ufl.as_vector([*(e[i, i] for i in range(3)), *(np.sqrt(2) * e[p] for p in pairs)])


def external(derivatives):
    def answer(strain):
        strain = strain.reshape(-1, 6)
        zero = np.zeros_like(strain)
        tangent, stress, _ = law().return_mapping(strain, zero, np.zeros(len(strain)))
        return (stress if derivatives == (0,) else tangent).reshape(-1)

    return answer


element = basix.ufl.quadrature_element("tetrahedron", degree=1, value_shape=(6,))
stresses = fem.functionspace(model.mesh, element)
sigma = package.FEMExternalOperator(epsilon(u), function_space=stresses, external_function=external)
v, du = ufl.TestFunction(model.space), ufl.TrialFunction(model.space)
form = ufl.inner(sigma, epsilon(v)) * ufl.dx(metadata={"quadrature_degree": 1})
slope = ufl.algorithms.expand_derivatives(ufl.derivative(form, u, du))
replaced, operators = package.replace_external_operators(form)
replaced_slope, slopes = package.replace_external_operators(slope)
operands = package.evaluate_operands(operators)
package.evaluate_external_operators(operators, operands)
package.evaluate_external_operators(slopes, operands)
residual = fem.assemble_vector(fem.form(replaced)).array
theirs = assemble_matrix(fem.form(replaced_slope))
theirs.assemble()
vector = theirs.createVecRight()
vector.array[:] = u.x.array
ours = np.array(bulk.force(vector).array)
print(np.abs(ours - residual).max() / np.abs(residual).max())
out = bulk.stiffness.duplicate()
bulk.tangent(out)
out.assemble()
print(np.abs(out[:, :] - theirs[:, :]).max() / np.abs(theirs[:, :]).max())
