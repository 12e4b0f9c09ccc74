"""Scenarios: what happens to a run and when, in Python or in a versioned JSON file.

    {"format": "seacrane-scenario/1", "name": "sensor fault", "about": "The pressure sensor sticks while hoisting.",
     "events": [
      {"at": "2 s",  "do": "set",      "variable": "stick.hoist",  "to": 0.5},
      {"at": "4 s",  "do": "freeze",   "variable": "winch.pressure"},
      {"at": "6 s",  "do": "ramp",     "variable": "pump.p",       "to": "180 bar", "over": "500 ms"},
      {"when": [{"variable": "crane.radius", "above": "24 m"}], "do": "release", "variable": "winch.pressure"},
      {"at": "30 s", "do": "stop",     "slave": "winch"}]}

Each event is due `at` a time of the run, or `when` all its conditions come to hold for the first time. Values are
texts with a unit, or numbers in the unit of the variable; times are texts or numbers in s.
"""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Final

from seacrane import documents
from seacrane.cosim.actions import ACTIONS, Action, Names, Stop, check_action
from seacrane.cosim.algorithms import NANOSECONDS
from seacrane.cosim.triggers import Above, Below, Condition, check_conditions
from seacrane.errors import CosimError, Problem, UnitError, nearest
from seacrane.model.dae import Variable
from seacrane.units import parse

FORMAT: Final = "seacrane-scenario/1"


@dataclass(frozen=True)
class Event:
    """An action that is due `at` a time [s], or at the first communication point at which a condition holds, or all."""

    at: float | Condition | tuple[Condition, ...]
    action: Action

    @property
    def conditions(self) -> tuple[Condition, ...] | None:
        """What must hold; None if the event is due at a time."""
        if isinstance(self.at, int | float):
            return None
        return self.at if isinstance(self.at, tuple) else (self.at,)


@dataclass(frozen=True)
class Timed:
    """An action that is due at `at_ns` [ns], and the index of its event."""

    at_ns: int
    index: int
    action: Action


@dataclass(frozen=True)
class Scenario:
    """What happens in a run, in the order of `events` where two are due at once."""

    name: str
    events: tuple[Event, ...]
    about: str = ""

    def timed(self) -> tuple[Timed, ...]:
        """The events that are due at a time, in the order in which they are."""
        timed = [
            Timed(round(event.at * NANOSECONDS), index, event.action)
            for index, event in enumerate(self.events)
            if isinstance(event.at, int | float) and math.isfinite(event.at)
        ]
        return tuple(sorted(timed, key=lambda event: (event.at_ns, event.index)))

    def check(self, names: Names) -> list[Problem]:
        """All that does not fit a system."""
        problems = []
        for index, event in enumerate(self.events):
            wrong = [*check_action(event.action, names)]
            if event.conditions is not None:
                wrong += check_conditions(event.conditions, names)
            elif isinstance(event.at, int | float) and not math.isfinite(event.at):
                wrong.append(Problem("at", "is not a finite number", event.at))
            problems += [Problem(f"events[{index}]: {p.path}", p.message, p.value, p.allowed, p.hint) for p in wrong]
        return problems


def load(path: str | os.PathLike[str], variables: Mapping[str, Variable]) -> Scenario:
    """The scenario in a file for a system with these variables; `CosimError` lists everything that is wrong."""
    return loads(documents.read(path, CosimError), variables, os.fspath(path))


def loads(content: bytes | str, variables: Mapping[str, Variable], origin: str = "scenario") -> Scenario:
    """The scenario in the JSON text of a file; `origin` names it in errors."""
    data = documents.parsed(content, origin, CosimError)
    if not isinstance(data, dict):
        raise CosimError.at(origin, "does not hold a scenario: the file must be a JSON object")
    if data.get("format") != FORMAT:
        written = data.get("format")
        what = "names no format" if written is None else "is of a format that this version cannot read"
        raise CosimError.at(f"{origin}: format", what, value=written, allowed=repr(FORMAT))
    reader = _Reader(variables)
    scenario = reader.scenario(data)
    if reader.problems:
        raise CosimError(Problem(f"{origin}: {p.path}", p.message, p.value, p.allowed, p.hint) for p in reader.problems)
    return scenario


