"""DOLFINx, PETSc and MPI as the finite-element level uses them.

Every call whose name or signature differs between DOLFINx releases sits here, and so does the
order of the imports: in the wheel `dolfinx-solver-real` the compiled modules need mpi4py's MPI to
be loaded before them. `dolfinx.fem.petsc` has a parser of C imported for those who use Numba; what
is called of it stands here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints, Locals
from anisocontact.base.errors import MachineError
from anisocontact.base.import_hooks import printable_arguments, without_its_package
from anisocontact.base.signals import held_back

try:
    with held_back(), printable_arguments():  # until the compiled modules are whole
        from mpi4py import MPI  # isort: skip

        import petsc4py  # isort: skip

        # PETSc would answer signals itself: a closed pipe, a hang-up and TERM with a block of
        # advice for debugging. They belong to the program; a script that has loaded PETSc before
        # has chosen.
        petsc4py.init(["anisocontact", "-no_signal_handler"])

        import basix
        import basix.ufl
        import ufl as _ufl

        # FFCx' generator of code, which is imported where a form is compiled, is asked for a list.
        without_its_package("ffcx.codegeneration.C.file_template")
        import dolfinx
        from dolfinx import cpp, fem, graph, io  # type: ignore[attr-defined]
        from dolfinx import la as _la
        from dolfinx import mesh as dmesh
        from dolfinx.la import petsc as _la_petsc
        from petsc4py import PETSc as _PETSc
except ImportError as missing:
    raise ImportError(
        "the finite-element level is not installed, or not whole: pip install 'anisocontact[fem]', "
        f"or fenics-dolfinx 0.11 from conda-forge ({missing})",
        name="dolfinx",
    ) from missing
except RuntimeError as refused:  # PETSc's own: it reads options as it is loaded
    raise MachineError(
        f"PETSc cannot be loaded ({refused})",
        "what it says above is about PETSC_OPTIONS or a file .petscrc",
    ) from refused

__all__ = [
    "MPI",
    "SNES",
    "Mat",
    "PETSc",
    "Vec",
    "assemble_force",
    "assemble_into",
    "basix",
    "boxes_around",
    "cell_nodes",
    "cell_permutation",
    "corner_weights",
    "create_force",
    "create_form_matrix",
    "create_mesh",
    "curved_gradients",
    "dolfinx",
    "facet_keys",
    "facet_nodes",
    "facet_sides",
    "fem",
    "geometry",
    "la",
    "locate_entities",
    "middle_nodes",
    "prescribe",
    "prescribed_rows",
    "prescribes_in",
    "release_unreferenced",
    "scalar_element",
    "ufl",
    "vector_space",
    "vertex_gradients",
]

# UFL has no types, DOLFINx few, and those of petsc4py take enumerations and sums of vectors for
# errors.
ufl: Any = _ufl
la: Any = _la
PETSc: Any = _PETSc
type Mat = Any
type Vec = Any
type SNES = Any


def create_mesh(
    comm: MPI.Comm,
    cell: str,
    degree: int,
    cells: Ints,
    points: Floats,
    owners: Ints | None = None,
) -> Any:
    """Distributed DOLFINx mesh of Lagrange cells.

    Args:
        comm: Communicator; ranks without data pass arrays of length zero.
        cell: "tetrahedron" or "hexahedron"; "triangle" or "quadrilateral" of a mesh in the plane.
        degree: Degree of the geometry.
        cells: Node numbers of each cell in DOLFINx order, (cells, nodes).
        points: Coordinates of the nodes, (nodes, 3), length.
        owners: Process to which each cell goes; if there are none, DOLFINx decides.
    """
    element = basix.ufl.element(
        "Lagrange", cell, degree, basix.LagrangeVariant.equispaced, shape=(3,)
    )
    if owners is None:
        return dmesh.create_mesh(comm, cells, ufl.Mesh(element), points)
    one_each = np.arange(len(owners) + 1, dtype=np.int32)
    shares = dolfinx.graph.adjacencylist(owners.astype(np.int32), one_each)._cpp_object
    return dmesh.create_mesh(comm, cells, ufl.Mesh(element), points, partitioner=lambda *_: shares)


def cell_permutation(cell: str, nodes: int) -> Ints:
    """Order `p` that takes a gmsh cell to DOLFINx: `dolfinx = gmsh[:, p]`."""
    return np.asarray(cpp.io.perm_gmsh(cpp.mesh.to_type(cell), nodes), dtype=np.int64)


def middle_nodes(cell: str) -> list[tuple[Ints, Ints]]:
    """Corners and middle node of the edges, and of the faces that have one, of a quadratic cell."""
    element = _lagrange(cell, 2)
    topology = basix.topology(basix.CellType[cell])
    out = []
    for corners, nodes in zip(topology[1:3], element.entity_dofs[1:3], strict=True):
        if nodes[0]:
            out.append((np.array(corners), np.array(nodes)[:, 0]))
    return out


def cell_nodes(cell: str, degree: int) -> Ints:
    """Places of the nodes of a Lagrange cell in the reference cell, times the degree."""
    places = np.rint(degree * _lagrange(cell, degree).points)
    return np.asarray(places, dtype=np.int64)


def facet_nodes(cell: str, degree: int) -> Ints:
    """Local nodes of each facet of a Lagrange cell, vertices first, (facets, nodes)."""
    return np.array(_lagrange(cell, degree).entity_closure_dofs[-2], dtype=np.int64)


def curved_gradients(cell: str) -> Floats:
    """Gradients of the basis of order 2 at the points of a rule of degree 4, (points, nodes, 3)."""
    element = _lagrange(cell, 2)
    points, _ = basix.make_quadrature(element.cell_type, 4)
    return np.ascontiguousarray(np.moveaxis(element.tabulate(1, points)[1:, :, :, 0], 0, -1))


def vertex_gradients(mesh: Any) -> Floats:
    """Gradients of the shapes of the cells of a mesh at their corners, (corners, nodes, dim)."""
    element = _lagrange(mesh.topology.cell_name(), mesh.geometry.cmaps[0].degree)
    found = element.tabulate(1, basix.geometry(element.cell_type))
    return np.ascontiguousarray(np.moveaxis(found[1:, :, :, 0], 0, -1))


def _lagrange(cell: str, degree: int) -> Any:
    variant = basix.LagrangeVariant.equispaced
    return basix.create_element(basix.ElementFamily.P, basix.CellType[cell], degree, variant)


def locate_entities(
    mesh: Any, dim: int, nodes: Ints, values: Locals
) -> tuple[Locals, Locals, bool]:
    """Local entities with the given nodes and the value of each; collective.

    Args:
        mesh: DOLFINx mesh.
        dim: Topological dimension of the entities.
        nodes: Input numbers of the nodes of each entity, (entities, nodes).
        values: A number for each entity, (entities,). Other ranks may pass none.

    Returns:
        Local indices (sorted), values, and whether every entity has been given once, on all ranks.
    """
    mesh.topology.create_connectivity(dim, mesh.topology.dim)
    vertices, local = io.distribute_entity_data(mesh, dim, nodes, values)
    tags = dmesh.meshtags_from_entities(
        mesh, dim, graph.adjacencylist(vertices), local.astype(np.int32, copy=False)
    )
    once = mesh.comm.allreduce(len(tags.indices) == len(vertices), MPI.LAND)
    return tags.indices, tags.values, bool(once)


def closest_cells(mesh: Any, points: Floats) -> tuple[Locals, Floats]:
    """The local cell nearest to each point and its distance, infinite on a rank without cells.

    Args:
        mesh: DOLFINx mesh.
        points: The points, (n, 3), length.
    """
    dim = mesh.topology.dim
    count = mesh.topology.index_map(dim).size_local
    cells = np.arange(count, dtype=np.int32)
    if not count:
        return np.zeros(len(points), dtype=np.int32), np.full(len(points), np.inf)
    tree = dolfinx.geometry.bb_tree(mesh, dim, entities=cells)
    middles = dolfinx.geometry.create_midpoint_tree(mesh, dim, cells)
    found = dolfinx.geometry.compute_closest_entity(tree, middles, mesh, points)
    return found, np.sqrt(dolfinx.geometry.squared_distance(mesh, dim, found, points))


def boxes_around(mesh: Any) -> Callable[[Floats], tuple[Ints, Ints]]:
    """A search for the cells this rank owns that have points in the boxes around their nodes.

    Args:
        mesh: DOLFINx mesh.

    Returns:
        A function of points, (n, 3), length, whose value are numbers of points and of cells, a pair
        of them for each such cell.
    """
    dim = mesh.topology.dim
    cells = np.arange(mesh.topology.index_map(dim).size_local, dtype=np.int32)
    tree = dolfinx.geometry.bb_tree(mesh, dim, entities=cells) if len(cells) else None

    def search(points: Floats) -> tuple[Ints, Ints]:
        if tree is None:
            return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
        found = dolfinx.geometry.compute_collisions_points(tree, points)
        of_point = np.repeat(np.arange(len(points)), np.diff(found.offsets))
        return of_point, np.asarray(found.array, dtype=np.int64)

    return search


def reference_place(mesh: Any, cell: int, point: Floats) -> Floats:
    """Where a point of a cell is in the reference cell, (1, 3)."""
    geometry = mesh.geometry
    corners = geometry.x[geometry.dofmaps[0][cell]]
    return np.asarray(geometry.cmaps[0].pull_back(point[None], corners))


def facet_sides(mesh: Any, facets: Locals) -> tuple[Locals, Locals]:
    """Cell and local number of each boundary facet this rank owns, in the order given."""
    topology = mesh.topology
    dim = topology.dim
    topology.create_connectivity(dim - 1, dim)
    topology.create_connectivity(dim, dim - 1)
    pairs = fem.compute_integration_domains(fem.IntegralType.exterior_facet, topology, facets)
    sides = np.asarray(pairs, dtype=np.int32).reshape(-1, 2)
    return sides[:, 0], sides[:, 1]


def facet_keys(mesh: Any, facets: Locals) -> Ints:
    """A number for each facet of `facet_sides` that does not depend on the distribution.

    It tells the cell by its place in the input, and the side of the cell.
    """
    cells, local = facet_sides(mesh, facets)
    sides = len(basix.topology(basix.CellType[mesh.topology.cell_type.name])[-2])
    original = np.asarray(mesh.topology.original_cell_index, dtype=np.int64)
    return np.asarray(original[cells] * sides + local)


def geometry(mesh: Any) -> tuple[Any, Locals, Floats]:
    """Basix element, node numbers of every cell and node coordinates of the geometry."""
    element = mesh.ufl_domain().ufl_coordinate_element().basix_element
    return element, mesh.geometry.dofmaps[0], mesh.geometry.x


def tags_of_mesh(tags: Any, mesh: Any) -> bool:
    """Whether MeshTags are those of a mesh: numbers of facets of another one mean nothing."""
    one, other = (getattr(t, "_cpp_object", t) for t in (tags.topology, mesh.topology))
    return one is other


def vector_space(mesh: Any, degree: int) -> Any:
    """Continuous Lagrange vectors in space."""
    return fem.functionspace(mesh, ("Lagrange", degree, (3,)))


def scalar_element(space: Any) -> Any:
    """Basix element of one component of a vector space."""
    return space.element.basix_element


def corner_weights(space: Any) -> tuple[Ints, Floats]:
    """Local nodes of a cell of order 2 that are no corners, and weights of the corners there.

    Returns:
        Nodes (m,), and the values of the basis functions of order 1 at them, (m, corners).
    """
    element = scalar_element(space)
    linear = _lagrange(element.cell_type.name, 1)
    corners = linear.dim
    weights = np.asarray(linear.tabulate(0, element.points)[0, corners:, :, 0])
    return np.arange(corners, element.dim), np.rint(weights * 8.0) / 8.0


def create_form_matrix(form: Any) -> Mat:
    """Matrix with the pattern of a bilinear form, not assembled yet."""
    return cpp.fem.petsc.create_matrix(form._cpp_object, None)


def create_force(form: Any) -> Vec:
    """Vector for `assemble_force` of a linear form, with ghosts."""
    dofmap = form.function_spaces[0].dofmap
    return _la_petsc.create_vector([(dofmap.index_map, dofmap.index_map_bs)])


def assemble_force(form: Any, out: Vec) -> None:
    """Write the vector of a linear form, ghosts added up, into one of `create_force`."""
    with out.localForm() as local:
        local.set(0.0)
        fem.assemble_vector(local.array_w, form)
    out.ghostUpdate(PETSc.InsertMode.ADD_VALUES, PETSc.ScatterMode.REVERSE)


def assemble_into(matrix: Mat, form: Any) -> None:
    """Add the matrix of a bilinear form to a matrix of its pattern; not assembled yet."""
    constants, coefficients = fem.pack_constants(form), fem.pack_coefficients(form)
    cpp.fem.petsc.assemble_matrix(matrix, form._cpp_object, constants, coefficients, [])
    matrix.assemble(PETSc.Mat.AssemblyType.FLUSH)


def prescribe(residual: Vec, bcs: Sequence[Any], x: Vec) -> None:
    """Write `x - g` into the rows of the residual that Dirichlet conditions prescribe."""
    values, now = residual.array_w, x.array_r
    for bc in bcs:
        bc.set(values, now, -1.0)


def prescribed_rows(bcs: Sequence[Any]) -> Locals:
    """Owned unknowns that Dirichlet conditions prescribe, local numbers."""
    rows = [dofs[:owned] for dofs, owned in (bc.dof_indices() for bc in bcs)]
    return np.unique(np.concatenate([np.empty(0, dtype=np.int32), *rows])).astype(np.int32)


def prescribes_in(bc: Any, space: Any) -> bool:
    """Whether a Dirichlet condition is on a space, or a sub-space of it."""
    return bool(space._cpp_object.contains(bc.function_space))


def release_unreferenced(comm: MPI.Comm) -> None:
    """Give back PETSc objects that Python has let go of; collective, nothing on one process.

    On several processes petsc4py only sets them aside: Python may let go of them at another moment
    on each, and PETSc destroys them together.

    Args:
        comm: Communicator that they were made with.
    """
    if comm.size > 1:
        PETSc.garbage_cleanup(comm)
