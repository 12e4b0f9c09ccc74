"""Consistent values at the start of a run: outputs depend on inputs that are outputs of others.

Sweeps over the slaves settle chains, and loops of direct feedthrough that contract. What then still changes is solved
by Newton's method for the outputs that are connected, with differences for derivatives, whatever the gain of the loop.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import numpy.typing as npt

from seacrane.cosim.plan import Part, Plan, Transfer
from seacrane.cosim.slave import Vector
from seacrane.errors import CosimError, Problem, SeacraneError

EXTRA_SWEEPS = 50
"""Sweeps beyond one for each slave, which a chain in the worst order needs: enough where loops contract."""

GROWING = 3
"""Sweeps after which a loop is left to Newton's method, if they change more and not less."""

TOLERANCE = 1e-9
"""Relative change, of the larger of value and nominal, below which an output counts as settled."""

MOST_ITERATIONS = 30
SHORTEST = 2.0**-10
"""Share of a step of Newton's method below which it is given up."""

DIFFERENCE = 1e-6
"""Of the larger of value and nominal: by how much an output is changed for its derivatives."""


def settle(plan: Plan, given: Mapping[str, float]) -> None:
    """Initialise the slaves in order and make connected values consistent.

    `given` holds values of inputs that nothing drives, instead of their start values.
    `CosimError` naming the outputs that have no solution around a loop of direct feedthrough, or are not finite.
    """
    time = plan.start_ns / 1e9
    for part in plan.parts:
        plan.values[part.inputs] = [v.start for v in part.interface.inputs]
        plan.values[part.outputs] = [v.start for v in part.interface.outputs]
    for name, value in given.items():
        plan.values[plan.index[name]] = value
    for part in plan.parts:
        part.instance.initialise(time)
    start = plan.values.copy()
    solver = _Start(plan, time)
    changing = solver.sweep()
    if changing.size:
        unsolved = solver.newton(np.intersect1d(changing, plan.coupled), start)
        if unsolved.size:
            raise CosimError(
                Problem(
                    solver.names[i],
                    f"does not settle at the start (t = {time:g} s): it is part of a loop of direct feedthrough",
                    hint="Put a state (a filter, a compliance) into the loop, "
                    "or give start values nearer to the solution.",
                )
                for i in unsolved
            )


class _Start:
    def __init__(self, plan: Plan, time: float) -> None:
        self._plan, self._time = plan, time
        self._outputs = plan.values[: plan.nominal.size]
        self._nominal = plan.nominal
        self._transfers = [Transfer(plan.values, [part]) for part in plan.parts]
        self.names = [f"{part.name}.{v.name}" for part in plan.parts for v in part.interface.outputs]

    def sweep(self) -> npt.NDArray[np.intp]:
        """Pass outputs on until nothing changes; the outputs that still do."""
        parts = self._plan.parts
        growing, last = 0, np.inf
        for sweep in range(len(parts) + EXTRA_SWEEPS):
            before = self._outputs.copy()
            for part, incoming in zip(parts, self._transfers, strict=True):
                incoming.transfer()
                part.instance.evaluate()
                if not np.all(np.isfinite(self._plan.values[part.outputs])):
                    if sweep < len(parts):
                        self._not_finite(part)
                    return np.arange(self._outputs.size)
            changing = self._apart(before)
            if not changing.size:
                break
            change = float(np.max(np.abs(self._outputs - before) / self._nominal))
            growing, last = growing + (sweep >= len(parts) and change >= last), change
            if growing >= GROWING:
                break
        return changing

    def newton(self, unknown: npt.NDArray[np.int64], start: Vector) -> npt.NDArray[np.intp]:
        """Solve for these outputs from their start values; those that are not solved."""
        self._outputs[:] = start[: self._outputs.size]
        z = self._outputs[unknown].copy()
        residual = self._residual(z, unknown)
        for _ in range(MOST_ITERATIONS):
            size = np.maximum(np.abs(z), self._nominal[unknown])
            if np.all(np.abs(residual) <= TOLERANCE * size):
                return np.empty(0, dtype=np.intp)
            jacobian = np.empty((z.size, z.size))
            for j in range(z.size):
                changed = z.copy()
                changed[j] += DIFFERENCE * size[j]
                jacobian[:, j] = (self._residual(changed, unknown) - residual) / (changed[j] - z[j])
            try:
                step = np.linalg.solve(jacobian, -residual)
            except np.linalg.LinAlgError:
                break
            share, norm = 1.0, np.linalg.norm(residual / size)
            while True:
                tried = self._residual(z + share * step, unknown)
                if np.linalg.norm(tried / size) < norm or share < SHORTEST:
                    break
                share /= 2
            if share < SHORTEST:
                break
            z, residual = z + share * step, tried
        return unknown

    def _residual(self, z: Vector, unknown: npt.NDArray[np.int64]) -> Vector:
        """What the outputs become when the inputs take `z`, less `z`; not finite where that has no value."""
        self._outputs[unknown] = z
        for incoming in self._transfers:
            incoming.transfer()
        for part in self._plan.parts:
            part.instance.evaluate()
        found: Vector = self._outputs[unknown] - z
        return found

    def _apart(self, before: Vector) -> npt.NDArray[np.intp]:
        size = np.maximum(np.abs(self._outputs), self._nominal)
        return np.flatnonzero(~(np.abs(self._outputs - before) <= TOLERANCE * size))

    def _not_finite(self, part: Part) -> None:
        names = self.names[part.outputs]
        values = self._plan.values[part.outputs]
        raise CosimError(
            Problem(names[i], f"is not finite at the start (t = {self._time:g} s)", float(values[i]))
            for i in np.flatnonzero(~np.isfinite(values))
        )


def check_repeatable(plan: Plan, algorithm: str) -> bool:
    """Whether steps can be repeated; `CosimError` naming the slaves that cannot go back, where they must."""
    problems = []
    if not plan.schedule.repeats and plan.schedule.control is None:
        return False
    for part in plan.parts:
        if part.instance.calls is not None and part.instance.calls.save:
            continue
        try:
            part.instance.save()
        except SeacraneError as error:
            why = "; ".join(p.message for p in error.problems)
            problems.append(Problem(part.name, f"cannot be saved and restored, which {algorithm} needs: {why}"))
    if problems and plan.schedule.repeats:
        raise CosimError(problems)
    return not problems
