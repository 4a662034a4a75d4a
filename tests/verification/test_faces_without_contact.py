"""Faces that are no slaves go through a master, and the run says so.

A contact is between two groups of facets: nothing stops another face of the slave's body. Forces
balance, and a run ends as done with bodies inside each other.
"""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.verification.hard.test_published_rubber_cylinder import CASE

from anisocontact.case import load
from anisocontact.case.build import build

BLOCK = """
[mesh.box.block]
origin = [0, 0, 0]
size = [1, 1, 1]
cells = [3, 3, 3]
[material.block]
model = "MODEL"
E = 2e11
nu = 0.3
"""

TURNED = """
[surface.floor]
shape = "plane"
point = [0, 0, 0]
normal = [0, 0, 1]
[[contact]]
slave = "block.bottom"
master = "floor"
friction = { coefficients = 0.5 }
[[step]]
name = "over"
increments = 4
rotation = { "block.top" = { axis = [0, 1, 0], angle_deg = 120, point = [0.5, 0, H] } }
"""

SIDE = """
[mesh.box.wall]
origin = [1.2, -0.5, -0.5]
size = [1, 2, 2]
cells = [2, 3, 4]
[material.wall]
model = "linear-elastic"
E = 2e11
nu = 0.3
[[contact]]
slave = "block.bottom"
master = "wall.top"
friction = { coefficients = 0.2 }
[[step]]
name = "push"
increments = 2
displacement."block.top" = { x = AWAY, y = 0, z = -0.3 }
displacement."wall.bottom" = { x = 0, y = 0, z = 0 }
"""


@pytest.mark.parametrize(
    ("text", "part"),
    [
        (TURNED.replace("H", "0.45"), True),
        (TURNED.replace("H", "0.75"), False),
        (SIDE.replace("AWAY", "0.8"), True),
        (SIDE.replace("AWAY", "0.1"), False),
    ],
    ids=["turned into a plane", "turned above it", "through a side", "beside it"],
)
def test_a_part_of_a_body_behind_its_master_is_told(tmp_path: Path, text: str, part: bool) -> None:
    """Requirement: a warning with body, share and depth; none where the body is in front of it.

    The upper edge of the first block is at 0.45 - 0.71 at the end, by geometry, that of
    the second at 0.75 - 0.71; the third lies in the wall by its side, the fourth stands beside it.
    """
    path = tmp_path / "case.toml"
    block = BLOCK.replace("MODEL", "linear-elastic" if "wall" in text else "neo-hookean")
    path.write_text(f'title = "Faces"\n{block}{text}')
    warnings: list[str] = []
    for _ in build(load(path)).solver.run(on_warning=warnings.append):
        pass
    about = [text for text in warnings if "lies behind its master" in text]
    assert len(about) == int(part)
    assert all("of body 'block'" in text and "other faces go through" in text for text in about)


@pytest.mark.parametrize("given", ['method = "penalty"', 'pass = "single"'])
def test_penetration_of_a_penalty_is_no_other_face(tmp_path: Path, given: str) -> None:
    """Requirement: nodes no deeper than points that press are not told to have gone through.

    All of the skin of a rubber cylinder is slave; the penalty lets it in by 6 % of its size.
    """
    path = tmp_path / "case.toml"
    text = CASE.format(cells=[32, 4], order=1, increments=8)
    path.write_text(text.replace("[[step]]", f"{given}\n[[step]]"))
    warnings: list[str] = []
    built = build(load(path))
    for _ in built.solver.run(on_warning=warnings.append):
        pass
    (contact,) = built.problem.contacts
    assert -contact.last.gap.min() > 0.1 * contact.slave_points.size
    assert not [text for text in warnings if "behind its master" in text]
