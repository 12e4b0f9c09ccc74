"""A macro step repeated until the outputs that it was done with are those that it gives.

Functions have the names of those in `iterate.c`, and do the same operations in the same order.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from seacrane.cosim.algorithms import FixedPoint, Iterative
from seacrane.cosim.loops import Failed, Fault
from seacrane.cosim.plan import FOR_STEP, JACOBIAN, WHENCE, Plan

if TYPE_CHECKING:
    from seacrane.cosim.python_loop import PythonLoop

NOWHERE, TOLD, DIFFERENCES = range(3)
LEAST_FACTOR, MOST_FACTOR = 0.1, 1.0
SLOW, DIFFERENCE = 0.25, 1e-4
"""`iterate.c` says what they are."""


class _Iteration:
    """The guess, and what it differs by from the outputs that it leads to."""

    def __init__(self, plan: Plan, loop: PythonLoop, iteration: Iterative, begin: int, size: int) -> None:
        self.plan, self.loop, self.iteration, self.begin, self.size = plan, loop, iteration, begin, size
        self.coupled = plan.coupled.tolist()
        self.nominal = plan.nominal[plan.coupled].tolist()
        self.guess: list[float] = plan.samples[0, plan.coupled].tolist()
        self.residual = [0.0] * len(self.coupled)

    def magnitudes(self) -> list[float]:
        values = self.plan.values[self.plan.coupled].tolist()
        return [max(abs(v), n) for v, n in zip(values, self.nominal, strict=True)]

    def compare(self) -> float:
        worst, tolerance = 0.0, self.iteration.tolerance
        values = self.plan.values[self.plan.coupled].tolist()
        self.residual = [v - g for v, g in zip(values, self.guess, strict=True)]
        for residual, size in zip(self.residual, self.magnitudes(), strict=True):
            error = abs(residual) / (tolerance * size)
            if error > worst:
                worst = error
        return worst

    def put(self) -> None:
        self.plan.samples[0, self.plan.coupled] = self.guess

    def ask(self, number: int) -> None:
        plan, slave, n = self.plan, self.loop.slaves[number], len(self.coupled)
        matrix = plan.jacobian[JACOBIAN:].reshape(n, n)
        owners = plan.coupled_slave.tolist()
        for source, target, origin, gain in zip(slave.sources, slave.targets, slave.origins, slave.gains, strict=True):
            j = self.coupled.index(source)
            if not self.loop.slaves[owners[j]].active:
                continue
            mean, _, _, end = slave.weigh(origin, self.begin, self.begin + self.size)
            share = (end[0] if slave.derives else mean[0]) * gain
            column = slave.directional(target - slave.part.inputs.start)
            for r, row in enumerate(self.coupled):
                if owners[r] == number:
                    matrix[r, j] += column.item(row - slave.part.outputs.start) * share

    def differentiate(self, states: list[Any], told: bool) -> None:
        plan, n = self.plan, len(self.coupled)
        count = plan.nominal.size
        base = plan.values[:count].copy()
        matrix = plan.jacobian[JACOBIAN:].reshape(n, n)
        matrix[:] = 0
        for i, slave in enumerate(self.loop.slaves):
            if told and slave.tells and slave.active:
                self.ask(i)
        owners = plan.coupled_slave.tolist()
        for j, k in enumerate(self.coupled):
            if not self.loop.slaves[owners[j]].active:
                continue
            changed = self.guess[j] + DIFFERENCE * max(abs(self.guess[j]), self.nominal[j])
            delta = changed - self.guess[j]
            plan.samples[0, k] = changed
            for i, slave in enumerate(self.loop.slaves):
                if k not in slave.sources or not slave.active or (told and slave.tells):
                    continue
                slave.restore(states[i])
                slave.step(self.begin, self.size)
                for m, row in enumerate(self.coupled):
                    if owners[m] == i:
                        matrix[m, j] = (plan.values.item(row) - base.item(row)) / delta
            plan.samples[0, k] = self.guess[j]
        plan.sweeps += 1
        plan.values[:count] = base
        plan.jacobian[WHENCE], plan.jacobian[FOR_STEP] = TOLD if told else DIFFERENCES, self.size

    def solve(self) -> bool:
        n = len(self.coupled)
        matrix = self.plan.jacobian[JACOBIAN:].reshape(n, n)
        a, b = (-matrix).tolist(), self.residual
        for i in range(n):
            a[i][i] = 1 + a[i][i]
        for k in range(n):
            pivot = k
            for i in range(k + 1, n):
                if abs(a[i][k]) > abs(a[pivot][k]):
                    pivot = i
            if a[pivot][k] == 0:
                return False
            a[k], a[pivot] = a[pivot], a[k]
            b[k], b[pivot] = b[pivot], b[k]
            for i in range(k + 1, n):
                factor = a[i][k] / a[k][k]
                if factor == 0:
                    continue
                for j in range(k + 1, n):
                    a[i][j] -= factor * a[k][j]
                b[i] -= factor * b[k]
        for k in range(n - 1, -1, -1):
            for j in range(k + 1, n):
                b[k] -= a[k][j] * b[j]
            b[k] /= a[k][k]
        return True


def aitken(factor: float, before: list[float], residual: list[float], scale: list[float]) -> float:
    product = square = 0.0
    for old, new, weight in zip(before, residual, scale, strict=True):
        last = old * weight
        change = new * weight - last
        product += last * change
        square += change * change
    return min(max(-factor * product / square, LEAST_FACTOR), MOST_FACTOR) if square > 0 else factor


def iterate(plan: Plan, loop: PythonLoop, begin: int, size: int) -> int:
    """How many iterations it took."""
    iteration = plan.schedule.iteration
    assert iteration is not None
    solver = iteration.solver
    factor = solver.relaxation if isinstance(solver, FixedPoint) else 1.0
    last, fresh = 0.0, False
    states = loop.save_all()
    for slave in loop.slaves:
        if slave.active:
            slave.push(begin + size, slave.predict(begin, size))
    it = _Iteration(plan, loop, iteration, begin, size)
    before: list[float] = []
    scale: list[float] = []
    count = 0
    while True:
        count += 1
        loop.sweep(begin, size, iterating=True)
        error = it.compare()
        if error <= 1:
            return count
        if count == iteration.most or not math.isfinite(error):
            raise Failed(Fault(-1, "converge", 0, -1, plan.unsettled(it.guess)))
        if isinstance(solver, FixedPoint):
            if count == 1:
                scale = [1 / magnitude for magnitude in it.magnitudes()]
            elif solver.aitken:
                factor = aitken(factor, before, it.residual, scale)
            before = it.residual
            it.guess = [g + factor * r for g, r in zip(it.guess, it.residual, strict=True)]
        else:
            known_for = plan.jacobian.item(FOR_STEP)
            whence = plan.jacobian.item(WHENCE)
            fits = whence != NOWHERE and known_for / 2 < size < 2 * known_for
            slow = not fresh and count > 1 and error > SLOW * last
            fresh = False
            if not fits or slow:
                told = any(s.tells for s in loop.slaves) and whence != DIFFERENCES and not (fits and slow)
                it.put()
                it.differentiate(states, told)
                fresh = not told
            if not it.solve():
                raise Failed(Fault(-1, "converge", 1, -1, plan.unsettled(it.guess)))
            it.guess = [g + r for g, r in zip(it.guess, it.residual, strict=True)]
        last = error
        it.put()
        loop.restore_all(states)
