"""Slave facets against the master of an interface: forces, tangent and history."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact._fenicsx import Mat, PETSc
from anisocontact.contact.quadrature import default_degree, facet_quadrature
from anisocontact.errors import InputError
from anisocontact.interface import STATUS, Interface, Response, State
from anisocontact.mesh import Model

Floats = npt.NDArray[np.float64]


class Contact:
    """Contact of a facet group with the master surface of an interface.

    The residual gets `-integral of t . delta u` over the slave area in the reference
    configuration, the tangent `-integral of delta u . (dt/dx) . du`; `t` is the traction on the
    slave at `x = X + u`. The history advances with `commit` only.

    Args:
        model: Mesh with the facet group.
        slave: Facet group "body.group".
        interface: Surface and laws.
        degree: Degree of the quadrature on the facets, >= 1; twice the order of the displacement
            if not given.
        name: Name in output; the slave if not given.

    Attributes:
        state: Committed history, one record for each point.
        last: Response of the accepted increment.

    Raises:
        InputError: No such facet group, one without facets, or a degree below 1.
    """

    def __init__(
        self,
        model: Model,
        slave: str,
        interface: Interface,
        *,
        degree: int | None = None,
        name: str = "",
    ) -> None:
        facets = model.facets(slave, "slave")
        if model.count_facets(slave) == 0:
            raise InputError(f"facet group {slave!r} has no facets", "slave")
        degree = default_degree(model.order) if degree is None else degree
        if degree < 1:
            raise InputError(f"{degree!r} given, must be >= 1", "degree")
        self.slave = slave
        self.name = name or slave
        self.interface = interface
        self.quadrature = facet_quadrature(model.space, facets, degree)
        self._comm = model.mesh.comm
        self._points = self.quadrature.reference
        self.state: State = interface.initial_state(self._points)
        self.last: Response = interface.update(self.state, self._points, tangent=False)
        self._trial: tuple[Floats, Response] | None = None

    @property
    def points(self) -> Floats:
        """Slave points where they are after the accepted increment, (n, 3), length."""
        return self._points

    @property
    def areas(self) -> Floats:
        """Area of each slave point, (n,), length^2."""
        return self.quadrature.areas

    def update(self, u: Floats, dt: float) -> Response:
        """Response to nodal displacements from the committed history, kept as the trial.

        Args:
            u: Displacement of the local nodes, (nodes, 3), length.
            dt: Time increment.

        Returns:
            The response; the committed history is unchanged.
        """
        x = self.quadrature.reference + self.quadrature.at_points(u)
        response = self.interface.update(self.state, x, dt)
        self._trial = x, response
        return response

    @property
    def trial(self) -> Response:
        """Response of the last `update`, or of the accepted increment if there was none since."""
        return self._trial[1] if self._trial else self.last

    def failed_points(self) -> Floats:
        """Positions of the trial at which the law has no answer, (failed, 3), length."""
        if self._trial is None:
            return np.zeros((0, 3))
        x, response = self._trial
        return x[response.failed]

    def add_force(self, out: Floats) -> None:
        """Add the forces of the trial on the slave to the local nodes, (nodes, 3), force."""
        self.quadrature.to_nodes(self.trial.traction, out)

    def add_tangent(self, matrix: Mat) -> None:
        """Add `-d force / d u` of the trial to the matrix of the system."""
        blocks = self.quadrature.facet_matrices(-self.trial.tangent)
        nodes = self.quadrature.nodes
        matrix.setValuesBlockedLocalRCV(nodes, nodes, blocks, PETSc.InsertMode.ADD_VALUES)

    def lever(self) -> float:
        """Forces that would move every point of the trial to the origin, norm over this rank.

        The machine's precision times this is the round-off of the contact forces: positions are
        known to a share of their distance from the origin.
        """
        x, response = self._trial if self._trial else (self._points, self.last)
        stiffness = np.linalg.norm(response.tangent, axis=(1, 2)) * self.areas
        return float(np.linalg.norm(stiffness * np.linalg.norm(x, axis=1)))

    def commit(self) -> None:
        """Make the trial the history."""
        if self._trial is not None:
            self._points, self.last = self._trial
            self.state = self.last.state
            self._trial = None

    def roll_back(self) -> None:
        """Forget the trial."""
        self._trial = None

    def counts(self) -> dict[str, int]:
        """Number of open, sticking and slipping points of the trial, over all ranks."""
        local = np.bincount(self.trial.status, minlength=len(STATUS))
        total = self._comm.allreduce(local)
        return {name: int(n) for name, n in zip(STATUS, total, strict=True)}

    def resultant(self) -> tuple[Floats, Floats]:
        """Force and moment about the origin on the slave after the accepted increment.

        Returns:
            Force (3,) and moment (3,), force and force times length.
        """
        forces = self.areas[:, None] * self.last.traction
        local = np.concatenate([forces.sum(axis=0), np.cross(self._points, forces).sum(axis=0)])
        total = self._comm.allreduce(local)
        return total[:3], total[3:]

    def energies(self) -> dict[str, float]:
        """Stored and dissipated energy after the accepted increment.

        Returns:
            "adhesion" (elastic, tangential), "normal" (of the penalty) and "friction" (dissipated
            since the start), force times length.
        """
        fields = {
            "adhesion": "energy_adhesion",
            "normal": "energy_normal",
            "friction": "dissipation",
        }
        local = np.array([self.areas @ self.state[name] for name in fields.values()])
        return dict(zip(fields, self._comm.allreduce(local).tolist(), strict=True))

    def extreme(self, values: Any) -> float:
        """Largest of one number at each point, over all ranks; 0 without points."""
        return float(max(self._comm.allgather(float(np.max(values, initial=0.0)))))
