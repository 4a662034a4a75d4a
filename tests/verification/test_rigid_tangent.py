"""Rows and columns of free rigid bodies: the tangent is the derivative of the residual."""

import numpy as np
import pytest
from tests.conftest import errors_and_status

SPRINGS = {"x": 30.0, "y": 20.0, "z": 40.0, "rx": 3.0, "ry": 2.0, "rz": 4.0}
SURFACES = {
    "plane": {"point": (0.0, 0.0, 0.0), "normal": (0.0, 0.0, 1.0)},
    "sphere": {"centre": (0.45, 0.55, -2.0), "radius": 2.0},
    "cylinder": {"point": (0.0, 0.5, -1.5), "axis": (1.0, 0.0, 0.0), "radius": 1.5},
}
FREE = ("x", "y", "z", "rx", "ry", "rz")
#: States that are tried.
SEEDS = range(60)


def interface(surface, coefficients, seed, on="master"):
    """Anisotropic adhesion and friction on a surface, axes at random angles."""
    from anisocontact.anisotropy import make_directions
    from anisocontact.interface import Interface
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.surfaces import make_surface

    angles = np.random.default_rng(seed).uniform(0.0, np.pi, 2)
    fields = [make_directions("constant", vector=(1.0, 0.0, 0.0), angle=a) for a in angles]
    return Interface(
        make_surface(surface, **SURFACES[surface]),
        NormalLaw(penalty=1e3),
        Adhesion(stiffness=(900.0, 300.0), directions=fields[0], directions_on=on),
        Friction(coefficients=coefficients, directions=fields[1], directions_on=on),
    )


def state(fe, seed, surface, coefficients, lift, free, current_area, on="master"):
    """Block on a free body, both displaced at random over a random history."""
    from anisocontact.rigid import RigidBody
    from anisocontact.solver import Step

    rng = np.random.default_rng(seed)
    body = RigidBody("die", (0.3, 0.6, -0.8), free=True, springs=SPRINGS)
    law = interface(surface, coefficients, seed, on)
    block = fe.block(law, cells=(2, 2, 1), young=10.0, body=body, current_area=current_area)
    motion = {"die": dict.fromkeys(free)}
    block.problem.begin(Step("random", 1, {"block.top": {"x": 0.1}}, motion=motion))
    block.problem.set_load_factor(1.0, 1.0)
    x = block.problem.accepted()
    for scale in (0.02, 0.01):
        block.problem.commit(x)
        x = x.copy()
        x.array[:] += scale * rng.standard_normal(x.getSize())
        x.array[-4] += lift
    direction = block.problem.new_vector()
    direction.array[:] = rng.standard_normal(x.getSize())
    return block, x, direction


def first_errors(states, steps, statuses):
    """Errors of the first state with these statuses, all of which stay along its direction."""
    for block, x, direction in states:
        found, same, seen = errors_and_status(block.problem, block.contact, x, direction, steps)
        if same and set(seen.tolist()) == statuses:
            return found
    return pytest.fail("no such state found")


@pytest.mark.parametrize("surface", SURFACES)
@pytest.mark.parametrize(
    ("statuses", "coefficients", "lift"),
    [
        ({0, 1, 2}, (0.4, 0.15), 0.0),
        ({0}, (0.4, 0.15), -0.2),
        ({1}, (90.0, 80.0), 0.1),
        ({2}, (0.02, 0.01), 0.1),
    ],
    ids=["all", "open", "stick", "slip"],
)
@pytest.mark.parametrize("current_area", [False, True], ids=["reference", "current"])
def test_second_order_of_the_central_difference(
    fe, surface, statuses, coefficients, lift, current_area
):
    """Halving the step quarters the error of the central difference against the tangent.

    Requirement: exact tangent for translation and turn of a free body, for open, sticking and
    slipping points, from accepted states that are turned. Source: Taylor. Tolerance: the ratio of
    two errors is 4 (1 + O(h^2)); 0.15 as for bodies alone. Directions have components of all
    nodes, of the translation and of the turn. In stick the residual is so nearly linear that the
    steps are larger, to stay above round-off.
    """
    first = 4e-4 if statuses == {1} else 2e-5
    steps = [first * 0.5**k for k in range(3)]
    states = (state(fe, seed, surface, coefficients, lift, FREE, current_area) for seed in SEEDS)
    found = first_errors(states, steps, statuses)
    if statuses == {0}:
        assert found[0] < 1e-9
    else:
        assert np.all(np.abs(found[:-1] / found[1:] - 4.0) < 0.15)
    assert found[0] < 1e-2


@pytest.mark.parametrize("component", range(6))
def test_single_columns(fe, component):
    """Each component alone, so that a small column cannot hide behind large ones.

    Requirement and source as above; the column must agree to 1e-6 of its own size at the smallest
    step, which the second order reaches.
    """

    def along(seed):
        block, x, direction = state(fe, seed, "sphere", (0.4, 0.15), 0.0, FREE, True)
        direction.array[:] = 0.0
        direction.array[component - 6] = 1.0
        return block, x, direction

    found = first_errors(map(along, SEEDS), [1e-4, 5e-5], {0, 1, 2})
    assert found[1] < 1e-6
    assert found[0] / found[1] > 3.5 or found[0] < 1e-10


def test_prescribed_components(fe):
    """Rows of prescribed components are those of supports, their columns stay.

    Requirement: tangent exact also where some components are prescribed. Source: Taylor.
    """
    steps = [2e-5 * 0.5**k for k in range(3)]
    states = (state(fe, seed, "plane", (0.4, 0.15), 0.0, ("z", "ry"), False) for seed in SEEDS)
    found = first_errors(states, steps, {0, 1, 2})
    assert np.all(np.abs(found[:-1] / found[1:] - 4.0) < 0.15)


@pytest.mark.parametrize("current_area", [False, True], ids=["reference", "current"])
def test_directions_on_the_slave(fe, current_area):
    """Tangent where the block carries the directions, on a body that moves and turns.

    Requirement, source and tolerance as of the first test; the traction then depends on the
    tangents of the slave, too, as they lie on the body.
    """
    steps = [2e-5 * 0.5**k for k in range(3)]
    states = (
        state(fe, seed, "sphere", (0.4, 0.15), 0.0, FREE, current_area, "slave") for seed in SEEDS
    )
    found = first_errors(states, steps, {0, 1, 2})
    assert np.all(np.abs(found[:-1] / found[1:] - 4.0) < 0.15)
    assert found[0] < 1e-2
