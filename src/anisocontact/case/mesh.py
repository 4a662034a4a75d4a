"""The mesh of a case, with the groups and the points that it names."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from anisocontact.base.errors import within
from anisocontact.base.fenicsx import MPI
from anisocontact.case import objects
from anisocontact.case.model import Case
from anisocontact.case.read import CaseFile, load
from anisocontact.mesh import GmshFile, Model
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.joined import with_joined
from anisocontact.mesh.merge import merge
from anisocontact.mesh.node_groups import node_near, nodes_along
from anisocontact.mesh.readers import file_arrays, is_mesh
from anisocontact.mesh.selectors import with_groups


def mesh_of(path: Path) -> MeshArrays:
    """The mesh of a case file or of a mesh file, in one process.

    Args:
        path: A mesh file by the ending of its name, else a case file.

    Raises:
        InputError: It is missing or damaged.
    """
    if is_mesh(path):
        return file_arrays(path, field="")
    return arrays_of(load(path), MPI.COMM_SELF)


def arrays_of(file: CaseFile, comm: MPI.Comm) -> MeshArrays:
    """The mesh of a case, with the groups that it names."""
    mesh = file.case.mesh
    parts: list[MeshArrays] = []
    if mesh.file is not None:
        shaped = {name for bodies in mesh.shaped().values() for name in bodies}
        wanted = [name for name in file.case.material if name not in shaped]
        source = GmshFile(file.resolve(mesh.file), None if mesh.files else wanted)
        parts.append(source.arrays(comm))
    for name, section in mesh.files.items():
        place = f"mesh.files.{name}"
        path, there = file.resolve(section.path), objects.placement(section)
        with within(place):
            source = GmshFile(
                path, section.bodies, section.rename, there, "path", section.cell_size
            )
            parts.append(source.arrays(comm))
    for shape, bodies in mesh.shaped().items():
        for name, table in bodies.items():
            place = f"mesh.{shape}.{name}"
            body = objects.body(table, name, place)
            with within(place):
                parts.append(body.arrays(comm))
    return _grouped(file.case, merge(parts))


def _grouped(case: Case, mesh: MeshArrays) -> MeshArrays:
    """The mesh with the facet groups that the case names."""
    chosen = {
        name: [objects.selector(table, f'group."{name}"') for table in tables]
        for name, tables in case.group.items()
    }
    with within("group"):
        mesh = with_groups(mesh, chosen)
    with within("join"):
        return with_joined(mesh, case.join)


def name_nodes(case: Case, model: Model) -> None:
    """Points and edges by their names."""
    for name, table in case.nodes.items():
        body, place = name.partition(".")[0], f'nodes."{name}"'
        if table.near is not None:
            found = node_near(model, body, table.near, place)
        else:
            start: Any = table.start
            end: Any = table.end
            found = nodes_along(model, body, start, end, place)
        with within(place):
            model.name_nodes(name, found)
