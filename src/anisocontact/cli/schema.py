"""`anisocontact schema`."""

from __future__ import annotations

import argparse
import json

from anisocontact.case import json_schema

__all__ = ["command"]


def command(arguments: argparse.Namespace) -> int:
    """Print the JSON Schema of the case file."""
    print(json.dumps(json_schema(), indent=2))
    return 0
