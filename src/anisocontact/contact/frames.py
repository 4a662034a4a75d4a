"""Tangents and normals of the master at slave points, and how vectors go from one to another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from anisocontact.base.array_types import Floats
from anisocontact.contact.plane_axes import unit_normal

# Half the squared sum of two unit normals below which they are opposite.
_OPPOSITE = 1e-12


@dataclass(frozen=True)
class Frames:
    """Tangents of the master and its normal at n points.

    Attributes:
        tangents: First derivatives of the position, (n, 2, 3), length.
        normal: Unit normal, (n, 3).
    """

    tangents: Floats
    normal: Floats

    @classmethod
    def of(cls, tangents: Floats) -> Frames:
        """Frames with the normal of the tangents, (n, 2, 3)."""
        return cls(tangents, unit_normal(tangents))

    def vector(self, covector: Floats) -> Floats:
        """Vectors (n, 3) of covariant components (n, 2).

        Where a correction has laid nodes of a facet on one line there are no such vectors: they
        are not numbers, and the correction is taken back.
        """
        metric = np.einsum("nid,njd->nij", self.tangents, self.tangents)
        try:
            contra = np.linalg.solve(metric, covector[..., None])[..., 0]
        except np.linalg.LinAlgError:
            flat = np.linalg.det(metric) == 0.0
            metric[flat] = np.eye(2)
            contra = np.linalg.solve(metric, covector[..., None])[..., 0]
            contra[flat] = np.nan
        return self.moved(contra)

    def moved(self, contra: Floats) -> Floats:
        """Vectors (n, 3) of contravariant components (n, 2)."""
        return np.asarray(np.einsum("ni,nid->nd", contra, self.tangents))

    def chord(self, path: Floats, spin: Floats) -> Floats:
        """Chords (n, 3) of the paths that they span where the slave turns by `spin`, (n,)."""
        half = 0.5 * spin
        along = np.divide(half, np.tan(half), out=np.ones_like(half), where=half != 0.0)
        across = np.cross(self.normal, path)
        return np.asarray(
            (along[:, None] * path - half[:, None] * across) / (along**2 + half**2)[:, None]
        )

    def turned_to(self, other: Frames, vectors: Floats) -> Floats:
        """Tangent vectors turned with the least rotation of the normal, (n, 3)."""
        both = self.normal + other.normal
        # Opposite normals have no least rotation: there a tangent vector stays as it is.
        squared = 0.5 * np.einsum("nd,nd->n", both, both)
        share = np.einsum("nd,nd->n", vectors, other.normal) / np.maximum(squared, _OPPOSITE)
        return np.asarray(vectors - share[:, None] * both)
