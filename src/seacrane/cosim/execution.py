"""`Execution`: one run of a system. All state of a simulation is in here."""

from __future__ import annotations

import math
import os
import time as wall
import weakref
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Literal, Self

import numpy as np

from seacrane.cosim import saved
from seacrane.cosim.actions import Action, Manipulator, Set, check_action
from seacrane.cosim.agenda import Agenda
from seacrane.cosim.algorithms import NANOSECONDS, Algorithm
from seacrane.cosim.bonds import ACCOUNT, SIGNALS, BondReport
from seacrane.cosim.catalogue import Catalogue
from seacrane.cosim.faults import explained, too_late
from seacrane.cosim.loopgain import loop_gains
from seacrane.cosim.loops import DONE, FAULT, Fault, Loop
from seacrane.cosim.native_loop import NativeLoop
from seacrane.cosim.observers import CsvRecorder, MemoryRecorder, Observer
from seacrane.cosim.plan import Plan
from seacrane.cosim.python_loop import PythonLoop
from seacrane.cosim.recorders import Recorder, Recorders, file_recorder
from seacrane.cosim.saved import State
from seacrane.cosim.scenario import Scenario
from seacrane.cosim.slave import Vector
from seacrane.cosim.startup import check_repeatable, settle
from seacrane.cosim.system import System
from seacrane.cosim.triggers import Condition, Trigger, Triggers, check_conditions
from seacrane.cosim.watchdog import Late, Watchdog
from seacrane.errors import CompileError, CosimError, ParameterError, SeacraneError
from seacrane.model.dae import Variable
from seacrane.results import Recording

FLUSH_S = 0.15
"""Rows are handed to the observers when this wall time [s] has passed; batches of the loop take far less."""

BATCH_S = 0.03
"""Wall time [s] of one call of the loop: below it, an interrupt from the keyboard is answered at once."""


@dataclass(frozen=True)
class Usage:
    """What a run has taken since its start: simulated time, wall time inside the loop, CPU time of it [s].

    The CPU time is that of the calling thread. `macro_steps` are those of the grid, and `sweeps` how often all slaves
    were stepped: in the steps that an adaptive algorithm takes between, in iterations, and in repeated steps.
    """

    simulated_s: float
    busy_s: float
    cpu_s: float
    macro_steps: int
    sweeps: int

    @property
    def real_time_factor(self) -> float:
        """Wall time used over simulated time; below 1 is faster than real time."""
        return self.busy_s / self.simulated_s if self.simulated_s else 0.0


