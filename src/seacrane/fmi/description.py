"""What an FMU says of itself: the model description of FMI 1.0, 2.0 or 3.0 as typed, frozen data."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

from seacrane.errors import FmuError, nearest

Scalar = float | int | bool | str | bytes
Value = Scalar | tuple[Scalar, ...]
"""The value of a variable; of an array, its elements in row-major order."""

TYPES: Final = ("Real", "Integer", "Boolean", "String", "Enumeration")
TYPES3: Final = (
    "Float32", "Float64", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64",
    "Boolean", "String", "Binary", "Enumeration", "Clock",
)  # fmt: skip
REALS: Final = ("Real", "Float32", "Float64")
INTEGERS: Final = {
    **{f"Int{bits}": (-(2 ** (bits - 1)), 2 ** (bits - 1) - 1) for bits in (8, 16, 32, 64)},
    **{f"UInt{bits}": (0, 2**bits - 1) for bits in (8, 16, 32, 64)},
    "Integer": (-(2**31), 2**31 - 1),
    "Enumeration": (-(2**31), 2**31 - 1),
}
"""The least and the greatest value of each type of whole numbers; an enumeration with items takes only those."""
CAUSALITIES: Final = ("parameter", "calculatedParameter", "input", "output", "local", "independent")
CAUSALITIES3: Final = (*CAUSALITIES, "structuralParameter")
VARIABILITIES: Final = ("constant", "fixed", "tunable", "discrete", "continuous")
INITIALS: Final = ("exact", "approx", "calculated")


@dataclass(frozen=True)
class UnitDefinition:
    """A unit: exponents of the SI base units (and rad), factor and offset to them, and its display units.

    value in base units = factor * value + offset; a display unit maps to its own (factor, offset) from the unit. The
    exponents are None if the file does not say them (FMI 1.0 cannot).
    """

    name: str
    exponents: Mapping[str, int] | None = field(default_factory=dict)
    factor: float = 1.0
    offset: float = 0.0
    display: Mapping[str, tuple[float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Dimension:
    """One dimension of an array: a fixed size, or the value reference of the structural parameter that gives it."""

    size: int | None = None
    reference: int | None = None


@dataclass(frozen=True)
class Variable:
    """A variable of an FMU; `initial` is what the standard gives as default if the file does not say.

    `type` is that of the file: Real, Integer, Boolean, String or Enumeration in FMI 1.0 and 2.0; Float64, Int32,
    Binary, Clock and so on in FMI 3.0. `derivative` is the 1-based index of the state of which this is the time
    derivative. `shape` is that at the start values of the structural parameters; of a scalar it is empty. `alias_of`
    names the variable under which FMI 3.0 lists this one as an alias. `items` are those of an enumeration, by name.
    `negated` tells that FMI 1.0 gives this one the opposite of the value behind its value reference.

    Unit, display unit, bounds and nominal value are those of the declared type where the variable has none of its own.
    """

    name: str
    value_reference: int
    type: str
    causality: str = "local"
    variability: str = "continuous"
    initial: str | None = None
    start: Value | None = None
    unit: str | None = None
    display_unit: str | None = None
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None
    derivative: int | None = None
    declared_type: str | None = None
    description: str = ""
    line: int = 0
    dimensions: tuple[Dimension, ...] = ()
    shape: tuple[int, ...] = ()
    alias_of: str | None = None
    items: Mapping[str, int] = field(default_factory=dict)
    negated: bool = False

    @property
    def count(self) -> int:
        """How many elements it has: 1 for a scalar."""
        return math.prod(self.shape)


@dataclass(frozen=True)
class Unknown:
    """An entry of the model structure: 1-based index of a variable and of those it depends on (None: on all)."""

    index: int
    dependencies: tuple[int, ...] | None = None
    kinds: tuple[str, ...] | None = None
    line: int = 0


@dataclass(frozen=True, kw_only=True)
class Capabilities:
    """What an FMU can do in either of its kinds (FMI 2.0, sections 3.3.1 and 4.3.1; FMI 3.0, 2.4, 3.4 and 4.4)."""

    model_identifier: str
    needs_execution_tool: bool = False
    once_per_process: bool = False
    saves_state: bool = False
    serializes_state: bool = False
    directional_derivative: bool = False
    adjoint_derivative: bool = False


@dataclass(frozen=True, kw_only=True)
class CoSimulation(Capabilities):
    """What the co-simulation slave can do."""

    variable_step: bool = False
    interpolates_inputs: bool = False
    output_derivative_order: int = 0
    event_mode: bool = False
    returns_early: bool = False
    fixed_step: float | None = None


@dataclass(frozen=True, kw_only=True)
class ModelExchange(Capabilities):
    """What the model can do for the solver of whoever runs it."""

    needs_completed_step: bool = True


@dataclass(frozen=True)
class Terminal:
    """Variables that are connected together: their names in the terminal, and those of the FMU's variables."""

    name: str
    members: Mapping[str, str]
    kind: str = ""
    matching: str = ""
    description: str = ""


@dataclass(frozen=True)
class Experiment:
    """The experiment for which the FMU was made."""

    start: float | None = None
    stop: float | None = None
    tolerance: float | None = None
    step: float | None = None


@dataclass(frozen=True)
class ModelDescription:
    """The whole of modelDescription.xml that matters to one who runs the FMU.

    `guid` is the GUID of FMI 1.0 and 2.0, or the instantiation token of FMI 3.0. Indices of variables are 1-based.
    """

    model_name: str
    guid: str
    variables: tuple[Variable, ...]
    co_simulation: CoSimulation | None
    model_exchange: ModelExchange | None = None
    scheduled_execution: bool = False
    fmi_version: str = "2.0"
    description: str = ""
    version: str = ""
    generation_tool: str = ""
    naming: str = "flat"
    units: tuple[UnitDefinition, ...] = ()
    types: Mapping[str, str | None] = field(default_factory=dict)
    experiment: Experiment = Experiment()
    outputs: tuple[Unknown, ...] = ()
    derivatives: tuple[Unknown, ...] = ()
    initial_unknowns: tuple[Unknown, ...] = ()
    event_indicators: int = 0
    terminals: tuple[Terminal, ...] = ()
    platforms: tuple[str, ...] = ()
    """The folders of its binaries, as linux64 in FMI 2.0 and x86_64-linux in FMI 3.0."""
    has_sources: bool = False

    @cached_property
    def by_name(self) -> Mapping[str, Variable]:
        """The variables by name."""
        return {v.name: v for v in self.variables}

    def variable(self, name: str) -> Variable:
        """The variable of this name; `FmuError` with the nearest names if there is none."""
        if name not in self.by_name:
            raise FmuError.at(self.model_name, f"has no variable {name!r}", hint=nearest(name, self.by_name))
        return self.by_name[name]

    @property
    def inputs(self) -> tuple[Variable, ...]:
        """The variables of causality input."""
        return tuple(v for v in self.variables if v.causality == "input")

    @property
    def parameters(self) -> tuple[Variable, ...]:
        """The variables of causality parameter."""
        return tuple(v for v in self.variables if v.causality == "parameter")
