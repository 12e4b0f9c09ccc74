"""A diagram laid flat: the variables and equations of all its components and nodes, side by side.

Union-find puts connected ports on nodes. A node has one symbol for its across variable; its through variables sum to
zero (two ports: the second is minus the first; more: an equation).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import casadi as ca

from seacrane.errors import Problem, StructureError
from seacrane.units import UNITS, display

from .component import check_value, shared_default, symbolic_twin
from .dae import Variable
from .diagram import Diagram, PortHandle
from .ports import PowerPort, SignalIn, SignalOut


@dataclass(frozen=True)
class Equation:
    """`residual` = 0, stated by `origin`: the path of a component, or the ports of a node."""

    residual: Any
    origin: str


@dataclass(frozen=True)
class Unknown:
    """A symbol to be solved for: a derivative of a state, a port variable, a signal or an unknown of a component.

    `state` is the state whose derivative it is. `shown`: whether the user should see it (derivatives are not shown).
    """

    variable: Variable
    symbol: Any
    state: str | None = None
    shown: bool = True


class Flat:
    """All variables and equations of a diagram, side by side: what joining gives and matching takes."""

    def __init__(self) -> None:
        self.t = ca.SX.sym("t")
        self.states: dict[str, tuple[Variable, Any]] = {}
        self.unknowns: dict[str, Unknown] = {}
        self.inputs: dict[str, tuple[Variable, Any]] = {}
        self.parameters: dict[str, tuple[Variable, Any]] = {}
        self.outputs: dict[str, tuple[Variable, Any]] = {}
        self.observables: dict[str, tuple[Variable, Any]] = {}
        self.equations: list[Equation] = []
        self.sources: list[str] = []

    def unknown(self, variable: Variable, state: str | None = None) -> Any:
        symbol = ca.SX.sym(variable.name)
        self.unknowns[variable.name] = Unknown(variable, symbol, state, shown=state is None)
        return symbol


class PortVariables:
    """The variables of one power port, by their letters: `m.a.p`, `m.a.q`."""

    def __init__(self, port: PowerPort, across: Any, through: Any) -> None:
        setattr(self, port.across, across)
        setattr(self, port.through, through)
        self.power = across * through


class Equations:
    """What a law is written with: the ports of one component, its states, and what it reports.

    `stores(power)`, `dissipates(power)` and `supplies(power)` account for the power into the ports:
    sum of port powers = stored + dissipated - supplied. They become the observables `stored_power`, `lost_power` and
    `supplied_power`.
    """

    def __init__(self, flat: Flat, path: str, ports: dict[str, Any]) -> None:
        self._flat, self._path = flat, path
        self.ports = ports
        self._ders: dict[str, Any] = {}
        self._account: dict[str, Any] = {}

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["ports"][name]
        except KeyError:
            raise AttributeError(f"{self._path} has no port {name!r}") from None

    @property
    def time(self) -> Any:
        return self._flat.t

    def state(
        self, name: str, *, unit: str, start: float = 0.0, nominal: float = 1.0, about: str = "", shown: str = ""
    ) -> Any:
        """A new state; its rate is `m.der(state)`."""
        path = f"{self._path}.{name}"
        symbol = ca.SX.sym(path)
        variable = Variable(path, unit, float(start), nominal, about=about, shown=shown)
        self._flat.states[path] = (variable, symbol)
        self._ders[path] = self._flat.unknown(Variable(f"der({path})", "1", about=f"rate of {path}"), path)
        return symbol

    def der(self, state: Any) -> Any:
        """The time derivative of a state of this component."""
        return self._ders[state.name()]

    def unknown(self, name: str, *, unit: str = "1", start: float = 0.0, nominal: float = 1.0, about: str = "") -> Any:
        """A new algebraic unknown, determined by an equation of the law."""
        return self._flat.unknown(Variable(f"{self._path}.{name}", unit, start, nominal, about=about))

    def observe(self, name: str, expression: Any, unit: str = "1", about: str = "", shown: str = "") -> None:
        """A named quantity to look at; it determines nothing."""
        path = f"{self._path}.{name}"
        self._flat.observables[path] = (Variable(path, unit, about=about, shown=shown), ca.SX(expression))

    def stores(self, power: Any) -> None:
        self._add("stored_power", power, "power that goes into storage")

    def dissipates(self, power: Any) -> None:
        self._add("lost_power", power, "power turned into heat")

    def supplies(self, power: Any) -> None:
        self._add("supplied_power", power, "power that comes from outside the diagram")

    def _add(self, name: str, power: Any, about: str) -> None:
        self._account[name] = self._account.get(name, 0) + power
        self.observe(name, self._account[name], "W", about)


def flatten(diagram: Diagram) -> Flat:
    """All equations and unknowns of the diagram; raises with every fault of the connections at once."""
    flat = Flat()
    nodes = _nodes(diagram)
    problems = [*_loose_ends(diagram, nodes)]
    if problems:
        raise StructureError(problems)
    across: dict[str, Any] = {}
    through: dict[str, Any] = {}
    signals: dict[str, Any] = {}
    exposed_name = {handle.path: name for name, handle in diagram.exposed.items()}
    for node in nodes:
        if isinstance(node[0].port, PowerPort):
            _power_node(flat, node, exposed_name, across, through)
        else:
            _signal_node(flat, node, exposed_name, signals)
    for name, part in diagram.parts.items():
        component = part.component
        ports = {
            key: PortVariables(port, across[f"{name}.{key}"], through[f"{name}.{key}"])
            if isinstance(port, PowerPort)
            else signals[f"{name}.{key}"]
            for key, port in component.interface().items()
        }
        equations = Equations(flat, name, ports)
        twin = symbolic_twin(component, _parameter_symbols(flat, diagram, name, component))
        for left, right in twin.equations(equations):
            flat.equations.append(Equation(left - right, name))
        flat.sources += [s for s in component.sources if s not in flat.sources]
    return flat


def _nodes(diagram: Diagram) -> list[list[PortHandle]]:
    """Ports grouped by connection (union-find), in order of appearance; lone ports are groups of one."""
    handles = {handle.path: handle for part in diagram.parts.values() for handle in part}
    parent = {path: path for path in handles}

    def find(path: str) -> str:
        while parent[path] != path:
            parent[path] = parent[parent[path]]
            path = parent[path]
        return path

    for connection in diagram.connections:
        for handle in connection[1:]:
            parent[find(handle.path)] = find(connection[0].path)
    groups: dict[str, list[PortHandle]] = {}
    for path, handle in handles.items():
        groups.setdefault(find(path), []).append(handle)
    return list(groups.values())


def _loose_ends(diagram: Diagram, nodes: list[list[PortHandle]]) -> Iterator[Problem]:
    exposed = {handle.path for handle in diagram.exposed.values()}
    if not diagram.parts:
        yield Problem(diagram.name, "is empty")
    for node in nodes:
        outputs = [h.path for h in node if isinstance(h.port, SignalOut)]
        if len(outputs) > 1:
            yield Problem(node[0].path, f"is driven by several outputs: {', '.join(outputs)}")
        if len(node) > 1 or node[0].path in exposed or isinstance(node[0].port, SignalOut):
            continue
        what = "is given no signal" if isinstance(node[0].port, SignalIn) else "is connected to nothing"
        hint = (
            "Connect it, or expose it." if isinstance(node[0].port, SignalIn) else "Connect it, expose it, or plug it."
        )
        yield Problem(f"{diagram.name}.{node[0].path}", what, hint=hint)


def _power_node(
    flat: Flat, node: list[PortHandle], exposed: dict[str, str], across: dict[str, Any], through: dict[str, Any]
) -> None:
    port = node[0].port
    assert isinstance(port, PowerPort)
    outside = [exposed[h.path] for h in node if h.path in exposed]
    first = f"{node[0].path}.{port.across}"
    if outside:
        name = f"{outside[0]}.{port.across}"
        symbol = ca.SX.sym(name)
        flat.inputs[name] = (Variable(name, port.across_unit, about=f"given at {node[0].path}"), symbol)
    else:
        symbol = flat.unknown(Variable(first, port.across_unit, nominal=port.across_nominal))
    for handle in node:
        across[handle.path] = symbol
        path = f"{handle.path}.{port.across}"
        if outside or path != first:
            flat.observables[path] = (Variable(path, port.across_unit), symbol)
    flows: list[Any] = []
    for handle in node:
        path = f"{handle.path}.{port.through}"
        if len(node) == 2 and not outside and flows:
            through[handle.path] = -flows[0]
            flat.observables[path] = (Variable(path, port.through_unit), -flows[0])
        else:
            through[handle.path] = flat.unknown(Variable(path, port.through_unit, nominal=port.through_nominal))
        flows.append(through[handle.path])
    total = sum(flows[1:], flows[0])
    if outside:
        name = f"{outside[0]}.{port.through}"
        flat.outputs[name] = (Variable(name, port.through_unit, about=f"into {node[0].path}"), total)
    elif len(node) > 2:
        flat.equations.append(Equation(total, "node of " + ", ".join(h.path for h in node)))


def _signal_node(flat: Flat, node: list[PortHandle], exposed: dict[str, str], signals: dict[str, Any]) -> None:
    source = next((h for h in node if isinstance(h.port, SignalOut)), None)
    names = [exposed[h.path] for h in node if h.path in exposed]
    if source is not None and isinstance(source.port, SignalOut):
        unit, shown = source.port.unit, source.port.shown
        symbol = flat.unknown(Variable(source.path, unit, about=source.port.about, shown=shown))
        for name in names:
            flat.outputs[name] = (Variable(name, unit, about=source.port.about, shown=shown), symbol)
    else:
        port = node[0].port
        assert isinstance(port, SignalIn)
        unit = port.unit
        low, high = port.minimum, port.maximum
        variable = Variable(names[0], unit, minimum=low, maximum=high, about=port.about, shown=port.shown)
        symbol = ca.SX.sym(names[0])
        flat.inputs[names[0]] = (variable, symbol)
    for handle in node:
        assert isinstance(handle.port, (SignalIn, SignalOut))
        factor = UNITS[unit].factor / UNITS[handle.port.unit].factor
        signals[handle.path] = symbol * factor if factor != 1.0 else symbol
        if handle is not source:
            flat.observables[handle.path] = (Variable(handle.path, handle.port.unit), signals[handle.path])


def _parameter_symbols(flat: Flat, diagram: Diagram, path: str, component: Any) -> dict[str, Any]:
    """Symbols for the parameters of a component; a shared one left to the diagram is one symbol for all."""
    symbols: dict[str, Any] = {}
    for name, (declaration, quantity) in type(component).declarations.items():
        if declaration.role not in ("parameter", "shared"):
            continue
        unit = quantity.unit if quantity else "1"
        default = shared_default(component, name) if declaration.role == "shared" else None
        full, value = f"{path}.{name}", getattr(component, name)
        if default is not None:
            full, value = name, diagram.shared.get(name, default)
            problem = check_value(f"{diagram.name}.{name}", value, declaration, quantity)
            if problem:
                raise StructureError(problem)
        if full not in flat.parameters:
            low = next((b for b in (declaration.above, declaration.least) if b is not None), -math.inf)
            high = next((b for b in (declaration.below, declaration.most) if b is not None), math.inf)
            shown = quantity.display if quantity else display(unit)
            about = declaration.about
            variable = Variable(full, unit, float(value), minimum=low, maximum=high, about=about, shown=shown)
            flat.parameters[full] = (variable, ca.SX.sym(full))
        symbols[name] = flat.parameters[full][1]
    return symbols
