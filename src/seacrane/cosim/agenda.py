"""What a run has to do at given times: the timed events of the scenario that it follows."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import astuple

from seacrane.cosim.actions import Action, Names
from seacrane.cosim.scenario import Scenario, Timed
from seacrane.errors import CosimError, Problem


class Agenda:
    """The events of a scenario, each due once, in their order. `passed` counts those that were."""

    def __init__(self) -> None:
        self.scenario: Scenario | None = None
        self.passed = 0
        self._events: tuple[Timed, ...] = ()

    def follow(self, scenario: Scenario, names: Names, now_ns: int) -> None:
        """Take a scenario; `CosimError` with all that does not fit the system, or lies before `now_ns` [ns]."""
        if self.scenario is not None:
            raise CosimError.at(scenario.name, "cannot be followed: the run follows a scenario already")
        problems = scenario.check(names)
        timed = scenario.timed()
        problems += [
            Problem(f"events[{event.index}]", f"is due before the present time {now_ns / 1e9:g} s", event.at_ns / 1e9)
            for event in timed
            if event.at_ns < now_ns
        ]
        if problems:
            raise CosimError(Problem(f"{scenario.name}: {p.path}", *astuple(p)[1:]) for p in problems)
        self.scenario, self._events = scenario, timed

    def due(self, now_ns: int) -> Iterator[Action]:
        """The actions that are due at `now_ns` [ns]."""
        while self.passed < len(self._events) and self._events[self.passed].at_ns <= now_ns:
            self.passed += 1
            yield self._events[self.passed - 1].action

    @property
    def next_ns(self) -> int | None:
        """When the next event is due [ns]."""
        return self._events[self.passed].at_ns if self.passed < len(self._events) else None
