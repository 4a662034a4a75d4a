"""What is worth knowing of friction before the run: rules whose forces jump, thin ellipses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact.contact import Contact
from anisocontact.interface.jumping_forces import jumping_forces
from anisocontact.laws import EXPLICIT

#: Ratio of two coefficients of friction below which increments fail: a block that is pressed and
#: dragged is solved by all methods at 3e-4, by some at 3e-5, by none at 3e-6.
THIN = 1e-4
#: Coefficient of friction above which increments become hard where points open: a block that is
#: pressed on a wider one and dragged by a fifth of its length takes 4 corrections in its last
#: increment at 50, 9 at 200, 79 at 1000, and cannot be followed at 1e6. Forces at 200 are within
#: 0.3 % of those at 1000.
ROUGH = 200.0


def doubtful_friction(contacts: Sequence[Contact]) -> list[str]:
    """Contacts whose sliding rule lets tangential forces jump, or whose ellipse is unfit.

    With isotropic stiffness slip of a slip ellipse relieves the yield function everywhere where
    the symmetric part of F K is positive definite, docs/theory/sliding-rules.md. The force of
    `explicit` does not turn at once where sliding begins if B F is isotropic,
    docs/theory/errata.md.

    Returns:
        A line for each of them.
    """
    return [
        f"contact of {' with '.join(one.groups)}: {text}"
        for one in contacts
        if not one.interface.tangential.in_python
        for text in (
            jumping_forces(one.interface.tangential) or _associated(one),
            _thin(one),
            _rough(one),
        )
        if text
    ]


def wrong_derivatives(contacts: Sequence[Contact]) -> str:
    """Laws in Python whose derivatives were wrong in the last evaluation; collective.

    Args:
        contacts: Those whose laws are asked.

    Returns:
        What is wrong, the same on each rank; empty where nothing is.
    """
    every = ((one.name, one.interface.tangential.doubts()) for one in contacts)
    own = [f"contact {name!r}: {said}" for name, said in every if said]
    parts = contacts[0].model.mesh.comm.allgather(own) if contacts else []
    return "; ".join(dict.fromkeys(text for part in parts for text in part))


def _coefficients(contact: Contact) -> Floats:
    """Coefficients of friction, (2,); 1 where there are none of these."""
    return np.array(contact.interface.tangential.friction.named[1].get("coefficients", (1.0, 1.0)))


def _rough(contact: Contact) -> str:
    """What coefficients that stand for "no slip" do, in words; empty if they are no such ones."""
    most = float(_coefficients(contact).max())
    if most <= ROUGH:
        return ""
    return (
        f"a coefficient of friction of {most:.3g} lets points slip only where they bear next to no "
        f"pressure, at the moment they open, and increments may not converge there; {ROUGH:g} "
        "lets next to nothing slip either, and a tie holds everything"
    )


def _thin(contact: Contact) -> str:
    """What coefficients far apart do, in words; empty if they are not."""
    mu = _coefficients(contact)
    if not 0.0 < mu.min() < THIN * mu.max():
        return ""
    return (
        f"the coefficients of friction, {mu[0]:.3g} and {mu[1]:.3g}, have a ratio of "
        f"{mu.min() / mu.max():.1g}: below {THIN:g} rounding across so thin an ellipse may "
        f"keep increments from converging; {1e-3 * mu.max():.1g} is next to nothing beside the "
        "larger one, too"
    )


def _associated(contact: Contact) -> str:
    """What the run has chosen for `explicit`, in words; empty where nothing hangs on it."""
    law = contact.interface.tangential
    stiffness = law.adhesion.named[1].get("stiffness", (1.0, 1.0))
    if contact.physical_adhesion or law.sliding_rule != EXPLICIT or len(set(stiffness)) == 1:
        return ""
    return (
        f"with sliding_rule = '{EXPLICIT}' the adhesion says which way forces of sliding have: its "
        f'stiffness "auto" is {stiffness[0]:.3g} and {stiffness[1]:.3g}, in proportion to the '
        "squares of the coefficients, with which the rule slides as 'maximum-dissipation' and "
        "nothing jumps; give stiffnesses for those of the surfaces"
    )
