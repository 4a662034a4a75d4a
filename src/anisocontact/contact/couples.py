"""Couples of forces that act on the slave at one place and on the master at another."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.surfaces import Jet

Floats = npt.NDArray[np.float64]
Mask = npt.NDArray[np.bool_]


class Couples:
    """Forces on the tangents of the master that balance the moments at points of the overlaps.

    The share F_g of the force of a slave point g acts on the master at rho instead of at x_g. Its
    moment differs by that of the arm from rho to the point x of the overlap, a = x - rho, of which
    friction alone has one, and of d_g, which is what x_g lies beside the mean of the points over
    which F_g is spread. The master's facet carries both arms: the virtual work `m_j . delta rho_j`,

        m_j = n (n . V rho^j) - V^T rho^j ,    V = a (x) T + sum_g d_g (x) F_g ,

    makes bodies that turn together do no work. T is the part of the sum of all F_g that is normal
    to a, see `kernel/couple.hpp`.

    Args:
        jet: The master at the points, tangents and second derivatives, (s, ...).
        arm: a, (s, 3), length.
        interior: Whether a is normal to the facet, (s,).
        force: Sum of the shares of all slave points, (s, 3), force.
        virial: Sum of d_g (x) F_g, (s, 3, 3), force times length.
        off: d_g, (s, q, 3), length.

    Attributes:
        off: As given.
    """

    def __init__(
        self, jet: Jet, arm: Floats, interior: Mask, force: Floats, virial: Floats, off: Floats
    ) -> None:
        tangents = np.asarray(jet.d1)
        self._second = np.asarray(jet.d2)[:, [[0, 1], [1, 2]]]
        self._tangents, self._arm, self._force, self.off = tangents, arm, force, off
        self._metric = np.linalg.inv(tangents @ tangents.swapaxes(1, 2))
        self._dual = self._metric @ tangents
        cross = np.cross(tangents[:, 0], tangents[:, 1])
        self._normal = cross / np.linalg.norm(cross, axis=1)[:, None]
        self._interior = interior
        length = np.linalg.norm(arm, axis=1)
        beside = ~interior & (length > 0.0)
        self._length = np.where(beside, length, 1.0)
        along = np.where(beside[:, None], arm / self._length[:, None], self._normal)
        self._along = along
        self._flat = np.eye(3) - along[:, :, None] * along[:, None, :]
        self._friction = np.einsum("sij,sj->si", self._flat, force)
        self._virial = arm[:, :, None] * self._friction[:, None, :] + virial
        self._lifted = np.einsum("sik,sjk->sji", self._virial, self._dual)  # V rho^j

    def on_tangents(self) -> Floats:
        """The forces m_j, (s, 2, 3), force times length."""
        raised = np.einsum("si,sji->sj", self._normal, self._lifted)
        fall = np.einsum("ski,sjk->sji", self._virial, self._dual)
        return np.asarray(raised[..., None] * self._normal[:, None] - fall)

    def by_force(self, share: Floats, g: int) -> Floats:
        """Derivative of m_j by the force of a slave point.

        Args:
            share: Share of the force that acts at each point, (s,).
            g: The slave point, by its number on the facet.

        Returns:
            (s, 2, 3, 3), length.
        """
        both = self._carried(self._arm) @ self._flat[:, None] + self._carried(self.off[:, g])
        return np.asarray(share[:, None, None, None] * both)

    def by_place(
        self,
        slave: Floats,
        master: Floats,
        first: Floats,
        share: Floats,
        off: Floats,
        force: Floats,
    ) -> tuple[Floats, Floats, Floats]:
        """Derivatives of m_j at fixed forces.

        Args:
            slave: Shape functions of the slave at the points, (s, k).
            master: Those of the master, (s, m).
            first: Their derivatives, (s, m, 2).
            share: Shares of the slave points, (s, q).
            off: Shape functions of the slave that give d_g, (s, q, k).
            force: Forces of the slave points, (s, q, 3).

        Returns:
            By the nodes of the slave (s, 2, k, 3, 3) and of the master (s, 2, m, 3, 3), and by the
            coordinates of the projection, (s, 2, 2, 3) with the coordinate second.
        """
        by_arm, by_tangent = self._by_arm(), self._by_tangent()
        spread = np.einsum("sgk,sg,sgi->ski", off, share, force, optimize=True)
        by_slave = slave[:, None, :, None, None] * by_arm[:, :, None]
        by_slave += np.einsum(
            "si,sn,skm,sjm->sjkin", self._normal, self._normal, spread, self._dual, optimize=True
        )
        by_slave -= np.einsum("ski,sjn->sjkin", spread, self._dual)
        by_master = np.einsum("sml,sjlin->sjmin", first, by_tangent, optimize=True)
        by_master -= master[:, None, :, None, None] * by_arm[:, :, None]
        by_xi = np.einsum("sjkin,skln->sjli", by_tangent, self._second, optimize=True)
        by_xi -= np.einsum("sjin,sln->sjli", by_arm, self._tangents)
        return by_slave, by_master, by_xi

    def _carried(self, arm: Floats) -> Floats:
        """Matrices n (n . arm) rho^j - (rho^j . arm) 1, by which forces give m_j, (s, 2, 3, 3)."""
        above = np.sum(self._normal * arm, axis=1)
        beside = np.einsum("sji,si->sj", self._dual, arm)
        lever = (above[:, None] * self._normal)[:, None, :, None] * self._dual[:, :, None, :]
        return np.asarray(lever - beside[..., None, None] * np.eye(3))

    def _by_direction(self) -> Floats:
        """Derivative of m_j by the direction that T is normal to, (s, 2, 3, 3)."""
        pressing = np.sum(self._force * self._along, axis=1)
        turned = self._along[:, :, None] * self._force[:, None, :]
        turned += pressing[:, None, None] * np.eye(3)
        return np.asarray(-self._carried(self._arm) @ turned[:, None])

    def _by_arm(self) -> Floats:
        """Derivative of m_j by a, (s, 2, 3, 3)."""
        up = np.einsum("si,sji->sj", self._friction, self._dual)
        normal = self._normal[:, :, None] * self._normal[:, None, :]
        out = up[..., None, None] * normal[:, None]
        out -= self._friction[:, None, :, None] * self._dual[:, :, None, :]
        turn = np.where(
            self._interior[:, None, None], 0.0, self._flat / self._length[:, None, None]
        )
        return np.asarray(out + self._by_direction() @ turn[:, None])

    def _by_tangent(self) -> Floats:
        """Derivative of m_j by the tangent k at a fixed arm, (s, 2, 2, 3, 3)."""
        n, dual = self._normal, self._dual
        turn = -dual[..., None] * n[:, None, None, :]  # of n, (s, k, 3, 3)
        stretch = -np.einsum("ski,sjn->sjkin", dual, dual)
        stretch += np.einsum("sjk,si,sn->sjkin", self._metric, n, n, optimize=True)
        raised = np.einsum("si,sji->sj", n, self._lifted)
        out = raised[:, :, None, None, None] * turn[:, None]
        leaned = np.einsum("skmn,sjm->sjkn", turn, self._lifted)
        out += n[:, None, None, :, None] * leaned[:, :, :, None, :]
        tilt = n[:, :, None] * np.einsum("smi,sm->si", self._virial, n)[:, None, :]
        tilt -= self._virial.swapaxes(1, 2)
        out += np.einsum("sim,sjkmn->sjkin", tilt, stretch, optimize=True)
        inside = np.where(self._interior[:, None, None, None], self._by_direction(), 0.0)
        return np.asarray(out + inside[:, :, None] @ turn[:, None])
