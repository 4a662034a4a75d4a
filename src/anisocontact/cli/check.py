"""`anisocontact check`."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from anisocontact.base.shown import shown
from anisocontact.case import load
from anisocontact.case.amplitudes import FunctionTable
from anisocontact.cli.output import say

if TYPE_CHECKING:
    from anisocontact.case.build import Built
    from anisocontact.contact import Contact


def command(arguments: argparse.Namespace) -> int:
    """Build the case and say what is in it."""
    path = Path(arguments.case)
    if path.suffix.lower() != ".toml" and _is_mesh(path):
        return 0
    file = load(path)

    from anisocontact.case.build import build
    from anisocontact.case.mesh import mesh_of
    from anisocontact.mesh.described import described

    built = build(file, python=not arguments.no_python)
    for line in (*contents(built), *_overlaps(built)):
        say(line)
    for line in described(mesh_of(path)):
        say(line)
    if arguments.no_python:
        for section in file.case.contact:
            if section.python is not None:
                say(f"not run   {section.python.file}: its law is not checked")
        for table in file.case.amplitude.values():
            if isinstance(table, FunctionTable):
                say(f"not run   {table.file}: its amplitude is not checked")
    return 0


def _is_mesh(path: Path) -> bool:
    """Say what is in a mesh file; whether it is one, by the ending of its name."""
    from anisocontact.mesh.described import described
    from anisocontact.mesh.inp import deck_supports
    from anisocontact.mesh.readers import file_arrays, is_mesh

    if not is_mesh(path):
        return False
    mesh = file_arrays(path, field="")
    for line in described(mesh):
        say(line)
    for line in mesh.torn:
        say(f"warning   {line}")
    if path.suffix.lower() == ".inp":
        for line in deck_supports(path, list(dict.fromkeys([*mesh.facets, *mesh.nodes]))):
            say(f"support   {line}")
    say("units     a mesh file has none: the numbers are taken as they are")
    return True


def contents(built: Built) -> list[str]:
    """What a case contains, in a few lines."""
    title = built.file.case.title or built.file.name
    steps = (
        f"step      {step.name}: {step.increments} increments, "
        f"{', '.join(step.driven()) or 'nothing new'}"
        for step in built.steps
    )
    return [
        f"case      {title}",
        *_mesh(built),
        *_contacts(built),
        *_ties(built),
        *_points(built),
        *_rigid_bodies(built),
        *steps,
        *_hints(built),
    ]


def _mesh(built: Built) -> Iterator[str]:
    """Bodies with their materials, and the mesh of all."""
    model, problem = built.problem.model, built.problem
    for body in model.body_names():
        yield f"body      {body}: {built.file.case.material[body].chosen['model']}"
    topology = model.mesh.topology
    cells = topology.index_map(topology.dim).size_global
    nodes = model.space.dofmap.index_map.size_global
    yield (
        f"mesh      {nodes} nodes, {cells} cells of order {model.order}, "
        f"{problem.unknowns} unknowns"
    )


def _contacts(built: Built) -> Iterator[str]:
    """Slave, master, and by which laws and where they meet."""
    problem = built.problem
    for section, contact in zip(built.file.case.contact, problem.contacts, strict=True):
        _, values = contact.interface.normal.named
        penalty = f", penalty {values['penalty'][0]:.4g}" if "penalty" in values else ""
        own = section.python
        rule = section.friction.sliding_rule if own is None else f"{own.law} of {own.file}"
        facets = problem.model.count_facets(section.slave)
        yield (
            f"contact   {section.slave} on {section.master}: {facets} slave facets{penalty}, "
            f"{rule}, {_pass(contact)}"
        )


def _ties(built: Built) -> Iterator[str]:
    """Ties, and what they have moved in the mesh."""
    for tie in built.file.case.tie:
        facets = built.problem.model.count_facets(tie.slave)
        yield f"tie       {tie.slave} to {tie.master}: {facets} slave facets"
    for line in built.adjusted:
        yield f"tie       {line}"


def _rigid_bodies(built: Built) -> Iterator[str]:
    """Rigid bodies and the facet groups that follow them."""
    for rigid in built.problem.rigid.bodies:
        how = "free where a step frees it" if rigid.free else "moved as prescribed"
        at = ", ".join(f"{v:g}" for v in rigid.reference)
        led = [face.group for face in built.problem.rigid.coupled[rigid]]
        with_ = f", with {', '.join(led)}" if led else ""
        yield f"rigid     {rigid.name}: reference point ({at}), {how}{with_}"


def _hints(built: Built) -> Iterator[str]:
    """What is worth a note, and what is hardly meant; collective."""
    from anisocontact.contact import doubtful_sides
    from anisocontact.contact.field_hints import doubtful_fields
    from anisocontact.contact.friction_hints import doubtful_friction
    from anisocontact.contact.hints import uneven
    from anisocontact.contact.tips import points_on_tips

    contacts = built.problem.contacts
    for text in uneven(contacts):
        yield f"note      {text}"
    doubts = (*doubtful_sides(contacts), *doubtful_friction(contacts), *doubtful_fields(contacts))
    found = (*built.doubts(), *built.solver.cautions, *doubts, *points_on_tips(contacts))
    for text in found:
        yield f"warning   {text}"


def _overlaps(built: Built) -> list[str]:
    """What a run says of bodies that overlap at its start."""
    from anisocontact.contact.hints import overlapping

    pairs = (
        (contact, f"contact of {section.slave} with {section.master}", contact.facet_size)
        for section, contact in zip(built.file.case.contact, built.problem.contacts, strict=True)
    )
    return [f"warning   {line}" for line in overlapping(pairs, "adjust = true")]


def _pass(contact: Contact) -> str:
    """Where the law of a contact is evaluated, and how exactly it holds."""
    where = "at slave nodes (mortar)" if contact.slave_points.at_nodes else "at integration points"
    return f"{where}, {'multipliers' if contact.trials.augmented else 'penalties'}"


def _points(built: Built) -> Iterator[str]:
    """What was found for the names of points and edges; collective."""
    model, comm = built.problem.model, built.problem.comm
    x = model.space.tabulate_dof_coordinates()
    size = max(comm.allgather(float(np.abs(x).max(initial=0.0))))
    for name in built.file.case.nodes:
        places = np.concatenate(comm.allgather(x[model.nodes(name)]))
        where = f"at {shown(places[0], 6, size)}" if len(places) == 1 else "on a line"
        yield f"nodes     {name}: {len(places)} {where}"
