"""Which way the equations are solved, and why; the registry of strategies."""

from __future__ import annotations

from dataclasses import dataclass

from anisocontact.base.errors import InputError
from anisocontact.base.kinds import entry_of
from anisocontact.base.strategies import AUTO, add_strategy, strategy_entry
from anisocontact.base.typed import typed
from anisocontact.solver.strategies.condensed.strategy import CondensedStrategy
from anisocontact.solver.strategies.direct import DirectStrategy
from anisocontact.solver.strategies.iterative.strategy import IterativeStrategy
from anisocontact.solver.strategies.strategy import Strategy, Task

_DIRECT = DirectStrategy()
#: All strategies, in the order in which `auto` asks them.
_STRATEGIES: list[Strategy] = [CondensedStrategy(), _DIRECT, IterativeStrategy()]


def register_strategy[T: type[Strategy]](strategy: T) -> T:
    """Let a strategy be asked for by its name, in Python and in case files read afterwards.

    `auto` takes it where it says that it costs nothing, and no strategy before it can.

    Args:
        strategy: Class that is made without arguments.

    Returns:
        The class, so that this serves as a decorator.

    Raises:
        InputError: There is a strategy of that name, or it is no class with an `entry` and all that
            a `Strategy` has.

    Example:
        >>> register_strategy(DirectStrategy)
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: strategy: 'direct' is registered already
    """
    entry_of(strategy, "strategy")
    _add(strategy())
    return strategy


@typed
def _add(strategy: Strategy) -> None:
    add_strategy(strategy.entry)
    _STRATEGIES.append(strategy)


@dataclass(frozen=True)
class Choice:
    """How the equations are solved.

    Attributes:
        strategy: The strategy.
        reason: Why, in a line.
    """

    strategy: Strategy
    reason: str

    @property
    def name(self) -> str:
        """Name of the strategy."""
        return self.strategy.entry.name


def choose(name: str, task: Task) -> Choice:
    """Take the strategy asked for, or the one that suits the problem.

    Args:
        name: Name of an entry of `base.strategies.strategies`.
        task: What is to be solved.

    Raises:
        InputError: There is no such strategy, or it cannot solve this problem.
    """
    asked = strategy_entry(name)
    if name == AUTO:
        return _suited(task)
    strategy = next(known for known in _STRATEGIES if known.entry == asked)
    against = next(strategy.obstacles(task), "")
    if against:
        raise InputError(f"{name!r} given, but {against}", "strategy")
    return Choice(strategy, "asked for")


def _suited(task: Task) -> Choice:
    """The first strategy that nothing speaks against; the direct one where there is none."""
    refused: dict[str, str] = {}
    for strategy in _STRATEGIES:
        against = next(strategy.obstacles(task), "") or next(strategy.costs(task), "")
        if not against:
            *before, last = refused.items() or [("", strategy.merit)]
            others = [f"not {name}: {reason}" for name, reason in before]
            return Choice(strategy, "; ".join([last[1], *others]))
        refused[strategy.entry.name] = against
    return Choice(_DIRECT, next(iter(refused.values())))
