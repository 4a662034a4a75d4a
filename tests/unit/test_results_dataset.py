"""Data sets for ParaView: what VTK reads is what was written."""

from __future__ import annotations

import numpy as np
import pytest

from anisocontact.results.dataset import DataSet, polygons, read_data_set, vertices


def read(path, content):
    pyvista = pytest.importorskip("pyvista")
    path.write_bytes(content)
    return pyvista.read(path)


def test_points_come_back_to_the_last_bit(tmp_path):
    """Whole numbers keep their type."""
    points = np.random.default_rng(3).normal(size=(3001, 3))
    status = np.arange(3001, dtype=np.int32)
    cloud = DataSet(
        "PolyData", points, vertices(np.arange(3001)), {"status": status, "gap": points[:, 0]}
    )
    found = read(tmp_path / "cloud.vtp", cloud.encoded())
    assert np.array_equal(found.points, points)
    assert found.n_cells == 3001
    assert np.array_equal(found.point_data["status"], status)
    assert found.point_data["status"].dtype == np.int32
    again = read_data_set(tmp_path / "cloud.vtp")
    assert np.array_equal(again.points, points)
    assert np.array_equal(again.point_data["status"], status)
    assert again.point_data["status"].dtype == np.int32
    assert np.array_equal(found.point_data["gap"], points[:, 0])


def test_polygons(tmp_path):
    corners = np.array([[0, 1, 2, 3], [1, 4, 5, 2]])
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 1, 0]], float)
    found = read(tmp_path / "two.vtp", DataSet("PolyData", points, polygons(corners), {}).encoded())
    assert found.area == pytest.approx(2.0)
    assert np.array_equal(found.faces.reshape(-1, 5)[:, 1:], corners)


def test_no_points_at_all(tmp_path):
    empty = DataSet("PolyData", np.zeros((0, 3)), vertices(np.arange(0)), {"gap": np.zeros(0)})
    assert read(tmp_path / "none.vtp", empty.encoded()).n_points == 0
    assert len(read_data_set(tmp_path / "none.vtp").points) == 0


def test_more_than_one_block(tmp_path):
    """Arrays of more than 1 MiB are cut; VTK puts them together, and so do we."""
    points = np.random.default_rng(4).normal(size=(100_000, 3))
    cloud = DataSet("PolyData", points, vertices(np.arange(len(points))), {})
    assert np.array_equal(read(tmp_path / "cloud.vtp", cloud.encoded()).points, points)
    assert np.array_equal(read_data_set(tmp_path / "cloud.vtp").points, points)


def test_pieces_are_joined(tmp_path):
    """The file that names pieces tells VTK what is in them."""
    cells = {**vertices(np.arange(2))["Verts"], "types": np.ones(2, dtype=np.uint8)}
    for i in range(2):
        points = np.full((2, 3), float(i))
        piece = DataSet("UnstructuredGrid", points, {"Cells": cells}, {"gap": np.full(2, i)})
        (tmp_path / f"{i}.vtu").write_bytes(piece.encoded())
    found = read(tmp_path / "all.pvtu", piece.summary(["0.vtu", "1.vtu"]))
    assert found.points[:, 0].tolist() == [0, 0, 1, 1]
    assert found.point_data["gap"].tolist() == [0, 0, 1, 1]
    again = read_data_set(tmp_path / "all.pvtu")
    assert again.points[:, 0].tolist() == [0, 0, 1, 1]
    assert again.cells["Cells"]["connectivity"].tolist() == [0, 1, 2, 3]
    assert again.cells["Cells"]["offsets"].tolist() == [0, 1, 2, 3, 4]
