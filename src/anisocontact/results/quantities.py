"""Output quantities: one table makes arrays and numbers of a run, their pages and `[output]`."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from anisocontact.base.array_types import Floats
from anisocontact.base.arrays import real
from anisocontact.base.errors import InputError
from anisocontact.base.python_file import called
from anisocontact.base.typed import typed
from anisocontact.results.stress_invariants import principal, von_mises

#: What a quantity belongs to.
NODE, CELL, POINT, PATCH = "node", "cell", "slave point", "patch"
CONTACT, RIGID = "contact", "rigid body"
#: The files that have it; the first ones are for ParaView.
FILES = {
    NODE: "fields.pvd",
    CELL: "fields.pvd",
    POINT: "contact.pvd",
    PATCH: "surfaces.pvd",
    CONTACT: "summary.json and history.csv",
    RIGID: "summary.json and history.csv",
}


@dataclass(frozen=True)
class OutputQuantity:
    """A row of the table.

    Args:
        name: Its name in the file.
        at: What it belongs to, one of `FILES`.
        unit: Dimension, such as "length"; "1" where there is none.
        doc: One line.
        values: Makes it of what is there, see `register_quantity`.
        always: Whether it is written whatever `output.quantities` says: pictures are made of it.
        asked: Whether it is written only where `output.quantities` names it: it takes time.
    """

    name: str
    at: str
    unit: str
    doc: str
    values: Callable[[Any], Any]
    always: bool = False
    asked: bool = False


@typed
def register_quantity[T: Callable[[Any], Any]](
    name: str, at: str, unit: str, doc: str
) -> Callable[[T], T]:
    """Let runs write a quantity, and case files that are read afterwards name it.

    Args:
        name: Its name in the file.
        at: What it belongs to. The function that is decorated takes what there is, and returns a
            number or a vector for each: at a "slave point" it takes `SlavePoints`; at a "node" or a
            "cell" an object with the `problem`, the `displacement` (nodes, 3) and the `stress`
            (nodes, 6); at a "patch" of an analytic master one with its `numbers` and `directions`.
            At a "contact" it takes `SlavePoints` as well, at a "rigid body" one with the `body`
            and its `force` and `support`; there it is called on every process, and returns what
            holds for all of them.
        unit: Dimension, such as "length"; "1" where there is none.
        doc: One line.

    Returns:
        A decorator.

    Raises:
        InputError: There is such a quantity, or nothing that it could belong to; in a run, the
            function failed, or returned something else than real numbers, one or a vector for each.

    Example:
        >>> register_quantity("gap", "slave point", "length", "once more")
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: quantity: 'gap' of a slave point is registered already
    """
    if at not in FILES:
        raise InputError(f"{at!r} given, must be one of {', '.join(FILES)}", "quantity")
    if (at, name) in _TABLE:
        raise InputError(f"{name!r} of a {at} is registered already", "quantity")

    def register(values: T) -> T:
        checked = partial(_answer, values, at, f"quantity {name!r} of a {at}")
        _TABLE[at, name] = OutputQuantity(name, at, unit, doc, checked)
        return values

    return register


def _answer(values: Callable[[Any], Any], at: str, who: str, of: Any) -> Floats:
    """What a function of the user's has made of what is there, as files can have it.

    Raises:
        InputError: It failed, or returned something else than real numbers, one or a vector for
            each.
    """
    found = real(called(values, of, who=who))
    if found is None:
        raise InputError("something else than real numbers returned", who)
    if at in (CONTACT, RIGID):
        fits, needed = found.ndim < 2 and found.size > 0, "() or (k,)"
    else:
        count, width = len(of.displacement if at == NODE else of.numbers), found.shape[1:]
        fits = found.shape[:1] == (count,) and len(width) < 2 and 0 not in width
        needed = f"({count},) or ({count}, k)"
    if not fits:
        raise InputError(f"an array of shape {found.shape} returned, {needed} needed", who)
    return found


def quantities(*at: str) -> tuple[OutputQuantity, ...]:
    """The registered quantities.

    Args:
        *at: What they belong to; all if not given.

    Returns:
        Rows of the table, in the order in which files have them.

    Example:
        >>> [q.name for q in quantities("node")]
        ['displacement', 'stress', 'von_mises', 'principal_stress']
    """
    return tuple(q for q in _TABLE.values() if q.at in (at or FILES))


def arrays(
    at: str, parts: Sequence[Any], chosen: Collection[str] = ()
) -> dict[str, npt.NDArray[Any]]:
    """Arrays of a file for ParaView.

    Args:
        at: What they belong to.
        parts: What there is of these, such as the slave points of each contact.
        chosen: Names of the ones to write; all if not given.

    Returns:
        Name -> rows of all parts, one after the other.
    """
    return {
        q.name: np.concatenate([np.asarray(q.values(part)) for part in parts])
        for q in quantities(at)
        if q.always or q.name in chosen or not (chosen or q.asked)
    }


def numbers(at: str, of: Any) -> dict[str, Any]:
    """Numbers of a contact or a rigid body as JSON can have them; collective."""
    found = {q.name: q.values(of) for q in quantities(at)}
    return {
        n: v.tolist() if isinstance(v, np.ndarray | np.generic) else v for n, v in found.items()
    }


type _Row = tuple[str, str, str, Callable[[Any], Any]]


def _rows(at: str, *rows: _Row) -> list[OutputQuantity]:
    """Rows of the same sort: name, unit, meaning, and how it is made."""
    return [
        OutputQuantity(name, at, unit, doc, values, name in _PICTURED, name in _ON_REQUEST)
        for name, unit, doc, values in rows
    ]


def _axis(law: str, number: int) -> _Row:
    """The row of an axis of a law."""
    return (
        f"direction_{law}_{number}",
        "1",
        f"unit vector of an axis of {law}, zero where the point is open",
        lambda p: getattr(p.last, f"directions_{law}")[:, number - 1],
    )


#: What the report is made of.
_PICTURED = {
    *("displacement", "body", "contact", "area", "covered", "pressure", "status"),
    "normal",
    *("traction_principal", "direction_adhesion_1", "direction_adhesion_2"),
    *("direction_friction_1", "direction_friction_2"),
}
#: What takes time to make.
_ON_REQUEST = {"energy_density"}
#: All of the project, in the order in which files have them.
_TABLE = {
    (q.at, q.name): q
    for q in (
        *_rows(
            NODE,
            ("displacement", "length", "displacement", lambda b: b.displacement),
            (
                "stress",
                "stress",
                "Cauchy stress, XX, YY, ZZ, XY, YZ, XZ; at a node the mean of its cells",
                lambda b: b.stress,
            ),
            ("von_mises", "stress", "equivalent stress", lambda b: von_mises(b.stress)),
            (
                "principal_stress",
                "stress",
                "principal stresses, the largest first",
                lambda b: principal(b.stress),
            ),
        ),
        *_rows(
            CELL,
            ("body", "1", "number of the body in `summary.json`", lambda b: b.numbers),
            (
                "plastic_strain",
                "1",
                "equivalent plastic strain, mean of the cell; 0 where the material has none",
                lambda b: b.plastic_strain,
            ),
            (
                "energy_density",
                "stress",
                "elastic energy per volume before deformation, mean of the cell; NaN where a "
                "material defines no energy; only if `quantities` names it",
                lambda b: b.energy_density,
            ),
        ),
        *_rows(
            POINT,
            ("contact", "1", "number of the contact", lambda p: p.numbers),
            ("area", "length^2", "slave area", lambda p: p.contact.areas),
            (
                "covered",
                "1",
                "share of the weight of a slave node that the master covers; 1 at other points",
                lambda p: p.contact.covered(),
            ),
            ("gap", "length", "signed gap, negative in contact", lambda p: p.last.gap),
            ("pressure", "stress", "pressure", lambda p: p.last.pressure),
            ("traction", "stress", "traction on the slave", lambda p: p.last.traction),
            ("traction_t", "stress", "its tangential part", lambda p: p.last.traction_t),
            (
                "traction_principal",
                "stress",
                "components of the tangential traction along the two friction axes",
                lambda p: p.last.traction_principal,
            ),
            ("elastic_slip", "length", "elastic slip", lambda p: p.contact.elastic_slip()),
            (
                "slip_accumulated",
                "length",
                "length of slip so far",
                lambda p: p.state["slip_accumulated"],
            ),
            ("status", "1", "0 open, 1 stick, 2 slip", lambda p: p.last.status.astype(np.int32)),
            (
                "dissipation",
                "stress length",
                "energy dissipated by friction so far, per area",
                lambda p: p.state["dissipation"],
            ),
            ("normal", "1", "normal of the master", lambda p: p.last.normal),
            *(_axis(law, number) for law in ("adhesion", "friction") for number in (1, 2)),
        ),
        *_rows(
            PATCH,
            ("contact", "1", "number of the contact", lambda p: p.numbers),
            (
                "direction_friction_1",
                "1",
                "first axis of friction, zero where there is none",
                lambda p: p.directions,
            ),
        ),
        *_rows(
            CONTACT,
            ("force", "force", "resultant on the slave", lambda c: c.resultant[0]),
            ("moment", "force length", "its moment about the origin", lambda c: c.resultant[1]),
            ("max_pressure", "stress", "largest", lambda c: c.contact.peak(c.last.pressure)),
            (
                "max_pressure_at",
                "length",
                "where it is; no number where nothing touches",
                lambda c: c.place_of_peak(),
            ),
            ("max_penetration", "length", "largest", lambda c: c.contact.peak(-c.last.gap)),
            (
                "max_elastic_slip",
                "length",
                "largest",
                lambda c: c.contact.peak(np.linalg.norm(c.contact.elastic_slip(), axis=1)),
            ),
            (
                "max_turn",
                "radian",
                "the largest angle by which normal, axes of adhesion or slave turned at a point in "
                "contact along the last sub-increment",
                lambda c: c.contact.extreme(c.state["turn"]),
            ),
            (
                "turn",
                "radian",
                "the same where friction acts, by which sub-increments are cut back: the cubic "
                "mean over the points, weighted with their tangential forces",
                lambda c: c.contact.turn(),
            ),
            ("area", "length^2", "slave area that touches", lambda c: c.means[0]),
            (
                "radius",
                "length",
                "that of a disc of the same area, seen against the mean normal, with what planes "
                "of symmetry mirror; no number unless it is round: its two semi-axes (of the "
                "ellipse with its second moments) differ by at most 15 %, no point of it with half "
                "its own size is farther than 1.17 radii from its middle, and it is no smaller "
                "than sixteen points, in an axisymmetric section than four of the largest rings",
                lambda c: c.radius(),
            ),
            ("elastic_slip", "length", "its mean over that area, a vector", lambda c: c.means[1]),
            ("slip", "length", "mean over it of the length of slip so far", lambda c: c.means[2]),
            ("least_gap", "length", "smallest gap of the points", lambda c: c.least_gap()),
            ("points", "1", "number of points by status", lambda c: c.contact.counts()),
            (
                "approach",
                "length",
                "approach of the bodies: how far facet groups with prescribed motion or loads have "
                "moved towards each other",
                lambda c: c.approach(),
            ),
        ),
        *_rows(
            RIGID,
            (
                "position",
                "length",
                "reference point of now",
                lambda b: b.body.reference + b.pose.translation,
            ),
            ("translation", "length", "how far it has moved", lambda b: b.pose.translation),
            ("rotation", "radian", "rotation vector, angle at most π", lambda b: b.rotation),
            (
                "turn",
                "radian",
                "sum of the rotations about the axes of space, as the steps prescribe it",
                lambda b: b.pose.turn,
            ),
            ("force", "force", "of the contacts on the body", lambda b: b.force[:3]),
            ("moment", "force length", "the same, about `position`", lambda b: b.force[3:]),
            ("support_force", "force", "what holds the body", lambda b: b.support[:3]),
            ("support_moment", "force length", "the same", lambda b: b.support[3:]),
        ),
    )
}
