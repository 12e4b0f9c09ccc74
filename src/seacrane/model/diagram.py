"""Diagrams: components by name, joined at their ports.

A diagram is checked while it is built: a wrong port name, a wrong domain or a wrong unit is refused at once, by name.
What the equations say together is checked when it is compiled.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Final

from seacrane.errors import Problem, StructureError, nearest
from seacrane.units import compatible

from .component import Component
from .dae import Dae, Variable
from .ports import Port, PowerPort, SignalIn, SignalOut

if TYPE_CHECKING:
    from .bondgraph import SystemBondGraph
    from .printing import PrintedEquations
    from .report import Report


class PortHandle:
    """One port of one component of one diagram: what `connect` and `expose` take."""

    __slots__ = ("diagram", "name", "owner", "port")

    def __init__(self, diagram: Diagram, owner: str, name: str, port: Port) -> None:
        self.diagram, self.owner, self.name, self.port = diagram, owner, name, port

    @property
    def path(self) -> str:
        return f"{self.owner}.{self.name}"

    def __repr__(self) -> str:
        return f"<{type(self.port).__name__} port {self.path}>"


class Part:
    """A component, or a whole diagram, placed in a diagram; its ports are its attributes."""

    def __init__(self, diagram: Diagram, name: str, content: Component | Diagram) -> None:
        self._ports = {key: PortHandle(diagram, name, key, port) for key, port in content.interface().items()}
        self._name = name
        self.content: Final = content

    @property
    def component(self) -> Component:
        """The component; `StructureError` if this part is a diagram."""
        if isinstance(self.content, Diagram):
            raise StructureError.at(self._name, f"is the diagram {self.content.name!r}, not a component")
        return self.content

    def __getattr__(self, key: str) -> PortHandle:
        ports: dict[str, PortHandle] = self.__dict__.get("_ports", {})
        if key in ports:
            return ports[key]
        if key.startswith("__"):
            raise AttributeError(key)
        raise StructureError.at(self.__dict__.get("_name", "part"), f"has no port {key!r}", hint=nearest(key, ports))

    def __iter__(self) -> Iterator[PortHandle]:
        return iter(self._ports.values())


class Diagram:
    """Components and their connections; `compile()` turns it into equations.

    Keyword arguments are values of shared parameters (`Diagram("drive", density=860.0)`), which every component
    without a value of its own takes. A diagram can be placed in another like a component: its exposed ports are then
    the ports of the part, and its own shared values go before those around it.
    """

    def __init__(self, name: str, **shared: float) -> None:
        self.name: Final = name
        self.shared: Final = shared
        self.parts: Final[dict[str, Part]] = {}
        self.connections: Final[list[tuple[PortHandle, ...]]] = []
        self.exposed: Final[dict[str, PortHandle]] = {}

    def add(self, name: str, content: Component | Diagram) -> Part:
        """Place a component, or a copy of another diagram as it is now, under a name of its own.

        The variables of a diagram placed as `drive` become `drive.cylinder.extension` and so on. Placed twice, it gives
        two independent copies.
        """
        if name in self.parts:
            raise StructureError.at(f"{self.name}.{name}", "is the name of a component already")
        if not name or not name.replace("_", "").isalnum():
            raise StructureError.at(self.name, f"{name!r} is no name for a component", allowed="letters, digits and _")
        if isinstance(content, Diagram):
            if not content.exposed:
                raise StructureError.at(
                    f"{self.name}.{name}",
                    f"is the diagram {content.name!r}, which has no ports to connect",
                    hint=f"Expose some: {content.name}.expose(...).",
                )
            content = content._copy()
        part = self.parts[name] = Part(self, name, content)
        return part

    def interface(self) -> Mapping[str, Port]:
        """The exposed ports by name: what this diagram is connected by when it is placed in another."""
        return {name: handle.port for name, handle in self.exposed.items()}

    def connect(self, *ports: PortHandle) -> None:
        """Join ports at one node, or one signal output to signal inputs."""
        problems = [*self._strangers(ports)]
        if len(ports) < 2:
            problems.append(Problem(self.name, "a connection needs at least two ports", [p.path for p in ports]))
        if not problems:
            problems += _mismatches(self.name, ports)
        if problems:
            raise StructureError(problems)
        self.connections.append(ports)

    def expose(self, **ports: PortHandle) -> None:
        """Make ports part of the diagram's own interface, under plain names.

        A signal input becomes an input, a signal output an output. A power port named `rod` takes its across variable
        from outside (input `rod.v`) and gives its through variable (output `rod.F`, positive into the diagram).
        """
        problems = [*self._strangers(tuple(ports.values()))]
        problems += [Problem(f"{self.name}.{n}", "is exposed already") for n in ports if n in self.exposed]
        if problems:
            raise StructureError(problems)
        self.exposed.update(ports)

    def compile(self) -> Dae:
        """The equations of the diagram; `StructureError` says in plain words what has no solution."""
        from .compile import compile_diagram

        return compile_diagram(self).dae

    def report(self) -> Report:
        """What the compiler finds in the diagram: states, stores tied rigidly to others, and algebraic loops."""
        from .report import report

        return report(self)

    def bond_graph(self) -> SystemBondGraph:
        """The bond graph of the diagram with its causality; `.svg()` draws it."""
        from .bondgraph import bond_graph

        return bond_graph(self)

    def icons_svg(self) -> str:
        """The iconic diagram as an SVG document: symbols of the components, joined by lines in domain colours.

        A diagram placed in it is a box with ports, and is drawn in a frame of its own below.
        """
        from .drawing.icons import icons_svg

        return icons_svg(self)

    def parameters(self) -> tuple[Variable, ...]:
        """The parameters of all components, shared ones once; `start` is the value [SI]."""
        from .values import parameters

        return parameters(self)

    def equations(self) -> PrintedEquations:
        """The laws of all components as they are solved, to be read: `str()` for text, `.latex()` for LaTeX."""
        from .printing import printed_equations

        return printed_equations(self)

    def sources(self) -> tuple[str, ...]:
        """Where the laws of exactly these components, at these levels, come from; each once, in order of use."""
        from .net import net

        return tuple(dict.fromkeys(s for component in net(self).components.values() for s in component.sources))

    def _copy(self) -> Diagram:
        copy = Diagram(self.name, **self.shared)
        copy.parts.update(self.parts)
        copy.connections.extend(self.connections)
        copy.exposed.update(self.exposed)
        return copy

    def _strangers(self, ports: tuple[object, ...]) -> Iterator[Problem]:
        for port in ports:
            if not isinstance(port, PortHandle):
                yield Problem(self.name, "takes ports, such as valve.a", port)
            elif port.diagram is not self:
                yield Problem(port.path, f"belongs to diagram {port.diagram.name!r}, not to {self.name!r}")


def _mismatches(name: str, ports: tuple[PortHandle, ...]) -> Iterator[Problem]:
    power = [p for p in ports if isinstance(p.port, PowerPort)]
    if power and len(power) < len(ports):
        listed = ", ".join(f"{p.path} ({_kind(p.port)})" for p in ports)
        yield Problem(name, f"a signal cannot be joined to a power port: {listed}")
        return
    if power:
        if len({p.port.domain for p in power}) > 1:  # type: ignore[union-attr]
            listed = ", ".join(f"{p.path} ({_kind(p.port)})" for p in ports)
            yield Problem(name, f"ports of different domains cannot be joined: {listed}")
        return
    outputs = [p for p in ports if isinstance(p.port, SignalOut)]
    if len(outputs) != 1:
        found = ", ".join(p.path for p in outputs) or "none"
        yield Problem(name, f"a signal connection has one output and inputs; outputs here: {found}")
        return
    unit = outputs[0].port.unit  # type: ignore[union-attr]
    for p in ports:
        if isinstance(p.port, SignalIn) and not compatible(unit, p.port.unit):
            yield Problem(p.path, f"takes a signal {_in(p.port.unit)}, but {outputs[0].path} gives one {_in(unit)}")


def _in(unit: str) -> str:
    return "without a unit" if unit == "1" else f"in {unit}"


def _kind(port: Port) -> str:
    return port.domain if isinstance(port, PowerPort) else "signal"
