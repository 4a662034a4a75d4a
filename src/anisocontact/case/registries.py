"""Everything that can be named in a case file."""

from __future__ import annotations

from dataclasses import dataclass, replace

from anisocontact.base import registry
from anisocontact.base.amplitudes import amplitudes
from anisocontact.base.machine import out_of_memory
from anisocontact.base.paths import paths
from anisocontact.base.registry import Entry
from anisocontact.base.strategies import strategies
from anisocontact.case.amplitudes import PYTHON
from anisocontact.case.python_section import MATERIAL
from anisocontact.results.quantities import CONTACT, FILES, RIGID, quantities


@dataclass(frozen=True)
class Registries:
    """Everything that can be named in a case file."""

    surfaces: tuple[Entry, ...]
    direction_fields: tuple[Entry, ...]
    normal_laws: tuple[Entry, ...]
    adhesion_models: tuple[Entry, ...]
    friction_models: tuple[Entry, ...]
    sliding_rules: tuple[Entry, ...]
    evolution_forms: tuple[Entry, ...]
    materials: tuple[Entry, ...]
    shapes: tuple[Entry, ...] = ()
    group_selectors: tuple[Entry, ...] = ()
    output_quantities: tuple[Entry, ...] = ()
    amplitudes: tuple[Entry, ...] = ()
    paths: tuple[Entry, ...] = ()
    strategies: tuple[Entry, ...] = ()
    idealisations: tuple[Entry, ...] = ()

    @classmethod
    def current(cls) -> Registries:
        """What is registered now."""
        materials, shapes, selectors, idealisations = _of_bodies()
        written = tuple(
            Entry(q.name, q.at, f"{q.doc} [{q.unit}]; at a {q.at}, {FILES[q.at]}", ())
            for q in quantities()
        )
        return replace(
            cls.of_points(),
            materials=materials,
            shapes=shapes,
            group_selectors=selectors,
            output_quantities=written,
            amplitudes=(*amplitudes(), PYTHON),
            paths=paths(),
            strategies=strategies(),
            idealisations=idealisations,
        )

    @property
    def arrays(self) -> list[str]:
        """Names of the quantities of the files for ParaView."""
        numbers = (CONTACT, RIGID)
        return list(dict.fromkeys(q.name for q in self.output_quantities if q.kind not in numbers))

    @classmethod
    def of_points(cls) -> Registries:
        """What is registered now, without materials and shapes of bodies."""
        return cls(
            registry.surfaces(),
            registry.direction_fields(),
            registry.normal_laws(),
            registry.adhesion_models(),
            registry.friction_models(),
            registry.sliding_rules(),
            registry.evolution_forms(),
            (),
        )


def _of_bodies() -> tuple[tuple[Entry, ...], ...]:
    """Materials, shapes, selectors of groups, idealisations; none without finite elements."""
    try:
        from anisocontact.bulk import materials
        from anisocontact.mesh import idealisations, selectors, shapes
    except ImportError as missing:
        if out_of_memory(missing) or (missing.name or "").startswith("anisocontact"):
            raise  # they are there
        return (), (), (), ()
    return (*materials(), MATERIAL), shapes(), selectors(), idealisations()
