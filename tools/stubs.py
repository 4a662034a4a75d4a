"""Writes src/anisocontact/_core.pyi, the types of the C++ core, from the built extension."""

import importlib
import re
from pathlib import Path

from nanobind.stubgen import StubGen

STUB = Path(__file__).resolve().parents[1] / "src" / "anisocontact" / "_core.pyi"


def stub() -> str:
    """Text of the stub of the extension as it is built now."""
    core = importlib.import_module("anisocontact._core")
    generator = StubGen(core)
    generator.put(core)
    text = generator.get()
    text = re.sub(r"Annotated\[(NDArray\[numpy\.\w+\]), dict\([^\]]*?\)\]", r"\1", text)
    text = text.replace("from typing import Annotated", "from typing import Any")
    for plain, full in {"dict": "dict[str, NDArray[Any]]", "list": "list[Any]"}.items():
        text = text.replace(f"-> {plain}:", f"-> {full}:")
    for loose in ("tuple", "object"):
        text = text.replace(f"-> {loose}:", "-> Any:")
    return text


if __name__ == "__main__":
    STUB.write_text(stub())
