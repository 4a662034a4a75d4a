"""A body that folds onto itself: one side of every fold is the slave of a mortar contact."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
from tests.verification.slid_blocks import force_of, linear_force

from anisocontact.anisotropy import make_directions
from anisocontact.base.errors import InputError
from anisocontact.bulk import make_material
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, Interface
from anisocontact.interface.augmentation import Augmentation
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import Body, BoxSpec, Model, Placement, Rotation
from anisocontact.mesh.arrays import CELL_FACETS, MeshArrays
from anisocontact.mesh.merge import merge
from anisocontact.solver import Problem, Solver, Step
from anisocontact.surfaces import make_surface

Floats = npt.NDArray[np.float64]

GAP, THICKNESS, LEG, WIDTH = 0.4, 0.3, 3.0, 0.6
ALONG, AROUND, ACROSS, THROUGH = 20, 8, 2, 2
HELD = 4  # cells at the end of a leg whose outer side is moved
PENALTY = 2e4
LAWS: dict[str, Any] = {
    "adhesion": Adhesion(stiffness=(1e4, 1e4)),
    "friction": Friction(coefficients=(1e-9, 1e-9)),
}


def hairpin(half: bool) -> Model:
    """A strip bent to a U that opens towards +x, or its upper half: a leg and half of the bend."""
    legs = np.concatenate(
        [np.linspace(LEG, 0.0, ALONG + 1)[:-1], np.linspace(0.0, -np.pi, AROUND + 1)]
    )
    if half:
        legs = legs[: ALONG + AROUND // 2 + 1]
    else:
        legs = np.concatenate([legs, -np.pi - np.linspace(0.0, LEG, ALONG + 1)[1:]])
    depth = np.linspace(0.5 * GAP, 0.5 * GAP + THICKNESS, THROUGH + 1)
    s, y, r = np.meshgrid(legs, np.linspace(0.0, WIDTH, ACROSS + 1), depth, indexing="ij")
    turn = np.clip(-s, 0.0, np.pi)
    x = np.where(s > 0.0, s, np.where(s < -np.pi, -np.pi - s, -r * np.sin(turn)))
    points = np.stack([x, y, r * np.cos(turn)], axis=-1).reshape(-1, 3)
    shape = s.shape
    number = np.arange(s.size).reshape(shape)
    near, far = slice(None, -1), slice(1, None)
    cells = np.stack(
        [
            number[i, j, k].reshape(-1)
            for k in (near, far)
            for j in (far, near)
            for i in (near, far)
        ],
        axis=1,
    )
    place = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, 3)
    sides = cells[:, CELL_FACETS["hexahedron"]].reshape(-1, 4)
    at = place[sides]
    outer = np.all(at[..., 2] == THROUGH, axis=1)
    facets = {
        "pin.inner": sides[np.all(at[..., 2] == 0, axis=1)],
        "pin.upper": sides[outer & np.all(at[..., 0] <= HELD, axis=1)],
    }
    last = shape[0] - 1
    if half:
        facets["pin.cut"] = sides[np.all(at[..., 0] == last, axis=1)]
    else:
        facets["pin.lower"] = sides[outer & np.all(at[..., 0] >= last - HELD, axis=1)]
    bodies = {"pin": np.arange(len(cells))}
    return Model.from_arrays(MeshArrays("hexahedron", 1, points, cells, bodies, facets, 1))


def folding(model: Model, law: ContactLaw, **options: Any) -> Contact:
    """Contact of the inner side of the pin with itself."""
    return Contact(model, "pin.inner", "pin.inner", law, self_contact=True, **options)


def _solve(problem: Problem, *steps: Step) -> list[Mapping[str, Floats]]:
    """Reactions after each increment."""
    return [one.reactions for one in Solver(problem, steps, options={"snes_rtol": 1e-10}).run()]


def _close(model: Model, contact: Any, material: str, depth: float) -> Floats:
    """Force on the upper end after each increment of the ends moving together by twice `depth`."""
    problem = Problem(model, {"pin": make_material(material, E=1000.0, nu=0.3)}, [contact])
    ends = {"pin.upper": {"x": 0.0, "y": 0.0, "z": -depth}}
    if "pin.lower" in model.facet_names():
        ends["pin.lower"] = {"x": 0.0, "y": 0.0, "z": depth}
    else:
        ends["pin.cut"] = {"z": 0.0}
    return np.array([one["pin.upper"] for one in _solve(problem, Step("close", 5, ends))])


@pytest.mark.parametrize("augmented", [False, True], ids=["penalty", "multipliers"])
@pytest.mark.parametrize("material", ["linear-elastic", "neo-hookean"])
def test_hairpin_against_its_half(material: str, augmented: bool) -> None:
    """What closes a hairpin closes its half on a rigid plane, and presses as much.

    Source: symmetry; where the sides overlap by g each half lies g/2 deep in the plane of symmetry,
    so that twice the penalty there gives the same pressure. Without friction, as only the half
    slides. Tolerance 1e-3: normals are those of the slave, which is tilted by 7e-4 at the edge of
    contact, so that the sides push each other along by as much; 1e-5 in the force across and 2e-4
    in the pressures measured.
    """
    finite, exact = material != "linear-elastic", Augmentation() if augmented else None
    depth = 0.5 * GAP + 2e-3
    whole = hairpin(half=False)
    law = ContactLaw(NormalLaw(penalty=PENALTY), **LAWS)
    folded = folding(whole, law, apart=0.3, current_area=finite, augmentation=exact)
    forces = _close(whole, folded, material, depth)
    upper = hairpin(half=True)
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    interface = Interface(plane, NormalLaw(penalty=2.0 * PENALTY), **LAWS)
    options: dict[str, Any] = {"current_area": finite, "augmentation": exact}
    rigid = Contact(upper, "pin.inner", interface, mortar=True, **options)
    expected = _close(upper, rigid, material, depth)
    scale = abs(expected[-1][2])
    assert scale > 3.0 * abs(expected[-2][2])  # the sides meet in the last increment
    assert np.abs(forces[:, 2] - expected[:, 2]).max() < 5e-5 * scale
    assert np.abs(forces - expected).max() < 1e-3 * scale
    most = [np.sort(one.last.pressure)[-15:] for one in (folded, rigid)]
    np.testing.assert_allclose(*most, rtol=1e-3)


def one_body(parts: Sequence[Body], faces: Sequence[str]) -> Model:
    """Parts as one body "c", whose group "faces" has facets of several of them."""
    made = merge([part.arrays() for part in parts])
    facets = {f"c.{name.replace('.', '_')}": rows for name, rows in made.facets.items()}
    facets["c.faces"] = np.concatenate([made.facets[name] for name in faces])
    cells = np.arange(len(made.cells))
    arrays = MeshArrays(
        made.cell, made.degree, made.points, made.cells, {"c": cells}, facets, made.order
    )
    return Model.from_arrays(arrays)


def _parts(cell: str, order: int, gap: float) -> list[Body]:
    upper = BoxSpec((0, 0, gap), (1, 1, 0.5), (4, 4, 2), cell=cell, order=order)
    lower = BoxSpec((0, 0, -0.5), (1, 1, 0.5), (3, 3, 2), cell=cell, order=order)
    return [Body("u", upper), Body("l", lower)]


def _slit(cell: str = "hexahedron", order: int = 1, gap: float = 0.0) -> Model:
    return one_body(_parts(cell, order, gap), ["u.bottom", "l.top"])


def _lips(model: Model, law: ContactLaw | None = None, **options: Any) -> Contact:
    return Contact(model, "c.faces", "c.faces", law or _law(), self_contact=True, **options)


def _law(mu: float = 0.3) -> ContactLaw:
    adhesion = Adhesion(stiffness=(1e3, 1e3))
    return ContactLaw(NormalLaw(penalty=4e4), adhesion, Friction(coefficients=mu))


@pytest.mark.parametrize("gap", [0.0, 0.02])
@pytest.mark.parametrize("augmented", [False, True], ids=["penalty", "multipliers"])
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("cell", ["hexahedron", "tetrahedron"])
def test_patch(cell: str, order: int, augmented: bool, gap: float) -> None:
    """Uniform compression across the faces of a slit, closed or open: 1e-8 at every slave node.

    Source: uniform stress; 4 x 4 on 3 x 3 facets, as of two bodies. The finer face is the slave.
    """
    model, pressure = _slit(cell, order, gap), 10.0
    exact = Augmentation(tangential=False) if augmented else None
    contact = _lips(model, current_area=False, augmentation=exact)
    problem = Problem(model, {"c": make_material("linear-elastic", E=1000.0, nu=0.3)}, [contact])
    held: dict[str, Any] = {f"c.{part}_left": {"x": 0.0} for part in "ul"}
    held |= {f"c.{part}_front": {"y": 0.0} for part in "ul"}
    down = gap + (0.0 if augmented else pressure / 4e4)
    held |= {"c.l_bottom": {"z": 0.0}, "c.u_top": {"z": -(pressure / 1000.0 + down)}}
    upper = np.unique(model.space.dofmap.list[_cells_above(model)])
    _solve(problem, Step("press", 1, held))
    at = model.space.tabulate_dof_coordinates()
    at[upper, 2] -= gap
    strain = 1e-2 * (np.array([0.3, 0.3, -1.0]) * (at + np.array([0.0, 0.0, 0.5])))
    strain[upper, 2] -= down
    slaves = contact.areas > 0.0
    assert contact.areas.sum() == pytest.approx(1.0, rel=1e-12)
    assert set(contact.facet_of_point[slaves]).isdisjoint(contact.facet_of_point[~slaves])
    np.testing.assert_allclose(contact.last.pressure[slaves], pressure, rtol=1e-8)
    assert np.abs(problem.u.x.array.reshape(-1, 3) - strain).max() < 1e-8 * np.abs(strain).max()


def _cells_above(model: Model) -> npt.NDArray[np.int32]:
    """Cells of the upper part of a slit."""
    x = model.space.tabulate_dof_coordinates()[model.space.dofmap.list].mean(axis=1)
    return np.flatnonzero(x[:, 2] > 0.0).astype(np.int32)


def _crack(n: int) -> Model:
    """A block with a closed crack from its right side to the middle; its faces share the front."""
    parts = [
        Body("u", BoxSpec((0, 0, 0), (1, 1, 0.5), (n, 2, n))),
        Body("l", BoxSpec((0, 0, -0.5), (1, 1, 0.5), (n, 2, n))),
    ]
    made = merge([part.arrays() for part in parts])
    x = made.points
    # nodes of the ligament are those of both parts
    joined, key = np.arange(len(x)), np.round(x, 9)
    _, first, which = np.unique(key, axis=0, return_index=True, return_inverse=True)
    whole = (x[:, 2] == 0.0) & (x[:, 0] <= 0.5)
    joined[whole] = first[which.reshape(-1)[whole]]
    kept, number = np.unique(joined, return_inverse=True)
    facets = {f"c.{k.replace('.', '_')}": number[rows] for k, rows in made.facets.items()}
    faces = np.concatenate([facets["c.u_bottom"], facets["c.l_top"]])
    facets["c.faces"] = faces[x[kept][faces][..., 0].min(axis=1) >= 0.5]
    for name in ("c.u_bottom", "c.l_top"):
        del facets[name]
    cells = number[made.cells]
    bodies = {"c": np.arange(len(cells))}
    return Model.from_arrays(MeshArrays("hexahedron", 1, x[kept], cells, bodies, facets, 1))


def test_closed_crack() -> None:
    """A closed crack under pressure is none: uniform stress, 1e-8, up to its front.

    Source: uniform stress has no jump. Facets at the front share nodes with those that they meet;
    the nodes of the front are opposite themselves, and have no pressure of their own.
    """
    model = _crack(4)
    contact = _lips(model, current_area=False, augmentation=Augmentation(tangential=False))
    problem = Problem(model, {"c": make_material("linear-elastic", E=1000.0, nu=0.3)}, [contact])
    held: dict[str, Any] = {f"c.{part}_left": {"x": 0.0} for part in "ul"}
    held |= {f"c.{part}_front": {"y": 0.0} for part in "ul"}
    held |= {"c.l_bottom": {"z": 0.0}, "c.u_top": {"z": -0.01}}
    _solve(problem, Step("press", 1, held))
    strain = 1e-2 * (np.array([0.3, 0.3, -1.0]) * model.space.tabulate_dof_coordinates())
    strain[:, 2] -= 0.005
    beside = (contact.areas > 0.0) & (contact.quadrature.reference[:, 0] > 0.6)
    np.testing.assert_allclose(contact.last.pressure[beside], 10.0, rtol=1e-8)
    assert np.abs(problem.u.x.array.reshape(-1, 3) - strain).max() < 1e-8 * np.abs(strain).max()


def test_sides_of_a_wall_do_not_meet() -> None:
    """A plate thinner than its facets, both faces in the group: pressed flat they meet nothing."""
    plate = Body("p", BoxSpec((0, 0, 0), (1, 1, 0.1), (4, 4, 1)))
    model = one_body([plate], ["p.bottom", "p.top"])
    contact = _lips(model)
    u = np.zeros_like(model.space.tabulate_dof_coordinates())
    u[:, 2] = -0.9 * model.space.tabulate_dof_coordinates()[:, 2]
    contact.update(u, 1.0)
    assert contact.counts()["open"] == len(contact.points)
    assert not contact.current.areas.any()


def _drawn(model: Model, contact: Contact) -> tuple[Floats, Floats]:
    """Resultant and pressures of the upper part pressed down and drawn over two facets below."""
    bodies = model.body_names()
    rubber = make_material("neo-hookean", E=1000.0, nu=0.3)
    held = {("c.l_bottom" if "c" in bodies else "l.bottom"): dict.fromkeys("xyz", 0.0)}
    top = "c.u_top" if "c" in bodies else "u.top"
    press = Step("press", 2, held | {top: {"x": 0.0, "y": 0.0, "z": -0.03}})
    problem = Problem(model, dict.fromkeys(bodies, rubber), [contact])
    _solve(problem, press, Step("drag", 4, {top: {"x": 0.6, "y": 0.1}}))
    return contact.resultant()[0], np.sort(contact.last.pressure)[-12:]


@pytest.mark.parametrize("augmented", [False, True], ids=["penalty", "multipliers"])
def test_slides_as_a_pair(augmented: bool) -> None:
    """Faces that slide on each other with friction, over facets: what two bodies do, 1e-9.

    Source: the same equations once the finer face is the slave, which it stays.
    """
    parts = _parts("hexahedron", 1, 0.02)
    exact = Augmentation() if augmented else None
    one, two = _slit(gap=0.02), Model.from_arrays(merge([part.arrays() for part in parts]))
    found = _drawn(one, _lips(one, reach=0.3, augmentation=exact))
    pair = Contact(two, "u.bottom", "l.top", _law(), mortar=True, reach=0.3, augmentation=exact)
    for a, b in zip(found, _drawn(two, pair), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9 * np.abs(b).max())


def _moved(contact: Contact, model: Model, shift: Floats) -> tuple[Floats, Floats]:
    """Two committed increments of warped faces that slide, the last and one towards a third."""
    rng = np.random.default_rng(3)
    u = np.zeros_like(model.space.tabulate_dof_coordinates())
    for noise in (0.004, 0.002):
        u += 0.5 * shift + noise * rng.normal(size=u.shape)
        contact.update(u, 1.0)
        contact.commit()
    return u, u + 0.05 * shift + 0.001 * rng.normal(size=u.shape)


def _turning() -> ContactLaw:
    rays = make_directions("polar", axis=((5.0, 3.0, 0.0), (0, 0, 1.0)))
    adhesion = Adhesion(stiffness=(60.0, 90.0), directions=rays)
    return ContactLaw(
        NormalLaw(penalty=100.0), adhesion, Friction(coefficients=(0.3, 0.5), directions=rays)
    )


def _star() -> tuple[Model, Floats]:
    """Three bars around a triangle, and the way of their nodes into each other."""
    bars, angles = [], (0.0, 120.0, 240.0)
    for i, angle in enumerate(angles):
        box = BoxSpec((-0.5, 0.3, 0.0), (1.0, 0.5, 0.5), (7, 1, 3))
        bars.append(Body(f"b{i}", box, Placement(rotate=Rotation((0, 0, 1), angle_deg=angle))))
    model = one_body(bars, [f"b{i}.front" for i in range(3)])
    x = model.space.tabulate_dof_coordinates()
    turn = np.deg2rad(np.array(angles))[:, None]
    outward = np.concatenate([-np.sin(turn), np.cos(turn), 0.0 * turn], axis=1)
    return model, -0.1 * outward[np.argmax(x @ outward.T, axis=1)]


@pytest.mark.parametrize(
    ("cell", "order"), [("hexahedron", 1), ("hexahedron", 2), ("tetrahedron", 2), ("three", 1)]
)
def test_tangent(cell: str, order: int) -> None:
    """Second order, and forces that balance, where faces warp and slide, also of three walls.

    Source: central differences, third law. Of three walls that meet in a point no two can all have
    different sides: facets there are slaves of some and masters of others.
    """
    if cell == "three":
        model, shift = _star()
    else:
        model = _slit(cell, order)
        shift = np.zeros_like(model.space.tabulate_dof_coordinates())
        shift[np.unique(model.space.dofmap.list[_cells_above(model)])] = (0.32, 0.13, -0.02)
    contact = _lips(model, _turning())
    _, u = _moved(contact, model, shift)
    way = np.random.default_rng(5).normal(size=u.shape)
    force = force_of(contact, u)
    assert contact.counts()["slip"] + contact.counts()["stick"] > 4
    assert np.abs(force.sum(axis=0)).max() < 1e-12 * np.abs(force).sum()
    exact, errors = linear_force(contact, way), []
    for h in (1e-5, 1e-6):
        found = (force_of(contact, u + h * way) - force_of(contact, u - h * way)) / (2.0 * h)
        errors.append(np.abs(found - exact).max() / np.abs(exact).max())
    assert errors[1] < max(errors[0] / 50.0, 2e-8)


def test_goes_on_from_what_it_kept() -> None:
    """A contact that takes over the state of another one answers as that does, exactly."""
    model, shift = _star()
    first, second = (_lips(model, _turning()) for _ in range(2))
    kept, u = _moved(first, model, shift)
    second.restore(first.persistent(), kept)
    assert np.array_equal(force_of(first, u), force_of(second, u))


def test_what_is_given_is_checked() -> None:
    """A group against itself needs to say so; the distance has to be positive."""
    model = hairpin(half=False)
    law = ContactLaw(NormalLaw(penalty=PENALTY), **LAWS)
    with pytest.raises(InputError, match=r"master: .*share 96 facets"):
        Contact(model, "pin.inner", "pin.inner", law=law, mortar=False)
    with pytest.raises(InputError, match=r"apart: -1.0 given, must be > 0"):
        folding(model, law, apart=-1.0)
    with pytest.raises(InputError, match=r"degree: given, but slave nodes have no quadrature"):
        folding(model, law, degree=3)
