"""`anisocontact convert`."""

from __future__ import annotations

import argparse
from pathlib import Path

from anisocontact.cli.output import say

__all__ = ["command"]


def command(arguments: argparse.Namespace) -> int:
    """Read a mesh, or the mesh of a case, and write it in another format."""
    from anisocontact.case.build import mesh_of
    from anisocontact.mesh.described import described
    from anisocontact.mesh.write import write_mesh

    mesh = mesh_of(Path(arguments.source))
    write_mesh(mesh, arguments.target)
    for line in described(mesh):
        say(line)
    say(f"written   {arguments.target}")
    return 0
