"""The form to which every model comes: a semi-explicit DAE of index 1 with named, unit-carrying variables.

    dx/dt = ode(t, x, z, u, p)
        0 = alg(t, x, z, u, p)       d alg / d z regular
        y = out(t, x, z, u, p)       outputs: what others may connect to
        w = obs(t, x, z, u, p)       observables: everything else worth plotting

p holds the parameters, then the modes: numbers that stay as they are until an event changes them. An event happens
where its indicator rises above zero, and sets states and modes to new values.

Diagrams compile to it, rigid-body cranes and vessels are written in it, and the C core, the FMU export and the
linearisation start from it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import casadi as ca

from seacrane.errors import Problem, StructureError
from seacrane.units import UNITS, display


@dataclass(frozen=True)
class Variable:
    """A scalar variable of a model.

    `start` is the default value of a parameter or input and the initial value of a state; `nominal` is the typical
    magnitude, which scales the solver's absolute tolerance. Both are SI, in `unit`.
    """

    name: str
    unit: str = "1"
    start: float = 0.0
    nominal: float = 1.0
    minimum: float = -math.inf
    maximum: float = math.inf
    about: str = ""
    shown: str = ""

    @property
    def display_unit(self) -> str:
        return self.shown or display(self.unit)


@dataclass(frozen=True)
class Event:
    """What happens where `indicator` rises above zero: the states and modes named in `resets` get these values.

    The indicator is of the order of one. All values are computed from what was before. Of events at the same instant
    that set the same variable, the later one in the model wins.
    """

    name: str
    indicator: Any
    resets: Mapping[str, Any]
    about: str = ""


@dataclass(frozen=True)
class Divisor:
    """What equations were divided by when they were solved in closed form: a square matrix in t, x, z, u and p.

    `unknowns` are the names of what was solved for. Where the matrix is singular, these have no value.
    """

    unknowns: tuple[str, ...]
    coefficients: Any


@dataclass(frozen=True)
class PowerBond:
    """An across variable (pressure, speed) and a through variable (flow, force) whose product is power.

    One of them is an input, the other an output. `inward`: positive power goes into the model rather than out of it.
    """

    name: str
    across: str
    through: str
    inward: bool = True


@dataclass(frozen=True)
class Dae:
    """A model as equations: variables, their CasADi symbols (column vectors in the same order) and expressions."""

    name: str
    states: tuple[Variable, ...]
    algebraics: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    parameters: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    observables: tuple[Variable, ...]
    t: Any
    x: Any
    z: Any
    u: Any
    p: Any
    ode: Any
    alg: Any
    out: Any
    obs: Any
    about: str = ""
    sources: tuple[str, ...] = field(default=())
    divisors: tuple[Divisor, ...] = field(default=())
    bonds: tuple[PowerBond, ...] = field(default=())
    modes: tuple[Variable, ...] = ()
    events: tuple[Event, ...] = ()

    def __post_init__(self) -> None:
        problems = []
        pairs = (
            ("states", self.states, self.x),
            ("algebraics", self.algebraics, self.z),
            ("inputs", self.inputs, self.u),
            ("parameters and modes", self.constants, self.p),
            ("states", self.states, self.ode),
            ("algebraics", self.algebraics, self.alg),
            ("outputs", self.outputs, self.out),
            ("observables", self.observables, self.obs),
        )
        for group, variables, vector in pairs:
            if vector.numel() != len(variables):
                problems.append(Problem(self.name, f"{len(variables)} {group}, but {vector.numel()} expressions"))
        names = [v.name for v in self.variables] + [e.name for e in self.events]
        problems += [Problem(n, "is the name of two variables") for n in sorted(set(names)) if names.count(n) > 1]
        settable = {v.name for v in self.states + self.modes}
        problems += [
            Problem(e.name, f"sets {n!r}, which is no state and no mode")
            for e in self.events
            for n in sorted(set(e.resets) - settable)
        ]
        problems += [Problem(v.name, f"unknown unit {v.unit!r}") for v in self.variables if v.unit not in UNITS]
        given, found = ({v.name for v in group} for group in (self.inputs, self.outputs))
        problems += [
            Problem(f"{self.name}.{b.name}", f"a power bond is an input and an output, not {b.across} and {b.through}")
            for b in self.bonds
            if any(len({b.across, b.through} & group) != 1 for group in (given, found))
        ]
        if problems:
            raise StructureError(problems)

    @property
    def variables(self) -> tuple[Variable, ...]:
        """All variables: states, algebraics, inputs, parameters, outputs, observables, modes, in this order."""
        return (
            self.states + self.algebraics + self.inputs + self.parameters + self.outputs + self.observables + self.modes
        )

    @property
    def constants(self) -> tuple[Variable, ...]:
        """What p holds: parameters, then modes."""
        return self.parameters + self.modes


def column(*expressions: Any) -> Any:
    """A dense CasADi column of the given expressions (an empty column for none)."""
    return ca.densify(ca.vertcat(*expressions)) if expressions else ca.SX(0, 1)
