"""Balance of forces at a state: the residual, and the forces that say whether it is small."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from anisocontact.base.fenicsx import Vec
from anisocontact.solver.system.parts import Parts

Floats = npt.NDArray[np.float64]

#: Share of `|diag(K) u|` and of `Contact.lever` that is round-off of the forces.
ROUND_OFF = 16.0 * float(np.finfo(np.float64).eps)
#: Share of the loads that may be left out of balance as round-off.
LOAD_SHARE = 1e-6


@dataclass(frozen=True)
class Place:
    """A state of all bodies.

    Attributes:
        x: All unknowns of this rank, length.
        owned: Displacements this rank owns, length.
        nodal: Displacement of the local nodes, (nodes, 3), length.
        rigid: Unknowns of rigid bodies, the same on every rank.
    """

    x: Vec
    owned: Vec
    nodal: Floats
    rigid: Floats


@dataclass(frozen=True)
class Balance:
    """Forces at a state, of the unknowns this rank owns.

    Attributes:
        residual: Residual, with the forces that a correction takes beyond those of the state; NaN
            everywhere where a law has no answer.
        norm: Norm of the residual without them over all ranks; 0 where no multipliers follow.
        outside: All forces but those of contact.
        load: Of these, the loads.
        force_scale: See `Problem`.
        round_off: See `Problem`.
    """

    residual: Floats
    norm: float
    outside: Floats
    load: Floats
    force_scale: float
    round_off: float

    @classmethod
    def none(cls, owned: int) -> Balance:
        """No forces at all."""
        return cls(np.zeros(owned), 0.0, np.zeros(owned), np.zeros(owned), 0.0, 0.0)


def follow(parts: Parts) -> bool:
    """Whether multipliers follow every correction."""
    return any(contact.follows for contact in parts.contacts)


def balance(parts: Parts, place: Place, level: float, dt: float) -> Balance:
    """Balance of forces where the bodies are.

    Args:
        parts: Parts of the problem; its rigid bodies are in their place.
        place: Where the bodies are.
        level: Fraction of the step at which the supports are.
        dt: Time increment.
    """
    layout, scale = parts.layout, parts.support_scale
    contact_force, failed = _contact_force(parts, place.nodal, dt)
    given = layout.assembled(parts.loads.force(place.nodal))
    outside = parts.bulk.force(place.owned).array_r - contact_force
    if parts.stabilisation:
        outside -= parts.stabilisation.force(place.nodal).reshape(-1)[: layout.owned]
    outside, load = parts.constraints.tied(outside), parts.constraints.tied(given)
    residual = parts.constraints.reduce(outside - load, place.x, scale)
    rows = parts.supports.unknowns
    residual[rows] = scale * (place.owned.array_r[rows] - parts.supports.at(level))
    of_bodies = parts.rigid.residual(place.rigid, scale)
    held = np.concatenate([rows, parts.constraints.planes.slaves])
    on_nodes, *at_work = layout.norms(given, outside[held], contact_force, residual[rows])
    load_norm = float(np.hypot(on_nodes, float(np.linalg.norm(parts.rigid.loads()))))
    force_scale = max(
        load_norm,
        *at_work,
        float(np.linalg.norm(parts.rigid.spring_forces())),
        float(np.linalg.norm(of_bodies[parts.rigid.held()])),
    )
    round_off = _round_off(parts, place.owned, load_norm)
    if layout.comm.allreduce(failed):
        residual[:] = np.nan
    whole, norm = np.append(residual, of_bodies) if layout.last_rank else residual, 0.0
    if follow(parts):
        norm = float(np.sqrt(layout.comm.allreduce(float(whole @ whole))))
        whole = whole - _lag(parts, place.nodal)
    return Balance(whole, norm, outside, load, force_scale, round_off)


def _contact_force(parts: Parts, nodal: Floats, dt: float) -> tuple[Floats, bool]:
    """Forces of contacts, elastic supports and springs; whether a law has no answer."""
    forces = np.zeros(nodal.shape)
    failed = False
    for contact in parts.contacts:
        response = contact.update(nodal, dt)
        failed = failed or bool(response.failed.any())
        contact.add_force(forces)
    parts.attached.add_force(nodal, forces)
    return parts.layout.assembled(forces.reshape(-1)), failed


def _round_off(parts: Parts, u: Vec, load_norm: float) -> float:
    """Residual that floating point leaves, force."""
    levers = np.array([contact.lever() for contact in parts.contacts])
    moved = np.abs(u.array_r) + parts.bulk.rest_length
    round_off = ROUND_OFF * sum(parts.layout.norms(parts.bulk.diagonal.array_r * moved, levers))
    return min(round_off, LOAD_SHARE * load_norm) if load_norm > 0.0 else round_off


def _lag(parts: Parts, nodal: Floats) -> Floats:
    """Forces that a correction takes beyond those of the trial, see `ContactRecord.add_lag`."""
    forces = np.zeros(nodal.shape)
    for contact in parts.contacts:
        contact.add_lag(forces)
    lag = parts.constraints.handed(parts.layout.assembled(forces.reshape(-1)))
    lag[parts.supports.unknowns] = 0.0
    of_bodies = parts.rigid.lag()
    return np.append(lag, of_bodies) if parts.layout.last_rank else lag
