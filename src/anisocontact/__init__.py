"""Frictional contact of surfaces that have a direction: anisotropic adhesion and friction."""

from importlib.metadata import version

__all__ = ["__version__"]

__version__ = version("anisocontact")
