"""A room uses those below it and never one that uses it."""

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

SOURCES = Path(__file__).parents[2] / "src" / "anisocontact"


def imported(path: Path) -> Iterator[str]:
    """Modules of the package that a file imports, wherever in it."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("anisocontact."):
            yield str(node.module)


def used() -> dict[str, set[str]]:
    """Rooms that each room uses: the packages and single modules below `anisocontact`."""
    rooms: dict[str, set[str]] = defaultdict(set)
    for path in SOURCES.rglob("*.py"):
        room = path.relative_to(SOURCES).with_suffix("").parts[0]
        rooms[room] |= {module.split(".")[1] for module in imported(path)} - {room}
    return rooms


def test_imports_go_one_way() -> None:
    rooms = used()
    left = set(rooms)
    while lowest := {room for room in left if not rooms[room] & left}:
        left -= lowest
    assert left == set(), f"use each other: {sorted(left)}"
    assert {"solver", "contact", "mesh"} <= rooms["case"]


def test_points_know_nothing_of_results() -> None:
    rooms = used()
    assert "results" not in rooms["point"]
