"""One slave in the loop in Python: its inputs, extrapolated where that is wanted, its step, and its history.

Methods have the names of the functions in `exchange.c`, and do the same operations in the same order.
"""

from __future__ import annotations

import ctypes
import math
from typing import Any

import numpy as np

from seacrane.cosim.loops import Failed, Fault
from seacrane.cosim.plan import Part, Plan, Transfer
from seacrane.cosim.slave import (
    DeriveFunction,
    DirectionalFunction,
    GetFunction,
    SetFunction,
    StepFunction,
    Vector,
)
from seacrane.errors import SeacraneError

ERROR = 3
"""FMI 2 status code."""


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
