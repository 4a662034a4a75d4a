"""What a contact is by default: the same in case files and in scripts."""

from __future__ import annotations

from anisocontact.contact.penalty import facet_size
from anisocontact.interface import AdhesionAndFriction, ContactLaw, PythonLaw
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Friction, NormalLaw, numerical_adhesion
from anisocontact.mesh import Model

#: Laws without one of the pressure, which is then a multiplier.
type WithoutPenalty = Friction | AdhesionAndFriction | PythonLaw

#: How many times as stiff as the master a finer slave of a mortar contact may be, and its facets
#: over those of the master. At 5 on 4 facets per contact radius the pressures of Hertz are off by
#: 2.6 % of the peak for 2, 13 % for 10, docs/verification/mortar.md.
STIFF, FINER = 3.0, 0.95


def takes_nodes(
    model: Model,
    slave: str,
    master: str | None,
    degree: int | None = None,
    young: tuple[float, float] | None = None,
) -> bool:
    """Whether a contact evaluates its law at the slave nodes, not at integration points.

    Nodes are exact where pressures at points matter, docs/verification/mortar.md, and are taken
    wherever they can be.

    Args:
        model: Mesh of the bodies.
        slave: Facet group of the slave.
        master: Facet group of the master; None for a surface.
        degree: Degree of a quadrature that was asked for.
        young: Young's moduli of slave and master, where they are known, stress.
    """
    if master == slave:  # integration points fold onto nothing
        return True
    if degree is not None or (model.mesh.comm.size > 1 and model.idealisation.dim == 2):
        return False
    if master is None or young is None or young[0] <= STIFF * young[1]:
        return True
    # nodes of a slave that is stiffer and finer lose contact in between, see `stiff_slaves`
    return facet_size(model, slave) >= FINER * facet_size(model, master)


def exact(
    law: ContactLaw | WithoutPenalty | None, given: Augmentation | None
) -> tuple[ContactLaw | None, Augmentation | None]:
    """Laws and multipliers of a contact: where no law of the pressure is given it holds exactly.

    Friction alone sticks without elastic slip; adhesion, and a law in Python, are physical.

    Args:
        law: What is given.
        given: Its multipliers, if these are given too.
    """
    if not isinstance(law, Friction | AdhesionAndFriction | PythonLaw):
        return law, given
    augmentation = given or Augmentation(tangential=isinstance(law, Friction))
    if isinstance(law, Friction):
        law = AdhesionAndFriction(numerical_adhesion(law, 1.0), law)
    # multipliers take penalties that suit the bodies, whatever these are
    return ContactLaw(NormalLaw(penalty=1.0), law), augmentation
