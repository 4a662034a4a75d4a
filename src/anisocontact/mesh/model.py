"""One DOLFINx mesh with named bodies and facet groups."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Locals
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI, create_mesh, fem, vector_space
from anisocontact.base.sealed import Sealed
from anisocontact.base.typed import typed
from anisocontact.base.words import hint
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.idealisation import SOLID, Idealisation
from anisocontact.mesh.local_entities import count_inside, located
from anisocontact.mesh.node_groups import nodes_at
from anisocontact.mesh.node_unknowns import NodeUnknowns
from anisocontact.mesh.own_space import named_facets, own_unknowns
from anisocontact.mesh.partition import owners


@typed
class Model(Sealed):
    """Mesh, names and the displacement space on it.

    Args:
        mesh: DOLFINx mesh of tetrahedra or hexahedra in space, or of triangles or quadrilaterals
            in the plane z = 0 of space.
        bodies: Body name -> local cells.
        facets: "body.group" -> local facets on the boundary of that body.
        order: Order of the displacement, 1 or 2.
        linear: Bodies whose displacement is of order 1 in a space of order 2; `Problem` ties
            their middle nodes to the corners.
        idealisation: What a mesh of two dimensions is taken for; a body in space if not given.

    Raises:
        InputError: The order is not 1 or 2, or mesh and idealisation do not go together.

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> model
        <Model: bodies block; facet groups block.left, block.right, block.front, block.back, \
