"""Names of the ways to solve the equations; no finite elements are needed to check them."""

from anisocontact.base import registry
from anisocontact.base.errors import InputError
from anisocontact.base.registry import Entry

AUTO, DIRECT, CONDENSED, ITERATIVE = "auto", "direct", "condensed", "iterative"
_ENTRIES = [
    Entry(name, "strategy", doc, ())
    for name, doc in (
        (AUTO, "what suits the case"),
        (DIRECT, "one factorisation of the whole system in every Newton iteration"),
        (
            CONDENSED,
            "few factorisations of the bodies, one if they are linear, iterations on the contact",
        ),
        (ITERATIVE, "Krylov iterations on the whole system"),
    )
]
#: Those of the project, the default first.
STRATEGIES = tuple(entry.name for entry in _ENTRIES)


def strategies() -> tuple[Entry, ...]:
    """What may be asked for, the default first."""
    return tuple(_ENTRIES)


def strategy_entry(name: str) -> Entry:
    """The entry of a strategy.

    Raises:
        InputError: There is no such strategy.
    """
    return registry.entry(strategies(), name, "strategy")


def add_strategy(entry: Entry) -> None:
    """Let one more be asked for.

    Raises:
        InputError: There is a strategy of that name.
    """
    if any(entry.name == known.name for known in _ENTRIES):
        raise InputError(f"{entry.name!r} is registered already", "strategy")
    _ENTRIES.append(entry)
