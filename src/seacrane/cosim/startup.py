"""Consistent values at the start of a run: outputs depend on inputs that are outputs of others."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from seacrane.cosim.plan import Plan, Transfer
from seacrane.errors import CosimError, Problem

EXTRA_SWEEPS = 50
"""Sweeps beyond one for each slave, which a chain in the worst order needs: enough where loops contract."""

TOLERANCE = 1e-9
"""Relative change, of the larger of value and nominal, below which an output counts as settled."""


def settle(plan: Plan, given: Mapping[str, float]) -> int:
    """Initialise the slaves in order and pass outputs on until nothing changes; the number of sweeps.

    `given` holds values of inputs that nothing drives, instead of their start values.
    `CosimError` naming the outputs that still change, if the signals around a loop of direct feedthrough do not
    converge, or those that are not finite.
    """
    time = plan.start_ns / 1e9
    for part in plan.parts:
        plan.values[part.inputs] = [v.start for v in part.interface.inputs]
        plan.values[part.outputs] = [v.start for v in part.interface.outputs]
    for name, value in given.items():
        plan.values[plan.index[name]] = value
    for part in plan.parts:
        part.instance.initialise(time)
    nominal = [np.array([abs(v.nominal) for v in part.interface.outputs]) for part in plan.parts]
    transfers = [Transfer(plan.values, [part]) for part in plan.parts]
    changing: list[str] = []
    for sweep in range(1, len(plan.parts) + EXTRA_SWEEPS + 1):
        changing = []
        for part, scale, incoming in zip(plan.parts, nominal, transfers, strict=True):
            before = plan.values[part.outputs].copy()
            incoming.transfer()
            part.instance.evaluate()
            after = plan.values[part.outputs]
            names = [f"{part.name}.{v.name}" for v in part.interface.outputs]
            bad = np.flatnonzero(~np.isfinite(after))
            if bad.size:
                raise CosimError(
                    Problem(names[i], f"is not finite at the start (t = {time:g} s)", float(after[i])) for i in bad
                )
            moved = np.abs(after - before) > TOLERANCE * np.maximum(np.abs(after), scale)
            changing += [names[i] for i in np.flatnonzero(moved)]
        if not changing:
            return sweep
    raise CosimError(
        Problem(
            name,
            f"does not settle at the start (t = {time:g} s): it is part of a loop of direct feedthrough",
            hint="Put a state (a filter, a compliance) into the loop, or give start values nearer to the solution.",
        )
        for name in changing
    )
