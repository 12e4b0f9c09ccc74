"""What can be done to a run at a communication point: values set, variables manipulated, slaves stopped.

A manipulation stands between a slave and what it is connected to: that of an output changes what all others and the
recorders see of it, that of an input what its slave sees. It works on the value that the slave or the connection
gives at each exchange (the true value), until it is replaced by another one or released. The loops carry it out, so
that it costs nothing where there is none.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, TypeAlias

import numpy as np

from seacrane.cosim.plan import CHANGE, Plan
from seacrane.cosim.slave import check_values
from seacrane.errors import ParameterError, Problem, nearest
from seacrane.model.dae import Variable


@dataclass(frozen=True)
class Set:
    """Set an input that nothing drives, or a parameter, as `Execution.set` does."""

    variable: str
    to: float


@dataclass(frozen=True)
class Override:
    """The input or output has the value `to` in place of the true one."""

    variable: str
    to: float


@dataclass(frozen=True)
class Ramp:
    """The input or output goes from its present value to `to` at a constant rate within `over` [s], and stays there."""

    variable: str
    to: float
    over: float


@dataclass(frozen=True)
class Freeze:
    """The input or output is stuck at its present value."""

    variable: str


@dataclass(frozen=True)
class Offset:
    """The input or output has its true value plus `by`."""

    variable: str
    by: float


@dataclass(frozen=True)
class Scale:
    """The input or output has its true value times `by`."""

    variable: str
    by: float


@dataclass(frozen=True)
class Release:
    """The input or output has its true value again."""

    variable: str


@dataclass(frozen=True)
class Stop:
    """The slave is never stepped again, and its outputs stay as they are: time in it stands still for good."""

    slave: str


Action: TypeAlias = Set | Override | Ramp | Freeze | Offset | Scale | Release | Stop
ACTIONS: Mapping[str, type[Action]] = {
    kind.__name__.lower(): kind for kind in (Set, Override, Ramp, Freeze, Offset, Scale, Release, Stop)
}
"""The actions by the names they have in files."""


@dataclass(frozen=True)
class Names:
    """What a system has that actions can be about: its variables, what drives which input, and its slaves."""

    variables: Mapping[str, Variable]
    causality: Mapping[str, str]
    sources: Mapping[str, str]
    slaves: Sequence[str]


def check_action(action: Action, names: Names) -> Sequence[Problem]:
    """All that is wrong with an action in a system."""
    if isinstance(action, Stop):
        if action.slave in names.slaves:
            return []
        return [Problem(action.slave, "there is no such slave", hint=nearest(action.slave, names.slaves))]
    name, causality = action.variable, names.causality
    if name not in causality:
        return [Problem(name, "no such variable in the system", hint=nearest(name, causality))]
    what = f"is {'an' if causality[name][0] in 'aio' else 'a'} {causality[name]} variable"
    if isinstance(action, Set):
        return _set_problems(action, names.variables[name], causality[name], names.sources.get(name), what)
    if causality[name] not in ("input", "output"):
        return [Problem(name, f"{what} and cannot be manipulated", allowed="inputs, outputs")]
    problems = []
    for field in fields(action)[1:]:
        value = getattr(action, field.name)
        if not math.isfinite(value):
            problems.append(Problem(name, f"{field.name!r} is not a finite number", value))
        elif field.name == "over" and value <= 0:
            problems.append(Problem(name, "the duration of the ramp must be positive", value, "more than 0 s"))
    return problems


def _set_problems(action: Set, variable: Variable, causality: str, source: str | None, what: str) -> Sequence[Problem]:
    if causality == "input" and source is not None:
        hint = "Override it instead."
        return [Problem(action.variable, f"is driven by {source!r} and cannot be set", hint=hint)]
    if causality not in ("input", "parameter"):
        return [Problem(action.variable, f"{what} and cannot be set", allowed="inputs, parameters")]
    try:
        check_values({action.variable: action.to}, [replace(variable, name=action.variable)])
    except ParameterError as error:
        return error.problems
    return []


class Manipulator:
    """Carries out manipulations in a plan and knows which are in force. Its state is that of the plan."""

    def __init__(self, plan: Plan, free: Collection[str]) -> None:
        """`free` names the inputs that nothing drives."""
        self._plan, self._free = plan, frozenset(free)
        self._names = {index: name for name, index in plan.index.items()}

    @property
    def manipulated(self) -> dict[str, float]:
        """The manipulated variables with their true values."""
        return {self._names[int(c["target"])]: float(c["raw"]) for c in self._plan.changes}

    @property
    def stopped(self) -> tuple[str, ...]:
        return tuple(part.name for part in self._plan.parts if part.stopped)

    def apply(self, action: Action) -> None:
        """Carry out an action other than `Set`, which has been checked; the loop must be refreshed afterwards."""
        plan = self._plan
        if isinstance(action, Stop):
            next(part for part in plan.parts if part.name == action.slave).stopped = True
            return
        index, now = plan.index[action.variable], plan.time_ns / 1e9
        present = float(plan.values[index])
        mine = plan.changes["target"] == index
        raw = float(plan.changes["raw"][mine][0]) if mine.any() else present
        others = plan.changes[~mine]
        law: dict[str, Any] = {"gain": 0.0, "bias": 0.0, "slope": 0.0, "end": -math.inf}
        match action:
            case Override(to=to):
                law["bias"] = to
            case Ramp(to=to, over=over):
                law |= {"bias": to, "slope": (to - present) / over, "end": now + over}
            case Freeze():
                law["bias"] = present
            case Offset(by=by):
                law |= {"gain": 1.0, "bias": by}
            case Scale(by=by):
                law["gain"] = by
            case Release():
                plan.values[index] = raw
                plan.put_changes(others)
                return
        change = np.zeros(1, CHANGE)
        change["target"], change["raw"] = index, raw
        change["fixed"] = action.variable in self._free
        for field, value in law.items():
            change[field] = value
        plan.values[index] = plan.changed(change[0], now)
        plan.put_changes(np.concatenate([others, change]))

    def set(self, name: str, value: float) -> None:
        """Take in that an input that nothing drives was set."""
        plan = self._plan
        index = plan.index[name]
        plan.values[index] = value
        for i in np.flatnonzero(plan.changes["target"] == index):
            plan.changes["raw"][i] = value
            plan.values[index] = plan.changed(plan.changes[i], plan.time_ns / 1e9)
