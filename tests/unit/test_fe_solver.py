"""Steps, supports, loads, and what remains when an increment fails."""

import dataclasses

import numpy as np
import pytest

from anisocontact.base.errors import InputError

PRESS = {"block.top": {"x": 0.0, "y": 0.0, "z": -0.01}}


@pytest.fixture
def block(fe):
    return fe.block(fe.interface(), cells=(2, 2, 1))


def fails_beyond(interface, limit):
    """The interface, with no answer where x > limit."""
    update = interface.update

    def partial(state, x, dt=1.0, *, tangent=True, **more_of_it):
        response = update(state, x, dt, tangent=tangent, **more_of_it)
        beyond = (x[:, 0] > limit).astype(np.int8)
        return dataclasses.replace(response, failure=beyond)

    interface.update = partial
    return interface


@pytest.mark.parametrize(
    ("values", "line"),
    [
        ({"increments": 0}, "step 'a'.increments: 0 given, allowed: 1 to 10000000"),
        ({"increments": 10**20}, f"step 'a'.increments: {10**20} given, allowed: 1 to 10000000"),
        ({"increments": 2.5}, "increments: 2.5 given, a whole number needed"),
        ({"duration": 0.0}, "step 'a'.duration: 0.0 given, must be > 0"),
        (
            {"displacement": {"block.top": {"w": 1.0}}},
            "step 'a'.displacement.block.top.w: no axis 'w', allowed: x, y, z",
        ),
        (
            {"displacement": {"block.top": {"x": float("nan")}}},
            "step 'a'.displacement.block.top.x: nan given, needs a finite number",
        ),
        (
            {"traction": {"block.top": {"x": None}}},
            "step 'a'.traction.block.top.x: None given, needs a finite number",
        ),
    ],
)
def test_wrong_step_is_one_line(fe, values, line):
    """Requirement: bad input is one line that names the field and what is allowed."""
    from anisocontact.solver import Step

    with pytest.raises(InputError) as caught:
        Step("a", **({"increments": 1} | values))
    assert str(caught.value) == line


@pytest.mark.parametrize("number", [np.float32(-0.25), np.int64(-1), np.array(-0.25)])
def test_numbers_of_numpy_are_numbers(fe, number):
    """Requirement: a step takes them as what they are, in the precision of all others.

    Arithmetic of NumPy with a number in single precision stays in single precision: a third of
    the way would be off in the eighth digit. Exact, as -1/4 and -1 are.
    """
    from anisocontact.base.load_curve import history_of
    from anisocontact.solver import Step

    given = Step("a", 1, {"block.top": {"z": number}}).displacement["block.top"]["z"]
    assert history_of(given).at(1.0 / 3.0, 1.0, 0.0) == float(number) * (1.0 / 3.0)


def test_unknown_group_is_found_before_anything_is_solved(block):
    """Requirement: a misspelt facet group suggests the near one, whatever the step."""
    from anisocontact.solver import Solver, Step

    steps = [Step("press", 1, PRESS), Step("drag", 1, {"block.tpo": {"x": 1.0}})]
    with pytest.raises(InputError, match=r"no facet group 'block.tpo'.*did you mean 'block.top'"):
        Solver(block.problem, steps)


def test_two_values_on_shared_nodes(block):
    """Requirement: an edge cannot go two ways; the line names both groups and the values."""
    from anisocontact.solver import Solver, Step

    step = Step("press", 1, PRESS | {"block.left": {"z": 0.5}})
    clash = r"'block.top' prescribes -0.01 and 'block.left' 0.5 for z on 3 shared nodes"
    with pytest.raises(InputError, match=clash):
        Solver(block.problem, [step])


def test_what_is_not_named_is_held(block):
    """Requirement: linear ramp to the value of the step, what is not named stays."""
    from anisocontact.solver import Solver, Step

    steps = [Step("press", 2, PRESS), Step("drag", 4, {"block.top": {"x": 0.02}}, duration=2.0)]
    seen = []
    top = block.model.space.tabulate_dof_coordinates()[:, 2] == 0.5
    for accepted in Solver(block.problem, steps).run():
        u = block.problem.u.x.array.reshape(-1, 3)[top]
        assert np.ptp(u, axis=0).max() < 1e-16
        seen.append((accepted.time, *u[0]))
    expected = [(0.5, 0, 0, -0.005), (1.0, 0, 0, -0.01)]
    expected += [(1.0 + 0.5 * i, 0.005 * i, 0, -0.01) for i in range(1, 5)]
    assert np.allclose(seen, expected, rtol=0.0, atol=1e-14)


