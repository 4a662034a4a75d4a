"""`anisocontact info`."""

from __future__ import annotations

import argparse
import json
import platform
from importlib import metadata
from typing import Any

from anisocontact import __version__
from anisocontact.base.registry import Entry, Parameter
from anisocontact.case.quantity import Quantity, key_of
from anisocontact.case.registries import Registries

_PACKAGES = ("numpy", "scipy", "pydantic", "gmsh", "pyvista", "vtk")


def command(arguments: argparse.Namespace) -> int:
    """Print versions and registries."""
    found = facts()
    if arguments.json:
        print(json.dumps(found, indent=2))
        return 0
    for name, version in found["versions"].items():
        print(f"{name:16} {version}")
    for title, entries in found["registries"].items():
        print(f"\n{title}")
        for entry in entries:
            print(f"  {entry['name']:24} {entry['doc']}")
            for p in entry["parameters"]:
                default = "required" if p["required"] else f"default {p['default']}"
                unit = "" if p["unit"] == "1" else f" [{p['unit']}]"
                print(f"    {p['key']:22} {p['form']}{unit}, {default}: {p['doc']}")
    return 0


def facts() -> dict[str, Any]:
    """Versions and everything that can be named in a case file."""
    registries = Registries.current()
    return {
        "versions": _versions(),
        "registries": {
            name.replace("_", " "): [_described(entry) for entry in getattr(registries, name)]
            for name in registries.__dataclass_fields__
        },
    }


def _versions() -> dict[str, str]:
    found = {"anisocontact": __version__, "python": platform.python_version()}
    for name in _PACKAGES:
        try:
            found[name] = metadata.version(name)
        except metadata.PackageNotFoundError:
            found[name] = "not installed"
    return found | _finite_elements()


def _finite_elements() -> dict[str, str]:
    try:
        from anisocontact.base.fenicsx import MPI, PETSc, dolfinx
    except ImportError:
        return {"dolfinx": "not installed", "petsc": "not installed", "mpi": "not installed"}
    return {
        "dolfinx": dolfinx.__version__,
        "petsc": ".".join(map(str, PETSc.Sys.getVersion())),
        "mpi": MPI.Get_library_version().split("\n")[0].strip(" \0"),
    }


def _described(entry: Entry) -> dict[str, Any]:
    return {
        "name": entry.name,
        "doc": entry.doc,
        "parameters": [_parameter(p) for p in entry.parameters],
    }


def _parameter(p: Parameter) -> dict[str, Any]:
    quantity = Quantity(p)
    bound = "" if p.bound == "any" or p.kind == "choice" else f", {p.bound}"
    return {
        "key": key_of(p),
        "form": f"{quantity.allowed()}{bound}",
        "unit": quantity.unit,
        "required": p.required,
        "default": None if p.required else quantity.default(),
        "doc": p.doc,
    }
