"""`diagnose`: where a coupling costs accuracy and stability, measured by running it.

The system is run by several algorithms with macro steps a factor of two apart, and each run is compared with a
reference. Of each bond are measured the error of its effort and flow, its residual power, the energy that its coupling
has created or lost (`seacrane.cosim.bonds`), and its loop gain (`seacrane.cosim.loopgain`): by how much a change is
multiplied when it has gone once around the bond within a step.

A coupling is stiff when its stability asks for a shorter step than its accuracy. Here a bond is called so when its loop
gain is above 1 with the longest step that still keeps the tolerance where each step is iterated; or when it has the
largest gain, and `Jacobi` or `GaussSeidel` has been unstable with such a step. For a mass m and a spring k the gain is
k step^2 / m, the square of the step times the natural frequency of the two: above 1 the step does not resolve that
oscillation, and at 4 Gauss-Seidel coupling of the two diverges.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, nullcontext, suppress
from dataclasses import asdict, dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from seacrane.cosim.algorithms import ALGORITHMS, NANOSECONDS, Algorithm, GaussSeidel, Iterative, Jacobi, Newton
from seacrane.cosim.diagnosis_report import ITERATED, text
from seacrane.cosim.execution import Execution
from seacrane.cosim.fmu import FmuSlave
from seacrane.cosim.slave import Vector
from seacrane.cosim.system import System
from seacrane.cosim.triggers import Above, Below
from seacrane.errors import CosimError, Problem, SeacraneError, nearest
from seacrane.fmi.logs import kept_back
from seacrane.results import Recording, sweeps
from seacrane.units import with_unit

if TYPE_CHECKING:
    from seacrane.results import Figure

SWEPT: Final = ("jacobi", "jacobi-linear", "gauss-seidel", "gauss-seidel-linear", "newton", "power-residual")
"""The algorithms that are tried, unless others are given, by their names in `ALGORITHMS`."""

PLAIN: Final = ("jacobi", "gauss-seidel")

HALVINGS, DOUBLINGS = 3, 3
"""The macro step of the system is halved and doubled so many times, unless steps are given."""

LOST = 100.0
"""A run is ended where a signal is so many of its ranges outside of where the reference has it: it is unstable."""

UNSTABLE = 1.0
"""A run that deviates by more than this share of a signal's range has no more to do with the solution."""

ALIKE = 1.2
"""CPU times within this factor are not told apart."""

DRAWN = 8
"""Bonds of the largest loop gain that are drawn."""

POINTS = 6
"""Of the reference, at which loop gains are measured."""


@dataclass(frozen=True)
class BondTrial:
    """One bond in one run: root mean squares of error [share of the range], residual and power [W]; energies [J]."""

    error: float
    residual: float
    power: float
    energy_error: float
    energy_moved: float


@dataclass(frozen=True)
class Trial:
    """One run: `error` is the largest of its couplings, as a share of the range of the signal.

    `cpu_s` is CPU time of the loop, `sweeps` how often all slaves were stepped. A run that ended before its time has a
    `failure`.
    """

    algorithm: str
    step: float
    error: float
    cpu_s: float
    real_time_factor: float
    sweeps: int
    bonds: Mapping[str, BondTrial] = field(default_factory=dict)
    failure: str = ""

    @property
    def stable(self) -> bool:
        return not self.failure and bool(self.error <= UNSTABLE)


@dataclass(frozen=True)
class BondDiagnosis:
    """What was found of a bond.

    `share` is its share of the residual power of all bonds, with the plain algorithm at its longest stable step.
    `gains` are its largest loop gains by macro step [s], `critical` the step [s] at which the gain is 1 (interpolated;
    None outside the sweep or where it could not be measured).
    """

    name: str
    share: float
    gains: Mapping[float, float]
    critical: float | None
    stiff: bool


