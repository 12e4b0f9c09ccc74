"""The master loop in Python: for machines without a compiler, and to check the other one against.

Functions have the names of those in `master.c`, and do the same operations in the same order.
"""

from __future__ import annotations

import math
from typing import Any

from seacrane.cosim.algorithms import StepDoubling
from seacrane.cosim.loops import DONE, FAULT, ROWS_FULL, STOPPED, Failed, Fault, Loop, append
from seacrane.cosim.plan import GREATEST_POWER, LAST_ERROR, NEXT_STEP, SIGNALS, BondIndices, Plan
from seacrane.cosim.python_iteration import iterate
from seacrane.cosim.python_slave import ERROR, PythonSlave, bad
from seacrane.cosim.slave import Vector
from seacrane.errors import SeacraneError

MACRO_STEP, ITERATIONS, REJECTED, COUPLING_ERROR = range(len(SIGNALS))

PROPORTIONAL, INTEGRAL = 0.4, 0.7
LEAST_CHANGE, MOST_CHANGE, LEAST_ERROR = 0.2, 2.0, 1e-4
MUCH = 25.0
"""Of the step size control; `master.c` says what they are."""

DISCARD = 2
"""FMI 2 status code."""

Kept = tuple[Vector, list[Any]]
"""Values, and a state of each slave."""


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

    def _keep(self) -> Kept:
        """What a step can be done again from."""
        return self._plan.values.copy(), self.save_all()

    def _go_back(self, kept: Kept) -> None:
        self._plan.values[:] = kept[0]
        self.restore_all(kept[1])

    def _may_be_mended(self, fault: Fault, size: int) -> bool:
        control = self._plan.schedule.control
        assert control is not None
        discarded = fault.stage == "step" and fault.status == DISCARD
        return (fault.stage == "converge" or discarded) and size > control.smallest_ns

    def _reject(self, kept: Kept, size: int, error: float) -> int:
        """Back to where the step began; the smaller size to do it with [ns]."""
        plan = self._plan
        self._go_back(kept)
        plan.signals[REJECTED] += 1
        self._choose(size, error, True)
        kept[0][:] = plan.values
        return int(plan.controller[NEXT_STEP])

    def _doubled_step(self, begin: int, size: int) -> int:
        """The step that was taken [ns]."""
        plan, control = self._plan, self._plan.schedule.control
        assert control is not None
        kept = self._keep()
        while True:
            half, error = size // 2, MUCH
            try:
                self._macro_step(begin, size)
                coarse = plan.values[: plan.nominal.size].copy()
                self._go_back(kept)
                self._macro_step(begin, half)
                self._macro_step(begin + half, size - half)
            except Failed as failed:
                if not self._may_be_mended(failed.fault, size):
                    raise
            else:
                error = self._doubling_error(coarse)
                if error <= 1 or size <= control.smallest_ns:
                    plan.signals[COUPLING_ERROR] = error * control.control.tolerance
                    self._choose(size, error, False)
                    return size
            size = self._reject(kept, size, error)

    def _followed_step(self, begin: int, size: int) -> int:
        """The step that was taken [ns]."""
        plan, control = self._plan, self._plan.schedule.control
        assert control is not None
        kept = self._keep() if plan.repeats else None
        while True:
            try:
                self._macro_step(begin, size)
            except Failed as failed:
                if kept is None or not self._may_be_mended(failed.fault, size):
                    raise
                size = self._reject(kept, size, MUCH)
            else:
                error = self._power_error(size / 1e9)
                plan.signals[COUPLING_ERROR] = error * control.control.tolerance
                self._choose(size, error, False)
                return size

    def _controlled_step(self, begin: int) -> None:
        plan, control = self._plan, self._plan.schedule.control
        assert control is not None
        step = self._doubled_step if isinstance(control.control, StepDoubling) else self._followed_step
        done, whole = 0, plan.schedule.step_ns
        while done < whole:
            rest, wanted = whole - done, int(plan.controller[NEXT_STEP])
            size = rest if wanted >= rest else rest - rest // 2 if 2 * wanted > rest else wanted
            done += step(begin + done, size)

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
