"""What a script lets go of gives back its MPI communicators at once, without the garbage collector.

MPICH has 2048 of them, and a problem with its mesh some ten: a process that makes one problem after
the other, and has much in memory that Python seldom looks through, would end without a word.
"""

import gc
import weakref

import pytest

from anisocontact.base.fenicsx import MPI, fem, ufl
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.solver import ContactProblem, Problem, Solver, Step
from anisocontact.surfaces import make_surface

LAW = ContactLaw(
    NormalLaw(penalty=100.0), Adhesion(stiffness=(50.0, 50.0)), Friction(coefficients=(0.3, 0.3))
)
DOWN = Step("down", 1, {"block.top": {"x": 0.01, "y": 0.0, "z": -0.01}})


def box(**more):
    """A block of unit size, and others."""
    return build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1)), **more})


def problem(facets=False, finite=False, **options):
    """A block above a rigid plane, or above another one."""
    base = {"base": BoxSpec((-1, -1, -1), (3, 3, 1), (2, 2, 1))} if facets else {}
    model = box(**base)
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    master = "base.top" if facets else MovingSurface(plane, RigidBody("die", (0, 0, 0)))
    contact = Contact(model, "block.bottom", master, LAW, **options)
    kind = "neo-hookean" if finite else "linear-elastic"
    steel = make_material(kind, E=100.0, nu=0.3)
    return Problem(model, dict.fromkeys(model.body_names(), steel), [contact])


def solved(strategy, **options):
    """The same after a step."""
    one = problem(**options)
    held = {"base.bottom": dict.fromkeys("xyz", 0.0)} if options.get("facets") else {}
    step = Step("down", 1, DOWN.displacement | held)
    solver = Solver(one, [step], strategy=strategy)
    list(solver.run(on_warning=lambda *_: None))
    return one


def script(solve=True):
    """A residual form of a script above a rigid plane."""
    model = box()
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    contact = Contact(model, "block.bottom", MovingSurface(plane, RigidBody("die", (0, 0, 0))), LAW)
    u, v = fem.Function(model.space), ufl.TestFunction(model.space)
    down = fem.Constant(model.mesh, (0.01, 0.0, -0.01))
    top = fem.dirichletbc(down, model.nodes("block.top"), model.space)
    form = ufl.inner(ufl.sym(ufl.grad(u)), ufl.grad(v)) * ufl.dx
    one = ContactProblem(form, u, bcs=[top], contacts=[contact])
    if solve:
        one.solve()
    return one


def left():
    """How many communicators MPI has yet."""
    made = []
    try:
        while len(made) < 5000:
            made.append(MPI.COMM_SELF.Dup())
    except MPI.Exception:
        pass
    for one in made:
        one.Free()
    return len(made)


MADE = {
    "model": box,
    "bodies": problem,
    "facets": lambda: problem(facets=True),
    "points": lambda: problem(facets=True, mortar=False, current_area=True),
    "finite": lambda: solved("direct", finite=True),
    "direct": lambda: solved("direct", facets=True),
    "condensed": lambda: solved("condensed"),
    "iterative": lambda: solved("iterative"),
    "script": lambda: script(solve=False),
    "solved script": script,
}


@pytest.mark.parametrize("name", MADE)
def test_what_is_let_go_of_is_gone(name):
    """Requirement: no problem and no communicator is left, however seldom Python looks for garbage.

    Once before, for what a process makes once; then thrice.
    """
    MADE[name]()
    gc.collect()
    gc.disable()
    try:
        before = left()
        for _ in range(3):
            known = weakref.ref(MADE[name]())
            assert known() is None
        assert left() == before
    finally:
        gc.enable()