@dataclass(frozen=True)
class Diagnosis:
    """What `diagnose` has measured, and what follows: `str()` says it in words, `figure()` draws it."""

    system: str
    until: float
    tolerance: float
    reference: str
    trials: tuple[Trial, ...]
    bonds: tuple[BondDiagnosis, ...]
    left_out: Mapping[str, str]
    notes: tuple[str, ...] = ()

    @property
    def limiting(self) -> BondDiagnosis | None:
        """The bond that limits the step: whose loop gain is the largest, or else whose residual is."""
        ranked = sorted(self.bonds, key=lambda b: (max(b.gains.values(), default=0.0), b.share))
        return ranked[-1] if ranked and (ranked[-1].gains or ranked[-1].share) else None

    @property
    def recommended(self) -> Trial | None:
        """The run that kept the tolerance at the least cost; None if none did.

        Among costs that differ by less than their measurement does, the most accurate one is the better choice.
        """
        kept = [t for t in self.trials if t.stable and t.error <= self.tolerance]
        least = min((t.cpu_s for t in kept), default=0.0)
        return min((t for t in kept if t.cpu_s <= ALIKE * least), key=lambda t: t.error, default=None)

    @property
    def closest(self) -> Trial | None:
        """The run with the least error."""
        return min((t for t in self.trials if t.stable), key=lambda t: t.error, default=None)

    def of(self, algorithm: str) -> list[Trial]:
        """The runs of one algorithm, from the shortest step to the longest."""
        return sorted((t for t in self.trials if t.algorithm == algorithm), key=lambda t: t.step)

    def order(self, algorithm: str) -> float | None:
        """Order of the error in the step, fitted over the runs with errors between 1e-8 and a tenth of the range."""
        points = [(t.step, t.error) for t in self.of(algorithm) if t.stable and 1e-8 < t.error < 0.1]
        if len(points) < 2:
            return None
        steps, errors = np.log(np.array(points)).T
        return float(np.polyfit(steps, errors, 1)[0])

    def __str__(self) -> str:
        return text(self)

    def figure(self) -> Figure:
        """Error over macro step and over cost, one curve for each algorithm, and the loop gains of the bonds.

        A matplotlib figure that belongs to no window; `figure.savefig(path)` writes it.
        """
        best = self.recommended
        runs = {
            name: [(t.step, t.cpu_s / self.until, 100 * t.error if t.stable else None) for t in self.of(name)]
            for name in dict.fromkeys(t.algorithm for t in self.trials)
        }
        strongest = sorted(self.bonds, key=lambda b: -max(b.gains.values(), default=0.0))
        return sweeps.error_and_cost(
            runs,
            "error [% of the range]",
            tolerance=100 * self.tolerance,
            chosen=(best.cpu_s / self.until, 100 * best.error) if best else None,
            gains={b.name: b.gains for b in strongest[:DRAWN] if any(b.gains.values())},
            title=f"{self.system}: error of the coupling (crosses: unstable; ringed: to be taken)",
        )

    def as_dict(self) -> dict[str, Any]:
        """For JSON: all that was measured, SI; numbers that are not finite are null."""
        recommended, limiting = self.recommended, self.limiting
        trials = [{**asdict(t), "error": t.error if math.isfinite(t.error) else None, "stable": t.stable}
                  for t in self.trials]  # fmt: skip
        bonds = [{**asdict(b), "gains": {f"{h:.9g}": g for h, g in b.gains.items()}} for b in self.bonds]
        return {
            "system": self.system,
            "until": self.until,
            "tolerance": self.tolerance,
            "reference": self.reference,
            "limiting_bond": limiting.name if limiting else None,
            "stiff": [b.name for b in self.bonds if b.stiff],
            "recommended": {"algorithm": recommended.algorithm, "step": recommended.step} if recommended else None,
            "orders": {name: self.order(name) for name in dict.fromkeys(t.algorithm for t in self.trials)},
            "bonds": bonds,
            "trials": trials,
            "left_out": dict(self.left_out),
            "notes": list(self.notes),
        }


Prepare = Callable[[Execution], None]
Progress = Callable[[int, int, str], None]


