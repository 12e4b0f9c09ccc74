"""The two master loops: C, and plain Python where there is no compiler. Both give the same bits.

They do the same operations on the same `Plan` in the same order: see `seacrane/native/master.c`, whose functions have
the same names as those here.
"""

from __future__ import annotations

import ctypes
import functools
import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np

from seacrane.cosim.plan import BondIndices, Part, Plan, Rows, Transfer
from seacrane.cosim.slave import Callback, GetFunction, SetFunction, StepFunction
from seacrane.native import build_library, source

DONE, ROWS_FULL, FAULT, STOPPED = range(4)
STAGES = ("set", "step", "get", "finite", "watch")


@dataclass(frozen=True)
class Fault:
    """Where a loop stopped: the slave, the stage of its exchange, the FMI status, and the output that is not finite."""

    slave: int
    stage: str
    status: int
    variable: int


class Loop(ABC):
    """Runs macro steps of a plan. `refresh` is called after watched variables or recorders have changed."""

    name: str
    fault: Fault | None = None

    @abstractmethod
    def refresh(self) -> None: ...

    @abstractmethod
    def run(self, steps: int) -> int:
        """Do `steps` macro steps or fewer; `plan.done` counts those done.

        The result is DONE, ROWS_FULL, FAULT, or STOPPED when a trigger has fired or `plan.stop` is set.
        """

    @abstractmethod
    def watch(self) -> int:
        """Read the watched internal variables into the values: DONE or FAULT."""


# ---------------------------------------------------------------- C
_Address, _Int, _Real = ctypes.c_void_p, ctypes.c_int64, ctypes.c_double


class _Slave(ctypes.Structure):
    _fields_ = [
        *((name, _Address) for name in ("handle", "set", "step", "get", "callback")),
        *((name, _Address) for name in ("input_references", "output_references", "watched_references")),
        *((name, _Address) for name in ("inputs", "outputs", "watched")),
        *((name, _Int) for name in ("input_count", "output_count", "watched_count")),
        *((name, _Int) for name in ("first_connection", "connection_count")),
        *((name, _Int) for name in ("first_change", "input_changes", "output_changes", "stopped")),
    ]


class _Connection(ctypes.Structure):
    _fields_ = [("source", _Int), ("target", _Int), ("gain", _Real), ("bias", _Real), ("adds", _Int)]


class _Bond(ctypes.Structure):
    _fields_ = [
        *((name, _Int) for name in ("effort_out", "flow_in", "effort_in", "flow_out", "account")),
        *((name, _Real) for name in ("effort_side", "flow_side")),
    ]


class _Recorder(ctypes.Structure):
    _fields_ = [
        *((name, _Int) for name in ("stride", "width", "capacity", "count", "watches")),
        *((name, _Address) for name in ("indices", "rows")),
    ]


class _Plan(ctypes.Structure):
    _fields_ = [
        *((n, _Int) for n in ("slave_count", "connection_count", "bond_count", "recorder_count")),
        *((n, _Int) for n in ("simultaneous", "start_ns", "step_ns")),
        *((n, _Address) for n in ("slaves", "connections", "bonds", "recorders", "values")),
        *((n, _Address) for n in ("changes", "triggers", "conditions")),
        *((n, _Int) for n in ("trigger_count", "trigger_watches")),
        *((n, _Address) for n in ("calls", "stop")),
        *((n, _Int) for n in ("done", "fault_slave", "fault_stage", "fault_status", "fault_variable")),
    ]


@functools.cache
def library() -> ctypes.CDLL:
    """The loop in C, compiled on first use; `CompileError` if there is no compiler."""
    loaded = ctypes.CDLL(str(build_library("master", source("master.c"))))
    loaded.seacrane_run.argtypes = [ctypes.c_void_p, ctypes.c_int64]
    loaded.seacrane_watch.argtypes = [ctypes.c_void_p]
    return loaded


