from collections.abc import Mapping, Sequence
from typing import Any

import numpy
from numpy.typing import NDArray

class Parameter:
    @property
    def name(self) -> str: ...
    @property
    def kind(self) -> str: ...
    @property
    def unit(self) -> str: ...
    @property
    def doc(self) -> str: ...
    @property
    def bound(self) -> str: ...
    @property
    def required(self) -> bool: ...
    @property
    def fallback(self) -> list[float]: ...
    @property
    def choices(self) -> list[str]: ...
    @property
    def isotropic(self) -> list[float]: ...

class Descriptor:
    @property
    def name(self) -> str: ...
    @property
    def doc(self) -> str: ...
    @property
    def parameters(self) -> list[Parameter]: ...
    @property
    def directions(self) -> int: ...

def surfaces() -> list[Descriptor]: ...
def direction_fields() -> list[Descriptor]: ...
def normal_laws() -> list[Descriptor]: ...
def adhesion_models() -> list[Descriptor]: ...
def friction_models() -> list[Descriptor]: ...
def sliding_rules() -> list[Descriptor]: ...
def evolution_forms() -> list[Descriptor]: ...

class Surface:
    def __init__(self, name: str, values: Mapping[str, Sequence[float]]) -> None: ...
    def jet(self, xi: NDArray[numpy.float64]) -> dict[str, NDArray[Any]]: ...
    def geometry(self, xi: NDArray[numpy.float64]) -> dict[str, NDArray[Any]]: ...
    def geometry_derivatives(self, xi: NDArray[numpy.float64]) -> dict[str, NDArray[Any]]: ...
    def spatial_basis(
        self, xi: NDArray[numpy.float64], gap: NDArray[numpy.float64]
    ) -> NDArray[numpy.float64]: ...
    def covariant_derivative_contra(
        self,
        xi: NDArray[numpy.float64],
        components: NDArray[numpy.float64],
        derivatives: NDArray[numpy.float64],
    ) -> NDArray[numpy.float64]: ...
    def covariant_derivative_co(
        self,
        xi: NDArray[numpy.float64],
        components: NDArray[numpy.float64],
        derivatives: NDArray[numpy.float64],
    ) -> NDArray[numpy.float64]: ...
    def convective_velocity(
        self,
        xi: NDArray[numpy.float64],
        gap: NDArray[numpy.float64] | None,
        relative: NDArray[numpy.float64],
        derivatives: NDArray[numpy.float64],
    ) -> Any: ...
    def project(
        self,
        x: NDArray[numpy.float64],
        guess: NDArray[numpy.float64] | None,
        derivatives: bool,
        threads: int,
    ) -> dict[str, NDArray[Any]]: ...
    def domain(self) -> Any: ...

class Field:
    def __init__(self, name: str, values: Mapping[str, Sequence[float]]) -> None: ...
    def axes(self, surface: Surface, xi: NDArray[numpy.float64]) -> dict[str, NDArray[Any]]: ...
    def tensor(
        self, surface: Surface, xi: NDArray[numpy.float64], values: Sequence[float]
    ) -> dict[str, NDArray[Any]]: ...

class FrictionModel:
    def __init__(self, name: str, values: Mapping[str, Sequence[float]]) -> None: ...
    @property
    def frictionless(self) -> bool: ...
    def tensor(
        self,
        surface: Surface,
        xi: NDArray[numpy.float64],
        directions: Field | None,
        directions_second: Field | None,
    ) -> dict[str, NDArray[Any]]: ...

def linear_model(
    name: str, values: Mapping[str, Sequence[float]]
) -> tuple[float, list[list[float]], list[list[float]], list[list[float]]]: ...

class SlidingRule:
    def __init__(self, name: str, values: Mapping[str, Sequence[float]]) -> None: ...
    def slide(
        self,
        stiffness: NDArray[numpy.float64],
        friction: NDArray[numpy.float64],
        trial: NDArray[numpy.float64],
        pressure: NDArray[numpy.float64],
        metric: NDArray[numpy.float64] | None,
        axes: NDArray[numpy.float64] | None,
        increment: NDArray[numpy.float64] | None,
        tangent: bool,
        threads: int,
    ) -> dict[str, NDArray[Any]]: ...

