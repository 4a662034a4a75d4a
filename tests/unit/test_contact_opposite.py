"""What is opposite to slave nodes, `Opposite`."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from anisocontact.contact.contact_planes import Opposite


def test_nodes_around_have_one_order() -> None:
    """The nodes that material tangents depend on are summed in one order, however they were listed.

    Requirement: the same bits, as a run that goes on from its files, where they are in ascending
    order, has the bits of one that was not stopped.
    """
    rng = np.random.default_rng(3)
    around = np.array([[4, 2, 7, -1, 0]], dtype=np.int32)
    along, bending = rng.normal(size=(1, 2, 5)), rng.normal(size=(1, 2, 2, 5))
    along[..., 3] = bending[..., 3] = 0.0
    there = replace(Opposite.none(1, 4), facet=np.zeros(1, np.int32))
    found = []
    for order in ([0, 1, 2, 3, 4], [3, 4, 2, 1, 0]):
        listed = replace(
            there,
            around=np.ascontiguousarray(around[:, order]),
            along=np.ascontiguousarray(along[..., order]),
            bending=np.ascontiguousarray(bending[..., order]),
        )
        found.append(listed.in_order())
    one, other = found
    assert one.around.tolist() == [[0, 2, 4, 7]]
    for name in ("around", "along", "bending"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
    np.testing.assert_array_equal(one.bending[0, 1, 1], bending[0, 1, 1][[4, 1, 0, 2]])
    x = rng.normal(size=(8, 3))
    assert np.array_equal(one.tangents(x), other.tangents(x))
