"""Tables of the bodies: built-in shapes, mesh files, and where they stand."""

from __future__ import annotations

from typing import Annotated, Any, Self, override

from pydantic import Field, create_model, model_validator
from pydantic_core import ErrorDetails

from anisocontact.base.cells import CELLS
from anisocontact.base.registry import Entry
from anisocontact.case.quantity import line, number, word
from anisocontact.case.registered import Registered, table_of
from anisocontact.case.section import Section

Point = tuple[float, float, float]


class Rotate(Section):
    """A rotation about an axis, right-handed."""

    axis: Annotated[Point, number("vector", "1", "direction of the axis", "nonzero")]
    angle_deg: Annotated[float, number("scalar", "angle", "angle")]
    point: Annotated[Point, number("vector", "length", "point on the axis")] = (0.0, 0.0, 0.0)


class NodeGroup(Section):
    """A point or an edge of a body: the node nearest to a point, or all on a straight line."""

    near: Annotated[
        Point | None, number("vector", "length", "the node of the body nearest to this point")
    ] = None
    start: Annotated[Point | None, number("vector", "length", "where the line begins")] = None
    end: Annotated[Point | None, number("vector", "length", "where the line ends")] = None

    @model_validator(mode="after")
    def _one(self) -> Self:
        ends = (self.start is not None) + (self.end is not None)
        if (self.near is None) != (ends == 2) or ends == 1:
            raise line("near, or start and end needed")
        return self


class Weighed(Registered):
    """A material with what gravity needs of it."""

    density: Annotated[
        float | None, number("scalar", "mass/length^3", "density, for gravity", "non-negative")
    ] = None


#: What is said of the order of the displacement where it is that of a file.
_ORDER = (
    "unknown key; the displacement has the order of the cells in the file: write it with cells of "
    "order 2 (in gmsh Mesh.ElementOrder = 2, or `gmsh -order 2`)"
)


class Placed(Registered):
    """Where bodies stand: scaled about the origin, then turned, then moved."""

    scale: Annotated[float, number("scalar", "1", "factor of all lengths", "positive")] = 1.0
    rotate: Rotate | None = Field(None, description="rotation, after `scale`")
    move: Annotated[Point, number("vector", "length", "translation, after `rotate`")] = (
        0.0,
        0.0,
        0.0,
    )


class Shaped(Placed):
    """A body of a built-in shape."""

    cell: str = ""
    order: Annotated[
        int, number("integer", "1", "order of the displacement", "positive", most=2)
    ] = 1


class MeshFile(Placed):
    """Bodies of a mesh file: its volume groups; its surface groups are facet groups."""

    path: str = Field(description="mesh file, or CAD that is meshed, relative to the case file")
    bodies: list[str] | None = Field(
        None, description="volume groups to take, all of them if left out"
    )
    rename: dict[str, str] = Field(
        default_factory=dict, description="volume group = name of the body, where they differ"
    )
    cell_size: Annotated[
        float | None,
        number(
            "scalar", "length", "of CAD and STL, the size of the cells before `scale`", "positive"
        ),
    ] = None

    @classmethod
    @override
    def _text(cls, e: ErrorDetails) -> str:
        return _ORDER if _asks_for_order(e) else super()._text(e)


class Mesh(Section):
    """The bodies: from mesh files, from built-in shapes, or from both."""

    file: str | None = Field(
        None,
        description="mesh file (gmsh's .msh, .inp of Abaqus or CalculiX), relative to the case "
        "file; volume groups that have a material are the bodies, surface groups the facet groups",
    )
    files: dict[str, MeshFile] = Field(
        default_factory=dict, description="several mesh files, each under a name of its own"
    )

    @classmethod
    @override
    def _text(cls, e: ErrorDetails) -> str:
        return _ORDER if _asks_for_order(e) else super()._text(e)

    def shaped(self) -> dict[str, dict[str, Any]]:
        """Shape -> body -> its table."""
        named = {name: getattr(self, name) for name in type(self).model_fields}
        return {name: named[name] for name in named if name not in Mesh.model_fields}

    @property
    def from_files(self) -> bool:
        """Whether there are bodies of which only the files know the names."""
        return self.file is not None or bool(self.files)


def _asks_for_order(e: ErrorDetails) -> bool:
    return e["type"] == "extra_forbidden" and e["loc"][-1] == "order"


def mesh_type(shapes: tuple[Entry, ...]) -> type[Mesh]:
    """The table `mesh` with a key for every built-in shape."""
    tables: dict[str, Any] = {}
    for entry in shapes:
        cells = CELLS[entry.kind]
        cell = {"cell": (Annotated[str, word("shape of the cells", *cells)], cells[0])}
        body = table_of(f"Mesh{entry.name.title()}", (entry,), Shaped, cell)
        about: Any = Field(
            default_factory=dict, description=f"bodies of the shape {entry.name} by name"
        )
        tables[entry.name] = (dict[str, body], about)  # type: ignore[valid-type]
    return create_model("Mesh", __base__=Mesh, **tables)
