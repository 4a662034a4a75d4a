"""What changes of temperature give to bodies with a history, `int dW/dT dT`.

Temperatures stretch a body while its displacements and internal variables stay. The power of that
is the derivative of what the body stores, `dT/dt ds/dT s^2 (3 W - P : F/s)` with its stretch s and
at small strain `-dT/dt de/dT tr(sigma)`. It follows from the stress alone, which a history leaves
as it is: what it stores would change with the internal variables, too.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from anisocontact.base.compiled_forms import compiled
from anisocontact.base.fenicsx import fem
from anisocontact.bulk.at_points import AtPoints
from anisocontact.bulk.expansion import Heated
from anisocontact.bulk.materials import body_measure
from anisocontact.mesh import Model


class ThermalWork:
    """Energy that rises of temperature give to bodies with a history.

    Args:
        model: Mesh of the bodies.
        heated: Bodies that expand with their temperature, by name.
        histories: Bodies with a history, by name.
        degree: Degree of the quadrature at whose points they live.
    """

    def __init__(
        self,
        model: Model,
        heated: Mapping[str, Heated],
        histories: Mapping[str, AtPoints],
        degree: int,
    ) -> None:
        self._histories = {name: body for name, body in histories.items() if name in heated}
        self._rises: dict[str, Any] = {
            name: fem.Constant(model.mesh, 0.0) for name in self._histories
        }
        self._comm, self._form = model.mesh.comm, None
        if not self._histories:
            return
        dx, weight = body_measure(model), model.idealisation.weight(model.mesh)
        power: Any = 0
        for i, name in enumerate(model.body_names()):
            if name in self._histories:
                body, rise = heated[name], self._rises[name]
                rate = weight * body.stretch**2 * body.stretches * rise
                power += rate * self._histories[name].chosen_thermal_force * dx(i, degree=degree)
        self._form = compiled(power, self._comm)

    def __call__(self, rises: Mapping[str, float], trial: bool) -> float:
        """What rises of temperature would give if nothing else changed, force times length.

        Args:
            rises: By body, temperature.
            trial: Whether to the last trial; else to the last accepted increment, whose
                temperature the bodies have to have.
        """
        if self._form is None:
            return 0.0
        for name, body in self._histories.items():
            self._rises[name].value = rises[name]
            body.choose_thermal_force(trial)
        return float(self._comm.allreduce(fem.assemble_scalar(self._form)))
