"""Options of the cards of a deck that a case has no words for: each is told."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from anisocontact.mesh.deck import Card

#: Keyword that is taken over -> options that are read, or change nothing of what is computed here.
#: Supports and loads have theirs in `deck_supports`.
_KNOWN = {
    "MATERIAL": "NAME",
    "ELASTIC": "TYPE MODULI=INSTANTANEOUS",
    "PLASTIC": "HARDENING RATE=0",
    "HYPERELASTIC": "NEOHOOKE MOONEY-RIVLIN YEOH OGDEN N MODULI=INSTANTANEOUS",
    "DENSITY": "",
    "EXPANSION": "TYPE ZERO",
    "ORIENTATION": "NAME SYSTEM DEFINITION=COORDINATES",
    "SURFACEINTERACTION": "NAME",
    "FRICTION": "ANISOTROPIC TAUMAX DEPENDENCIES SLIPTOLERANCE ELASTICSLIP LAGRANGE",
    "SURFACEBEHAVIOR": "PRESSURE-OVERCLOSURE NOSEPARATION AUGMENTEDLAGRANGE PENALTY DIRECT",
    "CONTACTPAIR": (
        "INTERACTION TYPE ADJUST SMALLSLIDING CPSET TRACKING SUPPLEMENTARYCONSTRAINTS NOTHICKNESS "
        "MECHANICALCONSTRAINT SMOOTH EXTENSIONZONE GEOMETRICCORRECTION SLIDEDISTANCE WEIGHT"
    ),
    "TIE": "NAME POSITIONTOLERANCE ADJUST TYPE NOROTATION CYCLICSYMMETRY NOTHICKNESS",
    "AMPLITUDE": "NAME DEFINITION TIME VALUE FIXEDINTERVAL BEGIN",
    "COUPLING": "CONSTRAINTNAME REFNODE SURFACE",
    "KINEMATIC": "",
    "RIGIDBODY": (
        "REFNODE ROTNODE ANALYTICALSURFACE SURFACE ELSET NSET TIENSET PINNSET POSITION=INPUT "
        "ISOTHERMAL"
    ),
    "STEP": "NAME NLGEOM INC PERTURBATION UNSYMM SOLVER EXTRAPOLATION CONVERTSDI",
    "STATIC": "DIRECT SOLVER STABILIZE ALLSDTOL FACTOR CONTINUE APPLICATION CETOL",
    "TRANSFORM": "NSET TYPE",
}
_ALLOWED = {keyword: options.split() for keyword, options in _KNOWN.items()}
_ALLOWED["SURFACEBEHAVIOUR"] = _ALLOWED["SURFACEBEHAVIOR"]
#: Options of which a word more is of use.
_WHY = {
    ("STATIC", "RIKS"): "loads go along the increments as the amplitudes say",
    ("STEP", "AMPLITUDE"): "what has no amplitude goes along the step",
}


def unread_options(cards: Iterable[Card]) -> Iterator[tuple[Card, str]]:
    """Cards with an option that a case does not have, and what to say of it.

    Example:
        >>> card = Card("STATIC", {"RIKS": "", "DIRECT": ""}, (), 12)
        >>> [why for _, why in unread_options([card])]
        [': RIKS is not taken over; loads go along the increments as the amplitudes say']
    """
    for card in cards:
        allowed = _ALLOWED.get(card.name)
        if allowed is None:
            continue
        for option, value in card.options.items():
            given = option + f"={value}" * bool(value)
            if option in allowed or _same(given, allowed):
                continue
            more = _WHY.get((card.name, option), "")
            yield card, f": {given} is not taken over" + f"; {more}" * bool(more)


def _same(given: str, allowed: Iterable[str]) -> bool:
    """Whether an option with its value is one of some."""
    name, _, value = given.upper().partition("=")
    for one in allowed:
        known, _, wanted = one.partition("=")
        if known != name or not wanted:
            continue
        try:
            return float(value or "0") == float(wanted)
        except ValueError:
            return value == wanted
    return False
