"""`anisocontact schema`."""

from __future__ import annotations

import argparse
import json

from anisocontact.case import json_schema


def command(arguments: argparse.Namespace) -> int:
    """Print the JSON Schema of the case file."""
    if arguments.trace:
        from anisocontact.case.trace import trace_schema

        print(json.dumps(trace_schema(), indent=2))
    else:
        print(json.dumps(json_schema(), indent=2))
    return 0
