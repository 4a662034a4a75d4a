"""`anisocontact convert`."""

from __future__ import annotations

import argparse
from pathlib import Path

from anisocontact.base.errors import InputError
from anisocontact.cli.output import say


def command(arguments: argparse.Namespace) -> int:
    """Read a mesh, that of a case, or a results folder, and write it in another format.

    Of a deck of Abaqus or CalculiX also a case file.
    """
    if Path(arguments.target).suffix.lower() == ".toml":
        return _case(Path(arguments.source), Path(arguments.target))
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
    from anisocontact.case.mesh import mesh_of
    from anisocontact.mesh.described import described
    from anisocontact.mesh.write import write_mesh

    mesh = mesh_of(Path(arguments.source))
    write_mesh(mesh, arguments.target)
    for line in described(mesh):
        say(line)
    say(f"written   {arguments.target}")
    return 0


def _case(source: Path, target: Path) -> int:
    """Write what a deck says as a case file."""
    from anisocontact.base.whole_files import named_by_user, replacing
    from anisocontact.case.from_deck import case_of_deck

    if source.suffix.lower() != ".inp":
        raise InputError(f"'{source}' given; a case file is written of a deck .inp")
    if target.exists():
        raise InputError(f"'{target}' exists already; give another name")
    text, left_out = case_of_deck(source, target)
    with named_by_user(target), replacing(target) as draft:
        draft.write_text(text, encoding="utf-8")
    for line in left_out:
        say(f"left out  {line}")
    say(f"written   {target}")
    if "[[step]]" not in text.splitlines():
        say("missing   [[step]]: the deck has no *STEP; supports and loads are to be written there")
    say(f"next      anisocontact check {target}")
    return 0
