"""What nobody has any more is given back before MPI runs out of communicators."""

import gc
import weakref

from anisocontact.base.unreferenced import EVERY
from anisocontact.bulk import make_material
from anisocontact.mesh import BoxSpec, build_box
from anisocontact.solver import Problem


class Ring:
    """Refers to itself, as problems with contact do: it goes when garbage is collected."""

    def __init__(self):
        self.ring = self


def test_problems_one_after_the_other_give_back_what_was_before():
    """Where Python does not look for garbage itself, as it hardly does in a large process."""
    model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (1, 1, 1))})
    steel = {"block": make_material("linear-elastic", E=1.0, nu=0.3)}
    gc.disable()
    try:
        left = weakref.ref(Ring())
        assert left() is not None
        for _ in range(EVERY):
            Problem(model, steel)
        assert left() is None
    finally:
        gc.enable()
