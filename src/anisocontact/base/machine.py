"""What a machine can lack, found in what was raised."""

from __future__ import annotations

import errno

from anisocontact.base.errors import MachineError

#: What makes a run need less memory.
MEMORY = 'take a coarser mesh, strategy = "iterative", or processes on several machines'
#: Modules of the extra `fem`.
_EXTRA = (
    *("mpi4py", "petsc4py", "basix", "ffcx", "ufl", "dolfinx"),
    *("gmsh", "pyvista", "vtk", "vtkmodules"),
)
#: PETSC_ERR_MEM
_PETSC_MEMORY = 55
_CURES = {
    errno.ENOMEM: MEMORY,
    errno.ENOSPC: "make room, or take another disk",
    errno.EDQUOT: "make room, or take another disk",
    errno.EROFS: "take a folder that can be written",
    errno.EACCES: "take a folder that can be written",
}


def out_of_memory(error: BaseException) -> bool:
    """Whether a library could not be loaded because there is no memory for it.

    Args:
        error: What an import raised.
    """
    return isinstance(error, ImportError) and "failed to map segment" in str(error)


def lack(error: BaseException) -> MachineError | None:
    """What the machine lacks, where that is the reason of an error.

    Args:
        error: What was raised.

    Returns:
        One line; None for any other reason.

    Example:
        >>> str(lack(OSError(28, "No space left on device", "run.log")))
        "'run.log': No space left on device: make room, or take another disk"
        >>> lack(ValueError("a bug")) is None
        True
    """
    if isinstance(error, MachineError):
        return error
    # petsc4py's own error has the code; MemoryError also comes from bad_alloc in C++
    if isinstance(error, MemoryError) or getattr(error, "ierr", None) == _PETSC_MEMORY:
        said = f" ({error})" if isinstance(error, MemoryError) and str(error) else ""
        return MachineError(f"out of memory{said}", MEMORY)
    if out_of_memory(error):
        return MachineError("out of memory (for a library)", MEMORY)
    if isinstance(error, ImportError) and (error.name or "").split(".")[0] in _EXTRA:
        text = f"the finite-element level is not installed, or not whole ({error})"
        return MachineError(text, "pip install 'anisocontact[fem]', or its packages of conda-forge")
    if isinstance(error, OSError) and error.errno in _CURES:
        name = f"'{error.filename}': " if error.filename else ""
        return MachineError(f"{name}{error.strerror}", _CURES[error.errno])
    return None
