"""What a mesh is taken for: a solid, a plane or a half plane that is turned about an axis.

A mesh of two dimensions lies in the plane z = 0 of space, its nodes have displacements with three
components. What is not meshed follows: a point x of the plane stands for the line or the circle
with the tangent `t = offset + turn x`, whose length is the thickness or the circumference. In the
body that tangent gives the derivative across the plane, on the surface it is the second tangent of
a facet, so that whatever knows space (materials, contact laws, surfaces) is asked as in space.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import scipy

from anisocontact.base import registry
from anisocontact.base.array_types import Floats, Ints
from anisocontact.base.errors import InputError
from anisocontact.base.fenicsx import ufl
from anisocontact.base.read_only import read_only
from anisocontact.base.registry import Entry, Parameter
from anisocontact.base.typed import typed

#: Distance from the axis that counts as on it, over the largest coordinate.
ON_AXIS = 1e-12

_THICKNESS = Parameter(
    "thickness", "scalar", "length", "extent across the plane", "positive", False, (1.0,)
)
_LATERAL = Parameter(
    "lateral",
    "flag",
    "1",
    "whether displacements across the plane are unknowns (antiplane shear, twist), or zero",
    default=(0.0,),
)


class Idealisation:
    """A solid in space; the others say what differs.

    Attributes:
        entry: Name, one line of text, parameters.
        dim: Dimension of the mesh.
        lateral: Whether displacements across the plane are unknowns.
        offset: Tangent across the plane where x = 0, (3,), length.
        turn: Its change with the position, (3, 3).
        motions: Components of the motion of a rigid surface that leave it what it is.
        moments: 0 for components of moments that cancel over the whole body, else 1, (3,).

    Example:
        >>> Idealisation().dim, PlaneStrain().dim, PlaneStrain(lateral=True).lateral
        (3, 2, True)
    """

    motions: ClassVar[tuple[str, ...]] = ("x", "y", "z", "rx", "ry", "rz")
    moments: ClassVar[tuple[float, float, float]] = (1.0, 1.0, 1.0)
    entry: ClassVar[Entry] = Entry("solid", "idealisation", "a body in space", ())
    dim: ClassVar[int] = 3
    lateral: bool = True
    #: :meta private:
    offset: Floats = read_only(np.zeros(3))
    #: :meta private:
    turn: Floats = read_only(np.zeros((3, 3)))

    def gradient(self, u: Any) -> Any:
        """Gradient of a displacement, (3, 3), UFL."""
        return ufl.grad(u)

    def seen(self, expression: Any, u: Any) -> Any:
        """An expression of `grad(u)` as one of `gradient(u)`, UFL."""
        return expression

    def stress(self, expression: Any, u: Any) -> Any:
        """The same for the stress of a linear material, (3, 3), UFL, stress."""
        return self.seen(expression, u)

    def at_nodes(self, expression: Any, u: Any) -> Any:
        """The same for any material where values at nodes are wanted, on the axis too.

        Args:
            expression: The stress, UFL.
            u: Displacement, a DOLFINx function.
        """
        return self.stress(expression, u)

    def weight(self, mesh: Any) -> Any:
        """Length across the plane, UFL: what integrals over the mesh are multiplied with."""
        return 1.0

    def check_material(self, material: Any, field: str) -> None:
        """Refuse a material that is not known under this idealisation.

        Raises:
            InputError: It is not.
        """

    def held(self, x: Floats) -> Iterator[tuple[Ints, int]]:
        """Nodes that cannot move along an axis of space, and the axis.

        Args:
            x: Positions of the nodes, (nodes, 3), length.
        """
        return iter(())

    def resisted(self, centre: Floats) -> Floats:
        """Rigid motions `t + w x (x - centre)` that strain the body: rows of (t, w), (r, 6).

        Those that are no combination of these rows do not.

        Args:
            centre: About which bodies turn, (3,), length.
        """
        return np.zeros((0, 6))

    @property
    def of_faces(self) -> tuple[str, ...]:
        """Components of the motion of a reference point that a face can follow."""
        return tuple(name for name in self.motions if self.lateral or name not in ("z", "ry"))

    def check_reference(self, point: Floats, field: str) -> None:
        """Refuse a reference point about which no face can turn.

        Args:
            point: The point, (3,), length.
            field: What messages call it.

        Raises:
            InputError: It is one.
        """

    def check_points(self, x: Floats) -> None:
        """Refuse nodes where no body can be.

        Args:
            x: Corners of the box around them, (2, 3), length.

        Raises:
            InputError: There are such nodes.
        """

    def across(self, x: Floats) -> Floats:
        """Tangents across the plane at points, (..., 3), length."""
        return np.asarray(self.offset + x @ self.turn.T)

    def image(self, share: float) -> tuple[Floats, Floats]:
        """Rotation, (3, 3), and translation, (3,), to another plane that is as this one.

        Args:
            share: Share of the thickness, or of a full turn.
        """
        return scipy.linalg.expm(share * self.turn), share * self.offset


class _Plane(Idealisation):
    """A mesh in the plane z = 0."""

    dim = 2
    lateral = False
    motions: ClassVar[tuple[str, ...]] = ("x", "y", "z", "rz")

    def gradient(self, u: Any) -> Any:
        """As of `Idealisation`: `grad(u) + (turn u / |t|) (x) e_z`."""
        plane = ufl.grad(u)
        if not self.turn.any():
            return plane
        side = ufl.as_matrix(self.turn.tolist()) * u / self.weight(u)
        return plane + ufl.outer(side, ufl.as_vector([0.0, 0.0, 1.0]))

    def seen(self, expression: Any, u: Any) -> Any:
        """As of `Idealisation`."""
        return ufl.replace(expression, {ufl.grad(u): self.gradient(u)})

    def weight(self, mesh: Any) -> Any:
        """As of `Idealisation`."""
        if not self.turn.any():
            return float(self.offset[2])
        domain = mesh if hasattr(mesh, "topology") else ufl.domain.extract_unique_domain(mesh)
        return float(self.turn[2, 0]) * ufl.SpatialCoordinate(domain)[0]

    def held(self, x: Floats) -> Iterator[tuple[Ints, int]]:
        """As of `Idealisation`."""
        if not self.lateral:
            yield np.arange(len(x)), 2

    def resisted(self, centre: Floats) -> Floats:
        """As of `Idealisation`: turns out of the plane."""
        return np.eye(6)[3:5]

    def check_points(self, x: Floats) -> None:
        """As of `Idealisation`."""
        size = np.abs(x).max(initial=0.0)
        if np.abs(x[:, 2]).max(initial=0.0) > ON_AXIS * size:
            text = "the mesh leaves the plane z = 0, in which one of two dimensions has to lie"
            raise InputError(text, "mesh")


@dataclass(frozen=True, eq=False)
class _Sheet(_Plane):
    """A plane of some thickness."""

    thickness: float = 1.0

    def __post_init__(self) -> None:
        registry.check(_THICKNESS, self.thickness)
        object.__setattr__(self, "offset", read_only(np.array([0.0, 0.0, float(self.thickness)])))


@typed
@dataclass(frozen=True, eq=False)
class PlaneStrain(_Sheet):
    """Nothing depends on z.

    Args:
        thickness: Extent across the plane, > 0, length: forces are those on it.
        lateral: Whether displacements along z are unknowns (antiplane shear), or zero.

    Example:
        >>> PlaneStrain(thickness=2.0).across(np.zeros(3)).tolist()
        [0.0, 0.0, 2.0]
    """

    lateral: bool = False

    entry: ClassVar[Entry] = Entry(
        "plane-strain",
        "idealisation",
        "nothing depends on z; the displacement along z is zero, or an unknown if lateral",
        (_THICKNESS, _LATERAL),
    )


@typed
@dataclass(frozen=True, eq=False)
class PlaneStress(_Sheet):
    """A thin sheet: the stress has no component along z.

    The strains across the sheet are those that make it so; they are found in closed form, for
    linear materials [Ting 1996, section 3.10].

    Args:
        thickness: Thickness of the sheet, > 0, length.

    Example:
        >>> PlaneStress(thickness=2.0).lateral
        False
    """

    entry: ClassVar[Entry] = Entry(
        "plane-stress", "idealisation", "a thin sheet of linear material", (_THICKNESS,)
    )

    def stress(self, expression: Any, u: Any) -> Any:
        """As of `Idealisation`, with the strains across that make `stress e_z = 0`."""
        e = [ufl.as_vector(row) for row in np.eye(3).tolist()]

        def at(gradient: Any) -> Any:
            return ufl.replace(expression, {ufl.grad(u): gradient})

        plane = self.gradient(u)
        rest = at(ufl.as_matrix(np.zeros((3, 3)).tolist())) * e[2]
        columns = [at(ufl.outer(one, e[2])) * e[2] - rest for one in e]
        stiffness = ufl.as_matrix([[columns[j][i] for j in range(3)] for i in range(3)])
        across = -ufl.inv(stiffness) * (at(plane) * e[2])
        return at(plane + ufl.outer(across, e[2]))

    def check_material(self, material: Any, field: str) -> None:
        """As of `Idealisation`: strains across the sheet are known for linear ones alone."""
        if not material.linear:
            text = "plane stress needs a linear material; take plane strain, or a body in space"
            raise InputError(text, field)
        if hasattr(material, "parts"):
            raise InputError("plane stress does not lock; take linear-elastic", field)


@typed
@dataclass(frozen=True, eq=False)
class Axisymmetric(_Plane):
    """The half plane x >= 0 turned about the axis x = 0: x is the radius, y the height.

    Forces are those on the whole circumference. The gradient is exact at finite strain and twist:
    a point at the angle a is at `R(a) (X + u)`, so `du / ds = (-u_z, 0, u_x) / x` around.

    Args:
        lateral: Whether displacements along z are unknowns (twist), or zero.

    Example:
        >>> np.round(Axisymmetric().across(np.array([1.0, 0.0, 0.0])) / np.pi, 12).tolist()
        [0.0, 0.0, 2.0]
    """

    lateral: bool = False

    entry: ClassVar[Entry] = Entry(
        "axisymmetric",
        "idealisation",
        "x is the radius and y the axis; displacements around are zero, or unknowns if lateral",
        (_LATERAL,),
    )
    motions: ClassVar[tuple[str, ...]] = ("y", "ry")
    moments: ClassVar[tuple[float, float, float]] = (0.0, 1.0, 0.0)
    turn = read_only(2.0 * math.pi * np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]))

    def at_nodes(self, expression: Any, u: Any) -> Any:
        """As of `Idealisation`: on the axis `u / x` is `du / dx`."""
        places = u.function_space.mesh.geometry.x
        least = ON_AXIS * float(np.abs(places).max(initial=0.0))
        plane, turn = ufl.grad(u), ufl.as_matrix((self.turn / self.turn[2, 0]).tolist())
        x = ufl.SpatialCoordinate(ufl.domain.extract_unique_domain(u))[0]
        on_axis = ufl.as_vector([plane[i, 0] for i in range(3)])
        side = turn * ufl.conditional(ufl.gt(x, least), u / x, on_axis)
        gradient = plane + ufl.outer(side, ufl.as_vector([0.0, 0.0, 1.0]))
        return ufl.replace(expression, {plane: gradient})

    def held(self, x: Floats) -> Iterator[tuple[Ints, int]]:
        """As of `Idealisation`: what is on the axis stays there."""
        yield from super().held(x)
        on_axis = np.flatnonzero(x[:, 0] <= ON_AXIS * np.abs(x).max(initial=0.0))
        yield on_axis, 0
        if self.lateral:
            yield on_axis, 2

    def resisted(self, centre: Floats) -> Floats:
        """As of `Idealisation`: all but `t_y` and the turn about the axis, `u_z ~ x`."""
        t_x, _, t_z, w_x, w_y, w_z = np.eye(6)
        away = np.hypot(1.0, centre[0])  # a thin ring's row is of the size of the others
        return np.array([t_x, w_z, w_x, (t_z + centre[0] * w_y) / away])

    def check_reference(self, point: Floats, field: str) -> None:
        """As of `Idealisation`: it is on the axis."""
        if point[0] or point[2]:
            given = ", ".join(f"{v:g}" for v in point)
            text = f"the reference point ({given}) is beside the axis x = z = 0"
            raise InputError(text, field)

    def check_points(self, x: Floats) -> None:
        """As of `Idealisation`."""
        super().check_points(x)
        least = x[:, 0].min(initial=0.0)
        if least < -ON_AXIS * np.abs(x).max(initial=0.0):
            text = f"the mesh goes to x = {least:g}, but x is the distance from the axis, >= 0"
            raise InputError(text, "mesh")


SOLID = Idealisation()
_KINDS: dict[str, Any] = {i.entry.name: i for i in (PlaneStrain, PlaneStress, Axisymmetric)}


def idealisations() -> tuple[Entry, ...]:
    """What meshes of two dimensions can be taken for.

    Returns:
        An entry for each.

    Example:
        >>> [entry.name for entry in idealisations()]
        ['plane-strain', 'plane-stress', 'axisymmetric']
    """
    return tuple(kind.entry for kind in _KINDS.values())


def make_idealisation(kind: str, **parameters: Any) -> Idealisation:
    """Idealisation by name.

    Args:
        kind: "plane-strain", "plane-stress" or "axisymmetric".
        **parameters: Its parameters.

    Returns:
        The idealisation.

    Raises:
        InputError: Unknown name or parameter, or one that is out of range.

    Example:
        >>> make_idealisation("plane-strain", thickness=3.0).offset.tolist()
        [0.0, 0.0, 3.0]
    """
    entry = registry.entry(idealisations(), kind, "kind")
    registry.values(entry, parameters)
    found: Idealisation = _KINDS[kind](**parameters)
    return found
