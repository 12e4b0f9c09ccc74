"""The master loop in Python: for machines without a compiler, and to check the other one against.

Functions have the names of those in `master.c` and `exchange.c`, and do the same operations in the same order.
"""

from __future__ import annotations

import ctypes
import math
from typing import Any

import numpy as np

from seacrane.cosim.algorithms import StepDoubling
from seacrane.cosim.loops import DONE, FAULT, ROWS_FULL, STOPPED, Failed, Fault, Loop, append
from seacrane.cosim.plan import GREATEST_POWER, LAST_ERROR, NEXT_STEP, SIGNALS, BondIndices, Part, Plan, Transfer
from seacrane.cosim.python_iteration import iterate
from seacrane.cosim.slave import DeriveFunction, DirectionalFunction, GetFunction, SetFunction, StepFunction, Vector
from seacrane.errors import SeacraneError

MACRO_STEP, ITERATIONS, REJECTED, COUPLING_ERROR = range(len(SIGNALS))

PROPORTIONAL, INTEGRAL = 0.4, 0.7
LEAST_CHANGE, MOST_CHANGE, LEAST_ERROR = 0.2, 2.0, 1e-4
"""Of the step size control; `master.c` says what they are."""

DISCARD, ERROR = 2, 3
"""FMI 2 status codes."""


