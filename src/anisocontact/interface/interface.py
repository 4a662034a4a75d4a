"""An interface: a surface with its laws, updated in batches of slave points."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.interface import series
from anisocontact.interface.series import History
from anisocontact.interface.states import (
    FAILURE,
    STATE,
    STATUS,
    Response,
    SlaveSurface,
    State,
    as_state,
    raw_state,
)
from anisocontact.laws import Adhesion, Carried, Friction, NormalLaw, carried
from anisocontact.surfaces import Surface, default_threads, points

__all__ = [
    "FAILURE",
    "STATE",
    "STATUS",
    "Interface",
    "PairLaw",
    "Response",
    "SlaveSurface",
    "State",
    "as_state",
    "raw_state",
]

#: Forms of evolution whose history is turned as vectors: those that meshed masters, directions on
#: the slave and multipliers can have.
VECTOR_FORMS = ("transport", "backward-euler")

#: No surface of the slave.
POINTS_ALONE = SlaveSurface(np.zeros((0, 3)), np.zeros((0, 2, 3)), np.zeros((0, 2, 3)))


class PairLaw:
    """Laws of the contact of two meshed bodies: what an `Interface` is without its surface.

    Args:
        normal: Law of the pressure.
        adhesion: Tangential law inside the yield ellipse.
        friction: Yield ellipse and sliding rule.
        evolution: How the history enters the step, one of `VECTOR_FORMS`.

    Attributes:
        dtype: Type of the state of a point.
        carried: Direction fields and the bodies that carry them.

    Raises:
        InputError: A direction field that goes by coordinates of a surface, a law in the place of
            another one, or a form of evolution that meshed masters do not have.

    Example:
        >>> adhesion, friction = Adhesion(stiffness=(1e5, 1e5)), Friction(coefficients=(0.3, 0.3))
        >>> law = PairLaw(NormalLaw(penalty=1e5), adhesion, friction)
        >>> law.stiffened(10.0).penalties()
        (1000000.0, 100000.0)
    """

    def __init__(
        self,
        normal: NormalLaw,
        adhesion: Adhesion,
        friction: Friction,
        *,
        evolution: str = "transport",
    ) -> None:
        _check_laws(normal, adhesion, friction)
        _check_evolution(evolution, adhesion)
        if evolution not in VECTOR_FORMS:
            allowed = " and ".join(f'"{name}"' for name in VECTOR_FORMS)
            raise InputError(
                f'"{evolution}" given, a meshed master has {allowed} only', "evolution"
            )
        self.evolution = evolution
        self.normal, self.adhesion, self.friction = normal, adhesion, friction
        self.dtype = STATE
        self.carried = carried(adhesion, friction)
        for one in self.carried:
            one.check_meshed("master")
            one.check_meshed("slave")

    def pairs(self, mirrored: bool = False) -> _core.FacetPairs:
        """The law as the core takes it for slave points and facets.

        Args:
            mirrored: Whether slave and master have swapped their parts: the master of the core
                carries what is the slave's, and angles count about the normal of the core's slave.

        Returns:
            The law of the core.
        """
        second = self.friction.directions_second
        return _made(
            _core.FacetPairs,
            self.normal.named,
            self.adhesion.named,
            self.adhesion.directions.core if self.adhesion.directions else None,
            self.friction.named,
            self.friction.directions.core if self.friction.directions else None,
            second.core if second else None,
            self.friction.rule,
            self.evolution,
            mirrored,
            [one.on_slave != (mirrored and one.field is not None) for one in self.carried],
        )

    def stiffened(self, normal: float, tangential: float = 1.0) -> PairLaw:
        """The laws with other penalties.

        Args:
            normal: How many times as large the normal penalty is.
            tangential: How many times as large the stiffness of adhesion is, if it is a penalty.

        Returns:
            The laws; those given are unchanged.
        """
        return PairLaw(*_stiffened(self, normal, tangential), evolution=self.evolution)

    def in_series(self, compliance: float, dt: float) -> tuple[PairLaw, History]:
        """The laws with a compliant layer behind adhesion, see `series.in_series`."""
        adhesion, start = series.in_series(self.adhesion, compliance, dt)
        return PairLaw(self.normal, adhesion, self.friction, evolution=self.evolution), start

    def slip_stiffness(self, dt: float) -> float:
        """Largest stiffness of adhesion against slip in an increment of time, stress/length."""
        return series.slip_stiffness(self.adhesion, dt)

    def penalties(self) -> tuple[float, float]:
        """Normal penalty and least stiffness of adhesion, stress/length."""
        return _penalties(self)


class Interface:
    """A surface with the laws of its contact.

    Args:
        surface: The master.
        normal: Law of the pressure.
        adhesion: Tangential law inside the yield ellipse.
        friction: Yield ellipse and sliding rule.
        evolution: Name in `registry.evolution_forms()`: how the history enters the step.
        threads: Number of threads of a batch; all processors if left out.

    Raises:
        InputError: Parts that do not go together, or one in the place of another.

    Example:
        >>> from anisocontact.surfaces import make_surface
        >>> from anisocontact.anisotropy import make_directions
        >>> marks = make_directions("constant", vector=(1, 0, 0))
        >>> interface = Interface(
        ...     make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)),
        ...     NormalLaw(penalty=1e5),
        ...     Adhesion(stiffness=(2e5, 5e4), directions=marks),
        ...     Friction(coefficients=(0.3, 0.1), directions=marks),
        ... )
        >>> state = interface.initial_state([[0.0, 0.0, 0.0]])
        >>> interface.update(state, [[1e-3, 0.0, -1e-4]]).traction.round(9).tolist()
        [[-3.0, 0.0, 10.0]]
    """

    def __init__(
        self,
        surface: Surface,
        normal: NormalLaw,
        adhesion: Adhesion,
        friction: Friction,
        *,
        evolution: str = "transport",
        threads: int | None = None,
    ) -> None:
        _check_kind("surface", surface, Surface)
        _check_laws(normal, adhesion, friction)
        _check_evolution(evolution, adhesion)
        self.evolution, self.surface = evolution, surface
        self.normal, self.adhesion, self.friction = normal, adhesion, friction
        self.threads = threads or default_threads()
        self.carried: tuple[Carried, ...] = carried(adhesion, friction)
        if evolution not in VECTOR_FORMS and self.needs_slave:
            raise InputError(
                f"'slave' given, the evolution {evolution!r} takes directions of the master only",
                self.needs_slave,
            )
        if evolution not in VECTOR_FORMS:
            self.carried = tuple(replace(c, on="master") for c in self.carried)
        self.core = _made(
            _core.Interface,
            surface.core,
            normal.named,
            adhesion.named,
            adhesion.directions.core if adhesion.directions else None,
            friction.named,
            friction.directions.core if friction.directions else None,
            friction.directions_second.core if friction.directions_second else None,
            friction.rule,
            evolution,
            [one.on_slave for one in self.carried],
        )

    def stiffened(self, normal: float, tangential: float = 1.0) -> Interface:
        """The interface with other penalties.

        Args:
            normal: How many times as large the normal penalty is.
            tangential: How many times as large the stiffness of adhesion is, if it is a penalty.

        Returns:
            The interface; the one given is unchanged.
        """
        return Interface(
            self.surface,
            *_stiffened(self, normal, tangential),
            evolution=self.evolution,
            threads=self.threads,
        )

    def in_series(self, compliance: float, dt: float) -> tuple[Interface, History]:
        """The interface with a compliant layer behind adhesion, see `PairLaw.in_series`."""
        adhesion, start = series.in_series(self.adhesion, compliance, dt)
        made = Interface(
            self.surface,
            self.normal,
            adhesion,
            self.friction,
            evolution=self.evolution,
            threads=self.threads,
        )
        return made, start

    def slip_stiffness(self, dt: float) -> float:
        """Largest stiffness of adhesion against slip in an increment of time, stress/length."""
        return series.slip_stiffness(self.adhesion, dt)

    def penalties(self) -> tuple[float, float]:
        """Normal penalty and least stiffness of adhesion, stress/length.

        Returns:
            The two stiffnesses.
        """
        return _penalties(self)

    @property
    def needs_slave(self) -> str:
        """Key that puts directions on the slave, which slave points alone do not have, or ""."""
        return next((f"{c.place}_on" for c in self.carried[:2] if c.on_slave), "")

    def takes_slave(self) -> bool:
        """Whether a surface of the slave would change what is answered.

        It carries directions, and its turn against the master turns the slip of `transport`.

        Raises:
            InputError: It carries directions, and one goes by coordinates of a surface.
        """
        for one in self.carried:
            one.check_meshed("slave")
        return self.evolution == "transport" or any(c.on_slave for c in self.carried)

    def initial_state(self, x: npt.ArrayLike) -> State:
        """State before the first step: projected and free of force.

        Args:
            x: Slave points, (n, 3) [length].

        Returns:
            The state of every point, (n,) of `STATE` [Konyukhov Schweizerhof 2006, eq. (101)].

        Raises:
            InputError: A point has no closest point on the surface.
        """
        x = points(x, 3)
        r = self.core.initial_state(x)
        failed = np.flatnonzero(r["failure"])
        if failed.size:
            raise InputError(f"{FAILURE[1]} for the point {x[failed[0]].tolist()}", field="x")
        return as_state(r["state"])

    def update(
        self,
        state: State,
        x: npt.ArrayLike,
        dt: float = 1.0,
        *,
        tangent: bool = True,
        slave: SlaveSurface | None = None,
    ) -> Response:
        """Tractions at new positions; the committed state is not changed.

        Args:
            state: Committed state, (n,) of `STATE`.
            x: Slave points, (n, 3) [length].
            dt: Time step [time]; without meaning for rate-independent laws.
            tangent: Whether dt/dx is wanted.
            slave: The slave's surface, which carries the directions that lie on it, and whose turn
                against the master turns the slip of `transport`.

        Returns:
            Tractions, tangent and trial state.

        Raises:
            InputError: Directions lie on the slave, and it has points alone; or points that are
                not those of the states.
        """
        x = points(x, 3, rows=len(state))
        if slave is None and self.needs_slave:
            raise InputError("'slave' given, but slave points alone carry none", self.needs_slave)
        own = (slave or POINTS_ALONE).arrays
        r = self.core.update(raw_state(state), x, dt, tangent, self.threads, *own)
        return Response(
            traction=r["traction"],
            tangent=r["tangent"],
            state=as_state(r["state"]),
            normal=r["normal"],
            directions_adhesion=r["adhesion_axes"],
            directions_friction=r["friction_axes"],
            failure=r["failure"],
            tangent_slave=r["tangent_own"],
        )


def _check_kind(name: str, given: object, needed: type) -> None:
    if not isinstance(given, needed):
        raise InputError(f"{type(given).__name__} given, {needed.__name__} needed", name)


def _check_laws(normal: object, adhesion: object, friction: object) -> None:
    """Refuse laws that stand in the place of another one."""
    _check_kind("normal", normal, NormalLaw)
    _check_kind("adhesion", adhesion, Adhesion)
    _check_kind("friction", friction, Friction)


def _check_evolution(evolution: str, adhesion: Adhesion) -> None:
    """Refuse a form of evolution that there is not, or not with the adhesion."""
    registry.entry(registry.evolution_forms(), evolution, "evolution")
    if evolution == "total" and adhesion.named[0] != "elastic":
        text = f"'total' needs the adhesion model 'elastic', {adhesion.named[0]!r} given"
        raise InputError(text, field="evolution")


def _stiffened(
    of: PairLaw | Interface, normal: float, tangential: float
) -> tuple[NormalLaw, Adhesion, Friction]:
    adhesion = of.adhesion if tangential == 1.0 else of.adhesion.stiffened(tangential)
    return of.normal.stiffened(normal), adhesion, of.friction


def _penalties(of: PairLaw | Interface) -> tuple[float, float]:
    normal, tangential = of.normal.named[1]["penalty"], of.adhesion.named[1].get("stiffness", [1.0])
    return normal[0], min(tangential)


def _made[T](kind: Callable[..., T], *arguments: object) -> T:
    """An object of the core; what it says of its arguments as a mistake of the user.

    Raises:
        InputError: The values of a law do not go together.
    """
    try:
        return kind(*arguments)
    except ValueError as error:
        name, _, line = str(error).partition(": ")
        # The values of an adhesion model are judged where it is made, in the core.
        if any(name in named[1] for named in arguments if isinstance(named, tuple)):
            raise InputError(line, field=f"adhesion.{name}") from None
        raise InputError(str(error)) from None
