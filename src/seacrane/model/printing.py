"""The equations of a diagram as they are solved, component by component, to be read."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from .component import Component, symbolic_twin
from .diagram import Diagram
from .expressions import Reader, latex, symbol_latex, text
from .flatten import Equations, Flat, PortVariables
from .net import Net, net
from .ports import PowerPort


@dataclass(frozen=True)
class Line:
    """One equation, left = right, as text and as LaTeX."""

    left: str
    right: str
    latex: str

    def __str__(self) -> str:
        return f"{self.left} = {self.right}"


@dataclass(frozen=True)
class ComponentEquations:
    """The law of one component: its equations and events, in its own names, and the parts with a name (`where`)."""

    path: str
    component: str
    level: str | None
    lines: tuple[Line, ...]
    where: tuple[Line, ...]

    @property
    def title(self) -> str:
        """`valve: DirectionalValve43 (dynamic)`"""
        return f"{self.path}: {self.component}" + (f" ({self.level})" if self.level else "")


@dataclass(frozen=True)
class PrintedEquations:
    """The equations of a diagram: those of its components, and those of its nodes."""

    name: str
    components: tuple[ComponentEquations, ...]
    nodes: tuple[Line, ...]

    def __str__(self) -> str:
        lines = []
        for part in self.components:
            lines += [part.title, *(f"    {line}" for line in part.lines)]
            lines += ["  where"] if part.where else []
            lines += [f"    {line}" for line in part.where]
        return "\n".join([*lines, "nodes", *(f"    {line}" for line in self.nodes)])

    def latex(self) -> str:
        """A LaTeX fragment: a heading and aligned equations (amsmath) for each component and for the nodes."""
        blocks = [(part.title, part.lines + part.where) for part in self.components]
        blocks.append((f"nodes of {self.name}", self.nodes))
        return "\n".join(_aligned(title, lines) for title, lines in blocks if lines)


def printed_equations(diagram: Diagram) -> PrintedEquations:
    """See `Diagram.equations`."""
    whole = net(diagram)
    parts = tuple(_of_component(path, component) for path, component in whole.components.items())
    return PrintedEquations(whole.name, parts, tuple(_node_lines(whole)))


def _of_component(path: str, component: Component) -> ComponentEquations:
    own = f"{path}."
    flat = Flat()
    ports = {
        key: PortVariables(port, ca.SX.sym(f"{key}.{port.across}"), ca.SX.sym(f"{key}.{port.through}"))
        if isinstance(port, PowerPort)
        else ca.SX.sym(key)
        for key, port in component.interface().items()
    }
    names = [n for n, (d, _) in type(component).declarations.items() if d.role in ("parameter", "shared")]
    twin = symbolic_twin(component, {name: ca.SX.sym(name) for name in names})
    pairs = [(ca.SX(left), ca.SX(right)) for left, right in twin.equations(Equations(flat, path, ports))]
    jumps = [
        (event.indicator, target.removeprefix(own), value)
        for event in flat.events.values()
        for target, value in event.resets
    ]
    sides = [side for pair in pairs for side in pair]
    sides += [side for indicator, _, value in jumps for side in (indicator, value)]
    reader = Reader(sides, own)
    cut = {node: f"s{i}" for i, node in enumerate(reader.named(), start=1)}

    lines = []
    laws = reader.roots[: 2 * len(pairs)]
    for left, right in zip(laws[::2], laws[1::2], strict=True):
        formula = f"{latex(reader, left, cut)} = {latex(reader, right, cut)}"
        lines.append(Line(text(reader, left, cut), text(reader, right, cut), formula))
    for i, (_, target, _) in enumerate(jumps):
        indicator, value = reader.roots[2 * (len(pairs) + i) :][:2]
        formula = rf"\text{{when }} {latex(reader, indicator, cut)} > 0:\quad {symbol_latex(target)}"
        formula += f" = {latex(reader, value, cut)}"
        lines.append(Line(f"when {text(reader, indicator, cut)} > 0: {target}", text(reader, value, cut), formula))
    where = []
    for node, name in cut.items():
        formula = f"{symbol_latex(name)} = {latex(reader, node, cut, whole=True)}"
        where.append(Line(name, text(reader, node, cut, whole=True), formula))
    interface = next(base for base in type(component).__mro__ if issubclass(base, Component) and base.level is None)
    return ComponentEquations(path, interface.__name__, component.level, tuple(lines), tuple(where))


def _node_lines(whole: Net) -> list[Line]:
    lines = []
    for node in whole.nodes:
        first, port = node.ends[0], node.ends[0].port
        suffix = f".{port.across}" if isinstance(port, PowerPort) else ""
        names = [f"{name}{suffix}" for name in node.exposed] + [f"{end.path}{suffix}" for end in node.ends]
        lines += [_equal(names[0], other) for other in names[1:]]
        if isinstance(port, PowerPort) and len(node.ends) > 1 and not node.exposed:
            flows = [f"{end.path}.{port.through}" for end in node.ends]
            lines.append(Line(" + ".join(flows), "0", " + ".join(map(symbol_latex, flows)) + " = 0"))
        elif isinstance(port, PowerPort) and not node.exposed:
            lines.append(
                Line(f"{first.path}.{port.through}", "0", f"{symbol_latex(f'{first.path}.{port.through}')} = 0")
            )
    return lines


def _equal(left: str, right: str) -> Line:
    return Line(left, right, f"{symbol_latex(left)} = {symbol_latex(right)}")


def _aligned(title: str, lines: tuple[Line, ...]) -> str:
    rows = " \\\\\n".join("  " + line.latex.replace(" = ", " &= ", 1) for line in lines)
    heading = title.replace("_", r"\_")
    return f"\\paragraph{{{heading}}}\n\\begin{{align*}}\n{rows}\n\\end{{align*}}"
