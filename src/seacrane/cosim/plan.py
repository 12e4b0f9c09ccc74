"""From names to indices: the system laid out on one flat array of values that both loops work on.

The array `values` holds all outputs, then all inputs, both in the order of the schedule, then room for the watched
internal variables of each slave, then the account of each bond, then what the algorithm keeps: its signals, histories
and step sizes. So `values`, the slaves' own states and the count of macro steps are the whole state of a run.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
import numpy.typing as npt

from seacrane.cosim.algorithms import Newton, PowerResidual, Schedule
from seacrane.cosim.bonds import ACCOUNT
from seacrane.cosim.slave import Instance, Interface, Vector
from seacrane.cosim.structure import Bond, Connection, factor
from seacrane.cosim.system import System
from seacrane.errors import CosimError
from seacrane.units import UNITS

Indices = npt.NDArray[np.int64]

SIGNALS: Final = {"macro_step": "s", "iterations": "1", "rejected": "1", "coupling_error": "1"}
"""What an algorithm tells of itself, with its unit, in the order of the C loop: the last macro step, the iterations it
took, how many were repeated with a smaller size, and the error of the last one relative to the tolerated variable."""

NEXT_STEP, LAST_ERROR, GREATEST_POWER = range(3)
"""What a step size control keeps: the next step [ns], the error of the last, the greatest power of each bond [W]."""

WHENCE, FOR_STEP, JACOBIAN = range(3)
"""What Newton's method keeps: whence its Jacobian comes, for which step [ns], and the Jacobian by rows."""


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
    sources: Indices
    targets: Indices
    gains: Vector
    biases: Vector
    origins: Indices
    """The places in the order of the slaves that the sources belong to."""
    owed: Indices
    """Where in the values it is kept what the targets are owed; -1 where it is not."""
    adds: Indices
    """Of each connection, whether it adds to what an earlier one has brought to the same input."""
    substeps: int
    every: int
    watched: list[str] = field(default_factory=list)
    changes: slice = field(default_factory=lambda: slice(0, 0))
    """Into the changes of the plan: those of its inputs, then those of its outputs."""
    input_changes: int = 0
    output_changes: int = 0
    stopped: bool = False

    @property
    def driven(self) -> Indices:
        """The places of connected inputs among the inputs."""
        return np.array(sorted({k - self.inputs.start for k in self.targets.tolist()}), dtype=np.int64)


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
    effort_slave: int
    flow_slave: int
    effort_connection: int
    flow_connection: int


@dataclass
class Rows:
    """Rows of (time, values...) that the loops fill for a recorder: one each `stride` macro steps."""

    stride: int
    indices: Indices
    watches: bool
    table: Vector
    count: int = 0


