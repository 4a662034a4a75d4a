"""The types of the C++ core that Python sees are those of the core as it is built."""

import ast
import importlib.util
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_types_of_the_core_are_of_this_build() -> None:
    """An argument that only the core gained fails here; `make format` writes the types."""
    spec = importlib.util.spec_from_file_location("stubs", ROOT / "tools" / "stubs.py")
    assert spec and spec.loader
    stubs = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(stubs)
    # as trees, for the file in the repository is formatted
    assert ast.dump(ast.parse(stubs.stub())) == ast.dump(ast.parse(stubs.STUB.read_text()))