block.bottom, block.top>
        >>> len(model.facets("block.bottom"))
        4
    """

    def __init__(
        self,
        mesh: Any,
        bodies: Mapping[str, Locals],
        facets: Mapping[str, Locals],
        order: int = 1,
        linear: Sequence[str] = (),
        idealisation: Idealisation = SOLID,
    ) -> None:
        if order not in (1, 2):
            raise InputError(f"order: got {order!r}, allowed: 1, 2", "order")
        _check_dimension(mesh, idealisation)
        self.mesh = mesh
        self.idealisation = idealisation
        self.order = order
        self.linear = tuple(linear)
        self._bodies = dict(bodies)
        self._facets = dict(facets)
        self._nodes: dict[str, Locals] = {}
        #: Nodes of groups of facets that are on none of these.
        self._beside: dict[str, Locals] = {}

    @classmethod
    def from_arrays(
        cls,
        arrays: MeshArrays,
        comm: MPI.Comm = MPI.COMM_WORLD,
        idealisation: Idealisation = SOLID,
        touching: Sequence[str] = (),
    ) -> Model:
        """Distribute plain arrays and name what is in them.

        Args:
            arrays: The mesh: a share of it on every process of `comm`, or all of it on each.
            comm: Communicator of the mesh.
            idealisation: As of `Model`.
            touching: Facet groups in contact, which the processes share as evenly as the cells, see
                `owners`; without them DOLFINx cuts the mesh.

        Returns:
            The names on a mesh that is distributed.
        """
        own = arrays.shared(comm)
        shares = owners(own, comm.size, touching) if touching and comm.size > 1 else None
        mesh = create_mesh(comm, own.cell, own.degree, own.cells, own.points, shares)
        dim = mesh.topology.dim
        bodies = located(mesh, dim, {name: own.cells[cells] for name, cells in own.bodies.items()})
        facets = located(mesh, dim - 1, own.facets)
        model = cls(mesh, bodies, facets, arrays.order, arrays.linear, idealisation)
        for name, places in arrays.nodes.items():
            found = nodes_at(model, name.partition(".")[0], places)
            if name in facets:
                model._beside[name] = found
            else:
                model.name_nodes(name, found)
        return model

    @classmethod
    @typed
    def of(
        cls,
        space: Any,
        facets: Mapping[str, Locals | int] | Any,
        idealisation: Idealisation = SOLID,
        *,
        tags: Any = None,
    ) -> Model:
        """Names on the facets of a user's own displacement space.

        Args:
            space: Vector Lagrange space of order 1 or 2, `fem.functionspace(mesh, ("P", 1, (3,)))`,
                or a sub-space of a mixed one, `W.sub(0)`; on a mesh in the plane two components
                will do.
            facets: "body.group" -> local boundary facets, as of `MeshTags.find`, or the value that
                they have in `tags`; MeshTags alone make a group "body.<value>" of each value.
            idealisation: As of `Model`.
            tags: MeshTags of facets.

        Returns:
            The names on that space; every cell belongs to the body of the first group.

        Raises:
            InputError: No vector Lagrange space of order 1 or 2 on cells that `Model` takes,
                or facets that are none of its mesh.
        """
        unknowns = own_unknowns(space)
        named = named_facets(facets, space.mesh, tags)
        body = next(iter(named), "body").partition(".")[0]
        topology = space.mesh.topology
        cells = np.arange(topology.index_map(topology.dim).size_local, dtype=np.int32)
        topology.create_entities(topology.dim - 1)
        index_map = topology.index_map(topology.dim - 1)
        count = index_map.size_local + index_map.num_ghosts
        for name, found in named.items():
            outside = found[(found < 0) | (found >= count)]
            if len(outside):
                raise InputError(f"facet {outside[0]} given, the mesh has 0 to {count - 1}", name)
        order = space.element.basix_element.degree
        model = cls(space.mesh, {body: cells}, named, order, (), idealisation)
        vars(model).update(unknowns=unknowns, space=unknowns.nodes)
        return model

    @cached_property
    def space(self) -> Any:
        """Vector Lagrange space of the displacement."""
        return vector_space(self.mesh, self.order)

    @cached_property
    def positions(self) -> Floats:
        """Positions of the local nodes in the reference configuration, (nodes, 3), length."""
        found: Floats = np.asarray(self.space.tabulate_dof_coordinates())
        found.flags.writeable = False
        return found

    @cached_property
    def unknowns(self) -> NodeUnknowns:
        """Where the displacement of the nodes of `space` is among the unknowns."""
        return NodeUnknowns(self.space)

    def __repr__(self) -> str:
        groups = ", ".join(self.facet_names()) or "none"
        return f"<Model: bodies {', '.join(self.body_names())}; facet groups {groups}>"

    def body_names(self) -> list[str]:
        """Names of the bodies.

        Returns:
            One for each, in the order of the sources.
        """
        return list(self._bodies)

    def facet_names(self) -> list[str]:
        """Names of the facet groups.

        Returns:
            "body.group" for each.
        """
        return list(self._facets)

    def cells(self, name: str, field: str = "") -> Locals:
        """Local cells of a body.

        Args:
            name: Body.
            field: Where the name was written, for the message.

        Returns:
            Their numbers on this rank, with ghosts, (cells,).

        Raises:
            InputError: No such body.
        """
        return _looked_up(self._bodies, name, "body", field)

    def facets(self, name: str, field: str = "") -> Locals:
        """Local facets of a group.

        Args:
            name: "body.group".
            field: Where the name was written, for the message.

        Returns:
            Their numbers on this rank, with ghosts, (facets,).

        Raises:
            InputError: No such group; the line suggests the nearest name.
        """
        if not self._facets:
            text = f"no facet group {name!r}: the mesh has none; [group] names facets by place"
            raise InputError(text, field)
        return _looked_up(self._facets, name, "facet group", field)

    def name_nodes(self, name: str, nodes: Locals) -> None:
        """Give nodes a name by which displacements are prescribed: points and edges.

        Args:
            name: "body.group".
            nodes: Local numbers, of those this rank owns.

        Raises:
            InputError: There is a group of that name.
        """
        if name in self._facets or name in self._nodes:
            raise InputError(f"{name!r} given, there is a group of that name already", "nodes")
        self._nodes[name] = nodes

    def nodes(self, name: str, field: str = "") -> Locals:
        """Nodes of a group that this rank owns, of facets or of nodes with a name, or of both.

        Args:
            name: "body.group".
            field: Where the name was written, for the message.

        Returns:
            Their local numbers, (nodes,).

        Raises:
            InputError: No such group; the line suggests the nearest name.
        """
        if name in self._nodes:
            return self._nodes[name]
        nodes = self.facet_nodes(name, field)
        own = nodes[nodes < self.space.dofmap.index_map.size_local]
        return np.union1d(own, self._beside[name]) if name in self._beside else np.asarray(own)

    def facet_nodes(self, name: str, field: str = "") -> Locals:
        """Nodes of a facet group on this rank; the call is collective.

        Args:
            name: "body.group".
            field: Where the name was written, for the message.

        Returns:
            Their local numbers, with ghosts, (nodes,).

        Raises:
            InputError: No such group; the line suggests the nearest name.
        """
        dim = self.mesh.topology.dim - 1
        return np.asarray(fem.locate_dofs_topological(self.space, dim, self.facets(name, field)))

    def boundary(self, name: str, field: str = "") -> Locals:
        """Local facets of a group that has to lie on the boundary; the call is collective.

        Args:
            name: "body.group".
            field: Where the name was written, for the message.

        Returns:
            Their numbers on this rank, with ghosts, (facets,).

        Raises:
            InputError: No such group, one without facets, or facets with a cell on either side.
        """
        facets = self.facets(name, field)
        count = self.count_facets(name)
        if count == 0:
            raise InputError(f"facet group {name!r} has no facets", field)
        inside = int(self.mesh.comm.allreduce(count_inside(self.mesh, facets)))
        if inside:
            raise InputError(
                f"{inside} of {count} facets of {name!r} have a cell on either side: they lie "
                "inside a body, or where bodies share nodes; name facets of the boundary",
                field,
            )
        return facets

    def encloses(self, name: str) -> bool:
        """Whether a facet group is the whole boundary of its body; the call is collective.

        Args:
            name: "body.group".

        Returns:
            Whether no facet of the boundary is left out, the same on all ranks.
        """
        topology = self.mesh.topology
        dim = topology.dim
        topology.create_connectivity(dim, dim - 1)
        sides = topology.connectivity(dim, dim - 1)
        of_body = [sides.links(cell) for cell in self.cells(self.body_of(name))]
        outer = np.unique(np.concatenate([np.zeros(0, dtype=np.int32), *of_body]))
        outer = outer[outer < topology.index_map(dim - 1).size_local]
        local = len(outer) - count_inside(self.mesh, outer)
        return bool(self.count_facets(name) == self.mesh.comm.allreduce(local))

    def body_of(self, facet_group: str, field: str = "") -> str:
        """Name of the body a facet group bounds.

        Args:
            facet_group: "body.group".
            field: Where the name was written, for the message.

        Returns:
            The name.

        Raises:
            InputError: No such group.
        """
        self.facets(facet_group, field)
        return facet_group.partition(".")[0]

    def count_facets(self, name: str) -> int:
        """Number of facets of a group.

        Args:
            name: "body.group".

        Returns:
            The number over all ranks; the call is collective.

        Raises:
            InputError: No such group.
        """
        return int(self.mesh.comm.allreduce(len(self.owned_facets(name))))

    def owned_facets(self, name: str) -> Locals:
        """Local facets of a group that this rank owns.

        Args:
            name: "body.group".

        Returns:
            Their local numbers, (facets,).

        Raises:
            InputError: No such group.
        """
        index_map = self.mesh.topology.index_map(self.mesh.topology.dim - 1)
        facets = self.facets(name)
        owned: Locals = facets[facets < index_map.size_local]
        return owned


def _check_dimension(mesh: Any, idealisation: Idealisation) -> None:
    """Refuse a mesh that is not of what it is taken for; collective."""
    dim = mesh.topology.dim
    if dim != idealisation.dim:
        given = idealisation.entry.name
        text = (
            f"{given} given, but the mesh has three dimensions"
            if dim == 3
            else "missing; a mesh of two dimensions needs one, such as plane-strain"
        )
        raise InputError(text, "idealisation")
    x, comm = mesh.geometry.x, mesh.comm
    low = np.min(comm.allgather(x.min(axis=0, initial=np.inf)), axis=0)
    high = np.max(comm.allgather(x.max(axis=0, initial=-np.inf)), axis=0)
    idealisation.check_points(np.array([low, high]))


def _looked_up(known: dict[str, Locals], name: str, kind: str, field: str) -> Locals:
    if name in known:
        return known[name]
    there = hint(name, known, "the mesh has")
    raise InputError(f"no {kind} {name!r} in the mesh; {there}", field)
