"""Which contacts of free bodies have another side that is held."""

from __future__ import annotations

from collections.abc import Sequence

from anisocontact.contact import Contact
from anisocontact.solver.terms.free_body import FreeBody, closed_points


def held_contacts(bodies: Sequence[FreeBody], at_start: bool = False) -> list[list[Contact]]:
    """Contacts of each of some free bodies whose other side is held; collective.

    What none of them is on is held, and a body that touches what is held is so itself.

    Args:
        bodies: All free bodies.
        at_start: As of `FreeBody.touched`.
    """
    on = {id(c): c for one in bodies for c in one.contacts}
    closed = {
        k: c.space.mesh.comm.allreduce(int(closed_points(c, at_start).any())) > 0
        for k, c in on.items()
    }
    owners = {k: [i for i, one in enumerate(bodies) if one.meets(c)] for k, c in on.items()}
    held: set[int] = set()

    def on_held(i: int) -> list[Contact]:
        sides = zip(bodies[i].contacts, bodies[i].sides, strict=True)
        return [c for c, side in sides if side and held.issuperset(set(owners[id(c)]) - {i})]

    while True:
        found = {
            i
            for i in range(len(bodies))
            if i not in held and any(closed[id(c)] for c in on_held(i))
        }
        if not found:
            return [on_held(i) for i in range(len(bodies))]
        held |= found
