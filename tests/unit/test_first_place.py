"""The place that a refusal names."""

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

from types import SimpleNamespace

from anisocontact.base.errors import InputError
from anisocontact.contact.initial import _refuse

POINTS = np.array([[0.5, 2.5, 1.0], [2.0, 0.5, 1.0], [0.5 + 1e-13, 0.5, 1.0], [0.0, 0.0, 1.0]])


@pytest.mark.parametrize(
    "ranks", [([0, 1, 2, 3],), ([3, 2, 1, 0],), ([0, 3], [1, 2]), ([], [2, 0])]
)
def test_is_the_same_on_any_number_of_processes(ranks):
    """Requirement: of points of which the last is not refused the first by x, y, z is named,
    however they are numbered and shared out; coordinates differ by rounding between processes.
    """
    places = np.concatenate([POINTS[own] for own in ranks if own])
    rows = [np.hstack([POINTS[own], POINTS[own] + 1, POINTS[own]]) for own in ranks]
    rows = [one[np.asarray(own, dtype=int) < 3] for one, own in zip(rows, ranks, strict=True)]
    firsts = [one[np.lexsort(np.round(one[:, 2::-1], 6).T)[:1]] for one in rows]

    def refused(rank: int) -> str:
        sent = []
        comm = SimpleNamespace(
            allgather=lambda local: sent.append(local) or firsts,
            allreduce=lambda count: len(places),
        )
        points = POINTS[ranks[rank]]
        contact = SimpleNamespace(
            points=points,
            slave_points=SimpleNamespace(outward=points + 1, size=1.0),
            space=SimpleNamespace(mesh=SimpleNamespace(comm=comm)),
        )
        bad = np.asarray(ranks[rank], dtype=int) < 3
        with pytest.raises(InputError) as caught:
            _refuse(contact, bad, "{count} at {point}, {outward}", "master", points)
        assert np.array_equal(sent[0], firsts[rank])
        return str(caught.value)

    said = {refused(rank) for rank in range(len(ranks))}
    assert said == {f"master: {len(places)} at (0.5, 0.5, 1), (1.5, 1.5, 2)"}
