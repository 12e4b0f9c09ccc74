"""Models and solvers side by side: how far from a reference, how fast, and both over time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from seacrane.errors import ParameterError, SolveError
from seacrane.results import Recording, overlay
from seacrane.units import labelled

from .simulate import Inputs, Model, Run, compiled, simulate, solver_of
from .solvers import Progress, Solver

if TYPE_CHECKING:
    from seacrane.results import Figure

TIGHT = 1e-10
"""Relative tolerance of a reference that is computed."""


@dataclass(frozen=True)
class Row:
    """One line of a comparison. `rmse` is in `unit`; it and the times are those up to `failure`, if there is one."""

    model: str
    solver: str
    rmse: float
    unit: str
    real_time_factor: float
    steps: int
    failure: str = ""


@dataclass(frozen=True, eq=False)
class Comparison:
    """Runs side by side; `print` it for the table, `data()` for the rows, `plot()` for the curves.

    `runs` are keyed by (model, solver), `reference` is what they are compared with.
    """

    signal: str
    rows: tuple[Row, ...]
    runs: Mapping[tuple[str, str], Run]
    reference: Recording = field(repr=False)

    def data(self) -> list[dict[str, Any]]:
        """The rows as plain dictionaries, for JSON or a data frame."""
        return [asdict(row) for row in self.rows]

    def plot(self, unit: str | None = None) -> Figure:
        """The signal of all runs over the reference, and below it how far each is from it."""
        named = {", ".join(key): run for key, run in self.runs.items()}
        return overlay(self.signal, named, self.reference, unit)

    def __str__(self) -> str:
        width = max(len(r.model) for r in self.rows), max(len(r.solver) for r in self.rows)
        error = labelled("RMSE", self.rows[0].unit)
        head = f"{'model':<{width[0]}}  {'solver':<{width[1]}}  {'RTF':>9}  {error:>11}  steps"
        lines = [
            f"{r.model:<{width[0]}}  {r.solver:<{width[1]}}  {r.real_time_factor:>9.2g}  {r.rmse:>11.3g}  {r.steps}"
            + (f"  {r.failure}" if r.failure else "")
            for r in self.rows
        ]
        return "\n".join([f"{self.signal}: RTF is CPU time over simulated time", head, *lines])


def compare(
    models: Model | Mapping[str, Model],
    until: float,
    signal: str,
    *,
    solvers: Sequence[str | Solver] = ("rodas4",),
    reference: str | Recording | None = None,
    every: float = 0.01,
    inputs: Inputs | None = None,
    parameters: Mapping[str, float] | None = None,
    tolerance: float = 1e-6,
    linear: bool = False,
    progress: bool | Progress | None = None,
) -> Comparison:
    """Runs every model with every solver and compares `signal` of each with a reference.

    models: one, or several by label, such as the fidelity levels of one diagram. reference: a recording that has the
    signal; or the name of another signal of each run, such as what a controller should have followed; or None, for the
    last model solved by RODAS4 at a relative tolerance of 1e-10. The rest is as in `simulate`. A run that fails gets
    its row too, up to where it failed.

    Raises `ParameterError` for a signal that a model does not have.
    """
    named = {k: compiled(m) for k, m in models.items()} if isinstance(models, Mapping) else {"": compiled(models)}
    if not named or not solvers:
        raise ParameterError.at("compare", "needs at least one model and one solver")
    common: dict[str, Any] = {"every": every, "inputs": inputs, "parameters": parameters, "linear": linear}
    common["progress"] = progress
    record = [signal, reference] if isinstance(reference, str) and reference != signal else [signal]
    last = list(named.values())[-1]
    goal: Recording | None = reference if isinstance(reference, Recording) else None
    if reference is None:
        goal = simulate(last, until, record=record, tolerance=TIGHT, **common)
    runs: dict[tuple[str, str], Run] = {}
    rows = []
    for label, native in named.items():
        for solver in map(solver_of, solvers):
            failure = ""
            try:
                run = simulate(native, until, record=record, solver=solver, tolerance=tolerance, **common)
            except SolveError as error:
                if error.results is None:
                    raise
                run, failure = error.results, str(error)
            key = (label or native.name, _unique(solver, runs, label or native.name))
            runs[key] = run
            against, name = (run, str(reference)) if goal is None else (goal, signal)
            with np.errstate(over="ignore"):  # of a run that diverged
                rmse = run.rmse(against, signal, name) if len(run) else float("nan")
            assert run.statistics is not None
            cost = run.statistics
            rows.append(Row(*key, rmse, run.signal(signal).unit, cost.real_time_factor, cost.steps, failure))
    if goal is None:
        whole = max(runs.values(), key=len)
        goal = Recording(whole.time, {signal: whole.signal(str(reference))})
    return Comparison(signal, tuple(rows), runs, goal)


def _unique(solver: Solver, runs: Mapping[tuple[str, str], Run], model: str) -> str:
    """The solver's name, with its step where the name alone would stand twice."""
    step = getattr(solver, "step", None)
    name = solver.name if step is None else f"{solver.name}, {step:g} s"
    if (model, name) in runs:
        raise ParameterError.at("solvers", f"{name} stands there twice")
    return name
