"""Slave nodes that several contacts have: who looks at whom."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from anisocontact.contact.shared_nodes import SharedNodes, mark_shared


def _contact(nodes: list[int], pressure: list[float], augmented: bool = True) -> Any:
    """A contact that was far from its master and now presses some of its nodes."""
    far = np.ones(len(nodes))
    response = SimpleNamespace(state=None, gap=far, pressure=np.array(pressure))
    master = SimpleNamespace(located=lambda _: far > 0.0)
    return SimpleNamespace(
        slave_points=SimpleNamespace(nodes=np.array(nodes)[:, None], size=0.5, at_nodes=True),
        accepted=SimpleNamespace(response=response),
        current=SimpleNamespace(response=response),
        trials=SimpleNamespace(augmented=augmented, master=master, shared=SharedNodes(())),
    )


def test_contacts_look_at_those_alone_that_have_their_nodes():
    """Requirement: a node that two contacts press is shared; contacts beside them are not asked.

    An assembly has many contacts, each of which would ask all others in every correction.
    """
    one, other = _contact([0, 1], [1.0, 1.0]), _contact([1, 2], [1.0, 0.0])
    beside, penalties = _contact([5, 6], [1.0, 1.0]), _contact([5, 2], [1.0, 1.0], augmented=False)
    before = beside.trials.shared
    mark_shared([one, other, beside, penalties])
    beside.current.response = None  # would fail if it were asked
    assert one.trials.shared is other.trials.shared
    assert one.trials.shared.at(np.array([0, 1, 2])).tolist() == [False, True, False]
    assert beside.trials.shared is before
    assert not before.at(np.array([5, 6])).any()


@pytest.mark.parametrize("pressure", [[1.0, 0.0], [0.0, 0.0]])
def test_a_node_that_one_contact_presses_is_not_shared(pressure):
    """Requirement: multipliers stay exact at nodes that never meet two masters at once."""
    one, other = _contact([0, 1], [1.0, 1.0]), _contact([2, 1], pressure)
    mark_shared([one, other])
    assert not one.trials.shared.at(np.array([0, 1, 2])).any()
