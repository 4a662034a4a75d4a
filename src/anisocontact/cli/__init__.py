"""The command `anisocontact`: it reads arguments, calls the library and turns errors into codes."""

from anisocontact.cli.main import build_parser, command, main

__all__ = ["build_parser", "command", "main"]
