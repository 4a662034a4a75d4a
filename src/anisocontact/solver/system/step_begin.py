"""A step begins: the terms of a problem take it over; and all steps are gone through beforehand."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from anisocontact.base.array_types import Flags, Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.bulk.material_warnings import doubtful_materials
from anisocontact.contact.mirror_planes import unmirrored
from anisocontact.contact.remote_nodes import with_ghosts
from anisocontact.mesh.connected_components import unjoined_bodies
from anisocontact.mesh.folded_cells import folded_cells
from anisocontact.solver.system.lost_loads import check_lost_loads, supported_space, unsupported
from anisocontact.solver.system.parts import ProblemParts
from anisocontact.solver.terms.free_modes import Supported, SupportedFrame, along_axes
from anisocontact.solver.terms.inclined_supports import InclinedSupports
from anisocontact.solver.terms.loads import Loads
from anisocontact.solver.terms.sector_contacts import halved_nodes
from anisocontact.solver.terms.step import AXES, Step, check_load_curves
from anisocontact.solver.terms.supports import Supports


def begin_step(
    parts: ProblemParts, step: Step, start: Floats, reaction: Floats, again: bool
) -> None:
    """Take over the loads of a step; what is no longer prescribed goes on from its reaction.

    Args:
        parts: Parts of the problem.
        step: The step.
        start: Accepted displacements of the local nodes, (3 nodes,), length.
        reaction: What the supports carry there, on the unknowns this rank owns, force.
        again: Whether the step had begun before, in a run that now goes on.

    Raises:
        InputError: See `Supports.begin` and `DeadLoads.begin`.
    """
    supports, inclined = parts.supports, parts.inclined
    before, let_go = supports.unknowns, inclined.released(reaction, step)
    _, of_supports = inclined.forces(reaction)
    supports.begin(step, start)
    inclined.begin(step, start, supports.unknowns, supports.end)
    held = [*supports.supported(), *inclined.supported()]
    gone = np.setdiff1d(before, supports.unknowns)
    let_go[gone] += of_supports[gone]
    released = np.zeros(len(start))
    released[: len(let_go)] = unsupported(let_go.reshape(-1, 3), held).reshape(-1)
    parts.assembly.terms.begin(step, released)
    if parts.assembly.constraints.ties is not None:
        parts.assembly.constraints.ties.begin(held, _on_bodies(parts))
    _begin_contacts(parts, held, len(start) // 3)
    load = parts.loads.at_end(start.reshape(-1, 3)) if parts.attached else None
    frames = parts.rigid.supported_frames() + _cut_faces(parts)
    parts.stabilisation.find_free(held, step.name, load, not again, frames)


def _begin_contacts(parts: ProblemParts, held: Sequence[Supported], count: int) -> None:
    """Let contacts know along which directions nodes are prescribed, and along which they rest."""
    of_faces = along_axes(parts.rigid.prescribed_of_faces())
    fixed = supported_space(count, [*held, *of_faces])
    if parts.assembly.constraints.ties is not None:
        parts.assembly.constraints.ties.sectors.hold_cuts(fixed)
    fixed = with_ghosts(parts.model.space, fixed)
    still = [*parts.supports.resting(), *parts.inclined.resting()]
    there = np.zeros((count, len(still)), dtype=bool)
    for i, (nodes, _) in enumerate(still):
        there[nodes, i] = True
    if parts.model.idealisation.dim == 2:
        # what holds a plane is no mirror: friction across it is what axes at an angle make of slip,
        # but where nothing slides in the plane either
        across = np.array([bool(direction[2]) for _, direction in still], dtype=bool)
        there[:, across] &= there[:, ~across].any(axis=1, keepdims=True)
    there = with_ghosts(parts.model.space, there)
    resting = [(there[:, i], direction) for i, (_, direction) in enumerate(still)]
    for contact in parts.contacts:
        contact.take_supports(fixed, resting)


def _rehearsed(
    parts: ProblemParts, steps: Sequence[Step]
) -> Iterator[tuple[Step, Supports, InclinedSupports, Loads]]:
    """Supports, inclined ones and loads of every step, begun without solving.

    Unknowns that no support has prescribed stand at zero, the others where they have been led to.
    """
    model = parts.model
    supports, loads = Supports(model), Loads(model, parts.materials)
    inclined = parts.inclined.fresh()
    u, nothing = np.zeros(model.positions.size), np.zeros(model.positions.size)
    for step in steps:
        supports.begin(step, u)
        inclined.take_over(step, nothing)
        loads.begin(step, nothing)
        yield step, supports, inclined, loads
        u[supports.unknowns] = supports.end


def check_steps(parts: ProblemParts, steps: Sequence[Step]) -> list[str]:
    """Go through the supports and loads of all steps without solving.

    Returns:
        What is doubtful, a line each.

    Raises:
        InputError: See `check_load_curves`, `Supports.begin`, `DeadLoads.begin`,
            `InclinedSupports.begin` and `check_lost_loads`.
    """
    turned, doubtful = False, check_load_curves(steps)
    known = np.ones(len(parts.model.positions), dtype=bool)  # nodes whose place is
    for step, supports, inclined, loads in _rehearsed(parts, steps):
        parts.assembly.bodies.check(step)
        _check_motions(parts, step)
        # Where a turn ends is not known before it has been, unless it is known where it begins.
        turned = turned or _turns_unknown(parts, step, known)
        for share in () if turned else supports.places:
            supports.set_load_factor(float(share))
            inclined.check(supports.unknowns, supports.values, step.name, float(share))
        if parts.rigid.faces:
            all_prescribed = np.concatenate([supports.unknowns, inclined.cylinders.unknowns])
            parts.rigid.faces.check(all_prescribed, step.name)
        held = [*supports.supported(), *inclined.supported()]
        if (ties := parts.assembly.constraints.ties) is not None:
            ties.check(held, _on_bodies(parts))
            ends = supports.unknowns, supports.end
            ties.check_prescribed(*ends, step.name)
            ties.sectors.check_prescribed(*ends, inclined.of_planes(), step.name)
        check_lost_loads(parts.layout, step, loads.given(step), held)
        known[:] = False
        if step.until is None:
            numbers, count = np.unique(supports.unknowns // 3, return_counts=True)
            known[numbers] = count == 3
    return doubtful + _doubtful(parts)


def _turns_unknown(parts: ProblemParts, step: Step, known: Flags) -> bool:
    """Whether a step turns a rigid body, or nodes whose place is not known when it begins."""
    nodes = (parts.model.nodes(group) for group in step.turned_groups())
    return bool(step.turned_bodies()) or not all(known[own].all() for own in nodes)


def _doubtful(parts: ProblemParts) -> list[str]:
    """What is doubtful whatever the steps ask for, a line each; collective."""
    ties, materials = parts.assembly.constraints.ties, parts.materials
    of_ties = (
        [] if ties is None else [*ties.left_out(), *halved_nodes(parts.contacts, ties.sectors)]
    )
    bodies = doubtful_materials(parts.model, materials, parts.bulk)
    of_contacts = [nodes for contact in parts.contacts for nodes in contact.nodes_of_groups]
    links = [] if ties is None else ties.links
    tied = [parts.model.facet_nodes(group) for link in links for group in link]
    directions = unmirrored(parts.contacts, parts.inclined.of_planes())
    cells = folded_cells(parts.model)
    return of_ties + bodies + cells + directions + unjoined_bodies(parts.model, of_contacts + tied)


def _cut_faces(parts: ProblemParts) -> list[SupportedFrame]:
    """Cut faces of sectors."""
    ties = parts.assembly.constraints.ties
    return [] if ties is None else ties.sectors.frames()


def _on_bodies(parts: ProblemParts) -> Ints:
    """Unknowns that follow rigid bodies, local numbers."""
    faces = parts.rigid.faces
    return np.zeros(0, dtype=np.int64) if faces is None else faces.dependents


def _check_motions(parts: ProblemParts, step: Step) -> None:
    """Refuse rigid motions that make a plane, or a body of revolution, something else."""
    idealisation = parts.model.idealisation
    with_faces = {body.name for body, faces in parts.rigid.coupled.items() if faces}

    def known(body: str) -> tuple[tuple[str, ...], str]:
        allowed = idealisation.of_faces if body in with_faces else idealisation.motions
        lateral = "" if body not in with_faces or idealisation.lateral else " without lateral"
        name = f"{idealisation.entry.name}{lateral}"
        return allowed, f"{name} has no such motion; allowed: {', '.join(allowed)}"

    for body, components in step.motion.items():
        allowed, said = known(body)
        for name, value in components.items():
            if name not in allowed and value != 0.0:
                field = f"step {step.name!r}.motion.{body}.{name}"
                raise InputError(f"{value!r} given, {said}", field)
    for name, turn in step.rotation.items():
        allowed, said = known(name)
        about = [f"r{axis}" for axis, share in zip(AXES, turn.axis, strict=True) if share]
        along = [axis for axis, share in zip(AXES, turn.move, strict=True) if share]
        if any(turn.point[i] for i, axis in enumerate(AXES) if axis not in allowed):
            along.append("of a point beside the axis")
        if wrong := [motion for motion in (*about, *along) if motion not in allowed]:
            field = f"step {step.name!r}.rotation.{name}"
            raise InputError(f"a motion {wrong[0]} given, {said}", field)


def contact_must_hold(parts: ProblemParts, steps: Sequence[Step]) -> bool:
    """Whether contact alone has to hold a body without springs in one of the steps.

    Raises:
        InputError: A body is free to move and in no contact.
    """
    found = False
    all_frames = parts.rigid.rehearsed(steps)
    rehearsed = _rehearsed(parts, steps)
    for (step, supports, inclined, loads), frames in zip(rehearsed, all_frames, strict=True):
        held = [*supports.supported(), *inclined.supported()]
        rest = np.zeros_like(parts.model.positions)
        load = loads.at_end(rest) if parts.attached else None
        all_supported = [*frames, *_cut_faces(parts)]
        parts.stabilisation.find_free(held, step.name, load, False, all_supported)
        found = found or parts.stabilisation.contact_alone
    parts.stabilisation.clear()
    return found
