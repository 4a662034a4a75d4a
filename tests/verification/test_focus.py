"""Built-in shapes with fine cells where contact is: places, quality, and Hertz with fewer cells."""

import numpy as np
import pytest

from anisocontact.base.errors import InputError

E, NU = 1000.0, 0.3
STIFF = E / (1.0 - NU**2)


@pytest.fixture(autouse=True)
def _needs_dolfinx(fe):
    """All tests here need DOLFINx."""


FLAT = ("rectangle", "disc", "annulus")
SHAPES = [
    ("disc", {"radius": 1.0, "cells": (16, 3)}, ("whole", "half", "quarter")),
    ("cylinder", {"radius": 1.0, "length": 1.0, "cells": (16, 3, 2)}, ("whole", "half", "quarter")),
    ("ball", {"radius": 1.0, "cells": (16, 3)}, ("ball", "half", "quarter", "eighth")),
]
CASES = [(name, given | {"part": part}) for name, given, parts in SHAPES for part in parts]


@pytest.mark.parametrize(("name", "given"), CASES)
@pytest.mark.parametrize("other", [False, True])
def test_cells_are_as_well_shaped(name, given, other):
    """Every part of every round shape, hexahedra and tetrahedra, focus 0.1.

    Requirement: blocks still meet node by node (the mesh has as many nodes as the even one), and
    the worst scaled Jacobian is that of the even mesh within a tenth, as the angles of the blocks
    are the same. Source: the even mesh. The facets at x = 0 are the smallest.
    """
    from anisocontact.mesh import Body, make_shape
    from anisocontact.mesh.quality import scaled_jacobian

    cells = ("triangle" if name == "disc" else "tetrahedron") if other else None
    kind = {} if cells is None else {"cell": cells}
    even, fine = (
        Body("b", make_shape(name, **given, **kind, focus=f)).arrays() for f in (1.0, 0.1)
    )
    assert len(fine.points) == len(even.points)
    if not other:
        assert scaled_jacobian(fine).min() > 0.9 * scaled_jacobian(even).min()
    facets = fine.points[fine.facets["b.outer"]]
    extent = np.ptp(facets, axis=1)[:, 0]
    middle = facets.mean(axis=1)
    low = np.abs(middle[:, 0]) if name == "disc" else np.hypot(*middle[:, :2].T)
    if name == "cylinder":
        low = np.abs(middle[:, 0])
    near = extent[low < 0.1 + low.min()]
    assert near.max() < 0.4 * extent.max()


def test_ring():
    """Requirement: the cells in the middle of a sector, and opposite of the start of a ring, are a
    fifth of those at the ends, the others between. Source: definition. Tolerance: 1e-9."""
    from anisocontact.mesh import Body, make_shape

    sector, ring = {"start": -2.0, "end": -1.0}, {"length": 1, "cells": (1, 12, 1)}
    for name, given in (
        ("ring", ring),
        ("ring", ring | sector),
        ("annulus", {"cells": (1, 12)} | sector),
    ):
        shape = make_shape(name, inner=1, outer=2, focus=0.2, **given)
        mesh = Body("b", shape).arrays()
        start = given.get("start", 0.0)
        angles = np.mod(np.arctan2(mesh.points[:, 1], mesh.points[:, 0]) - start, 2 * np.pi)
        planes = np.unique(angles.round(9))
        planes = planes[planes < 2 * np.pi - 1e-6]
        sizes = np.diff(planes if "start" in given else [*planes, 2 * np.pi])
        assert len(sizes) == 12
        assert sizes == pytest.approx(sizes[::-1], abs=1e-8)
        assert sizes[:6] / sizes[0] == pytest.approx(0.2 ** (np.arange(6) / 5), abs=1e-7)


@pytest.mark.parametrize("place", [0.0, 0.3, 0.5, 1.0])
def test_zone_of_fine_cells(place):
    """Requirement: planes from 0 to 1 with one at the place; the size of cells grows in the same
    share from one to the next on either side, and is there over the largest what is asked for.

    Source: sizes linear in the distance, x = (e^(g s) - 1)/g. Tolerance: rounding; the ratio of the
    sizes and their jump at the place are met with the first power of the number of cells, the
    ratio to the growth of one cell of 20.
    """
    from anisocontact.mesh.lattice import zoned

    off = []
    for count in (40, 80):
        planes = zoned(count, place, 0.1)
        sizes, at = np.diff(planes), int(np.argmin(abs(planes - place)))
        assert len(sizes) == count
        assert planes[at] == place
        assert (planes[0], planes[-1]) == (0.0, 1.0)
        for side in (sizes[:at][::-1], sizes[at:]):
            if len(side):
                assert side[1:] / side[:-1] == pytest.approx(max(side[1] / side[0], 1.0), rel=1e-9)
        beside = sizes[max(at - 1, 0) : at + 1]
        assert beside.max() < (1.0 + 4.0 / count) * beside.min()
        off.append(abs(sizes.min() / sizes.max() / 0.1 - 1.0))
    assert off[1] < 0.6 * off[0]
    assert off[0] < 0.1 ** (-1.0 / 20.0) - 1.0