def state_layout() -> list[Any]: ...

state_size: int = 296

class Law:
    def __init__(
        self,
        normal: tuple[str, Mapping[str, Sequence[float]]],
        adhesion: tuple[str, Mapping[str, Sequence[float]]],
        adhesion_directions: Field | None,
        friction: tuple[str, Mapping[str, Sequence[float]]],
        friction_directions: Field | None,
        friction_directions_second: Field | None,
        rule: tuple[str, Mapping[str, Sequence[float]]],
        evolution: str,
        on_slave: Sequence[bool],
    ) -> None: ...
    @staticmethod
    def given(
        normal: tuple[str, Mapping[str, Sequence[float]]], directions: Field | None, on_slave: bool
    ) -> Law: ...

class Interface:
    def __init__(self, surface: Surface, law: Law) -> None: ...
    def initial_state(self, x: NDArray[numpy.float64]) -> dict[str, NDArray[Any]]: ...
    def law_input(
        self,
        state: NDArray[numpy.uint8],
        x: NDArray[numpy.float64],
        dt: float,
        threads: int,
        own_reference: NDArray[numpy.float64],
        own_reference_tangents: NDArray[numpy.float64],
        own_tangents: NDArray[numpy.float64],
    ) -> dict[str, NDArray[Any]]: ...
    def update(
        self,
        state: NDArray[numpy.uint8],
        x: NDArray[numpy.float64],
        dt: float,
        tangent: bool,
        threads: int,
        own_reference: NDArray[numpy.float64],
        own_reference_tangents: NDArray[numpy.float64],
        own_tangents: NDArray[numpy.float64],
        outputs: NDArray[numpy.float64] | None = None,
    ) -> dict[str, NDArray[Any]]: ...

class FacetSurface:
    def __init__(
        self,
        points: NDArray[numpy.float64],
        topologies: Sequence[str],
        counts: NDArray[numpy.int32],
        nodes: NDArray[numpy.int32],
        flip: NDArray[numpy.bool_],
    ) -> None: ...
    def update(self, points: NDArray[numpy.float64]) -> None: ...
    def project(
        self,
        x: NDArray[numpy.float64],
        hint: NDArray[numpy.int32],
        named: NDArray[numpy.int32],
        start: NDArray[numpy.float64],
        limit: NDArray[numpy.float64],
        offsets: NDArray[numpy.int64],
        excluded: NDArray[numpy.int32],
        threads: int,
    ) -> dict[str, NDArray[Any]]: ...
    def met_along(
        self,
        facet: NDArray[numpy.int32],
        xi: NDArray[numpy.float64],
        x: NDArray[numpy.float64],
        normal: NDArray[numpy.float64],
        opposed: float,
        threads: int,
    ) -> Any: ...
    def shapes(
        self, facet: NDArray[numpy.int32], xi: NDArray[numpy.float64]
    ) -> dict[str, NDArray[Any]]: ...
    def jet(
        self, facet: NDArray[numpy.int32], xi: NDArray[numpy.float64]
    ) -> dict[str, NDArray[Any]]: ...
    def geometry(
        self, facet: NDArray[numpy.int32], xi: NDArray[numpy.float64]
    ) -> dict[str, NDArray[Any]]: ...
    def within(self, x: NDArray[numpy.float64], distance: float, threads: int) -> Any: ...
    def facing(
        self,
        middle: NDArray[numpy.float64],
        radius: NDArray[numpy.float64],
        normal: NDArray[numpy.float64],
        centre: NDArray[numpy.float64],
        size: NDArray[numpy.float64],
        other: NDArray[numpy.float64],
        distance: float,
        farther: float,
        offsets: NDArray[numpy.int64],
        unmet: NDArray[numpy.int32],
        threads: int,
    ) -> Any: ...
    def rings(self, facet: NDArray[numpy.int32], count: int) -> Any: ...
    def sides(self) -> NDArray[numpy.int32]: ...

def facet_balls(nodes: NDArray[numpy.int32], x: NDArray[numpy.float64]) -> Any: ...
def facet_normals(
    nodes: NDArray[numpy.int32],
    flip: NDArray[numpy.bool_],
    gradient: NDArray[numpy.float64],
    x: NDArray[numpy.float64],
) -> NDArray[numpy.float64]: ...