def diagnose(
    system: System,
    *,
    until: float | None = None,
    steps: Sequence[float] | None = None,
    algorithms: Sequence[str] = SWEPT,
    tolerance: float = 0.01,
    reference: Algorithm | Recording | None = None,
    prepare: Prepare | None = None,
    patience: float = 60.0,
    progress: Progress | None = None,
) -> Diagnosis:
    """Run `system` to `until` [s] by all `algorithms` with all macro `steps` [s], and say what limits its coupling.

    `until` and the steps around the macro step come from the system's experiment unless they are given; each of the
    steps divides the longest. `tolerance` is the error asked for, as a share of the range of a signal: root mean square
    over the run, of the worst effort or flow of a bond (without bonds: of the worst connected output). `reference` is a
    recording with those signals, or the algorithm that makes one; by default Newton's method with linear inputs at half
    of the shortest step, and linear Gauss-Seidel at a quarter where slaves cannot be brought back. `prepare(run)` is
    called before each run starts: to set inputs and parameters, or follow a scenario. A run that takes longer than
    `patience` [s] is given up. `progress(done, total, what)` is told of each run.

    A diagnosis is of the motion that was run: a system at rest shows nothing of its coupling. Raises `CosimError` if
    nothing is connected, nothing moves, or the reference cannot be made.
    """
    if not tolerance > 0:
        raise CosimError.at("tolerance", "must be positive", value=tolerance)
    sweep = _Sweep(system, until, steps, algorithms, prepare, patience)
    told = progress or (lambda done, total, what: None)
    total = 2 + len(sweep.names) * len(sweep.steps)
    told(0, total, "reference")
    with ExitStack() as held:
        for slave in system.slaves.values():
            if isinstance(slave, FmuSlave):
                held.enter_context(slave.held())
        exact, words, notes = sweep.reference(reference)
        done = 1
        trials: list[Trial] = []
        left_out: dict[str, str] = {}
        for name in sweep.names:
            for step in sweep.steps:
                told(done, total, f"{name}, {step:g} s")
                done += 1
                if name in left_out:
                    continue
                try:
                    trials.append(sweep.trial(name, step, exact))
                except CosimError as error:
                    left_out[name] = "; ".join(p.message for p in error.problems)
        told(total - 1, total, "loop gains")
        gains, why = sweep.gains(exact)
        if why:
            notes = (*notes, f"loop gains were not measured: {why}")
    told(total, total, "done")
    bonds = _judged(sweep, trials, gains, tolerance)
    return Diagnosis(system.name, sweep.until, tolerance, words, tuple(trials), bonds, left_out, notes)


@dataclass(frozen=True)
class _Run:
    """A run that is over: the signals at the times compared, residual and power of the bonds at each macro step."""

    run: Execution
    recording: Recording
    account: Recording
    failure: str


