"""What the accepted state of a problem is asked for: forces, displacements, energies."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import Vec
from anisocontact.base.renamed import RenamedAttribute
from anisocontact.solver.system.accepted import AcceptedState
from anisocontact.solver.system.assembled import AssembledSystem
from anisocontact.solver.system.assembly import Assembly
from anisocontact.solver.system.configuration import Configuration
from anisocontact.solver.system.layout import Layout
from anisocontact.solver.system.reduction import Reduction
from anisocontact.solver.system.whole import Whole
from anisocontact.solver.terms.attachments import Attachments
from anisocontact.solver.terms.inclined_supports import InclinedSupports

#: Energies that every run reports, in this order.
ENERGIES = (
    "elastic",
    "adhesion",
    "normal",
    "friction",
    "viscous",
    "stabilisation",
    "regularisation",
)


class Energies(dict[str, float]):
    """Energies by their names; "flow", as "regularisation" was called before, finds it, too.

    Example:
        >>> Energies(elastic=2.0, regularisation=0.5)["regularisation"]
        0.5
    """

    def __missing__(self, name: str) -> float:
        if name != "flow":
            raise KeyError(name)
        warnings.warn('"flow" is now "regularisation"', DeprecationWarning, stacklevel=2)
        return self["regularisation"]


class ReportedSystem(AssembledSystem):
    """A system whose accepted state is known, of which only some unknowns may be up to date.

    Attributes:
        assembly: Its terms.
        layout: Where the unknowns are.
        attached: Springs and elastic supports.
        inclined: Planes of symmetry and cylindrical supports.
        whole: Who answers for the bulk where every state is one of all unknowns.
        reduction: Who answers for it now.
    """

    guides = RenamedAttribute("inclined")
    inner_forces = RenamedAttribute("internal_forces")

    assembly: Assembly
    layout: Layout
    attached: Attachments
    inclined: InclinedSupports
    whole: Whole
    reduction: Reduction
    _bodies: Configuration
    _accepted: AcceptedState
    _trial: Vec | None = None

    @contextmanager
    def asked_at(self, x: Vec | None) -> Iterator[None]:
        """Let forces and displacements be those of a trial while a function of a script looks.

        Args:
            x: All unknowns of the trial in equilibrium, evaluated; None for the accepted state.
        """
        self._trial = x
        try:
            yield
        finally:
            self._trial = None

    @property
    def outside(self) -> Floats:
        """All forces but those of contact on the unknowns this rank owns, accepted state."""
        return self._accepted.outside

    @property
    def contact_forces(self) -> Floats:
        """Forces of contact on the unknowns this rank owns, accepted state."""
        return self._accepted.contact

    def inverted_cells(self) -> Floats:
        """Middles of the cells of this rank that the last evaluation inverted, (n, 3)."""
        return self._bodies.inverted()

    def folded_cells(self) -> dict[str, Floats]:
        """Middles of those that it folded at a corner, by body, (n, 3)."""
        return self._bodies.folded()

    def reactions(self, x: Vec | None = None) -> dict[str, Floats]:
        """Force of the supports of each facet group on the bodies, and of springs, (3,), force.

        Unknowns on an edge that several groups prescribe count for the first of them. Collective.

        Args:
            x: All unknowns of the trial in equilibrium; the accepted state if not given.
        """
        x = self._trial if x is None else x
        sums = self.reduction.reactions(x)
        nodal = self._bodies.nodal if x is None else self.reduction.nodal(x)
        for name, force in self.attached.reactions(nodal, trial=x is not None).items():
            sums[name] = sums.get(name, 0.0) + force
        return sums

    def internal_forces(self) -> Floats:
        """Internal force on the nodes this rank owns, accepted state, (nodes, 3), force."""
        if self._trial is not None:
            return self.assembly.bodies.internal_force(self._bodies.nodal).reshape(-1, 3)
        self.reduction.recover()
        return self.assembly.bodies.accepted_internal_force(self._bodies.nodal).reshape(-1, 3)

    def support_forces(self) -> Floats:
        """Forces of the supports on the nodes this rank owns, accepted, (nodes, 3), force.

        Of elastic ones as well, as in `reactions`, not of springs.
        """
        self.reduction.recover()
        forces = self._accepted.reaction
        if self._trial is not None:
            forces = self.balance.outside - self.balance.load
        if self.attached.supports:
            forces = forces + self.layout.assembled(
                self.attached.supports.force(self._bodies.nodal)
            )
        return np.asarray(forces.reshape(-1, 3))

    def mean_displacement(self, group: str, weights: Floats) -> Floats:
        """Mean displacement of a facet group in the accepted state, (3,), length.

        Args:
            group: Its name.
            weights: Share of each local node in the mean, (nodes,).
        """
        return self.reduction.mean(group, weights, self._trial)

    def energies(self) -> Energies:
        """Energies of the accepted state, force times length.

        Returns:
            "external" work of supports, loads and temperatures since the start (trapezoidal rule),
            stored "elastic" (bodies), "adhesion" and "normal" (penalty) energy, not a number where
            a material or a law tells none, energy dissipated by
            "friction" and "viscous" laws, energy of "stabilisation", what the viscous
            "regularisation" has dissipated on jumps and, where there are any, energy of "springs"
            and elastic supports, what materials have dissipated, "inelastic", and "residual", what
            is left of "external" less all others: the error of the increments.

        Raises:
            InputError: A function of a script asks for those of a trial.
        """
        if self._trial is not None:
            text = "a trial has no energies yet: events wait for forces, displacements or stresses"
            raise InputError(text, "Until.measure")
        elastic = self.reduction.elastic() if self.assembly.bodies.bulk.stores else math.nan
        stored = dict.fromkeys(ENERGIES, 0.0) | {"elastic": elastic}
        stored |= self.assembly.bodies.dissipated()
        stored |= self.assembly.acting.energies(self._bodies.nodal)
        work = self._accepted.work
        return Energies(external=work, **stored, residual=work - sum(stored.values()))
