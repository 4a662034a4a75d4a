"""`anisocontact convert`."""

from __future__ import annotations

import argparse
from pathlib import Path

from anisocontact.base.errors import InputError
from anisocontact.cli.output import say

__all__ = ["command"]


def command(arguments: argparse.Namespace) -> int:
    """Read a mesh, that of a case, or a results folder, and write it in another format."""
    if Path(arguments.source).is_dir():
        from anisocontact.results import Results
        from anisocontact.results.vtkhdf import write_vtkhdf

        target, results = Path(arguments.target), Results(arguments.source)
        if target.suffix != ".vtkhdf":
            raise InputError(f"'{arguments.target}' given; results are written as .vtkhdf")
        for kind in results.kinds or ["fields"]:
            added = "" if kind == "fields" else f"-{kind}"
            path = target.with_name(f"{target.stem}{added}.vtkhdf")
            write_vtkhdf(results, path, kind)
            say(f"written   {path}")
        return 0
    from anisocontact.case.build import mesh_of
    from anisocontact.mesh.described import described
    from anisocontact.mesh.write import write_mesh

    mesh = mesh_of(Path(arguments.source))
    write_mesh(mesh, arguments.target)
    for line in described(mesh):
        say(line)
    say(f"written   {arguments.target}")
    return 0
