"""The variables of a run by their full names: what each is, and what may be done with it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from seacrane.cosim.actions import Names
from seacrane.cosim.algorithms import Schedule
from seacrane.cosim.plan import SIGNALS
from seacrane.cosim.system import System
from seacrane.errors import CosimError, Problem, nearest
from seacrane.model.dae import Variable


class Catalogue:
    """Variables of a system, and what the algorithm tells of itself.

    `free` are the inputs that nothing drives, `connectors` those of the system itself with the inputs that they lead
    to, and `places` the slave and the variable of each name but those of bonds.
    """

    def __init__(self, system: System, schedule: Schedule) -> None:
        causality = dict(system.causalities)
        variables = dict(system.variables)
        sources = {c.target: c.source for c in system.connections}
        self.connectors = system.settable_connectors
        self.places = {name: system.split(name) for name, c in causality.items() if c != "bond"}
        self.free = {n for n, c in causality.items() if c == "input" and n not in sources}
        for name in schedule.signals:
            variables[name], causality[name] = Variable(name, SIGNALS[name]), "algorithm"
        self.variables: Mapping[str, Variable] = variables
        self.causality: Mapping[str, str] = causality
        self.names = Names(variables, causality, sources, tuple(system.slaves))

    @property
    def observed(self) -> list[str]:
        """What is recorded unless something is asked for: all outputs and bonds."""
        return [n for n, c in self.causality.items() if c in ("output", "bond")]

    def settable(self, name: str) -> bool:
        return name in self.free or self.causality.get(name) == "parameter"

    def check_readable(self, names: Iterable[str]) -> None:
        """`CosimError` with every name that cannot be read."""
        problems = []
        for name in names:
            if name not in self.causality:
                problems.append(Problem(name, "no such variable in the system", hint=nearest(name, self.causality)))
            elif self.causality[name] == "parameter":
                what = "is a parameter and does not change by itself: it cannot be read here"
                problems.append(Problem(name, what))
        if problems:
            raise CosimError(problems)