def test_traction_ramps_and_is_held(block):
    """Requirement: tractions per reference area, linear ramp; unnamed components are held."""
    from anisocontact.solver import Step

    fixed = {"block.top": {"x": 0.0, "y": 0.0}}
    block.run(Step("press", 1, PRESS))
    block.run(Step("release", 2, {"block.top": {"z": None}}, {"block.top": {"z": -4.0}}))
    force, _ = block.contact.resultant()
    assert force[2] == pytest.approx(4.0, rel=1e-7)
    block.run(Step("shear", 1, fixed, {"block.right": {"y": 1.0}}))
    force, _ = block.contact.resultant()
    total = force + block.problem.reactions()["block.top"]
    assert np.allclose(total, [0.0, -0.5, 4.0], atol=1e-6)


def test_released_support_fades_out(block):
    """Requirement: a released support gives up its force linearly along the step."""
    from anisocontact.solver import Step

    press = block.run(Step("press", 1, PRESS))[-1]
    carried = press.resultants["block.bottom"][0][2]
    along = block.run(Step("release", 4, {"block.top": {"z": None}}))
    forces = [a.resultants["block.bottom"][0][2] for a in along]
    assert np.allclose(forces, carried * np.array([0.75, 0.5, 0.25, 0.0]), atol=1e-6 * carried)


@pytest.mark.parametrize("cause", ["law", "iterations"])
def test_failed_increment_leaves_the_accepted_state(fe, cause, no_detours):
    """Requirement: only converged steps commit; the error says where and why, the rest is kept."""
    from anisocontact.solver import Limits, Solver, Step, StoppedError

    interface = fe.interface()
    if cause == "law":
        interface = fails_beyond(interface, 1.0 + 1e-3)
    block = fe.block(interface, cells=(2, 2, 1))
    options = {"snes_max_it": 3, "snes_rtol": 1e-14} if cause == "iterations" else {}
    block.run(Step("press", 2, PRESS))
    limits = Limits(cuts=0) if cause == "iterations" else Limits(smallest=0.25)
    drag = [Step("drag", 4, {"block.top": {"x": 0.8}})]
    solver = Solver(block.problem, drag, options=options, limits=limits)
    with pytest.raises(StoppedError) as stopped:
        list(solver.run())
    failed = stopped.value
    assert failed.step == "drag"
    assert failed.increment == 1
    u = block.problem.accepted().array
    assert np.array_equal(block.problem.u.x.array, u)
    if cause == "law":
        assert len(failed.points) > 0
        assert failed.points[:, 0].min() > 1.0
        assert "slave points failed, the first at (" in str(failed)
    else:
        assert "no convergence in 3 Newton iterations" in str(failed)


def test_history_is_untouched_by_a_failed_increment(fe):
    """A run goes on after a failure as if it had not been.

    Requirement: history untouched by a failed step. Source: purity of the update. Tolerance: none,
    the states are compared byte by byte and the forces bit by bit. No cuts: of a smaller part one
    correction may be enough.
    """
    from anisocontact.solver import Limits, Solver, Step, StoppedError

    def start():
        block = fe.block(fe.interface(angle=0.4), cells=(2, 2, 1))
        block.run(Step("press", 2, PRESS), Step("drag", 3, {"block.top": {"x": 0.01}}))
        return block

    disturbed, straight = start(), start()
    state, u = disturbed.contact.state.tobytes(), disturbed.problem.u.x.array.copy()
    fail = Step("fail", 1, {"block.top": {"y": 0.5}})
    with pytest.raises(StoppedError):
        once = {"snes_max_it": 1}
        list(Solver(disturbed.problem, [fail], options=once, limits=Limits(cuts=0)).run())
    assert disturbed.contact.state.tobytes() == state
    assert np.array_equal(disturbed.problem.u.x.array, u)

    further = Step("on", 3, {"block.top": {"x": 0.01, "y": 0.01}})
    ends = [block.run(further)[-1].resultants["block.bottom"][0] for block in (disturbed, straight)]
    assert np.array_equal(*ends)


def test_interrupt_of_a_callback_reaches_the_caller(block):
    """Requirement: an interrupt ends the run at the last accepted state, not as PETSc's error."""
    from anisocontact.solver import Solver, Step

    def stop(progress):
        if progress.step == "drag" and progress.iteration == 1:
            raise KeyboardInterrupt

    steps = [Step("press", 1, PRESS), Step("drag", 1, {"block.top": {"x": 0.01}})]
    with pytest.raises(KeyboardInterrupt):
        list(Solver(block.problem, steps).run(stop))
    assert np.array_equal(block.problem.u.x.array, block.problem.accepted().array)
    assert np.abs(block.problem.u.x.array[0::3]).max() < 0.01


