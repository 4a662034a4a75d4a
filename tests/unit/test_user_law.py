"""Answers of a law of the user's that can be no law: one line that says which and what."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.errors import InputError, RunWarning
from anisocontact.base.fenicsx import ufl
from anisocontact.bulk import (
    NonlinearBulk,
    PointResult,
    PointState,
    UserEnergy,
    UserLaw,
    UserStress,
    user_material,
)
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem, Solver, Step, StoppedError

ONE = np.eye(9).reshape(3, 3, 3, 3)


class Spring:
    """`2 G e`; `spoil` changes its answer at strains that are not zero."""

    young = 3.0

    def __init__(self, spoil: Any = None, history: Any = None) -> None:
        self.history = {"p": ()} if history is None else history
        self._spoil = spoil

    def update(self, state: PointState) -> PointResult:
        """Stress, tangent and what was remembered."""
        answer = {
            "stress": 2.0 * state.strain,
            "tangent": np.stack([ONE + ONE.swapaxes(2, 3)] * len(state.strain)),
            "after": {name: 1.0 * values for name, values in state.before.items()},
        }
        if self._spoil is not None and state.strain.any():
            self._spoil(answer)
        return PointResult(**answer)


def _lost(answer: Any, part: str) -> None:
    values = answer["after"]["p"] if part == "p" else answer[part]
    values[0] = np.nan


def _skew(answer: Any) -> None:
    answer["stress"][:, 0, 1] += 0.01


def _one_sided(answer: Any) -> None:
    answer["tangent"][:, 0, 1, 0, 1] += 0.01


def _state(strain: float = 0.1) -> PointState:
    before = {"p": np.zeros(2)}
    return PointState(np.full((2, 3, 3), strain), before, 1.0, np.zeros((2, 3)))


@pytest.mark.parametrize(
    ("spoil", "says"),
    [
        (lambda a: _lost(a, "tangent"), "tangent: the law Spring returned numbers that are not"),
        (lambda a: _lost(a, "p"), "p: the law Spring returned numbers that are not finite"),
        (_skew, "stress: the law Spring returned one that is not symmetric"),
        (_one_sided, "tangent: .* one that is not symmetric in its last two indices"),
    ],
)
def test_answers_that_can_be_none(spoil: Any, says: str) -> None:
    """Requirement: a tangent or a variable that is no number where the stress is one, and what
    has to be symmetric and is not, end a run with the name of the law and of the part."""
    with pytest.raises(InputError, match=says):
        UserLaw(Spring(spoil)).update(_state())


def test_a_trial_that_went_too_far_is_no_mistake() -> None:
    """A stress that is no number cuts the increment, whatever else is none there."""

    def spoil(answer: Any) -> None:
        for part in ("stress", "tangent", "p"):
            _lost(answer, part)

    found = UserLaw(Spring(spoil)).update(_state())
    assert np.isnan(found.stress[0]).all() and np.isfinite(found.stress[1]).all()


@pytest.mark.parametrize("history", [["p"], {"p": "3"}, {"p": (3, 1.5)}, {"p": (-1,)}, {"p": 3}])
def test_shapes_of_variables(history: Any) -> None:
    """Requirement: shapes that are none are one line, before anything is made of them."""
    with pytest.raises(InputError, match=r"Spring.history: .* given, shapes by name needed"):
        UserLaw(Spring(history=history))


def test_elastic_tangent() -> None:
    """That of a law which flows is handed on; another shape is one line."""
    law = Spring()
    assert UserLaw(law).elastic_tangent is None
    law.elastic_tangent = (ONE + ONE.swapaxes(2, 3)).tolist()  # type: ignore[attr-defined]
    assert UserLaw(law).elastic_tangent == pytest.approx(ONE + ONE.swapaxes(2, 3))
    law.elastic_tangent = np.eye(6)  # type: ignore[attr-defined]
    with pytest.raises(
        InputError, match=r"law Spring returned an array of shape \(6, 6\)"
    ) as error:
        UserLaw(law)
    assert error.value.field == "elastic_tangent"


@pytest.mark.parametrize("power", [0, 2])
def test_a_body_without_stiffness_is_named(power: int) -> None:
    """Requirement: an energy that holds nothing at rest is said of its body, not of a penalty that
    was made of its stiffness."""

    class Loose:
        young = 1.0

        def energy(self, gradient: Any) -> Any:
            from anisocontact.base.fenicsx import ufl

            moved = gradient - ufl.Identity(3)
            return ufl.tr(gradient) - power * ufl.inner(moved, moved)

    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    with pytest.raises(InputError, match=r"material.block: no stiffness at rest: that of a node"):
        NonlinearBulk(model, {"block": user_material(Loose())})


def test_stress_at_rest_is_told() -> None:
    """Requirement: an energy that lacks what makes it least at rest, as `G/2 tr C` without
    `-G ln J`, whose stress there is G, is told before anything is solved: bodies shrink at once.
    A stress of 1e-8 of it is rounding of constants."""
    lack = {"a": 1.0, "b": 1e-8}
    boxes = {name: BoxSpec((2.0 * k, 0, 0), (1, 1, 1), (2, 2, 2)) for k, name in enumerate(lack)}
    materials = {
        name: UserEnergy(
            lambda F, share=share: 0.5 * ufl.inner(F, F) - (1.0 - share) * ufl.ln(ufl.det(F)),
            young=2.0,
        )
        for name, share in lack.items()
    }
    (said,) = Problem(build_box(boxes), materials).check([])
    assert said.startswith("body 'a': there is stress in it where it is not strained, as much as a")


def test_cells_that_a_stress_at_rest_turns_inside_out() -> None:
    """Requirement: a stop says what was told at the start where it is the cause, so that nobody
    looks for it in the mesh; one of a law without it does not."""
    model = build_box({"a": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})

    def stopped(stress: float) -> str:
        eye = ufl.Identity(3)
        law = UserStress(lambda F: F - ufl.inv(F).T + stress * eye, young=3.0)
        held = {"a.bottom": dict.fromkeys("xyz", 0.0), "a.top": {"z": 0.1 if stress else -1.5}}
        with pytest.raises(StoppedError) as caught:
            list(Solver(Problem(model, {"a": law}), [Step("hold", 1, held)]).run(on_note=str))
        return str(caught.value)

    cause = "body 'a': there is stress in it where it is not strained"
    said, other = stopped(30.0), stopped(0.0)
    assert "inverted" in said
    assert cause in said
    assert "inverted" in other
    assert cause not in other


def _spring(gradient: Any) -> Any:
    """Energy that is least at rest."""
    moved = gradient - ufl.Identity(3)
    return ufl.inner(moved, moved)


def test_a_script_hears_what_a_run_tells() -> None:
    """Requirement: who names nobody that is to be told gets Python warnings; who does gets none."""
    model = build_box({"bar": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    stressed = {"bar": UserEnergy(lambda F: 1e-3 * ufl.inner(F, F) + _spring(F), young=2.0)}
    held = {name: {"x": 0.0, "y": 0.0, "z": 0.0} for name in ("bar.bottom", "bar.top")}

    def solver() -> Solver:
        return Solver(Problem(model, stressed), [Step("hold", 1, held)])

    told: list[str] = []
    noted: list[str] = []
    with warnings.catch_warnings(record=True) as heard:
        warnings.simplefilter("always")
        list(solver().run(on_warning=told.append))
        list(solver().run(on_note=noted.append))
        assert not heard
        list(solver().run())
    assert told
    assert [line for line in noted if line.startswith("warning: ")] == [
        f"warning: {t}" for t in told
    ]
    assert [(one.category, str(one.message)) for one in heard] == [(RunWarning, t) for t in told]
