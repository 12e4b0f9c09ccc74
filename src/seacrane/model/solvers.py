"""The solvers of the C core, by name or as objects, and what every solver is given and gives back.

RODAS4 is what to use: adaptive, implicit, in C, and the one that exported FMUs contain. The others are there to compare
with, and because somebody has to reproduce a result of theirs.
"""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seacrane.errors import ParameterError, SolveError

from .failure import Stop, explained
from .native import Happening, NativeInstance, NativeModel
from .singular import Point

Reals = NDArray[np.float64]
Progress = Callable[[float, float], None]
"""Called with the time reached and the time to reach, both [s]."""

CHUNKS = 100
"""Parts in which a run is handed to the C core: between them a progress bar moves and an interrupt is heard."""


@dataclass(frozen=True)
class RunStatistics:
    """What a run has cost: steps and evaluations, CPU time [s] of the integration alone, and simulated time [s]."""

    solver: str
    steps: int
    rejected: int
    evaluations: int
    jacobians: int
    cpu_time: float
    simulated: float

    @property
    def real_time_factor(self) -> float:
        """CPU time over simulated time; below 1 is faster than real time."""
        return self.cpu_time / self.simulated if self.simulated > 0 else math.nan


@dataclass(frozen=True)
class Task:
    """A run to be done: a model, its settings, the output times [s] and the names of what is recorded.

    `constants` are values of inputs, parameters and starts; `sampled` the inputs that change: times and values.
    """

    native: NativeModel
    times: Reals
    names: Sequence[str]
    constants: Mapping[str, float]
    sampled: Mapping[str, tuple[ArrayLike, ArrayLike]]
    linear: bool
    tolerance: float
    progress: Progress

    def start(self) -> NativeInstance:
        """An instance at the first output time, its algebraic unknowns solved."""
        instance = self.native.instantiate()
        try:
            settings = dict(self.constants)
            for name, (_, values) in self.sampled.items():
                settings[name] = float(np.asarray(values, dtype=np.float64).reshape(-1)[0])
            instance.set(list(settings), list(settings.values()))
            try:
                instance.initialize(float(self.times[0]))
            except SolveError as failure:
                raise self.explained(failure, instance.point()) from None
        except BaseException:
            instance.close()
            raise
        return instance

    def explained(
        self, failure: SolveError, point: Point, *, implicit: bool = True, rows: Reals | None = None
    ) -> SolveError:
        """The failure, with what stands out at that point; `rows` is what was recorded before."""
        seen = dict(zip(self.names, rows.T, strict=True)) if rows is not None else {}
        stop = Stop(point, self.sampled, self.linear, self.tolerance, implicit, seen)
        return explained(failure, self.native.dae, stop)


@dataclass(frozen=True)
class Outcome:
    """Values of the recorded variables at the times that were reached, the error if those are not all, and events."""

    values: Reals
    statistics: RunStatistics
    error: SolveError | None = None
    events: tuple[Happening, ...] = ()


class Solver(Protocol):
    """How a model is integrated."""

    @property
    def name(self) -> str:
        """What tables call it."""
        ...

    def run(self, task: Task) -> Outcome:
        """Does the task as far as it can be done."""
        ...


# ---------------------------------------------------------------- in the C core
@dataclass(frozen=True)
class _InCore:
    name: ClassVar[str]
    implicit: ClassVar[bool] = True

    def prepare(self, instance: NativeInstance, task: Task) -> None:
        raise NotImplementedError

    def run(self, task: Task) -> Outcome:
        parts: list[Reals] = []
        events: list[Happening] = []
        seen = 0
        error: SolveError | None = None
        with task.start() as instance:
            self.prepare(instance, task)
            spent = 0.0
            for part in np.array_split(np.arange(task.times.size), min(CHUNKS, task.times.size)):
                begun = time.process_time()
                try:
                    parts.append(
                        instance.simulate(task.times[part], task.names, dict(task.sampled), linear=task.linear)
                    )
                except SolveError as failure:
                    error = failure
                    parts.append(failure.results)
                spent += time.process_time() - begun
                seen, latest = instance.events(seen)
                events += latest
                if error is not None:
                    here, rows = instance.point(), np.concatenate(parts)
                    error = task.explained(error, here, implicit=self.implicit, rows=rows)
                    break
                task.progress(instance.time, float(task.times[-1]))
            s = instance.statistics
            reached = instance.time - float(task.times[0])
        statistics = RunStatistics(self.name, s.steps, s.rejected, s.residuals, s.jacobians, spent, reached)
        return Outcome(np.concatenate(parts), statistics, error, tuple(events))


@dataclass(frozen=True)
class RODAS4(_InCore):
    """Adaptive linearly implicit Runge-Kutta (Rosenbrock) of order 4, L-stable; the default.

    Source: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, 1996, sections IV.7 and VI.4.
    """

    name = "RODAS4"

    def prepare(self, instance: NativeInstance, task: Task) -> None:
        instance.set("solver.tolerance", task.tolerance)


@dataclass(frozen=True)
class _FixedStep(_InCore):
    step: float = 1e-3

    def __post_init__(self) -> None:
        if not 0 < self.step < math.inf:
            raise ParameterError.at(f"{type(self).__name__}.step", f"cannot be {self.step:g} s", allowed="above 0 s")


@dataclass(frozen=True)
class ImplicitEuler(_FixedStep):
    """The linearly implicit Euler method of fixed `step` [s]: order 1, stable, the same cost at every step."""

    name = "implicit Euler"

    def prepare(self, instance: NativeInstance, task: Task) -> None:
        instance.set("solver.fixed_step", self.step)


@dataclass(frozen=True)
class ExplicitEuler(_FixedStep):
    """Euler's method of fixed `step` [s]: stable only if the step resolves the fastest rate of the model."""

    step: float = 1e-5
    name = "explicit Euler"
    implicit = False

    def prepare(self, instance: NativeInstance, task: Task) -> None:
        instance.step_explicitly(1, self.step)


@dataclass(frozen=True)
class RungeKutta4(_FixedStep):
    """The classical Runge-Kutta method of order 4 with fixed `step` [s]; stable up to 2.78 over the fastest rate."""

    step: float = 1e-5
    name = "Runge-Kutta 4"
    implicit = False

    def prepare(self, instance: NativeInstance, task: Task) -> None:
        instance.step_explicitly(4, self.step)


# ---------------------------------------------------------------- progress
@dataclass
class ProgressBar:
    """A line on the terminal that shows how far a run is, from the second `after` [s] of it on."""

    after: float = 2.0
    stream: Any = None
    _begun: float = field(default_factory=time.monotonic)
    _shown: float = 0.0

    def __call__(self, now: float, until: float) -> None:
        stream, clock = self.stream or sys.stderr, time.monotonic()
        done = now >= until
        if clock - self._begun < self.after or (clock - self._shown < 0.1 and not done):
            return
        self._shown = clock
        share = now / until if until > 0 else 1.0
        bar = "#" * int(30 * share)
        stream.write(f"\r[{bar:<30}] {now:.6g} of {until:.6g} s, {clock - self._begun:.0f} s" + ("\n" if done else ""))
        stream.flush()


def progress_of(wanted: bool | Progress | None) -> Progress:
    """The callback for the argument `progress` of `simulate`: by default a bar if a person is watching."""
    if callable(wanted):
        return wanted
    if wanted or (wanted is None and sys.stderr is not None and sys.stderr.isatty()):
        return ProgressBar()
    return lambda now, until: None
