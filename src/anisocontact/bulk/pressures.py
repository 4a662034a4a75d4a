"""Changes of volume of cells: pressures of their own in every cell, so that cells do not lock.

The energy `K/2 e^2` of a change of volume e at every point would hold a cell in more ways than it
has displacements for. Here it is that of the projection of e onto pressures of lower order that
do not go on from cell to cell, `K/2 <Pe, Pe>` with `<q, Pe> = <q, e>` for all such q: displacement
and pressure in a mixed form, of which the pressure `p = K Pe` is eliminated in each cell [Malkus
Hughes 1978; Simo Taylor Pister 1985]. What is constant in a cell is its own projection, whatever
the shape of the cell, so that a patch test holds.

A Newton correction du leaves a pressure `K de(du, du)` of second order in it that means nothing,
and a tangent with the stress of that pressure goes astray where K is large beside what the material
has against changes of shape, as in rubber, or in metal that flows. So tangents have the pressure
that the correction has led to, `K P(e + de/du du)`, and corrections are those of the mixed form in
which p is an unknown of its own. The first of them has that of the accepted state, unless that of
the iterate is near: an extrapolated state changes the volume by the square of the increment, which
K makes a pressure of, too. A line search by the residual of displacements would see that pressure
of second order again: where penalties press, rubber has one of the mixed form, see `MixedSearch`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
import scipy

from anisocontact.base.array_types import Floats
from anisocontact.base.compiled_forms import compiled
from anisocontact.base.fenicsx import Mat, Vec, assemble_into, basix, fem, ufl
from anisocontact.base.form_matrix import add_matrix
from anisocontact.base.form_rows import create_stiffness
from anisocontact.bulk.expansion import Heated
from anisocontact.bulk.followed_pressures import FollowedPressures
from anisocontact.bulk.volume import volume_of
from anisocontact.mesh import Model

#: What the stiffness of a node against changes of volume counts for, over that against changes of
#: shape at most, where what is asked is how far a surface gives way: a half space of nu = 1/2 is
#: 1.21 times as stiff as one of nu = 0.3, and nodes of it come to 1.3 times.
MOST = 1.0
#: From which on corrections are taken in full: nu = 0.4995 in a block of cubes.
IN_FULL = 250.0
#: From which on they have a line search of the mixed form beside penalties: nu = 0.46 there.
MIXED_SEARCH = 5.0
#: Change of the pressures of a cell from the accepted state to the first iterate up to which the
#: first tangent has those of the iterate, over the stiffness of the cell against changes of shape.
NEAR = 2e-3
#: Residual of displacements alone over that of both in a mixed form, at most, where pressures count
#: as of `CellPressures.force_sizes`.
OF_BOTH = 2.0**0.5


def pressure_element(space: Any) -> Any:
    """Element of the pressures below displacements, of an order that is stable with them.

    A constant in cells of order 1, the mean dilatation Q1/P0, and in simplices; a linear function
    in hexahedra and quadrilaterals of order 2, Q2/P1 [Boffi Brezzi Fortin 2013, section 8.6].
    """
    element = space.element.basix_element
    linear = element.cell_type.name in ("hexahedron", "quadrilateral") and element.degree == 2
    kind = ("DPC", 1) if linear else ("DG", 0)
    return basix.ufl.element(kind[0], element.cell_type, kind[1], dtype=np.float64)


@dataclass(frozen=True)
class VolumeRows:
    """What pressures answer to, on one process: `add_tangent` adds `B^T C^-1 B`.

    Attributes:
        slope: B, derivatives of the changes of volume `<q, e>`, (pressures, displacements).
        stiffness: C^-1, the inverse of `<q, p> / K`, of each cell, (cells, k, k).
        sizes: As of `CellPressures.force_sizes`.
    """

    slope: scipy.sparse.csr_array
    stiffness: Floats
    sizes: Floats

    def pressures(self, change: Floats) -> Floats:
        """`C^-1 e`, (pressures,)."""
        return _pressures_of(self.stiffness, change)


class CellPressures:
    """Pressures of all bodies whose material keeps its change of volume apart.

    Args:
        model: Mesh of the bodies.
        laws: Material of each body.
        u: Displacement, a DOLFINx function.
        dx: Measure over the bodies, numbered in the order of their names.
        heated: How gradients of bodies that expand are seen, by name.

    Attributes:
        of: The pressure of each of these bodies by name, a DOLFINx function.
        followed: Pressures that follow corrections; None where nothing keeps its volume apart.
        in_full: Whether corrections are to be taken in full, without a line search.
        mixed_search: Whether a line search of the mixed form pays beside penalties.
        hardness: Stiffness of a node at rest against changes of volume over the rest, at most.
        hardnesses: The same of every pressure this rank owns, the mean of its nodes, (pressures,).
    """

    def __init__(
        self,
        model: Model,
        laws: Mapping[str, Any],
        u: Any,
        dx: Any,
        heated: Mapping[str, Heated] = MappingProxyType({}),
    ) -> None:
        self._u, comm, self._rises = u, model.mesh.comm, bool(heated)
        space = fem.functionspace(model.mesh, pressure_element(model.space))
        self._pressure: Any = fem.Function(space)
        self._width = space.element.space_dimension
        self.of: dict[str, Any] = {}
        self.in_full, self.mixed_search, self.hardness = False, False, 0.0
        self.hardnesses: Floats = np.zeros(0)
        self.followed: FollowedPressures | None = None
        mass, change = self._forms(model, laws, dx, heated)
        if not self.of:
            return
        self._change = compiled(change, comm)
        self._slope_form = compiled(ufl.derivative(change, u), comm)
        self._slope = create_stiffness(self._slope_form)
        self._mass_form = compiled(mass, comm)
        self._mass = create_stiffness(self._mass_form)
        self._inverse: Mat = self._mass.duplicate()
        self._invert()
        self._stiffness: Mat = self._inverse.ptap(self._slope)
        self.followed = FollowedPressures(
            u, self._slope, self._changes, self._near, self._of_pressures
        )

    def _forms(
        self, model: Model, laws: Mapping[str, Any], dx: Any, heated: Mapping[str, Heated]
    ) -> tuple[Any, Any]:
        """`<q, p> / K` and `<q, e>` in UFL; takes note of the bodies that have pressures."""
        u, pressure = self._u, self._pressure
        space = pressure.function_space
        q, p = ufl.TestFunction(space), ufl.TrialFunction(space)
        weight = model.idealisation.weight(model.mesh)
        mass, change, self._extent_form, self._work = 0, 0, 0, 0
        for i, name in enumerate(model.body_names()):
            here = dx(i, degree=2 * model.order)
            volume = volume_of(laws[name], u) if name in laws else None
            if volume is None:
                mass += q * p * here
                continue
            self.of[name] = pressure
            stretch = heated[name].stretch if name in heated else 1.0
            ideal = heated.get(name, model.idealisation)
            size, e = weight * stretch**3, ideal.seen(volume.change(ufl.grad(u)), u)
            mass += size / volume.bulk * q * p * here
            change += size * q * e * here
            self._extent_form += size * q * here
            self._work += size * pressure * e * here
        return mass, change

    def work(self, v: Any) -> Any:
        """Virtual work of the pressures along a displacement, a linear form in UFL."""
        return ufl.derivative(self._work, self._u, v) if self.of else 0

    def evaluate(self) -> None:
        """Bring the pressures to where the displacement is now; collective."""
        if not self.of:
            return
        if self._rises:
            _assemble_anew(self._mass, self._mass_form)
            self._invert()
        assert self.followed is not None
        self._take(self.followed.of_residual(self._changes()))

    def energy(self) -> float:
        """`K/2 <Pe, Pe>` on the cells of this rank at the displacement of now."""
        if not self.of:
            return 0.0
        change = self._changes()
        return 0.5 * float((change * (self._blocks @ change)).sum())

    def cell_energies(self, count: int) -> Floats:
        """The same of each of the first cells of this rank, (count,)."""
        if not self.of:
            return np.zeros(count)
        change = self._changes()
        by_block = 0.5 * (change * (self._blocks @ change)).sum(axis=(1, 2))
        rows = self._pressure.function_space.dofmap.list[:count, 0] // self._width
        return np.asarray(by_block[rows])

    @cached_property
    def _extents(self) -> Floats:
        """Volume of every cell of this rank whose volume is kept apart, (cells,)."""
        form = compiled(self._extent_form, self._pressure.function_space.mesh.comm)
        return np.asarray(self._of_this_rank(form).sum(axis=(1, 2)))

    def strains(self) -> Floats:
        """Mean change of volume, over volume, of the pressures in tangents, (pressures,)."""
        kept = None if self.followed is None else self.followed.in_tangent
        change = self._changes() if kept is None else kept
        sums, extents = np.abs(change.sum(axis=(1, 2))), self._extents
        by_cell = np.divide(sums, extents, out=np.zeros_like(sums), where=extents > 0.0)
        return np.repeat(by_cell, self._width)

    def add_tangent(self, out: Mat, *, again: bool = False) -> None:
        """Add what the pressures change by to a matrix: `K <P de, P de>`; collective.

        Args:
            out: The matrix.
            again: Whether it is to be what the last call has added.
        """
        if not self.of:
            return
        if not again:
            _assemble_anew(self._slope, self._slope_form)
            self._inverse.ptap(self._slope, result=self._stiffness)
        if self.followed is not None:
            self.followed.linearise()
        add_matrix(out, self._stiffness)
        out.assemble()

    def rows(self) -> VolumeRows:
        """What `add_tangent` has added last, in its parts, on one process."""
        starts, columns, values = self._slope.getValuesCSR()
        slope = scipy.sparse.csr_array((values, columns, starts), self._slope.getSize())
        return VolumeRows(slope, self._blocks, self.force_sizes())

    def add_product(self, x: Vec, out: Vec) -> None:
        """Add the product of what `add_tangent` has added last with a vector; collective."""
        if self.of:
            self._stiffness.multAdd(x, out, out)

    def yielding(self, diagonal: Vec) -> Vec:
        """How stiff bodies are that may give way by shear, where their change of volume is held.

        Args:
            diagonal: Of the tangent at rest, with the pressures, force/length.

        Returns:
            The diagonal in which the pressures count `MOST` times the rest, at most.
        """
        if not self.of:
            return diagonal
        held = self._stiffness.getDiagonal().array_r
        found, rest = diagonal.copy(), diagonal.array_r - held
        shape = np.maximum(rest, np.finfo(np.float64).eps * held)
        hardest = float((held[held > 0.0] / shape[held > 0.0]).max(initial=0.0))
        self.hardness = max(self._pressure.function_space.mesh.comm.allgather(hardest))
        ratios = np.divide(held, shape, out=np.zeros_like(held), where=held > 0.0)
        self.hardnesses = self._mean_of_nodes(ratios)
        self.in_full = self.hardness > IN_FULL
        self.mixed_search = self.hardness > MIXED_SEARCH
        found.array[:] -= np.maximum(held - MOST * rest, 0.0)
        return found

    @property
    def slope(self) -> Mat:
        """B of what `add_tangent` has added last: derivatives of `<q, e>` by displacements."""
        return self._slope

    def stiffened(self, change: Floats) -> Floats:
        """Pressures of this rank for changes of volume `<q, e>`, `C^-1 e`, (pressures,)."""
        return _pressures_of(self._blocks, change)

    def force_sizes(self) -> Floats:
        """Forces that pressures of one make, by which the residual of a mixed form counts them.

        Forces of as many pressures meet at a node, so that the norm of `B^T p` is at most that of
        the pressures times these.

        Returns:
            Of the pressures of this rank, (pressures,), length^2; 1 for those that make none.
        """
        starts, _, values = self._slope.getValuesCSR()
        squares = np.concatenate([[0.0], np.cumsum(values**2)])
        sizes = np.sqrt(self._meeting * np.diff(squares[starts]))
        return np.where(sizes > 0.0, sizes, 1.0)

    @cached_property
    def _meeting(self) -> float:
        """Most pressures that have a force on one displacement, over all ranks."""
        ones = self._slope.copy()
        starts, columns, values = ones.getValuesCSR()
        ones.setValuesCSR(starts, columns, np.ones_like(values))
        ones.assemble()
        count, all_of_them = ones.createVecs()
        all_of_them.set(1.0)
        ones.multTranspose(all_of_them, count)
        return float(max(1.0, count.max()[1]))

    def stiffness_beyond(self, kept: Floats) -> Mat:
        """What `add_tangent` has added last beyond a share of it; collective.

        Args:
            kept: Share of each pressure that this rank owns, (pressures,).

        Returns:
            `B^T (1 - kept) C^-1 B`, a new matrix.
        """
        beyond, factors = self._inverse.copy(), self._inverse.createVecLeft()
        factors.array[:] = 1.0 - kept
        beyond.diagonalScale(L=factors)
        return beyond.ptap(self._slope)

    @contextmanager
    def predicted(self) -> Iterator[None]:
        """The pressures that the last correction has led to, if they follow; collective."""
        if self.followed is None or not self.followed.active:
            yield
            return
        now = self._pressure.x.array.copy()
        self._take(self.followed.for_tangent())
        yield
        self._pressure.x.array[:] = now

    def _near(self, here: Floats, accepted: Floats) -> bool:
        """Whether pressures of all cells are near those of another state, see `NEAR`."""
        away = self.hardnesses * np.abs(here - accepted).reshape(-1)
        far = bool((away > NEAR * np.repeat(self._extents, self._width)).any())
        return not self._pressure.function_space.mesh.comm.allreduce(int(far))

    def _mean_of_nodes(self, values: Floats) -> Floats:
        """Mean of values of displacements over those that change a volume, by how much they do."""
        weights = self._slope.copy()
        starts, columns, slopes = weights.getValuesCSR()
        weights.setValuesCSR(starts, columns, slopes**2)
        weights.assemble()
        given, found = weights.createVecs()
        given.array[:] = values
        weights.mult(given, found)
        sums: Floats = np.array(found.array_r)
        given.set(1.0)
        weights.mult(given, found)
        total: Floats = found.array_r
        return np.divide(sums, total, out=np.zeros_like(sums), where=total > 0.0)

    def _of_pressures(self) -> Floats:
        """`hardnesses` in the shape of `_changes`."""
        return self.hardnesses.reshape(-1, self._width, 1)

    def _changes(self) -> Floats:
        """`<q, e>` of the cells of this rank, (cells, pressures of a cell, 1)."""
        return self._of_this_rank(self._change)

    def _of_this_rank(self, form: Any) -> Floats:
        """A linear form of the pressures of this rank, (cells, pressures of a cell, 1)."""
        owned = self._pressure.x.index_map.size_local
        return np.asarray(fem.assemble_vector(form).array[:owned]).reshape(-1, self._width, 1)

    def _take(self, change: Floats) -> None:
        """Pressures of changes of volume, see `_changes`."""
        self._pressure.x.array[: change.size] = (self._blocks @ change).reshape(-1)
        self._pressure.x.scatter_forward()

    def _invert(self) -> None:
        """Inverse of `<q, p> / K`, in which no two cells meet."""
        starts, columns, values = self._mass.getValuesCSR()
        self._blocks: Floats = np.linalg.inv(values.reshape(-1, self._width, self._width))
        self._inverse.setValuesCSR(starts, columns, self._blocks.reshape(-1))
        self._inverse.assemble()


def _assemble_anew(matrix: Mat, form: Any) -> None:
    matrix.zeroEntries()
    assemble_into(matrix, form)
    matrix.assemble()


def _pressures_of(stiffness: Floats, change: Floats) -> Floats:
    """`C^-1 e` of C^-1 by cells, (cells, k, k), and e, (pressures,)."""
    if stiffness.shape[1] == 1:
        return stiffness.reshape(-1) * change
    return np.asarray((stiffness @ change.reshape(*stiffness.shape[:2], 1)).reshape(-1))
