"""The master loop in C."""

from __future__ import annotations

import ctypes
import functools
from typing import Any

import numpy as np

from seacrane.cosim.algorithms import FixedPoint, PowerResidual
from seacrane.cosim.loops import FAULT, STAGES, Fault, Loop
from seacrane.cosim.plan import Part, Plan
from seacrane.cosim.slave import Callback, RestoreFunction, SaveFunction
from seacrane.native import build_library, source

_Address, _Int, _Real = ctypes.c_void_p, ctypes.c_int64, ctypes.c_double
_TRIALS = 2 * 7
_ERROR = 3


def _fields(*groups: tuple[Any, str]) -> list[tuple[str, Any]]:
    return [(name, kind) for kind, names in groups for name in names.split()]


class _Slave(ctypes.Structure):
    _fields_ = _fields(
        (_Address, "handle set step get derive directional save release restore callback"),
        (_Address, "input_references output_references watched_references derived_references orders"),
        (_Address, "inputs outputs watched begins slopes derived_slopes times"),
        (_Int, "first_input first_output input_count output_count watched_count derived_count"),
        (_Address, "derived"),
        (_Int, "first_connection connection_count first_change input_changes output_changes stopped substeps every"),
        (_Address, "saved_step saved_macro"),
        (_Int, "fault_stage fault_status fault_variable"),
    )


class _Connection(ctypes.Structure):
    _fields_ = _fields((_Int, "source target origin owed"), (_Real, "gain bias"), (_Int, "adds"))


class _Bond(ctypes.Structure):
    _fields_ = _fields(
        (_Int, "effort_out flow_in effort_in flow_out account"),
        (_Int, "effort_slave flow_slave effort_connection flow_connection"),
        (_Real, "effort_side flow_side"),
    )


class _Recorder(ctypes.Structure):
    _fields_ = _fields((_Int, "stride width capacity count watches"), (_Address, "indices rows"))


class _Group(ctypes.Structure):
    _fields_ = [
        *_fields(
            (_Address, "members"),
            (_Int, "count natives phase parallel threaded left block taken block_ns waited_ns lost_ns serial_ns"),
        ),
        ("trial_ns", _Int * _TRIALS),
    ]


class _Plan(ctypes.Structure):
    _fields_ = _fields(
        (_Int, "slave_count connection_count bond_count recorder_count group_count start_ns step_ns"),
        (_Address, "slaves connections bonds recorders groups values"),
        (_Address, "changes triggers conditions"),
        (_Int, "trigger_count trigger_watches"),
        (_Address, "calls stop"),
        (_Int, "value_count output_count depth order"),
        (_Address, "samples signals"),
        (_Int, "iteration aitken most tells coupled_count"),
        (_Real, "relaxation tolerance"),
        (_Address, "coupled coupled_slave nominal jacobian guess residual before scale base matrix column"),
        (_Int, "control repeats smallest_ns"),
        (_Real, "control_tolerance safety power"),
        (_Address, "controller backup coarse"),
        (_Int, "threads"),
        (_Address, "pool"),
        (_Int, "done sweeps fault_slave fault_stage fault_status fault_variable"),
    )


@functools.cache
def library() -> ctypes.CDLL:
    """The loop in C, compiled on first use; `CompileError` if there is no compiler."""
    sources = source("master.h", "master.c", "exchange.c", "iterate.c", "pool.c")
    loaded = ctypes.CDLL(str(build_library("master", sources, ["-pthread"])))
    loaded.seacrane_run.argtypes = [ctypes.c_void_p, ctypes.c_int64]
    loaded.seacrane_watch.argtypes = [ctypes.c_void_p]
    loaded.seacrane_end.argtypes = [ctypes.c_void_p]
    loaded.seacrane_end.restype = None
    return loaded


