"""Geometry of CAD and surfaces of triangles as bodies: gmsh meshes them with curved tetrahedra."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.gmsh import gmsh_arrays

#: Endings of names.
CAD = (".step", ".stp", ".iges", ".igs", ".brep", ".stl")
#: Cells around a full circle, so that curved faces are resolved, and along the longest side.
AROUND, ALONG = 24, 15
#: Angle between triangles of a surface beyond which they are on two faces, radian.
EDGE = 0.7


def cad_arrays(
    path: Path,
    bodies: Sequence[str] | None = None,
    field: str = "mesh.file",
    comm: Any = MPI.COMM_SELF,
    size: float | None = None,
) -> MeshArrays:
    """Mesh of the volumes of a file, with its faces as groups.

    Args:
        path: STEP, IGES or BREP, or a closed surface in STL. Lengths of STEP and IGES are in mm.
        bodies: Volumes to take, `body`, or `body1`, `body2` ...; all of them if not given.
        field: Where the path was written, for messages.
        comm: Processes, each of which gets its share.
        size: Of the cells, length; if not given a share of the longest side, and smaller where
            faces are curved.

    Returns:
        Tetrahedra of order 2, curved; groups `face1`, `face2` ... of every body, in the order of
        the file.

    Raises:
        InputError: gmsh is not installed or cannot read or mesh the file, or it has no volume.
    """
    content, problem = b"", ""
    if comm.rank == 0:
        try:
            content = _meshed(path, size)
        except InputError as error:
            problem = str(error)
    content, problem = comm.bcast((content, problem))
    if problem:
        raise InputError(f"'{path}': {problem}", field)
    with TemporaryDirectory() as folder:
        file = Path(folder, "meshed.msh")
        file.write_bytes(content)
        return gmsh_arrays(file, bodies, field, comm)


def _meshed(path: Path, size: float | None) -> bytes:
    """The mesh as a file of gmsh."""
    try:
        import gmsh
    except (ImportError, OSError) as error:
        raise InputError(f"gmsh is needed to mesh it, and cannot be imported: {error}") from None
    with _session(gmsh), TemporaryDirectory() as folder:
        try:
            _read(gmsh, path)
            _name(gmsh)
            _choose_sizes(gmsh, size)
            gmsh.model.mesh.generate(3)
            if any(not gmsh.model.mesh.getElements(*v)[0].size for v in gmsh.model.getEntities(3)):
                raise InputError("its surface does not enclose a volume; a closed one is needed")
        except InputError:
            raise
        except Exception as error:  # gmsh raises this alone
            raise InputError(f"gmsh cannot mesh it: {' '.join(str(error).split())}") from None
        file = Path(folder, "meshed.msh")
        gmsh.write(str(file))
        return file.read_bytes()


@contextmanager
def _session(gmsh: Any) -> Iterator[None]:
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        yield
    finally:
        gmsh.finalize()


def _read(gmsh: Any, path: Path) -> None:
    """Take the volumes of a file; of a surface the volume that it bounds."""
    if path.suffix.lower() != ".stl":
        gmsh.model.occ.importShapes(str(path))
        gmsh.model.occ.synchronize()
        return
    gmsh.merge(str(path))
    gmsh.model.mesh.classifySurfaces(EDGE, True, True, EDGE)
    gmsh.model.mesh.createGeometry()
    faces = [tag for _, tag in gmsh.model.getEntities(2)]
    gmsh.model.geo.addVolume([gmsh.model.geo.addSurfaceLoop(faces)])
    gmsh.model.geo.synchronize()


def _name(gmsh: Any) -> None:
    """Give every volume and face a name, of which groups are made."""
    volumes = gmsh.model.getEntities(3)
    if not volumes:
        raise InputError("no volume is in it")
    for number, (_, tag) in enumerate(volumes, 1):
        name = f"body{number}" if len(volumes) > 1 else "body"
        gmsh.model.addPhysicalGroup(3, [tag], name=name)
        faces = gmsh.model.getBoundary([(3, tag)], oriented=False)
        for k, (_, face) in enumerate(faces, 1):
            gmsh.model.addPhysicalGroup(2, [face], name=f"{name}.face{k}")


def _choose_sizes(gmsh: Any, size: float | None) -> None:
    low, high = (gmsh.model.getBoundingBox(-1, -1)[k : k + 3] for k in (0, 3))
    longest = max(b - a for a, b in zip(low, high, strict=True))
    numbers = {
        "Mesh.MeshSizeMin": size or 0.0,
        "Mesh.MeshSizeMax": size or longest / ALONG,
        "Mesh.MeshSizeFromCurvature": AROUND if size is None else 0,
        "Mesh.ElementOrder": 2,
        "Mesh.HighOrderOptimize": 1,
    }
    for name, value in numbers.items():
        gmsh.option.setNumber(name, value)
