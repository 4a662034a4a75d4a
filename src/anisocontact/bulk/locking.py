"""Bodies that are nearly incompressible without a pressure that helps them.

Their cells of order 1 lock; those of order 2 take many corrections at finite strain.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from anisocontact.bulk.expansion import without_expansion
from anisocontact.bulk.materials import small_strain
from anisocontact.mesh import Model, PlaneStress

#: Poisson's ratio from which on it is told. A sphere pressed into a block, 20 quadrilaterals across
#: the contact: forces 4 % too large at 0.48, 7 % at 0.49, 38 % at 0.499; triangles 12, 19, 87 %.
NEARLY = 0.48
#: That from which on it is told of cells of order 2 at finite strain. A sphere pressed into a
#: neo-Hookean block that is stretched by a tenth, four increments: 36 corrections at 0.49, 43 at
#: 0.499, 284 and two cuts at 0.4999, 600 and four cuts at 0.49999; 22 with a pressure in every
#: cell.
STEEP = 0.4995
#: Cells of which a pressure does not help: there are too few displacements for each of them.
_SIMPLICES = ("triangle", "tetrahedron")


def locking_bodies(model: Model, materials: Mapping[str, Any]) -> list[str]:
    """What is to be known of bodies that are much too stiff, or hard to solve for, a line each.

    Args:
        model: The bodies.
        materials: Body name -> material.

    Returns:
        The body, and what helps.

    Example:
        >>> from anisocontact.bulk import make_material
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> soft = {"block": make_material("linear-elastic", E=1.0, nu=0.499)}
        >>> len(locking_bodies(model, soft))
        1
    """
    if isinstance(model.idealisation, PlaneStress):
        return []  # sheets give way through their thickness
    simplex = model.mesh.topology.cell_name() in _SIMPLICES
    cure = "take order 2" if simplex else "take a model that is called -incompressible, or order 2"
    steep = [
        f"body {body!r}: at nu = {material.nu:g} corrections at finite strain change volumes, "
        "which is that stiff, and many of them are needed; take neo-hookean-incompressible or "
        "another rubber"
        for body, material in ((body, without_expansion(one)) for body, one in materials.items())
        if not (model.order == 1 or body in model.linear)
        and getattr(material, "nu", 0.0) >= STEEP
        and not (small_strain(material) or hasattr(material, "volume"))
    ]
    return steep + [
        f"body {body!r}: at nu = {material.nu:g} its cells of order 1 lock, and forces are too "
        f"large, by some per cent at 0.48 and by half and more at 0.499; {cure}"
        for body, material in ((body, without_expansion(one)) for body, one in materials.items())
        if (model.order == 1 or body in model.linear)
        and getattr(material, "nu", 0.0) >= NEARLY
        and (simplex or not hasattr(material, "volume"))
    ]
