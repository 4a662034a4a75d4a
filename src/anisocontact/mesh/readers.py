"""Mesh files by the ending of their name."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import MPI
from anisocontact.base.python_file import where_failed
from anisocontact.base.typed import typed
from anisocontact.mesh.arrays import MeshArrays
from anisocontact.mesh.cad import CAD, cad_arrays
from anisocontact.mesh.gmsh import check_file, gmsh_arrays
from anisocontact.mesh.meshio_files import SUFFIXES, read_by_meshio
from anisocontact.mesh.unv import read_unv
from anisocontact.mesh.whole import WholeMesh

#: Reads the bodies of a file: path, which bodies (all if None), where the path was written, the
#: processes, each of which gets its share.
type Reader = Callable[[Path, Sequence[str] | None, str, Any], MeshArrays]

_READERS: dict[str, Reader] = {}
#: Endings of names of files that users come with and that are not read -> what they are of.
FOREIGN = {
    **dict.fromkeys((".cdb", ".ans", ".rst", ".db"), "Ansys"),
    **dict.fromkeys((".k", ".key", ".dyn"), "LS-DYNA"),
    **dict.fromkeys((".cae", ".odb"), "Abaqus beside its input"),
    ".frd": "CalculiX beside its input",
    ".mail": "Code_Aster beside MED",
    ".rad": "Radioss",
    ".hm": "HyperMesh",
    ".op2": "Nastran beside its input",
}


def register_reader(*suffixes: str) -> Callable[[Reader], Reader]:
    """Let a function read the files whose names end so.

    Args:
        suffixes: Endings with the dot, in small letters.

    Returns:
        A decorator.

    Example:
        >>> @register_reader(".none")
        ... def read_none(path, bodies, field, comm):
        ...     raise InputError("nothing is in it", field)
        >>> file_arrays(Path("a.none"))
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: mesh.file: mesh file 'a.none' does not exist
    """

    def register(read: Reader) -> Reader:
        for suffix in suffixes:
            _READERS[suffix] = read
        return read

    return register


@typed
def whole_reader(read: Callable[[Path], WholeMesh]) -> Reader:
    """A reader of a format that every process reads as a whole.

    Args:
        read: Reads a file; raises InputError, or OSError where it cannot be read.

    Returns:
        The reader.

    Example:
        >>> @whole_reader
        ... def read_gone(path):
        ...     raise FileNotFoundError(2, "No such file or directory")
        >>> read_gone(Path("part.mesh"), None, "mesh.file", None)
        Traceback (most recent call last):
        ...
        anisocontact.base.errors.InputError: mesh.file: mesh file 'part.mesh' cannot be read: \
No such file or directory
    """

    def arrays(path: Path, bodies: Sequence[str] | None, field: str, comm: Any) -> MeshArrays:
        try:
            return _read(read, path).arrays(bodies).shared(comm)
        except InputError as problem:
            raise InputError(f"mesh file {str(path)!r}: {problem}", field) from None
        except OSError as problem:
            text = f"mesh file {str(path)!r} cannot be read: {problem.strerror}"
            raise InputError(text, field) from None

    return arrays


def _read(read: Callable[[Path], WholeMesh], path: Path) -> WholeMesh:
    """What a reader returns, which may be a function of a user's.

    Raises:
        InputError: That function failed, or returned something else.
    """
    who = f"the reader {getattr(read, '__name__', type(read).__name__)}"
    try:
        found = read(path)
    except (InputError, OSError):
        raise
    except (Exception, SystemExit) as error:
        if getattr(read, "__module__", "").partition(".")[0] == __name__.partition(".")[0]:
            raise  # one of the project's, whose mistake is none of the user's
        raise InputError(f"{who} failed: {where_failed(error)}") from error
    if not isinstance(found, WholeMesh):
        raise InputError(f"{who} returned {type(found).__name__}, a WholeMesh needed")
    return found


def is_mesh(path: Path) -> bool:
    """Whether the ending of a name is that of mesh files.

    Example:
        >>> is_mesh(Path("part.INP")), is_mesh(Path("case.toml"))
        (True, False)
    """
    return path.suffix.lower() in _READERS


def file_arrays(
    path: Path,
    bodies: Sequence[str] | None = None,
    field: str = "mesh.file",
    comm: Any = MPI.COMM_SELF,
) -> MeshArrays:
    """Plain arrays of a mesh file of any kind that is known.

    Args:
        path: The file; the ending of its name says what it is, gmsh's if it has none that is known.
        bodies: Which bodies; all of them if not given.
        field: Where the path was written, for messages.
        comm: Processes, each of which gets its share.

    Raises:
        InputError: The file is missing or damaged, or has no such body.
    """
    check_file(path, field)
    return _READERS.get(path.suffix.lower(), gmsh_arrays)(path, bodies, field, comm)


def _read_inp(path: Path) -> WholeMesh:
    """What `read_inp` reads, which is imported for it: decks have many parts."""
    from anisocontact.mesh.inp import read_inp

    return read_inp(path)


def _refuse(path: Path) -> WholeMesh:
    """Say what to do with a file of a code whose meshes are not read.

    Raises:
        InputError: Always.
    """
    of = FOREIGN[path.suffix.lower()]
    raise InputError(f"files of {of} are not read; have it write .inp, .bdf, .med, .unv or .msh")


register_reader(".msh")(gmsh_arrays)
register_reader(*FOREIGN)(whole_reader(_refuse))
register_reader(*CAD)(cad_arrays)
register_reader(".inp")(whole_reader(_read_inp))
register_reader(".unv")(whole_reader(read_unv))
register_reader(*SUFFIXES)(whole_reader(read_by_meshio))
