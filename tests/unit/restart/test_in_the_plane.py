"""Going on with a run of bodies in the plane, whose facets are swept out of edges."""

from __future__ import annotations

import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

CASE = """
[idealisation]
kind = "{kind}"
[mesh.rectangle.base]
origin = [0.5, -0.5]
size = [2, 0.5]
cells = [8, 2]
order = {order}
[mesh.rectangle.block]
origin = [1, 0]
size = [0.7, 0.4]
cells = [3, 2]
order = {order}
[material.base]
model = "{model}"
E = 1000
nu = 0.3
[material.block]
model = "{model}"
E = 3000
nu = 0.3
[[contact]]
slave = "{slave}"
master = "{master}"
pass = "mortar"
friction = {{ coefficients = 0.3 }}
[[step]]
name = "press"
increments = 1
[step.displacement]
"base.bottom" = {{ x = 0, y = 0 }}
"block.top" = {{ x = 0, y = -0.01 }}
[[step]]
name = "drag"
increments = 2
displacement = {{ "block.top" = {{ x = 0.3 }} }}
[output]
pictures = false
[solver]
strategy = "{strategy}"
"""


SIDES = ("block.bottom", "base.top")


@pytest.mark.parametrize(
    ("kind", "order", "model", "strategy", "sides"),
    [
        ("plane-strain", 1, "linear-elastic", "direct", SIDES),
        ("plane-strain", 1, "neo-hookean", "condensed", SIDES),
        ("axisymmetric", 1, "linear-elastic", "condensed", SIDES[::-1]),
        ("axisymmetric", 2, "linear-elastic", "direct", SIDES[::-1]),
    ],
)
def test_mortar_contact_goes_on_bit_by_bit(
    tmp_path, kind, order, model, strategy, sides, same, gone_on
):
    """A run halted in the middle of a drag by more than a facet is the whole one.

    What was opposite to a slave node at the accepted increment, which its slip counts from, are
    nodes of edges: facets of order 1, swept to both sides of the plane, have none of them. Where
    the base is the slave there are nodes of its own among them.
    """
    case = tmp_path / "case.toml"
    given = {"slave": sides[0], "master": sides[1], "strategy": strategy}
    case.write_text(CASE.format(kind=kind, order=order, model=model, **given))
    assert same(*gone_on(case, 2))