class _Sweep:
    """What all runs have in common: the system, the steps, the signals compared and the times at which they are."""

    def __init__(
        self,
        system: System,
        until: float | None,
        steps: Sequence[float] | None,
        algorithms: Sequence[str],
        prepare: Prepare | None,
        patience: float,
    ) -> None:
        self.system, self.prepare, self.patience = system, prepare, patience
        self.names = list(dict.fromkeys(algorithms))
        problems = [
            Problem("algorithms", "there is no such algorithm", name, hint=nearest(name, ALGORITHMS))
            for name in self.names
            if name not in ALGORITHMS
        ]
        experiment = system.experiment
        self.start = experiment.start
        until = experiment.stop if until is None else until
        if until is None or not until > self.start:
            problems.append(Problem("until", "is not given, or not after the start", until, f"above {self.start:g} s"))
        if steps is None and experiment.step is None:
            problems.append(Problem("steps", "are not given, and the system does not say its macro step"))
        if not system.connections:
            problems.append(Problem(system.name, "has no connections, so there is no coupling to diagnose"))
        if problems:
            raise CosimError(problems)
        if steps is None:
            middle = experiment.step or 0.0
            steps = [middle * 2.0**i for i in range(-HALVINGS, DOUBLINGS + 1)]
        self.steps = _checked_steps(steps)
        longest = self.steps[-1]
        assert until is not None
        self.until = self.start + longest * max(2, math.ceil((until - self.start) / longest - 1e-9))
        bonds = system.bonds.values()
        self.couplings: dict[str, tuple[str, ...]] = {b.name: (b.effort[0], b.flow[0]) for b in bonds}
        if not self.couplings:
            self.couplings = {source: (source,) for source in dict.fromkeys(c.source for c in system.connections)}
        self.sizes: dict[str, float] = {}
        self.limits: dict[str, tuple[float, float]] = {}
        self.signals = list(dict.fromkeys(s for pair in self.couplings.values() for s in pair))

    def reference(self, wanted: Algorithm | Recording | None) -> tuple[Recording, str, tuple[str, ...]]:
        """The signals of the reference at the times compared, what it is in words, and what is to be noted."""
        if isinstance(wanted, Recording):
            return self._given(wanted), "a recording that was given", ()
        shortest = self.steps[0]
        newton = Iterative(Jacobi(shortest / 2, extrapolation="linear"), Newton())
        choices: list[tuple[Algorithm, str]] = [
            (newton, f"Newton's method with linear inputs, {shortest / 2:g} s"),
            (GaussSeidel(shortest / 4, extrapolation="linear"), f"Gauss-Seidel with linear inputs, {shortest / 4:g} s"),
        ]
        if wanted is not None:
            choices = [(wanted, f"{type(wanted).__name__} as given, {wanted.step:g} s")]
        notes: list[str] = []
        for algorithm, words in choices:
            try:
                recording = self._run(algorithm, patience=math.inf).recording
            except SeacraneError as error:
                notes.append(f"no reference by {words}: {'; '.join(map(str, error.problems))}")
                continue
            self._sizes(recording)
            return recording, words, tuple(notes)
        raise CosimError(Problem("reference", note) for note in notes)

    def _given(self, wanted: Recording) -> Recording:
        missing = [s for s in self.signals if s not in wanted.signals]
        if missing:
            raise CosimError(Problem(name, "is not in the recording given as reference") for name in missing)
        if wanted.time[-1] < self.until - 1e-9:
            end = float(wanted.time[-1])
            raise CosimError.at("reference", "ends before the runs do", value=end, allowed=f"{self.until:g} s")
        count = round((self.until - self.start) / self.steps[-1])
        times: Vector = self.start + self.steps[-1] * np.arange(1.0 + count)
        signals = {s: wanted.signal(s) for s in self.signals}
        taken = Recording(times, {n: type(s)(s.unit, s.display, np.interp(times, wanted.time, s.values))
                                  for n, s in signals.items()})  # fmt: skip
        self._sizes(taken)
        return taken

    def _sizes(self, exact: Recording) -> None:
        """The range of each signal, at least a thousandth of its nominal value and a millionth of its magnitude."""
        variables = self.system.variables
        moves = False
        for name in self.signals:
            values = exact[name]
            self.limits[name] = float(values.min()), float(values.max())
            least = max(1e-3 * (abs(variables[name].nominal) or 1.0), 1e-6 * float(np.abs(values).max()))
            moves = moves or bool(np.ptp(values) > least)
            self.sizes[name] = max(float(np.ptp(values)), float(least))
        if not moves:
            raise CosimError.at(
                self.system.name, "nothing moves at its couplings", hint="Set an input or follow a scenario."
            )

    def trial(self, name: str, step: float, exact: Recording) -> Trial:
        """One run compared with the reference; `CosimError` if the algorithm cannot run this system at all."""
        done = self._run(ALGORITHMS[name](step), patience=self.patience, kept=True)
        usage = done.run.usage
        compared = {c: self._error(done.recording, exact, names) for c, names in self.couplings.items()}
        bonds = {}
        for bond, report in done.run.bonds.items():
            residual, power = (_rms(done.account[f"{bond}.{q}"]) for q in ("residual", "power"))
            bonds[bond] = BondTrial(compared[bond], residual, power, report.energy_error, report.energy_moved)
        error = math.inf if done.failure else max(compared.values())
        return Trial(name, step, error, usage.cpu_s, usage.real_time_factor, usage.sweeps, bonds, done.failure)

    def gains(self, exact: Recording) -> tuple[dict[str, dict[float, float]], str]:
        """The largest loop gain of each bond by step, or why there are none."""
        found: dict[str, dict[float, float]] = {name: {} for name in self.system.bonds}
        if not found:
            return {}, "there are no power bonds"
        try:
            for run in self._stops():
                for step in self.steps:
                    for name, gain in run.loop_gains(step, self.sizes).items():
                        found[name][step] = max(found[name].get(step, 0.0), abs(gain))
        except SeacraneError as error:
            return {}, "; ".join(map(str, error.problems))
        return found, ""

    def _stops(self) -> Iterator[Execution]:
        algorithm = GaussSeidel(self.steps[0], extrapolation="linear")
        with Execution(self.system, algorithm, start=self.start, threads=1) as run:
            if self.prepare is not None:
                self.prepare(run)
            run.start()
            for i in range(POINTS):
                run.advance(self.start + (self.until - self.start) * i / POINTS)
                yield run

    def _run(self, algorithm: Algorithm, patience: float, kept: bool = False) -> _Run:
        """One run; with `kept`, what was recorded until it failed."""
        failure = ""
        with Execution(self.system, algorithm, start=self.start, threads=1) as run:
            if self.prepare is not None:
                self.prepare(run)
            recorder = run.record(self.signals, every=self.steps[-1])
            account = run.record([f"{bond}.{q}" for bond in self.system.bonds for q in ("residual", "power")])
            run.start()

            def watch(time: float, until: float) -> None:
                if run.usage.busy_s > patience:
                    run.pause()

            lost: list[str] = []
            for name in self.limits:
                self._guard(run, name, lost)
            try:
                with kept_back() if kept else nullcontext():
                    run.run(self.until, watch)
                if lost:
                    failure = lost[0]
                elif run.time < self.until - 1e-9:
                    failure = f"given up at t = {run.time:g} s after {patience:g} s of computing"
            except SeacraneError as error:
                if not kept:
                    raise
                with suppress(SeacraneError):
                    run.flush()
                failure = "; ".join(map(str, error.problems))
            return _Run(run, recorder.recording(), account.recording(), failure)

    def _guard(self, run: Execution, name: str, lost: list[str]) -> None:
        """End the run where a signal is beyond all bounds, and say so in `lost`."""

        def end(run: Execution) -> None:
            value = float(run.values([name])[0])
            where = with_unit(f"{value:.3g}", run.variables[name].unit)
            lost.append(f"{name} is at {where} at t = {run.time:g} s, {LOST:g} times its range away from the reference")
            run.pause()

        low, high = self.limits[name]
        run.when(Above(name, high + LOST * self.sizes[name]), call=end)
        run.when(Below(name, low - LOST * self.sizes[name]), call=end)

    def _error(self, recording: Recording, exact: Recording, names: Sequence[str]) -> float:
        """The larger one of the root mean square deviations of these signals, as shares of their ranges."""
        errors = []
        for name in names:
            count = min(len(recording[name]), len(exact[name]))
            errors.append(_rms(recording[name][:count] - exact[name][:count]) / self.sizes[name])
        worst = float(np.max(errors))
        return worst if math.isfinite(worst) else math.inf


