"""Default of the normal penalty."""

from __future__ import annotations

from anisocontact.base.typed import typed
from anisocontact.bulk import Material
from anisocontact.contact.quadrature import facet_quadrature, mean_size
from anisocontact.mesh import Model

#: Penalty in units of Young's modulus over the facet size: a pressure p lets the surfaces overlap
#: by `h p / (10 E)`, a tenth of what one layer of elements gives way.
PENALTY_FACTOR = 10.0


@typed
def facet_size(model: Model, facet_group: str) -> float:
    """Length of a facet of a group: square root of the mean area, or in the plane mean length.

    Args:
        model: Mesh with the group.
        facet_group: Its name, "body.group".

    Returns:
        The size [length].

    Example:
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"a": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> round(facet_size(model, "a.top"), 12)
        0.5
    """
    facets = model.facets(facet_group)
    quadrature = facet_quadrature(model.space, facets, 2, model.idealisation)
    return mean_size(quadrature, model.mesh.comm)


def auto_penalty(
    model: Model, slave: str, material: Material, factor: float = PENALTY_FACTOR
) -> float:
    """Normal penalty `factor E / h`, the same physical stiffness in any units.

    Args:
        model: Mesh with the facet group.
        slave: Facet group "body.group"; h is the square root of its mean facet area.
        material: Material of the slave's body, E its Young's modulus.
        factor: Dimensionless factor, > 0.

    Returns:
        The penalty, stress/length.

    Example:
        >>> from anisocontact.bulk import make_material
        >>> from anisocontact.mesh import BoxSpec, build_box
        >>> model = build_box({"block": BoxSpec((0, 0, 0), (1, 1, 1), (2, 2, 2))})
        >>> steel = make_material("linear-elastic", E=50.0, nu=0.3)
        >>> round(auto_penalty(model, "block.bottom", steel), 6)
        1000.0
    """
    return factor * material.young / facet_size(model, slave)
