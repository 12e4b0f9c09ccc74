"""From names to indices: the system laid out on one flat array of values that both loops work on.

The array `values` holds, in the order of the schedule, all outputs, then all inputs, then room for the watched internal
variables of each slave, then the account of each bond.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from seacrane.cosim.algorithms import Schedule
from seacrane.cosim.bonds import ACCOUNT
from seacrane.cosim.slave import Instance, Interface, Vector
from seacrane.cosim.structure import Connection, factor
from seacrane.cosim.system import System
from seacrane.model.dae import Variable
from seacrane.units import UNITS

CHANGE = np.dtype(
    [("target", "i8"), ("fixed", "i8"), ("gain", "f8"), ("bias", "f8"), ("slope", "f8"), ("end", "f8"), ("raw", "f8")]
)
"""A variable whose value is changed to gain * raw + bias, reached by a ramp of `slope` that ends at time `end` [s]."""

TRIGGER = np.dtype([("first", "i8"), ("count", "i8"), ("held", "i8"), ("fired", "i8")])
"""All of `count` conditions from `first` on; `fired` is set to 1 when they come to hold, unless it is set already."""

CONDITION = np.dtype([("index", "i8"), ("above", "i8"), ("threshold", "f8")])


@dataclass
class Part:
    """One slave's place in the plan: index ranges into `values`, and its connections."""

    name: str
    interface: Interface
    instance: Instance
    outputs: slice
    inputs: slice
    room: slice
    sources: npt.NDArray[np.int64]
    targets: npt.NDArray[np.int64]
    gains: Vector
    biases: Vector
    adds: npt.NDArray[np.int64]
    """Of each connection, whether it adds to what an earlier one has brought to the same input."""
    watched: list[str] = field(default_factory=list)
    changes: slice = field(default_factory=lambda: slice(0, 0))
    """Into the changes of the plan: those of its inputs, then those of its outputs."""
    input_changes: int = 0
    output_changes: int = 0
    stopped: bool = False


class Transfer:
    """Outputs to inputs, of all connections into some slaves at once."""

    def __init__(self, values: Vector, parts: Sequence[Part]) -> None:
        self._values = values
        names = ("sources", "targets", "gains", "biases", "adds")
        columns = [np.concatenate([getattr(p, n) for p in parts]) for n in names]
        alone = columns[-1] == 0
        self._sources, self._targets, self._gains, self._biases = (column[alone] for column in columns[:4])
        self._added = list(zip(*(column[~alone].tolist() for column in columns[:3]), strict=True))

    def transfer(self) -> None:
        values = self._values
        if self._sources.size:
            values[self._targets] = values[self._sources] * self._gains + self._biases
        for source, target, gain in self._added:
            values[target] = values[source] * gain + values[target]


@dataclass(frozen=True)
class BondIndices:
    """Where a bond's variables and account are in `values`, and the factors of the products of each side to W."""

    name: str
    effort_out: int
    flow_in: int
    effort_in: int
    flow_out: int
    account: int
    effort_side: float
    flow_side: float


@dataclass
class Rows:
    """Rows of (time, values...) that the loops fill for a recorder: one each `stride` macro steps."""

    stride: int
    indices: npt.NDArray[np.int64]
    watches: bool
    table: Vector
    count: int = 0