ZONES = [
    ("box", {"origin": (0, 0, 0), "size": (2, 3, 1), "cells": (8, 8, 4)}, ("x", "y", "z")),
    ("rectangle", {"origin": (0, 0), "size": (2, 3), "cells": (8, 8)}, ("x", "y")),
    ("disc", {"radius": 1.0, "cells": (16, 8)}, ("out",)),
    ("cylinder", {"radius": 1.0, "length": 2.0, "cells": (16, 8, 8)}, ("out", "z")),
    ("dome", {"radius": 3.0, "rim": 1.0, "height": 2.0, "cells": (16, 8, 8)}, ("out", "z")),
    ("ball", {"radius": 1.0, "cells": (16, 8)}, ("out",)),
    ("ring", {"inner": 1, "outer": 2, "length": 1, "cells": (8, 16, 8)}, ("wall", "around", "z")),
    ("annulus", {"inner": 1, "outer": 2, "cells": (8, 16), "end": 2.0}, ("wall", "around")),
]


@pytest.mark.parametrize(("name", "given", "ways"), ZONES)
def test_zones_of_every_shape(name, given, ways):
    """Requirement: the parameter of each direction makes the smallest cell along it smaller, blocks
    still meet node by node, and a ratio besides or a place outside is one line.

    Source: the even mesh, of whose cells the smallest is 0.4 in the limit of many cells.
    """
    from anisocontact.mesh import Body, make_shape

    def smallest(shape):
        return [np.diff(planes).min() for planes in shape.blocks()[-1].planes]

    plain = make_shape(name, **given)
    even = Body("b", plain).arrays()
    for way in ways:
        shape = make_shape(name, **given, **{f"zone_{way}": (0.5, 0.2)})
        fine = Body("b", shape).arrays()
        assert len(fine.points) == len(even.points)
        assert min(np.divide(smallest(shape), smallest(plain))) < 0.7
        ratio = given | {"ratio": 0.5 if name in ("ball", "disc") else (0.5,) * len(ways)}
        if len(ways) < 3 and name not in ("ball", "disc", "rectangle", "annulus"):
            ratio["ratio"] = (0.5, 0.5)
        for wrong in (given | {f"zone_{way}": (1.5, 0.2)}, ratio | {f"zone_{way}": (0.5, 0.2)}):
            with pytest.raises(InputError, match=f"zone_{way}: "):
                make_shape(name, **wrong)


def test_rings_around_a_circle():
    """Requirement: nodes of the face of a ring lie on the circle of the zone, cells are smallest
    there. Source: definition, a radius of 1.3 between 1 and 2. Tolerance: rounding."""
    from anisocontact.mesh import Body, make_shape

    shape = make_shape("ring", inner=1, outer=2, length=1, cells=(20, 8, 1), zone_wall=(0.3, 0.05))
    radii = np.unique(np.hypot(*Body("b", shape).arrays().points[:, :2].T).round(12))
    sizes = np.diff(radii)
    assert np.abs(radii - 1.3).min() < 1e-12
    assert abs(radii[np.argmin(sizes)] - 1.3) < 2.1 * sizes.min()
    assert sizes.min() < 0.1 * sizes.max()