class NativeLoop(Loop):
    """The loop in C. While it runs, other Python threads run too."""

    name = "c"

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._library = library()
        self.refresh()

    def refresh(self) -> None:
        plan, parts = self._plan, self._plan.parts
        callbacks, references = [], []
        slaves = (_Slave * len(parts))()
        connections = (_Connection * sum(part.sources.size for part in parts))()
        base, first = plan.values.ctypes.data, 0
        for slave, part in zip(slaves, parts, strict=True):
            slave.inputs, slave.input_count = base + 8 * part.inputs.start, part.inputs.stop - part.inputs.start
            slave.outputs, slave.output_count = base + 8 * part.outputs.start, part.outputs.stop - part.outputs.start
            slave.watched, slave.watched_count = base + 8 * part.room.start, len(part.watched)
            calls = part.instance.calls
            if calls is None:
                callbacks.append(_callback(part))
                slave.callback = ctypes.cast(callbacks[-1], _Address).value
            else:
                slave.handle, slave.set, slave.step, slave.get = calls.handle, calls.set, calls.step, calls.get
                arrays = _references(part)
                references.append(arrays)
                slave.input_references, slave.output_references, slave.watched_references = (
                    array.ctypes.data for array in arrays
                )
            slave.first_connection, slave.connection_count = first, part.sources.size
            for i in range(part.sources.size):
                connections[first + i] = _Connection(
                    part.sources[i], part.targets[i], part.gains[i], part.biases[i], part.adds[i]
                )
            first += part.sources.size
            slave.first_change, slave.stopped = part.changes.start, part.stopped
            slave.input_changes, slave.output_changes = part.input_changes, part.output_changes
        bonds = (_Bond * len(plan.bonds))(
            *(
                _Bond(b.effort_out, b.flow_in, b.effort_in, b.flow_out, b.account, b.effort_side, b.flow_side)
                for b in plan.bonds
            )
        )
        recorders = (_Recorder * len(plan.rows))(
            *(
                _Recorder(
                    r.stride, r.indices.size, len(r.table), 0, r.watches, r.indices.ctypes.data, r.table.ctypes.data
                )
                for r in plan.rows
            )
        )
        self._recorders = recorders
        self._native = _Plan(
            len(slaves), len(connections), len(bonds), len(recorders),
            plan.schedule.simultaneous, plan.start_ns, plan.schedule.step_ns,
            *(ctypes.addressof(array) for array in (slaves, connections, bonds, recorders)), base,
            *(array.ctypes.data for array in (plan.changes, plan.triggers, plan.conditions)),
            plan.triggers.size, plan.trigger_watches, plan.calls.ctypes.data, plan.stop.ctypes.data,
        )  # fmt: skip
        # C keeps addresses only: everything they point at lives as long as this loop.
        self._keep = (slaves, connections, bonds, callbacks, references, plan.changes, plan.triggers, plan.conditions)

    def run(self, steps: int) -> int:
        native, plan = self._native, self._plan
        native.done = plan.done
        for recorder, rows in zip(self._recorders, plan.rows, strict=True):
            recorder.count = rows.count
        result = int(self._library.seacrane_run(ctypes.addressof(native), steps))
        plan.done = native.done
        for recorder, rows in zip(self._recorders, plan.rows, strict=True):
            rows.count = recorder.count
        return self._result(result)

    def watch(self) -> int:
        return self._result(int(self._library.seacrane_watch(ctypes.addressof(self._native))))

    def _result(self, result: int) -> int:
        if result == FAULT:
            n = self._native
            self.fault = Fault(n.fault_slave, STAGES[n.fault_stage], n.fault_status, n.fault_variable)
        return result


def _references(part: Part) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    calls, interface = part.instance.calls, part.interface
    assert calls is not None
    names = ([v.name for v in interface.inputs], [v.name for v in interface.outputs], part.watched)
    inputs, outputs, watched = (np.array([calls.references[n] for n in group], dtype=np.uint32) for group in names)
    return inputs, outputs, watched


def _callback(part: Part) -> Any:
    advance = part.instance.advance
    return Callback(lambda _, time, step: advance(time, step))


