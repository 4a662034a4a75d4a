"""Frictional contact of surfaces that have a direction: anisotropic adhesion and friction."""

from importlib.metadata import version

from anisocontact.base import import_hooks
from anisocontact.base.errors import InputError

__all__ = ["InputError", "__version__"]

__version__ = version("anisocontact")

import_hooks.install()
