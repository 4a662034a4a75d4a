"""An interface on a rigid body: evaluated in the frame of the body, answered in space."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.typed import typed
from anisocontact.interface import Interface, Response, SlaveSurface, State
from anisocontact.rigid.body import RigidBody
from anisocontact.rigid.rotation import skew
from anisocontact.surfaces import Surface


@typed
@dataclass(frozen=True)
class MovingSurface:
    """A surface that moves with a rigid body, as the master of a `Contact`.

    Args:
        surface: The surface where it was drawn, or one with its laws.
        body: The body; the surface rests if there is none.

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> die = make_surface("plane", point=(0, 0, 1), normal=(0, 0, -1))
        >>> MovingSurface(die, RigidBody("die", (0, 0, 1))).body.name
        'die'
    """

    surface: Surface | Interface
    body: RigidBody | None


class MovingInterface:
    """An interface whose surface and directions move with a rigid body.

    The slave points are brought into the frame of the body, `y = c + R^T (x - c - d)`, where the
    surface rests; tractions, normals, axes and `dt/dx = R (dt'/dy) R^T` are turned back. A history
    in components of the surface is the same in both frames, so a motion of body and slave points
    as one rigid body changes nothing.

    Args:
        interface: The interface on the surface where it was drawn.
        body: The body it moves with.

    Example:
        >>> from anisocontact import Adhesion, Friction, Interface, NormalLaw, make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> laws = Adhesion(stiffness=(5.0, 5.0)), Friction(coefficients=(0.3, 0.3))
        >>> face = Interface(plane, NormalLaw(penalty=10.0), *laws)
        >>> die = RigidBody("die", (0, 0, 0))
        >>> state = face.initial_state([[0.0, 0.0, 0.0]])
        >>> die.move(z=0.1)
        >>> MovingInterface(face, die).update(state, np.zeros((1, 3)), 1.0).traction.tolist()
        [[0.0, 0.0, 1.0]]
    """

    def __init__(self, interface: Interface, body: RigidBody) -> None:
        self._interface = interface
        self._body = body

    def update(
        self, state: State, x: Floats, dt: float, slave: SlaveSurface | None = None
    ) -> Response:
        """Tractions at positions in space, with the body at its trial.

        Args:
            state: Committed state, (n,).
            x: Slave points in space, (n, 3), length.
            dt: Time increment.
            slave: The slave's surface, where it carries directions.

        Returns:
            Tractions, tangent and axes in space, trial state.
        """
        body, turn = self._body, self._body.trial.rotation
        y = body.to_body(x)
        seen = None if slave is None else replace(slave, tangents=slave.tangents @ turn)
        answer = self._interface.update(state, y, dt, slave=seen)
        return replace(
            answer,
            traction=body.to_space(answer.traction),
            tangent=turn @ answer.tangent @ turn.T,
            tangent_slave=turn @ answer.tangent_slave @ turn.T,
            tangent_slip=turn @ answer.tangent_slip @ turn.T,
            normal=body.to_space(answer.normal),
            directions_adhesion=body.to_space(answer.directions_adhesion),
            directions_friction=body.to_space(answer.directions_friction),
        )


def motion_derivative(
    body: RigidBody, x: Floats, response: Response, slave: SlaveSurface | None = None
) -> Floats:
    """Change of the tractions with translation and turn of the body.

    `dt = D (dx - dd - w x r) + D_i (ds_i - w x s_i) + w x t` with `D = dt/dx`, `D_i` those by the
    tangents `s_i` of the slave, `r` from the reference point and `w = J d(turn)`.

    Args:
        body: The body at its trial.
        x: Slave points, (n, 3), length.
        response: What a `MovingInterface` of the body answers there.
        slave: The slave's surface, where it carries directions.

    Returns:
        dt/d(translation, turn), (n, 3, 6), stress/length and stress.

    Example:
        The plane of `MovingInterface`, with its penalty of 10:

        >>> from anisocontact import Adhesion, Friction, Interface, NormalLaw, make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> laws = Adhesion(stiffness=(5.0, 5.0)), Friction(coefficients=(0.3, 0.3))
        >>> face = Interface(plane, NormalLaw(penalty=10.0), *laws)
        >>> die = RigidBody("die", (0, 0, 0))
        >>> state, x = face.initial_state([[0.0, 0.0, 0.0]]), np.zeros((1, 3))
        >>> die.move(z=0.1)
        >>> answer = MovingInterface(face, die).update(state, x, 1.0)
        >>> motion_derivative(die, x, answer)[0, 2, 2]  # of the force along z, by z
        np.float64(10.0)
    """
    arms = skew(x - body.position)
    by_spin = response.tangent @ arms - skew(response.traction)
    if slave is not None and len(response.tangent_slave):
        by_spin += np.einsum("naij,najk->nik", response.tangent_slave, skew(slave.tangents))
    return np.concatenate([-response.tangent, by_spin @ body.trial.spin], axis=2)
