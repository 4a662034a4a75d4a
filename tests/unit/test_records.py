"""Data classes of `base/records.py` are those of `dataclasses`, which is their source."""

from __future__ import annotations

import copy
import dataclasses
import inspect
import pickle
from collections.abc import Callable
from dataclasses import FrozenInstanceError, field
from typing import Any

import pytest

from anisocontact.base import records


def _classes(decorator: Callable[..., Any]) -> tuple[Any, Any, Any]:
    """A frozen class, one that inherits from it, and one that is not frozen."""

    @decorator(frozen=True)
    class Base:
        """Has a text."""

        a: int
        b: list[int] = field(default_factory=list)
        c: str = "c"
        d: int = field(default=4, repr=False, compare=False)
        e: list[int] = field(init=False, default_factory=lambda: [5])

        def __post_init__(self) -> None:
            if self.a < 0:
                raise ValueError(self.a)

    @decorator(frozen=True)
    class Derived(Base):
        """Has one more."""

        f: float = field(default=1.0, kw_only=True)
        c: str = "other"

    @decorator
    class Free:
        """Can be changed."""

        a: int
        b: int = field(init=False, default=2)

    return Base, Derived, Free


OURS, THEIRS = _classes(records.dataclass), _classes(dataclasses.dataclass)
pairs = pytest.mark.parametrize("number", range(3))


@records.dataclass(frozen=True)
class Kept:
    """In a module, as what is kept in a file has to be."""

    a: int


@records.dataclass(frozen=True, eq=False)
class Itself:
    """Is equal to nothing else."""

    a: int


@pairs
def test_constructors_are_the_same(number: int) -> None:
    ours, theirs = OURS[number], THEIRS[number]
    assert str(inspect.signature(ours)) == str(inspect.signature(theirs))
    assert ours.__init__.__qualname__ == f"{ours.__qualname__}.__init__"
    assert [one.name for one in dataclasses.fields(ours)] == [
        one.name for one in dataclasses.fields(theirs)
    ]
    assert ours.__match_args__ == theirs.__match_args__
    assert vars(ours(1)) == vars(theirs(1))
    with pytest.raises(TypeError, match="missing 1 required positional argument: 'a'"):
        ours()
    with pytest.raises(TypeError, match="unexpected keyword argument 'e'"):
        ours(1, e=[])


@pairs
def test_objects_are_told_compared_and_replaced_in_the_same_way(number: int) -> None:
    ours, theirs = OURS[number], THEIRS[number]
    assert repr(ours(1)) == repr(theirs(1))
    assert ours(1) == ours(1) != ours(2)
    assert dataclasses.replace(ours(1), a=3) == ours(3)
    assert copy.deepcopy(ours(1)) == ours(1)
    assert dataclasses.asdict(ours(1)) == dataclasses.asdict(theirs(1))


def test_what_is_left_out_of_comparisons_does_not_count() -> None:
    base, derived, _ = OURS
    assert base(1, d=1) == base(1, d=2)
    assert base(1) != derived(1)
    assert derived(1, f=2.0) != derived(1)


def test_defaults_are_made_for_each_object() -> None:
    base, derived, _ = OURS
    assert base(1).b is not base(1).b
    assert base(1).e is not base(1).e
    assert derived(1).c == "other"


def test_frozen_objects_do_not_change_and_have_a_hash() -> None:
    _, derived, free = OURS
    one = derived(1)
    for name in ("a", "unknown"):
        with pytest.raises(FrozenInstanceError, match=f"cannot assign to field '{name}'"):
            setattr(one, name, 2)
    with pytest.raises(FrozenInstanceError, match="cannot delete field 'a'"):
        del one.a
    assert (
        hash(Kept(1))
        == hash(Kept(1))
        == hash(dataclasses.make_dataclass("K", ["a"], frozen=True)(1))
    )
    changed = free(1)
    changed.a = 2
    assert changed == free(2)
    with pytest.raises(TypeError, match="unhashable"):
        hash(changed)


def test_subclasses_that_are_no_data_classes_have_what_they_like() -> None:
    class Plain(OURS[0]):  # type: ignore[misc]
        """No data class."""

    one = Plain(1)
    one.mark = 2
    with pytest.raises(FrozenInstanceError):
        one.a = 2
    with pytest.raises(ValueError, match="-1"):
        Plain(-1)


def test_objects_can_be_kept_and_those_without_equality_are_themselves() -> None:
    assert pickle.loads(pickle.dumps(Kept(1))) == Kept(1)
    one = Itself(1)
    assert one != Itself(1)
    assert len({one, Itself(1)}) == 2
