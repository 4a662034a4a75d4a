"""Condensed strategy: the same answers as one factorisation of the whole system.

Requirement: with a tight Newton tolerance both strategies solve the same equations, so that every
number agrees to 1e-8 of its size: what is left of Newton's method (1e-11) times how much the
solution answers to it. Source: `direct`, an independent way to solve the same equations.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from tests.verification.laws_in_python import Creeping
from tests.verification.test_fe_self_contact import hairpin

from anisocontact.anisotropy import make_directions
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import (
    ContactLaw,
    Interface,
    PythonLaw,
)
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import (
    Body,
    BoxSpec,
    Model,
    PlaneStrain,
    build_box,
    build_mesh,
    make_shape,
)
from anisocontact.solver import Accepted, Problem, Solver, Step, Turn
from anisocontact.solver.stepping import attempts
from anisocontact.solver.strategies.condensed import reach
from anisocontact.solver.strategies.condensed.condensed import Condensed
from anisocontact.surfaces import make_surface

#: At slave nodes.
POINTS, MORTAR = (partial(Contact, mortar=nodes) for nodes in (False, True))


MARKS = make_directions("constant", vector=(1, 0, 0), angle=np.pi / 6)
type Laws = tuple[NormalLaw, Adhesion, Friction]
LAWS: Laws = (
    NormalLaw(penalty=1e5),
    Adhesion(stiffness=(1e5, 5e4), directions=MARKS),
    Friction(coefficients=(0.3, 0.15), directions=MARKS),
)
CLAMP = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
PRESS = Step("press", 2, {**CLAMP, "block.top": {"x": 0.0, "y": 0.0, "z": -0.01}})
DRAG = Step("drag", 3, {"block.top": {"x": 0.02}})


def _model(cell: str = "hexahedron", order: int = 1, n: int = 4, length: float = 2.0) -> Model:
    shape: dict[str, Any] = {"cell": cell, "order": order}
    m = 3 * n // 2
    base = BoxSpec((-0.5, -0.5, -0.5), (length, 2, 0.5), (int(m * length / 2), m, 2), **shape)
    return build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (n, n, 2), **shape), "base": base})


def _pair(model: Model, laws: Laws = LAWS, kind: Any = POINTS, **options: Any) -> Problem:
    law = ContactLaw(*laws)
    contact = kind(model, "block.bottom", "base.top", law=law, current_area=False, **options)
    elastic = make_material("linear-elastic", E=1000.0, nu=0.3)
    return Problem(model, {"block": elastic, "base": elastic}, [contact])


def _on_surface(surface: str = "plane", **parameters: Any) -> Problem:
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (4, 4, 2))})
    parameters = parameters or {"point": (0, 0, 0), "normal": (0, 0, 1)}
    interface = Interface(make_surface(surface, **parameters), *LAWS)
    elastic = make_material("linear-elastic", E=1000.0, nu=0.3)
    contacts: list[Contact] = [Contact(model, "block.bottom", interface, mortar=False)]
    return Problem(model, {"block": elastic}, contacts)


def _run(
    problem: Problem,
    steps: Sequence[Step],
    strategy: str,
    notes: list[str] | None = None,
    **more: Any,
) -> tuple[list[Accepted], list[Any], np.ndarray]:
    """What was accepted, means over the loaded groups, and all displacements at the end."""
    options = {"snes_rtol": 1e-11, **more}
    solver = Solver(problem, steps, options=options, strategy=strategy)
    weights = np.random.default_rng(2).random(len(problem.u.x.array) // 3)
    accepted, means = [], []
    for one in solver.run(on_note=None if notes is None else notes.append):
        accepted.append(one)
        means.append(problem.mean_displacement("any", weights))
    return accepted, means, problem.u.x.array.copy()


def _close(a: Any, b: Any, scale: float) -> None:
    np.testing.assert_allclose(a, b, rtol=0.0, atol=1e-8 * scale)


def _same(make: Callable[[], Problem], steps: Sequence[Step], **options: Any) -> list[str]:
    """Run both ways, compare everything that is reported, return the notes of `condensed`.

    `options` are those of PETSc.
    """
    notes: list[str] = []
    ours, our_means, our_u = _run(make(), steps, "condensed", notes, **options)
    theirs, their_means, their_u = _run(make(), steps, "direct", None, **options)
    force = max(float(np.abs(r).max()) for a in theirs for r in a.reactions.values())
    energy = max(abs(value) for a in theirs for value in a.energies.values())
    size = float(np.abs(their_u).max())
    _close(our_u, their_u, size)
    _close(our_means, their_means, float(np.abs(their_means).max()))
    assert len(ours) == len(theirs)
    for a, b in zip(ours, theirs, strict=True):
        assert a.contacts == b.contacts
        for group, reaction in b.reactions.items():
            _close(a.reactions[group], reaction, force)
        for name, (resultant, moment) in b.resultants.items():
            _close(a.resultants[name][0], resultant, force)
            _close(a.resultants[name][1], moment, force)
        for name, value in b.energies.items():
            _close(a.energies[name], value, energy)
    return notes


@pytest.mark.parametrize(
    "surface",
    [{}, {"surface": "sphere", "centre": (0.5, 0.5, -2.0), "radius": 2.0}],
    ids=["plane", "sphere"],
)
def test_block_on_surface(surface: dict[str, Any]) -> None:
    """Pressed and dragged on a rigid surface, askew to the grain."""
    steps = [Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.02}}), DRAG]
    _same(lambda: _on_surface(**surface), steps)


@pytest.mark.parametrize("kind", [POINTS, MORTAR])
def test_block_on_block(kind: type) -> None:
    """Meshed bodies, each condensed by itself."""
    notes = _same(lambda: _pair(_model(), kind=kind), [PRESS, DRAG])
    assert sum("condensing" in note for note in notes) == 2


@pytest.mark.parametrize(("cell", "order"), [("tetrahedron", 1), ("hexahedron", 2)])
def test_other_cells(cell: str, order: int) -> None:
    """Tetrahedra and quadratic hexahedra."""
    _same(lambda: _pair(_model(cell, order, n=2)), [PRESS, DRAG])


def test_loads_and_supports_that_come_and_go() -> None:
    """Tractions, supports on several faces, some that hold contact nodes, added and released.

    A body is condensed anew when other unknowns of it are prescribed, not when their values change.
    """
    side = {"block.left": {"y": 0.0}}
    steps = [
        PRESS,
        Step("pull", 2, {"block.top": {"z": -0.012}}, {"block.right": {"x": 3.0, "z": -1.0}}),
        Step("hold a side", 2, {**side, "block.top": {"x": 0.01}}),
        Step(
            "let go",
            3,
            {
                "block.left": {"y": None},
                "block.top": {"y": None, "z": -0.01},
                "block.right": {"y": 0.0},
            },
        ),
        Step("unload", 2, {"block.top": {"z": -0.008}}, {"block.right": {"x": 0.0}}),
    ]
    notes = _same(lambda: _pair(_model()), steps)
    assert sum("condensing" in note for note in notes) == 4


def test_a_body_that_contact_alone_holds() -> None:
    """`auto` condenses a body that nothing but contact holds; forces, iterations as of `direct`.

    Source: `direct`. Tolerance 1e-8 of the force: both find equilibrium to 1e-11 of it, with other
    springs until contact holds.
    """
    held = {"base.bottom": {"x": 0.0, "y": 0.0, "z": 0.0}}
    steps = [
        Step("press", 2, held, {"block.top": {"z": -10.0}}),
        Step("drag", 3, held, {"block.top": {"x": 1.5}}),
    ]
    found, spent = [], []
    for strategy in ("auto", "direct"):
        solver = Solver(_pair(_model()), steps, options={"snes_rtol": 1e-11}, strategy=strategy)
        assert solver.choice.name == {"auto": "condensed"}.get(strategy, strategy)
        done = list(solver.run())
        found.append(np.array([a.resultants["block.bottom"][0] for a in done]))
        spent.append([a.iterations for a in done])
    _close(found[0], found[1], np.abs(found[1]).max())
    assert sum(spent[0]) <= sum(spent[1]) + 2
    np.testing.assert_allclose(found[0][-1], [-1.5, 0.0, 10.0], atol=1e-6)


def test_lifted_and_pressed_again() -> None:
    """No contact at all for a while: equilibrium of the bulk alone."""
    steps = [
        PRESS,
        Step("lift", 2, {"block.top": {"z": 0.005}}),
        Step("press again", 2, {"block.top": {"z": -0.01}}),
    ]
    _same(lambda: _pair(_model()), steps)


def test_slides_out_of_reach(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the loads do not tell how far bodies slide, what is in reach moves along.

    Seven facets of the master, none of which is announced.
    """
    monkeypatch.setattr(reach, "_prescribed_range", lambda *_: np.zeros(3))
    away = Step("away", 6, {"block.top": {"x": 0.9}})
    model = _model(length=3.0)
    notes = _same(lambda: _pair(model, reach=0.2), [PRESS, away])
    assert sum("condensing" in note for note in notes) > 4


