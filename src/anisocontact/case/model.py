"""The case file as types: what may stand in it, with units, bounds and defaults.

Tables of surfaces, direction fields, laws, rules and materials are made from the registries, so
that a new entry can be written in a case file without a change here.
"""

from __future__ import annotations

from functools import cache
from typing import Annotated, Any

from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WithJsonSchema,
    WrapValidator,
    create_model,
)

from anisocontact.base.limits import MOST_INCREMENTS, Limits
from anisocontact.base.registry import Entry
from anisocontact.base.strategies import AUTO
from anisocontact.case.amplitudes import amplitude_table, path_table
from anisocontact.case.bodies import Mesh, NodeGroup, mesh_type
from anisocontact.case.contact_laws import laws_or_python
from anisocontact.case.cyclic import CyclicSection
from anisocontact.case.loads import ElasticBed, GroupSpring, Loading
from anisocontact.case.output import Output
from anisocontact.case.python_section import MATERIAL, MaterialSection, MaterialTable
from anisocontact.case.quantity import line, shown
from anisocontact.case.quantity import number as _number
from anisocontact.case.quantity import word as _word
from anisocontact.case.registered import Key, OneOf
from anisocontact.case.registries import Registries
from anisocontact.case.rigid import Load, Motion, Rigid
from anisocontact.case.section import Section, near
from anisocontact.case.ties import TieSection
from anisocontact.case.units import Units
from anisocontact.case.until import UntilSection
from anisocontact.interface.augmentation import AUTO as AUTO_MULTIPLIERS
from anisocontact.interface.augmentation import NEWTON, SCHEMES, UZAWA, Augmentation

PENALTY, AUGMENTED = "penalty", "augmented"
SINGLE, TWO_HALF, MORTAR = "single", "two-half", "mortar"
_PASSES = (
    "where the law is evaluated: at integration points of the slave, or at its nodes, with dual "
    f'mortar weights; "{AUTO}" takes "{MORTAR}" where it can, and "{TWO_HALF}" of before is '
    f'"{MORTAR}"'
)


class StepSection(Loading):
    """A load step: values are reached at its end, linearly; what is not named is held."""

    name: str = Field(description="name of the step, used once")
    increments: Annotated[
        int,
        _number("integer", "1", "number of equal increments", "positive", most=MOST_INCREMENTS),
    ]
    duration: Annotated[float, _number("scalar", "time", "time the step takes", "positive")] = 1.0
    until: UntilSection | None = Field(None, description=str(UntilSection.__doc__))
    motion: dict[str, Motion] = Field(
        default_factory=dict, description="prescribed and freed motion by rigid body"
    )
    load: dict[str, Load] = Field(
        default_factory=dict, description="forces and moments by rigid body"
    )


def _option(given: object, inner: ValidatorFunctionWrapHandler) -> Any:
    """A value PETSc can have; one line where it is none, not one for each kind it could be."""
    try:
        return inner(given)
    except ValidationError:
        raise line(f"{shown(given)} given, a text, a number, true or false needed") from None


class Solver(Section):
    """How it is solved."""

    strategy: str = AUTO
    options: dict[str, Annotated[str | int | float | bool, WrapValidator(_option)]] = Field(
        default_factory=dict,
        description="PETSc options without the prefix `anisocontact_`, such as `snes_max_it = 50`",
    )
    smallest_increment: Annotated[
        float,
        _number(
            "scalar",
            "1",
            "an increment that fails is cut into sub-increments, this share of it the smallest",
            "positive",
            most=1.0,
        ),
    ] = Limits.smallest
    largest_increment: Annotated[
        float,
        _number(
            "scalar", "1", "largest sub-increment, a share of an increment", "positive", most=1.0
        ),
    ] = Limits.largest
    stabilisation: Annotated[
        bool,
        _number(
            "flag",
            "1",
            "whether bodies that only contact can hold are kept in reach until it does",
        ),
    ] = True
    cuts: Annotated[
        int, _number("integer", "1", "most cuts within an increment", "non-negative")
    ] = Limits.cuts


