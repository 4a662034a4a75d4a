"""Materials by a law of their points, in NumPy for all points of a body at once.

What no formula in UFL says, such as a yield condition that is solved for at every point, is
evaluated between two assemblies: a law takes the strains of all quadrature points and gives
stresses and their derivatives, which stand in the forms as values at these points.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.fenicsx import ufl
from anisocontact.base.processes import on_all
from anisocontact.bulk.at_points import AtPoints
from anisocontact.bulk.expansion import Heated
from anisocontact.bulk.hyperelastic import cauchy_stress
from anisocontact.bulk.materials import constant, small_strain
from anisocontact.bulk.strain import STRAINS, Strain
from anisocontact.bulk.volume import Volume, volume_of
from anisocontact.mesh import Model


@dataclass(frozen=True, eq=False)
class PointState:
    """Strain, internal variables and time increment at n points of a body.

    Attributes:
        strain: Strain at its end, of the kind the law names, (n, 3, 3).
        before: Internal variables at its begin by name, (n, ...).
        dt: Time increment; 0 where the stiffness at rest is asked for.
        place: Positions in the reference configuration, (n, 3), length.

    Example:
        >>> state = PointState(np.zeros((2, 3, 3)), {"damage": np.zeros(2)}, 0.1, np.zeros((2, 3)))
        >>> state.before["damage"].tolist()
        [0.0, 0.0]
    """

    strain: Floats
    before: Mapping[str, Floats]
    dt: float
    place: Floats


@dataclass(frozen=True, eq=False)
class PointResult:
    """Stress, tangent and internal variables of n points.

    Attributes:
        stress: Stress conjugate to the strain, (n, 3, 3).
        tangent: Its derivative by the strain, (n, 3, 3, 3, 3), symmetric in the last two indices.
        after: Internal variables at the end of the increment by name, (n, ...).
        stored: Energy per reference volume that is stored then, (n,), energy/volume; without it
            a run has no balance of energy.
        dissipated: What was dissipated in the increment, (n,), energy/volume; nothing if left out.

    Example:
        >>> none = PointResult(stress=np.zeros((2, 3, 3)), tangent=np.zeros((2, 3, 3, 3, 3)))
        >>> none.after, none.stored is None
        ({}, True)
    """

    stress: Floats
    tangent: Floats
    after: Mapping[str, Floats] = field(default_factory=dict)
    stored: Floats | None = None
    dissipated: Floats | None = None


class PointLaw(Protocol):
    """Protocol of a stress update at points, beside `linear = False` and `young`.

    A law that is elastic against a change of volume may have `volume(u)` of that part in UFL beside
    it, see `ElasticVolume`; one that flows `elastic_tangent`, (3, 3, 3, 3), the derivative of its
    stress without flow, see `BodyPoints.write_tangent`.

    Attributes:
        strain: Word for its strain, "small" or "logarithmic".
        history: Internal variables by name with their shape, () of a number; zero at the start.

    Example:
        `sigma = 2 G eps`, which remembers nothing:

        >>> class Shear:
        ...     linear, young, strain, history = False, 3.0, "small", {}
        ...     def update(self, state):
        ...         one = np.eye(9).reshape(3, 3, 3, 3)
        ...         tangent = np.stack([one + one.swapaxes(2, 3)] * len(state.strain))
        ...         return PointResult(stress=2.0 * state.strain, tangent=tangent)
        >>> sheared = np.zeros((1, 3, 3))
        >>> sheared[0, 0, 1] = sheared[0, 1, 0] = 0.01
        >>> Shear().update(PointState(sheared, {}, 1.0, np.zeros((1, 3)))).stress[0, 0].tolist()
        [0.0, 0.02, 0.0]
    """

    strain: str
    history: Mapping[str, tuple[int, ...]]

    def update(self, state: PointState) -> PointResult:
        """Stress, tangent, new variables and energies; must not change its argument.

        Args:
            state: Strain of n points, what they remember, time increment and place.

        Returns:
            Arrays of n points, of the shapes of `PointResult`.
        """
        ...


class ElasticVolume:
    """The part `K/2 tr(E)^2` of a law whose own stress does not depend on the change of volume.

    It has a pressure in every cell, so that cells do not lock where the material flows, or is
    nearly incompressible; see `Volume`.

    Attributes:
        strain: Word for the strain E.
        bulk: Bulk modulus K, stress.
    """

    linear = False
    strain = "small"
    bulk: float

    def volume(self, u: Any) -> Volume:
        """The change of volume, `tr(E)`.

        Args:
            u: Displacement, UFL.

        Returns:
            Bulk modulus and change of volume.
        """
        kind: Any = STRAINS[self.strain]
        return Volume(constant(u, self.bulk), kind.dilatation)


class BodyPoints(AtPoints):
    """A law of points, bound to a body and what its points have gone through.

    Args:
        law: The law.
        model: Mesh of the body.
        body: Its name.
        u: Displacement, a DOLFINx function.
        dt: Time increment, a constant of DOLFINx.
        degree: Degree of the quadrature at whose points the law is evaluated.
        heated: How gradients are seen where the body expands; as those of the mesh if left out.
        pressure: That of the cells, UFL, where the law is elastic against a change of volume.

    Attributes:
        stores: Whether the law says what it stores.
    """

    def __init__(
        self,
        law: PointLaw,
        model: Model,
        body: str,
        u: Any,
        dt: Any,
        degree: int,
        heated: Heated | None = None,
        pressure: Any = None,
    ) -> None:
        super().__init__(model, body, law.history, degree, heated)
        self._law, self._dt = law, dt
        self._elastic: Floats | None = getattr(law, "elastic_tangent", None)
        self.small_strain = small_strain(law)
        self._volume, self._pressure = volume_of(law, u), pressure
        self._gradient = self._at_points(self._ideal.seen(ufl.grad(u), u))
        self._piola, self._slope = self._zero((3, 3)), self._zero((3, 3, 3, 3))
        self._true_stress = self._at_points(self._ideal.seen(cauchy_stress(self, u), u))
        self._thermal: Any = self._thermal_expression(heated, u) if heated else None
        self._last: tuple[Strain, PointResult]
        self.evaluate()
        self.write_tangent()
        self.stores = self._last[1].stored is not None

    def _thermal_expression(self, heated: Heated, u: Any) -> Any:
        """What a stretch by temperature gives, and the volume without stress over the reference.

        What is elastic against changes of volume is not in it: pressures of cells have that.
        """
        self._energy_now = self._zero(())
        gradient = heated.seen(ufl.grad(u), u)
        given = heated.thermal_force(self._energy_now, self._piola, gradient)
        return self._at_points(ufl.as_vector([given, heated.stretch**3]))

    def piola(self, u: Any) -> Any:
        """First Piola-Kirchhoff stress at the points, (3, 3), UFL, stress."""
        if self._volume is None:
            return self._piola
        return self._piola + self._volume.stress(u, self._pressure)

    def work(self, v: Any) -> Any:
        """Virtual work of the stress of the law per reference volume, UFL."""
        return ufl.inner(self._piola, self._ideal.gradient(v))

    def slope(self, du: Any, v: Any) -> Any:
        """Derivative of `work` along a displacement, UFL."""
        i, j, k, m = ufl.indices(4)
        gradient = self._ideal.gradient
        return self._slope[i, j, k, m] * gradient(du)[k, m] * gradient(v)[i, j]

    def evaluate(self) -> None:
        """Bring the stress to where the displacement and the time increment are now."""
        gradient = self._gradient.eval(self._mesh, self._cells).reshape(-1, 3, 3)
        lost = ~np.isfinite(gradient).all(axis=(1, 2))
        strain = STRAINS[self._law.strain](np.where(lost[:, None, None], 0.0, gradient))
        strain.value[lost] = np.nan
        before = {name: self._read(variable) for name, variable in self.variables.items()}
        state = PointState(strain.value, before, float(self._dt.value), self.places)
        with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
            result = on_all(self._mesh.comm, lambda: self._law.update(state))
            self._write(self._piola, strain.piola(result.stress))
        self._last = strain, result

    def _trial_stress(self) -> Floats:
        return np.asarray(self._true_stress.eval(self._mesh, self._cells), dtype=np.float64)

    def _trial_thermal_force(self) -> Floats:
        return self._thermal_values()[:, 0]

    def _thermal_values(self) -> Floats:
        """Values of `_thermal_expression` at the last trial, (points, 2)."""
        _, result = self._last
        if result.stored is not None:
            self._write(self._energy_now, result.stored)
        return np.asarray(self._thermal.eval(self._mesh, self._cells)).reshape(-1, 2)

    def write_tangent(self, elastic_share: float = 0.0) -> None:
        """Bring the tangent to where the stress is.

        Args:
            elastic_share: Share s of the elastic tangent in `(1 - s) C + s C_e`, of a law that has
                one: what flows far from equilibrium is a thousand times softer than what has come
                to rest in the end, and a correction with C alone goes far beyond that.
        """
        strain, result = self._last
        slope = result.tangent
        if elastic_share and self._elastic is not None:
            slope = (1.0 - elastic_share) * slope + elastic_share * self._elastic
        with np.errstate(invalid="ignore", over="ignore"):
            self._write(self._slope, strain.tangent(result.stress, slope))

    def commit(self) -> None:
        """Accept the increment: the displacement and the time increment are those of its end."""
        self.evaluate()
        _, result = self._last
        self._write(self._stress, self._trial_stress())
        for name, variable in self.variables.items():
            self._write(variable, np.asarray(result.after[name]))
        if result.stored is not None:
            self._write(self.stored, result.stored)
        lost = result.dissipated
        if self._thermal is not None:
            given, volume = self._thermal_values().T
            self._write(self.thermal_force, given)
            lost = lost if lost is None else volume * lost
        if lost is not None:
            self._write(self.dissipated, self._read(self.dissipated) + lost)