class Execution:
    """A run of `system` with `algorithm`, from `start` [s].

    The order of calls is record*, set* -> start -> (step | advance | run | set | values | save | restore)* -> close,
    and `record` and `set` are welcome at any time. It is a context manager; without one, everything is closed when it
    is no longer used. `loop` is `"c"`, `"python"`, or `"auto"`: C where there is a compiler. The C loop steps slaves
    that may run side by side on up to `threads` threads (as many as there are processors, unless given), where it
    measures that this is faster; the results are the same bits with any number.

    A failure of a slave raises `CosimError` with slave, variable and time, and ends the run: what was recorded stays
    readable, `error` holds the error, and only `restore` brings the run back.

    With a `time_limit` [s] of wall time for one step of a slave, one that takes longer is logged by name while it is at
    work (`seacrane.cosim.watchdog`), and in `late`. It cannot be interrupted; when it has come back, the run ends with
    a `CosimError`, or goes on if `when_late` is `"warn"`.
    """

    def __init__(
        self,
        system: System,
        algorithm: Algorithm,
        *,
        start: float = 0.0,
        loop: Literal["auto", "c", "python"] = "auto",
        time_limit: float | None = None,
        when_late: Literal["stop", "warn"] = "stop",
        threads: int | None = None,
    ) -> None:
        if not system.slaves:
            raise CosimError.at(system.name, "has no slaves", hint="Add one with system.add(name, slave).")
        self._system, self._algorithm = system, algorithm
        if threads is not None and threads < 1:
            raise CosimError.at("threads", "is no number of threads", value=threads, allowed="1 or more")
        schedule = algorithm.schedule(tuple(system.slaves), system)
        self._catalogue = Catalogue(system, schedule)
        self._resources = ExitStack()
        self._finalizer = weakref.finalize(self, self._resources.close)
        try:
            instances = {}
            for name, slave in system.slaves.items():
                instances[name] = slave.instantiate(name)
                self._resources.callback(instances[name].close)
            self._plan = Plan(system, schedule, instances, round(start * NANOSECONDS))
            self._loop = _loop(self._plan, loop, threads or _processors())
            self._resources.callback(self._loop.close)
        except BaseException:
            self._finalizer()
            raise
        self._manipulator = Manipulator(self._plan, self._catalogue.free)
        self._triggers = Triggers(self._plan)
        self._agenda = Agenda()
        self._paused = False
        self._watchdog = self._guarded(time_limit, when_late)
        self._recorders = Recorders(self._plan, self._loop)
        self._inputs_set: dict[str, float] = {}
        self._started = False
        self._error: SeacraneError | None = None
        self._batch = 1
        self._flushed = wall.monotonic()
        self._busy = self._cpu = 0.0
        self._steps = 0

    # ------------------------------------------------------------ reading
    @property
    def time(self) -> float:
        """Simulated time [s]: an exact multiple of the macro step after the start."""
        return self._plan.time_ns / 1e9

    @property
    def macro_step(self) -> float:
        """The macro step [s]."""
        return self._plan.schedule.step_ns / 1e9

    @property
    def loop(self) -> str:
        """Which loop runs: `"c"` or `"python"`."""
        return self._loop.name

    @property
    def order(self) -> tuple[str, ...]:
        """The slaves in the order in which they step."""
        return self._plan.schedule.order

    @property
    def variables(self) -> Mapping[str, Variable]:
        """All variables that can be read, and parameters, by their full names."""
        return self._catalogue.variables

    @property
    def error(self) -> SeacraneError | None:
        """What ended the run, if something did."""
        return self._error

    @property
    def late(self) -> tuple[Late, ...]:
        """Of each slave that took longer than the time limit, the last such call, at work still or not."""
        return tuple(self._watchdog.late) if self._watchdog is not None else ()

    @property
    def usage(self) -> Usage:
        return Usage(self._steps * self.macro_step, self._busy, self._cpu, self._steps, self._plan.sweeps)

    @property
    def bonds(self) -> dict[str, BondReport]:
        """The power and energy account of each bond."""
        reports = {}
        for bond in self._plan.bonds:
            account = self._plan.values[bond.account : bond.account + len(ACCOUNT)]
            reports[bond.name] = BondReport(**{q: float(account[ACCOUNT.index(q)]) for q in SIGNALS})
        return reports

    def loop_gains(self, step: float, sizes: Mapping[str, float]) -> dict[str, float]:
        """For each bond, by how much a change is multiplied when it goes once around it in a step of `step` seconds.

        Measured at the slaves as they stand now, which are then back where they were; see `seacrane.cosim.loopgain`.
        """
        self._require_started()
        return loop_gains(self._plan, step, sizes)

    def steps_to(self, until: float) -> int:
        """How many macro steps lead to the first communication point at or after `until` [s].

        `CosimError` if that lies before the present.
        """
        if math.isfinite(until):
            steps = -(-(round(until * NANOSECONDS) - self._plan.time_ns) // self._plan.schedule.step_ns)
            if steps >= 0:
                return steps
        hint = "Time does not run back; restore() goes back to a saved state."
        raise CosimError.at("until", "is no time to come", value=until, allowed=f"from {self.time:.9g} s on", hint=hint)

    def values(self, names: Sequence[str]) -> Vector:
        """Current values, shape (names,), each in the unit of its variable (SI in our own models)."""
        return self.reader(names)()

    def reader(self, names: Sequence[str]) -> Callable[..., Vector]:
        """A fast way to read the same variables again and again.

        `read()` gives a new array of shape (names,), `read(out)` fills and gives the array `out`.
        """
        indices, watches = self._resolve(names)
        values = self._plan.values

        def read(out: Vector | None = None) -> Vector:
            if watches and self._started:
                self._watch()
            return np.take(values, indices, out=out, mode="clip")

        return read

    # ------------------------------------------------------------ setting
    def set(self, name: str, value: float) -> None:
        """Set an input that nothing drives, or a parameter, in its unit, from the next macro step on.

        A connector of the system itself sets all inputs that it leads to.
        """
        catalogue = self._catalogue
        for target, gain, bias in catalogue.connectors.get(name, ()):
            self.set(target, gain * value + bias)
        if name in catalogue.connectors:
            return
        problems = check_action(Set(name, value), catalogue.names)
        if problems:
            raise (ParameterError if catalogue.settable(name) else CosimError)(problems)
        slave, variable = catalogue.places[name]
        if name in catalogue.free:
            if value != self._plan.values[self._plan.index[name]]:
                self._plan.restart()
            self._inputs_set[name] = value
            self._manipulator.set(name, value)
        else:
            part = next(part for part in self._plan.parts if part.name == slave)
            part.instance.set({variable: value})
            self._plan.restart()

    def apply(self, action: Action) -> None:
        """Carry out an action (`Set`, `Override`, `Ramp`, `Freeze`, `Offset`, `Scale`, `Release`, `Stop`) now.

        `CosimError` if the system has no such variable, or one that this cannot be done to.
        """
        if isinstance(action, Set):
            self.set(action.variable, action.to)
            return
        self._require_started()
        problems = check_action(action, self._catalogue.names)
        if problems:
            raise CosimError(problems)
        self._manipulator.apply(action)
        self._plan.restart()
        self._loop.refresh()

    @property
    def manipulated(self) -> dict[str, float]:
        """The manipulated variables, each with its true value: that which its slave or connection gives."""
        return self._manipulator.manipulated

    @property
    def stopped(self) -> tuple[str, ...]:
        """The slaves that were stopped."""
        return self._manipulator.stopped

    # ------------------------------------------------------------ triggers and scenarios
    def when(self, *conditions: Condition, call: Callable[[Execution], None] | Action, once: bool = True) -> None:
        """Do something at the first communication point at which all conditions (`Above`, `Below`) hold.

        `call` is an action, or a function of the run; it comes after the row of that point was recorded. It may set,
        apply, read and save. Unless `once`, it is called again each time the conditions come to hold after they
        did not.
        """
        problems = check_conditions(conditions, self._catalogue.names)
        if not callable(call):
            problems += check_action(call, self._catalogue.names)
        if problems:
            raise CosimError(problems)
        whole = weakref.ref(self)

        def done() -> None:
            run = whole()
            assert run is not None
            if callable(call):
                call(run)
            else:
                run.apply(call)

        indices, watches = self._resolve([c.variable for c in conditions])
        self._triggers.add(Trigger(conditions, done, once), indices.tolist(), watches)
        self._loop.refresh()
        if self._started:
            self._look()

    def follow(self, scenario: Scenario) -> None:
        """Carry out the events of a scenario, each at the first communication point at which it is due.

        An event takes effect after the row of that point was recorded. `CosimError` with all events that do not fit
        the system, or lie before the present.
        """
        self._agenda.follow(scenario, self._catalogue.names, self._plan.time_ns)
        for event in scenario.events:
            if event.conditions is not None:
                self.when(*event.conditions, call=event.action)

    # ------------------------------------------------------------ observing
    def record(
        self,
        names: Sequence[str] | None = None,
        *,
        every: float | None = None,
        keep: float | None = None,
        begin: Condition | None = None,
        end: Condition | None = None,
    ) -> MemoryRecorder:
        """Record into memory: all outputs and bonds by default, at each macro step or `every` so many seconds.

        `every` is a multiple of the macro step; `CosimError` names the nearest ones of what is none. With `keep` only
        the last so many seconds of simulated time are kept. With `begin`, rows come from each point at which that
        condition comes to hold; with `end`, none come after a point at which that one comes to hold.
        """
        recorder = MemoryRecorder(keep)
        self.observe(recorder, names, every=every, begin=begin, end=end)
        return recorder

    def record_file(
        self,
        path: str | Path,
        names: Sequence[str] | None = None,
        *,
        every: float | None = None,
        begin: Condition | None = None,
        end: Condition | None = None,
    ) -> Observer:
        """Record into a file while the run goes on; the rest as for `record`.

        The suffix of the path says its kind: `.csv`, `.arrow` (a stream that survives a crash, see `ArrowRecorder`),
        or `.parquet` (that stream, turned into Parquet when the run is closed).
        """
        recorder = file_recorder(path)
        self.observe(recorder, names, every=every, begin=begin, end=end)
        return recorder

    def record_csv(
        self, path: str | Path, names: Sequence[str] | None = None, *, every: float | None = None
    ) -> CsvRecorder:
        """Record into a CSV file while the run goes on; names and `every` as for `record`."""
        recorder = CsvRecorder(path)
        self.observe(recorder, names, every=every)
        return recorder

    def observe(
        self,
        observer: Observer,
        names: Sequence[str] | None = None,
        *,
        every: float | None = None,
        begin: Condition | None = None,
        end: Condition | None = None,
    ) -> None:
        """Hand rows of these variables to an observer; all else as for `record`."""
        problems = [p for c in (begin, end) if c is not None for p in check_conditions([c], self._catalogue.names)]
        if problems:
            raise CosimError(problems)
        names = self._catalogue.observed if names is None else names
        indices, watches = self._resolve(names)
        signals = {n: ((v := self.variables[n]).unit, v.display_unit) for n in names}
        recorder = self._recorders.add(observer, signals, indices, watches, every)
        self._resources.callback(recorder.close)
        if begin is None:
            self._begin_recording(recorder)
        else:
            self.when(begin, call=lambda run: run._begin_recording(recorder), once=False)
        if end is not None:
            self.when(end, call=lambda run: run._recorders.end(recorder), once=False)

    def flush(self) -> None:
        """Hand all rows recorded so far to their observers, and let these bring them to where others can read them."""
        self._flushed = wall.monotonic()
        self._recorders.flush()

    # ------------------------------------------------------------ running
    def start(self) -> Self:
        """Initialise the slaves in order and make their connected values consistent. Starting twice does nothing."""
        if self._started:
            return self
        self._ready()
        try:
            settle(self._plan, self._inputs_set)
            for part in self._plan.parts:
                part.instance.begin()
            self._plan.repeats = check_repeatable(self._plan, type(self._algorithm).__name__)
            self._loop.refresh()
            self._plan.start()
        except BaseException as error:
            interrupted = CosimError.at("", f"the start was interrupted by {type(error).__name__}")
            self._error = error if isinstance(error, SeacraneError) else interrupted
            raise
        self._started = True
        self._recorders.first_rows(self._watch)
        self._look()
        return self

    def pause(self) -> None:
        """Let `step`, `advance` or `run` return after the macro step in which it is; they may be called again.

        For triggers, progress functions and other threads.
        """
        self._paused = True
        self._plan.stop[0] = 1

    def step(self, steps: int = 1) -> bool:
        """Do so many macro steps; whether they were all done, and `pause` was not called."""
        self.start()
        self._ready()
        target = self._plan.done + steps
        while self._plan.done < target:
            if self._pausing():
                return False
            self._run_batch(min(self._batch, target - self._plan.done))
        return not self._pausing()

    def advance(self, until: float) -> bool:
        """Go on to the first communication point at or after `until` [s], or to a `pause`; whether it was reached."""
        return self.step(self.steps_to(until))

    def run(self, until: float, progress: Callable[[float, float], None] | None = None) -> Recording:
        """Start if need be, advance to `until` [s], and give what the first recorder in memory holds.

        Without one, all outputs and bonds are recorded at each macro step from here on. `progress(time, until)` is
        called some ten times a second. The end comes earlier if `pause` is called.
        """
        recorder = self._recorders.in_memory or self.record()
        self.start()
        told = wall.monotonic()
        target = self._plan.done + self.steps_to(until)
        while (remaining := target - self._plan.done) > 0:
            if self._pausing():
                break
            self._ready()
            self._run_batch(min(self._batch, remaining))
            if progress is not None and (wall.monotonic() - told >= 0.1 or remaining <= self._batch):
                told = wall.monotonic()
                progress(self.time, until)
        self._pausing()
        self.flush()
        return recorder.recording()

    def save(self) -> State:
        """The whole state, to which `restore` goes back exactly; `CosimError` naming each slave that cannot."""
        self._require_started()
        self._ready()
        return saved.taken(self._plan, self._manipulator.stopped, self._agenda.passed)

    def restore(self, state: State) -> None:
        """Go back (or forth) to a state of this system; what recorders hold of later times is forgotten.

        The scenario and the triggers must be the same as when it was saved; what triggers have called is not undone.
        """
        self._require_started()
        saved.check(self._plan, state)
        self.flush()
        saved.put_back(self._plan, state)
        self._agenda.passed = state.events
        self._loop.refresh()
        self._error = None
        self._recorders.forget_after(self.time)

    def save_file(self, path: str | Path) -> None:
        """Save the whole state to a file, from which a run in another process can go on: see `restore_file`."""
        saved.write(path, self.save(), self.time, self._made_of())

    def restore_file(self, path: str | Path) -> None:
        """Go on from a file that `save_file` has written, also in another process; starts the run if need be.

        The run goes on bit by bit as the saved one would have. `CosimError` with all that is different if it is not
        made of the same slaves, connections, algorithm and scenario, or if the file is damaged or of another format.
        """
        state = saved.read(path, self._made_of())
        self.start()
        self.restore(state)

    def close(self) -> None:
        """Hand over what was recorded, close all observers and free all slaves."""
        self._error = self._error or CosimError.at("", "the run has been closed")
        self._finalizer()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    # ------------------------------------------------------------ inside
    def _run_batch(self, steps: int) -> None:
        plan = self._plan
        for action in self._agenda.due(plan.time_ns):
            self.apply(action)
        if (event := self._agenda.next_ns) is not None:
            steps = min(steps, -(-(event - plan.time_ns) // plan.schedule.step_ns))
        if self._watchdog is not None:
            self._watchdog.time = self.time
        before = plan.done
        wall_before, cpu_before = wall.perf_counter(), wall.thread_time()
        result = self._loop.run(steps)
        elapsed = wall.perf_counter() - wall_before
        self._busy += elapsed
        self._cpu += wall.thread_time() - cpu_before
        self._steps += plan.done - before
        if elapsed > BATCH_S:
            self._batch = max(1, self._batch // 2)
        elif elapsed < BATCH_S / 4 and steps == self._batch:
            self._batch *= 2
        if result == FAULT and self._loop.fault is not None:
            self._fail(self._loop.fault)
        if self._watchdog is not None and self._watchdog.end and self.late:
            late, self._watchdog.late = self.late, []
            self._end(too_late(late, self._watchdog.limit, plan))
        if result != DONE or wall.monotonic() - self._flushed > FLUSH_S:
            self._hand_over()
        self._triggers.fire()

    def _guarded(self, limit: float | None, when_late: str) -> Watchdog | None:
        if limit is None:
            return None
        if not limit > 0:
            raise CosimError.at("time_limit", "must be positive", value=limit)
        names = [part.name for part in self._plan.parts]
        watchdog = Watchdog(names, self._plan.calls, self._plan.stop, limit, when_late == "stop")
        self._resources.callback(watchdog.close)
        return watchdog

    def _hand_over(self) -> None:
        self._flushed = wall.monotonic()
        self._recorders.drain()

    def _begin_recording(self, recorder: Recorder) -> None:
        if self._recorders.begin(recorder) and self._started:
            self._recorders.first_row(recorder, self._watch)

    def _look(self) -> None:
        """Do what triggers do that hold from the beginning."""
        if self._plan.trigger_watches:
            self._watch()
        if self._plan.look():
            self._triggers.fire()

    def _pausing(self) -> bool:
        """Whether `pause` was called; it is over with that."""
        paused, self._paused = self._paused, False
        if paused:
            self._plan.stop[0] = 0
        return paused

    def _made_of(self) -> dict[str, str]:
        """What a saved state must have in common with the run that goes on from it, as fingerprints."""
        system = self._system
        return {
            **{f"slave {name!r}": slave.fingerprint for name, slave in system.slaves.items()},
            "the connections": saved.fingerprint(system.connections, tuple(system.bonds.items())),
            "the algorithm": saved.fingerprint(
                type(self._algorithm).__name__, self._plan.schedule, self._plan.start_ns
            ),
            "the scenario": saved.fingerprint(self._agenda.scenario and self._agenda.scenario.events),
        }

    def _fail(self, fault: Fault) -> None:
        error, cause = explained(fault, self._plan)
        if cause is not None and not isinstance(cause, Exception):
            self._error = error
            raise cause
        self._end(error, cause)

    def _end(self, error: CosimError, cause: BaseException | None = None) -> None:
        """End the run with all rows where they can be read; what cannot be kept is told with the error."""
        self._error = error
        try:
            self.flush()
        except SeacraneError as lost:
            self._error = CosimError([*error.problems, *lost.problems])
        raise self._error from cause

    def _watch(self) -> None:
        if self._error is None and self._loop.watch() == FAULT and self._loop.fault is not None:
            self._fail(self._loop.fault)

    def _resolve(self, names: Iterable[str]) -> tuple[np.ndarray, bool]:
        """Indices into the values; `CosimError` with every name that is wrong."""
        names = list(names)
        self._catalogue.check_readable(names)
        watches = self._plan.watch(names)
        if watches:
            self._loop.refresh()
        return np.array([self._plan.index[name] for name in names], dtype=np.int64), watches

    def _require_started(self) -> None:
        if not self._started:
            raise CosimError.at("", "the run has not started", hint="Call start() first.")

    def _ready(self) -> None:
        if self._error is not None:
            message = "; ".join(str(problem) for problem in self._error.problems)
            raise CosimError.at("", f"the run ended at t = {self.time:.9g} s ({message})")


def _processors() -> int:
    """Those that this process may use, where the system tells."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _loop(plan: Plan, wanted: str, threads: int) -> Loop:
    if wanted == "python":
        return PythonLoop(plan)
    try:
        return NativeLoop(plan, threads)
    except CompileError:
        if wanted == "c":
            raise
        return PythonLoop(plan)
