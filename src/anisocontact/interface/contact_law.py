"""The law of a contact: a normal law and a tangential one, of the core or written in Python."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, Literal, TypedDict

import numpy as np

from anisocontact import _core
from anisocontact.base import registry
from anisocontact.base.array_types import Codes, Flags, Floats, Locals
from anisocontact.base.copied_by_arguments import CopiedByArguments
from anisocontact.base.errors import InputError
from anisocontact.base.typed import typed
from anisocontact.interface import series
from anisocontact.interface.python_law import Look, PythonLaw, Update
from anisocontact.interface.series import SeriesHistory
from anisocontact.interface.states import STATE, State, as_state, raw_state
from anisocontact.laws import (
    Adhesion,
    CarriedDirections,
    Friction,
    Named,
    NormalLaw,
    carried_directions,
)

#: Forms of evolution whose history is turned as vectors: those that meshed masters, directions on
#: the slave and multipliers can have.
VECTOR_FORMS = ("transport", "backward-euler")
#: What the core gives of slave points on facets, see `FacetLaw.evaluate`.
type CoreCall = Literal["update", "assemble", "tractions"]
#: How many stiffer laws a law keeps.
_KEPT = 4


@typed
class AdhesionAndFriction(CopiedByArguments):
    """The tangential law of the core.

    Args:
        adhesion: Law inside the yield ellipse.
        friction: Yield ellipse and sliding rule.

    Attributes:
        in_python: Whether the law is written in Python.
        dtype: Type of the state of a point.
        carried: Direction fields and the bodies that carry them.
        model: Name of the adhesion model.
        sliding_rule: Name of the rule.
        friction_directions: Directions of friction, if it has any.

    Example:
        >>> law = AdhesionAndFriction(Adhesion(stiffness=9.0), Friction(coefficients=0.3))
        >>> law.model, law.sliding_rule, law.in_python
        ('elastic', 'maximum-dissipation', False)
    """

    in_python = False
    dtype = STATE

    def __init__(self, adhesion: Adhesion | None, friction: Friction | None) -> None:
        _check_kind("adhesion", adhesion, Adhesion)
        _check_kind("friction", friction, Friction)
        assert adhesion is not None and friction is not None
        self.adhesion, self.friction = adhesion, friction
        self.carried: tuple[CarriedDirections, ...] = carried_directions(adhesion, friction)
        self.model, self.sliding_rule = adhesion.named[0], friction.rule[0]
        self.friction_directions = friction.directions

    def core(self, normal: NormalLaw, evolution: str) -> _core.Law:
        """The law as the core has it.

        Args:
            normal: Law of the pressure.
            evolution: Name of the form of evolution.

        Returns:
            The law of the core.

        Raises:
            InputError: Values that do not go together.
        """
        fields = (c.field.core if c.field else None for c in self.carried)
        adhesion_field, friction_field, second = fields
        return _made(
            _core.Law,
            normal.named,
            self.adhesion.named,
            adhesion_field,
            self.friction.named,
            friction_field,
            second,
            self.friction.rule,
            evolution,
            [one.on_slave for one in self.carried],
        )

    def check_evolution(self, evolution: str) -> None:
        """Refuse a form of evolution that does not go with adhesion.

        Args:
            evolution: Name of the form.

        Raises:
            InputError: It is `total` with another adhesion than an elastic one.
        """
        if evolution == "total" and self.model != "elastic":
            text = f"'total' needs the adhesion model 'elastic', {self.model!r} given"
            raise InputError(text, field="evolution")

    def named(self) -> dict[str, Named]:
        """Names and values of the parts."""
        return {
            "adhesion": self.adhesion.named,
            "friction": self.friction.named,
            "sliding_rule": self.friction.rule,
        }

    def stiffened(self, times: float) -> AdhesionAndFriction:
        """The law with a stiffer adhesion, if its stiffness is a penalty.

        Args:
            times: How many times as large the stiffness is.

        Returns:
            The law; the one given is unchanged.
        """
        adhesion = self.adhesion if times == 1.0 else self.adhesion.stiffened(times)
        return AdhesionAndFriction(adhesion, self.friction)

    def in_series(self, compliance: float, dt: float) -> tuple[AdhesionAndFriction, SeriesHistory]:
        """The law with a compliant layer behind adhesion, see `anisocontact.interface.series`.

        Args:
            compliance: Of the layer, length/stress.
            dt: Time increment, time.

        Returns:
            The law, and what its history starts from.
        """
        adhesion, start = series.in_series(self.adhesion, compliance, dt)
        return AdhesionAndFriction(adhesion, self.friction), start

    def slip_stiffness(self, dt: float) -> float:
        """Largest stiffness of adhesion against slip in an increment of time.

        Args:
            dt: Time increment, time.

        Returns:
            The stiffness, stress/length; 0 where a force can be along the slip.
        """
        return series.slip_stiffness(self.adhesion, dt)

    def penalty(self) -> float:
        """Least stiffness of adhesion along the axes along which it has one, stress/length."""
        return min(one for one in self._stiffness(1.0) if one > 0.0)

    def softness(self) -> Floats:
        """Least stiffness of adhesion over that along each of its axes, (2,); 1 where it has none.

        Multipliers, which ask for it, have adhesion along both axes: see `holds_all_ways`.
        """
        stiffness = np.array(self._stiffness(1.0))
        return np.asarray(self.penalty() / np.where(stiffness > 0.0, stiffness, self.penalty()))

    def holds_all_ways(self) -> bool:
        """Whether there is adhesion along both axes."""
        return min(self._stiffness(1.0)) > 0.0

    def stiffest(self) -> float:
        """Largest stiffness of adhesion, stress/length; 0 where it has none."""
        return max(self._stiffness(0.0))

    def _stiffness(self, none: float) -> Sequence[float]:
        """Stiffness of adhesion along its axes, or what stands for it in laws without one."""
        return self.adhesion.named[1].get("stiffness", [none])

    def doubts(self) -> str:
        """Nothing: the derivatives of the core are exact."""
        return ""

    def through(self, state: State, dt: float, look: Look, update: Update) -> dict[str, Any]:
        """What the core finds for a batch; arguments as of `PythonLaw.through`."""
        found = update(raw_state(state), None)
        return found | {"state": as_state(found["state"])}


@typed
class ContactLaw(CopiedByArguments):
    """The law of a contact, on an analytic, a moving or a meshed master.

    Args:
        normal: Law of the pressure.
        adhesion: Tangential law inside the yield ellipse; or a `PythonLaw`, which is adhesion and
            friction in one.
        friction: Yield ellipse and sliding rule.
        evolution: Name in `registry.evolution_forms()`: how the history enters the step.

    Attributes:
        dtype: Type of the state of a point.
        carried: Direction fields and the bodies that carry them.
        core: The law of the core.

    Raises:
        InputError: Parts that do not go together, or one in the place of another.

    Example:
        >>> adhesion, friction = Adhesion(stiffness=(1e5, 1e5)), Friction(coefficients=(0.3, 0.3))
        >>> law = ContactLaw(NormalLaw(penalty=1e5), adhesion, friction)
        >>> law.stiffened(10.0).penalties()
        (1000000.0, 100000.0)
    """

    def __init__(
        self,
        normal: NormalLaw,
        adhesion: Adhesion | AdhesionAndFriction | PythonLaw | None,
        friction: Friction | None = None,
        *,
        evolution: str = "transport",
    ) -> None:
        registry.entry(registry.evolution_forms(), evolution, "evolution")
        if isinstance(adhesion, AdhesionAndFriction | PythonLaw):
            self.tangential = adhesion
        else:
            self.tangential = AdhesionAndFriction(adhesion, friction)
        self.tangential.check_evolution(evolution)
        self.normal, self.evolution = normal, evolution
        self._stiffer: dict[tuple[float, float], ContactLaw] = {}  # see `stiffened`
        self.dtype, self.carried = self.tangential.dtype, self.tangential.carried
        self.core = self.tangential.core(normal, evolution)

    def on_facets(self) -> FacetLaw:
        """The law for slave points and facets.

        Returns:
            What is evaluated for them.

        Raises:
            InputError: As of `check_meshed`.
        """
        self.check_meshed()
        return FacetLaw(self)

    def check_meshed(self) -> None:
        """Check that facets of a mesh can be the master.

        Raises:
            InputError: A direction field that goes by coordinates of a surface, or a form of
                evolution that meshed masters do not have.
        """
        if self.evolution not in VECTOR_FORMS:
            allowed = " and ".join(f'"{name}"' for name in VECTOR_FORMS)
            text = f'"{self.evolution}" given, a meshed master has {allowed} only'
            raise InputError(text, "evolution")
        for one in self.carried:
            one.check_meshed("master")
            one.check_meshed("slave")

    def stiffened(self, normal: float, tangential: float = 1.0) -> ContactLaw:
        """The law with other penalties.

        Args:
            normal: How many times as large the normal penalty is.
            tangential: How many times as large the stiffness of adhesion is, if it is a penalty.

        Returns:
            The law; the one given is unchanged.
        """
        factors = normal, tangential
        if factors not in self._stiffer:  # trials ask for the same again and again
            stiffer = self.normal.stiffened(normal), self.tangential.stiffened(tangential)
            if len(self._stiffer) == _KEPT:
                self._stiffer.clear()
            self._stiffer[factors] = ContactLaw(*stiffer, evolution=self.evolution)
        return self._stiffer[factors]

    def in_series(self, compliance: float, dt: float) -> tuple[ContactLaw, SeriesHistory]:
        """The law with a compliant layer behind its tangential part.

        Args:
            compliance: Of the layer, length/stress.
            dt: Time increment.

        Returns:
            The law, and what its history starts from.
        """
        tangential, start = self.tangential.in_series(compliance, dt)
        return ContactLaw(self.normal, tangential, evolution=self.evolution), start

    def slip_stiffness(self, dt: float) -> float:
        """Largest stiffness against slip in an increment of time.

        Args:
            dt: Time increment, time.

        Returns:
            The stiffness, stress/length.
        """
        return self.tangential.slip_stiffness(dt)

    def penalties(self) -> tuple[float, float]:
        """Normal penalty and least stiffness of adhesion, stress/length; 1 where it has none.

        The penalty is 0 of a normal law that has another parameter in its place.
        """
        return self.normal.named[1].get("penalty", (0.0,))[0], self.tangential.penalty()


class FacetBatch(TypedDict):
    """Slave points that meet facets as the core takes them, with its names."""

    slave_nodes: Locals
    slave_shape: Floats
    slave_gradient: Floats
    weight: Floats
    current_area: bool
    now: Floats
    reference: Floats
    connectivity: Locals
    topology: Codes
    flip: Flags
    facet: Locals
    xi: Floats
    feature: Codes
    edge: Floats
    held: Floats
    near: Flags
    tangent: bool
    threads: int


class FacetLaw:
    """A contact law for slave points that meet facets of a mesh.

    Attributes:
        in_python: Whether its tangential part is written in Python.
    """

    def __init__(self, law: ContactLaw) -> None:
        self._tangential, self.in_python = law.tangential, law.tangential.in_python
        self.core = _core.FacetInterface(law.core)

    def evaluate(self, state: State, of: CoreCall, dt: float, batch: FacetBatch) -> dict[str, Any]:
        """Forces, blocks and the trial state.

        Args:
            state: Committed state, (n,).
            of: What is wanted of the points: forces, with a block for each of them or one for those
                of a pair of facets, or derivatives of tractions.
            dt: Time increment.
            batch: The points and facets.

        Returns:
            As of the core; the state has the law's own variables.

        Raises:
            InputError: A law in Python failed, or returned arrays that cannot be.
        """
        update = getattr(self.core, of)
        return self._tangential.through(
            state,
            dt,
            lambda raw: self.core.law_input(raw, dt, **batch),
            lambda raw, outputs: update(raw, dt, **batch, outputs=outputs),
        )


def _check_kind(name: str, given: object, needed: type) -> None:
    """Refuse an argument that is something else.

    Raises:
        InputError: It is.
    """
    if not isinstance(given, needed):
        raise InputError(f"{type(given).__name__} given, {needed.__name__} needed", name)


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