class _Reader:
    """Reads plain data, and collects what is wrong with it."""

    def __init__(self, variables: Mapping[str, Variable]) -> None:
        self._variables = variables
        self.problems: list[Problem] = []

    def scenario(self, data: dict[str, Any]) -> Scenario:
        self._only(data, "", ("format", "name", "about", "events"))
        name, about = self._text(data, "name", ""), self._text(data, "about", "") if "about" in data else ""
        events = data.get("events")
        if not isinstance(events, list):
            self._wrong("events", "must be a list of events", events)
            events = []
        read = [self._event(event, f"events[{i}]") for i, event in enumerate(events)]
        return Scenario(name, tuple(event for event in read if event is not None), about)

    def _event(self, data: Any, path: str) -> Event | None:
        if not isinstance(data, dict):
            self._wrong(path, "must be an object", data)
            return None
        kind = ACTIONS.get(do) if isinstance(do := data.get("do"), str) else None
        if kind is None:
            hint = nearest(do, ACTIONS) if isinstance(do, str) else None
            self._wrong(f"{path}.do", "must say what is done", do, ", ".join(ACTIONS), hint)
            return None
        names = [field.name for field in fields(kind)]
        self._only(data, path, ("at", "when", "do", *names))
        before = len(self.problems)
        due = self._due(data, path)
        subject = self._text(data, names[0], path)
        unit = "1" if kind is Stop else self._unit(subject, f"{path}.{names[0]}")
        values = []
        for name in names[1:]:
            # A factor has no unit, and a duration one of time, whatever the variable has.
            needed = {"over": "s", "by": "1" if do == "scale" else unit}.get(name, unit)
            values.append(self._value(data, name, path, needed))
        if len(self.problems) > before:
            return None
        return Event(due, kind(subject, *values))

    def _due(self, data: dict[str, Any], path: str) -> float | tuple[Condition, ...]:
        if ("at" in data) == ("when" in data):
            self._wrong(path, "must be due either at a time or when conditions hold", allowed="'at' or 'when'")
            return 0.0
        if "at" in data:
            return self._value(data, "at", path, "s")
        conditions = data["when"]
        if not isinstance(conditions, list) or not conditions:
            self._wrong(f"{path}.when", "must be a list of conditions", conditions)
            return ()
        return tuple(self._condition(c, f"{path}.when[{i}]") for i, c in enumerate(conditions))

    def _condition(self, data: Any, path: str) -> Condition:
        if not isinstance(data, dict) or ("above" in data) == ("below" in data):
            self._wrong(path, "must name a variable and what it is above or below", data)
            return Above("", 0.0)
        kind: type[Condition] = Above if "above" in data else Below
        self._only(data, path, ("variable", kind.__name__.lower()))
        name = self._text(data, "variable", path)
        return kind(name, self._value(data, kind.__name__.lower(), path, self._unit(name, f"{path}.variable")))

    # ------------------------------------------------------------ fields
    def _only(self, data: Mapping[str, Any], path: str, allowed: Sequence[str]) -> None:
        for key in data:
            if key not in allowed:
                self._wrong(f"{path}.{key}" if path else key, "no such field here", hint=nearest(key, allowed))

    def _text(self, data: Mapping[str, Any], key: str, path: str) -> str:
        value = data.get(key)
        if isinstance(value, str) and (value or key == "about"):
            return value
        self._wrong(f"{path}.{key}" if path else key, "must be a text" if key in data else "is missing", value)
        return ""

    def _unit(self, name: str, path: str) -> str:
        """The unit of a variable; empty if there is none of this name."""
        if name in self._variables:
            return self._variables[name].unit
        if name:
            self._wrong(path, "no such variable in the system", name, hint=nearest(name, self._variables))
        return ""

    def _value(self, data: Mapping[str, Any], key: str, path: str, unit: str) -> float:
        value, at = data.get(key), f"{path}.{key}"
        if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
            return float(value)
        if not isinstance(value, str):
            self._wrong(at, "must be a finite number or a text with a unit" if key in data else "is missing", value)
        elif unit:
            try:
                return parse(value, unit, at)
            except UnitError as error:
                self.problems += error.problems
        return 0.0

    def _wrong(
        self, path: str, message: str, value: Any = None, allowed: str | None = None, hint: str | None = None
    ) -> None:
        self.problems.append(Problem(path, message, value, allowed, hint))