class PythonLoop(Loop):
    """The same loop in Python."""

    name = "python"

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self.slaves = [PythonSlave(part, plan, i) for i, part in enumerate(plan.parts)]

    def refresh(self) -> None:
        for slave in self.slaves:
            slave.refresh()

    def close(self) -> None:
        """Nothing to free."""

    def run(self, steps: int) -> int:
        try:
            return self._run(steps)
        except Failed as failed:
            self.fault = failed.fault
            return FAULT

    def watch(self) -> int:
        for i, slave in enumerate(self.slaves):
            status = slave.watch()
            if bad(status):
                self.fault = Fault(i, "watch", status, -1)
                return FAULT
        return DONE

    def _run(self, steps: int) -> int:
        plan = self._plan
        for _ in range(steps):
            begin = plan.done * plan.schedule.step_ns
            if any(rows.count == len(rows.table) for rows in plan.rows):
                return ROWS_FULL
            if plan.schedule.control is None:
                self._macro_step(begin, plan.schedule.step_ns)
            else:
                self._controlled_step(begin)
            plan.done += 1
            result = self._record(plan.time_ns / 1e9)
            if result == DONE and plan.triggers.size:
                result = self._look()
            if result == DONE and plan.stop[0]:
                result = STOPPED
            if result != DONE:
                return result
        return DONE

    # ------------------------------------------------------------ a macro step
    def _macro_step(self, begin: int, size: int) -> None:
        plan, values = self._plan, self._plan.values
        before = [(values.item(b.effort_out), values.item(b.flow_out)) for b in plan.bonds]
        if plan.schedule.iteration is None:
            self.sweep(begin, size)
        else:
            plan.signals[ITERATIONS] = iterate(plan, self, begin, size)
        h = size / 1e9
        for bond, (effort, flow) in zip(plan.bonds, before, strict=True):
            self._balance(bond, effort, flow, h)
        plan.signals[MACRO_STEP] = h

    def sweep(self, begin: int, size: int, iterating: bool = False) -> None:
        plan = self._plan
        plan.sweeps += 1
        for group in plan.groups:
            members = [slave for i in group.tolist() if (slave := self.slaves[i]).active]
            if not plan.depth:
                for slave in members:
                    slave.transfer(begin + size - slave.part.every * size, begin + size)
            for slave in members:
                slave.step(begin, size)
            for slave in members:
                if iterating:
                    plan.samples[0, slave.part.outputs] = slave.outputs
                elif plan.depth:
                    slave.push(begin + size, slave.outputs)

    def save_all(self) -> list[Any]:
        states = []
        for i, slave in enumerate(self.slaves):
            try:
                states.append(slave.part.instance.save())
            except SeacraneError as error:
                slave.part.instance.failure = error
                raise Failed(Fault(i, "save", ERROR, -1)) from error
        return states

    def restore_all(self, states: list[Any]) -> None:
        for slave, state in zip(self.slaves, states, strict=True):
            slave.restore(state)

    # ------------------------------------------------------------ bonds
    def _stepped(self, slave: int, h: float) -> float:
        part = self._plan.parts[slave]
        if part.every == 1:
            return h
        return part.every * h if self.slaves[slave].active else 0.0

    def _owe(self, connection: tuple[PythonSlave, int], mean: float, h: float) -> None:
        slave, i = connection
        owed, gain, bias, target = slave.owed[i], slave.gains[i], slave.biases[i], slave.targets[i]
        if owed >= 0 and h != 0:
            values = self._plan.values
            due = mean * gain + bias
            values[owed] += (due - values.item(target)) * h

    def _balance(self, bond: BondIndices, effort_before: float, flow_before: float, h: float) -> None:
        values = self._plan.values
        v, at = values.item, bond.account
        effort = 0.5 * (effort_before + v(bond.effort_out))
        flow = 0.5 * (flow_before + v(bond.flow_out))
        given = effort * v(bond.flow_in) * bond.effort_side
        taken = v(bond.effort_in) * flow * bond.flow_side
        residual = given - taken
        giving, taking = self._stepped(bond.effort_slave, h), self._stepped(bond.flow_slave, h)
        lost = residual * giving if giving == taking else given * giving - taken * taking
        values[at : at + 9] = (
            effort_before,
            flow_before,
            given,
            taken,
            residual,
            v(at + 5) + given * giving,
            v(at + 6) + lost,
            v(at + 7) + abs(given) * giving,
            max(v(at + 8), abs(residual)),
        )
        self._owe(self._connection(bond.effort_connection), effort, taking)
        self._owe(self._connection(bond.flow_connection), flow, giving)

    def _connection(self, number: int) -> tuple[PythonSlave, int]:
        for slave in self.slaves:
            if number < len(slave.sources):
                return slave, number
            number -= len(slave.sources)
        raise IndexError(number)

    # ------------------------------------------------------------ the step size
    def _power_error(self, h: float) -> float:
        plan, control = self._plan, self._plan.schedule.control
        assert control is not None
        whole, worst = plan.schedule.step_ns / 1e9, 0.0
        for i, bond in enumerate(plan.bonds):
            given, taken, residual = (abs(plan.values.item(bond.account + k)) for k in (2, 3, 4))
            greatest = max(plan.controller.item(GREATEST_POWER + i), given, taken)
            plan.controller[GREATEST_POWER + i] = greatest
            usual = getattr(control.control, "power", None) or greatest
            if usual != 0:
                worst = max(worst, residual * h / (usual * whole * control.control.tolerance))
        return worst

    def _doubling_error(self, coarse: Vector) -> float:
        plan, control = self._plan, self._plan.schedule.control
        assert control is not None
        worst = 0.0
        outputs = plan.values[: plan.nominal.size].tolist()
        for value, other, nominal in zip(outputs, coarse.tolist(), plan.nominal.tolist(), strict=True):
            size = max(abs(value), nominal)
            worst = max(worst, abs(value - other) / (control.control.tolerance * size))
        return worst / ((1 << plan.order) - 1)

    def _choose(self, size: int, error: float, rejected: bool) -> None:
        plan, control, kept = self._plan, self._plan.schedule.control, self._plan.controller
        assert control is not None
        wanted, exponent = kept.item(NEXT_STEP), 1 / (plan.order + 1)
        error = max(error, LEAST_ERROR)
        change = control.safety * math.pow(error, -INTEGRAL * exponent)
        change = change * math.pow(kept.item(LAST_ERROR), PROPORTIONAL * exponent)
        if rejected:
            change = control.safety * math.pow(error, -exponent)
        following = size * min(max(change, LEAST_CHANGE), MOST_CHANGE)
        if not rejected and error <= 1 and following < wanted:
            following = wanted
        if rejected and following > 0.9 * size:
            following = 0.9 * size
        following = min(max(following, control.smallest_ns), plan.schedule.step_ns)
        kept[NEXT_STEP] = math.floor(following)
        if not rejected:
            kept[LAST_ERROR] = error

    def _doubled_step(self, begin: int, size: int) -> int:
        """The step that was taken [ns]."""
        plan, control, values = self._plan, self._plan.schedule.control, self._plan.values
        assert control is not None
        states, backup = self.save_all(), values.copy()
        while True:
            half, error, fault = size // 2, 1 / (LEAST_CHANGE * LEAST_CHANGE), None
            try:
                self._macro_step(begin, size)
                coarse = values[: plan.nominal.size].copy()
                values[:] = backup
                self.restore_all(states)
                self._macro_step(begin, half)
                self._macro_step(begin + half, size - half)
            except Failed as failed:
                fault = failed.fault
                again = fault.stage == "converge" or (fault.stage == "step" and fault.status == DISCARD)
                if not again or size <= control.smallest_ns:
                    raise
            if fault is None:
                error = self._doubling_error(coarse)
                if error <= 1 or size <= control.smallest_ns:
                    plan.signals[COUPLING_ERROR] = error * control.control.tolerance
                    self._choose(size, error, False)
                    return size
            rejected = backup[plan.index["rejected"]] + 1
            values[:] = backup
            plan.signals[REJECTED] = rejected
            self.restore_all(states)
            self._choose(size, error, True)
            size = int(plan.controller[NEXT_STEP])
            backup = values.copy()

    def _controlled_step(self, begin: int) -> None:
        plan, control = self._plan, self._plan.schedule.control
        assert control is not None
        done, whole = 0, plan.schedule.step_ns
        while done < whole:
            rest, wanted = whole - done, int(plan.controller[NEXT_STEP])
            size = rest if wanted >= rest else rest - rest // 2 if 2 * wanted > rest else wanted
            if isinstance(control.control, StepDoubling):
                size = self._doubled_step(begin + done, size)
            else:
                self._macro_step(begin + done, size)
                error = self._power_error(size / 1e9)
                plan.signals[COUPLING_ERROR] = error * control.control.tolerance
                self._choose(size, error, False)
            done += size

    # ------------------------------------------------------------ recorders and triggers
    def _look(self) -> int:
        if self._plan.trigger_watches:
            result = self.watch()
            if result != DONE:
                return result
        return STOPPED if self._plan.look() else DONE

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


