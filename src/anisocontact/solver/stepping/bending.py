"""Whether bodies that contact alone holds bend, so that multipliers are sought by what bends."""

from __future__ import annotations

from anisocontact.bulk import PLASTIC_STRAIN
from anisocontact.contact.multiplier_schemes import SLENDER
from anisocontact.mesh.slenderness import slenderness
from anisocontact.solver.system.problem import Problem

#: Length over thickness, see `slenderness`, from which on bodies bend before they are strained: a
#: bore or tyre, whose faces are held, has 14 to 19.
BENDS = 25.0


def bend(problem: Problem) -> bool:
    """Whether the penalties of what bends come first in a step; collective.

    A slender body at finite strain turns by much of what a correction moves it, and that leaves
    gaps which usual penalties take for a contact that opens: nothing would hold it then. The
    contacts learn whether it is so, whether any body is slender, however it is held and whatever
    contacts hold by, and whether one may yield.

    Args:
        problem: The problem, in a step.
    """
    contacts = problem.contact_term
    follows = SLENDER in contacts.ways and not problem.linear
    contacts.compact = not _slender(problem, _of_contacts(problem))
    contacts.slender = follows and not contacts.compact
    contacts.bends = contacts.slender and _slender(problem, _held_by_contact(problem))
    contacts.plastic = not _plastic(problem).isdisjoint(_of_contacts(problem))
    return contacts.bends


def told_if_unstable(problem: Problem) -> bool:
    """Whether a state that is not stable is to be told of the present step.

    A body that contact alone holds may stand on a single node where that it stands for rests on
    more than a facet, and is told only where it is slender.
    """
    return not problem.stabilisation.loose or problem.contact_term.slender


def _slender(problem: Problem, bodies: set[str]) -> bool:
    """Whether one of some bodies is slender that no face on a rigid body keeps in shape."""
    faces = problem.rigid.faces
    kept = set() if faces is None else {face.group.split(".")[0] for face in faces.faces}
    return slenderness(problem.model, bodies - kept) > BENDS


def _plastic(problem: Problem) -> set[str]:
    """Bodies whose material remembers a plastic strain."""
    histories = problem.bulk.histories.items()
    return {body for body, history in histories if PLASTIC_STRAIN in history.variables}


def _of_contacts(problem: Problem) -> set[str]:
    """Bodies of which contacts have facets."""
    names = {name.split(".")[0] for contact in problem.contacts for name in contact.groups}
    return names & set(problem.model.body_names())


def _held_by_contact(problem: Problem) -> set[str]:
    """Bodies that contact alone holds."""
    return {part for free in problem.stabilisation.loose for part in free.body.parts}
