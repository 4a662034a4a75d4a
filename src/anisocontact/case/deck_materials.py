"""Materials of a deck as tables of a case file, and the temperatures of bodies."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.base.errors import InputError
from anisocontact.mesh.deck import Card, real
from anisocontact.mesh.deck_contents import Deck
from anisocontact.mesh.deck_supports import key_of
from anisocontact.mesh.inp import bodies_of, plain
from anisocontact.mesh.placement import Rotation

#: Kind of `*ELASTIC` -> how many of its numbers are at one temperature.
_SIZES = {"ISOTROPIC": 2, "ISO": 2, "ORTHO": 9, "ORTHOTROPIC": 9, "ENGINEERINGCONSTANTS": 9}
#: Kind of `*HYPERELASTIC` -> how many constants it has; none where N says it.
_RUBBERS = {"NEOHOOKE": 1, "MOONEY-RIVLIN": 2, "YEOH": 3, "OGDEN": 0}
#: Keys of a material that yields.
_YIELDS = ("flow_curve", "yield_stress", "kinematic")
#: Share of the range of temperatures that a body may differ by and count as uniform.
UNIFORM = 1e-9


class Materials:
    """What a deck says of its materials.

    Args:
        deck: The deck.
        leave: Says that a part of a card is not taken over, and why.
    """

    def __init__(self, deck: Deck, leave: Callable[[Card, str], None]) -> None:
        self._leave = leave
        self._made_of = {plain(body): one for body, one in deck.sections.items()}
        self._models: dict[str, dict[str, object]] = {}
        self._directions: dict[str, dict[str, object]] = {}
        self._model: dict[str, object] = {}

    def take(self, card: Card) -> bool:
        """Take a card over; whether it is one of a material.

        Raises:
            InputError: It cannot be taken over.
        """
        if card.name in _READERS:
            _READERS[card.name](self, card)
        return card.name in _READERS

    def expands(self, body: str) -> bool:
        """Whether the material of a body has an expansion."""
        return "expansion" in self._of(body)

    def table(self, body: str, finite: bool) -> tuple[dict[str, object], list[str]]:
        """Table of the material of a body, and lines on what is missing.

        Args:
            body: Name of the body.
            finite: Whether strain is finite.
        """
        known = self._of(body)
        if "model" in known:
            return known, []
        if "E" not in known:
            return known, [f"material of {body}: [material.{key_of(body)}] has to be written"]
        if "G" in known:
            orientation = self._made_of[body].orientation.upper()
            if orientation and orientation not in self._directions:
                return {}, [f"material of {body}: *ORIENTATION {orientation} is not read"]
            strain = {"strain": "green-lagrange"} if finite else {}
            axes = self._directions.get(orientation, {})
            elastic = {key: value for key, value in known.items() if key not in _YIELDS}
            left = []
            if elastic != known:
                left = [f"material of {body}: *PLASTIC of an orthotropic one; see the model hill"]
            return {"model": "orthotropic"} | elastic | axes | strain, left
        if "flow_curve" in known or "yield_stress" in known:
            strain = {"strain": "logarithmic"} if finite else {}
            return {"model": "plastic"} | known | strain, []
        return {"model": "st-venant-kirchhoff" if finite else "linear-elastic"} | known, []

    def _of(self, body: str) -> dict[str, object]:
        section = self._made_of.get(body)
        return self._models.get(section.material.upper(), {}) if section else {}

    def read_material(self, card: Card) -> None:
        """Take `*MATERIAL`; what follows is of it."""
        if card.option("NAME").upper() in self._models:
            self._leave(
                card, ": there is one of this name already; what both say is taken together"
            )
        self._model = self._models.setdefault(card.option("NAME").upper(), {})

    def read_elastic(self, card: Card) -> None:
        """Take `*ELASTIC` where it is isotropic or orthotropic, at its first temperature."""
        kind = "".join(card.options.get("TYPE", "ISO").upper().split())
        if kind not in _SIZES:
            raise InputError(f"TYPE={card.options['TYPE']} is not taken over; see a law in Python")
        numbers, size = card.numbers(), _SIZES[kind]
        if len(numbers) < size:
            raise InputError(f"{len(numbers)} numbers, {size} are needed")
        if size == 2:
            self._model |= {"E": float(numbers[0]), "nu": float(numbers[1])}
            others = len(list(card.fields())) > 1
        else:
            engineering = kind == "ENGINEERINGCONSTANTS"
            values = numbers[:9].reshape(3, 3) if engineering else _engineering(numbers[:9])
            names = ("E", "nu", "G")
            self._model |= {name: v.tolist() for name, v in zip(names, values, strict=True)}
            others = len(numbers) > size + 1
        if others:
            self._leave(card, ": its values at other temperatures")

    def read_rubber(self, card: Card) -> None:
        """Take `*HYPERELASTIC`: constants, and D1 of the energy `(J - 1)^2 / D1`."""
        kind = next((k for k in _RUBBERS if k in card.options), "")
        if not kind:
            raise InputError(f"{', '.join(_RUBBERS)} are taken over")
        numbers, terms = card.numbers().tolist(), int(card.options.get("N", "1"))
        constants = numbers[: _RUBBERS[kind] or 2 * terms]
        volume = numbers[len(constants) :]
        if len(constants) < (_RUBBERS[kind] or 2 * terms) or "TESTDATAINPUT" in card.options:
            raise InputError("constants alone are taken over, no data of tests")
        if any(volume[1 : 3 if kind == "YEOH" else terms]):
            raise InputError("D1 alone is taken over; see bulk_modulus")
        found: dict[str, object] = {"model": kind.lower()}
        if kind == "OGDEN":  # 2 mu / alpha^2 there, mu / alpha here
            exponents = constants[1::2]
            pairs = zip(constants[::2], exponents, strict=True)
            found |= {"mu": [2.0 * mu / alpha for mu, alpha in pairs], "alpha": exponents}
        elif kind == "YEOH":
            found |= dict(zip(("C10", "C20", "C30"), constants, strict=True))
        else:
            found["model"] = "mooney-rivlin"
            found |= dict(zip(("C10", "C01"), (*constants, 0.0), strict=False))
        if volume and volume[0] > 0.0:
            found["bulk_modulus"] = 2.0 / volume[0]
        else:
            text = ": without D1, which is incompressible in Abaqus and nu = 0.475 in CalculiX: "
            self._leave(card, f"{text}bulk_modulus has to be written")
        self._model |= found

    def read_density(self, card: Card) -> None:
        """Take `*DENSITY`."""
        self._model["density"] = float(card.numbers()[0])

    def read_expansion(self, card: Card) -> None:
        """Take `*EXPANSION`, one coefficient at its first temperature."""
        if not card.options.get("TYPE", "ISO").upper().startswith("ISO"):
            raise InputError("one coefficient is taken over")
        if coefficient := float(card.numbers()[0]):
            self._model["expansion"] = coefficient
        if len(list(card.fields())) > 1:
            self._leave(card, ": its values at other temperatures")

    def read_plastic(self, card: Card) -> None:
        """Take `*PLASTIC`: a curve of yield stress, or two points of one that moves."""
        kind = card.options.get("HARDENING", "ISOTROPIC").upper()
        if real(card.options.get("RATE") or "0") != 0.0:
            raise InputError(f"RATE={card.options['RATE']}: yield stress is that of no rate here")
        rows = list(card.fields())
        moves = kind == "KINEMATIC" and len(rows) == 2
        if not (moves or kind == "ISOTROPIC") or any(len(row) > 2 for row in rows):
            raise InputError("one isotropic curve, or two kinematic points, are taken over")
        pairs = [(real((*row, "0")[1]), real(row[0])) for row in rows]
        if moves:
            (start, first), (end, last) = pairs
            self._model["yield_stress"] = first
            self._model["kinematic"] = (last - first) / (end - start)
            return
        self._model["flow_curve"] = [value for pair in pairs for value in pair]

    def read_orientation(self, card: Card) -> None:
        """Take `*ORIENTATION`: two vectors, or the axis of cylinder coordinates."""
        first, *others = card.fields()
        a, b = np.array([real(v) for v in first[:6]]).reshape(2, 3)
        turns = [(int(row[0]), real(row[1])) for row in others if len(row) > 1 and real(row[1])]
        kind = card.options.get("SYSTEM", "RECTANGULAR").upper()
        if kind.startswith("R"):
            axes = _axes(a, b)
            for about, angle in turns:
                turn = Rotation(tuple(axes[about - 1]), angle_deg=angle)
                axes = turn.apply(axes)
            kept = axes[:2] if turns else (a, b)
            found: dict[str, object] = dict(
                zip(("first", "second"), map(_listed, kept), strict=True)
            )
        elif turns:
            raise InputError("axes of a cylinder with a turn of their own; see orthotropic")
        elif kind.startswith("C"):
            found = {"around": [a.tolist(), (b - a).tolist()]}
        else:
            raise InputError(f"SYSTEM={kind} is not read; see orthotropic")
        self._directions[card.option("NAME").upper()] = found


def _axes(a: Floats, b: Floats) -> Floats:
    """Unit vectors along the first vector, across it towards the second, and normal to both."""
    first, third = a / np.linalg.norm(a), np.cross(a, b) / np.linalg.norm(np.cross(a, b))
    return np.array([first, np.cross(third, first), third])


def _listed(vector: Floats) -> list[float]:
    return [round(float(v), 12) + 0.0 for v in vector]


def _engineering(d: Floats) -> Floats:
    """E, nu12 nu13 nu23 and G12 G13 G23 of D1111, D1122, D2222, D1133, D2233, D3333 and shears."""
    stiffness = np.array([[d[0], d[1], d[3]], [d[1], d[2], d[4]], [d[3], d[4], d[5]]])
    compliance = np.linalg.inv(stiffness)
    moduli = 1.0 / compliance.diagonal()
    ratios = [-compliance[i, j] * moduli[i] for i, j in ((0, 1), (0, 2), (1, 2))]
    return np.array([moduli, ratios, d[6:9]])


_READERS: dict[str, Callable[[Materials, Card], None]] = {
    "MATERIAL": Materials.read_material,
    "ELASTIC": Materials.read_elastic,
    "HYPERELASTIC": Materials.read_rubber,
    "DENSITY": Materials.read_density,
    "EXPANSION": Materials.read_expansion,
    "PLASTIC": Materials.read_plastic,
    "ORIENTATION": Materials.read_orientation,
}


class Temperatures:
    """Temperatures of the bodies of a deck, over those at the start.

    Args:
        deck: The deck.
        bodies: Names of the bodies whose material expands.
        start: The cards that say how warm nodes are at the start.
    """

    def __init__(self, deck: Deck, bodies: list[str], start: list[Card]) -> None:
        self._deck = deck
        of_element = bodies_of(deck)
        nodes: dict[str, set[int]] = {body: set() for body in bodies}
        for element, (_, corners) in deck.elements.items():
            body = of_element.get(element, "")
            if body in nodes:
                nodes[body].update(corners)
        self._nodes = {body: sorted(found) for body, found in nodes.items() if found}
        self._start: dict[int, float] = {}
        for card in start:
            self._start |= self._values(card)
        self._now = dict(self._start)

    def prescribed(self, card: Card) -> Iterator[tuple[str, float] | InputError]:
        """Bodies and the temperatures that a `*TEMPERATURE` leads them to, over the start.

        Yields:
            They, or why a body has none: its temperatures are not the same all over it.

        Raises:
            InputError: They come from a file.
        """
        if "FILE" in card.options:
            raise InputError("temperatures of a file; the case has one for each body")
        if "AMPLITUDE" in card.options and any(self._start.values()):
            raise InputError("an amplitude of temperatures that do not start at 0")
        if card.options.get("OP", "MOD").upper() == "NEW":
            self._now = dict(self._start)
        self._now |= self._values(card)
        for body, nodes in self._nodes.items():
            rise = np.array([self._now.get(n, 0.0) - self._start.get(n, 0.0) for n in nodes])
            span = float(np.ptp(rise))
            if span > UNIFORM * np.abs(rise).max():
                text = f"{body} is at {rise.min():.4g} to {rise.max():.4g} over its start"
                yield InputError(f"{text}; the case has one temperature for each body")
            else:
                yield body, float(rise[0])

    def _values(self, card: Card) -> dict[int, float]:
        found: dict[int, float] = {}
        for entry, value, *_ in card.fields():
            found |= dict.fromkeys(self._deck.nodes_of(entry), real(value))
        return found