class Plan:
    """The layout, the values themselves, and the count of macro steps `done` since `start_ns`.

    `sweeps` counts how often all slaves have been stepped, repeated steps included: what the run has cost. `repeats` is
    whether all slaves can be brought back to where a step began.
    """

    def __init__(self, system: System, schedule: Schedule, instances: dict[str, Instance], start_ns: int) -> None:
        self.schedule = schedule
        self.start_ns = start_ns
        # How many samples of each output are kept; none where inputs are outputs as they are.
        self.depth = schedule.degree + 1 if schedule.degree or schedule.iteration is not None else 0
        self.done = 0
        self.sweeps = 0
        self.repeats = False
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
        self._place = {name: i for i, name in enumerate(schedule.order)}
        self._variables = system.variables
        self._slave: Callable[[str], str] = lambda name: system.split(name)[0]
        self.watchable = {
            f"{name}.{v.name}": (name, v.name) for name, interface in interfaces.items() for v in interface.watchable
        }
        self._connect(system)
        self.nominal = np.array([abs(v.nominal) or 1.0 for name in schedule.order for v in interfaces[name].outputs])
        layout = self._layout(size, len(system.bonds))
        self.values: Vector = np.zeros(max(place.stop for place in layout.values()))
        self.samples = self.values[layout["samples"]].reshape(self.depth, self.nominal.size)
        self.times = self.values[layout["times"]].reshape(len(schedule.order), self.depth + 1)
        self.signals, self.controller, self.jacobian = (
            self.values[layout[name]] for name in ("signals", "controller", "jacobian")
        )
        self.index |= {name: layout["signals"].start + i for i, name in enumerate(SIGNALS)}
        owed = {}
        for i, missed in enumerate(system.bonds.values() if schedule.conserve else ()):
            for j, connection in enumerate(missed.connections):
                owed[connection.target] = layout["owed"].start + 2 * i + j
        incoming: dict[str, list[Connection]] = {name: [] for name in schedule.order}
        for connection in system.connections:
            incoming[self._slave(connection.target)].append(connection)
        self.parts = [
            self._part(name, interfaces[name], instances[name], places[name], incoming[name], owed)
            for name in schedule.order
        ]
        accounts = layout["accounts"].start
        targets = {k: i for i, k in enumerate(k for part in self.parts for k in part.targets.tolist())}
        self.bonds = [
            self._bond(bond, accounts + len(ACCOUNT) * i, targets) for i, bond in enumerate(system.bonds.values())
        ]
        for bond in self.bonds:
            self.index |= {f"{bond.name}.{q}": bond.account + i for i, q in enumerate(ACCOUNT)}
        for part in self.parts:
            part.instance.bind(self.values[part.inputs], self.values[part.outputs])
        self.groups = [np.array([self._place[name] for name in group], dtype=np.int64) for group in schedule.groups]

    @property
    def time_ns(self) -> int:
        return self.start_ns + self.done * self.schedule.step_ns

    @property
    def newton(self) -> bool:
        iteration = self.schedule.iteration
        return iteration is not None and isinstance(iteration.solver, Newton)

    @property
    def order(self) -> int:
        """The order of convergence that the step size control counts on."""
        return 2 if self.schedule.degree or self.schedule.conserve else 1

    def start(self) -> None:
        """The histories begin with the outputs as they are now."""
        self.restart()
        if self.depth:
            self.samples[0] = self.values[: self.nominal.size]
            self.times[:, -1] = 1

    def restart(self) -> None:
        """Something has jumped: what the outputs were before says nothing about what comes."""
        if self.depth:
            self.times[:, -1] = 0
        if (control := self.schedule.control) is not None:
            self.controller[NEXT_STEP], self.controller[LAST_ERROR] = control.smallest_ns, 1.0

    def unsettled(self, guess: Sequence[float] | Vector) -> list[int]:
        """The connected outputs that differ from a guess by more than is tolerated."""
        iteration = self.schedule.iteration
        assert iteration is not None
        value = self.values[self.coupled]
        tolerated = iteration.tolerance * np.maximum(np.abs(value), self.nominal[self.coupled])
        return [int(k) for k in self.coupled[~(np.abs(value - np.asarray(guess)) <= tolerated)]]

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

    @staticmethod
    def changed(change: np.void, t: float, raw: float | None = None) -> float:
        """What a change makes of its raw value, or of another one, at time `t` [s]."""
        value = float(change["gain"]) * float(change["raw"] if raw is None else raw) + float(change["bias"])
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

    def _connect(self, system: System) -> None:
        """The connected outputs, and the slaves they belong to."""
        sources = {c.source for c in system.connections}
        self.coupled: Indices = np.array(sorted(self.index[s] for s in sources), dtype=np.int64)
        slave = {self.index[s]: self._place[self._slave(s)] for s in sources}
        self.coupled_slave: Indices = np.array([slave[k] for k in self.coupled.tolist()], dtype=np.int64)

    def _layout(self, first: int, bonds: int) -> dict[str, slice]:
        """The places of what comes after the variables of the slaves."""
        schedule, slaves = self.schedule, len(self.schedule.order)
        if schedule.conserve and not bonds:
            raise CosimError.at("conserve", "needs a power bond in the system", hint="Connect with system.bond().")
        control = schedule.control
        if control is not None and isinstance(control.control, PowerResidual) and not bonds:
            hint = "Connect with system.bond(), or use StepDoubling()."
            raise CosimError.at("control", "PowerResidual needs a power bond in the system", hint=hint)
        sizes = {
            "accounts": len(ACCOUNT) * bonds,
            "signals": len(SIGNALS),
            "samples": self.depth * self.nominal.size,
            "times": (self.depth + 1) * slaves,
            "owed": 2 * bonds if schedule.conserve else 0,
            "controller": GREATEST_POWER + bonds if control is not None else 0,
            "jacobian": JACOBIAN + self.coupled.size**2 if self.newton else 0,
        }
        places = {}
        for name, size in sizes.items():
            places[name] = slice(first, first + size)
            first += size
        return places

    def _part(
        self,
        name: str,
        interface: Interface,
        instance: Instance,
        places: list[slice],
        incoming: list[Connection],
        owed: Mapping[str, int],
    ) -> Part:
        schedule = self.schedule
        gains = []
        for c in incoming:
            units = self._variables[c.source].unit, self._variables[c.target].unit
            gains.append(c.gain * (factor(*units) if c.convert else 1.0))
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
            origins=np.array([self._place[self._slave(c.source)] for c in incoming], dtype=np.int64),
            owed=np.array([owed.get(c.target, -1) for c in incoming], dtype=np.int64),
            adds=np.array([i != first[c.target] for i, c in enumerate(incoming)], dtype=np.int64),
            substeps=schedule.substeps.get(name, 1),
            every=schedule.every.get(name, 1),
        )

    def _bond(self, bond: Bond, account: int, targets: Mapping[int, int]) -> BondIndices:
        (effort_out, effort_in), (flow_out, flow_in) = bond.effort, bond.flow
        return BondIndices(
            bond.name,
            effort_out=self.index[effort_out],
            flow_in=self.index[flow_in],
            effort_in=self.index[effort_in],
            flow_out=self.index[flow_out],
            account=account,
            effort_side=self._factor(effort_out) * self._factor(flow_in),
            flow_side=self._factor(effort_in) * self._factor(flow_out),
            effort_slave=self._place[self._slave(effort_out)],
            flow_slave=self._place[self._slave(flow_out)],
            effort_connection=targets[self.index[effort_in]],
            flow_connection=targets[self.index[flow_in]],
        )

    def _factor(self, name: str) -> float:
        return UNITS[self._variables[name].unit].factor
