"""What comes back around a bond within one step: the strength of a coupling, measured at its two slaves."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from seacrane.cosim.plan import Part, Plan
from seacrane.errors import CosimError

SHARE = 1e-3
"""A value is changed by this share of the size that its signal has in the run."""


def loop_gains(plan: Plan, step: float, sizes: Mapping[str, float]) -> dict[str, float]:
    """For each bond, by how much a change of its flow is multiplied when it has gone once around the bond.

    The slave of the effort does a step of `step` seconds with the flow changed, up and down; what its effort then
    differs by is given to the slave of the flow, which does a step as well, and its flow compared with the change. Both
    are then back where they were. `sizes` are those of the bonds' efforts and flows, by the names of the outputs.

    A mass m against a spring k gives -k step^2 / m. Raises `CosimError` if a slave cannot be saved or does not step.
    """
    gains = np.concatenate([part.gains for part in plan.parts]).tolist()
    names = {index: name for name, index in plan.index.items()}
    found: dict[str, float] = {}
    for bond in plan.bonds:
        taken, returned = gains[bond.flow_connection], gains[bond.effort_connection]
        flow = SHARE * sizes[names[bond.flow_out]] * taken
        effort = SHARE * sizes[names[bond.effort_out]] * returned
        if not (flow and effort):
            found[bond.name] = 0.0
            continue
        one, two = plan.parts[bond.effort_slave], plan.parts[bond.flow_slave]
        there = _response(plan, one, bond.flow_in, bond.effort_out, abs(flow), step)
        back = _response(plan, two, bond.effort_in, bond.flow_out, abs(effort), step)
        found[bond.name] = there * back * taken * returned
    return found


def _response(plan: Plan, part: Part, entry: int, output: int, change: float, step: float) -> float:
    """Of an output after the step, by an input changed for the whole of it: central difference."""
    values, state = plan.values.copy(), part.instance.save()
    after = []
    for moved in (change, -change):
        plan.values[entry] = values[entry] + moved
        status = part.instance.advance(plan.time_ns / 1e9, step)
        after.append(float(plan.values[output]))
        part.instance.restore(state)
        plan.values[:] = values
        if status > 1 or not np.isfinite(after[-1]):
            raise CosimError.at(part.name, f"does no step of {step:g} s from t = {plan.time_ns / 1e9:g} s")
    return (after[0] - after[1]) / (2 * change)
