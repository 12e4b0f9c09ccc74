"""What a component looks like: its bond graph and its icon, apart from its law.

A bond graph is written as a list of elements with their kinds and a list of bonds:

    bond_graph = BondGraph("flow: 1, edge: R", "a -> flow, flow -> b, flow ->| edge")

An end of a bond is an element or a port of the component. The half arrow `->` points where power is counted positive.
A bar is the causal stroke that the law prefers: it stands at the end that is given the effort. `->|` gives the effort
to the second end (an orifice that turns a pressure drop into a flow), `|->` to the first (a volume that gives its
pressure). Without a bar, causality is left to the elements around.

(D. C. Karnopp, D. L. Margolis and R. C. Rosenberg, System Dynamics, 5th ed., 2012, chapters 2 to 5.)
"""

from __future__ import annotations

import re
from collections.abc import Mapping
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
        for text in filter(None, (part.strip() for part in bonds.split(","))):
            match = _BOND.match(text)
            if match is None or (match[2] and match[3]):
                problems.append(Problem("bond graph", f"{text!r} is not a bond", allowed="a -> b, a |-> b or a ->| b"))
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

    def misfits(self, name: str, power_ports: set[str]) -> list[Problem]:
        """Where the graph does not fit the power ports of the component `name`: each needs one bond."""
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
