"""A diagram laid flat: the variables and equations of all its components and nodes, side by side.

Union-find puts connected ports on nodes. A node has one symbol for its across variable; its through variables sum to
zero (two ports: the second is minus the first; more: an equation).
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca

from seacrane.errors import Problem, StructureError, nearest
from seacrane.units import UNITS, display

from .component import REGISTRY, Component, check_value, shared_default, symbolic_twin
from .dae import PowerBond, Variable
from .diagram import Diagram
from .net import Net, Node, net
from .ports import PowerPort, SignalIn, SignalOut


@dataclass(frozen=True)
class Equation:
    """`residual` = 0, stated by `origin`: the path of a component, or the ports of a node."""

    residual: Any
    origin: str


@dataclass(frozen=True)
class Jump:
    """An event of a component, stated with the symbols of its law; see `Equations.when`."""

    name: str
    indicator: Any
    resets: tuple[tuple[str, Any], ...]
    about: str


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
        self.modes: dict[str, tuple[Variable, Any]] = {}
        self.events: dict[str, Jump] = {}
        self.equations: list[Equation] = []
        self.sources: list[str] = []
        self.bonds: list[PowerBond] = []

    def unknown(self, variable: Variable, state: str | None = None) -> Any:
        symbol = ca.SX.sym(variable.name)
        self.unknowns[variable.name] = Unknown(variable, symbol, state, shown=state is None)
        return symbol


class PortVariables:
    """The variables of one power port, by their letters (`m.a.p`, `m.a.q`), or in any domain as `across`, `through`."""

    def __init__(self, port: PowerPort, across: Any, through: Any) -> None:
        setattr(self, port.across, across)
        setattr(self, port.through, through)
        self.across, self.through = across, through
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
        """A new state; its rate is `m.der(state)`. `start` and `nominal` are numbers."""
        path = f"{self._path}.{name}"
        symbol = ca.SX.sym(path)
        start, nominal = _number(path, "start value", start), _number(path, "nominal value", nominal)
        variable = Variable(path, unit, start, nominal, about=about, shown=shown)
        self._flat.states[path] = (variable, symbol)
        self._ders[path] = self._flat.unknown(Variable(f"der({path})", "1", about=f"rate of {path}"), path)
        return symbol

    def der(self, state: Any) -> Any:
        """The time derivative of a state of this component."""
        return self._ders[state.name()]

    def unknown(self, name: str, *, unit: str = "1", start: float = 0.0, nominal: float = 1.0, about: str = "") -> Any:
        """A new algebraic unknown, determined by an equation of the law."""
        path = f"{self._path}.{name}"
        start, nominal = _number(path, "start value", start), _number(path, "nominal value", nominal)
        return self._flat.unknown(Variable(path, unit, start, nominal, about=about))

    def mode(self, name: str, *, start: float = 0.0, about: str = "") -> Any:
        """A new mode: a number that stays as it is until an event sets it. `start` is a number."""
        path = f"{self._path}.{name}"
        symbol = ca.SX.sym(path)
        self._flat.modes[path] = (Variable(path, "1", _number(path, "start value", start), about=about), symbol)
        return symbol

    def when(self, name: str, indicator: Any, *resets: tuple[Any, Any], about: str = "") -> None:
        """An event: where `indicator` rises above zero, each pair (state or mode, value) gives that one its new value.

        The instant is located within the step of the solver. All values are computed from what was before it; what the
        jump brings about happens at the same instant. At the start, and where an input jumps, an indicator above zero
        counts as one that has risen. Write indicators of the order of one, and switch off one that must not act in some
        mode by a factor of zero. Two events that switch to and fro need limits that are apart (a hysteresis).
        """
        path = f"{self._path}.{name}"
        targets = []
        for target, value in resets:
            place = target.name() if isinstance(target, ca.SX) and target.is_symbolic() else str(target)
            if place not in self._ders and not (place in self._flat.modes and place.startswith(f"{self._path}.")):
                told = f"sets {place}, but an event sets states and modes of its own component only"
                raise StructureError.at(path, told)
            targets.append((place, ca.SX(value)))
        self._flat.events[path] = Jump(path, ca.SX(indicator), tuple(targets), about)

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


def _number(path: str, what: str, value: Any) -> float:
    """A start or nominal value; `StructureError` for a symbol: parameters are symbols while a law is written."""
    if isinstance(value, ca.SX) and not value.is_constant():
        symbols = ", ".join(s.name() for s in ca.symvar(value))
        raise StructureError.at(
            path,
            f"has a {what} that depends on the parameter {symbols}, but it must be a number",
            hint="Declare what a state starts from as `initial`, not as `parameter`: it stays a number in the law.",
        )
    number = float(value)
    if not math.isfinite(number):
        raise StructureError.at(path, f"has a {what} that is not a finite number", value=number)
    return number


def flatten(diagram: Diagram) -> Flat:
    """All equations and unknowns of the diagram; raises with every fault of the connections at once."""
    flat = Flat()
    whole = net(diagram)
    problems = [*_loose_ends(whole), *_unknown_shared(whole)]
    if problems:
        raise StructureError(problems)
    across: dict[str, Any] = {}
    through: dict[str, Any] = {}
    signals: dict[str, Any] = {}
    for node in whole.nodes:
        if isinstance(node.ends[0].port, PowerPort):
            _power_node(flat, node, across, through)
        else:
            _signal_node(flat, node, signals, whole.components)
    for path, component in whole.components.items():
        ports = {
            key: PortVariables(port, across[f"{path}.{key}"], through[f"{path}.{key}"])
            if isinstance(port, PowerPort)
            else signals[f"{path}.{key}"]
            for key, port in component.interface().items()
        }
        equations = Equations(flat, path, ports)
        twin = symbolic_twin(component, parameter_symbols(flat, whole, path, component))
        for left, right in twin.equations(equations):
            flat.equations.append(Equation(left - right, path))
        flat.sources += [s for s in component.sources if s not in flat.sources]
    flat.bonds += (b for b in _partners(whole) if (b.across in flat.inputs) != (b.through in flat.inputs))
    return flat


def _partners(whole: Net) -> Iterator[PowerBond]:
    """The bonds of components that exchange power by signals, both of which the diagram exposes.

    Such a bond is called what its names begin with, "rod" for rod_velocity and rod_force, or else like the component.
    """
    names = {end.path: node.exposed[0] for node in whole.nodes if node.exposed for end in node.ends}
    for path, component in whole.components.items():
        bond = component.partner
        if bond is None or not all(f"{path}.{key}" in names for key in (bond.across, bond.through)):
            continue
        across, through = (names[f"{path}.{key}"] for key in (bond.across, bond.through))
        stem, other = (re.sub(r"[._]?[^._]+$", "", name) for name in (across, through))
        yield PowerBond(stem if stem == other and stem else path, across, through, bond.inward)


def _loose_ends(whole: Net) -> Iterator[Problem]:
    if not whole.components:
        yield Problem(whole.name, "is empty")
    for node in whole.nodes:
        end = node.ends[0]
        outputs = [e.path for e in node.ends if isinstance(e.port, SignalOut)]
        if len(outputs) > 1:
            yield Problem(end.path, f"is driven by several outputs: {', '.join(outputs)}")
        if len(node.ends) > 1 or node.exposed or isinstance(end.port, SignalOut):
            continue
        what = "is given no signal" if isinstance(end.port, SignalIn) else "is connected to nothing"
        hint = "Connect it, or expose it." if isinstance(end.port, SignalIn) else "Connect it, expose it, or plug it."
        yield Problem(f"{whole.name}.{end.path}", what, hint=hint)


def _unknown_shared(whole: Net) -> Iterator[Problem]:
    """Shared values that no component knows. One that just these levels do not use is no fault."""
    known = {n for c in REGISTRY for n, (d, _) in c.declarations.items() if d.role == "shared"}
    for scope, values in whole.shared.items():
        for name in values:
            if name not in known:
                place = ".".join(filter(None, (whole.name, scope, name)))
                yield Problem(place, "is no shared parameter of any component", hint=nearest(name, known))


def _power_node(flat: Flat, node: Node, across: dict[str, Any], through: dict[str, Any]) -> None:
    ends, outside = node.ends, node.exposed
    port = ends[0].port
    assert isinstance(port, PowerPort)
    first = f"{ends[0].path}.{port.across}"
    if outside:
        name = f"{outside[0]}.{port.across}"
        symbol = ca.SX.sym(name)
        flat.inputs[name] = (Variable(name, port.across_unit, about=f"given at {ends[0].path}"), symbol)
    else:
        symbol = flat.unknown(Variable(first, port.across_unit, nominal=port.across_nominal))
    for end in ends:
        across[end.path] = symbol
        path = f"{end.path}.{port.across}"
        if outside or path != first:
            flat.observables[path] = (Variable(path, port.across_unit), symbol)
    flows: list[Any] = []
    for end in ends:
        path = f"{end.path}.{port.through}"
        if len(ends) == 2 and not outside and flows:
            through[end.path] = -flows[0]
            flat.observables[path] = (Variable(path, port.through_unit), -flows[0])
        else:
            through[end.path] = flat.unknown(Variable(path, port.through_unit, nominal=port.through_nominal))
        flows.append(through[end.path])
    total = sum(flows[1:], flows[0])
    if outside:
        name = f"{outside[0]}.{port.through}"
        flat.outputs[name] = (Variable(name, port.through_unit, about=f"into {ends[0].path}"), total)
        flat.bonds.append(PowerBond(outside[0], f"{outside[0]}.{port.across}", name))
    elif len(ends) > 2:
        flat.equations.append(Equation(total, "node of " + ", ".join(e.path for e in ends)))


def _signal_node(flat: Flat, node: Node, signals: dict[str, Any], owners: Mapping[str, Component]) -> None:
    ends, names = node.ends, node.exposed
    source = next((e for e in ends if isinstance(e.port, SignalOut)), None)
    if source is not None and isinstance(source.port, SignalOut):
        unit, shown = source.port.unit, source.port.shown
        symbol = flat.unknown(Variable(source.path, unit, about=source.port.about, shown=shown))
        for name in names:
            flat.outputs[name] = (Variable(name, unit, about=source.port.about, shown=shown), symbol)
    else:
        port = ends[0].port
        assert isinstance(port, SignalIn)
        unit = port.unit
        low, high = port.minimum, port.maximum
        start = float(getattr(owners[ends[0].owner], port.start)) if port.start else 0.0
        variable = Variable(names[0], unit, start, minimum=low, maximum=high, about=port.about, shown=port.shown)
        symbol = ca.SX.sym(names[0])
        flat.inputs[names[0]] = (variable, symbol)
    for end in ends:
        assert isinstance(end.port, (SignalIn, SignalOut))
        factor = UNITS[unit].factor / UNITS[end.port.unit].factor
        signals[end.path] = symbol * factor if factor != 1.0 else symbol
        if end is not source:
            flat.observables[end.path] = (Variable(end.path, end.port.unit), signals[end.path])


def parameter_symbols(flat: Flat, whole: Net, path: str, component: Any) -> dict[str, Any]:
    """Symbols for the parameters of a component; a shared one left to the diagram is one symbol for all."""
    symbols: dict[str, Any] = {}
    for name, (declaration, quantity) in type(component).declarations.items():
        if declaration.role not in ("parameter", "shared"):
            continue
        unit = quantity.unit if quantity else "1"
        default = shared_default(component, name) if declaration.role == "shared" else None
        full, value = f"{path}.{name}", getattr(component, name)
        if default is not None:
            scope = _scope(whole, path, name)
            full, value = ".".join(filter(None, (scope, name))), whole.shared[scope].get(name, default)
            problem = check_value(f"{whole.name}.{full}", value, declaration, quantity)
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


def _scope(whole: Net, path: str, name: str) -> str:
    """The innermost diagram around a component that gives a value to a shared parameter; the outermost if none does."""
    while path:
        path = path.rpartition(".")[0]
        if name in whole.shared.get(path, {}):
            break
    return path
