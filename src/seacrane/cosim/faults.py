"""What a fault of a loop means, in words: which slave, doing what, when, and why."""

from __future__ import annotations

from seacrane.cosim.loops import Fault
from seacrane.cosim.plan import Plan
from seacrane.cosim.watchdog import Late
from seacrane.errors import CosimError, Problem

STATUS = {0: "OK", 1: "warning", 2: "discard", 3: "error", 4: "fatal", 5: "pending"}
"""FMI 2 status codes (FMI 2.0, section 2.1.3)."""

_DOING = {
    "set": "taking its inputs",
    "step": "stepping",
    "get": "giving its outputs",
    "watch": "giving its internal variables",
    "save": "saving its state",
    "restore": "going back to a saved state",
    "derive": "giving its directional derivatives",
}


def explained(fault: Fault, plan: Plan) -> tuple[CosimError, BaseException | None]:
    """The error of a run that a fault ends, and the exception behind it if a slave in Python raised one.

    An exception that is none of a program, such as an interrupt from the keyboard, is to be raised itself.
    """
    begin, end = plan.time_ns / 1e9, (plan.time_ns + plan.schedule.step_ns) / 1e9
    when = f"in the step from t = {begin:.9g} to {end:.9g} s"
    if fault.stage == "converge":
        return _not_converged(fault, plan, when), None
    part = plan.parts[fault.slave]
    part.instance.failed(fault.status)
    cause, part.instance.failure = part.instance.failure, None
    if fault.stage == "finite":
        variable = part.interface.outputs[fault.variable]
        value = float(plan.values[part.outputs][fault.variable])
        return CosimError.at(f"{part.name}.{variable.name}", f"is not finite {when}", value=value), None
    if cause is None:
        status = STATUS.get(fault.status, str(fault.status))
        reason = f": {part.instance.message}" if part.instance.message else ""
        message = f"failed with status {status!r} when {_DOING[fault.stage]} {when}{reason}"
    elif isinstance(cause, Exception):
        message = f"failed {when}: {type(cause).__name__}: {cause}"
    else:
        message = f"was interrupted {when}"
    return CosimError.at(part.name, message), cause


def too_late(late: tuple[Late, ...], limit: float, plan: Plan) -> CosimError:
    """The error of a run whose last macro step took a slave longer than `limit` [s] of wall time."""
    begin, end = (plan.time_ns - plan.schedule.step_ns) / 1e9, plan.time_ns / 1e9
    message = f"took too long in the step from t = {begin:.9g} to {end:.9g} s"
    return CosimError(Problem(c.slave, message, c.seconds, f"at most {limit:g} s of wall time") for c in late)


def _not_converged(fault: Fault, plan: Plan, when: str) -> CosimError:
    names = {k: name for name, k in plan.index.items() if k in fault.variables}
    iteration = plan.schedule.iteration
    assert iteration is not None
    count = "its equations are singular" if fault.status else f"after {iteration.most} iterations"
    message = f"does not converge {when} ({count}, tolerance {iteration.tolerance:g})"
    hint = "Take a shorter step, Newton(), an under-relaxed FixedPoint, a wider tolerance, or more exact slaves."
    return CosimError(Problem(name, message, float(plan.values[k]), hint=hint) for k, name in names.items())
