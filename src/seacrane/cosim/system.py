"""The structure of a coupled system, in names: slaves, connections and bonds. It runs nothing and holds no state."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType

from seacrane.cosim.bonds import SIGNALS
from seacrane.cosim.slave import Slave
from seacrane.errors import CosimError, Problem, nearest
from seacrane.model.dae import Variable
from seacrane.units import UNITS, compatible

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
_WATT = UNITS["W"]


@dataclass(frozen=True)
class Connection:
    """target = source * gain + bias, after conversion to the unit of the target; both are `<slave>.<variable>`."""

    source: str
    target: str
    gain: float = 1.0
    bias: float = 0.0


@dataclass(frozen=True)
class Bond:
    """Two connections whose product is power: `effort` leaves the one side and `flow` the other.

    Each is a pair (source output, target input), `<slave>.<variable>`.
    """

    name: str
    effort: tuple[str, str]
    flow: tuple[str, str]

    @property
    def connections(self) -> tuple[Connection, Connection]:
        return Connection(*self.effort), Connection(*self.flow)


class System:
    """Slaves by name with their connections and bonds.

    Built step by step with `add`, `connect` and `bond`, each of which refuses with `CosimError` what is wrong and
    then leaves the system as it was; or given as a whole, and then everything that is wrong is told at once. Slaves
    have names of letters, digits, `_` and `-`; a variable is addressed as `<slave>.<variable>`.
    """

    def __init__(
        self,
        name: str = "system",
        slaves: Mapping[str, Slave] | None = None,
        connections: Iterable[Connection] = (),
        bonds: Iterable[Bond] = (),
    ) -> None:
        self.name = name
        self._slaves: dict[str, Slave] = {}
        self._connections: list[Connection] = []
        self._bonds: dict[str, Bond] = {}
        self._sources: dict[str, str] = {}
        self._variables: dict[str, tuple[str, Variable]] = {}
        problems: list[Problem] = []
        for slave_name, slave in (slaves or {}).items():
            problems += self._try_add(slave_name, slave)
        for connection in connections:
            problems += self._try_connect((connection,))
        for bond in bonds:
            problems += self._try_bond(bond)
        if problems:
            raise CosimError(problems)

    @property
    def slaves(self) -> Mapping[str, Slave]:
        """In the order of adding."""
        return MappingProxyType(self._slaves)

    @property
    def connections(self) -> tuple[Connection, ...]:
        """All connections, those of bonds included."""
        return tuple(self._connections)

    @property
    def bonds(self) -> Mapping[str, Bond]:
        return MappingProxyType(self._bonds)

    @property
    def variables(self) -> dict[str, Variable]:
        """All variables by their full name `<slave>.<variable>`, and `<bond>.<quantity>`."""
        own = {name: variable for name, (_, variable) in self._variables.items()}
        own |= {f"{b}.{q}": Variable(f"{b}.{q}", unit) for b in self._bonds for q, unit in SIGNALS.items()}
        return own

    def causality(self, name: str) -> str:
        """`input`, `output`, `parameter`, `watchable` or `bond` of a variable; `CosimError` if there is none."""
        if name in self._variables:
            return self._variables[name][0]
        if name in self.variables:
            return "bond"
        raise CosimError(self._unknown(name))

    def source_of(self, target: str) -> str | None:
        """The output that drives an input, or None if nothing does."""
        return self._sources.get(target)

    def add(self, name: str, slave: Slave) -> None:
        """Add a slave under a name that no other slave or bond has."""
        _refuse(self._try_add(name, slave))

    def connect(self, source: str, *targets: str, gain: float = 1.0, bias: float = 0.0) -> None:
        """Connect an output to inputs: target = source * gain + bias, with `bias` in the unit of the target.

        Units of one dimension are converted. All targets are connected or none.
        """
        if not targets:
            raise CosimError.at(source, "is connected to nothing", allowed="one input or more")
        _refuse(self._try_connect(tuple(Connection(source, target, gain, bias) for target in targets)))

    def bond(self, name: str, *, effort: tuple[str, str], flow: tuple[str, str]) -> None:
        """Make the two connections of a power bond; effort and flow are pairs (source output, target input)."""
        _refuse(self._try_bond(Bond(name, effort, flow)))

    # ------------------------------------------------------------ checks; what passes is taken in
    def _try_add(self, name: str, slave: Slave) -> list[Problem]:
        problems = self._name_problems(name, "slave")
        interface = slave.interface
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
            self._slaves[name] = slave
            self._variables |= variables
        return problems

    def _try_connect(self, connections: tuple[Connection, ...]) -> list[Problem]:
        problems, sources = self._checked(connections)
        if not problems:
            self._connections += connections
            self._sources = sources
        return problems

    def _try_bond(self, bond: Bond) -> list[Problem]:
        problems = self._name_problems(bond.name, "bond")
        wrong, sources = self._checked(bond.connections)
        problems += wrong or self._power_problems(bond)
        if not problems:
            self._connections += bond.connections
            self._sources = sources
            self._bonds[bond.name] = bond
        return problems

    def _name_problems(self, name: str, what: str) -> list[Problem]:
        if not _NAME.fullmatch(name):
            allowed = "letters, digits, _ and -, not beginning with a digit"
            return [Problem(name, f"is no name for a {what}", allowed=allowed)]
        if name in self._slaves or name in self._bonds:
            return [Problem(name, f"there is a {'slave' if name in self._slaves else 'bond'} of this name already")]
        return []

    def _checked(self, connections: Iterable[Connection]) -> tuple[list[Problem], dict[str, str]]:
        """What is wrong with new connections, and the sources of all inputs as they would be with them."""
        problems: list[Problem] = []
        sources = dict(self._sources)
        for connection in connections:
            source = self._end(connection.source, "output", problems)
            target = self._end(connection.target, "input", problems)
            driver = sources.setdefault(connection.target, connection.source)
            if target is not None and (connection.target in self._sources or driver != connection.source):
                problems.append(Problem(connection.target, f"is driven by {driver!r} already", connection.source))
            if source is not None and target is not None and not compatible(source.unit, target.unit):
                message = f"is in {target.unit!r} and cannot take {connection.source!r}, which is in {source.unit!r}"
                problems.append(Problem(connection.target, message))
            if not (math.isfinite(connection.gain) and math.isfinite(connection.bias)):
                message = "the gain and the bias of its connection must be finite"
                problems.append(Problem(connection.target, message, (connection.gain, connection.bias)))
        return problems, sources

    def _end(self, name: str, causality: str, problems: list[Problem]) -> Variable | None:
        """The variable at an end of a connection, if it exists and has the right causality."""
        if name not in self._variables:
            problems.append(self._unknown(name, causality))
            return None
        found, variable = self._variables[name]
        if found == causality:
            return variable
        article = "an" if found in ("input", "output") else "a"
        role = "start" if causality == "output" else "end"
        message = f"is {article} {found} variable; a connection must {role} at an {causality}"
        problems.append(Problem(name, message, hint=nearest(name, self._of(name.partition(".")[0], causality))))
        return None

    def _of(self, slave: str, causality: str | None = None) -> list[str]:
        """Full names of the variables of a slave."""
        prefix = f"{slave}."
        return [n for n, (c, _) in self._variables.items() if n.startswith(prefix) and causality in (None, c)]

    def _unknown(self, name: str, causality: str | None = None) -> Problem:
        slave, dot, _ = name.partition(".")
        if not dot:
            return Problem(name, "is not the name of a variable", allowed="<slave>.<variable>")
        if slave in self._bonds:
            return Problem(name, "a bond has no such quantity", hint=nearest(name, [f"{slave}.{q}" for q in SIGNALS]))
        if slave not in self._slaves:
            return Problem(name, f"there is no slave {slave!r}", hint=nearest(slave, self._slaves))
        return Problem(name, f"slave {slave!r} has no such variable", hint=nearest(name, self._of(slave, causality)))

    def _power_problems(self, bond: Bond) -> list[Problem]:
        problems = []
        sides = (("effort's", bond.effort[0], bond.flow[1]), ("flow's", bond.effort[1], bond.flow[0]))
        for side, effort, flow in sides:
            if effort.partition(".")[0] != flow.partition(".")[0]:
                message = f"the effort and the flow at the {side} side belong to different slaves: {effort!r}, {flow!r}"
                problems.append(Problem(bond.name, message))
            elif not _is_power(self._variables[effort][1].unit, self._variables[flow][1].unit):
                product = f"{self._variables[effort][1].unit} * {self._variables[flow][1].unit}"
                message = f"the product of {effort!r} and {flow!r} is not power"
                problems.append(
                    Problem(bond.name, message, product, "effort * flow in W, such as N * m/s or Pa * m3/s")
                )
        return problems


def _is_power(effort: str, flow: str) -> bool:
    """Whether the product of two units is power; angles count as numbers."""
    exponents = zip(UNITS[effort].dimension[:3], UNITS[flow].dimension[:3], _WATT.dimension[:3], strict=True)
    return all(e + f == w for e, f, w in exponents)


def _refuse(problems: list[Problem]) -> None:
    if problems:
        raise CosimError(problems)