class Smoothing:
    def __init__(
        self,
        points: NDArray[numpy.float64],
        topologies: Sequence[str],
        counts: NDArray[numpy.int32],
        nodes: NDArray[numpy.int32],
        flip: NDArray[numpy.bool_],
        crease: float,
    ) -> None: ...
    def nodes(self, points: int) -> list[int]: ...
    def middles(self, points: NDArray[numpy.float64]) -> NDArray[numpy.float64]: ...
    def derivatives(self, points: NDArray[numpy.float64]) -> Any: ...

class FacetInterface:
    def __init__(self, law: Law) -> None: ...
    def law_input(
        self,
        state: NDArray[numpy.uint8],
        dt: float,
        slave_nodes: NDArray[numpy.int32],
        slave_shape: NDArray[numpy.float64],
        slave_gradient: NDArray[numpy.float64],
        weight: NDArray[numpy.float64],
        current_area: bool,
        now: NDArray[numpy.float64],
        reference: NDArray[numpy.float64],
        connectivity: NDArray[numpy.int32],
        topology: NDArray[numpy.int8],
        flip: NDArray[numpy.bool_],
        facet: NDArray[numpy.int32],
        xi: NDArray[numpy.float64],
        feature: NDArray[numpy.int8],
        edge: NDArray[numpy.float64],
        held: NDArray[numpy.float64],
        near: NDArray[numpy.bool_],
        tangent: bool,
        threads: int,
        outputs: NDArray[numpy.float64] | None = None,
    ) -> dict[str, NDArray[Any]]: ...
    def update(
        self,
        state: NDArray[numpy.uint8],
        dt: float,
        slave_nodes: NDArray[numpy.int32],
        slave_shape: NDArray[numpy.float64],
        slave_gradient: NDArray[numpy.float64],
        weight: NDArray[numpy.float64],
        current_area: bool,
        now: NDArray[numpy.float64],
        reference: NDArray[numpy.float64],
        connectivity: NDArray[numpy.int32],
        topology: NDArray[numpy.int8],
        flip: NDArray[numpy.bool_],
        facet: NDArray[numpy.int32],
        xi: NDArray[numpy.float64],
        feature: NDArray[numpy.int8],
        edge: NDArray[numpy.float64],
        held: NDArray[numpy.float64],
        near: NDArray[numpy.bool_],
        tangent: bool,
        threads: int,
        outputs: NDArray[numpy.float64] | None = None,
    ) -> dict[str, NDArray[Any]]: ...
    def tractions(
        self,
        state: NDArray[numpy.uint8],
        dt: float,
        slave_nodes: NDArray[numpy.int32],
        slave_shape: NDArray[numpy.float64],
        slave_gradient: NDArray[numpy.float64],
        weight: NDArray[numpy.float64],
        current_area: bool,
        now: NDArray[numpy.float64],
        reference: NDArray[numpy.float64],
        connectivity: NDArray[numpy.int32],
        topology: NDArray[numpy.int8],
        flip: NDArray[numpy.bool_],
        facet: NDArray[numpy.int32],
        xi: NDArray[numpy.float64],
        feature: NDArray[numpy.int8],
        edge: NDArray[numpy.float64],
        held: NDArray[numpy.float64],
        near: NDArray[numpy.bool_],
        tangent: bool,
        threads: int,
        outputs: NDArray[numpy.float64] | None = None,
    ) -> dict[str, NDArray[Any]]: ...
    def assemble(
        self,
        state: NDArray[numpy.uint8],
        dt: float,
        slave_nodes: NDArray[numpy.int32],
        slave_shape: NDArray[numpy.float64],
        slave_gradient: NDArray[numpy.float64],
        weight: NDArray[numpy.float64],
        current_area: bool,
        now: NDArray[numpy.float64],
        reference: NDArray[numpy.float64],
        connectivity: NDArray[numpy.int32],
        topology: NDArray[numpy.int8],
        flip: NDArray[numpy.bool_],
        facet: NDArray[numpy.int32],
        xi: NDArray[numpy.float64],
        feature: NDArray[numpy.int8],
        edge: NDArray[numpy.float64],
        held: NDArray[numpy.float64],
        near: NDArray[numpy.bool_],
        tangent: bool,
        threads: int,
        outputs: NDArray[numpy.float64] | None = None,
    ) -> dict[str, NDArray[Any]]: ...

