"""Modules from Python files that somebody names."""

from __future__ import annotations

import ast
import importlib.util
import os
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
    """Python files that one imports from its folder, packages too, and those that these import.

    Args:
        path: The file; nothing is run.

    Returns:
        The other files, in the order in which they are found; none where the file is no Python.
    """
    found, root = [path], path.parent
    for file in found:
        found += [
            other
            for other in dict.fromkeys(_imports(file, root))
            if other not in found and other.is_relative_to(root) and other.is_file()
        ]
    return found[1:]


def _imports(file: Path, root: Path) -> Iterator[Path]:
    """Where the modules that a file imports would be, in the folder `root` or in packages there."""
    try:
        tree = ast.parse(file.read_bytes())
    except (OSError, SyntaxError, ValueError):
        return
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield from _places(root, alias.name)
        elif isinstance(node, ast.ImportFrom):
            start = file.parents[min(node.level, len(file.parents)) - 1] if node.level else root
            for alias in node.names:  # a name may be that of a module
                yield from _places(start, ".".join(filter(None, [node.module, alias.name])))


def _places(root: Path, name: str) -> Iterator[Path]:
    """Files that are run where a module of a dotted name is imported from a folder."""
    for part in name.split("."):
        yield root / f"{part}.py"
        root /= part
        yield root / "__init__.py"


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
    folder = os.getcwd()
    try:
        yield
    finally:
        del sys.path[0]
        os.chdir(folder)  # paths of the case are relative to it
