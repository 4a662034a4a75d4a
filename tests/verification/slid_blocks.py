"""Two blocks, one moved over the other: forces of their contact, and what the tangent makes."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from anisocontact.contact import Contact
from anisocontact.mesh import BoxSpec, Model, build_box

Floats = npt.NDArray[np.float64]


def offset_pair(cell: str, order: int) -> Model:
    """A block above one that is larger, on meshes that do not match."""
    upper = BoxSpec((0.1, 0.05, 0), (1, 1, 1), (3, 3, 1), cell=cell, order=order)
    lower = BoxSpec((-0.5, -0.5, -1), (2.2, 2.1, 1), (4, 5, 1), cell=cell, order=order)
    return build_box({"upper": upper, "lower": lower})


def slid(contact: Contact, model: Model) -> Floats:
    """Two committed increments of warped surfaces, and displacements on the way to a third one."""
    rng = np.random.default_rng(3)
    u = np.zeros_like(model.space.tabulate_dof_coordinates())
    block = np.unique(model.space.dofmap.list[model.cells("upper")])
    for way, noise in (((0.02, 0.01, -0.02), 0.01), ((0.3, 0.12, -0.01), 0.004)):
        u[block] += way
        u += noise * rng.normal(size=u.shape)
        contact.update(u, 1.0)
        contact.commit()
    u[block] += (-0.03, 0.015, -0.002)
    return u + 0.002 * rng.normal(size=u.shape)


def force_of(contact: Contact, u: Floats) -> Floats:
    """Forces on the nodes, (nodes, 3), where these are displaced by u."""
    contact.update(u, 1.0)
    out = np.zeros_like(u)
    contact.add_force(out)
    return out


def linear_force(contact: Contact, way: Floats) -> Floats:
    """What the tangent makes of a displacement, (nodes, 3)."""
    out = np.zeros_like(way)
    for rows, columns, blocks in contact.answer.couplings():
        square = blocks.reshape(len(rows), rows.shape[1], 3, columns.shape[1], 3)
        there = np.where(columns[..., None] >= 0, way[columns], 0.0)
        found = -np.einsum("pricj,pcj->pri", square, there)
        np.add.at(out, rows[rows >= 0], found[rows >= 0])
    return out
