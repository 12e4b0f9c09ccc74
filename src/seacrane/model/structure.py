"""What a component looks like: its bond graph and its icon, apart from its law.

A bond graph is written as a list of elements with their kinds and a list of bonds:

    bond_graph = BondGraph("flow: 1, edge: R", "a -> flow, flow -> b, flow ->| edge")

An end of a bond is an element or a port of the component. The half arrow `->` points where power is counted positive.
A bar is the causal stroke that the law prefers: it stands at the end that is given the effort. `->|` gives the effort
to the second end (an orifice that turns a pressure drop into a flow), `|->` to the first (a volume that gives its
pressure). Without a bar, causality is left to the elements around. `k ~> edge` is a signal, which carries no power: it
modulates an element (an MR, an MTF), or reports something at a port or junction, `through ~> q`. Its ends may be signal
ports, and it senses a power port that it begins at.

(D. C. Karnopp, D. L. Margolis and R. C. Rosenberg, System Dynamics, 5th ed., 2012, chapters 2 to 5.)
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final

from seacrane.errors import Problem, StructureError, nearest

KINDS: Final[Mapping[str, tuple[int, int | None]]] = MappingProxyType(
    {
        **dict.fromkeys(("Se", "MSe", "Sf", "MSf", "R", "MR", "I", "C"), (1, 1)),
        **dict.fromkeys(("TF", "MTF", "GY", "MGY"), (2, 2)),
        **dict.fromkeys(("0", "1"), (2, None)),
    }
)
"""The kinds of element, with the least and the largest number of bonds at one."""

_BOND = re.compile(r"^\s*(\w+)\s+(\|?)->(\|?)\s+(\w+)\s*$")
_SIGNAL = re.compile(r"^\s*(\w+)\s+~>\s+(\w+)\s*$")


@dataclass(frozen=True)
class Bond:
    """A bond from one end to another. `effort_to` is the end that the law gives the effort to, or None."""

    tail: str
    head: str
    effort_to: str | None = None


@dataclass(frozen=True, init=False)
class BondGraph:
    """The bond graph of one component; see the module. A signal block has an empty one: `BondGraph()`."""

    elements: Mapping[str, str]
    bonds: tuple[Bond, ...]
    signals: tuple[tuple[str, str], ...]

    def __init__(self, elements: str = "", bonds: str = "") -> None:
        problems: list[Problem] = []
        kinds: dict[str, str] = {}
        for text in filter(None, (part.strip() for part in elements.split(","))):
            name, _, kind = (part.strip() for part in text.partition(":"))
            if kind not in KINDS:
                problems.append(Problem("bond graph", f"{text!r} is of no kind of element", allowed=", ".join(KINDS)))
            elif name in kinds:
                problems.append(Problem("bond graph", f"{name!r} is the name of two elements"))
            kinds[name] = kind
        parsed: list[Bond] = []
        signals: list[tuple[str, str]] = []
        for text in filter(None, (part.strip() for part in bonds.split(","))):
            if signal := _SIGNAL.match(text):
                signals.append((signal[1], signal[2]))
                continue
            match = _BOND.match(text)
            if match is None or (match[2] and match[3]):
                problems.append(
                    Problem("bond graph", f"{text!r} is not a bond", allowed="a -> b, a |-> b, a ->| b or a ~> b")
                )
                continue
            tail, first, second, head = match.groups()
            parsed.append(Bond(tail, head, tail if first else head if second else None))
        for name, kind in kinds.items():
            least, most = KINDS.get(kind, (0, None))
            count = sum((bond.tail == name) + (bond.head == name) for bond in parsed)
            if count < least or (most is not None and count > most):
                problems.append(Problem("bond graph", f"{name}, a {kind}, has {count} bonds"))
        if problems:
            raise StructureError(problems)
        object.__setattr__(self, "elements", MappingProxyType(kinds))
        object.__setattr__(self, "bonds", tuple(parsed))
        object.__setattr__(self, "signals", tuple(signals))

    def misfits(self, name: str, power_ports: set[str], signal_ports: Iterable[str] = ()) -> list[Problem]:
        """Where the graph does not fit the ports of the component `name`.

        Each power port needs one bond; a graph with elements says of each signal port, and of each modulated element,
        what it has to do with the rest.
        """
        problems = []
        ends = [end for bond in self.bonds for end in (bond.tail, bond.head)]
        for port in sorted(power_ports):
            if port in self.elements:
                problems.append(Problem(f"{name}.bond_graph", f"{port!r} is the name of an element and of a port"))
            elif ends.count(port) != 1:
                problems.append(Problem(f"{name}.bond_graph", f"port {port!r} has {ends.count(port)} bonds, needs one"))
        known = {*self.elements, *power_ports}
        for end in sorted(set(ends) - known):
            problems.append(
                Problem(f"{name}.bond_graph", f"{end!r} is no element and no power port", hint=nearest(end, known))
            )
        carried = {end for signal in self.signals for end in signal}
        for end in sorted(carried - known - set(signal_ports)):
            problems.append(
                Problem(f"{name}.bond_graph", f"{end!r} is no element and no port", hint=nearest(end, known))
            )
        modulated = {element for element, kind in self.elements.items() if kind.startswith("M")}
        for end in sorted((modulated | (set(signal_ports) if self.elements else set())) - carried):
            problems.append(
                Problem(f"{name}.bond_graph", f"{end!r} has no signal", hint=f"Say {end!r} ~> or ~> {end!r}.")
            )
        return problems


@dataclass(frozen=True)
class Symbol:
    """An icon: SVG of a given size, and where the ports are on its rim.

    `svg` is drawn in a box `width` by `height` with the origin at the top left; lines take the style of the drawing
    they are put in (no colours of their own). A port that `ports` does not name is put on the left rim if it takes a
    signal, on the right rim if it gives one, and wherever there is room if it carries power. A `repeated` symbol (a
    tank) is drawn anew at each thing it is joined to, instead of lines from everywhere to one place.
    """

    width: float
    height: float
    svg: str
    ports: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    repeated: bool = False
