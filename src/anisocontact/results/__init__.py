"""Results of a run: `Results` reads a folder, `recorded` writes that of a script."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from anisocontact.results.quantities import register_quantity
from anisocontact.results.read import Results
from anisocontact.results.slave_points import SlavePoints

if TYPE_CHECKING:
    from anisocontact.results.script_folder import recorded

__all__ = ["Results", "SlavePoints", "recorded", "register_quantity"]


def __getattr__(name: str) -> Any:
    # finite elements are imported for what writes alone: results are read without them
    if name == "recorded":
        from anisocontact.results.script_folder import recorded

        return recorded
    raise AttributeError(f"module 'anisocontact.results' has no attribute {name!r}")