def _judged(
    sweep: _Sweep, trials: Sequence[Trial], gains: Mapping[str, Mapping[float, float]], tolerance: float
) -> tuple[BondDiagnosis, ...]:
    """Shares, critical steps and stiffness of the bonds."""
    plain = [t for t in trials if t.stable and t.algorithm in PLAIN]
    shown = max(plain, key=lambda t: (t.algorithm == "gauss-seidel", t.step), default=None)
    total = sum(b.residual for b in shown.bonds.values()) if shown else 0.0
    iterated = [t.step for t in trials if t.algorithm in ITERATED and t.stable and t.error <= tolerance]
    longest = max(iterated, default=0.0)
    lost = any(t.step <= longest and not t.stable for t in trials if t.algorithm in PLAIN)
    strongest = max(gains, key=lambda name: gains[name].get(longest, 0.0), default="")
    found = []
    for name in sweep.system.bonds:
        own = gains.get(name, {})
        share = shown.bonds[name].residual / total if shown and total else 0.0
        stiff = own.get(longest, 0.0) > 1.0 or (lost and name == strongest)
        found.append(BondDiagnosis(name, share, dict(own), _critical(own), stiff))
    return tuple(found)


def _critical(gains: Mapping[float, float]) -> float | None:
    """Where the gain passes 1, on straight lines between logarithms."""
    points = [(h, g) for h, g in sorted(gains.items()) if g > 0]
    for (h0, g0), (h1, g1) in pairwise(points):
        if g0 <= 1 < g1:
            return float(h0 * (h1 / h0) ** (math.log(1 / g0) / math.log(g1 / g0)))
    return None


def _checked_steps(steps: Sequence[float]) -> list[float]:
    """From the shortest to the longest; each divides the longest, so that all runs meet at its multiples."""
    whole = sorted({round(step * NANOSECONDS) for step in steps})
    if not whole or whole[0] < 4:
        raise CosimError.at("steps", "are no macro steps", value=list(steps), allowed="4e-9 s or more")
    problems = [
        Problem("steps", "does not divide the longest step", step / NANOSECONDS, f"{whole[-1] / NANOSECONDS:g} s / n")
        for step in whole
        if whole[-1] % step
    ]
    if problems:
        raise CosimError(problems)
    return [step / NANOSECONDS for step in whole]


def _rms(values: Vector) -> float:
    with np.errstate(over="ignore", invalid="ignore"):
        return float(np.sqrt(np.mean(np.square(values)))) if values.size else math.inf