class MortarMemory:
    def __init__(self) -> None: ...

class MortarWeights:
    def __init__(
        self,
        slave_topology: str,
        slave: NDArray[numpy.int32],
        master_topology: str,
        master: NDArray[numpy.int32],
        now: NDArray[numpy.float64],
        reference: NDArray[numpy.float64],
        pair_offsets: NDArray[numpy.int64],
        pair_facets: NDArray[numpy.int32],
        patch: NDArray[numpy.int32],
        around_offsets: NDArray[numpy.int64],
        around_facets: NDArray[numpy.int32],
        around_local: NDArray[numpy.int32],
        support: NDArray[numpy.float64],
        more_offsets: NDArray[numpy.int64],
        more_nodes: NDArray[numpy.int32],
        straight_points: NDArray[numpy.float64],
        straight_weights: NDArray[numpy.float64],
        skew_points: NDArray[numpy.float64],
        skew_weights: NDArray[numpy.float64],
        whole: NDArray[numpy.float64],
        current_area: bool,
        memory: MortarMemory,
        threads: int,
    ) -> None: ...
    @property
    def masters(self) -> NDArray[numpy.int32]: ...
    @property
    def area(self) -> NDArray[numpy.float64]: ...
    @property
    def weight(self) -> NDArray[numpy.float64]: ...
    def tangent(
        self,
        which: NDArray[numpy.int32],
        by: NDArray[numpy.float64],
        lift: NDArray[numpy.float64],
        traction: NDArray[numpy.float64],
        moving: Sequence[tuple[int, NDArray[numpy.int32] | None, NDArray[numpy.float64]]],
        threads: int,
    ) -> Any: ...

def node_sums(
    nodes: NDArray[numpy.int32], values: NDArray[numpy.float64], x: NDArray[numpy.float64]
) -> NDArray[numpy.float64]: ...
def add_at_nodes(
    nodes: NDArray[numpy.int32],
    weights: NDArray[numpy.float64],
    vectors: NDArray[numpy.float64],
    out: NDArray[numpy.float64],
) -> None: ...
def unit_normals(tangents: NDArray[numpy.float64]) -> NDArray[numpy.float64]: ...
def surface_tangents(
    gradients: NDArray[numpy.float64],
    normals: NDArray[numpy.float64],
    facet: NDArray[numpy.int32],
    xi: NDArray[numpy.float64],
    own: NDArray[numpy.float64],
    bend: NDArray[numpy.float64],
    threads: int,
) -> Any: ...
def plane_slopes(
    slave: NDArray[numpy.float64],
    tangents: NDArray[numpy.float64],
    normal: NDArray[numpy.float64],
    held: NDArray[numpy.float64],
    now: NDArray[numpy.float64],
    reference: NDArray[numpy.float64],
    then: NDArray[numpy.float64],
    carried: NDArray[numpy.float64],
    area: NDArray[numpy.float64],
    masters: NDArray[numpy.int32],
    shares: NDArray[numpy.float64],
    facet: NDArray[numpy.int32],
    nodes: NDArray[numpy.int32],
    shape: NDArray[numpy.float64],
    gradient: NDArray[numpy.float64],
    second: NDArray[numpy.float64],
    edge: NDArray[numpy.float64],
    around: NDArray[numpy.int32],
    along: NDArray[numpy.float64],
    bending: NDArray[numpy.float64],
    which: NDArray[numpy.int32],
    by_nodes: NDArray[numpy.float64],
    threads: int,
) -> Any: ...
def block_entries(
    row: NDArray[numpy.int64], column: NDArray[numpy.int64], number: NDArray[numpy.int64], size: int
) -> Any: ...
def multiply_block_rows(
    starts: NDArray[numpy.int32],
    columns: NDArray[numpy.int32],
    blocks: NDArray[numpy.float32],
    x: NDArray[numpy.float32],
) -> NDArray[numpy.float32]: ...
