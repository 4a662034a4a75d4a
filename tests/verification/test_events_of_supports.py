"""Steps that end where elastic supports, symmetry planes or springs carry a force."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.verification.block_of_events import NU, PENALTY, PRESS, E, block, run, stiffness

from anisocontact.solver import ElasticSupport, Spring, Step, Until


def check_elastic_support(strategy: str) -> None:
    """Lift a block on a bed off a plane by its top, then press it on it, each to a force."""
    bed, lift, press = 500.0, 0.01, -0.01
    forces = {"lift": -1.5, "press": 0.1}
    events = {
        name: Until(reaction="block.bottom", value=force, along=(0, 0, 1))
        for name, force in forces.items()
    }
    found = run(
        block(attached=[ElasticSupport("block.bottom", normal=bed)]),
        Step("lift", 3, {"block.top": {"x": 0.0, "y": 0.0, "z": lift}}, until=events["lift"]),
        Step("rest", 1),
        Step("press", 3, {"block.top": {"z": press}}, until=events["press"]),
        strategy=strategy,
    )
    up, down = (a for a in found if a.event)
    carried = {a.step: a.reactions["block.bottom"][2] for a in (up, down)}
    assert carried == pytest.approx(forces, rel=1e-3)
    inner, below = E / 0.5, {"lift": bed, "press": bed + PENALTY}
    tops = {name: -force / bed * (1.0 + below[name] / inner) for name, force in carried.items()}
    assert lift * up.time == pytest.approx(tops["lift"], rel=1e-9)
    part = down.time - up.time - 1.0
    assert tops["lift"] + (press - tops["lift"]) * part == pytest.approx(tops["press"], rel=1e-9)


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
def test_force_of_an_elastic_support_is_reached(strategy: str):
    """A block on a bed, lifted off a plane by its top and then pressed on it, each to a force.

    Requirement: the bed carries k u, the force waited for to 1e-3; the top is where springs in
    series say so, to 1e-9 of that force. The second force is of the other sign, and contact is a
    spring beside the bed then. Source: Hooke. Tolerance: that of the event; Newton.
    """
    check_elastic_support(strategy)


@pytest.mark.mpi
@pytest.mark.slow
@pytest.mark.parametrize("strategy", ["direct", "iterative"])
def test_force_of_an_elastic_support_on_two_processes(strategy: str):
    """Requirement, source, tolerance: as on one, of the sum over both."""
    if shutil.which("mpirun") is None:
        pytest.skip("no mpirun")
    script = (
        "from tests.verification.test_events_of_supports import check_elastic_support as check; "
    )
    command = ["mpirun", "-n", "2", sys.executable, "-c", f"{script}check({strategy!r})"]
    command = ["timeout", "-k", "5", "300", *command]
    root = Path(__file__).parents[2]
    done = subprocess.run(command, cwd=root, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
def test_supports_of_one_group_are_counted_together(strategy: str):
    """A block pressed by a top that has a bed as well, until its supports carry a force.

    Requirement: support and bed balance the block together, so that the top is where it is without
    a bed: force over stiffness, 1e-9 of the force that is met to 1e-3. Source: springs in series.
    """
    until = Until(reaction="block.top", value=4.0)
    problem = block(attached=[ElasticSupport("block.top", normal=300.0)])
    press = run(problem, Step("press", 2, PRESS, until=until), strategy=strategy)[-1]
    force = press.reactions["block.top"][2]
    assert press.event and force == pytest.approx(-4.0, rel=1e-3)
    assert press.time == pytest.approx(-force / stiffness() / 0.01, rel=1e-9)


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
def test_force_of_a_symmetry_plane_is_reached(strategy: str):
    """A block between two symmetry planes, pressed until one of them carries a force.

    Requirement: the plane carries nu p per area, 1e-3. Source: no strain along x, free along y:
    sigma_x = nu sigma_z. Tolerance: that of the event. Only a part of the displacements is known to
    the strategy `condensed`, whose events saw no force of such planes.
    """
    planes = ["block.left", "block.right", "block.front"]
    until = Until(reaction="block.left", value=0.3)
    top = {"block.top": {"z": -0.01}}
    problem = block(nu=NU, symmetry=planes, mu=0.0)
    press = run(problem, Step("press", 2, top, until=until), strategy=strategy)[-1]
    assert press.reactions["block.left"] == pytest.approx([0.3, 0.0, 0.0], rel=1e-3, abs=1e-9)
    assert press.reactions["block.top"][2] == pytest.approx(-0.6 / NU, rel=1e-3)


@pytest.mark.parametrize("strategy", ["direct", "condensed", "iterative"])
def test_force_of_a_spring_is_reached(strategy: str):
    """A block, clamped on its left, pulled by a spring whose anchor moves, and then let go.

    Requirement: the force waited for to 1e-3, in trials as in the accepted state, and the anchor
    where springs in series say, 1e-9. Source: Hooke. Tolerance: that of the event.
    """
    stiff, own = 2000.0, E * 0.5
    problem = block(height=1.0, attached=[Spring("pull", "block.right", (stiff, 0.0, 0.0))])
    fixed = {"block.left": dict.fromkeys("xyz", 0.0)}
    found = run(
        problem,
        Step("pull", 2, fixed, anchor={"pull": {"x": 0.1}}, until=Until(reaction="pull", value=20)),
        Step("back", 2, anchor={"pull": {"x": 0.0}}, until=Until(reaction="pull", value=5.0)),
        strategy=strategy,
    )
    pull, back = (a for a in found if a.event)
    forces = [a.reactions["pull"][0] for a in (pull, back)]
    assert forces == pytest.approx([20.0, 5.0], rel=1e-3)
    anchors = 0.1 * pull.time * np.array([1.0, 1.0 - (back.time - pull.time)])
    assert anchors == pytest.approx(np.array(forces) * (1.0 / stiff + 1.0 / own), rel=1e-9)
