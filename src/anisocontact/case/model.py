"""The case file as types: what may stand in it, with units, bounds and defaults.

Tables of surfaces, direction fields, laws, rules and materials are made from the registries, so
that a new entry can be written in a case file without a change here.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
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

from anisocontact.base import registry
from anisocontact.base.amplitudes import amplitudes
from anisocontact.base.limits import Limits
from anisocontact.base.paths import paths
from anisocontact.base.registry import Entry
from anisocontact.base.strategies import AUTO, strategies
from anisocontact.case.amplitudes import PYTHON, amplitude_table, path_table
from anisocontact.case.bodies import Mesh, mesh_type
from anisocontact.case.loads import ElasticBed, GroupSpring, Loading
from anisocontact.case.output import Output
from anisocontact.case.python_section import MATERIAL, MaterialTable, PythonSection
from anisocontact.case.quantity import line, shown
from anisocontact.case.quantity import number as _number
from anisocontact.case.quantity import word as _word
from anisocontact.case.registered import Key, OneOf, Registered, default_of
from anisocontact.case.rigid import Load, Motion, Rigid
from anisocontact.case.section import Section, near
from anisocontact.case.units import Units
from anisocontact.interface import Interface
from anisocontact.interface.augmentation import AUTO as AUTO_MULTIPLIERS
from anisocontact.interface.augmentation import NEWTON, SCHEMES, UZAWA, Augmentation
from anisocontact.laws import SIDES, Adhesion, Friction, NormalLaw
from anisocontact.results.quantities import CONTACT, FILES, RIGID, quantities

__all__ = [
    "Case",
    "ContactSection",
    "Directed",
    "Mesh",
    "Output",
    "Registries",
    "Solver",
    "StepSection",
    "case_type",
    "laws",
]

_DIRECTIONS = "direction field of the axes; needed where the two values of a pair differ"
_DIRECTIONS_SECOND = "directions of the second surface, for a friction model of two surfaces"


PENALTY, AUGMENTED = "penalty", "augmented"
SINGLE, TWO_HALF, MORTAR = "single", "two-half", "mortar"
_PASSES = (
    "where the law is evaluated: at integration points of the slave alone, or, between bodies, "
    "of both with half the weight; or at the slave nodes, with dual mortar weights"
)


class StepSection(Loading):
    """A load step: values are reached at its end, linearly; what is not named is held."""

    name: str = Field(description="name of the step, used once")
    increments: Annotated[int, _number("integer", "1", "number of equal increments", "positive")]
    duration: Annotated[float, _number("scalar", "time", "time the step takes", "positive")] = 1.0
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
            "an increment that fails is cut into parts, this share of it the smallest",
            "positive",
            most=1.0,
        ),
    ] = Limits.smallest
    largest_increment: Annotated[
        float,
        _number("scalar", "1", "largest part, a share of an increment", "positive", most=1.0),
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


class Directed(Registered):
    """A law whose axes follow a direction field."""

    directions: Any = None
    directions_on: str = SIDES[0]


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
            "self-contact: facets nearer to each other than this in the reference configuration do "
            "not meet, three facet sizes if left out",
            "positive",
        ),
    ] = None
    method: Annotated[
        str,
        _word(
            "whether penetration and elastic slip are those of the penalties or are brought below "
            "the tolerance by an augmented Lagrangian; the stiffness of adhesion counts as a "
            'penalty where it is "auto"',
            PENALTY,
            AUGMENTED,
        ),
    ] = PENALTY
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
    def half_passes(self) -> bool:
        """Whether each of two bodies is slave and master for half of the work."""
        return bool(getattr(self, "pass") == TWO_HALF)

    @property
    def mortar(self) -> bool:
        """Whether the law is evaluated at slave nodes with mortar weights."""
        return bool(getattr(self, "pass") == MORTAR)


class Case(Section):
    """A whole case file; `case_type()` adds the tables made from the registries."""

    title: str = Field("", description="heading of the report")
    units: Units = Units()
    mesh: Mesh
    group: dict[str, Any] = Field(default_factory=dict)
    idealisation: Any = None
    material: dict[str, Any]
    surface: dict[str, Any] = Field(default_factory=dict)
    rigid: dict[str, Rigid] = Field(
        default_factory=dict, description="rigid bodies that carry surfaces, by name"
    )
    contact: list[Any] = Field(default_factory=list)
    symmetry: list[str] = Field(
        default_factory=list, description='flat facet groups that stay in their plane, "body.group"'
    )
    elastic_support: dict[str, ElasticBed] = Field(
        default_factory=dict, description='elastic supports by "body.group"'
    )
    spring: dict[str, GroupSpring] = Field(
        default_factory=dict, description="springs of facet groups by name"
    )
    amplitude: dict[str, Any] = Field(default_factory=dict)
    path: dict[str, Any] = Field(default_factory=dict)
    step: list[StepSection] = Field(min_length=1, description="load steps, one after the other")
    output: Output = Output()
    solver: Solver = Solver()


@dataclass(frozen=True)
class Registries:
    """Everything that can be named in a case file."""

    surfaces: tuple[Entry, ...]
    direction_fields: tuple[Entry, ...]
    normal_laws: tuple[Entry, ...]
    adhesion_models: tuple[Entry, ...]
    friction_models: tuple[Entry, ...]
    sliding_rules: tuple[Entry, ...]
    evolution_forms: tuple[Entry, ...]
    materials: tuple[Entry, ...]
    shapes: tuple[Entry, ...] = ()
    group_selectors: tuple[Entry, ...] = ()
    output_quantities: tuple[Entry, ...] = ()
    amplitudes: tuple[Entry, ...] = ()
    paths: tuple[Entry, ...] = ()
    strategies: tuple[Entry, ...] = ()
    idealisations: tuple[Entry, ...] = ()

    @classmethod
    def current(cls) -> Registries:
        """What is registered now."""
        materials, shapes, selectors, idealisations = _of_bodies()
        written = tuple(
            Entry(q.name, q.at, f"{q.doc} [{q.unit}]; at a {q.at}, {FILES[q.at]}", ())
            for q in quantities()
        )
        return replace(
            cls.of_points(),
            materials=materials,
            shapes=shapes,
            group_selectors=selectors,
            output_quantities=written,
            amplitudes=(*amplitudes(), PYTHON),
            paths=paths(),
            strategies=strategies(),
            idealisations=idealisations,
        )

    @property
    def arrays(self) -> list[str]:
        """Names of the quantities of the files for ParaView."""
        numbers = (CONTACT, RIGID)
        return list(dict.fromkeys(q.name for q in self.output_quantities if q.kind not in numbers))

    @classmethod
    def of_points(cls) -> Registries:
        """What is registered now, without materials and shapes of bodies."""
        return cls(
            registry.surfaces(),
            registry.direction_fields(),
            registry.normal_laws(),
            registry.adhesion_models(),
            registry.friction_models(),
            registry.sliding_rules(),
            registry.evolution_forms(),
            (),
        )


def _of_bodies() -> tuple[tuple[Entry, ...], ...]:
    """Materials, shapes, selectors of groups, idealisations; none without finite elements."""
    try:
        from anisocontact.bulk import materials
        from anisocontact.mesh import idealisations, selectors, shapes
    except ImportError:
        return (), (), (), ()
    return (*materials(), MATERIAL), shapes(), selectors(), idealisations()


@cache
def case_type(known: Registries) -> type[Case]:
    """The type of a case file that can name what is in the registries.

    Args:
        known: The registries.

    Returns:
        A subclass of `Case`.
    """
    # "pass" is no name for an attribute in a class body
    passes: dict[str, Any] = {
        "pass": (Annotated[str, _word(_PASSES, SINGLE, TWO_HALF, MORTAR)], SINGLE)
    }
    fields = _or_in_python(laws(known), known)
    contact = create_model("Contact", __base__=ContactSection, **passes, **fields)
    surface = OneOf("Surface", Key("shape", known.surfaces))
    own = {MATERIAL.name: MaterialTable}
    material = OneOf("Material", Key("model", known.materials), bases=own)
    selector = OneOf("Group", Key("by", known.group_selectors))
    idealisation = OneOf("Idealisation", Key("kind", known.idealisations))
    return create_model(
        "Case",
        __base__=Case,
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
        surface=(
            dict[str, Annotated[Any, surface]],
            Field(default_factory=dict, description="rigid surfaces by name"),
        ),
        contact=(
            list[contact],  # type: ignore[valid-type]
            Field(default_factory=list, description="pairs in contact"),
        ),
        amplitude=(
            dict[str, Annotated[Any, amplitude_table(known.amplitudes)]],
            Field(default_factory=dict, description="amplitudes by name, for values of steps"),
        ),
        path=(
            dict[str, Annotated[Any, path_table(known.paths)]],
            Field(default_factory=dict, description="paths by name, for what is led along them"),
        ),
        output=(_output(known.arrays), Output()),
        solver=(_solver(known.strategies), Solver()),
    )


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


def _or_in_python(fields: dict[str, Any], known: Registries) -> dict[str, Any]:
    """Fields of a contact, with a law in Python that may stand in place of those of the core."""
    friction, about = fields["friction"]
    python = _directed("Python", PythonSection, known, "direction field of the law's first axis")
    text = f"{about.description}; needed unless there is a law in Python"
    return fields | {
        "friction": (friction, Field(None, description=text)),
        "python": (python | None, Field(None, description=str(PythonSection.__doc__))),
    }


@cache
def _field(known: Registries) -> Any:
    """A table of a direction field."""
    return Annotated[Any, OneOf("Directions", Key("kind", known.direction_fields))]


def _directed(name: str, base: type[Section], known: Registries, about: str) -> Any:
    """A table with a direction field and the body that carries it."""
    return create_model(
        name,
        __base__=base,
        directions=(_field(known), Field(None, description=about)),
        directions_on=_on("master"),
    )


def _on(default: str) -> tuple[Any, str]:
    """A key for the body that carries a direction field."""
    return Annotated[str, _word("body that carries these directions", *SIDES)], default


def laws(known: Registries) -> dict[str, Any]:
    """Fields of a contact that come from the registries."""
    directed = _directed("Directed", Directed, known, _DIRECTIONS)
    twice_directed = create_model(
        "TwiceDirected",
        __base__=directed,
        directions_second=(_field(known), Field(None, description=_DIRECTIONS_SECOND)),
        directions_second_on=_on("slave"),
    )
    normal = OneOf("Normal", Key("model", known.normal_laws, default_of(NormalLaw, "model")))
    adhesion = OneOf(
        "Adhesion",
        Key("model", known.adhesion_models, default_of(Adhesion, "model")),
        base=directed,
    )
    friction = OneOf(
        "Friction",
        Key("model", known.friction_models, default_of(Friction, "model")),
        Key("sliding_rule", known.sliding_rules, default_of(Friction, "sliding_rule")),
        base=twice_directed,
    )
    return {
        "normal": (Annotated[Any, normal], Field(normal.validate({}), description="pressure law")),
        "adhesion": (
            Annotated[Any, adhesion],
            Field(adhesion.validate({}), description="tangential law inside the yield ellipse"),
        ),
        "friction": (Annotated[Any, friction], Field(description="yield ellipse and sliding rule")),
        "evolution": (
            Annotated[str, _word("how the history enters a step", *_names(known.evolution_forms))],
            default_of(Interface, "evolution"),
        ),
    }


def _names(entries: tuple[Entry, ...]) -> list[str]:
    return [entry.name for entry in entries]
