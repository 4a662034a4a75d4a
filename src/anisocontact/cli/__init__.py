"""The command `anisocontact`: it reads arguments, calls the library and turns errors into codes."""

from anisocontact.cli.main import build_parser, main

__all__ = ["build_parser", "main"]
