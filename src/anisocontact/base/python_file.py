"""Modules from Python files that somebody names."""

from __future__ import annotations

import importlib.util
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

__all__ = ["module_of", "where_failed"]


def module_of(path: Path) -> ModuleType:
    """Run a Python file as a module, with all rights of whoever runs the program.

    Modules beside the file can be imported by it.

    Args:
        path: The file.

    Raises:
        ImportError: Its name is none of a Python file.
        Exception: Whatever the file raises.
    """
    name = f"_law_of_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"'{path}' is no Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look themselves up there
    with _beside(path):
        spec.loader.exec_module(module)
    return module


def where_failed(error: BaseException) -> str:
    """An error of somebody's code in one line: file and line, and what it says."""
    at: tuple[str | None, int | None] = (None, None)
    if isinstance(error, SyntaxError):
        at = (error.filename, error.lineno)
    elif frames := traceback.extract_tb(error.__traceback__)[1:]:
        at = (frames[-1].filename, frames[-1].lineno)
    said = " ".join(f"{type(error).__name__}: {getattr(error, 'msg', None) or error}".split())
    return said if at[0] is None else f"{Path(at[0]).name}, line {at[1]}: {said}"


@contextmanager
def _beside(path: Path) -> Iterator[None]:
    sys.path.insert(0, str(path.resolve().parent))
    try:
        yield
    finally:
        del sys.path[0]
