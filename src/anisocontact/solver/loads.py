"""Supports and tractions along the steps."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from anisocontact._fenicsx import fem
from anisocontact.contact import FacetQuadrature, facet_quadrature
from anisocontact.errors import InputError
from anisocontact.mesh import Model
from anisocontact.solver.steps import AXES, Step

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Support = tuple[str, int]  # facet group, axis


class Supports:
    """Unknowns that are prescribed, and their values along a step.

    An unknown that several groups prescribe (an edge) counts as one of the first of them.

    Attributes:
        unknowns: Local numbers of the prescribed unknowns this rank owns, (p,).
        start: Their values at the beginning of the step, length.
        end: Their values at its end, length.
    """

    def __init__(self, model: Model) -> None:
        self._model = model
        self._nodes: dict[str, Ints] = {}
        self._values: dict[Support, float] = {}
        self._owner: dict[Support, Ints] = {}
        self.unknowns: Ints = np.zeros(0, dtype=np.int64)
        self.start: Floats = np.zeros(0)
        self.end: Floats = np.zeros(0)

    def begin(self, step: Step, u: Floats) -> None:
        """Take over the supports of a step.

        Args:
            step: The step.
            u: Local unknowns at its beginning, length.

        Raises:
            InputError: An unknown facet group, or two groups that give shared nodes different
                values.
        """
        for group, values in step.displacement.items():
            self._model.facets(group, f"step {step.name!r}.displacement")
            for name, given in values.items():
                self._values.pop((group, AXES.index(name)), None)
                if given is not None:
                    self._values[group, AXES.index(name)] = float(given)
        taken = np.full(len(u), np.nan)
        owner: dict[Support, Ints] = {}
        for (group, axis), value in self._values.items():
            unknowns = 3 * self._owned_nodes(group) + axis
            clash = ~np.isnan(taken[unknowns]) & (taken[unknowns] != value)
            if clash.any():
                raise self._clash(step, group, axis, owner, unknowns[clash])
            owner[group, axis] = unknowns[np.isnan(taken[unknowns])]
            taken[unknowns] = value
        self._owner = owner
        self.unknowns = np.flatnonzero(~np.isnan(taken))
        self.start, self.end = u[self.unknowns], taken[self.unknowns]

    def at(self, fraction: float) -> Floats:
        """Prescribed values at a fraction of the step."""
        return (1.0 - fraction) * self.start + fraction * self.end

    def reactions(self, force: Floats) -> dict[str, Floats]:
        """Force of each group's supports on the body.

        Args:
            force: Force of the supports on the unknowns this rank owns.

        Returns:
            Facet group -> force, (3,), over all ranks.
        """
        sums: dict[str, Floats] = {}
        for (group, axis), unknowns in self._owner.items():
            sums.setdefault(group, np.zeros(3))[axis] = force[unknowns].sum()
        return {group: self._model.mesh.comm.allreduce(local) for group, local in sums.items()}

    def _owned_nodes(self, group: str) -> Ints:
        if group not in self._nodes:
            space = self._model.space
            nodes = fem.locate_dofs_topological(space, 2, self._model.facets(group))
            owned = nodes[nodes < space.dofmap.index_map.size_local]
            self._nodes[group] = owned.astype(np.int64)
        return self._nodes[group]

    def _clash(
        self, step: Step, group: str, axis: int, owner: dict[Support, Ints], shared: Ints
    ) -> InputError:
        other = next(
            g for (g, a), held in owner.items() if a == axis and np.isin(shared, held).any()
        )
        return InputError(
            f"{other!r} prescribes {self._values[other, axis]:g} and {group!r} "
            f"{self._values[group, axis]:g} for {AXES[axis]} on {len(shared)} shared nodes",
            f"step {step.name!r}.displacement",
        )


class Tractions:
    """Forces per reference area on facet groups, and what released supports still carry."""

    def __init__(self, model: Model) -> None:
        self._model = model
        self._quadrature: dict[str, FacetQuadrature] = {}
        self._start: dict[str, Floats] = {}
        self._end: dict[str, Floats] = {}
        index_map = model.space.dofmap.index_map
        self._released: Floats = np.zeros(3 * (index_map.size_local + index_map.num_ghosts))

    def begin(self, step: Step, released: Floats) -> None:
        """Take over the tractions of a step.

        Args:
            step: The step.
            released: Forces on the local unknowns that fade out along the step.

        Raises:
            InputError: An unknown facet group.
        """
        self._released = released
        self._start = {group: value.copy() for group, value in self._end.items()}
        for group, values in step.traction.items():
            facets = self._model.facets(group, f"step {step.name!r}.traction")
            if group not in self._quadrature:
                space, degree = self._model.space, 2 * self._model.order
                self._quadrature[group] = facet_quadrature(space, facets, degree)
            end = self._end.setdefault(group, np.zeros(3))
            for axis, value in values.items():
                end[AXES.index(axis)] = value

    def at(self, fraction: float) -> Floats:
        """Forces on the local unknowns at a fraction of the step."""
        force = (1.0 - fraction) * self._released
        for group, end in self._end.items():
            start = self._start.get(group, np.zeros(3))
            value = (1.0 - fraction) * start + fraction * end
            quadrature = self._quadrature[group]
            traction = np.broadcast_to(value, (quadrature.count, 3))
            quadrature.to_nodes(traction, force.reshape(-1, 3))
        return force


def check_steps(model: Model, steps: Sequence[Step]) -> None:
    """Go through the loads of all steps without solving.

    Raises:
        InputError: See `Supports.begin` and `Tractions.begin`.
    """
    supports, tractions = Supports(model), Tractions(model)
    nothing = np.zeros(3 * model.space.dofmap.index_map.size_local)
    for step in steps:
        supports.begin(step, nothing)
        tractions.begin(step, nothing)