def test_progress_tells_iterations_and_contact(block):
    """Requirement: step, increment, iteration, residual and contact counts are reported."""
    from anisocontact.solver import Solver, Step

    seen = []
    accepted = list(Solver(block.problem, [Step("press", 2, PRESS)]).run(seen.append))
    first = [p for p in seen if p.increment == 1]
    assert [p.iteration for p in first] == list(range(accepted[0].iterations + 1))
    assert [p.residual for p in first] == accepted[0].residuals
    assert sum(first[-1].contacts["block.bottom"].values()) == block.contact.areas.size
    assert first[-1].residual < 1e-8


def test_options_prefix_reaches_snes(block):
    """Requirement: users control SNES by its prefix; the database goes before our defaults."""
    from anisocontact.base.fenicsx import PETSc
    from anisocontact.solver import Solver, Step, StoppedError

    options = PETSc.Options("mine_")
    options["snes_max_it"] = 1
    try:
        with pytest.raises(StoppedError, match="no convergence in 1 Newton"):
            list(Solver(block.problem, [Step("press", 1, PRESS)], "mine_").run())
    finally:
        options.delValue("snes_max_it")
    assert len(list(Solver(block.problem, [Step("press", 1, PRESS)], "mine_").run())) == 1


def test_nothing_to_do_needs_no_iteration(block):
    """Requirement: without load there is nothing to solve, and no division by zero."""
    from anisocontact.solver import Step

    (accepted,) = block.run(Step("rest", 1))
    assert accepted.iterations == 0
    assert accepted.energies["external"] == 0.0


def test_body_without_support_is_refused_by_the_solver(fe):
    """Requirement: a run that cannot succeed says so; a body that flies off is never accepted."""
    from anisocontact.solver import Limits, Solver, Step, StoppedError

    far = fe.interface(point=(0.0, 0.0, -5.0))
    block = fe.block(far, cells=(1, 1, 1))
    pull = Step("pull", 1, {}, {"block.top": {"z": 1.0}})
    with pytest.raises(StoppedError):
        list(Solver(block.problem, [pull], limits=Limits(cuts=1)).run())


def test_work_is_stored_and_given_back_in_stick(fe):
    """Pressing, shifting and going back where nothing slips.

    Requirement: balance of energy. Source: first law; for linear laws, whose slip does not turn
    with the slave, the trapezoidal rule is exact,
    and after the way back only the work of the first contact remains stored. Tolerance:
    that of Newton, 1e-8.
    """
    from anisocontact.solver import Step

    rough = fe.interface(
        coefficients=(50.0, 40.0),
        penalty=500.0,
        point=(0.0, 0.0, 0.005),
        evolution="backward-euler",
    )
    block = fe.block(rough, cells=(2, 2, 1))
    hold = {"block.top": {"x": 0.0, "y": 0.0, "z": 0.0}}
    start = block.run(Step("hold", 1, hold))[-1].energies
    away = block.run(Step("away", 3, {"block.top": {"x": 2e-3, "z": -1e-3}}))[-1].energies
    back = block.run(Step("back", 3, hold))[-1].energies
    work = away["external"] - start["external"]
    stored = sum(away[k] - start[k] for k in ("elastic", "adhesion", "normal"))
    assert work == pytest.approx(stored, rel=1e-7)
    assert away["friction"] == 0.0
    assert back["external"] - start["external"] == pytest.approx(0.0, abs=1e-7 * work)


def test_options_read_late_are_seen(fe):
    """An option of MUMPS, read at the first factorisation, reaches it and is taken back.

    Source: PETSc reads `mat_mumps_icntl_<n>` when the factor is made.
    """
    from anisocontact.base.fenicsx import PETSc
    from anisocontact.solver import Step
    from anisocontact.solver.strategies.newton import Newton

    problem = fe.block(fe.interface(), cells=(2, 2, 1)).problem
    newton = Newton(problem, "late_", {"mat_mumps_icntl_14": 77}, lambda *_: None)
    problem.begin(Step("push", 1, PRESS))
    problem.set_load_factor(1.0, 1.0)
    assert not newton.solve(problem.accepted()).reason
    assert newton.snes.getKSP().getPC().getFactorMatrix().getMumpsIcntl(14) == 77
    assert not PETSc.Options("late_").hasName("mat_mumps_icntl_14")
    newton.close()
