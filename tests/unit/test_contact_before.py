"""Names and arguments of contacts of before: they work for one more version, with a warning."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

pytest.importorskip("anisocontact.base.fenicsx", exc_type=ImportError)

import anisocontact.contact
from anisocontact.contact import Contact
from anisocontact.interface import ContactLaw, Interface
from anisocontact.laws import Adhesion, Friction, NormalLaw
from anisocontact.mesh import BoxSpec, Model, build_box
from anisocontact.rigid import MovingSurface, RigidBody
from anisocontact.surfaces import make_surface

LAWS = (
    NormalLaw(penalty=100.0),
    Adhesion(stiffness=(100.0, 100.0)),
    Friction(coefficients=(0.3, 0.3)),
)
SIDES = "block.bottom", "base.top"


def _model() -> Model:
    upper = BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 1))
    return build_box({"block": upper, "base": BoxSpec((-1, -1, -1), (3, 3, 1), (3, 3, 1))})


def _answer(contact: Any) -> np.ndarray:
    u = np.zeros((len(contact.space.tabulate_dof_coordinates()), 3))
    u[np.unique(contact.slave_points.nodes)] = (1e-3, 2e-3, -1e-2)
    return contact.update(u, 1.0).traction


@pytest.mark.parametrize(
    ("name", "before", "now"),
    [
        ("FacetContact", SIDES, {"mortar": False}),
        ("FacetContact", SIDES, {"mortar": False, "degree": 1, "name": "pair"}),
        ("TwoHalfPass", SIDES, {"mortar": True}),
        ("SelfContact", SIDES[:1], {"self_contact": True, "apart": 0.5, "name": "fold"}),
    ],
)
def test_classes(name: str, before: tuple[str, ...], now: dict[str, Any]) -> None:
    """The same tractions as those of `Contact`, exactly: nothing else is made."""
    model, law = _model(), ContactLaw(*LAWS)
    with pytest.warns(DeprecationWarning, match=rf"{name} is now Contact\("):
        kind = getattr(anisocontact.contact, name)
    options = {k: v for k, v in now.items() if k not in {"mortar", "self_contact"}}
    old = kind(model, *before, law=law, **options)
    new = Contact(model, before[0], before[-1], law, **now)
    assert old.name == new.name
    assert np.array_equal(_answer(old), _answer(new))


@pytest.mark.parametrize("name", ["two_half", "overlaps"])
def test_passes(name: str) -> None:
    """What was integrated over overlaps of facets is evaluated at the slave nodes."""
    model, law, before = _model(), ContactLaw(*LAWS), {name: True}
    with pytest.warns(DeprecationWarning, match="take mortar=True, which is taken now") as told:
        old = Contact(model, *SIDES, law, **before)  # type: ignore[misc]
    assert np.array_equal(_answer(old), _answer(Contact(model, *SIDES, law, mortar=True)))
    # Python shows it only where the line is the script's own, not one of the package
    assert [one.filename for one in told] == [__file__]


def test_arguments() -> None:
    """A body and an interface by their names of before; a name that never was is refused."""
    model, die = _model(), RigidBody("die", (0, 0, 0))
    interface = Interface(make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)), *LAWS)
    with pytest.warns(DeprecationWarning, match="MovingSurface"):
        old = Contact(model, SIDES[0], interface=interface, body=die)
    new = Contact(model, SIDES[0], MovingSurface(interface, die), mortar=False)
    assert old.body is new.body is die
    assert np.array_equal(_answer(old), _answer(new))
    with pytest.raises(TypeError, match="'degre': did you mean 'degree'"):
        Contact(model, SIDES[0], interface, degre=2, mortar=False)  # type: ignore[call-arg]


def test_laws_go_on_a_surface() -> None:
    """Laws and a surface apart answer as an `Interface` of both does, exactly."""
    model = _model()
    plane = make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1))
    apart = Contact(model, SIDES[0], plane, ContactLaw(*LAWS), mortar=False)
    together = Contact(model, SIDES[0], Interface(plane, *LAWS), mortar=False)
    assert np.array_equal(_answer(apart), _answer(together))


def test_parts_of_an_interface() -> None:
    """Adhesion and friction of an interface by their names of before."""
    interface = Interface(make_surface("plane", point=(0, 0, 0), normal=(0, 0, 1)), *LAWS)
    with pytest.warns(DeprecationWarning, match="is now Interface.tangential.adhesion"):
        assert interface.adhesion is LAWS[1]
    with pytest.warns(DeprecationWarning, match="is now Interface.tangential.friction"):
        assert interface.friction is LAWS[2]