class Plan:
    """The layout, the values themselves, and the count of macro steps `done` since `start_ns`."""

    def __init__(self, system: System, schedule: Schedule, instances: dict[str, Instance], start_ns: int) -> None:
        self.schedule = schedule
        self.start_ns = start_ns
        self.done = 0
        self.watched_at = -1
        self.rows: list[Rows] = []
        self.changes = np.zeros(0, CHANGE)
        self.triggers, self.conditions = np.zeros(0, TRIGGER), np.zeros(0, CONDITION)
        self.trigger_watches = False
        self.calls = np.zeros(len(schedule.order), dtype=np.int64)
        self.stop = np.zeros(1, dtype=np.int64)
        self.index: dict[str, int] = {}
        interfaces = {name: system.slaves[name].interface for name in schedule.order}
        places: dict[str, list[slice]] = {name: [] for name in schedule.order}
        size = 0
        for group in ("outputs", "inputs", "watchable"):
            for name in schedule.order:
                variables = getattr(interfaces[name], group)
                places[name].append(slice(size, size + len(variables)))
                if group != "watchable":
                    self.index |= {f"{name}.{v.name}": size + i for i, v in enumerate(variables)}
                size += len(variables)
        first_account, size = size, size + len(ACCOUNT) * len(system.bonds)
        self.values: Vector = np.zeros(size)
        self.watchable = {
            f"{name}.{v.name}": (name, v.name) for name, interface in interfaces.items() for v in interface.watchable
        }
        variables = system.variables
        incoming: dict[str, list[Connection]] = {name: [] for name in schedule.order}
        for connection in system.connections:
            incoming[system.split(connection.target)[0]].append(connection)
        self.parts = [
            self._part(name, interfaces[name], instances[name], places[name], incoming[name], variables)
            for name in schedule.order
        ]
        self.bonds = [self._bond(system, name, first_account + len(ACCOUNT) * i) for i, name in enumerate(system.bonds)]
        for bond in self.bonds:
            self.index |= {f"{bond.name}.{q}": bond.account + i for i, q in enumerate(ACCOUNT)}
        for part in self.parts:
            part.instance.bind(self.values[part.inputs], self.values[part.outputs])

    @property
    def time_ns(self) -> int:
        return self.start_ns + self.done * self.schedule.step_ns

    def watch(self, names: Iterable[str]) -> bool:
        """Give internal variables a place in `values`; whether any of these names is one."""
        parts = {part.name: part for part in self.parts}
        found = False
        for name in names:
            if name not in self.watchable:
                continue
            found = True
            slave, variable = self.watchable[name]
            part = parts[slave]
            if variable not in part.watched:
                self.index[name] = part.room.start + len(part.watched)
                part.watched.append(variable)
        return found

    def put_changes(self, changes: npt.NDArray[np.void]) -> None:
        """Put these in place of all changes of variables that there were; the loop must be refreshed."""
        pieces, count = [], 0
        for part in self.parts:
            groups = [
                changes[(changes["target"] >= place.start) & (changes["target"] < place.stop)]
                for place in (part.inputs, part.outputs)
            ]
            part.input_changes, part.output_changes = (group.size for group in groups)
            part.changes = slice(count, count + part.input_changes + part.output_changes)
            count = part.changes.stop
            pieces += groups
        self.changes = np.concatenate(pieces)

    def manipulate(self, first: int, end: int, t: float) -> None:
        """Carry out changes on the values they are about, at time `t` [s]."""
        for i in range(first, end):
            c = self.changes[i]
            if not c["fixed"]:
                c["raw"] = self.values[c["target"]]
            self.values[c["target"]] = self.changed(c, t)

    @staticmethod
    def changed(change: np.void, t: float) -> float:
        """What a change makes of its raw value at time `t` [s]."""
        value = float(change["gain"]) * float(change["raw"]) + float(change["bias"])
        if t < change["end"]:
            value -= float(change["slope"]) * (float(change["end"]) - t)
        return value

    def look(self) -> bool:
        """See which triggers hold; whether one of them has come to hold."""
        fired = False
        for trigger in self.triggers:
            holds = True
            for c in self.conditions[trigger["first"] : trigger["first"] + trigger["count"]]:
                value = self.values[c["index"]]
                holds = holds and bool(value > c["threshold"] if c["above"] else value < c["threshold"])
            if holds and not (trigger["held"] or trigger["fired"]):
                trigger["fired"], fired = 1, True
            trigger["held"] = holds
        return fired

    def _part(
        self,
        name: str,
        interface: Interface,
        instance: Instance,
        places: list[slice],
        incoming: Sequence[Connection],
        variables: Mapping[str, Variable],
    ) -> Part:
        gains = []
        for c in incoming:
            gains.append(c.gain * (factor(variables[c.source].unit, variables[c.target].unit) if c.convert else 1.0))
        first = {c.target: i for i, c in reversed(list(enumerate(incoming)))}
        return Part(
            name,
            interface,
            instance,
            outputs=places[0],
            inputs=places[1],
            room=places[2],
            sources=np.array([self.index[c.source] for c in incoming], dtype=np.int64),
            targets=np.array([self.index[c.target] for c in incoming], dtype=np.int64),
            gains=np.array(gains, dtype=np.float64),
            biases=np.array([c.bias for c in incoming], dtype=np.float64),
            adds=np.array([i != first[c.target] for i, c in enumerate(incoming)], dtype=np.int64),
        )

    def _bond(self, system: System, name: str, account: int) -> BondIndices:
        bond, variables = system.bonds[name], system.variables
        (effort_out, effort_in), (flow_out, flow_in) = bond.effort, bond.flow
        factor = {n: UNITS[variables[n].unit].factor for n in (effort_out, effort_in, flow_out, flow_in)}
        return BondIndices(
            name,
            effort_out=self.index[effort_out],
            flow_in=self.index[flow_in],
            effort_in=self.index[effort_in],
            flow_out=self.index[flow_out],
            account=account,
            effort_side=factor[effort_out] * factor[flow_in],
            flow_side=factor[effort_in] * factor[flow_out],
        )
