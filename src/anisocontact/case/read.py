"""Reading a case file: from TOML to a checked `Case`, or to a list of what is wrong."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from anisocontact.base.errors import InputError
from anisocontact.case.checks import check
from anisocontact.case.model import Case, case_type
from anisocontact.case.registries import Registries

#: Characters to either side of an error that a message has of a long line of a file.
_AROUND = 40
#: A table that stands for an entry of a list.
_LIST = re.compile(r"\[{1,2}(contact|step|tie|cyclic)\]{1,2}")
_BARE = re.compile(r"[A-Za-z0-9_-]+")


class CaseError(InputError):
    """One or several mistakes in a case file.

    Attributes:
        errors: One for each mistake.

    Example:
        >>> try:
        ...     validate({"title": "Nothing"})
        ... except CaseError as wrong:
        ...     [one.field for one in wrong.errors]
        ['mesh', 'material', 'step']
    """

    def __init__(self, errors: list[InputError]) -> None:
        more = f" (and {len(errors) - 1} more)" if len(errors) > 1 else ""
        super().__init__(f"{errors[0]}{more}", errors[0].field)
        self.errors = errors


@dataclass(frozen=True)
class CaseFile:
    """A case with the file it came from.

    Args:
        case: The checked content.
        path: The file; paths inside the case are relative to its folder.
        text: What stood in it when it was read: it may be a pipe, or changed while the case runs.
    """

    case: Case
    path: Path
    text: str

    @property
    def name(self) -> str:
        """Name of the case: that of the file, or of its folder where the file is `case.toml`."""
        path = self.path.resolve()
        return path.parent.name if path.stem == "case" and path.parent.name else path.stem

    def resolve(self, path: str) -> Path:
        """A path written in the case.

        Args:
            path: As it is written: absolute, or relative to the folder of the file.

        Returns:
            Where that is.
        """
        return self.path.parent / path


def load(path: str | Path) -> CaseFile:
    """Read and check a case file; nothing is meshed.

    Args:
        path: The TOML file.

    Returns:
        The case and where it came from.

    Raises:
        InputError: The file is missing or is not TOML.
        CaseError: Something in it is wrong; `errors` has a line for each mistake.

    Example:
        >>> load("nowhere.toml")
        Traceback (most recent call last):
            ...
        anisocontact.base.errors.InputError: case file 'nowhere.toml' does not exist
    """
    path = Path(path)
    text, tables = read_tables(path)
    return CaseFile(validate(tables), path, text)


def validate(data: object) -> Case:
    """A case from nested tables, as `tomllib` returns them.

    Args:
        data: The tables.

    Returns:
        The checked case.

    Raises:
        InputError: The finite-element level is not installed, or it is a case of the point driver.
        CaseError: Something in it is wrong.

    Example:
        >>> validate({"title": "Nothing"})
        Traceback (most recent call last):
        anisocontact.case.read.CaseError: mesh: missing; ...
    """
    registries = Registries.current()
    if not registries.materials:
        raise InputError(
            "the finite-element level is not installed: pip install 'anisocontact[fem]', "
            "or fenics-dolfinx from conda-forge"
        )
    if isinstance(data, Mapping) and "load" in data and "mesh" not in data:
        raise InputError("load given and no mesh: this is a case of `anisocontact trace`")
    try:
        case = case_type(registries).model_validate(data)
    except ValidationError as error:
        raise CaseError([as_input(e) for e in error.errors(include_url=False)]) from None
    errors = list(check(case))
    if errors:
        raise CaseError(errors)
    return case


def json_schema() -> dict[str, Any]:
    """JSON Schema of the case file: every key with its description, unit, bounds and default.

    Returns:
        The schema as nested tables, for `json.dumps`.

    Example:
        >>> sorted(json_schema()["required"])
        ['material', 'mesh', 'step']
    """
    schema = case_type(Registries.current()).model_json_schema()
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **without_null(schema),
        "title": "anisocontact case file",
    }


def dotted(loc: tuple[str | int, ...]) -> str:
    """Path of a place in the file, such as `contact[0].friction.coefficients`."""
    text = ""
    for part in loc:
        if isinstance(part, int):
            text += f"[{part}]"
        else:
            text += f".{part}" if _BARE.fullmatch(part) else f'."{part}"'
    return text.removeprefix(".")


def as_input(error: Any) -> InputError:
    """An error of pydantic as one line."""
    return InputError(error["msg"], field=dotted(error["loc"]))


def read_tables(path: Path) -> tuple[str, dict[str, Any]]:
    """Text and tables of a TOML file, read once.

    Args:
        path: The file, in UTF-8; a mark of the byte order at its start is passed over.

    Returns:
        The text, and the tables, nested.

    Raises:
        InputError: It is missing, cannot be read or is not TOML.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
        return text, tomllib.loads(text)
    except FileNotFoundError:
        raise InputError(f"case file '{path}' does not exist") from None
    except OSError as error:
        raise InputError(f"case file '{path}' cannot be read: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise InputError(f"case file '{path}' is not UTF-8 text: byte {error.start}") from None
    except (tomllib.TOMLDecodeError, ValueError) as error:
        raise _not_toml(path, text, error) from None
    except RecursionError:
        raise InputError(f"case file '{path}' is nested too deeply") from None


def _not_toml(path: Path, text: str, error: ValueError) -> InputError:
    """What is no TOML in a file, with the line that it is in, where the error names one."""
    said = f"case file '{path}' is not TOML: {error}"
    where = re.search(r"at line (\d+), column (\d+)", said)
    if where is None:
        return InputError(said)
    line, column = text.split("\n")[int(where[1]) - 1].strip(), int(where[2])
    first, last = max(0, column - _AROUND), column + _AROUND
    shown = f"{'... ' * (first > 0)}{line[first:last]}{' ...' * (last < len(line))}"
    twice = _LIST.fullmatch(line) if "Cannot" in said else None
    cure = f"; where there are several each is [[{twice[1]}]]" if twice else ""
    return InputError(f"{said}: {shown}{cure}")


def without_null(schema: Any) -> Any:
    """TOML has no null: what may be left out is said by `required` alone."""
    if isinstance(schema, list):
        return [without_null(item) for item in schema]
    if not isinstance(schema, dict):
        return schema
    kept = {key: without_null(value) for key, value in schema.items() if value is not None}
    options = [option for option in kept.get("anyOf", []) if option != {"type": "null"}]
    if len(options) == 1:
        del kept["anyOf"]
        return {**options[0], **kept}
    return kept
