"""Run one model by itself: compiled, integrated, recorded with units."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import ArrayLike

from seacrane.errors import ParameterError, Problem, SolveError, nearest
from seacrane.results import Recording, Signal
from seacrane.units import in_unit

from .classical import BDF, LSODA, Adams, Radau
from .dae import Dae
from .diagram import Diagram
from .failure import doubts
from .native import Happening, NativeModel, build
from .solvers import (
    RODAS4,
    ExplicitEuler,
    ImplicitEuler,
    Progress,
    RungeKutta4,
    RunStatistics,
    Solver,
    Task,
    progress_of,
)
from .values import unsound

Model = Diagram | Dae | NativeModel
Inputs = Mapping[str, float | tuple[ArrayLike, ArrayLike]]

SOLVERS: Final[Mapping[str, Solver]] = {
    "rodas4": RODAS4(),
    "implicit-euler": ImplicitEuler(),
    "explicit-euler": ExplicitEuler(),
    "rk4": RungeKutta4(),
    "adams": Adams(),
    "bdf": BDF(),
    "lsoda": LSODA(),
    "radau": Radau(),
}
"""Solvers by the names that `simulate` and `compare` take, with the steps they have by default."""


@dataclass(frozen=True, eq=False, repr=False)
class Run(Recording):
    """What a run of a model has given, and what it has cost.

    `doubts` tells where it left the range of its laws: a cylinder beyond its stroke, a pressure below vacuum. Only what
    was recorded is looked at. `events` are what has happened, and when (of more than 256 in a hundredth of the run, the
    last 256).
    """

    statistics: RunStatistics | None = None
    doubts: tuple[Problem, ...] = ()
    events: tuple[Happening, ...] = ()


def simulate(
    model: Model,
    until: float,
    *,
    every: float = 0.01,
    inputs: Inputs | None = None,
    parameters: Mapping[str, float] | None = None,
    record: Sequence[str] | None = None,
    solver: str | Solver = "rodas4",
    tolerance: float = 1e-6,
    linear: bool = False,
    progress: bool | Progress | None = None,
) -> Run:
    """The behaviour of a model from 0 to `until` [s], recorded every `every` [s].

    inputs: a constant, or sample times and values, for each input (SI); samples are held, or joined by straight lines
    if `linear`. parameters: values other than the model's own, start values of states included. record: names of
    variables, by default all. solver: a name of `SOLVERS`, or an object such as `RungeKutta4(step=2e-5)`. tolerance:
    relative, of adaptive solvers. progress: True shows a bar if the run takes longer than two seconds, False does not,
    None does so on a terminal; a function is called with the time reached and `until`. (SUNDIALS reports the end only.)

    Outputs within a step of RODAS4 come from the method's own interpolation, of order 3, whose error is held to the
    tolerance as well; they end no step, unless the model has events.

    The result's `statistics` tell steps, CPU time and real-time factor, its `doubts` what not to believe.

    Raises `ParameterError` for an unknown name, `SolveError` where the integration fails; its `results` are then the
    `Run` up to there.
    """
    if not (math.isfinite(until) and until > 0 and 0 < every <= until):
        raise SolveError.at(
            "simulate", f"cannot run until {until:g} s with output every {every:g} s", allowed="0 < every <= until"
        )
    chosen = solver_of(solver)
    native = compiled(model)
    variables = {v.name: v for v in native.dae.variables}
    names = list(variables) if record is None else list(record)
    unknown = [n for n in names if n not in variables]
    if unknown:
        raise ParameterError(
            Problem(native.name, f"has no variable {n!r}", hint=nearest(n, variables)) for n in unknown
        )
    times = np.linspace(0.0, until, round(until / every) + 1)
    problems = [*_not_numbers(native.dae, parameters or {}, inputs or {})]
    if isinstance(model, Diagram) and not problems:
        problems = unsound(model, parameters or {})
    if problems:
        raise ParameterError(problems)
    task = Task(
        native,
        times,
        names,
        {**(parameters or {}), **{n: float(v) for n, v in (inputs or {}).items() if not isinstance(v, tuple)}},
        {n: v for n, v in (inputs or {}).items() if isinstance(v, tuple)},
        linear,
        tolerance,
        progress_of(progress),
    )
    outcome = chosen.run(task)
    signals = {
        n: Signal(variables[n].unit, variables[n].display_unit, outcome.values[:, i]) for i, n in enumerate(names)
    }
    done = times[: len(outcome.values)]
    seen = dict(zip(names, outcome.values.T, strict=True))
    run = Run(done, signals, outcome.statistics, tuple(doubts(native.dae, done, seen, task.constants)), outcome.events)
    if outcome.error is not None:
        outcome.error.results = run
        raise outcome.error
    return run


def _not_numbers(dae: Dae, parameters: Mapping[str, float], inputs: Inputs) -> Iterator[Problem]:
    """Values that are no numbers: texts with a unit, samples that are none."""
    units = {v.name: v.unit for v in dae.variables}
    constants = {n: v for n, v in inputs.items() if not isinstance(v, tuple)}
    for name, value in {**parameters, **constants}.items():
        try:
            float(value)
        except (TypeError, ValueError):
            told = f"must be {in_unit('a number', units.get(name, 'SI'))}"
            yield Problem(name, told, value, hint="`seacrane.model.settings` reads texts with units.")
    for name, series in inputs.items():
        if not isinstance(series, tuple):
            continue
        try:
            times, values = (np.asarray(a, dtype=np.float64).reshape(-1) for a in series)
        except (TypeError, ValueError):
            yield Problem(name, "must be sample times and as many values, all of them numbers in SI")
            continue
        if times.size != values.size or not times.size:
            yield Problem(name, f"has {times.size} sample times for {values.size} values")


def compiled(model: Model) -> NativeModel:
    """The model as machine code, from whichever form it has."""
    if isinstance(model, NativeModel):
        return model
    return build(model.compile() if isinstance(model, Diagram) else model)


def solver_of(solver: str | Solver) -> Solver:
    """The solver of this name, or the one given; `SolveError` with the nearest names if there is none."""
    if not isinstance(solver, str):
        return solver
    if solver not in SOLVERS:
        raise SolveError.at("solver", f"there is none named {solver!r}", hint=nearest(solver, SOLVERS))
    return SOLVERS[solver]