class PythonSlave:
    """One slave's exchange, with the arguments of its calls made ready."""

    def __init__(self, part: Part, plan: Plan, number: int) -> None:
        self.part, self._plan, self._number = part, plan, number
        self.outputs = plan.values[part.outputs]
        self._held = Transfer(plan.values, [part])
        columns = (part.sources, part.targets, part.origins, part.owed, part.gains, part.biases, part.adds)
        self.sources, self.targets, self.origins, self.owed, self.gains, self.biases, self.adds = (
            column.tolist() for column in columns
        )
        calls = self._calls = part.instance.calls
        interface, inputs = part.interface, plan.values[part.inputs]
        self.derives = calls is not None and bool(calls.derive) and plan.schedule.degree > 0
        self._begins, self._slopes = (np.zeros(inputs.size) for _ in range(2))
        self._driven = part.driven
        self.tells = calls is not None and bool(calls.directional) and plan.newton
        if calls is not None:
            handle = self._handle = ctypes.c_void_p(calls.handle)
            self._set, self._get, self._step = SetFunction(calls.set), GetFunction(calls.get), StepFunction(calls.step)
            places, driven = [v.name for v in interface.inputs], [interface.inputs[i].name for i in self._driven]
            given, taken, derived = (
                self._references(names) for names in (places, [v.name for v in interface.outputs], driven)
            )
            start = self._begins if self.derives else inputs
            self._put = handle, given.ctypes.data, given.size, start.ctypes.data
            self._take = handle, taken.ctypes.data, taken.size, self.outputs.ctypes.data
            ones, self._rates = np.ones(derived.size, dtype=np.int32), np.zeros(derived.size)
            if self.derives:
                self._derive = DeriveFunction(calls.derive)
            self._change = handle, derived.ctypes.data, derived.size, ones.ctypes.data, self._rates.ctypes.data
            self._kept = given, taken, derived, ones
            if self.tells:
                self._directional = DirectionalFunction(calls.directional)
        self.refresh()

    def refresh(self) -> None:
        if self._calls is not None:
            watched = self._watched = self._references(self.part.watched)
            room = self._plan.values[self.part.room]
            self._look = self._handle, watched.ctypes.data, watched.size, room.ctypes.data

    def _references(self, names: list[str]) -> np.ndarray:
        assert self._calls is not None
        return np.array([self._calls.references[name] for name in names], dtype=np.uint32)

    @property
    def active(self) -> bool:
        part = self.part
        return not part.stopped and (part.every == 1 or (self._plan.done + 1) % part.every == 0)

    # ------------------------------------------------------------ inputs
    def weigh(self, origin: int, a: float, b: float) -> tuple[list[float], ...]:
        """Weights of the samples for mean, begin, slope and end; see `exchange.c`."""
        times = self._plan.times[origin].tolist()
        count = max(1, int(times[-1]))
        tau = [(time - a) / (b - a) for time in times[:count]]
        if count == 1:
            return [1.0], [1.0], [0.0], [1.0]
        if count == 2:
            d = tau[0] - tau[1]
            old = (tau[0] - 0.5) / d, tau[0] / d, -1 / d, (tau[0] - 1) / d
            return [1 - old[0], old[0]], [1 - old[1], old[1]], [1 / d, old[2]], [1 - old[3], old[3]]
        rows = []
        for i in range(3):
            j, k = tau[(i + 1) % 3], tau[(i + 2) % 3]
            c2 = 1 / ((tau[i] - j) * (tau[i] - k))
            c1, c0 = -(j + k) * c2, j * k * c2
            rows.append((c0 + c1 / 2 + c2 / 3, c0 - c2 / 6, c1 + c2, c0 + c1 + c2))
        return tuple([row[i] for row in rows] for i in range(4))

    def _weighed(self, weights: list[float], place: int) -> float:
        samples = self._plan.samples
        total = weights[0] * samples.item(0, place)
        for i in range(1, len(weights)):
            total += weights[i] * samples.item(i, place)
        return total

    def transfer(self, begin: int, end: int) -> None:
        values, depth = self._plan.values, self._plan.depth
        if not depth and not self._plan.schedule.conserve:
            self._held.transfer()
            return
        seconds = (end - begin) / 1e9
        for source, target, origin, owed, gain, bias, adds in zip(
            self.sources, self.targets, self.origins, self.owed, self.gains, self.biases, self.adds, strict=True
        ):
            mean, more = values.item(source), 0.0
            if depth:
                weights = self.weigh(origin, begin, end)
                mean = self._weighed(weights[0], source)
            value = mean * gain + (values.item(target) if adds else bias)
            if owed >= 0:
                more = values.item(owed) / seconds
                value = value + more
            values[target] = value
            if self.derives:
                place = target - self.part.inputs.start
                begun = self._weighed(weights[1], source) * gain
                rate = self._weighed(weights[2], source) * gain / seconds
                begun = begun + (self._begins.item(place) if adds else bias)
                self._begins[place] = begun + more
                self._slopes[place] = self._slopes.item(place) + rate if adds else rate

    def _manipulate(self, first: int, end: int, t: float) -> None:
        plan, part = self._plan, self.part
        for i in range(first, end):
            c = plan.changes[i]
            target = int(c["target"])
            if not c["fixed"]:
                c["raw"] = plan.values[target]
            plan.values[target] = plan.changed(c, t)
            place = target - part.inputs.start
            if self.derives and 0 <= place < self._begins.size:
                self._begins[place] = plan.changed(c, t, None if c["fixed"] else self._begins.item(place))
                self._slopes[place] = float(c["gain"]) * self._slopes.item(place)

    # ------------------------------------------------------------ the step
    def step(self, begin: int, size: int) -> None:
        plan, part = self._plan, self.part
        plan.calls[self._number] += 1
        try:
            self._exchange(begin, size)
        finally:
            plan.calls[self._number] += 1
        t, h = (plan.start_ns + begin) / 1e9, size / 1e9
        self._manipulate(part.changes.start + part.input_changes, part.changes.stop, t + h)

    def _exchange(self, begin: int, size: int) -> None:
        plan, part = self._plan, self.part
        window = part.every * size
        first = begin + size - window
        changes = part.changes.start, part.changes.start + part.input_changes
        for k in range(part.substeps):
            a, b = first + window * k // part.substeps, first + window * (k + 1) // part.substeps
            t = (plan.start_ns + a) / 1e9
            if self.derives:
                self._begins[:] = plan.values[part.inputs]
            if plan.depth:
                self.transfer(a, b)
            if plan.depth or k == 0:
                self._manipulate(*changes, t)
            self._call(t, (b - a) / 1e9)
        if plan.depth and part.substeps > 1:
            self.transfer(first, first + window)
            self._manipulate(*changes, (plan.start_ns + first) / 1e9)
        if self._calls is not None and self._take[2] and bad(status := self._get(*self._take)):
            raise self._failed("get", status)
        if not all(map(math.isfinite, self.outputs.tolist())):
            raise self._failed("finite", 0, int(np.argmin(np.isfinite(self.outputs))))

    def _call(self, t: float, h: float) -> None:
        if self._calls is None:
            if bad(status := self.part.instance.advance(t, h)):
                raise self._failed("step", status)
            return
        if self._put[2] and bad(status := self._set(*self._put)):
            raise self._failed("set", status)
        if self.derives and self._driven.size:
            self._rates[:] = self._slopes[self._driven]
            if bad(status := self._derive(*self._change)):
                raise self._failed("set", status)
        if bad(status := self._step(self._handle, t, h, 1)):
            raise self._failed("step", status)

    def _failed(self, stage: str, status: int, variable: int = -1) -> Failed:
        return Failed(Fault(self._number, stage, status, variable))

    def directional(self, place: int) -> Vector:
        """The derivatives of the outputs with respect to the input at this place, as the slave tells them."""
        outputs, inputs = self._kept[1], self._kept[0]
        known, seed, column = inputs[place : place + 1].copy(), np.ones(1), np.empty(self.outputs.size)
        arguments = (outputs.ctypes.data, outputs.size, known.ctypes.data, 1, seed.ctypes.data, column.ctypes.data)
        if bad(status := self._directional(self._handle, *arguments)):
            raise self._failed("derive", status)
        return column

    def watch(self) -> int:
        if self._calls is None or not self._look[2]:
            return 0
        return int(self._get(*self._look))

    # ------------------------------------------------------------ history
    def predict(self, begin: int, size: int) -> list[float]:
        weights = self.weigh(self._number, begin, begin + size)[3]
        return [self._weighed(weights, place) for place in range(self.part.outputs.start, self.part.outputs.stop)]

    def push(self, time: int, outputs: Any) -> None:
        samples, times, depth = self._plan.samples, self._plan.times[self._number], self._plan.depth
        place = self.part.outputs
        for i in range(depth - 1, 0, -1):
            samples[i, place] = samples[i - 1, place]
            times[i] = times[i - 1]
        samples[0, place] = outputs
        times[0] = time
        if times[depth] < depth:
            times[depth] += 1

    def restore(self, state: bytes) -> None:
        try:
            self.part.instance.restore(state)
        except SeacraneError as error:
            self.part.instance.failure = error
            raise self._failed("restore", ERROR) from error


def bad(status: int) -> bool:
    """Whether an FMI 2 status ends the run: all but OK and a warning."""
    return not 0 <= status <= 1
