"""What a user can get wrong, and what a machine can lack, said in one line."""

from __future__ import annotations

import os
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

__all__ = [
    "InputError",
    "MachineError",
    "ModelWarning",
    "RunError",
    "RunWarning",
    "one_line",
    "printable",
    "tell_script",
    "within",
]

#: Files of which no warning names a line: what a script has called goes through several of them.
_PACKAGE = f"{Path(__file__).parents[1]}{os.sep}"


def printable(text: str) -> str:
    r"""A text as it may be shown anywhere: what does not print is written as an escape.

    Control characters move the cursor of a terminal or change its state, marks of direction turn
    a line around, halves of surrogates have no bytes.

    Args:
        text: Any text, from a case file for instance.

    Returns:
        The text; line breaks are escapes, too.

    Example:
        >>> print(printable("drag\x1b[31m"))
        drag\x1b[31m
    """
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)


def one_line(message: object) -> str:
    r"""A message on one line: line breaks in it become spaces, what does not print an escape.

    Example:
        >>> one_line(ValueError("a\n  b"))
        'a b'
    """
    return printable(" ".join(str(message).split()))


class InputError(ValueError):
    """A mistake in the input: one line names the field, what was given and what is allowed.

    Args:
        message: the line, without a final newline; line breaks in it become spaces, other
            characters that do not print are written as escapes.
        field: dotted path of the field or entity, `contact[0].friction.coefficients`; `""` if
            the mistake has no place of its own. Put in front of the message unless it is there.

    Attributes:
        field: the dotted path as given.
        said: the line without it.
        failed: the slave point at which a law in Python failed, if one did: a `FailedPoint`.

    Example:
        >>> str(InputError("given -0.3, must be positive", field="friction.coefficients"))
        'friction.coefficients: given -0.3, must be positive'
    """

    failed: Any = None

    def __init__(self, message: str, field: str = "") -> None:
        line = " ".join(message.split())
        said = line.removeprefix(f"{field}:").lstrip() if field else line
        super().__init__(printable(f"{field}: {said}" if field else said))
        self.field, self.said = field, printable(said)


@contextmanager
def within(place: str) -> Iterator[None]:
    """Put a place, as one in the case file, in front of the field an error names."""
    try:
        yield
    except InputError as error:
        field = ".".join(part for part in (place, error.field) if part)
        raise InputError(error.said, field=field) from None


class MachineError(RuntimeError):
    """The machine lacks what a run needs: one line says what, and the cure.

    Args:
        lack: What is missing or failed.
        cure: What to do about it.

    Example:
        >>> str(MachineError("no C compiler found", "install one, or name one in CC"))
        'no C compiler found: install one, or name one in CC'
    """

    def __init__(self, lack: str, cure: str) -> None:
        super().__init__(one_line(f"{lack}: {cure}"))


class RunError(RuntimeError):
    """A run ended in an error of the program; its results folder has what converged."""


class ModelWarning(UserWarning):
    """What the user of a script should look at: the model is solved, but may not be what was meant.

    Runs of case files say the same in their log, in `summary.json` and in the report.

    Example:
        >>> import warnings
        >>> warnings.simplefilter("error", ModelWarning)  # a script that is to stop there
        >>> warnings.simplefilter("default", ModelWarning)
    """


class RunWarning(ModelWarning):
    """The same of a run of `Solver`, where nobody was named who is to be told.

    Example:
        >>> issubclass(RunWarning, ModelWarning)
        True
    """


def tell_script(text: str, category: type[Warning] = RunWarning) -> None:
    """Give a warning of the line of the script that has called the package.

    Args:
        text: The line.
        category: What it is a warning of.
    """
    warnings.warn(text, category, skip_file_prefixes=(_PACKAGE,))
