"""What `import anisocontact` changes of imports: the wheel's order, and paths of before."""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import sys
import warnings
from collections.abc import Iterator, Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from types import ModuleType

from anisocontact.base.errors import printable

#: Modules that have moved into a package: their path of before and that of today. An import by the
#: path of before works for one more version.
MOVED = {
    "anisocontact._fenicsx": "anisocontact.base.fenicsx",
    "anisocontact.adhesion_domain": "anisocontact.laws",
    "anisocontact.arrays": "anisocontact.base.arrays",
    "anisocontact.augmentation": "anisocontact.interface",
    "anisocontact.base.course": "anisocontact.base.load_curve",
    "anisocontact.errors": "anisocontact.base.errors",
    "anisocontact.facet_blocks": "anisocontact.surfaces.facet_blocks",
    "anisocontact.facets": "anisocontact.surfaces",
    "anisocontact.figure_style": "anisocontact.base.figure_style",
    "anisocontact.geometry": "anisocontact.surfaces.geometry",
    "anisocontact.kinematics": "anisocontact.surfaces",
    "anisocontact.limits": "anisocontact.base.limits",
    "anisocontact.orientation": "anisocontact.surfaces.orientation",
    "anisocontact.processes": "anisocontact.base.processes",
    "anisocontact.python_law": "anisocontact.interface",
    "anisocontact.python_pair": "anisocontact.interface",
    "anisocontact.registry": "anisocontact.base.registry",
    "anisocontact.series": "anisocontact.interface.series",
    "anisocontact.smooth_facets": "anisocontact.surfaces",
    "anisocontact.strategies": "anisocontact.base.strategies",
    "anisocontact.whole_files": "anisocontact.base.whole_files",
}


class MovedModules(MetaPathFinder, Loader):
    """Finds modules by their paths of before; a `DeprecationWarning` names the new one."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The module, if it has moved."""
        return ModuleSpec(name, self) if name in MOVED else None

    def exec_module(self, module: ModuleType) -> None:
        """Let the module of before have what that of today has."""
        new = MOVED[module.__name__]
        text = f"{module.__name__} has moved: import from {new}"
        warnings.warn(text, DeprecationWarning, stacklevel=2)
        of_today = importlib.import_module(new)
        names = vars(of_today).items()
        kept = {k: v for k, v in names if not k.startswith("__") or k == "__getattr__"}
        module.__dict__.update(kept)


class LibrariesOfWheels(MetaPathFinder):
    """Loads MPI before DOLFINx and PETSc: in the wheels their compiled modules need it loaded."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> None:
        """Nothing is found here, what is asked for is only prepared."""
        if name in {"dolfinx", "petsc4py"}:
            with contextlib.suppress(ImportError):
                importlib.import_module("mpi4py.MPI")


def install() -> None:
    """Put both in front of Python's own ways to find a module, once."""
    if not any(isinstance(finder, MovedModules) for finder in sys.meta_path):
        sys.meta_path[:0] = [LibrariesOfWheels(), MovedModules()]


def when_used(name: str) -> None:
    """Let a module be executed when something of it is first used, not when it is imported.

    Args:
        name: The module, in a package that is imported.
    """
    package, _, last = name.rpartition(".")
    spec = importlib.util.find_spec(name)
    if name in sys.modules or spec is None or spec.loader is None:
        return
    spec.loader = importlib.util.LazyLoader(spec.loader)
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    setattr(sys.modules[package], last, module)


def without_its_package(name: str) -> None:
    """Import a module while the package that it is in is not executed, which takes longer.

    Others find the module as usual, and a later import of the package is a usual one. Nothing is
    done where there is no such module.

    Args:
        name: The module.
    """
    package = name.rpartition(".")[0]
    try:
        around = importlib.util.find_spec(package)
    except ModuleNotFoundError:
        return
    places = around.submodule_search_locations if around else None
    spec = PathFinder.find_spec(name, places) if places else None
    if name in sys.modules or spec is None or spec.loader is None:
        return
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)


@contextlib.contextmanager
def printable_arguments() -> Iterator[None]:
    """Let the program have arguments that compiled modules can take while these are imported.

    DOLFINx reads those of the program as it is loaded, and takes no text with bytes that are none
    in UTF-8, as names of files have them that an older system wrote.
    """
    given = sys.argv[:]
    sys.argv[:] = [printable(argument) for argument in given]
    try:
        yield
    finally:
        sys.argv[:] = given
