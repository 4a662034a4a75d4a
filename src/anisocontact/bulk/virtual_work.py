"""Virtual work of the stresses of bodies, and their energies, as UFL has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from anisocontact.base.fenicsx import ufl
from anisocontact.bulk.at_points import AtPoints
from anisocontact.bulk.expansion import Heated
from anisocontact.bulk.materials import Density, linear_parts
from anisocontact.bulk.point_law import BodyPoints
from anisocontact.mesh import Idealisation, Model


class Forms:
    """Virtual work of the stresses, and the energies as far as materials tell them.

    Changes of volume that materials keep apart are not in it, see `CellPressures`.

    Args:
        model: Mesh with its bodies.
        laws: Body name -> material, or what goes through its history.
        heated: Bodies that expand with their temperature, by name.
        u: Displacement.
        v: Test function.
        du: Trial function.
        dx: Measure, by the number of a body.
        full: Degree of the quadrature of stresses.

    Attributes:
        work: Linear form.
        slope: What of its derivative the work does not show: that of laws at points.
        elastic: What bodies without a history store; 0 where there are none.
        stored: What the others store.
        dissipated: What they have dissipated.
        told: Whether that is all: no material has a stress but no energy.
    """

    def __init__(
        self,
        model: Model,
        laws: Mapping[str, Any],
        heated: Mapping[str, Heated],
        u: Any,
        v: Any,
        du: Any,
        dx: Any,
        full: int,
    ) -> None:
        weight = model.idealisation.weight(model.mesh)
        work, self.elastic, self.stored, self.slope, self.dissipated = 0, 0, 0, 0, 0
        self.told = True
        for i, name in enumerate(model.body_names()):
            if name not in laws:
                continue
            law, here = laws[name], dx(i, degree=full)
            ideal = heated.get(name, model.idealisation)
            stretch = heated[name].stretch if name in heated else 1.0
            volume = weight * stretch**3
            for density, degree in _stored(ideal, law, u):
                part = volume * density * dx(i, degree=full if degree is None else degree)
                self.elastic += part
                work += ufl.derivative(part, u, v)
            if isinstance(law, BodyPoints):
                work += weight * stretch**2 * law.work(v) * here
                self.slope += weight * stretch * law.slope(du, v) * here
            elif not (law.linear or hasattr(law, "energy")):
                stress = stretch**2 * ideal.seen(law.piola(u), u)
                work += weight * ufl.inner(stress, ideal.gradient(v)) * here
                self.told &= isinstance(law, AtPoints)
            if isinstance(law, AtPoints):
                self.told &= law.stores
                self.stored += volume * law.stored * here
                self.dissipated += weight * law.dissipated * here
        self.work = work


def _stored(ideal: Idealisation, law: Any, u: Any) -> Sequence[Density]:
    """Terms of the energy of a material from which its stress follows."""
    if law.linear:
        strain = ufl.sym(ideal.seen(ufl.grad(u), u))
        parts = linear_parts(law, u)
        return [(0.5 * ufl.inner(ideal.stress(s, u), strain), degree) for s, degree in parts]
    terms = law.energy(u) if hasattr(law, "energy") else []
    return [(ideal.seen(density, u), degree) for density, degree in terms]
