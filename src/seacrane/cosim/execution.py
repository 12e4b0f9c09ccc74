"""`Execution`: one run of a system. All state of a simulation is in here."""

from __future__ import annotations

import math
import os
import time as wall
import weakref
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import astuple, dataclass
from pathlib import Path
from types import TracebackType
from typing import Literal, Self

import numpy as np

from seacrane.cosim import saved
from seacrane.cosim.actions import Action, Manipulator, Names, Set, check_action
from seacrane.cosim.algorithms import NANOSECONDS, Algorithm, nanoseconds
from seacrane.cosim.bonds import ACCOUNT, SIGNALS, BondReport
from seacrane.cosim.faults import explained, too_late
from seacrane.cosim.loopgain import loop_gains
from seacrane.cosim.loops import DONE, FAULT, Fault, Loop, append
from seacrane.cosim.native_loop import NativeLoop
from seacrane.cosim.observers import ArrowRecorder, CsvRecorder, MemoryRecorder, Observer
from seacrane.cosim.plan import CHANGE, TRIGGER, Plan, Rows
from seacrane.cosim.plan import SIGNALS as OWN_SIGNALS
from seacrane.cosim.python_loop import PythonLoop
from seacrane.cosim.saved import State
from seacrane.cosim.scenario import Scenario, Timed
from seacrane.cosim.slave import Vector
from seacrane.cosim.startup import settle
from seacrane.cosim.system import System
from seacrane.cosim.triggers import Condition, Trigger, Triggers, check_conditions
from seacrane.cosim.watchdog import Late, Watchdog
from seacrane.errors import CompileError, CosimError, ParameterError, Problem, SeacraneError, nearest
from seacrane.model.dae import Variable
from seacrane.results import Recording

