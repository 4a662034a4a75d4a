"""Materials of the bodies and the forces inside them."""

from anisocontact.bulk.linear import LinearBulk
from anisocontact.bulk.materials import LinearElastic, Material, make_material, materials

__all__ = ["LinearBulk", "LinearElastic", "Material", "make_material", "materials"]