class NativeLoop(Loop):
    """The loop in C. While it runs, other Python threads run too.

    Slaves that may step side by side do so on up to `threads` threads where that is measured to be faster.
    """

    name = "c"

    def __init__(self, plan: Plan, threads: int) -> None:
        self._plan = plan
        self._library = library()
        self._native = _Plan(threads=threads)
        self._keep: list[Any] = []
        self._slaves = (_Slave * len(plan.parts))()
        self._groups = (_Group * len(plan.groups))()
        for group, members in zip(self._groups, plan.groups, strict=True):
            group.members, group.count = members.ctypes.data, members.size
            group.natives = sum(plan.parts[i].instance.calls is not None for i in members)
        self._lay_out_slaves()
        self._lay_out_algorithm()
        self.refresh()

    def refresh(self) -> None:
        plan, native = self._plan, self._native
        self._references = []
        for slave, part in zip(self._slaves, plan.parts, strict=True):
            slave.first_change, slave.stopped = part.changes.start, part.stopped
            slave.input_changes, slave.output_changes = part.input_changes, part.output_changes
            calls = part.instance.calls
            if calls is not None and part.watched:
                watched = _references(part, part.watched)
                self._references.append(watched)
                slave.watched, slave.watched_count = plan.values.ctypes.data + 8 * part.room.start, watched.size
                slave.watched_references = watched.ctypes.data
        self._recorders = (_Recorder * len(plan.rows))(
            *(
                _Recorder(
                    r.stride, r.indices.size, len(r.table), 0, r.watches, r.indices.ctypes.data, r.table.ctypes.data
                )
                for r in plan.rows
            )
        )
        native.recorder_count, native.recorders = len(self._recorders), ctypes.addressof(self._recorders)
        self._arrays = plan.changes, plan.triggers, plan.conditions
        native.changes, native.triggers, native.conditions = (array.ctypes.data for array in self._arrays)
        native.trigger_count, native.trigger_watches = plan.triggers.size, plan.trigger_watches
        native.repeats = plan.repeats

    def run(self, steps: int) -> int:
        native, plan = self._native, self._plan
        native.done = plan.done
        for recorder, rows in zip(self._recorders, plan.rows, strict=True):
            recorder.count = rows.count
        result = int(self._library.seacrane_run(ctypes.addressof(native), steps))
        plan.done, plan.sweeps = native.done, native.sweeps
        for recorder, rows in zip(self._recorders, plan.rows, strict=True):
            rows.count = recorder.count
        return self._result(result)

    def watch(self) -> int:
        return self._result(int(self._library.seacrane_watch(ctypes.addressof(self._native))))

    def close(self) -> None:
        self._library.seacrane_end(ctypes.addressof(self._native))

    def _result(self, result: int) -> int:
        if result == FAULT:
            n, stage = self._native, STAGES[self._native.fault_stage]
            unsettled = self._plan.unsettled(self._guess) if stage == "converge" else ()
            self.fault = Fault(n.fault_slave, stage, n.fault_status, n.fault_variable, unsettled)
        return result

    # C keeps addresses only: everything they point at lives as long as this loop.
    def _address(self, array: np.ndarray) -> int:
        self._keep.append(array)
        return int(array.ctypes.data)

    def _lay_out_slaves(self) -> None:
        plan, parts = self._plan, self._plan.parts
        connections = (_Connection * sum(part.sources.size for part in parts))()
        base, first = plan.values.ctypes.data, 0
        for i, (slave, part) in enumerate(zip(self._slaves, parts, strict=True)):
            slave.first_input, slave.input_count = part.inputs.start, part.inputs.stop - part.inputs.start
            slave.first_output, slave.output_count = part.outputs.start, part.outputs.stop - part.outputs.start
            slave.inputs, slave.outputs = base + 8 * slave.first_input, base + 8 * slave.first_output
            slave.times = plan.times[i].ctypes.data
            slave.substeps, slave.every = part.substeps, part.every
            slave.first_connection, slave.connection_count = first, part.sources.size
            columns = (part.sources, part.targets, part.origins, part.owed, part.gains, part.biases, part.adds)
            for row in zip(*(column.tolist() for column in columns), strict=True):
                connections[first] = _Connection(*row)
                first += 1
            self._lay_out_calls(slave, part)
        bonds = (_Bond * len(plan.bonds))(
            *(
                _Bond(
                    b.effort_out, b.flow_in, b.effort_in, b.flow_out, b.account,
                    b.effort_slave, b.flow_slave, b.effort_connection, b.flow_connection, b.effort_side, b.flow_side,
                )
                for b in plan.bonds
            )
        )  # fmt: skip
        native = self._native
        for name, array in (
            ("slave", self._slaves),
            ("connection", connections),
            ("bond", bonds),
            ("group", self._groups),
        ):
            setattr(native, f"{name}_count", len(array))
            setattr(native, f"{name}s", ctypes.addressof(array))
        self._keep += [connections, bonds]

    def _lay_out_calls(self, slave: _Slave, part: Part) -> None:
        instance, calls = part.instance, part.instance.calls
        interface, address = part.interface, self._address
        if calls is None:
            advance = instance.advance
            callback = Callback(lambda _, time, step: advance(time, step))
            self._keep.append(callback)
            slave.callback = ctypes.cast(callback, _Address).value
        else:
            slave.handle, slave.set, slave.step, slave.get = calls.handle, calls.set, calls.step, calls.get
            slave.input_references = address(_references(part, [v.name for v in interface.inputs]))
            slave.output_references = address(_references(part, [v.name for v in interface.outputs]))
            if calls.derive and self._plan.schedule.degree:
                driven = part.driven
                slave.derive, slave.derived_count = calls.derive, driven.size
                slave.derived = address(driven)
                slave.derived_references = address(_references(part, [interface.inputs[i].name for i in driven]))
                slave.orders = address(np.ones(driven.size, dtype=np.int32))
                slave.begins, slave.slopes = (address(np.zeros(len(interface.inputs))) for _ in range(2))
                slave.derived_slopes = address(np.zeros(driven.size))
        if calls is not None and calls.directional and self._plan.newton:
            slave.directional = calls.directional
        if calls is not None and calls.save:
            slave.save, slave.restore, slave.release = calls.save, calls.restore, calls.release
        else:
            functions = _SavedStates(part)
            self._keep.append(functions)
            slave.save, slave.restore = (ctypes.cast(f, _Address).value for f in (functions.save, functions.restore))

    def _lay_out_algorithm(self) -> None:
        plan, native, schedule = self._plan, self._native, self._plan.schedule
        address, count = self._address, plan.coupled.size
        native.start_ns, native.step_ns = plan.start_ns, schedule.step_ns
        native.calls, native.stop = plan.calls.ctypes.data, plan.stop.ctypes.data
        native.values, native.value_count = plan.values.ctypes.data, plan.values.size
        native.output_count, native.depth, native.order = plan.nominal.size, plan.depth, plan.order
        native.samples, native.signals = plan.samples.ctypes.data, plan.signals.ctypes.data
        native.nominal = address(plan.nominal)
        if (iteration := schedule.iteration) is not None:
            solver = iteration.solver
            native.iteration = 1 if isinstance(solver, FixedPoint) else 2
            if isinstance(solver, FixedPoint):
                native.relaxation, native.aitken = solver.relaxation, solver.aitken
            else:
                native.matrix = address(np.zeros(count * count))
                native.column = address(np.zeros(plan.nominal.size))
                native.tells = any(slave.directional for slave in self._slaves)
            native.most, native.tolerance = iteration.most, iteration.tolerance
            native.coupled, native.coupled_count = address(plan.coupled), count
            native.coupled_slave, native.jacobian = address(plan.coupled_slave), plan.jacobian.ctypes.data
            self._guess = np.zeros(count)
            native.guess = address(self._guess)
            native.residual, native.before, native.scale = (address(np.zeros(count)) for _ in range(3))
            native.base = address(np.zeros(plan.nominal.size))
        if (control := schedule.control) is not None:
            rule = control.control
            native.control = 1 if isinstance(rule, PowerResidual) else 2
            native.power = (rule.power or 0.0) if isinstance(rule, PowerResidual) else 0.0
            native.smallest_ns, native.safety = control.smallest_ns, control.safety
            native.control_tolerance = rule.tolerance
            native.controller = plan.controller.ctypes.data
            native.backup, native.coarse = address(np.zeros(plan.values.size)), address(np.zeros(plan.nominal.size))


class _SavedStates:
    """The states of an instance that has no C functions for them, by number."""

    def __init__(self, part: Part) -> None:
        instance = part.instance
        states: dict[int, bytes] = {}

        def save(_: int, place: Any) -> int:
            number = place[0] or len(states) + 1
            try:
                states[number] = instance.save()
            except BaseException as error:  # it cannot pass through C; the run ends with it
                instance.failure = error
                return _ERROR
            place[0] = number
            return 0

        def restore(_: int, number: int) -> int:
            try:
                instance.restore(states[number])
            except BaseException as error:  # it cannot pass through C; the run ends with it
                instance.failure = error
                return _ERROR
            return 0

        self.save, self.restore = SaveFunction(save), RestoreFunction(restore)


def _references(part: Part, names: list[str]) -> np.ndarray:
    calls = part.instance.calls
    assert calls is not None
    return np.array([calls.references[name] for name in names], dtype=np.uint32)
