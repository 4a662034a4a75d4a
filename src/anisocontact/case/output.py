"""The table `[output]`: what is written, when, and for which places."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from anisocontact.base.errors import InputError
from anisocontact.case.bodies import Point
from anisocontact.case.quantity import number
from anisocontact.case.section import Section

if TYPE_CHECKING:
    from anisocontact.results.output_options import OutputOptions
    from anisocontact.results.probes import Probe
    from anisocontact.results.resultants import Resultant


#: Bytes of a name that still is one of a file, with what is put around it.
_LONGEST_NAME = 100


class ProbeSection(Section):
    """Values at a point, along a line or at the nodes of a facet group, in `probes/<name>.csv`."""

    point: Annotated[
        Point | None, number("vector", "length", "a point of a body at rest, or the first one")
    ] = None
    to: Annotated[Point | None, number("vector", "length", "the last point of a line")] = None
    count: Annotated[
        int, number("integer", "1", "points of the line", "positive", most=1_000_000)
    ] = 11
    group: str | None = Field(None, description='facet group in the place of `point`, "body.group"')
    quantities: list[str] = Field(
        default=["displacement", "stress"], description="quantities of a node"
    )

    def probe(self) -> Probe:
        """The probe."""
        from anisocontact.results.probes import Probe

        if self.group is not None or self.point is None:
            return Probe((), self.group or "", self.quantities)
        if self.to is None:
            return Probe((self.point,), "", self.quantities)
        return Probe.along(self.point, self.to, self.count, self.quantities)

    def mistakes(self) -> Iterator[tuple[str, str]]:
        """Key and text of what does not fit together."""
        if (self.point is None) == (self.group is None):
            yield "point", "either a point or a group is needed"
        if self.to is not None and self.point is None:
            yield "to", "given without a point"
        if self.to is not None and self.to == self.point:
            yield "to", "the same point as `point`, a line has two ends"
        if self.to is None and "count" in self.model_fields_set:
            yield "count", "given without `to`, the other end of a line"
        if not self.quantities:
            yield "quantities", "[] given, one or more needed"
        if self.to is not None and self.count < 2:
            yield "count", f"{self.count} given, a line has at least 2"


class ResultantSection(Section):
    """Force and moment of the supports of a facet group, or through a section of a body."""

    group: str | None = Field(
        None, description='facet group with supports or prescribed displacements, "body.group"'
    )
    body: str | None = Field(None, description="body with a section, in the place of `group`")
    point: Annotated[Point | None, number("vector", "length", "a point of the section")] = None
    normal: Annotated[
        Point | None,
        number("vector", "1", "normal of the section, towards the part in front", "nonzero"),
    ] = None
    about: Annotated[Point, number("vector", "length", "point of the moment")] = (0.0, 0.0, 0.0)

    def resultant(self) -> Resultant:
        """Whose force and moment."""
        from anisocontact.results.resultants import GroupResultant, SectionResultant

        if self.body is None or self.point is None or self.normal is None:
            return GroupResultant(self.group or "", self.about)
        return SectionResultant(self.body, self.point, self.normal, self.about)

    def mistakes(self) -> Iterator[tuple[str, str]]:
        """Key and text of what does not fit together."""
        if (self.body is None) == (self.group is None):
            yield "group", "either a group or a body is needed"
        for key in ("point", "normal"):
            if (self.body is None) != (getattr(self, key) is None):
                yield key, "a body needs it, a group does not"


class Output(Section):
    """What is written."""

    every: Annotated[
        int,
        number("integer", "1", "fields are written every so many increments", "positive"),
    ] = 1
    steps: list[str] = Field(
        default_factory=list, description="steps whose fields are written, all if left out"
    )
    times: list[Annotated[float, number("scalar", "time", "a time", "non-negative")]] = Field(
        default_factory=list,
        description="times from which on the next increment is written as well [time]",
    )
    pictures: Annotated[
        bool,
        number(
            "flag",
            "1",
            "whether report.html and its pictures are made at the end; "
            "`anisocontact report` makes them at any time",
        ),
    ] = True
    vtkhdf: Annotated[
        bool,
        number(
            "flag",
            "1",
            "whether all states are also written as one file of each sort, fields.vtkhdf, "
            "contact.vtkhdf and surfaces.vtkhdf, at the end; needs h5py",
        ),
    ] = False
    checkpoint_every: Annotated[
        float,
        number(
            "scalar",
            "1",
            "wall-clock seconds, whatever the units of the case, between two checkpoints, at least "
            "20 times what one takes to be written; 0 writes one after each increment; the end of "
            "a run always has one",
            "non-negative",
        ),
    ] = 1.0
    quantities: list[str] = Field(
        default_factory=list,
        description="arrays of the files for ParaView, all if left out; those that pictures are "
        "made of are always there",
    )
    probe: dict[str, ProbeSection] = Field(
        default_factory=dict, description="tables of values at places, by name"
    )
    resultant: dict[str, ResultantSection] = Field(
        default_factory=dict,
        description="forces and moments in `summary.json` and `history.csv`, by name",
    )

    def options(self) -> OutputOptions:
        """The same for the writer."""
        from anisocontact.results.output_options import OutputOptions

        return OutputOptions(
            every=self.every,
            steps=self.steps,
            times=self.times,
            quantities=self.quantities,
            probes={name: one.probe() for name, one in self.probe.items()},
            resultants={name: one.resultant() for name, one in self.resultant.items()},
            pictures=self.pictures,
            vtkhdf=self.vtkhdf,
            checkpoint_every=self.checkpoint_every,
        )


def check_output(output: Output, steps: Sequence[str], end: float) -> Iterator[InputError]:
    """What is wrong in the table.

    Args:
        output: The table.
        steps: Names of the steps.
        end: When the last of them ends at the latest.
    """
    if output.vtkhdf and find_spec("h5py") is None:
        yield InputError("needs h5py: pip install h5py", "output.vtkhdf")
    for i, name in enumerate(output.steps):
        if name not in steps:
            text = f'no step "{name}"; there are: {", ".join(steps)}'
            yield InputError(text, f"output.steps[{i}]")
    for i, time in enumerate(output.times):
        if time > end * (1.0 + 1e-9):
            yield InputError(f"{time:g} given, the run ends at {end:g}", f"output.times[{i}]")
    tables: list[tuple[str, str, ProbeSection | ResultantSection]] = [
        *(("probe", name, section) for name, section in output.probe.items()),
        *(("resultant", name, section) for name, section in output.resultant.items()),
    ]
    for what, name, section in tables:
        plain = name.replace("_", "").replace("-", "").isalnum()
        if not plain or len(name.encode()) > _LONGEST_NAME:
            allowed = f"a name of letters, numbers, - and _ needed, at most {_LONGEST_NAME} bytes"
            text = f'"{name[:40]}" given, {allowed}'
            yield InputError(text, f"output.{what}")
        for key, text in section.mistakes():
            yield InputError(text, f"output.{what}.{name}.{key}")
