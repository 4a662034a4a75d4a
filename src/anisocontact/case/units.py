"""The table `[units]`: what the numbers of a case are in, and whether they make sense together."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated

from anisocontact.base.errors import InputError
from anisocontact.case.quantity import word
from anisocontact.case.section import Section

#: Unit -> how many of the SI unit it is.
LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "nm": 1e-9, "in": 0.0254, "ft": 0.3048}
FORCES = {"N": 1.0, "kN": 1e3, "MN": 1e6, "mN": 1e-3, "uN": 1e-6, "lbf": 4.4482216152605}
STRESSES = {
    **{"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "N/mm^2": 1e6},
    **{"psi": 6894.757293168361, "ksi": 6894757.293168361},
}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0}
#: Systems that a case without the table may be written in: length, force.
SYSTEMS = (("m", "N"), ("mm", "N"), ("um", "uN"), ("in", "lbf"), ("cm", "N"), ("m", "kN"))
#: SI values from one to the other: gel to diamond, gas to osmium, a grain to a bridge, an asteroid
#: to a centrifuge.
YOUNG, DENSITY, SIZE, GRAVITY = (1e2, 1.5e12), (0.05, 2.5e4), (1e-7, 1e4), (0.02, 5e3)


class Units(Section):
    """Units in which the numbers are written; they label tables and pictures and are checked.

    Nothing is converted: numbers have to be consistent, and stress is force over length squared.
    """

    length: Annotated[str | None, word("unit of lengths", *LENGTHS)] = None
    force: Annotated[str | None, word("unit of forces", *FORCES)] = None
    stress: Annotated[str | None, word("unit of stresses", *STRESSES)] = None
    time: Annotated[str | None, word("unit of times", *TIMES)] = None

    def labels(self) -> dict[str, str]:
        """Dimension -> unit, of those that are known."""
        given = {name: unit for name, unit in self if unit is not None}
        if self.length and self.force and not self.stress:
            size = FORCES[self.force] / LENGTHS[self.length] ** 2
            named = (unit for unit, factor in STRESSES.items() if math.isclose(factor, size))
            given["stress"] = next(named, f"{self.force}/{self.length}^2")
        if self.length and self.stress and not self.force:
            size = STRESSES[self.stress] * LENGTHS[self.length] ** 2
            named = (unit for unit, factor in FORCES.items() if math.isclose(factor, size))
            given["force"] = next(named, f"{self.stress} {self.length}^2")
        return given

    def system(self) -> tuple[float, float, float] | None:
        """Length, force and time in SI units, where the first two are known; else seconds."""
        if not self.length:
            return None
        length, time = LENGTHS[self.length], TIMES[self.time or "s"]
        if self.force:
            return length, FORCES[self.force], time
        return (length, STRESSES[self.stress] * length**2, time) if self.stress else None


def check_units(units: Units) -> Iterator[InputError]:
    """Refuse units that are not consistent."""
    if units.length and units.force and units.stress:
        size = FORCES[units.force] / LENGTHS[units.length] ** 2
        if not math.isclose(size, STRESSES[units.stress], rel_tol=1e-6):
            needed = Units(length=units.length, force=units.force).labels()["stress"]
            text = f'"{units.stress}" given, {units.force} and {units.length} make {needed}'
            yield InputError(text, "units.stress")


def doubts(
    units: Units,
    young: Mapping[str, float],
    densities: Sequence[float],
    size: float,
    gravity: Sequence[float] = (),
) -> list[str]:
    """What is hardly meant, a line each.

    Args:
        units: The table.
        young: Young's modulus by body, stress.
        densities: Densities, mass over volume.
        size: Longest side of the bodies, length.
        gravity: Accelerations that give bodies their weight, length over time squared.

    Returns:
        Lines; nothing where the numbers make sense in the units given or, without units, in some
        usual system.

    Example:
        >>> doubts(Units(length="mm", force="N"), {"block": 210e9}, [], 100.0)
        ['units: E of block is 2.1e+17 Pa in mm and N; 100 to 1.5e+12 Pa are usual']
    """
    values = young, densities, size, gravity
    given = units.system()
    if given is not None:
        return [f"units: {text}" for text in _odd(given, _name(units), *values)]
    for length, force in SYSTEMS:
        if not _odd((LENGTHS[length], FORCES[force], 1.0), "", *values):
            return []
    parts = ["Young's moduli", "densities", *(["gravity"] if gravity else []), "the size"]
    return [
        f"units: {', '.join(parts[:-1])} and {parts[-1]} of the bodies do not fit together in m "
        "and N, mm and N or other usual units; [units] says what they are in"
    ]


def _name(units: Units) -> str:
    names = [units.length, units.force or units.stress, *([units.time] if units.time else [])]
    return f"{', '.join(map(str, names[:-1]))} and {names[-1]}"


def _odd(
    system: tuple[float, float, float],
    name: str,
    young: Mapping[str, float],
    densities: Sequence[float],
    size: float,
    gravity: Sequence[float],
) -> list[str]:
    """Values out of the usual range, where units of length, force and time have these sizes."""
    length, force, time = system
    mass = force * time**2 / length
    values = [
        *((f"E of {body}", e * force / length**2, "Pa", YOUNG) for body, e in young.items()),
        *(("a density", rho * mass / length**3, "kg/m^3", DENSITY) for rho in densities),
        ("the size of the bodies", size * length, "m", SIZE),
        *(("gravity", g * length / time**2, "m/s^2", GRAVITY) for g in gravity),
    ]
    return [
        f"{what} is {value:.3g} {unit} in {name}; {low:g} to {high:.3g} {unit} are usual"
        for what, value, unit, (low, high) in values
        if not low <= value <= high
    ]
