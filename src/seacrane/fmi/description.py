"""What an FMU says of itself: the model description of FMI 2.0 as typed, frozen data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Final

Value = float | int | bool | str

TYPES: Final = ("Real", "Integer", "Boolean", "String", "Enumeration")
CAUSALITIES: Final = ("parameter", "calculatedParameter", "input", "output", "local", "independent")
VARIABILITIES: Final = ("constant", "fixed", "tunable", "discrete", "continuous")
INITIALS: Final = ("exact", "approx", "calculated")


@dataclass(frozen=True)
class UnitDefinition:
    """A unit: exponents of the SI base units (and rad), factor and offset to them, and its display units.

    value in base units = factor * value + offset; a display unit maps to its own (factor, offset) from the unit.
    """

    name: str
    exponents: Mapping[str, int] = field(default_factory=dict)
    factor: float = 1.0
    offset: float = 0.0
    display: Mapping[str, tuple[float, float]] = field(default_factory=dict)


@dataclass(frozen=True)
class ScalarVariable:
    """A variable of an FMU; `initial` is what the standard gives as default if the file does not say.

    `derivative` is the 1-based index of the state of which this is the time derivative.
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


@dataclass(frozen=True)
class Unknown:
    """An entry of the model structure: 1-based index of a variable and of those it depends on (None: on all)."""

    index: int
    dependencies: tuple[int, ...] | None = None
    kinds: tuple[str, ...] | None = None
    line: int = 0


@dataclass(frozen=True)
class CoSimulation:
    """What the co-simulation slave can do (FMI 2.0.4, section 4.3.1)."""

    model_identifier: str
    variable_step: bool = False
    interpolates_inputs: bool = False
    needs_execution_tool: bool = False
    once_per_process: bool = False
    saves_state: bool = False
    serializes_state: bool = False
    directional_derivative: bool = False


@dataclass(frozen=True)
class Experiment:
    """The experiment for which the FMU was made."""

    start: float | None = None
    stop: float | None = None
    tolerance: float | None = None
    step: float | None = None


@dataclass(frozen=True)
class ModelDescription:
    """The whole of modelDescription.xml that matters to one who runs the FMU for co-simulation."""

    model_name: str
    guid: str
    variables: tuple[ScalarVariable, ...]
    co_simulation: CoSimulation | None
    model_exchange: bool = False
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

    @cached_property
    def by_name(self) -> Mapping[str, ScalarVariable]:
        """The variables by name."""
        return {v.name: v for v in self.variables}

    @property
    def inputs(self) -> tuple[ScalarVariable, ...]:
        """The variables of causality input."""
        return tuple(v for v in self.variables if v.causality == "input")

    @property
    def parameters(self) -> tuple[ScalarVariable, ...]:
        """The variables of causality parameter."""
        return tuple(v for v in self.variables if v.causality == "parameter")