# ---------------------------------------------------------------- Python
class PythonLoop(Loop):
    """The same loop in Python: for machines without a compiler, and to check the other one against."""

    name = "python"

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self.refresh()

    def refresh(self) -> None:
        self._slaves = [_PythonSlave(part, self._plan) for part in self._plan.parts]
        self._everything = Transfer(self._plan.values, self._plan.parts)

    def run(self, steps: int) -> int:
        plan, values = self._plan, self._plan.values
        step_ns, start_ns = plan.schedule.step_ns, plan.start_ns
        simultaneous, h = plan.schedule.simultaneous, step_ns / 1e9
        for _ in range(steps):
            t = (start_ns + plan.done * step_ns) / 1e9
            if any(rows.count == len(rows.table) for rows in plan.rows):
                return ROWS_FULL
            before = [(values.item(b.effort_out), values.item(b.flow_out)) for b in plan.bonds]
            if simultaneous:
                self._everything.transfer()
            for i, slave in enumerate(self._slaves):
                if not simultaneous:
                    slave.incoming.transfer()
                fault = self._advance(i, slave, t, h)
                if fault is not None:
                    return self._failed(fault)
            for bond, (effort, flow) in zip(plan.bonds, before, strict=True):
                balance(bond, values, effort, flow, h)
            plan.done += 1
            result = self._record((start_ns + plan.done * step_ns) / 1e9)
            if result == DONE and plan.triggers.size:
                result = self._look()
            if result == DONE and plan.stop[0]:
                result = STOPPED
            if result != DONE:
                return result
        return DONE

    def _advance(self, i: int, slave: _PythonSlave, t: float, h: float) -> Fault | None:
        part, plan = slave.part, self._plan
        if part.stopped:
            return None
        inputs = part.changes.start + part.input_changes
        plan.manipulate(part.changes.start, inputs, t)
        plan.calls[i] += 1
        stage, status = slave.advance(t, h)
        plan.calls[i] += 1
        if stage is not None:
            return Fault(i, stage, status, -1)
        if not all(map(math.isfinite, slave.outputs.tolist())):
            return Fault(i, "finite", 0, int(np.argmin(np.isfinite(slave.outputs))))
        plan.manipulate(inputs, part.changes.stop, t + h)
        return None

    def _look(self) -> int:
        if self._plan.trigger_watches:
            result = self.watch()
            if result != DONE:
                return result
        return STOPPED if self._plan.look() else DONE

    def watch(self) -> int:
        for i, slave in enumerate(self._slaves):
            status = slave.watch()
            if not 0 <= status <= 1:
                return self._failed(Fault(i, "watch", status, -1))
        return DONE

    def _record(self, t: float) -> int:
        watched = False
        for rows in self._plan.rows:
            if self._plan.done % rows.stride:
                continue
            if rows.watches and not watched:
                watched = True
                result = self.watch()
                if result != DONE:
                    return result
            append(rows, t, self._plan)
        return DONE

    def _failed(self, fault: Fault) -> int:
        self.fault = fault
        return FAULT


class _PythonSlave:
    """One slave's calls with their arguments made ready."""

    def __init__(self, part: Part, plan: Plan) -> None:
        self.part, self.incoming = part, Transfer(plan.values, [part])
        self.outputs = plan.values[part.outputs]
        self._calls = part.instance.calls
        if self._calls is not None:
            self._arrays = _references(part)
            handle, base = ctypes.c_void_p(self._calls.handle), plan.values.ctypes.data
            self._set, self._get = SetFunction(self._calls.set), GetFunction(self._calls.get)
            self._step = StepFunction(self._calls.step)
            self._handle = handle
            places = (part.inputs, part.outputs, part.room)
            self._put, self._take, self._look = (
                (handle, array.ctypes.data, array.size, base + 8 * place.start)
                for array, place in zip(self._arrays, places, strict=True)
            )

    def advance(self, t: float, h: float) -> tuple[str | None, int]:
        """The stage that failed, or None, and its status."""
        if self._calls is None:
            status = self.part.instance.advance(t, h)
            return (None if 0 <= status <= 1 else "step"), status
        if self._put[2] and not 0 <= (status := self._set(*self._put)) <= 1:
            return "set", status
        if not 0 <= (status := self._step(self._handle, t, h, 1)) <= 1:
            return "step", status
        if self._take[2] and not 0 <= (status := self._get(*self._take)) <= 1:
            return "get", status
        return None, 0

    def watch(self) -> int:
        if self._calls is None or not self._look[2]:
            return 0
        return int(self._get(*self._look))


def balance(bond: BondIndices, values: np.ndarray, effort_before: float, flow_before: float, h: float) -> None:
    """Account for the power at a bond over a macro step; see `seacrane.cosim.bonds`."""
    v, at = values.item, bond.account
    effort = 0.5 * (effort_before + v(bond.effort_out))
    flow = 0.5 * (flow_before + v(bond.flow_out))
    given = effort * v(bond.flow_in) * bond.effort_side
    taken = v(bond.effort_in) * flow * bond.flow_side
    residual = given - taken
    values[at : at + 9] = (
        effort_before,
        flow_before,
        given,
        taken,
        residual,
        v(at + 5) + given * h,
        v(at + 6) + residual * h,
        v(at + 7) + abs(given) * h,
        max(v(at + 8), abs(residual)),
    )


def append(rows: Rows, t: float, plan: Plan) -> None:
    """Write the next row of a recorder."""
    row = rows.table[rows.count]
    row[0] = t
    row[1:] = plan.values[rows.indices]
    rows.count += 1
