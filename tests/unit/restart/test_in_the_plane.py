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
slave = "block.bottom"
master = "base.top"
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


@pytest.mark.parametrize(
    ("kind", "order", "model", "strategy"),
    [
        ("plane-strain", 1, "linear-elastic", "direct"),
        ("plane-strain", 1, "neo-hookean", "condensed"),
        ("axisymmetric", 1, "linear-elastic", "condensed"),
        ("axisymmetric", 2, "linear-elastic", "direct"),
    ],
)
def test_mortar_contact_goes_on_bit_by_bit(tmp_path, kind, order, model, strategy, same, gone_on):
    """A run halted in the middle of a drag by more than a facet is the whole one.

    What was opposite to a slave node at the accepted increment, which its slip counts from, are
    nodes of edges: facets of order 1, swept to both sides of the plane, have none of them.
    """
    case = tmp_path / "case.toml"
    case.write_text(CASE.format(kind=kind, order=order, model=model, strategy=strategy))
    assert same(*gone_on(case, 2))