def test_large_increments_leave_the_reach_within_newton(monkeypatch: pytest.MonkeyPatch) -> None:
    """A point that meets a facet out of reach during iterations: the increment begins anew.

    Friction depends on the path, so that neither run may cut the increment: full steps go on for as
    long as they need, 17 to 46 iterations from one order of rounding to another; up to 402 with
    four facets along the block instead of three.
    """
    monkeypatch.setattr(reach, "_prescribed_range", lambda *_: np.zeros(3))
    away = Step("away", 1, {"block.top": {"x": 0.9}})
    model = _model(n=3, length=3.0)
    full = {"snes_linesearch_type": "basic", "snes_max_it": 5000}
    notes = _same(lambda: _pair(model, reach=0.2), [PRESS, away], **full)
    assert any("widened" in note for note in notes)


def test_flow_that_leaves_the_reach_begins_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same with bodies that flow: to the only equilibrium, from the accepted state again.

    Nothing is called a jump.
    """
    monkeypatch.setattr(reach, "_prescribed_range", lambda *_: np.zeros(3))
    away = Step("away", 1, {"block.top": {"x": 0.9}})
    model = _model(n=3, length=3.0)
    laws = (*LAWS[:2], Friction(coefficients=(1e-9, 5e-10), directions=MARKS))
    *_, wanted = _run(_pair(model, laws, reach=0.2), [PRESS, away], "direct")
    regularised = lambda _, full, **__: [replace(full, regularised=True)]  # noqa: E731
    monkeypatch.setattr(attempts.Attempts, "_ordered", regularised)
    notes: list[str] = []
    ours, _, found = _run(_pair(model, laws, reach=0.2), [PRESS, away], "condensed", notes)
    assert any("widened" in note for note in notes)
    assert ours[-1].energies["regularisation"] == 0.0
    _close(found, wanted, float(np.abs(wanted).max()))


ELASTIC = make_material("linear-elastic", E=1000.0, nu=0.3)


def test_self_contact() -> None:
    """A hairpin that closes."""

    def make() -> Problem:
        model = hairpin(half=False)
        law = ContactLaw(*LAWS)
        group = "pin.inner"
        folded = Contact(model, group, group, law, self_contact=True, apart=0.3, current_area=False)
        return Problem(model, {"pin": ELASTIC}, [folded])

    ends = {f"pin.{end}": {"x": 0.0, "y": 0.0, "z": z} for end, z in (("upper", -1), ("lower", 1))}
    close = {end: {**axes, "z": 0.202 * axes["z"]} for end, axes in ends.items()}
    slide = {"pin.upper": {"x": 0.02}}
    _same(make, [Step("close", 4, close), Step("slide", 2, slide)])


def test_law_in_python() -> None:
    """A law written in Python: regularised Coulomb friction."""

    def make() -> Problem:
        model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 0.5), (3, 3, 2))})
        plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
        interface = Interface(plane, NormalLaw(penalty=1e5), PythonLaw(Creeping()))
        elastic = make_material("linear-elastic", E=1000.0, nu=0.3)
        return Problem(
            model, {"block": elastic}, [Contact(model, "block.bottom", interface, mortar=False)]
        )

    _same(make, [Step("press", 2, {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}), DRAG])


def test_group_that_turns_in_the_plane() -> None:
    """A turn names the axis across the plane too, along which nothing moves anyway."""

    def make() -> Problem:
        upper = make_shape("rectangle", origin=(0.2, 0.0), size=(1.0, 0.5), cells=(5, 2))
        lower = make_shape("rectangle", origin=(0.0, -0.5), size=(1.5, 0.5), cells=(6, 2))
        bodies = [Body("block", upper), Body("base", lower)]
        model = build_mesh(bodies, idealisation=PlaneStrain())
        contact = Contact(model, "block.bottom", "base.top", ContactLaw(*LAWS), mortar=True)
        return Problem(model, {"block": ELASTIC, "base": ELASTIC}, [contact])

    press = {"base.bottom": {"x": 0.0, "y": 0.0}, "block.top": {"x": 0.0, "y": -0.01}}
    turn = Turn((0, 0, 1), -0.01, point=(0.7, 0.5, 0.0))
    _same(make, [Step("press", 2, press), Step("turn", 2, rotation={"block.top": turn})])


def test_strips_that_bend_together_go_on_as_before() -> None:
    """Bodies that leave what was allowed for are condensed anew and take no more iterations.

    Requirement: as many as with `direct`, 12, as the same nodes stay in reach and both start from
    the same extrapolated state; one more would be rounding. From the last state they take 16.
    """

    def make() -> Problem:
        shape: dict[str, Any] = {"size": (20.0, 1.0), "cells": (12, 1)}
        below = {"up": 0.0, "low": -1.0}
        shapes = {n: make_shape("rectangle", origin=(0, y), **shape) for n, y in below.items()}
        bodies = [Body(name, one) for name, one in shapes.items()]
        model = build_mesh(bodies, idealisation=PlaneStrain())
        law = Friction(coefficients=(0.2, 0.2))
        contact = Contact(model, "up.bottom", "low.top", law, mortar=True)
        soft = make_material("linear-elastic", E=1e4, nu=0.0)
        return Problem(model, dict.fromkeys(below, soft), [contact])

    clamped = {name: {"x": 0.0, "y": 0.0} for name in ("up.left", "low.left")}
    press = Step("press", 1, clamped, pressure={"up.top": 1.0, "low.bottom": 1.0})
    bend = Step("bend", 4, traction={name: {"y": 0.5} for name in ("up.right", "low.right")})
    took = {}
    for name in ("condensed", "direct"):
        accepted, *_ = _run(make(), [press, bend], name, snes_rtol=1e-8)
        took[name] = sum(one.iterations for one in accepted)
    assert took["condensed"] <= took["direct"] + 1


def test_residual_asked_twice() -> None:
    """A line search that goes nowhere asks for a state again: it has the same residual."""
    problem = _pair(_model(n=2))
    problem.begin(PRESS)
    problem.set_load_factor(1.0, 1.0)
    system = Condensed(problem, [PRESS], print).prepare()
    own = system.new_vector()
    first = system.evaluate(own)
    assert first.any()
    np.testing.assert_array_equal(system.evaluate(own), first)
