"""Tables of amplitudes and paths, and values that follow them."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic_core import CoreSchema, core_schema

from anisocontact.base.registry import Entry, Parameter
from anisocontact.case.quantity import Quantity, number, word
from anisocontact.case.registered import Key, OneOf, Registered
from anisocontact.case.section import Section

#: Kind of an amplitude that is a function in a Python file.
PYTHON = Entry("python", "amplitude", "a function of time in a Python file of yours", ())
#: The key of a path among prescribed components.
PATH: Any = Field(
    None,
    description="name of a path that prescribes its components, from where they are when the step "
    "begins",
)
STEP, TOTAL = "step", "total"


class Timed(Registered):
    """An amplitude with the time it counts."""

    time_of: Annotated[
        str, word("whether time counts from the beginning of the step or of the run", STEP, TOTAL)
    ] = STEP

    @property
    def of_run(self) -> bool:
        """Whether its time is that of the run."""
        return self.time_of == TOTAL


class FunctionTable(Timed):
    """A function of time in a Python file."""

    file: str = Field(
        description="Python file, from the folder of the case file on; `run` and `check` run it "
        "with all rights of whoever calls them, `check --no-python` does not"
    )
    function: str = Field(description="name of the function in it, of the time")
    arguments: dict[str, Any] = Field(
        default_factory=dict, description="what else it is called with, by name"
    )


class Scheduled(Section):
    """A value that follows an amplitude: `value` times it."""

    amplitude: str = Field(description="name of an amplitude")
    value: Annotated[
        float, number("scalar", "unit of the prescribed value", "factor of the amplitude")
    ] = 1.0
    relative: Annotated[
        bool, number("flag", "1", "whether it is added to the value at the start of the step")
    ] = False


class PrescribedQuantity(Quantity):
    """Annotation of a prescribed number: at the end of the step, or as a table `Scheduled`."""

    def check(self, given: object) -> Any:
        """As of `Quantity`; tables and what has been checked are passed on."""
        if isinstance(given, Scheduled):
            return given
        return Scheduled.model_validate(given) if isinstance(given, dict) else super().check(given)

    def __get_pydantic_core_schema__(  # type: ignore[override]
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Pydantic asks: every check is ours, the table is described by its class."""
        inner = handler.generate_schema(Scheduled)
        return core_schema.no_info_wrap_validator_function(lambda v, _: self.check(v), inner)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Pydantic asks: the number as of `Quantity`, or the table."""
        plain = super().__get_pydantic_json_schema__(schema, handler)
        about = {key: plain.pop(key) for key in ("description", "unit")}
        return {**about, "anyOf": [*plain.get("anyOf", [plain]), handler(schema)]}


def times(value: float | Scheduled, factor: float) -> float | Scheduled:
    """A multiple of a prescribed value."""
    if isinstance(value, Scheduled):
        return value.model_copy(update={"value": factor * value.value})
    return factor * value


def prescribed(unit: str, doc: str, **more: Any) -> PrescribedQuantity:
    """Annotation of a component that a step prescribes."""
    return PrescribedQuantity(Parameter("", "scalar", unit, doc), **more)


def amplitude_table(known: tuple[Entry, ...]) -> Any:
    """Annotation of a table `[amplitude.NAME]`."""
    return OneOf("Amplitude", Key("kind", known), base=Timed, bases={PYTHON.name: FunctionTable})


def path_table(known: tuple[Entry, ...]) -> Any:
    """Annotation of a table `[path.NAME]`."""
    return OneOf("Path", Key("kind", known))