_RECORDERS: Mapping[str, type[CsvRecorder | ArrowRecorder]] = {
    ".csv": CsvRecorder,
    ".arrow": ArrowRecorder,
    ".parquet": ArrowRecorder,
}

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
        self._variables = system.variables
        self._causality = system.causalities
        self._connectors = system.settable_connectors
        self._places = {name: system.split(name) for name, c in self._causality.items() if c != "bond"}
        self._sources = {c.target: c.source for c in system.connections}
        self._free = {n for n, c in self._causality.items() if c == "input" and n not in self._sources}
        self._names = Names(self._variables, self._causality, self._sources, tuple(system.slaves))
        self._system, self._algorithm = system, algorithm
        if threads is not None and threads < 1:
            raise CosimError.at("threads", "is no number of threads", value=threads, allowed="1 or more")
        schedule = algorithm.schedule(tuple(system.slaves), system)
        for name in schedule.signals:
            self._variables[name] = Variable(name, OWN_SIGNALS[name])
            self._causality[name] = "algorithm"
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
        self._manipulator = Manipulator(self._plan, self._free)
        self._triggers = Triggers(self._plan)
        self._scenario: Scenario | None = None
        self._events: tuple[Timed, ...] = ()
        self._next_event = 0
        self._paused = False
        self._watchdog = self._guarded(time_limit, when_late)
        self._recorders: list[_Recorder] = []
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
        return self._variables

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
        for target, gain, bias in self._connectors.get(name, ()):
            self.set(target, gain * value + bias)
        if name in self._connectors:
            return
        problems = check_action(Set(name, value), self._names)
        if problems:
            settable = name in self._free or self._causality.get(name) == "parameter"
            raise (ParameterError if settable else CosimError)(problems)
        slave, variable = self._places[name]
        if name in self._free:
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
        problems = check_action(action, self._names)
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
        problems = check_conditions(conditions, self._names)
        if not callable(call):
            problems += check_action(call, self._names)
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
        if self._scenario is not None:
            raise CosimError.at(scenario.name, "cannot be followed: the run follows a scenario already")
        problems = scenario.check(self._names)
        timed = scenario.timed()
        problems += [
            Problem(f"events[{event.index}]", f"is due before the present time {self.time:g} s", event.at_ns / 1e9)
            for event in timed
            if event.at_ns < self._plan.time_ns
        ]
        if problems:
            raise CosimError(Problem(f"{scenario.name}: {p.path}", *astuple(p)[1:]) for p in problems)
        self._scenario, self._events = scenario, timed
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
        kind = _RECORDERS.get(Path(path).suffix)
        if kind is None:
            allowed = f"a name that ends in {', '.join(_RECORDERS)}"
            raise CosimError.at(str(path), "is of no kind of file to record into", allowed=allowed)
        recorder = kind(path)
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
        problems = [p for c in (begin, end) if c is not None for p in check_conditions([c], self._names)]
        if problems:
            raise CosimError(problems)
        if names is None:
            names = [n for n, c in self._causality.items() if c in ("output", "bond")]
        indices, watches = self._resolve(names)
        stride = 1 if every is None else self._stride(every)
        capacity = max(64, min(4096, 262_144 // (1 + len(names))))
        rows = Rows(stride, indices, watches, np.zeros((capacity, 1 + len(names))))
        observer.open({n: (self._variables[n].unit, self._variables[n].display_unit) for n in names})
        recorder = _Recorder(observer, rows)
        self._resources.callback(recorder.close)
        self._recorders.append(recorder)
        if begin is None:
            self._begin_recording(recorder)
        else:
            self.when(begin, call=lambda run: run._begin_recording(recorder), once=False)
        if end is not None:
            self.when(end, call=lambda run: run._end_recording(recorder), once=False)

    def flush(self) -> None:
        """Hand all rows recorded so far to their observers, and let these bring them to where others can read them."""
        self._flushed = wall.monotonic()
        self._each_recorder(_Recorder.flush)

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
            self._check_repeatable()
            self._plan.start()
        except BaseException as error:
            interrupted = CosimError.at("", f"the start was interrupted by {type(error).__name__}")
            self._error = error if isinstance(error, SeacraneError) else interrupted
            raise
        self._started = True
        for recorder in self._recorders:
            if any(rows is recorder.rows for rows in self._plan.rows):
                self._first_row(recorder)
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
        recorder = next((r.observer for r in self._recorders if isinstance(r.observer, MemoryRecorder)), None)
        if recorder is None:
            recorder = self.record()
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
        slaves, problems = {}, []
        for part in self._plan.parts:
            try:
                slaves[part.name] = part.instance.save()
            except SeacraneError as error:
                problems += [Problem(part.name, f"cannot be saved: {p.message}") for p in error.problems]
        if problems:
            raise CosimError(problems)
        plan = self._plan
        return State(
            plan.done,
            plan.values.tobytes(),
            slaves,
            self._manipulator.stopped,
            plan.changes.tobytes(),
            plan.conditions.tobytes(),
            plan.triggers.tobytes(),
            self._next_event,
        )

    def restore(self, state: State) -> None:
        """Go back (or forth) to a state of this system; what recorders hold of later times is forgotten.

        The scenario and the triggers must be the same as when it was saved; what triggers have called is not undone.
        """
        self._require_started()
        plan = self._plan
        if set(state.slaves) != {part.name for part in plan.parts} or len(state.values) != plan.values.nbytes:
            raise CosimError.at("state", "is that of another system")
        if state.conditions != plan.conditions.tobytes() or len(state.triggers) != plan.triggers.nbytes:
            raise CosimError.at("state", "is that of a run with other triggers")
        self.flush()
        for part in plan.parts:
            part.instance.restore(state.slaves[part.name])
            part.stopped = part.name in state.stopped
        plan.values[:] = np.frombuffer(state.values)
        plan.done = state.done
        plan.triggers[:] = np.frombuffer(state.triggers, TRIGGER)
        plan.put_changes(np.frombuffer(state.changes, CHANGE))
        plan.calls[:] = 0
        plan.stop[0] = 0
        self._next_event = state.events
        self._loop.refresh()
        self._error = None
        for recorder in self._recorders:
            recorder.observer.forget_after(self.time)

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
        if (event := self._due()) is not None:
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

    def _due(self) -> int | None:
        """Carry out the events that are due; when the next one is [ns]."""
        while self._next_event < len(self._events):
            event = self._events[self._next_event]
            if event.at_ns > self._plan.time_ns:
                return event.at_ns
            self._next_event += 1
            self.apply(event.action)
        return None

    def _hand_over(self) -> None:
        self._flushed = wall.monotonic()
        self._each_recorder(_Recorder.drain)

    def _each_recorder(self, do: Callable[[_Recorder], None]) -> None:
        """Do something with all recorders, also when one of them cannot."""
        problems: list[Problem] = []
        for recorder in self._recorders:
            try:
                do(recorder)
            except SeacraneError as error:
                problems += error.problems
        if problems:
            raise CosimError(problems)

    def _begin_recording(self, recorder: _Recorder) -> None:
        if all(rows is not recorder.rows for rows in self._plan.rows):
            self._plan.rows.append(recorder.rows)
            self._loop.refresh()
            if self._started:
                self._first_row(recorder)

    def _end_recording(self, recorder: _Recorder) -> None:
        recorder.drain()
        self._plan.rows = [rows for rows in self._plan.rows if rows is not recorder.rows]
        self._loop.refresh()

    def _stride(self, every: float) -> int:
        """How many macro steps `every` [s] is."""
        wanted, step = nanoseconds(every, "every"), self._plan.schedule.step_ns
        stride = max(1, round(wanted / step))
        if abs(wanted - stride * step) > stride:  # the step itself is rounded to whole nanoseconds
            below = wanted // step
            near = " or ".join(f"{n * step / 1e9:.9g}" for n in (below, below + 1) if n > 0)
            what = f"is no multiple of the macro step of {self.macro_step:.9g} s"
            raise CosimError.at("every", what, value=every, allowed=f"{near} s, for example")
        return stride

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
            "the scenario": saved.fingerprint(self._scenario and self._scenario.events),
        }

    def _check_repeatable(self) -> None:
        """See whether steps can be repeated; `CosimError` naming the slaves that do not let them, where they must."""
        schedule = self._plan.schedule
        if not schedule.repeats and schedule.control is None:
            return
        problems = []
        for part in self._plan.parts:
            if part.instance.calls is not None and part.instance.calls.save:
                continue
            try:
                part.instance.save()
            except SeacraneError as error:
                why = "; ".join(p.message for p in error.problems)
                what = type(self._algorithm).__name__
                problems.append(Problem(part.name, f"cannot be saved and restored, which {what} needs: {why}"))
        if problems and schedule.repeats:
            raise CosimError(problems)
        self._plan.repeats = not problems
        self._loop.refresh()

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

    def _first_row(self, recorder: _Recorder) -> None:
        if self._plan.done % recorder.rows.stride == 0:
            if recorder.rows.watches:
                self._watch()
            append(recorder.rows, self.time, self._plan)

    def _resolve(self, names: Iterable[str]) -> tuple[np.ndarray, bool]:
        """Indices into the values; `CosimError` with every name that is wrong."""
        names, problems = list(names), []
        for name in names:
            try:
                if self._require(name) == "parameter":
                    problems.append(
                        Problem(name, "is a parameter and does not change by itself: it cannot be read here")
                    )
            except CosimError as error:
                problems += error.problems
        if problems:
            raise CosimError(problems)
        watches = self._plan.watch(names)
        if watches:
            self._loop.refresh()
        return np.array([self._plan.index[name] for name in names], dtype=np.int64), watches

    def _require(self, name: str) -> str:
        try:
            return self._causality[name]
        except KeyError:
            raise CosimError.at(name, "no such variable in the system", hint=nearest(name, self._causality)) from None

    def _require_started(self) -> None:
        if not self._started:
            raise CosimError.at("", "the run has not started", hint="Call start() first.")

    def _ready(self) -> None:
        if self._error is not None:
            message = "; ".join(str(problem) for problem in self._error.problems)
            raise CosimError.at("", f"the run ended at t = {self.time:.9g} s ({message})")


class _Recorder:
    """An observer with the rows that the loop fills for it."""

    def __init__(self, observer: Observer, rows: Rows) -> None:
        self.observer, self.rows = observer, rows

    def drain(self) -> None:
        count, self.rows.count = self.rows.count, 0
        if count:
            self.observer.write(self.rows.table[:count])

    def flush(self) -> None:
        self.drain()
        self.observer.flush()

    def close(self) -> None:
        try:
            self.drain()
        finally:
            self.observer.close()


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
