"""One model of bodies that come from built-in shapes and from files."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Protocol

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI
from anisocontact.base.typed import typed
from anisocontact.mesh.arrays import MeshArrays, face_mesh, rename_bodies
from anisocontact.mesh.blocks import mesh_blocks
from anisocontact.mesh.cad import CAD, cad_arrays
from anisocontact.mesh.idealisation import SOLID, Idealisation
from anisocontact.mesh.joined import with_joined
from anisocontact.mesh.merge import merge
from anisocontact.mesh.model import Model
from anisocontact.mesh.placement import IN_PLACE, Placement
from anisocontact.mesh.quality import check_cells
from anisocontact.mesh.readers import file_arrays
from anisocontact.mesh.selectors import Selector, with_groups
from anisocontact.mesh.shapes import BoxSpec, Shape, checked_blocks
from anisocontact.mesh.shapes.shape import FACE, FLAT
from anisocontact.mesh.torn import tell_torn


class Source(Protocol):
    """Where bodies come from."""

    def arrays(self, comm: Any = MPI.COMM_SELF) -> MeshArrays:
        """The bodies in place; collective.

        Args:
            comm: Communicator, of which each process gets its share.

        Returns:
            Cells, nodes and facet groups.

        Raises:
            InputError: No mesh can be made of it.
        """
        ...


@typed
@dataclass(frozen=True)
class Body:
    """A body of a built-in shape.

    Attributes:
        name: Name of the body.
        shape: Its shape.
        placement: Where it stands.

    Example:
        >>> from anisocontact.mesh import make_shape
        >>> pin = Body("pin", make_shape("cylinder", radius=1.0, length=2.0, cells=(8, 1, 2)))
        >>> build_mesh([pin]).body_names()
        ['pin']
    """

    name: str
    shape: Shape
    placement: Placement = IN_PLACE

    def __post_init__(self) -> None:
        if not self.name or "." in self.name:
            raise InputError(f"{self.name!r} given, a name without a dot needed", "name")

    def arrays(self, comm: Any = MPI.COMM_SELF) -> MeshArrays:
        """The body in place; see `Source.arrays`.

        Args:
            comm: Communicator, of which each process gets its share.

        Returns:
            Cells, nodes and facet groups.

        Raises:
            InputError: Its cells are flat, inverted or too far away.
        """
        shape = self.shape
        degree = shape.order if shape.curved else 1
        blocks = checked_blocks(shape)
        solid = FLAT.get(shape.cell)
        if solid is None:
            mesh = mesh_blocks(self.name, blocks, shape.cell, degree, shape.order, comm)
        else:
            thick = mesh_blocks(self.name, blocks, solid, degree, shape.order)
            mesh = face_mesh(thick, f"{self.name}.{FACE}", shape.cell).shared(comm)
        check_cells(mesh)
        return self.placement.apply(mesh)


@typed
@dataclass(frozen=True)
class MeshFile:
    """The bodies of a mesh file: gmsh's, or that of another code, by the ending of its name.

    See `read_gmsh`, `mesh.inp.read_inp` and `register_reader`.

    Attributes:
        path: The file.
        bodies: Volume groups to take; all of them if not given.
        rename: Volume group -> name of the body, where it is to be another.
        placement: Where they stand.
        field: Where the path was written, for messages.
        cell_size: Of CAD, the size of the cells, length.

    Example:
        >>> press = MeshFile("press.inp", rename={"PART-1": "punch"})  # read by `build_mesh`
        >>> press.rename["PART-1"]
        'punch'
    """

    path: str | Path
    bodies: Sequence[str] | None = None
    rename: Mapping[str, str] = MappingProxyType({})
    placement: Placement = IN_PLACE
    field: str = "mesh.file"
    cell_size: float | None = None

    def arrays(self, comm: Any = MPI.COMM_SELF) -> MeshArrays:
        """The bodies in place; see `Source.arrays`.

        Args:
            comm: Communicator, of which each process gets its share.

        Returns:
            Cells, nodes and facet groups.

        Raises:
            InputError: The file cannot be read, has no such body or cells that are none, or a size
                of cells is given for a file that has cells.
        """
        path = Path(self.path)
        if self.cell_size is None:
            mesh = file_arrays(path, self.bodies, self.field, comm)
        elif path.suffix.lower() in CAD:
            mesh = cad_arrays(path, self.bodies, self.field, comm, self.cell_size)
        else:
            raise InputError(f"given for {path.name!r}, which is a mesh already", "cell_size")
        return self.placement.apply(rename_bodies(mesh, self.rename))


#: The name of before files of other codes were read.
GmshFile = MeshFile


@typed
def build_mesh(
    sources: Iterable[Source],
    groups: Mapping[str, Sequence[Selector]] = MappingProxyType({}),
    idealisation: Idealisation = SOLID,
    joined: Mapping[str, Sequence[str]] = MappingProxyType({}),
    touching: Sequence[str] = (),
) -> Model:
    """Model of bodies from shapes and files, in one mesh.

    Args:
        sources: Where the bodies come from.
        groups: Further facet groups, "body.group" -> selectors of their facets, see
            `make_selector`.
        idealisation: What a mesh of two dimensions is taken for.
        joined: Facet groups made of others, "body.group" -> groups of that body.
        touching: Slave facets of contacts: several processes share them as evenly as the cells.

    Returns:
        The model.

    Raises:
        InputError: No body, two bodies of one name, cells of several kinds, or a damaged file.

    Example:
        >>> from anisocontact.mesh import Body, Placement, make_shape
        >>> drum = make_shape("cylinder", radius=1.0, length=2.0, cells=(8, 1, 2))
        >>> plate = make_shape("box", origin=(-2, -2, 0), size=(4, 4, 1), cells=(4, 4, 1))
        >>> up = Placement(move=(0.0, 0.0, 1.0))
        >>> build_mesh([Body("drum", drum, up), Body("plate", plate)]).body_names()
        ['drum', 'plate']
    """
    parts = [source.arrays(MPI.COMM_WORLD) for source in sources]
    if not parts:
        raise InputError("no body given, at least one needed", "mesh")
    mesh = with_joined(with_groups(merge(parts), groups), joined)
    tell_torn(mesh.torn)
    return Model.from_arrays(mesh, idealisation=idealisation, touching=touching)


def build_box(boxes: Mapping[str, BoxSpec]) -> Model:
    """Mesh of one or several boxes, each a body of its own.

    The faces of body "block" are block.left, .right (x- and x+), .front, .back (y- and y+),
    .bottom, .top (z- and z+).

    Args:
        boxes: Body name -> box.

    Returns:
        The model.

    Raises:
        InputError: No box, or boxes of different cells.

    Example:
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (4, 4, 2))})
        >>> model.body_names()
        ['block']
    """
    return build_mesh(Body(name, box) for name, box in boxes.items())
