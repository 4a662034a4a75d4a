"""Exodus files: element blocks are bodies, side sets facet groups, node sets nodes.

Format: Schoof and Yarberry, EXODUS II, A Finite Element Data Model (1994), section 4: numbering of
nodes and sides of elements. Some writers number middle nodes as VTK does; where they lie says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.mesh.tetrahedra import EDGES

#: Endings of names.
SUFFIXES = (".e", ".exo", ".ex2", ".g", ".gen")
#: Beginning of the name of an element -> cell here, name of meshio by the number of nodes.
KINDS: dict[str, tuple[str, dict[int, str]]] = {
    "HEX": ("hexahedron", {8: "hexahedron", 20: "hexahedron20", 27: "hexahedron27"}),
    "TET": ("tetrahedron", {4: "tetra", 10: "tetra10"}),
    "WED": ("prism", {6: "wedge", 15: "wedge15"}),
    "PYR": ("pyramid", {5: "pyramid", 13: "pyramid13"}),
    "TRI": ("triangle", {3: "triangle", 6: "triangle6"}),
    "QUA": ("quadrilateral", {4: "quad", 8: "quad8", 9: "quad9"}),
    "SHE": ("quadrilateral", {4: "quad", 8: "quad8", 9: "quad9"}),
}
#: Corners of the sides of cells, in their order.
SIDES: dict[str, list[tuple[int, ...]]] = {
    "hexahedron": [
        *((0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6)),
        *((0, 4, 7, 3), (0, 3, 2, 1), (4, 5, 6, 7)),
    ],
    "tetrahedron": [(0, 1, 3), (1, 2, 3), (0, 3, 2), (0, 2, 1)],
    "prism": [(0, 1, 4, 3), (1, 2, 5, 4), (0, 3, 5, 2), (0, 2, 1), (3, 4, 5)],
    "pyramid": [(0, 1, 4), (1, 2, 4), (2, 3, 4), (0, 4, 3), (0, 3, 2, 1)],
    "triangle": [(0, 1), (1, 2), (2, 0)],
    "quadrilateral": [(0, 1), (1, 2), (2, 3), (3, 0)],
}
#: Nodes of Exodus in the order of VTK, where the two differ.
ORDERS = {
    20: [*range(12), *range(16, 20), *range(12, 16)],
    27: [*range(12), *range(16, 20), *range(12, 16), 23, 24, 25, 26, 21, 22, 20],
    15: [*range(9), *range(12, 15), *range(9, 12)],
}


def read_exodus(path: Path) -> Any:
    """The mesh of an Exodus file as meshio would give it, with `sides`: name -> corners of facets.

    Raises:
        InputError: netCDF4 is not installed, or a side set names sides that elements do not have.
        OSError: It cannot be read.
    """
    try:
        import netCDF4
    except ImportError:
        text = "needs netCDF4: pip install 'anisocontact[meshes]'"
        raise InputError(f"files that end with {path.suffix} {text}") from None
    with netCDF4.Dataset(path) as data:
        data.set_auto_mask(False)
        values: Mapping[str, Any] = data.variables
        points = _points(values)
        blocks = [values[f"connect{k}"] for k in _numbers(values, "connect")]
        kinds = [str(block.elem_type).upper()[:3] for block in blocks]
        rows = [np.asarray(block[:], dtype=np.int64) - 1 for block in blocks]
        names = _names(values, "eb", len(blocks))
        numbers = _identifiers(values, "eb", len(blocks))
        cells = [_in_order(kind, nodes, points) for kind, nodes in zip(kinds, rows, strict=True)]
        return SimpleNamespace(
            points=points,
            cells=[
                SimpleNamespace(type=_type(kind, one), data=one)
                for kind, one in zip(kinds, cells, strict=True)
            ],
            cell_sets=dict(_bodies(kinds, rows, names, numbers)),
            cell_data={},
            field_data={},
            point_sets=dict(_node_sets(values)),
            sides=dict(_side_sets(values, kinds, rows)),
        )


def _points(values: Mapping[str, Any]) -> Floats:
    if "coord" in values:
        found = np.asarray(values["coord"][:], dtype=float).T
    else:
        axes = [values[name][:] for name in ("coordx", "coordy", "coordz") if name in values]
        found = np.column_stack([np.asarray(axis, dtype=float) for axis in axes])
    points = np.zeros((len(found), 3))
    points[:, : found.shape[1]] = found
    return points


def _numbers(values: Mapping[str, Any], name: str) -> list[int]:
    """Numbers k of variables `name<k>`, in order."""
    return sorted(
        int(key[len(name) :])
        for key in values
        if key[len(name) :].isdigit() and key.startswith(name)
    )


def _names(values: Mapping[str, Any], kind: str, count: int) -> list[str]:
    """Names of blocks ("eb"), side sets ("ss") or node sets ("ns"); empty where there are none."""
    if f"{kind}_names" not in values:
        return [""] * count
    rows = values[f"{kind}_names"][:]
    found = [
        b"".join(row.tolist()).split(b"\0")[0].decode("utf-8", "replace").strip() for row in rows
    ]
    return [*found, *[""] * count][:count]


def _identifiers(values: Mapping[str, Any], kind: str, count: int) -> list[int]:
    key = f"{kind}_prop1"
    return [int(n) for n in values[key][:]] if key in values else list(range(1, count + 1))


def _type(kind: str, nodes: Ints) -> str:
    """Name of meshio for elements."""
    return KINDS.get(kind, ("", {}))[1].get(nodes.shape[1], f"{kind.lower()}{nodes.shape[1]}")


def _in_order(kind: str, nodes: Ints, points: Floats) -> Ints:
    """Nodes in the order of VTK: as the format has it, or as they are where that fits better."""
    order = ORDERS.get(nodes.shape[1])
    if order is None or kind not in ("HEX", "WED"):
        return nodes
    cell = KINDS[kind][0]
    ends, count = np.array(EDGES[cell]), {"hexahedron": 8, "prism": 6}[cell]

    def off(found: Ints) -> float:
        middles = points[found[:, count : count + len(ends)]]
        return float(np.abs(middles - points[found[:, ends]].mean(axis=2)).sum())

    return min((nodes[:, order], nodes), key=off)


def _bodies(
    kinds: list[str], rows: list[Ints], names: list[str], numbers: list[int]
) -> Iterator[tuple[str, Any]]:
    """Cells of each block by its name; blocks without a name have one if there are several."""
    solid = [k for k, kind in enumerate(kinds) if kind in ("HEX", "TET", "WED", "PYR")]
    bodies = solid or [k for k, kind in enumerate(kinds) if kind in KINDS]
    for k, name in enumerate(names):
        own = name or (f"body{numbers[k]}" if k in bodies and len(bodies) > 1 else "")
        if own and kinds[k] in KINDS:
            yield own, [np.arange(len(one)) if i == k else None for i, one in enumerate(rows)]


def _node_sets(values: Mapping[str, Any]) -> Iterator[tuple[str, Ints]]:
    numbers = _numbers(values, "node_ns")
    known = _identifiers(values, "ns", len(numbers))
    for place, (k, name) in enumerate(
        zip(numbers, _names(values, "ns", len(numbers)), strict=True)
    ):
        yield name or f"nodes{known[place]}", np.asarray(values[f"node_ns{k}"][:], np.int64) - 1


def _side_sets(
    values: Mapping[str, Any], kinds: list[str], rows: list[Ints]
) -> Iterator[tuple[str, list[Ints]]]:
    starts = [0, *np.cumsum([len(one) for one in rows]).tolist()]
    numbers = _numbers(values, "elem_ss")
    known = _identifiers(values, "ss", len(numbers))
    for place, (k, name) in enumerate(
        zip(numbers, _names(values, "ss", len(numbers)), strict=True)
    ):
        elements = np.asarray(values[f"elem_ss{k}"][:], dtype=np.int64) - 1
        sides = np.asarray(values[f"side_ss{k}"][:], dtype=np.int64) - 1
        found: list[Ints] = []
        for block, (kind, nodes) in enumerate(zip(kinds, rows, strict=True)):
            inside = (elements >= starts[block]) & (elements < starts[block + 1])
            if not inside.any() or kind not in KINDS or kind == "SHE":
                continue
            corners = SIDES[KINDS[kind][0]]
            if sides[inside].max() >= len(corners):
                text = f"side {sides[inside].max() + 1} of a {KINDS[kind][0]}"
                raise InputError(f"side set {name or known[place]} has {text}")
            for side in np.unique(sides[inside]):
                own = elements[inside & (sides == side)] - starts[block]
                found.append(nodes[own][:, corners[side]])
        if found:
            yield name or f"surface{known[place]}", found
