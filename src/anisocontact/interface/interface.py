"""An interface: a surface with its laws, updated in batches of slave points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import numpy.typing as npt

from anisocontact import _core
from anisocontact.base.copied_by_arguments import CopiedByArguments
from anisocontact.base.errors import InputError
from anisocontact.base.renamed import RenamedAttribute
from anisocontact.base.typed import typed
from anisocontact.interface.contact_law import VECTOR_FORMS, ContactLaw
from anisocontact.interface.python_law import PythonLaw
from anisocontact.interface.series import SeriesHistory
from anisocontact.interface.states import FAILURE, Response, SlaveSurface, State, as_state
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.surfaces import Surface, points, threads_of

#: No surface of the slave.
POINTS_ALONE = SlaveSurface(np.zeros((0, 3)), np.zeros((0, 2, 3)), np.zeros((0, 2, 3)))


@typed
class Interface(CopiedByArguments, changing="threads"):
    """A surface with the laws of its contact.

    Args:
        surface: The master.
        normal: Law of the pressure; or the whole `ContactLaw`.
        adhesion: Tangential law inside the yield ellipse, or a `PythonLaw`.
        friction: Yield ellipse and sliding rule.
        evolution: Name in `registry.evolution_forms()`: how the history enters the step.
        threads: Number of threads of a batch; all processors if left out.

    Attributes:
        law: The law of the contact.
        dtype: Type of the state of a point.
        carried: Direction fields and the bodies that carry them.

    Raises:
        InputError: Parts that do not go together, one in the place of another, or threads below 1.

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

    adhesion = RenamedAttribute("tangential.adhesion")
    friction = RenamedAttribute("tangential.friction")

    def __init__(
        self,
        surface: Surface,
        normal: NormalLaw | ContactLaw,
        adhesion: Adhesion | PythonLaw | None = None,
        friction: Friction | None = None,
        *,
        evolution: str = "transport",
        threads: int | None = None,
    ) -> None:
        law = normal
        if not isinstance(law, ContactLaw):
            law = ContactLaw(law, adhesion, friction, evolution=evolution)
        self.surface, self.law = surface, law
        self.normal, self.tangential, self.evolution = law.normal, law.tangential, law.evolution
        self.threads = threads_of(threads)
        self.dtype, self.carried = law.dtype, law.carried
        if law.evolution not in VECTOR_FORMS:
            if self.needs_slave:
                text = f"'slave' given, the evolution {law.evolution!r} takes directions of the "
                raise InputError(text + "master only", self.needs_slave)
            self.carried = tuple(replace(c, on="master") for c in self.carried)
        self.core = _core.Interface(surface.core, law.core)

    def _with(self, law: ContactLaw) -> Interface:
        return Interface(self.surface, law, threads=self.threads)

    def stiffened(self, normal: float, tangential: float = 1.0) -> Interface:
        """The interface with other penalties, see `ContactLaw.stiffened`.

        Args:
            normal: How many times as large the normal penalty is.
            tangential: How many times as large the stiffness of adhesion is, if it is a penalty.

        Returns:
            The interface; the one given is unchanged.
        """
        return self._with(self.law.stiffened(normal, tangential))

    def in_series(self, compliance: float, dt: float) -> tuple[Interface, SeriesHistory]:
        """The interface with a compliant layer behind adhesion, see `ContactLaw.in_series`.

        Args:
            compliance: Of the layer, length/stress.
            dt: Time increment, time.

        Returns:
            The interface, and what its history starts from.
        """
        law, start = self.law.in_series(compliance, dt)
        return self._with(law), start

    def slip_stiffness(self, dt: float) -> float:
        """Largest stiffness against slip in an increment of time.

        Args:
            dt: Time increment, time.

        Returns:
            The stiffness, stress/length.
        """
        return self.law.slip_stiffness(dt)

    def penalties(self) -> tuple[float, float]:
        """Normal penalty and least stiffness of adhesion, stress/length."""
        return self.law.penalties()

    @property
    def needs_slave(self) -> str:
        """Key that puts directions on the slave, which slave points alone do not have, or ""."""
        return next((f"{c.place}_on" for c in self.carried[:2] if c.on_slave), "")

    def takes_slave(self) -> bool:
        """Whether a surface of the slave would change the tractions.

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
        return as_state(r["state"], self.dtype)

    @typed
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
            dt: Time step > 0 [time]; without meaning for rate-independent laws.
            tangent: Whether dt/dx is wanted.
            slave: The slave's surface, which carries the directions that lie on it, and whose turn
                against the master turns the slip of `transport`.

        Returns:
            Tractions, tangent and trial state.

        Raises:
            InputError: Directions lie on the slave, and it has points alone; points that are not
                those of the states; a time step that is none; or arguments of other types.
        """
        x = points(x, 3, rows=len(state))
        if not 0.0 < dt < np.inf:
            raise InputError(f"{dt!r} given, must be > 0", "dt")
        if slave is None and self.needs_slave:
            raise InputError("'slave' given, but slave points alone carry none", self.needs_slave)
        own = (slave or POINTS_ALONE).arrays
        r = self.law.tangential.through(
            state,
            dt,
            lambda raw: self.core.law_input(raw, x, dt, self.threads, *own),
            lambda raw, outputs: self.core.update(raw, x, dt, tangent, self.threads, *own, outputs),
        )
        return Response(
            traction=r["traction"],
            tangent=r["tangent"],
            state=r["state"],
            normal=r["normal"],
            directions_adhesion=r["adhesion_axes"],
            directions_friction=r["friction_axes"],
            failure=r["failure"],
            tangent_slave=r["tangent_own"],
            tangent_slip=r["by_slip"],
        )
