"""State of slave points and what an interface answers to them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.base.array_types import Codes, Flags, Floats
from anisocontact.base.arrays import read_only_view
from anisocontact.base.errors import InputError

#: What could not be done at a point, by its failure code.
FAILURE = (
    "",
    "no closest point on the surface",
    "the direction field has no direction there: singular, along the normal or out of its table",
    "the sliding rule found no force, or its tangent is not finite; stiffnesses may be too far "
    "apart",
)


def _state_dtype() -> np.dtype[np.void]:
    names, formats, offsets = [], [], []
    for name, offset, count, kind in _core.state_layout():
        names.append(name)
        formats.append((kind, (count,)) if count > 1 else kind)
        offsets.append(offset)
    return np.dtype(
        {"names": names, "formats": formats, "offsets": offsets, "itemsize": _core.state_size}
    )


#: Structured type of the state of a point; an array of it is one block that can be copied whole.
STATE = _state_dtype()

State = npt.NDArray[np.void]
"""States of points, (n,) of the type `STATE`, of which every variable is a column.

Example:
    >>> from anisocontact import ContactLaw, Interface, NormalLaw
    >>> from anisocontact.surfaces import make_surface
    >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    >>> state = Interface(plane, ContactLaw(NormalLaw(penalty=1e3))).initial_state([[0, 0, 0.1]])
    >>> state["gap"].tolist(), state["status"].tolist()
    ([0.1], [0])
"""


@dataclass(frozen=True, eq=False)
class SlaveSurface:
    """The slave at n points, for directions that it carries and its turn against the master.

    Args:
        reference: Positions in the reference configuration, (n, 3) [length].
        reference_tangents: Two tangents there, (n, 2, 3) [length].
        tangents: The same material tangents now, (n, 2, 3) [length].

    Example:
        >>> flat = np.array([[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])
        >>> turned = np.array([[[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]])  # by 90 degrees about z
        >>> slave = SlaveSurface(np.zeros((1, 3)), flat, turned)
        >>> [part.shape for part in slave.arrays]
        [(1, 3), (1, 2, 3), (1, 2, 3)]
    """

    reference: Floats
    reference_tangents: Floats
    tangents: Floats

    @property
    def arrays(self) -> tuple[Floats, Floats, Floats]:
        """All of it as the core takes it."""
        a, b, c = (
            np.ascontiguousarray(v)
            for v in (self.reference, self.reference_tangents, self.tangents)
        )
        return a, b, c


@dataclass(frozen=True, eq=False)
class Response:
    """Tractions, tangent and trial state of n slave points.

    Args:
        traction: t = N n + T on the slave, (n, 3) [stress].
        tangent: dt/dx, exact and in general unsymmetric, (n, 3, 3) [stress/length]; empty where it
            was not asked for.
        state: Trial state, (n,) of `STATE`; it is committed by keeping it.
        normal: Outward normal of the master, (n, 3).
        directions_adhesion: Axes of the adhesion tensor, (n, 2, 3); zero at open points.
        directions_friction: Axes of the friction tensor, (n, 2, 3); zero at open points.
        failure: Why a point could not be updated, a code of `FAILURE`, (n,).
        tangent_slave: Change of t with the two tangents of the slave, (n, 2, 3, 3) [stress/length];
            empty where no surface of the slave was given.
        tangent_slip: Change of t with slip of a point that stays where it is, so that normal and
            axes do, and along the normal with the gap, (n, 3, 3) [stress/length]; as `tangent`.

    Example:
        >>> from anisocontact.interface import Interface
        >>> from anisocontact.laws import Adhesion, Friction, NormalLaw
        >>> from anisocontact.surfaces import make_surface
        >>> plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        >>> stick, slip = Adhesion(stiffness=(10, 10)), Friction(coefficients=(1, 1))
        >>> interface = Interface(plane, NormalLaw(penalty=1e3), stick, slip)
        >>> start = interface.initial_state([[0.0, 0.0, 0.0]])
        >>> response = interface.update(start, [[0.1, 0.0, -0.01]])
        >>> response.traction.round(9).tolist()  # T = -stiffness times slip: it sticks
        [[-1.0, 0.0, 10.0]]
    """

    traction: Floats
    tangent: Floats
    state: State
    normal: Floats
    directions_adhesion: Floats
    directions_friction: Floats
    failure: Codes
    tangent_slave: Floats = field(default_factory=lambda: np.empty((0, 2, 3, 3)))
    tangent_slip: Floats = field(default_factory=lambda: np.empty((0, 3, 3)))

    def frozen(self) -> Response:
        """The same that nobody writes into: an accepted state that a script draws is what goes on.

        Its state is that of this one, which its owner may still change.
        """
        for values in vars(self).values():
            if values is not self.state:
                values.flags.writeable = False
        return replace(self, state=read_only_view(self.state))

    @property
    def pressure(self) -> Floats:
        """N, (n,) [stress]."""
        return self.state["pressure"]

    @property
    def gap(self) -> Floats:
        """xi^3, (n,) [length]."""
        return self.state["gap"]

    @property
    def status(self) -> Codes:
        """0 open, 1 stick, 2 slip, (n,)."""
        return self.state["status"].astype(np.int8)

    @property
    def failed(self) -> Flags:
        """Whether a point could not be updated, (n,)."""
        return np.asarray(self.failure != 0)

    @property
    def traction_t(self) -> Floats:
        """Tangential traction T on the slave, (n, 3) [stress]."""
        return self.traction - self.pressure[:, None] * self.normal

    @property
    def traction_principal(self) -> Floats:
        """Components of T along the friction axes, (n, 2) [stress]."""
        return np.asarray(np.einsum("nij,nj->ni", self.directions_friction, self.traction_t))


def as_state(raw: npt.NDArray[np.uint8], dtype: np.dtype[np.void] = STATE) -> State:
    """States from rows of bytes, without a copy where they are of `STATE` alone.

    Args:
        raw: Bytes, (n, bytes of a state of `STATE`).
        dtype: Type that begins with `STATE`; what is behind it is zero.

    Returns:
        The states, (n,).

    Example:
        >>> rows = raw_state(np.zeros(3, dtype=STATE))
        >>> as_state(rows)["pressure"].tolist()
        [0.0, 0.0, 0.0]
    """
    if dtype == STATE:
        return raw.reshape(-1).view(STATE)
    whole = np.zeros(len(raw), dtype=dtype)
    whole.view(np.uint8).reshape(len(raw), dtype.itemsize)[:, : STATE.itemsize] = raw
    return whole


def raw_state(state: State) -> npt.NDArray[np.uint8]:
    """States as rows of bytes, as the core takes them.

    Args:
        state: States, (n,) of `STATE`, or of a type that begins with it.

    Returns:
        Their bytes, (n, bytes of a state).

    Raises:
        InputError: It is no array of states, one a row.

    Example:
        >>> raw_state(np.zeros(3, dtype=STATE)).shape == (3, STATE.itemsize)
        True
    """
    dtype = getattr(state, "dtype", None)
    if not isinstance(dtype, np.dtype) or state.ndim != 1 or not _begins_as_state(dtype):
        raise InputError("no states given, those that a response has are needed", "state")
    return np.ascontiguousarray(state).view(np.uint8).reshape(len(state), dtype.itemsize)


@lru_cache(maxsize=64)
def _begins_as_state(dtype: np.dtype[Any]) -> bool:
    """Whether the fields of a state are where they are in `STATE`."""
    fields, own = dict(dtype.fields or {}), dict(STATE.fields or {})
    return all(fields.get(name) == place for name, place in own.items())