def pressed(name, way, support, idealisation=None, **given):
    """A part of a disc or ball of radius 1 on a smooth plane: cells, pressure, places, areas."""
    from anisocontact.bulk import make_material
    from anisocontact.contact import Contact
    from anisocontact.interface import Augmentation, Interface
    from anisocontact.laws import Adhesion, Friction, NormalLaw
    from anisocontact.mesh import Body, build_mesh, make_shape
    from anisocontact.solver import Problem, Solver, Step
    from anisocontact.surfaces import make_surface

    options = {} if idealisation is None else {"idealisation": idealisation}
    body = Body("b", make_shape(name, radius=1.0, **given))
    model = build_mesh([body], **options)
    axis = 1 if idealisation is not None else 2
    up = np.eye(3)[axis]
    laws = NormalLaw(penalty=1e6), Adhesion(stiffness=1e3), Friction(coefficients=0.0)
    floor = Interface(make_surface("plane", point=tuple(-up), normal=tuple(up)), *laws)
    contact = Contact(model, "b.outer", floor, mortar=True, augmentation=Augmentation())
    problem = Problem(model, {"b": make_material("linear-elastic", E=E, nu=NU)}, [contact])
    held = support | {"b.top": {"xyz"[axis]: -way}}
    list(Solver(problem, [Step("press", 1, held)]).run())
    cells = model.mesh.topology.index_map(model.mesh.topology.dim).size_global
    return cells, contact, contact.resultant()[0][axis]


def off(contact, distance, radius, peak):
    """Pressure against that of Hertz: mean square over its own, and the largest over the peak."""
    exact = peak * np.sqrt(np.clip(1.0 - (distance / radius) ** 2, 0.0, None))
    weights = contact.areas * (distance < 1.5 * radius)
    error = weights @ (contact.last.pressure - exact) ** 2 / (weights @ exact**2)
    return float(np.sqrt(error)), contact.last.pressure.max() / peak - 1.0


def line(cells, **given):
    """A cylinder on a plane, half contact width 0.045: cells and errors against Hertz."""
    from anisocontact.mesh import PlaneStrain

    held = {"b.left": {"x": 0.0}}
    count, contact, force = pressed(
        "disc", 0.004, held, PlaneStrain(), cells=cells, part="quarter", **given
    )
    radius = np.sqrt(8.0 * force / np.pi / STIFF)
    peak = 4.0 * force / np.pi / radius
    return count, *off(contact, contact.points[:, 0], radius, peak)


def test_a_line_contact_with_a_quarter_of_the_cells():
    """A cylinder on a plane, plane strain, even cells and those with focus and ratio.

    Requirement: the pressure of Hertz from the force that is found, better than by four times as
    many even cells. Source: closed form. Tolerance: mean square 0.06, of six linear cells in half
    of the contact, whose pressure is cut off at a node; peak 0.5 %.
    """
    even, coarse, _ = line((256, 64))
    cells, error, peak = line((160, 24), focus=0.05, ratio=0.03)
    assert cells < 0.27 * even
    assert error < 0.06
    assert error < 0.6 * coarse
    assert abs(peak) < 5e-3


@pytest.mark.slow
def test_a_point_contact_with_a_third_of_the_cells():
    """An eighth of a ball on a plane, contact radius 0.1, even cells and those with focus.

    Requirement: the pressure of Hertz from the force that is found, not worse than by three times
    as many even cells, and the peak to 1 %. Source: closed form. Tolerance: mean square 0.15: the
    edge of the contact lies within a cell, of which there are four along its radius.
    """
    held = {"b.left": {"x": 0.0}, "b.front": {"y": 0.0}}
    found = []
    for cells, given in (((96, 24), {}), ((64, 16), {"focus": 0.05, "ratio": 0.05})):
        count, contact, force = pressed("ball", 0.01, held, cells=cells, part="eighth", **given)
        radius = (3.0 * force / STIFF) ** (1.0 / 3.0)
        peak = 6.0 * force / np.pi / radius**2
        distance = np.hypot(*contact.points[:, :2].T)
        found.append((count, *off(contact, distance, radius, peak)))
    (even, coarse, worse), (cells, error, peak) = found
    assert cells < 0.3 * even
    assert error < min(coarse, 0.15)
    assert abs(peak) < 1e-2 < abs(worse)


def test_mistakes():
    """Requirement: one line. Source: the rule for users' mistakes."""
    from anisocontact.mesh import make_shape

    ring = {"inner": 1, "outer": 2, "length": 1}
    for name, given, said in (
        ("disc", {"radius": 1, "cells": (16, 2), "focus": 2.0}, "must be <= 1"),
        ("disc", {"radius": 1, "cells": (12, 2), "focus": 0.5}, "an even number is needed"),
        ("ring", ring | {"cells": (1, 5, 1), "focus": 0.5}, "an even number is needed"),
        ("ring", ring | {"cells": (1, 4, 1), "focus": 0.5, "ratio": (1, 2, 1)}, "one of the two"),
    ):
        with pytest.raises(InputError, match=said):
            make_shape(name, **given)