class ContactSection(Section):
    """A pair in contact: slave facets against a rigid surface or the facets of another body."""

    slave: str = Field(description='slave facets, "body.group"')
    master: str = Field(
        description='name of a surface, or facets of another body, "body.group"; the slave once '
        "more for self-contact"
    )
    degree: Annotated[
        int | None,
        _number(
            "integer",
            "1",
            "degree of the quadrature on slave facets; if left out, twice the order of the "
            f'displacement, the order with the method "{AUGMENTED}"',
            "positive",
            most=30,
        ),
    ] = None
    self_contact: Annotated[
        bool,
        _number("flag", "1", "whether the slave is its own master: a body that folds onto itself"),
    ] = False
    apart: Annotated[
        float | None,
        _number(
            "scalar",
            "length",
            "self-contact: facets nearer to each other than this in the reference configuration "
            "that do not face each other do not meet, three facet sizes if left out",
            "positive",
        ),
    ] = None
    method: Annotated[
        str,
        _word(
            "whether penetration and elastic slip are those of the penalties or are brought below "
            "the tolerance by an augmented Lagrangian; the stiffness of adhesion counts as a "
            f'penalty where it is "auto"; "{AUTO}" takes "{AUGMENTED}" at slave nodes where the '
            "normal penalty is not given and the laws allow for it",
            AUTO,
            PENALTY,
            AUGMENTED,
        ),
    ] = AUTO
    physical_penalty: Annotated[
        bool,
        _number(
            "flag",
            "1",
            "whether the normal penalty is the stiffness of a layer between the surfaces, as a "
            "lining, whose compression no warning takes for a penetration",
        ),
    ] = False
    tolerance: Annotated[
        float | None,
        _number(
            "scalar",
            "1",
            f'largest penetration and elastic slip of "{AUGMENTED}", share of the facet size, '
            f"{Augmentation.tolerance:g} if left out",
            "positive",
        ),
    ] = None
    multipliers: Annotated[
        str,
        _word(
            f'how "{AUGMENTED}" finds its multipliers: "{NEWTON}" together with the displacements, '
            f'"{UZAWA}" in cycles around Newton\'s method; "{AUTO_MULTIPLIERS}" takes "{NEWTON}", '
            f'"{UZAWA}" for the sliding rule "explicit"',
            *SCHEMES,
        ),
    ] = AUTO_MULTIPLIERS
    adjust: Annotated[
        bool, _number("flag", "1", "whether slave points that overlap at the start just touch")
    ] = False
    adjust_gap: Annotated[
        float,
        _number("scalar", "length", "gaps up to this one are closed by adjust", "non-negative"),
    ] = 0.0
    normal: Any
    adhesion: Any
    friction: Any
    evolution: str
    python: Any

    @property
    def meshed(self) -> bool:
        """Whether the master is a facet group; names of surfaces have no dot."""
        return "." in self.master

    @property
    def pass_(self) -> str:
        """The `pass`, which is no name for an attribute in Python."""
        return str(getattr(self, "pass"))

    @property
    def asks_for_multipliers(self) -> bool:
        """Whether something is given that only an augmented contact has."""
        return self.tolerance is not None or self.multipliers != AUTO_MULTIPLIERS

    @property
    def of_before(self) -> bool:
        """Whether the pass is one that was given up for mortar: two half ones, or of a fold."""
        return self.pass_ == TWO_HALF or (self.self_contact and self.pass_ == SINGLE)

    @property
    def mortar(self) -> bool:
        """Whether the law is evaluated at slave nodes with mortar weights."""
        return self.pass_ == MORTAR or self.of_before


class Case(Section):
    """A whole case file; `case_type()` adds the tables made from the registries."""

    title: str = Field("", description="heading of the report")
    units: Units = Units()
    mesh: Mesh
    group: dict[str, Any] = Field(default_factory=dict)
    join: dict[str, list[str]] = Field(
        default_factory=dict,
        description='facet groups made of others, "body.group" = ["body.one", "body.other"]',
    )
    idealisation: Any = None
    material: dict[str, Any]
    surface: dict[str, Any] = Field(default_factory=dict)
    rigid: dict[str, Rigid] = Field(
        default_factory=dict, description="rigid bodies that carry surfaces, by name"
    )
    contact: list[Any] = Field(default_factory=list)
    tie: list[TieSection] = Field(
        default_factory=list, description="pairs of facet groups that are glued together"
    )
    cyclic: list[CyclicSection] = Field(
        default_factory=list, description="cut faces of sectors that stand for a whole"
    )
    symmetry: list[str] = Field(
        default_factory=list, description='flat facet groups that stay in their plane, "body.group"'
    )
    elastic_support: dict[str, ElasticBed] = Field(
        default_factory=dict, description='elastic supports by "body.group"'
    )
    spring: dict[str, GroupSpring] = Field(
        default_factory=dict, description="springs of facet groups by name"
    )
    nodes: dict[str, NodeGroup] = Field(
        default_factory=dict,
        description='points and edges by "body.group", for prescribed displacements',
    )
    amplitude: dict[str, Any] = Field(default_factory=dict)
    path: dict[str, Any] = Field(default_factory=dict)
    step: list[StepSection] = Field(min_length=1, description="load steps, one after the other")
    output: Output = Output()
    solver: Solver = Solver()


