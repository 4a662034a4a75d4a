"""What is named as the cause of work that the balance of energy leaves open."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.interface import STATUS
from anisocontact.solver.stepping import energy_watch
from anisocontact.solver.stepping.energy_watch import DISSIPATED, Cause, EnergyWatch
from anisocontact.solver.system.reported import Energies


class _Points:
    """A contact of 20 points, of which the numbers of each status are given."""

    facet_size = 1.0
    name = "pad on disc"

    def __init__(self, *numbers: int) -> None:
        self.numbers = numbers
        self.heat = {"friction": 0.0, "viscous": 0.0}
        self.bodies: dict[str, float] = {}

    def energies(self) -> dict[str, float]:
        return dict(self.heat)

    def counts(self) -> dict[str, int]:
        return dict(zip(STATUS, self.numbers, strict=True))


@pytest.fixture
def watch(monkeypatch: pytest.MonkeyPatch) -> Any:
    """A watch of a contact of 10 open and 10 sticking points, with overlaps at the start or not."""

    def begun(overlap: bool = False, sticking: int = 10) -> tuple[EnergyWatch, _Points]:
        points = _Points(20 - sticking, sticking, 0)
        problem: Any = SimpleNamespace(
            contacts=[points],
            missed=float("inf"),  # so nothing snaps
            bulk=SimpleNamespace(stores=True, dissipated_by_body=lambda: dict(points.bodies)),
            energies=lambda: {"external": 0.0, "residual": 0.0, "regularisation": 0.0},
        )
        monkeypatch.setattr(energy_watch, "initial_overlap", lambda *_: overlap)
        monkeypatch.setattr(EnergyWatch, "_rounded", lambda _: 0.0)
        made = EnergyWatch(problem)
        made.begin()
        return made, points

    return begun


@pytest.mark.parametrize(
    ("numbers", "cause"),
    [
        ((9, 11, 0), Cause.COARSE),
        ((8, 12, 0), Cause.TOUCHED),
        ((10, 9, 1), Cause.COARSE),
        ((10, 5, 5), Cause.SLID),
        ((8, 6, 6), Cause.SLID),
        ((7, 8, 5), Cause.TOUCHED),
    ],
)
def test_what_most_points_do_is_the_cause(watch: Any, numbers: Any, cause: str) -> None:
    """An increment that leaves 1 of 10 open, after which points have other statuses.

    Requirement: contact that begins, or sliding, whichever more points do, of more than 1 in 20;
    else the increments. Source: by hand, of 20 points: 2 that close, 4 and 2 that come to slide.
    """
    made, points = watch()
    points.numbers = numbers
    found = made.after({"external": 10.0, "residual": 1.0, "regularisation": 0.0}, ran_off=False)
    assert (found.share, found.cause) == (pytest.approx(0.1), cause)


def test_first_and_last_points_are_all_of_the_contact(watch: Any) -> None:
    """Requirement: one point in 20 is the cause where nothing touched before, or does so now.

    Source: a ball that comes to a large face touches at a few of its nodes; all that is open in the
    balance is of the way on which there was no force.
    """
    for sticking, numbers in ((0, (19, 1, 0)), (1, (20, 0, 0))):
        made, points = watch(sticking=sticking)
        points.numbers = numbers
        energies = {"external": 10.0, "residual": 1.0, "regularisation": 0.0}
        assert made.after(energies, ran_off=False).cause == Cause.TOUCHED


def test_an_overlap_is_the_cause_of_the_first_increment_alone(watch: Any) -> None:
    """Requirement: what pushes bodies apart is named, until more of the work has another cause."""
    made, points = watch(overlap=True)
    found = made.after({"external": 10.0, "residual": 1.0, "regularisation": 0.0}, ran_off=True)
    assert found.cause == Cause.OVERLAPPED
    assert made.pushed_apart
    points.numbers = (10, 5, 5)
    found = made.after({"external": 10.0, "residual": 1.5, "regularisation": 0.0}, ran_off=False)
    assert found.cause == Cause.OVERLAPPED
    assert not made.pushed_apart
    found = made.after({"external": 10.0, "residual": 4.5, "regularisation": 0.0}, ran_off=True)
    assert found.cause == Cause.RAN_OFF
    found = made.after({"external": 10.0, "residual": -4.5, "regularisation": 1.0}, ran_off=False)
    assert found.cause == Cause.JUMPED


def test_the_energy_of_regularisation_by_its_name_of_before() -> None:
    """For one more version, with a warning; a name that never was is refused."""
    energies = Energies(external=2.0, regularisation=0.5)
    with pytest.warns(DeprecationWarning, match='"flow" is now "regularisation"'):
        assert energies["flow"] == 0.5
    with pytest.raises(KeyError, match="flo"):
        _ = energies["flo"]


@pytest.mark.parametrize(
    ("heat", "cause"),
    [
        ({"friction": -0.5}, Cause.HEAT_FELL),
        ({"friction": 0.5, "viscous": -1.0}, Cause.HEAT_FELL),
        ({"inelastic": -0.3}, Cause.HEAT_FELL),
        ({"friction": -0.2}, Cause.COARSE),
        ({"friction": 0.5}, Cause.COARSE),
    ],
)
def test_dissipation_that_falls_is_the_cause(
    watch: Any, heat: dict[str, float], cause: str
) -> None:
    """An increment that leaves 1 of 10 open, in which laws say what they have dissipated.

    Requirement: where what was dissipated falls by more than a quarter of what is left open, the
    law is named, not contact that began meanwhile. Source: second law of thermodynamics; a
    dissipation with the wrong sign leaves twice itself open.
    """
    made, points = watch()
    points.numbers = (10, 10, 0) if cause == Cause.COARSE else (5, 15, 0)
    found = made.after(
        {"external": 10.0, "residual": 1.0, "regularisation": 0.0} | heat, ran_off=False
    )
    assert found.cause == cause
    again = EnergyWatch(made._problem)
    again.restore(made.persistent())
    assert again.persistent().tolist() == made.persistent().tolist()


def test_a_run_that_goes_on_knows_what_was_dissipated(watch: Any) -> None:
    """Requirement: dissipation that falls, and is positive still, is seen by who goes on, too."""
    made, _ = watch()
    energies = {"external": 10.0, "residual": 0.0, "regularisation": 0.0}
    made.after(energies | {"inelastic": 5.0}, ran_off=False)
    again = EnergyWatch(made._problem)
    again.restore(made.persistent())
    found = again.after(energies | {"residual": 1.0, "inelastic": 4.0}, ran_off=False)
    assert found.cause == Cause.HEAT_FELL


@pytest.mark.parametrize(
    ("numbers", "heat", "jumped", "cause"),
    [
        ((5, 15, 0), {"inelastic": 1.5}, 0.0, Cause.FLOWED),
        ((10, 5, 5), {"inelastic": 1.5, "friction": 1.0}, 0.0, Cause.FLOWED),
        ((10, 5, 5), {"inelastic": 1.5, "friction": 2.0}, 0.0, Cause.SLID),
        ((5, 15, 0), {"inelastic": 0.9}, 0.0, Cause.TOUCHED),
        ((10, 10, 0), {"inelastic": 1.5}, 0.0, Cause.FLOWED),
        ((10, 10, 0), {"inelastic": 1.5}, 1.0, Cause.JUMPED),
    ],
)
def test_flow_that_dissipates_more_than_is_left_open_is_the_cause(
    watch: Any, numbers: Any, heat: dict[str, float], jumped: float, cause: str
) -> None:
    """An increment that leaves 1 of 10 open, after one in which as much had flowed already.

    Requirement: materials that flow are named where what they dissipate in the increment can
    explain what is left open, and friction dissipates less; else contact or sliding that began.
    Source: a force that yields at F on its way by s counts as `F s / 2` where a load is reversed,
    for a work of `F s`: what is left open is what flow dissipates at most.
    """
    made, points = watch()
    before = dict.fromkeys(DISSIPATED, 5.0)
    energies = {"external": 10.0, "residual": 0.0, "regularisation": 0.0}
    made.after(energies | before, ran_off=False)
    points.numbers = numbers
    now = {name: value + heat.get(name, 0.0) for name, value in before.items()}
    energies |= {"external": 20.0, "residual": -1.0, "regularisation": jumped}
    assert made.after(energies | now, ran_off=False).cause == cause


def test_statuses_are_followed_while_dissipation_falls(watch: Any) -> None:
    """Requirement: what points did in an increment is not put down to the next one."""
    made, points = watch()
    points.numbers = (5, 15, 0)
    energies = {"external": 10.0, "residual": 0.01, "regularisation": 0.0, "friction": -1.0}
    assert made.after(energies, ran_off=False).cause == Cause.HEAT_FELL
    energies |= {"residual": 1.0}
    assert made.after(energies, ran_off=False).cause == Cause.COARSE


def test_a_contact_that_gives_energy_is_named(watch: Any) -> None:
    """Requirement: also where the balance closes, and by an increment that is behind a restart."""
    made, points = watch()
    energies = {"external": 10.0, "residual": 0.0, "regularisation": 0.0}
    points.heat = {"friction": 5.0, "viscous": 1.0}
    assert not made.after(energies, ran_off=False).driven
    again = EnergyWatch(made._problem)
    again.restore(made.persistent())
    again.begin()
    points.heat = {"friction": 3.0, "viscous": 2.0}
    assert again.after(energies, ran_off=False).driven == {"pad on disc": 0.1}
    points.heat["friction"] -= 1e-7  # rounding
    assert not again.after(energies, ran_off=False).driven


def test_rounding_before_any_work_is_no_energy_that_a_contact_gives(
    watch: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Requirement: where nothing has done work yet a share of it says nothing."""
    made, points = watch()
    monkeypatch.setattr(EnergyWatch, "_rounded", lambda _: 1e-25)
    points.heat["friction"] = -1e-30
    energies = {"external": 0.0, "residual": 0.0, "regularisation": 0.0}
    assert not made.after(energies, ran_off=False).driven


def test_a_material_that_gives_energy_is_named(watch: Any) -> None:
    """Requirement: its body, though another one dissipates more than that."""
    made, points = watch()
    energies = {"external": 10.0, "residual": 0.0, "regularisation": 0.0}
    points.bodies = {"disc": 1.0, "pad": 1.0}
    assert not made.after(energies, ran_off=False).driven_by
    points.bodies = {"disc": 5.0, "pad": 0.0}
    found = made.after(energies, ran_off=False)
    assert (found.driven_by, found.driven) == ({"pad": 0.1}, {})
