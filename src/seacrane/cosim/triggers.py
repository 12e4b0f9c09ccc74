"""Triggers: what is done when conditions on variables come to hold, at the communication point where they do."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from seacrane.cosim.actions import Names
from seacrane.cosim.plan import CONDITION, TRIGGER, Plan
from seacrane.errors import Problem, nearest


@dataclass(frozen=True)
class Above:
    """The variable is greater than `value`, in its unit."""

    variable: str
    value: float


@dataclass(frozen=True)
class Below:
    """The variable is less than `value`, in its unit."""

    variable: str
    value: float


Condition: TypeAlias = Above | Below


def check_conditions(conditions: Sequence[Condition], names: Names) -> list[Problem]:
    """All that is wrong with conditions in a system."""
    causality = names.causality
    problems = [] if conditions else [Problem("when", "has no condition")]
    for condition in conditions:
        name = condition.variable
        if name not in causality:
            problems.append(Problem(name, "no such variable in the system", hint=nearest(name, causality)))
        elif causality[name] == "parameter":
            problems.append(Problem(name, "is a parameter and does not change by itself"))
        if not math.isfinite(condition.value):
            problems.append(Problem(name, "is compared with what is not a finite number", condition.value))
    return problems


@dataclass
class Trigger:
    """What is called, and whether only the first time."""

    conditions: tuple[Condition, ...]
    call: Callable[[], None]
    once: bool


class Triggers:
    """The triggers of a run; which of them hold is in the plan, where the loops look at them."""

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self._all: list[Trigger] = []

    def __len__(self) -> int:
        return len(self._all)

    def add(self, trigger: Trigger, indices: Sequence[int], watches: bool) -> None:
        """Add a trigger whose conditions are on the values of these indices; the loop must be refreshed."""
        plan = self._plan
        first = plan.conditions.size
        rows = [(i, isinstance(c, Above), c.value) for i, c in zip(indices, trigger.conditions, strict=True)]
        plan.conditions = np.concatenate([plan.conditions, np.array(rows, CONDITION)])
        plan.triggers = np.concatenate([plan.triggers, np.array([(first, len(rows), 0, 0)], TRIGGER)])
        plan.trigger_watches = plan.trigger_watches or watches
        self._all.append(trigger)

    def fire(self) -> None:
        """Call what has come to hold since the last time, in the order of adding."""
        for i in range(len(self._all)):
            if self._plan.triggers["fired"][i] == 1:
                # One that is to fire once stays at 2, and is passed over by all later calls.
                self._plan.triggers["fired"][i] = 2 if self._all[i].once else 0
                self._all[i].call()
