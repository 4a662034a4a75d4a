"""Prescribed values: numbers and load curves of values, amplitudes and paths of a case file."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from anisocontact.base.amplitudes import Amplitude, make_amplitude
from anisocontact.base.errors import InputError, within
from anisocontact.base.load_curve import LoadCurve, load_curves
from anisocontact.base.paths import make_path
from anisocontact.case.amplitudes import FunctionTable, Scheduled
from anisocontact.case.law_file import module_at
from anisocontact.case.model import Case, StepSection
from anisocontact.case.quantity import FREE
from anisocontact.case.section import near

#: Shares of a step at which an amplitude is looked at; no period divides them.
_PLACES = (0.0, *((k * 0.618034) % 1.0 for k in range(1, 200)), 1.0)
#: Time after a step, as a share of it, that is rounding.
_LATE = 1e-9
#: What of a step may follow a path.
_WITH_PATHS = ("displacement", "motion", "anchor")


class CaseLoadCurves:
    """Amplitudes and paths of a case.

    Args:
        case: The case.
        resolve: From a path in the case file to where that is.
        python: Whether Python files are run; without them their amplitudes are 0.
    """

    def __init__(self, case: Case, resolve: Callable[[str], Path], python: bool = True) -> None:
        self._of_run = {name: table.of_run for name, table in case.amplitude.items()}
        self._amplitudes = {
            name: _amplitude(table, f"amplitude.{name}", resolve, python)
            for name, table in case.amplitude.items()
        }
        self._paths = {
            name: load_curves(_path(table, f"path.{name}")) for name, table in case.path.items()
        }

    def amplitude(self, name: str, begun: float) -> Amplitude:
        """An amplitude for a step that begins at a time of the run."""
        found = self._amplitudes[name]
        return (lambda time: found(begun + time)) if self._of_run[name] else found

    def values(self, given: Mapping[str, Any], path: str | None, begun: float) -> dict[str, Any]:
        """What a step takes: numbers, load curves, None where free.

        Args:
            given: Values as they are in the case file, by component.
            path: Name of a path that prescribes components, too.
            begun: Time of the run at which the step begins.
        """
        found = {component: self.value(value, begun) for component, value in given.items()}
        return found | (self._paths[path] if path is not None else {})

    def value(self, given: Any, begun: float) -> Any:
        """One of the values."""
        if isinstance(given, Scheduled):
            amplitude = self.amplitude(given.amplitude, begun)
            return LoadCurve(amplitude, given.value, given.relative)
        return None if given == FREE else given


def _amplitude(table: Any, place: str, resolve: Callable[[str], Path], python: bool) -> Amplitude:
    if not isinstance(table, FunctionTable):
        with within(place):
            return make_amplitude(table.chosen["kind"], **table.parameters())
    with within(place):
        module = module_at(resolve, table.file, python)
        if module is None:
            return lambda time: 0.0
        found: Any = getattr(module, table.function, None)
        if not callable(found):
            known = [n for n, v in vars(module).items() if callable(v) and not n.startswith("_")]
            text = f"\"{table.function}\" given, no such function in '{table.file}'; "
            raise InputError(text + near(table.function, known), "function")
        return partial(found, **table.arguments)


def _path(table: Any, place: str) -> Any:
    with within(place):
        return make_path(table.chosen["kind"], **table.parameters())


def prescribed_axes(case: Case, path: str | None) -> list[str]:
    """Components that a path prescribes; none where it is not there or wrong."""
    try:
        return [] if path is None else list(_path(case.path[path], "").components())
    except (InputError, KeyError):
        return []


def check_load_curves(case: Case) -> Iterator[InputError]:
    """Amplitudes and paths that are wrong, or that steps name and there are not."""
    axes_of: dict[str, list[str]] = {}
    for name, table in case.amplitude.items():
        if not isinstance(table, FunctionTable):
            try:
                _amplitude(table, f"amplitude.{name}", Path, python=False)
            except InputError as error:
                yield error
    for name, table in case.path.items():
        axes_of[name] = prescribed_axes(case, name)
        try:
            _path(table, f"path.{name}")
        except InputError as error:
            yield error
    for i, step in enumerate(case.step):
        for place, value in _values(step):
            if isinstance(value, Scheduled) and value.amplitude not in case.amplitude:
                yield _missing(value.amplitude, list(case.amplitude), f"step[{i}].{place}")
        for name, turn in step.rotation.items():
            if turn.amplitude is not None and turn.amplitude not in case.amplitude:
                place = f"step[{i}].rotation.{_key(name)}"
                yield _missing(turn.amplitude, list(case.amplitude), place)
        for kind in _WITH_PATHS:
            for name, given in getattr(step, kind).items():
                yield from _along_path(given, axes_of, f"step[{i}].{kind}.{_key(name)}")


def idle_amplitudes(case: Case) -> Iterator[str]:
    """Amplitudes that steps name and that stay at one value in them, a line each.

    So it is where times are meant to count from the beginning of the run and count from that of
    the step. Functions in Python are left out, and holds of amplitudes of the run.
    """
    built = {
        name: _amplitude(table, f"amplitude.{name}", Path, python=False)
        for name, table in case.amplitude.items()
        if not (table.of_run or isinstance(table, FunctionTable))
    }
    for step in case.step:
        named = {place: v.amplitude for place, v in _values(step) if isinstance(v, Scheduled)}
        named |= {
            f"rotation.{_key(group)}": turn.amplitude
            for group, turn in step.rotation.items()
            if turn.amplitude is not None
        }
        for place, name in named.items():
            if name in built and len({built[name](step.duration * s) for s in _PLACES}) == 1:
                yield (
                    f"step {step.name!r}.{place}: its amplitude stays at one value from the time 0 "
                    f"to {step.duration:g}: times count from where the step begins, with "
                    'time_of = "total" in its table from the beginning of the run'
                )


def cut_paths(case: Case) -> Iterator[str]:
    """Paths that come to an end after the steps that follow them, a line each."""
    ends = {name: getattr(_path(t, f"path.{name}"), "end", 0.0) for name, t in case.path.items()}
    for step in case.step:
        for kind in _WITH_PATHS:
            for name, given in getattr(step, kind).items():
                if given.path is not None and ends[given.path] > step.duration * (1.0 + _LATE):
                    yield (
                        f"step {step.name!r}.{kind}.{_key(name)}: its path ends at the time "
                        f"{ends[given.path]:g} and the step at {step.duration:g}: what comes later "
                        "is not followed; times count from where the step begins"
                    )


def _along_path(given: Any, axes_of: Mapping[str, list[str]], place: str) -> Iterator[InputError]:
    if given.path is None:
        return
    if given.path not in axes_of:
        yield _missing(given.path, list(axes_of), place, "path")
        return
    for axis in given.given():
        if axis in axes_of[given.path]:
            text = f'given with path "{given.path}", which has {axis}; one of the two is allowed'
            yield InputError(text, f"{place}.{axis}")


def _values(step: StepSection) -> Iterator[tuple[str, Any]]:
    for kind in ("displacement", "motion", "load", "anchor", "traction", "force", "body_force"):
        for name, given in getattr(step, kind).items():
            yield from ((f"{kind}.{_key(name)}.{key}", value) for key, value in given)
    for name, given in step.cylindrical.items():
        yield from ((f"cylindrical.{_key(name)}.{k}", v) for k, v in given.given().items())
    yield from ((f"gravity.{axis}", value) for axis, value in step.gravity or ())
    for kind in ("pressure", "temperature"):
        yield from ((f"{kind}.{_key(name)}", value) for name, value in getattr(step, kind).items())


def _key(name: str) -> str:
    return f'"{name}"' if "." in name else name


def _missing(name: str, known: list[str], place: str, what: str = "amplitude") -> InputError:
    return InputError(f'"{name}" given, no such {what}; {near(name, known)}', f"{place}.{what}")
