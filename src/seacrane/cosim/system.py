"""The structure of a coupled system, in names: slaves, sub-systems, connections and bonds. It runs nothing."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy.typing as npt

from seacrane.cosim.bonds import SIGNALS
from seacrane.cosim.slave import Slave
from seacrane.cosim.structure import (
    Bond,
    Connection,
    Connector,
    Experiment,
    Transformation,
    composed,
    factor,
    finite,
    is_power,
)
from seacrane.errors import CosimError, Problem, nearest
from seacrane.model.dae import Variable
from seacrane.units import UNITS, compatible

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
_WIDTH = ("Boolean", "Integer", "Real")
_SEEN_FROM_INSIDE = {"input": "output", "output": "input", "signal": "signal"}
"""The role of a system's own connector within it: what comes in is something to connect from."""


@dataclass
class Level:
    """What was put together in a system itself, in the order of doing so; what sub-systems hold is in them."""

    parts: dict[str, Slave | System] = field(default_factory=dict)
    connectors: dict[str, Connector] = field(default_factory=dict)
    connections: list[Connection | Transformation] = field(default_factory=list)
    bonds: dict[str, Bond] = field(default_factory=dict)


class System:
    """Slaves and sub-systems by name with their connections and bonds.

    Built step by step with `add`, `expose`, `connect`, `transform` and `bond`, each of which refuses with `CosimError`
    what is wrong and then leaves the system as it was; or given as a whole, and then everything that is wrong is told
    at once. Parts have names of letters, digits, `_` and `-`. A variable is addressed as `<slave>.<variable>`, in a
    sub-system as `<system>.<slave>.<variable>`, and a connector of a sub-system as `<system>.<connector>`.

    A system that is added to another is taken as it stands then.
    """

    def __init__(
        self,
        name: str = "system",
        slaves: Mapping[str, Slave | System] | None = None,
        connections: Iterable[Connection | Transformation] = (),
        bonds: Iterable[Bond] = (),
        connectors: Iterable[Connector] = (),
        experiment: Experiment | None = None,
        about: str = "",
        notes: Iterable[str] = (),
    ) -> None:
        self.name = name
        self.about = about
        self.notes = tuple(notes)
        self.experiment = experiment or Experiment()
        self._level = Level()
        self._slaves: dict[str, Slave] = {}
        self._bonds: dict[str, Bond] = {}
        self._variables: dict[str, tuple[str, Variable]] = {}
        self._owners: dict[str, str] = {}
        self._points: dict[str, Connector] = {}
        self._into: dict[str, tuple[Connection, ...]] = {}
        self._resolved: tuple[Connection, ...] | None = None
        problems: list[Problem] = []
        for part_name, part in (slaves or {}).items():
            problems += self._try_add(part_name, part)
        for connector in connectors:
            problems += self._try_declare(connector)
        for connection in connections:
            problems += self._try_connect((connection,))
        for bond in bonds:
            problems += self._try_bond(bond)
        if problems:
            raise CosimError(problems)

    # ------------------------------------------------------------ as it runs: all slaves, whatever system they are in
    @property
    def slaves(self) -> Mapping[str, Slave]:
        """In the order of adding, those of sub-systems as `<system>.<slave>`."""
        return MappingProxyType(self._slaves)

    @property
    def connections(self) -> tuple[Connection, ...]:
        """All connections from slave to slave, through connectors and in bonds too; those into one input add up."""
        if self._resolved is None:
            self._resolved = tuple(c for target in self._into if target in self._variables for c in self._trace(target))
        return self._resolved

    @property
    def bonds(self) -> Mapping[str, Bond]:
        """All bonds from slave to slave, those of sub-systems as `<system>.<bond>`."""
        return MappingProxyType(self._bonds)

    @property
    def variables(self) -> dict[str, Variable]:
        """All variables by their full name `<slave>.<variable>`, and `<bond>.<quantity>`."""
        own = {name: variable for name, (_, variable) in self._variables.items()}
        own |= {f"{b}.{q}": Variable(f"{b}.{q}", unit) for b in self._bonds for q, unit in SIGNALS.items()}
        return own

    @property
    def causalities(self) -> dict[str, str]:
        """`input`, `output`, `parameter`, `watchable` or `bond` of each of the variables."""
        return {name: self._variables[name][0] if name in self._variables else "bond" for name in self.variables}

    @property
    def open_inputs(self) -> tuple[str, ...]:
        """Inputs of slaves that nothing drives: they keep their start values unless they are set."""
        driven = {c.target for c in self.connections}
        return tuple(n for n, (causality, _) in self._variables.items() if causality == "input" and n not in driven)

    def causality(self, name: str) -> str:
        """`input`, `output`, `parameter`, `watchable` or `bond` of a variable; `CosimError` if there is none."""
        found = self.causalities.get(name)
        if found is None:
            raise CosimError(self._unknown(name))
        return found

    def split(self, name: str) -> tuple[str, str]:
        """The slave of a variable, and the name that the variable has in it; `CosimError` if there is none."""
        if name not in self._owners:
            raise CosimError(self._unknown(name))
        slave = self._owners[name]
        return slave, name[len(slave) + 1 :]

    def source_of(self, target: str) -> str | None:
        """The output that drives an input, the first of several that add up, or None if nothing does."""
        return next((c.source for c in self._trace(target)), None)

    def behind(self, connector: str) -> tuple[Connection, ...]:
        """What a connector of this system leads to: the inputs that it drives, or the outputs that drive it."""
        if connector not in self._level.connectors:
            raise CosimError.at(connector, "is no connector", hint=nearest(connector, self._level.connectors))
        if self._points[connector].kind == "output":
            return tuple(self._trace(connector))
        return tuple(c for target in self._ends(connector) for c in self._trace(target, connector))

    @property
    def settable_connectors(self) -> dict[str, tuple[tuple[str, float, float], ...]]:
        """For each input connector of this system, what it drives: (input, factor, bias), from unit to unit."""
        found = {}
        for name, connector in self._level.connectors.items():
            if connector.kind == "input":
                found[name] = tuple((c.target, self._scale(c), c.bias) for c in self.behind(name))
        return found

    def _scale(self, connection: Connection) -> float:
        """What a number in the unit of the source is multiplied by."""
        units = self._unit(connection.source), self._unit(connection.target)
        return connection.gain * (factor(*units) if connection.convert else 1.0)

    def unit_of(self, name: str) -> str:
        """The unit of a variable or connector; empty if there is none, or if it is not known yet."""
        return self._unit(name) if name in self._variables or name in self._points else ""

    # ------------------------------------------------------------ as it was put together
    @property
    def level(self) -> Level:
        """What was put together in this system itself; to read, not to change."""
        return self._level

    def add(self, name: str, part: Slave | System) -> None:
        """Add a slave or a sub-system under a name that nothing else has."""
        _refuse(self._try_add(name, part))

    def expose(self, name: str, *variables: str) -> None:
        """Make a connector of this system: of inputs that are driven together, or of one output."""
        if not variables:
            raise CosimError.at(name, "exposes nothing", allowed="inputs, or one output")
        roles = {self._role(v) for v in variables}
        if roles == {"input"}:
            links = [Connection(name, variable) for variable in variables]
            connector = Connector(name, "input", self._unit(variables[0]))
        elif roles == {"output"} and len(variables) == 1:
            links = [Connection(variables[0], name)]
            connector = Connector(name, "output", self._unit(variables[0]))
        else:
            unknown = [self._unknown(v) for v in variables if self._role(v) is None]
            raise CosimError(unknown or [Problem(name, "cannot expose these", variables, "inputs, or one output")])
        _refuse(self._try_declare(connector))
        problems = self._try_connect(links)
        if problems:
            del self._points[name], self._level.connectors[name]
        _refuse(problems)

    def connect(self, source: str, *targets: str, gain: float = 1.0, bias: float = 0.0, convert: bool = True) -> None:
        """Connect an output to inputs: target = source * gain + bias, with `bias` in the unit of the target.

        Units of one dimension are converted, unless `convert` is false: then the numbers are taken as they stand. All
        targets are connected or none.
        """
        if not targets:
            raise CosimError.at(source, "is connected to nothing", allowed="one input or more")
        _refuse(self._try_connect([Connection(source, target, gain, bias, convert) for target in targets]))

    def transform(
        self,
        sources: Sequence[str],
        targets: Sequence[str],
        matrix: npt.ArrayLike,
        bias: npt.ArrayLike | None = None,
        *,
        convert: bool = True,
    ) -> None:
        """Connect several outputs to several inputs: targets = matrix @ sources + bias.

        `matrix` has shape (targets, sources) and `bias` (targets,), in the units of the targets. `Transformation` says
        how units are converted.
        """
        _refuse(self._try_connect([Transformation.of(sources, targets, matrix, bias, convert)]))

    def bond(self, name: str, *, effort: tuple[str, str], flow: tuple[str, str], gain: float = 1.0) -> None:
        """Make the two connections of a power bond; effort and flow are pairs (source output, target input).

        Both are multiplied by `gain`: -1 where the sides count their flow in opposite directions.
        """
        _refuse(self._try_bond(Bond(name, effort, flow, gain)))

    # ------------------------------------------------------------ checks; what passes is taken in
    def _try_add(self, name: str, part: Slave | System) -> list[Problem]:
        problems = self._name_problems(name, "slave")
        if problems:
            return problems
        if isinstance(part, System):
            self._take_in(name, part)
            return []
        interface = part.interface
        groups = {
            "input": interface.inputs,
            "output": interface.outputs,
            "parameter": interface.parameters,
            "watchable": interface.watchable,
        }
        variables: dict[str, tuple[str, Variable]] = {}
        for causality, group in groups.items():
            for variable in group:
                full = f"{name}.{variable.name}"
                if full in variables:
                    problems.append(Problem(full, "is the name of two variables"))
                if variable.unit not in UNITS:
                    hint = nearest(variable.unit, UNITS)
                    problems.append(Problem(full, "has an unknown unit", variable.unit, hint=hint))
                variables[full] = (causality, variable)
        if not problems:
            self._level.parts[name] = part
            self._slaves[name] = part
            self._variables |= variables
            self._owners |= dict.fromkeys(variables, name)
        return problems

    def _take_in(self, name: str, part: System) -> None:
        def full(inner: str) -> str:
            return f"{name}.{inner}"

        self._level.parts[name] = part._snapshot()
        self._slaves |= {full(n): slave for n, slave in part._slaves.items()}
        self._variables |= {full(n): v for n, v in part._variables.items()}
        self._owners |= {full(n): full(slave) for n, slave in part._owners.items()}
        self._points |= {full(n): connector for n, connector in part._points.items()}
        for target, terms in part._into.items():
            self._into[full(target)] = tuple(replace(c, source=full(c.source), target=full(c.target)) for c in terms)
        for n, b in part._bonds.items():
            ends = ((full(b.effort[0]), full(b.effort[1])), (full(b.flow[0]), full(b.flow[1])))
            self._bonds[full(n)] = Bond(full(n), *ends, b.gain)
        self._resolved = None

    def _snapshot(self) -> System:
        """This system as it stands now, whatever is done to it later."""
        taken = copy(self)
        taken._level = Level(**{name: copy(value) for name, value in vars(self._level).items()})
        for name in ("_slaves", "_bonds", "_variables", "_owners", "_points", "_into"):
            setattr(taken, name, dict(getattr(self, name)))
        return taken

    def _try_declare(self, connector: Connector) -> list[Problem]:
        name = connector.name
        if name in self._points or name in self._variables:
            return [Problem(name, "there is something of this name already, so it cannot be a connector")]
        if not name or name != name.strip():
            return [Problem(name, "is no name for a connector")]
        if connector.unit and connector.unit not in UNITS:
            return [Problem(name, "has an unknown unit", connector.unit, hint=nearest(connector.unit, UNITS))]
        self._level.connectors[name] = self._points[name] = connector
        return []

    def _try_connect(self, made: Sequence[Connection | Transformation]) -> list[Problem]:
        problems = self._checked(made)
        if not problems:
            self._level.connections += made
            self._join(made)
        return problems

    def _try_bond(self, bond: Bond) -> list[Problem]:
        problems = self._name_problems(bond.name, "bond")
        wrong = self._checked(bond.connections)
        problems += wrong or self._power_problems(bond)
        if not problems:
            resolved = Bond(bond.name, self._innermost(*bond.effort), self._innermost(*bond.flow), bond.gain)
            missing = [n for pair in (resolved.effort, resolved.flow) for n in pair if n not in self._variables]
            problems = [
                Problem(bond.name, f"connector {n!r} must lead to one slave for a bond to end there") for n in missing
            ]
        if not problems:
            self._level.bonds[bond.name] = bond
            self._join(bond.connections)
            self._bonds[bond.name] = resolved
        return problems

    def _join(self, made: Iterable[Connection | Transformation]) -> None:
        for connection in (term for entry in made for term in entry.terms):
            for end, other in ((connection.source, connection.target), (connection.target, connection.source)):
                if end in self._points and not self._points[end].unit:
                    self._points[end] = replace(self._points[end], unit=self._unit(other))
            self._into[connection.target] = (*self._into.get(connection.target, ()), connection)
        self._resolved = None

    def _name_problems(self, name: str, what: str) -> list[Problem]:
        if not _NAME.fullmatch(name):
            allowed = "letters, digits, _ and -, not beginning with a digit"
            return [Problem(name, f"is no name for a {what}", allowed=allowed)]
        for kind, there in (
            ("bond", self._level.bonds),
            ("sub-system" if isinstance(self._level.parts.get(name), System) else "slave", self._level.parts),
        ):
            if name in there:
                return [Problem(name, f"there is a {kind} of this name already")]
        return []

    def _checked(self, made: Iterable[Connection | Transformation]) -> list[Problem]:
        """What is wrong with new connections."""
        problems: list[Problem] = []
        new: dict[str, str] = {}
        for entry in made:
            sources = {c.source: self._end(c.source, "output", problems) for c in entry.terms}
            told = set()
            for connection in entry.terms:
                source = sources[connection.source]
                first = connection.target not in told
                target = self._end(connection.target, "input", problems if first else [])
                driver = new.get(connection.target) or self._driver(connection.target)
                if first and target is not None and driver:
                    problems.append(Problem(connection.target, f"is driven by {driver!r} already", connection.source))
                told.add(connection.target)
                if source and target and connection.convert and not compatible(source, target):
                    message = f"is in {target!r} and cannot take {connection.source!r}, which is in {source!r}"
                    problems.append(Problem(connection.target, message))
                if source is not None and target is not None:
                    problems += self._kind_problems(connection)
                if not finite(connection):
                    message = "the gain and the bias of its connection must be finite"
                    problems.append(Problem(connection.target, message, (connection.gain, connection.bias)))
                if connection.target in self._points and connection.source in self._ends(connection.target, True):
                    problems.append(Problem(connection.target, "drives itself", connection.source))
            new |= {c.target: c.source for c in reversed(entry.terms)}
        return list(dict.fromkeys(problems))

    def _driver(self, target: str) -> str:
        """What is connected to a name at this level of the structure, the first of several; empty if nothing is."""
        return self._into[target][0].source if target in self._into else ""

    def _kind_problems(self, connection: Connection) -> list[Problem]:
        """A number of a wider type does not go into one of a narrower type, unless it is taken as it stands."""
        sources, targets = [connection.source], [connection.target]
        if connection.source in self._points:
            sources = [c.source for c in self._trace(connection.source)]
        if connection.target in self._points:
            targets = self._ends(connection.target)
        return [
            Problem(target, f"is of type {taken} and cannot take {source!r}, which is of type {given}")
            for source in sources
            for target in targets
            if (given := self._kind(source)) and (taken := self._kind(target)) and connection.convert
            if _WIDTH.index(given) > _WIDTH.index(taken)
        ]

    def _kind(self, name: str) -> str:
        """Real, Integer or Boolean, where the type of a variable is fixed."""
        if name not in self._variables:
            return ""
        slave, variable = self.split(name)
        return self._slaves[slave].interface.kinds.get(variable, "")

    def _role(self, name: str) -> str | None:
        """What a name is to this system: an `output` to connect from, an `input` to connect to, ..."""
        if name in self._variables:
            return self._variables[name][0]
        if name in self._level.connectors:
            return _SEEN_FROM_INSIDE[self._points[name].kind]
        point = self._points.get(name)
        return None if point is None else "inner signal" if point.kind == "signal" else point.kind

    def _unit(self, name: str) -> str:
        return self._variables[name][1].unit if name in self._variables else self._points[name].unit

    def _end(self, name: str, wanted: str, problems: list[Problem]) -> str | None:
        """The unit at an end of a connection, if it exists and has the right role; empty if it is open."""
        found = self._role(name)
        if found is None:
            problems.append(self._unknown(name, wanted))
            return None
        if found in (wanted, "signal"):
            return self._unit(name)
        article = "an" if found[0] in "aeiou" else "a"
        what = f"{article} {found} variable"
        if name in self._level.connectors:
            what = f"an {self._points[name].kind} of the system itself"
        role = "start" if wanted == "output" else "end"
        message = f"is {what}; a connection must {role} at an {wanted}"
        part = self._owners.get(name, name.partition(".")[0])
        problems.append(Problem(name, message, hint=nearest(name, self._of(part, wanted))))
        return None

    def _of(self, part: str, role: str | None = None) -> list[str]:
        """Full names of the variables and connectors of a part."""
        prefix = f"{part}."
        names = [n for n in (*self._variables, *self._points) if n.startswith(prefix)]
        return [n for n in names if role in (None, self._role(n))]

    def _unknown(self, name: str, role: str | None = None) -> Problem:
        part, dot, rest = name.partition(".")
        if not dot:
            hint = nearest(name, self._level.connectors) if self._level.connectors else None
            return Problem(name, "is not the name of a variable", allowed="<slave>.<variable>", hint=hint)
        if part in self._bonds:
            return Problem(name, "a bond has no such quantity", hint=nearest(name, [f"{part}.{q}" for q in SIGNALS]))
        if part not in self._level.parts:
            return Problem(name, f"there is no slave {part!r}", hint=nearest(part, self._level.parts))
        if isinstance(self._level.parts[part], System):
            within = max((s for s in self._slaves if name.startswith(f"{s}.")), key=len, default=part)
            return Problem(name, f"{within!r} has no such variable", hint=nearest(name, self._of(within, role)))
        kind = self._slaves[part].interface.left_out.get(rest)
        if kind is not None:
            return Problem(name, f"cannot be connected: {kind}", allowed="real scalars in a unit that is known")
        return Problem(name, f"slave {part!r} has no such variable", hint=nearest(name, self._of(part, role)))

    def _power_problems(self, bond: Bond) -> list[Problem]:
        problems = []
        given, taken = self._innermost(*bond.effort)
        back, moved = self._innermost(*bond.flow)
        sides = (
            ("effort's", bond.effort[0], bond.flow[1], given, moved),
            ("flow's", bond.effort[1], bond.flow[0], taken, back),
        )
        for side, effort, flow, *inner in sides:
            owners = {self._owners.get(n, n.partition(".")[0]) for n in inner}
            if len(owners) > 1 and self._points.keys().isdisjoint(inner):
                message = f"the effort and the flow at the {side} side belong to different slaves: {effort!r}, {flow!r}"
                problems.append(Problem(bond.name, message))
            elif not is_power(self._unit(effort) or "1", self._unit(flow) or "1"):
                product = f"{self._unit(effort)} * {self._unit(flow)}"
                message = f"the product of {effort!r} and {flow!r} is not power"
                problems.append(
                    Problem(bond.name, message, product, "effort * flow in W, such as N * m/s or Pa * m3/s")
                )
        return problems

    # ------------------------------------------------------------ through connectors
    def _trace(self, target: str, until: str = "") -> list[Connection]:
        """What drives a name: connections that start at slaves, or at the connector `until`."""
        found = []
        for connection in self._into.get(target, ()):
            if connection.source in self._variables or connection.source == until:
                found.append(connection)
                continue
            for before in self._trace(connection.source, until):
                units = (self._unit(before.source), self._unit(connection.source), self._unit(target))
                found.append(composed(before, connection, units))
        return found

    def _ends(self, point: str, points: bool = False) -> list[str]:
        """The inputs of slaves that a connector drives; with `points` the connectors on the way too, and itself."""
        reached, waiting = [point], [point]
        while waiting:
            here = waiting.pop()
            onward = [t for t, terms in self._into.items() if any(c.source == here for c in terms) and t not in reached]
            reached += onward
            waiting += [t for t in onward if t in self._points]
        return [n for n in reached if points or n in self._variables]

    def _innermost(self, source: str, target: str) -> tuple[str, str]:
        """The slaves' variables at the ends of a connection between connectors, where there is one of each."""
        if source in self._points:
            behind = self._trace(source)
            source = behind[0].source if len(behind) == 1 else source
        if target in self._points:
            ahead = self._ends(target)
            target = ahead[0] if len(ahead) == 1 else target
        return source, target


def _refuse(problems: list[Problem]) -> None:
    if problems:
        raise CosimError(problems)
