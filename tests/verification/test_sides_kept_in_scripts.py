"""Bodies stay in front of their masters in scripts, too."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pytest
from tests.verification.test_sides_kept import _problem, _state

from anisocontact.base.fenicsx import Vec
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Model
from anisocontact.solver import ContactProblem
from anisocontact.solver.strategies.newton import Newton, NewtonResult
from anisocontact.surfaces import make_surface


def test_a_script_does_not_accept_it_either(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same state in a problem written in UFL: refused, displacement and history as before."""
    from anisocontact.base.fenicsx import fem, ufl

    problem = _problem("plane")
    over = _state(problem, lambda x: x * [1.0, -1.0, -1.0] + [0.0, 1.0, -1e-3]).array.copy()
    contact, space = problem.contacts[0], problem.model.space
    u, v = fem.Function(space), ufl.TestFunction(space)
    form = ufl.inner(make_material("linear-elastic", E=1e3, nu=0.3).stress(u), ufl.grad(v)) * ufl.dx
    script = ContactProblem(form, u, contacts=[contact])

    def thrown(self: Newton, x: Vec, *_: Any) -> NewtonResult:
        x.array[:] = over
        return NewtonResult(1, [0.0], "")

    monkeypatch.setattr(Newton, "solve", thrown)
    with pytest.raises(RuntimeError, match="body 'block' has turned over"):
        script.solve()
    script.close()
    assert not u.x.array.any()
    assert not contact.state["pressure"].any()


@pytest.mark.parametrize("angle", [60.0, 120.0])
def test_a_script_tells_of_faces_that_go_through(
    monkeypatch: pytest.MonkeyPatch, angle: float
) -> None:
    """Requirement: a state with a face below the plane that is no slave is accepted with a warning
    once, as in a case file. A block turned by 120 degrees about a point 0.45 above the plane has
    an upper edge below it, one turned by 60 degrees about a point 1.2 above it has none."""
    from anisocontact.base.fenicsx import fem, ufl

    problem = _problem("plane")
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    turn, pivot = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]), np.array([0.5, 0.0, 0.45])
    rise = 0.0 if angle > 90.0 else 0.75
    turned = _state(problem, lambda x: (x - pivot) @ turn.T + pivot + [0, 0, rise]).array.copy()
    space = problem.model.space
    u, v = fem.Function(space), ufl.TestFunction(space)
    form = ufl.inner(make_material("linear-elastic", E=1e3, nu=0.3).stress(u), ufl.grad(v)) * ufl.dx
    script = ContactProblem(form, u, contacts=[problem.contacts[0]])

    def thrown(self: Newton, x: Vec, *_: Any) -> NewtonResult:
        x.array[:] = turned
        return NewtonResult(1, [0.0], "")

    monkeypatch.setattr(Newton, "solve", thrown)
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        for _ in range(2):
            script.solve()
            u.x.array[:] = 0.0
    script.close()
    about = [str(w.message) for w in told if "lies behind its master" in str(w.message)]
    assert len(about) == (1 if angle > 90.0 else 0)


@pytest.mark.parametrize("master", ["plane", "plate"])
@pytest.mark.parametrize("named", [True, False], ids=["two bodies", "one name"])
def test_a_script_asks_nodes_of_bodies(master: str, named: bool) -> None:
    """Requirement: a block that a soft penalty lets sink in by 0.8 of its height is refused in a
    script as in a case file, whatever its nodes are called; by 0.02 it is not."""
    from anisocontact.base.fenicsx import fem, ufl

    problem = _problem(master)
    model = problem.model
    if not named:  # one name for all cells, as `Model.of` gives
        groups = {f"all.{n.replace('.', '-')}": model.facets(n) for n in model.facet_names()}
        model = Model.of(model.space, groups)
    prefix = ("block.", "base.") if named else ("all.block-", "all.base-")
    soft = ContactLaw(NormalLaw(penalty=1.0), Adhesion(stiffness=1.0), Friction(coefficients=0.2))
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    met = plane if master == "plane" else f"{prefix[1]}top"
    contact = Contact(model, f"{prefix[0]}bottom", met, soft, mortar=False)
    space = model.space
    u, v = fem.Function(space), ufl.TestFunction(space)
    form = ufl.inner(make_material("linear-elastic", E=1e3, nu=0.3).stress(u), ufl.grad(v)) * ufl.dx
    moved = fem.Constant(space.mesh, np.zeros(3))
    rest = fem.Constant(space.mesh, np.zeros(3))
    bcs = [fem.dirichletbc(moved, model.facet_nodes(f"{prefix[0]}top"), space)]
    if master == "plate":
        bcs.append(fem.dirichletbc(rest, model.facet_nodes(f"{prefix[1]}bottom"), space))
    script = ContactProblem(form, u, bcs=bcs, contacts=[contact])
    moved.value[:] = (0.0, 0.0, -0.02)
    script.solve()
    moved.value[:] = (0.0, 0.0, -0.8)
    with pytest.raises(RuntimeError, match=r"is behind its master with|has gone through"):
        script.solve()
    script.close()
