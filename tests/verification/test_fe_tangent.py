"""The assembled tangent is the derivative of the assembled residual."""

import numpy as np
import pytest
from tests.conftest import errors_and_status

RULES = [
    ("maximum-dissipation", {}),
    ("explicit", {"history": "centre"}),
    ("radial", {}),
]


def random_vector(problem, rng, scale):
    x = problem.new_vector()
    x.array[:] = scale * rng.standard_normal(x.getSize())
    return x


def random_state(fe, seed, rule, of_rule, **block):
    """Block with a random history and random displacements: open, sticking and slipping points."""
    from anisocontact.solver import Step

    rng = np.random.default_rng(seed)
    interface = fe.interface(
        stiffness=(900.0, 300.0),
        coefficients=(0.4, 0.15),
        penalty=1e3,
        angle=rng.uniform(0.0, np.pi),
        adhesion_angle=rng.uniform(0.0, np.pi),
        rule=rule,
        **of_rule,
    )
    made = fe.block(interface, young=10.0, **block)
    made.problem.begin(Step("random", 1, {"block.top": {"x": 0.1, "z": -0.02}}))
    made.problem.set_load_factor(1.0, 1.0)
    x = made.problem.accepted()
    for scale in (0.02, 0.01):
        made.problem.commit(x)
        x += random_vector(made.problem, rng, scale)
    return made, x, random_vector(made.problem, rng, 1.0)


@pytest.mark.parametrize(("rule", "of_rule"), RULES, ids=[r[0] for r in RULES])
@pytest.mark.parametrize(("cell", "order"), [("hexahedron", 1), ("tetrahedron", 2)])
@pytest.mark.parametrize("seed", range(4))
def test_second_order_of_the_central_difference(fe, rule, of_rule, cell, order, seed):
    """Halving the step quarters the error of the central difference against the tangent.

    Requirement: exact tangent, checked by order of convergence on random states with open,
    sticking and slipping points together. Source: Taylor. Tolerance: the ratio of two errors is
    4 (1 + O(h^2)); steps are small enough that no point changes its status and large enough that
    round-off stays below a hundredth of the error, so 4 +- 0.15 holds.
    """
    steps = [1e-5 * 0.5**k for k in range(3)]
    # States in which all three occur and no point stands just before a change.
    for attempt in range(20):
        block, x, direction = random_state(
            fe, 100 * seed + attempt, rule, of_rule, cell=cell, order=order
        )
        errors, same, status = errors_and_status(block.problem, block.contact, x, direction, steps)
        if same and set(status) == {0, 1, 2}:
            break
    else:
        pytest.fail("no such state found")
    assert np.all(np.abs(errors[:-1] / errors[1:] - 4.0) < 0.15)
    assert errors[0] < 1e-2


@pytest.mark.parametrize("status", ["open", "stick"])
def test_linear_statuses(fe, status):
    """Where all points are open, or all stick, the residual is linear.

    Requirement: tangent exact in every status. Source: t = 0, or t linear in x. Tolerance: the
    central difference of a linear function is exact but for round-off, 1e-16 / h.
    """
    rng = np.random.default_rng(3)
    height = {"open": -0.1, "stick": 0.1}[status]
    interface = fe.interface(
        coefficients=(90.0, 80.0), angle=0.4, adhesion_angle=1.0, point=(0.0, 0.0, height)
    )
    block = fe.block(interface)
    block.problem.set_load_factor(1.0, 1.0)
    x = random_vector(block.problem, rng, 1e-3)
    direction = random_vector(block.problem, rng, 1.0)
    errors, same, found = errors_and_status(block.problem, block.contact, x, direction, [1e-4])
    assert same
    assert set(found) == {{"open": 0, "stick": 1}[status]}
    assert errors[0] < 1e-10
