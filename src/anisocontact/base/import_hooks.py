"""What `import anisocontact` changes of imports: the wheel's order, and paths of before."""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import sys
import warnings
from collections.abc import Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path
from types import ModuleType

#: Modules that have moved into a package: their path of before and that of today. An import by the
#: path of before works for one more version.
MOVED = {
    "anisocontact._fenicsx": "anisocontact.base.fenicsx",
    "anisocontact.adhesion_domain": "anisocontact.laws",
    "anisocontact.arrays": "anisocontact.base.arrays",
    "anisocontact.augmentation": "anisocontact.interface",
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


class _Later(ModuleType):
    """A module that is executed when Python does not find something in it.

    That of `importlib.util.LazyLoader` is executed by each `import` of it, before Python 3.12.3.
    """

    def __getattr__(self, name: str) -> object:
        self.__class__ = ModuleType  # type: ignore[assignment]
        spec = self.__spec__
        if spec is None or spec.loader is None:
            raise AttributeError(name)
        if spec.submodule_search_locations is not None:
            self.__path__ = spec.submodule_search_locations
        spec.loader.exec_module(self)
        return getattr(self, name)


def when_used(name: str) -> None:
    """Let a module be executed when something of it is first used, not when it is imported.

    Args:
        name: The module; if it is in a package, that is imported.
    """
    package, _, last = name.rpartition(".")
    spec = importlib.util.find_spec(name)
    if name in sys.modules or spec is None or spec.loader is None:
        return
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    module.__dict__.pop("__path__", None)  # what is in it is looked for: that is a use
    module.__class__ = _Later
    if package:
        setattr(sys.modules[package], last, module)


def alone(name: str) -> None:
    """Import a module without what its package imports, which is done when that is asked for.

    Then `from` finds the module, its package has no attribute of its name.

    Args:
        name: The module; if there is none of that name, nothing is done.
    """
    package = name.rpartition(".")[0]
    outside, _, last = package.rpartition(".")
    if name in sys.modules:
        return
    with contextlib.suppress(ImportError):
        folders = [str(Path(folder, last)) for folder in importlib.import_module(outside).__path__]
        spec = PathFinder.find_spec(name, folders)
        if spec is not None and spec.loader is not None:
            module = sys.modules[name] = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