@cache
def case_type(known: Registries) -> type[Case]:
    """The type of a case file that can name what is in the registries.

    Returns:
        A subclass of `Case`.
    """
    contact = _contact(known)
    surface = OneOf("Surface", Key("shape", known.surfaces))
    return create_model(
        "Case",
        __base__=Case,
        surface=(
            dict[str, Annotated[Any, surface]],
            Field(default_factory=dict, description="rigid surfaces by name"),
        ),
        amplitude=(
            dict[str, Annotated[Any, amplitude_table(known.amplitudes)]],
            Field(default_factory=dict, description="amplitudes by name, for values of steps"),
        ),
        path=(
            dict[str, Annotated[Any, path_table(known.paths)]],
            Field(
                default_factory=dict,
                description="paths by name, for displacements and motions along them",
            ),
        ),
        contact=(
            list[contact],  # type: ignore[valid-type]
            Field(default_factory=list, description="pairs in contact"),
        ),
        output=(_output(known.arrays), Output()),
        solver=(_solver(known.strategies), Solver()),
        **_bodies(known),
    )


def _bodies(known: Registries) -> dict[str, Any]:
    """Tables of meshes, their groups and their materials."""
    own = {MATERIAL.name: MaterialTable}
    material = OneOf("Material", Key("model", known.materials), base=MaterialSection, bases=own)
    selector = OneOf("Group", Key("by", known.group_selectors))
    idealisation = OneOf("Idealisation", Key("kind", known.idealisations))
    return dict(
        mesh=(mesh_type(known.shapes), Field(description=str(Mesh.__doc__))),
        idealisation=(
            Annotated[Any, idealisation],
            Field(None, description="what a mesh in the plane z = 0 is taken for"),
        ),
        group=(
            dict[str, Annotated[list[Annotated[Any, selector]], BeforeValidator(_as_list)]],
            Field(
                default_factory=dict,
                description='facet groups that the mesh lacks, "body.group", or "group" for one in '
                "every body that has such facets; of several tables all have to choose a facet",
            ),
        ),
        material=(
            dict[str, Annotated[Any, material]],
            Field(description="material of each body, by body name"),
        ),
    )


def _contact(known: Registries) -> type[ContactSection]:
    """A table `[[contact]]`."""
    # "pass" is no name for an attribute in a class body
    passes: dict[str, Any] = {
        "pass": (Annotated[str, _word(_PASSES, AUTO, SINGLE, TWO_HALF, MORTAR)], AUTO)
    }
    return create_model("Contact", __base__=ContactSection, **passes, **laws_or_python(known))


def _as_list(given: object) -> object:
    """One table where several may stand."""
    return [given] if isinstance(given, dict) else given


def _solver(ways: tuple[Entry, ...]) -> type[Solver]:
    """The table `[solver]`, whose strategies are the registered ones."""
    text = "; ".join(f"{way.doc} ({way.name})" for way in ways)
    names = (way.name for way in ways)
    field: dict[str, Any] = {"strategy": (Annotated[str, _word(text, *names)], AUTO)}
    return create_model("Solver", __base__=Solver, __doc__=Solver.__doc__, **field)


def _output(names: list[str]) -> type[Output]:
    """The table `[output]`, whose quantities are those of the table of quantities."""

    def check(given: str) -> str:
        if given not in names:
            raise line(f"{shown(given)} given; {near(given, names)}")
        return given

    name = Annotated[str, AfterValidator(check), WithJsonSchema({"enum": names})]
    of_base = Output.model_fields["quantities"]
    return create_model(
        "Output", __base__=Output, __doc__=Output.__doc__, quantities=(list[name], of_base)
    )
