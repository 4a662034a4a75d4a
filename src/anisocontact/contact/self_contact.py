"""Self-contact, a body that folds onto itself: facets of a group against others of the group."""

from __future__ import annotations

from anisocontact.contact.facet_contact import FacetContact
from anisocontact.contact.penalty import facet_size
from anisocontact.interface import ContactLaw
from anisocontact.mesh import Model

#: Reference distance below which facets do not meet, in facet sizes: more than the search reaches,
#: so that nothing touches at the start.
APART = 3.0


class SelfContact(FacetContact):
    """Contact of a facet group with itself.

    Every facet is slave and master: each side of the fold carries half of the weight, as in two
    half passes, and forces go to the other side over the overlaps of the facets. What is near in
    the reference configuration does not count: neighbours, and the other side of a thin wall.
    Resultants are sums of what the points get as slaves, on both sides: what is left is small.
    Directions are those of the side that is met.

    Args:
        model: Mesh with the group.
        group: Facet group "body.group".
        law: Laws of the interface.
        degree: Degree of the quadrature; twice the order of the displacement if not given.
        apart: Facets nearer to each other than this in the reference configuration do not meet,
            length; three facet sizes if not given. Sides of a narrow gap need less.
        reach: Distance within which a point searches, length; twice the facet size, at most
            `apart`, if not given.
        current_area: As of `FacetContact`.
        name: Name in output; the group if not given.

    Raises:
        InputError: As of `FacetContact`; `apart` is not positive.
    """

    def __init__(
        self,
        model: Model,
        group: str,
        *,
        law: ContactLaw,
        degree: int | None = None,
        apart: float | None = None,
        reach: float | None = None,
        current_area: bool | None = None,
        name: str = "",
    ) -> None:
        model.facets(group, "slave")
        size = facet_size(model, group) if model.count_facets(group) else 0.0
        apart = APART * size if apart is None else apart
        super().__init__(
            model,
            group,
            group,
            law=law,
            degree=degree,
            reach=min(2.0 * size, apart) if reach is None else reach,
            current_area=current_area,
            weight=0.5,
            overlaps=True,
            apart=apart,
            name=name,
        )
