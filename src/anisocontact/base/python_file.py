"""Modules from Python files that somebody names."""

from __future__ import annotations

import ast
import importlib.util
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType

from anisocontact.base.errors import InputError


def module_of(path: Path) -> ModuleType:
    """Run a Python file as a module, with all rights of whoever runs the program.

    Modules beside the file can be imported by it.

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


def imported_beside(path: Path) -> list[Path]:
    """Python files in the folder of one that it imports, and those that these import.

    Args:
        path: The file; nothing is run.

    Returns:
        The other files, in the order in which they are found; none where the file is no Python.
    """
    found = [path]
    for file in found:
        others = (path.with_name(f"{name}.py") for name in _imports(file))
        found += [
            other for other in dict.fromkeys(others) if other not in found and other.is_file()
        ]
    return found[1:]


def _imports(path: Path) -> Iterator[str]:
    """Names of the modules that a file imports."""
    try:
        tree = ast.parse(path.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name.partition(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            yield node.module.partition(".")[0]


def where_failed(error: BaseException) -> str:
    """An error of somebody's code in one line: file and line, and what it says."""
    at: tuple[str | None, int | None] = (None, None)
    if isinstance(error, SyntaxError):
        at = (error.filename, error.lineno)
    elif frames := _readable(traceback.extract_tb(error.__traceback__)[1:]):
        at = (frames[-1].filename, frames[-1].lineno)
    said = " ".join(f"{type(error).__name__}: {getattr(error, 'msg', None) or error}".split())
    return said if at[0] is None else f"{Path(at[0]).name}, line {at[1]}: {said}"


def called[T](function: Callable[..., T], *arguments: object, who: str, field: str = "") -> T:
    """What a function of somebody's returns.

    Args:
        function: The function.
        *arguments: What it is given.
        who: What messages call it.
        field: Where it was given, for messages.

    Raises:
        InputError: It failed; one that it raised itself is a line already.

    Example:
        >>> called(lambda x: 1 / x, 0, who="load")
        Traceback (most recent call last):
        anisocontact.base.errors.InputError: load failed: ...: ZeroDivisionError: division by zero
    """
    try:
        return function(*arguments)
    except InputError:
        raise
    except (Exception, SystemExit) as error:
        raise InputError(f"{who} failed: {where_failed(error)}", field) from error


def _readable(frames: list[traceback.FrameSummary]) -> list[traceback.FrameSummary]:
    """Those that stand in files: not what Python itself has frozen, as `exit`."""
    return [frame for frame in frames if not frame.filename.startswith("<frozen")]


@contextmanager
def _beside(path: Path) -> Iterator[None]:
    sys.path.insert(0, str(path.resolve().parent))
    try:
        yield
    finally:
        del sys.path[0]
