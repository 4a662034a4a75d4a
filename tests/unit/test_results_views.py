"""Pictures of the report: where they look from, what they cut open and what they show."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import pyvista
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.quiver import Quiver
from matplotlib.text import Text

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.base.figure_style import new_figure
from anisocontact.interface import STATUS
from anisocontact.results.dataset import DataSet, polygons, vertices
from anisocontact.results.deformed import SHOWN, caption, surfaces
from anisocontact.results.report import along, curves, maps
from anisocontact.results.report.frame import ContactView, axis_name
from anisocontact.results.report.run_data import Moment
from anisocontact.results.report.shape import Drawings
from anisocontact.results.section_plane import SectionPlane
from anisocontact.results.solids import Solid


def test_stress_is_shown_where_it_is_largest():
    """A bar whose middle is at the stress 8 inside: it is cut open there, on the far side in y."""
    grid = pyvista.ImageData(dimensions=(5, 5, 5)).cast_to_unstructured_grid()
    inside = np.all(grid.points == 2.0, axis=1)
    grid.point_data["displacement"] = np.zeros((125, 3))
    grid.point_data["von_mises"] = np.where(inside, 8.0, 1.0)
    grid.point_data["principal_stress"] = np.where(inside[:, None], [1.0, 0.0, -8.0], [3.0, 2, 1])
    for name, most in (("von_mises", 8.0), ("principal_stress", -8.0)):
        drawn = surfaces(Solid(grid), 1.0, SHOWN[name])
        skin, before = drawn.skin, drawn.before
        value = skin.values("value")
        assert value[np.argmax(abs(value))] == most
        assert skin.bounds[2] == 2.0
        assert before.bounds[2] == 0.0
    assert SHOWN["von_mises"].limits(np.array([1.0, 8.0])) == (0.0, 8.0)
    assert SHOWN["principal_stress"].limits(np.array([-8.0, 3.0])) == (-8.0, 8.0)


def _block(*largest: float) -> pyvista.DataSet:
    """A block of 4 by 4 by 4 without stress but at a node."""
    grid = pyvista.ImageData(dimensions=(5, 5, 5)).cast_to_unstructured_grid()
    there = np.all(grid.points == largest, axis=1)
    grid.point_data["displacement"] = np.zeros((125, 3))
    grid.point_data["principal_stress"] = np.where(there[:, None], [9.0, 0, 0], [0.0, 0, 0])
    return grid


@pytest.mark.parametrize(
    ("largest", "cut", "bounds"),
    [
        ((2, 1, 2), (1, 1.0, -1.0), (0, 4, 1, 4)),
        ((1, 4, 4), (0, 1.0, -1.0), (1, 4, 0, 4)),
        ((3, 3, 0), (1, 3.0, 1.0), (0, 4, 0, 3)),
        ((4, 4, 0), (1, 4.0, 1.0, False), (0, 4, 0, 4)),
        ((4, 0, 2), None, (0, 4, 0, 4)),
        ((0, 4, 2), None, (0, 4, 0, 4)),
    ],
)
def test_a_cut_leaves_bodies_to_look_at(largest, cut, bounds):
    """Largest in front, at the back on the left, at the back on the right, and on faces in sight.

    Requirement: a cut through the largest value that leaves 0.45 of the nodes or more; the heading
    says where it is and from where it is seen, and the largest value is on what is drawn. Source:
    a cut along y alone left nothing but a face where the largest value was at the back.
    """
    grid = Solid(_block(*largest))
    drawn = surfaces(grid, 1.0, SHOWN["principal_stress"])
    assert drawn.cut == (None if cut is None else SectionPlane(*cut))
    assert drawn.skin.bounds[:4] == bounds
    assert drawn.skin.values("value").max() == 9.0
    heading = caption(1.0, drawn.cut)
    assert ("cut open" in heading) == (cut is not None and len(cut) == 3)
    if cut is not None:
        name, side = "xyz"[cut[0]], "+" if cut[2] > 0 else "-"
        assert len(cut) == 4 or f"cut open at {name} = {cut[1]:g} " in heading
        assert f"seen from {side}{name}" in heading


def test_a_body_without_stress_is_seen(tmp_path):
    """A block whose stress is zero but at a node: it is not white on white, and has its colours.

    Requirement: a tenth of the picture has the colour of zero, to the rounding of a byte, and that
    colour is told from white. Source: the scale of colours, which light on the surface changed.
    """
    _block(2, 2, 2).save(tmp_path / "grid.vtu")
    with Drawings(tmp_path / "grid.vtu", tmp_path, ["principal_stress"], {}) as drawings:
        drawings.finish("principal_stress")
    zero = np.round(255 * np.array(colormaps[SHOWN["principal_stress"].colours](0.5)[:3]))
    assert zero.max() < 235
    picture = np.round(255 * imread(tmp_path / "principal_stress.png")[..., :3])
    assert np.mean(np.abs(picture - zero).max(axis=-1) <= 2) > 0.1


def test_a_view_of_a_closed_master():
    """All around a bar along z: seen from the front, without the points behind."""
    angle = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False) + 0.01
    normal = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    view = ContactView(_touching(3.0 * normal, normal), 0)
    assert view.closed
    assert view.frame.names() == ("x", "z")
    assert len(view.position) == 20
    assert np.all(view.position[:, 1] < 0.0)
    # Half of the way around there is a mean normal to look along.
    half = normal[normal[:, 0] > 0.0]
    assert not ContactView(_touching(3.0 * half, half), 0).closed


def _touching(places, normals, **data):
    """Slave points that touch."""
    count = len(places)
    data |= {"normal": normals, "contact": np.zeros(count, dtype=int), "area": np.ones(count)}
    data["status"] = np.ones(count, dtype=int)
    return DataSet("PolyData", places, vertices(np.arange(count)), data)


@pytest.mark.parametrize(
    ("direction", "name"),
    [
        ((0.9999, 0.004, 0.0), "x"),
        ((0.6, -0.8, -2.46e-5), "(0.6, -0.8, 0)"),
        ((0.8, 0.6, -1e-20), "(0.8, 0.6, 0)"),
        ((0.0, 0.6, 0.8), "(0, 0.6, 0.8)"),
    ],
)
def test_names_of_directions_have_no_rounding(direction, name):
    """Requirement: a label has no digits that nobody can see in the picture, as of 2.46e-05."""
    assert axis_name(np.array(direction)) == name


@pytest.mark.parametrize(("radius", "shown"), [(0.1, 0.16), (0.35, 0.5)])
def test_a_small_contact_is_seen_alone(radius, shown):
    """Points on a square of which a disc touches: of a small one the maps show a close-up.

    Requirement: what touches fills more than half of the map, and so does the whole slave where
    that is nearly as small; panels are of one shape, and more arrows than one stand in it. Source:
    of a ball on a race nothing but a grey disc with a dot was seen. Tolerance: the spacing of the
    points, 0.02, and the room of a facet.
    """
    side = np.linspace(-0.5, 0.5, 51)
    places = np.stack(np.meshgrid(side, side, [0.0]), axis=-1).reshape(-1, 3)
    inside = np.linalg.norm(places, axis=1) < radius
    data = {"pressure": 1.0 * inside, "traction_principal": np.ones((len(places), 2))}
    data |= {f"direction_friction_{i + 1}": np.tile(np.eye(3)[i], (51**2, 1)) for i in range(2)}
    points = _touching(places, np.tile([0.0, 0.0, 1.0], (51**2, 1)), **data)
    points.point_data["area"][:] = 0.02**2
    points.point_data["status"][:] = inside
    view = ContactView(points, 0)
    moments = [Moment("drag, increment 4", 1, 1)]
    run = SimpleNamespace(moments=moments, steps=[0], ends=lambda: moments, view=lambda *_: view)
    run.mixed = lambda _: moments
    for draw in (maps.pressure, maps.status, maps.traction):
        figure = draw(run, 0)
        axes = figure.axes[0]
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        assert right == pytest.approx(shown, abs=0.1)
        assert (right - left, left) == pytest.approx((top - bottom, -right))
    (quiver,) = [one for one in axes.collections if isinstance(one, Quiver)]
    assert quiver.N > 12


@pytest.mark.parametrize(("end", "shown"), [(1.0, (0.0, 2.5)), (15.0, None)])
def test_curves_show_what_touches(end: float, shown: tuple[float, float] | None) -> None:
    """An outline from 0 to 20 of 41 points that touches up to some place.

    Requirement: where contact is little of it, the curves show that alone, and three spacings of
    0.5 around it: of a ball on a block twelve points of 41 stood within a twentieth of the width.
    """
    places = np.column_stack([np.linspace(0.0, 20.0, 41), np.zeros((41, 2))])
    points = _touching(places, np.tile([0.0, 1.0, 0.0], (41, 1)))
    points.point_data["status"][:] = places[:, 0] <= end
    axes = Figure().subplots()
    axes.set_xlim(-1.0, 21.0)
    along._close_up(axes, [ContactView(points, 0)])
    assert axes.get_xlim() == pytest.approx(shown or (-1.0, 21.0))


@pytest.mark.parametrize(("height", "rows"), [(0.1, 1), (0.3, 2)])
def test_arrows_stand_in_the_middle_of_what_they_stand_for(height: float, rows: int) -> None:
    """A strip of points, 1 long: its arrows are spread over its height.

    Requirement: no arrow is cut by the border of the map, as those of a belt were, which stood on
    its lower edge. Tolerance: the spacing of the points, 0.01.
    """
    x, y = np.meshgrid(
        np.linspace(0.0, 1.0, 101), np.linspace(0.0, height, round(100 * height) + 1)
    )
    places = np.column_stack([x.ravel(), y.ravel()])
    shown = places[maps._spread(places)]
    middles = (np.arange(rows) + 0.5) / rows if rows == 1 else 0.5 + np.array([-0.5, 0.5]) / 1.8
    assert np.allclose(np.unique(shown[:, 1]), height * middles, atol=0.01)
    assert len(shown) == 6 * rows


@pytest.mark.parametrize(("tilt", "name"), [(8.0, "z"), (20.0, "(0, 0.342, 0.94)")])
def test_a_contact_that_is_nearly_level_is_seen_along_an_axis(tilt, name):
    up = np.tile([0.0, np.sin(np.radians(tilt)), np.cos(np.radians(tilt))], (10, 1))
    view = ContactView(_touching(np.random.default_rng(5).uniform(size=(10, 3)), up), 0)
    assert view.frame.normal_name == name


def test_values_at_nodes_are_drawn_between_them():
    """A square of which three nodes touch, beside a triangle that is open, and two loose points."""
    places = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [5, 5, 0], [6, 5, 0]])
    points = _touching(places.astype(float), np.tile([0.0, 0, 1], (7, 1)), covered=np.ones(7))
    points.point_data["status"][[2, 4]] = 0
    points.point_data["contact"][5:] = 1
    cells = polygons(np.array([[0, 1, 2, 3]]), np.array([[1, 4, 2]]))
    view = ContactView(replace(points, cells=cells), 0)
    axes = new_figure(3.0, 3.0).subplots()
    image = view.draw_touching(axes, np.arange(5.0))
    # four triangles around the middle of the square, and that of which one node touches
    assert len(image.get_paths()) == 5
    assert axes.get_xlim()[1] < 4.0
    assert ContactView(replace(points, cells=cells), 1).position.tolist() == places[5:].tolist()


def test_points_that_have_never_seen_their_master_are_seen_across_their_plane():
    place = np.random.default_rng(4).uniform(size=(20, 3)) * [1.0, 0.0, 2.0]
    view = ContactView(_touching(place, np.zeros((20, 3))), 0)
    assert not view.closed
    assert view.frame.names() == ("x", "z")


def test_names_of_short_steps_do_not_hide_each_other():
    """Three steps of which the first two go hardly anywhere: one label for both."""
    axes = new_figure(6.0, 4.0).subplots()
    steps = [("touch", np.array([0])), ("load", np.array([1, 2])), ("turn", np.array([3, 4]))]
    run = SimpleNamespace(steps=steps)
    curves._name_steps(run, axes, np.array([0.0, 1e-3, 1.5e-3, 2e-3, 5.0, 10.0]))
    assert [text.get_text() for text in axes.texts] == ["turn", "touch, load"]
    curves._name_steps(run, axes, np.array([0.0, 0.9, 1.0, 1.8, 5.0, 10.0]))
    assert [text.get_text() for text in axes.texts[2:]] == ["turn", "touch", "load"]


@pytest.mark.parametrize("height", [0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 1.0])
def test_no_text_of_a_map_is_cut_off(height):
    """Points on a line, as of a mesh in the plane, in a strip and in a square: titles, labels of
    axes and of the scale of colours lie within the picture. Tolerance: a pixel."""
    places = np.random.default_rng(3).uniform(size=(60, 3)) * [1.0, height, 0.0]
    data = {"pressure": np.ones(60), "traction_principal": np.ones((60, 2))}
    data |= {f"direction_friction_{i + 1}": np.tile(np.eye(3)[i], (60, 1)) for i in range(2)}
    points = _touching(places, np.tile([0.0, 0.0, 1.0], (60, 1)), **data)
    points.point_data["area"][:] = 1e-3
    view = ContactView(points, 0)
    moments = [Moment("drag, increment 4", 1, 1)]
    run = SimpleNamespace(moments=moments, steps=[0], ends=lambda: moments, view=lambda *_: view)
    for drawn in (maps.traction, maps.pressure):
        figure = drawn(run, 0)
        figure.draw_without_rendering()
        for text in figure.findobj(Text):
            if len(text.get_text()) < 5:  # ticks, also those beyond the ends of their axes
                continue
            box = text.get_window_extent()
            inside = [figure.bbox.x0 - 1 <= box.x0, box.x1 <= figure.bbox.x1 + 1]
            inside += [figure.bbox.y0 - 1 <= box.y0, box.y1 <= figure.bbox.y1 + 1]
            assert all(inside), text.get_text()


def _words(figure):
    """Texts of a figure and of its legend."""
    return [text.get_text() for text in figure.findobj(Text) if text.get_text()]


@pytest.mark.parametrize(
    ("codes", "named"), [((1, 2), ["stick", "slip"]), ((0, 2), ["open", "slip"]), ((1,), ["stick"])]
)
def test_maps_name_what_is_there(codes, named):
    """Requirement: the legend has the statuses of some point, and which state is shown is said."""
    places = np.random.default_rng(3).uniform(size=(40, 3)) * [1.0, 1.0, 0.0]
    points = _touching(places, np.tile([0.0, 0, 1], (40, 1)), pressure=np.ones(40))
    points.point_data["status"][:] = np.resize(codes, 40)
    points.point_data["area"][:] = 1e-3
    view = ContactView(points, 0)
    for steps in (2, 5):
        moments = [Moment(f"step {i}", i, i) for i in range(steps)]
        run = SimpleNamespace(
            steps=range(steps),
            ends=lambda moments=moments: moments,
            mixed=lambda _, moments=moments: moments,
            view=lambda *_: view,
        )
        words = _words(maps.status(run, 0))
        assert [word for word in words if word in STATUS] == named
        which = "of each step" if steps == 2 else "of each of the last 3 of 5 steps"
        assert f"{which} the state in which stick and slip are most mixed" in words
        words = _words(maps.pressure(run, 0))
        assert ("open" in words) == (0 in codes)
        assert ("at the end of each of the last 3 of 5 steps" in words) == (steps == 5)


@pytest.mark.parametrize(("across", "panels"), [(0.0, 1), (2.0, 2)])
def test_a_normal_force_that_cancels_is_not_drawn(across: float, panels: int) -> None:
    """A ring around z that is pushed along it, as one on a bar.

    Requirement: an empty panel of a force that is zero throughout is left out.
    """
    angles = 2.0 * np.pi * np.arange(40) / 40
    around = np.column_stack([np.cos(angles), np.sin(angles), 0.0 * angles])
    view = ContactView(_touching(10.0 * around, -around), 0)
    force = 3.0 * np.array([[0.0, 0.0, 1.0]]) + across * view.frame.normal
    run = SimpleNamespace(view=lambda *_: view, around_an_axis=False, is_resultant=lambda _: True)
    run.vectors = lambda _: force
    run.path_length = lambda: ("time [time]", np.array([1.0]))
    run.history = {f"contacts.0.{name}": np.ones(1) for name in ("max_pressure", "area")}
    run.steps = [("push", [0])]
    figure = curves.force(run, 0)
    assert view.closed
    assert len(figure.axes) == panels
    assert figure.axes[-1].get_xlabel() == "time [time]"
