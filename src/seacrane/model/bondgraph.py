"""The bond graph of a diagram: the graphs of its components joined, simplified, and given causality.

Where ports meet, hydraulic ones are joined by a 0 junction (one pressure), mechanical ones by a 1 junction (one speed).
Junctions of one kind that touch are merged, and one that only passes a bond on is left out. A diagram placed in another
keeps its own junctions, so that it can be drawn by itself. Signals that modulate elements are kept beside the bonds,
with the blocks that they come through.

Causality is assigned sequentially (SCAP): sources first, then stores in integral form, then what resistors are left,
each followed by what the junctions and transformers imply. Three things can go wrong and are reported: a store that is
left with derivative causality, resistors that had to be chosen freely (an algebraic loop), and an element whose rule
cannot be met.

(D. C. Karnopp, D. L. Margolis and R. C. Rosenberg, System Dynamics, 5th ed., 2012, sections 3.4 and 5.2.)
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Final, Literal

from .component import Component
from .diagram import Diagram
from .net import End, Net, Node, net
from .ports import PowerPort, SignalIn, SignalOut
from .structure import Bond

WORD: Final = "word"
"""Kind of the element that stands for a component without a bond graph of its own: it has no rule of causality."""

BLOCK: Final = "block"
"""Kind of the element that stands for a component that carries signals only, and for a signal given from outside."""

Sort = Literal["derivative", "loop", "conflict"]


@dataclass(frozen=True)
class Element:
    """An element of the joined graph: `drive.cylinder.oil_a`, of kind C, of component `drive.cylinder`.

    `scope` is the diagram that it stands in, one placed in another by its path: `drive`.
    """

    name: str
    kind: str
    component: str
    scope: str = ""


@dataclass(frozen=True)
class DomainBond(Bond):
    """A bond with the domain of its power: "hydraulic", "translational", "rotational", or "" if not known.

    `ports` has the names of the ports through which it leaves diagrams placed in others, by their paths.
    """

    domain: str = ""
    ports: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Link:
    """A signal from one element to another; `ports` as those of a bond."""

    tail: str
    head: str
    ports: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Finding:
    """Something about the causality that the user should know; `element` is where."""

    sort: Sort
    element: str
    message: str

    def __str__(self) -> str:
        return f"{self.element}: {self.message}"


@dataclass(frozen=True)
class SystemBondGraph:
    """The bond graph of a whole diagram with its causality; `svg()` draws it, `str()` lists it."""

    name: str
    elements: tuple[Element, ...]
    bonds: tuple[DomainBond, ...]
    findings: tuple[Finding, ...]
    links: tuple[Link, ...] = ()

    def at(self, element: str) -> list[DomainBond]:
        """The bonds at an element."""
        return [bond for bond in self.bonds if element in (bond.tail, bond.head)]

    def svg(self) -> str:
        """The drawing, as an SVG document."""
        from .drawing.bonds import bond_graph_svg

        return bond_graph_svg(self)

    def __str__(self) -> str:
        counts: dict[str, int] = {}
        for element in self.elements:
            counts[element.kind] = counts.get(element.kind, 0) + 1
        lines = [f"{self.name}: " + ", ".join(f"{count} {kind}" for kind, count in sorted(counts.items()))]
        for bond in self.bonds:
            left = "|" if bond.effort_to == bond.tail else ""
            right = "|" if bond.effort_to == bond.head else ""
            lines.append(f"  {bond.tail} {left}->{right} {bond.head}")
        lines += [f"  {link.tail} ~> {link.head}" for link in self.links]
        return "\n".join(lines + [f"  {finding.sort}: {finding}" for finding in self.findings])


def bond_graph(diagram: Diagram) -> SystemBondGraph:
    """See the module."""
    joined = _Joined(net(diagram))
    joined.simplify()
    elements, bonds = joined.elements, _with_domains(joined)
    causal = _Causality(elements, bonds)
    causal.assign()
    bonds = [replace(bond, effort_to=end) for bond, end in zip(bonds, causal.effort_to, strict=True)]
    links = tuple({(link.tail, link.head): link for link in joined.links}.values())
    return SystemBondGraph(diagram.name, tuple(elements.values()), tuple(bonds), tuple(causal.findings), links)


# ---------------------------------------------------------------- joining
def scope_of(path: str) -> str:
    """The path of the diagram that a component stands in."""
    return path.rpartition(".")[0]


def _common(paths: Iterable[str]) -> str:
    """The innermost diagram around all of these."""
    split = [path.split(".") if path else [] for path in paths]
    return ".".join(steps[0] for steps in itertools.takewhile(lambda s: len(set(s)) == 1, zip(*split, strict=False)))


class _Joined:
    """The graphs of all components, joined at the nodes of a net."""

    def __init__(self, whole: Net) -> None:
        self.elements: dict[str, Element] = {}
        self.bonds: list[DomainBond] = []
        self.links: list[Link] = []
        self._at: dict[str, tuple[str, Node]] = {}
        """The junction at each power port, by its path, and the node."""
        self.domains: dict[str, str] = {}
        """Domains of junctions, as far as they are known from the ports that meet there."""
        for node in whole.nodes:
            if isinstance(node.ends[0].port, PowerPort):
                self._join(node, list(node.ends))
                for outside in node.exposed:
                    self._source(outside, node)
        for path, component in whole.components.items():
            self._place(path, component)
        for node in whole.nodes:
            if not isinstance(node.ends[0].port, PowerPort):
                self._link(node, whole.components)

    def _join(self, node: Node, ends: Sequence[End]) -> str:
        """Junctions for these ends of a node, one in each diagram where several meet; the name of the outermost."""
        port = node.ends[0].port
        assert isinstance(port, PowerPort)
        scope = _common(scope_of(end.owner) for end in ends)
        name = f"node {ends[0].path}" if len(ends) == len(node.ends) else f"{scope}.node {ends[0].path}"
        self.elements[name] = Element(name, "0" if port.across == "p" else "1", "", scope)
        self.domains[name] = port.domain
        depth = len(scope.split(".")) if scope else 0
        groups: dict[str, list[End]] = {}
        for end in ends:
            owner = scope_of(end.owner)
            groups.setdefault(end.owner if owner == scope else ".".join(owner.split(".")[: depth + 1]), []).append(end)
        for inside in groups.values():
            if len(inside) == 1 or scope_of(inside[0].owner) == scope:
                self._at.update({end.path: (name, node) for end in inside})
                continue
            inner = self._join(node, inside)
            self.bonds.append(DomainBond(name, inner, None, port.domain, node.within))
        return name

    def _source(self, outside: str, node: Node) -> None:
        """What stands for a power port that the diagram exposes: its across variable comes from outside."""
        port = node.ends[0].port
        assert isinstance(port, PowerPort)
        name = f"node {node.ends[0].path}"
        kind = "MSe" if port.across == "p" else "MSf"
        self.elements[outside] = Element(outside, kind, "")
        self.bonds.append(DomainBond(outside, name, name if kind == "MSe" else outside, port.domain, node.within))

    def _place(self, path: str, component: Component) -> None:
        """The elements and bonds of a component."""
        own, scope = f"{path}.", scope_of(path)
        ports = {key for key, port in component.interface().items() if isinstance(port, PowerPort)}
        graph = component.bond_graph
        if graph is None or not graph.elements:
            self.elements[path] = Element(path, WORD if ports else BLOCK, path, scope)
            for key in sorted(ports):
                junction, node = self._at[own + key]
                self.bonds.append(DomainBond(junction, path, None, _domain(node), node.within))
            return
        for key, kind in graph.elements.items():
            self.elements[own + key] = Element(own + key, kind, path, scope)
        for bond in graph.bonds:
            tail, head = (self._at[own + end][0] if end in ports else own + end for end in (bond.tail, bond.head))
            effort_to = None if bond.effort_to is None else tail if bond.effort_to == bond.tail else head
            outside = next((self._at[own + end][1] for end in (bond.tail, bond.head) if end in ports), None)
            domain, within = (_domain(outside), outside.within) if outside is not None else ("", {})
            self.bonds.append(DomainBond(tail, head, effort_to, domain, within))
        for sensed, to in graph.signals:
            if to in graph.elements and sensed in ports:
                junction, node = self._at[own + sensed]
                self.links.append(Link(junction, own + to, node.within))
            elif to in graph.elements and sensed in graph.elements:
                self.links.append(Link(own + sensed, own + to))

    def _link(self, node: Node, components: Mapping[str, Component]) -> None:
        """The signals of a node: from what gives it, or from outside, to all that take it."""
        sources = [
            name for end in node.ends if isinstance(end.port, SignalOut) for name in self._signal(end, components)
        ]
        takers = [name for end in node.ends if isinstance(end.port, SignalIn) for name in self._signal(end, components)]
        if not sources and node.exposed:
            self.elements.update({name: Element(name, BLOCK, "") for name in node.exposed[:1]})
            sources = list(node.exposed[:1])
        elif node.exposed:
            self.elements.update({name: Element(name, BLOCK, "") for name in node.exposed})
            takers += node.exposed
        self.links += [Link(tail, head, node.within) for tail in sources for head in takers]

    def _signal(self, end: End, components: Mapping[str, Component]) -> Iterator[str]:
        """The elements behind a signal port: what it modulates, or what it is sensed at."""
        graph = components[end.owner].bond_graph
        if graph is None or not graph.elements:
            yield end.owner
            return
        for tail, head in graph.signals:
            other = head if tail == end.key else tail if head == end.key else None
            if other is not None:
                path = f"{end.owner}.{other}"
                yield self._at[path][0] if path in self._at else path

    # ------------------------------------------------------------ simplifying
    def simplify(self) -> None:
        """Leave out junctions that only pass a bond on, and merge touching junctions of one kind in one diagram."""
        while (change := self._next_change()) is not None:
            gone, kept, removed = change
            del self.elements[gone]
            if self.elements[kept].kind in "01":
                self.domains.setdefault(kept, self.domains.get(gone) or removed.domain)

            def named(end: str, gone: str = gone, kept: str = kept) -> str:
                return kept if end == gone else end

            self.bonds = [
                replace(
                    bond,
                    tail=named(bond.tail),
                    head=named(bond.head),
                    effort_to=bond.effort_to and named(bond.effort_to),
                    ports={**removed.ports, **bond.ports} if gone in (bond.tail, bond.head) else bond.ports,
                )
                for bond in self.bonds
                if bond is not removed
            ]
            self.links = [replace(link, tail=named(link.tail), head=named(link.head)) for link in self.links]

    def _next_change(self) -> tuple[str, str, DomainBond] | None:
        """The next junction to leave out, the element that takes its place, and the bond that goes with it."""
        at: dict[str, list[DomainBond]] = {name: [] for name in self.elements}
        for bond in self.bonds:
            at[bond.tail].append(bond)
            at[bond.head].append(bond)
        for bond in self.bonds:
            a, b = self.elements[bond.tail], self.elements[bond.head]
            if a.kind == b.kind and a.kind in "01" and a.name != b.name and a.scope == b.scope:
                gone, kept = (a, b) if not a.component and b.component else (b, a)
                return gone.name, kept.name, bond
        for name, here in at.items():
            if self.elements[name].kind in "01" and len(here) == 2:
                first, second = here
                passes = (first.head == name) != (second.head == name)
                if passes and first is not second:
                    other = first.tail if first.head == name else first.head
                    return name, other, first
        return None


def _domain(node: Node) -> str:
    port = node.ends[0].port
    return port.domain if isinstance(port, PowerPort) else ""


def _with_domains(joined: _Joined) -> list[DomainBond]:
    """Domains carried from the ports through junctions."""
    elements, bonds = joined.elements, joined.bonds
    domains = [bond.domain for bond in bonds]
    spreading = True
    while spreading:
        spreading = False
        known = {name: domain for name, domain in joined.domains.items() if domain}
        for bond, domain in zip(bonds, domains, strict=True):
            for end in (bond.tail, bond.head):
                if domain and elements[end].kind in "01":
                    known[end] = domain
        for i, bond in enumerate(bonds):
            domain = known.get(bond.tail) or known.get(bond.head) or ""
            if not domains[i] and domain:
                domains[i], spreading = domain, True
    return [replace(bond, domain=domain) for bond, domain in zip(bonds, domains, strict=True)]


# ---------------------------------------------------------------- causality
class _Causality:
    """One run of the sequential assignment: `effort_to[i]` is the end of bond i that is given the effort."""

    def __init__(self, elements: dict[str, Element], bonds: list[DomainBond]) -> None:
        self.elements, self.bonds = elements, bonds
        self.preferred = [bond.effort_to for bond in bonds]
        self.effort_to: list[str | None] = [None] * len(bonds)
        self.at: dict[str, list[int]] = {name: [] for name in elements}
        for i, bond in enumerate(bonds):
            self.at[bond.tail].append(i)
            self.at[bond.head].append(i)
        self.findings: list[Finding] = []

    def assign(self) -> None:
        for i, name, kind in self._ports("Se", "MSe", "Sf", "MSf"):
            wanted = self._other(i, name) if kind.endswith("Se") else name
            if self.effort_to[i] not in (None, wanted):
                what = "effort" if kind.endswith("Se") else "flow"
                self._report("conflict", name, f"imposes its {what} where it is imposed already")
            self._set(i, wanted)
        for i, name, kind in self._ports("C", "I"):
            wanted = self._other(i, name) if kind == "C" else name
            if self.effort_to[i] not in (None, wanted):
                what = "effort (a pressure, force or torque)" if kind == "C" else "flow (a speed)"
                self._report("derivative", name, f"has derivative causality: its {what} is imposed by others")
            self._set(i, wanted)
        for i, name, _ in self._ports("R", "MR"):
            if self.effort_to[i] is None:
                self._report("loop", name, "is in an algebraic loop: no source or store decides its causality")
                self._set(i, self.preferred[i] or name)
        for i, bond in enumerate(self.bonds):
            self._set(i, self.preferred[i] or bond.head)
        for name in self.elements:
            if not self._fulfilled(name):
                self._report("conflict", name, _RULES[self.elements[name].kind.removeprefix("M")])

    def _ports(self, *kinds: str) -> Iterator[tuple[int, str, str]]:
        for name, element in self.elements.items():
            if element.kind in kinds:
                for i in self.at[name]:
                    yield i, name, element.kind

    def _other(self, i: int, name: str) -> str:
        bond = self.bonds[i]
        return bond.head if bond.tail == name else bond.tail

    def _report(self, sort: Sort, name: str, message: str) -> None:
        self.findings.append(Finding(sort, name, message))

    def _set(self, i: int, end: str) -> None:
        """Assign a bond if it is free, and all that follows from it."""
        work = [(i, end)]
        while work:
            i, end = work.pop()
            if self.effort_to[i] is None:
                self.effort_to[i] = end
                work += self._implied(self.bonds[i].tail)
                work += self._implied(self.bonds[i].head)

    def _implied(self, name: str) -> list[tuple[int, str]]:
        """What the rule of an element says of its bonds that are still free."""
        kind = self.elements[name].kind.removeprefix("M")
        here = self.at[name]
        free = [i for i in here if self.effort_to[i] is None]
        inward = [i for i in here if self.effort_to[i] == name]
        outward = [i for i in here if self.effort_to[i] not in (None, name)]
        if not free or kind not in _RULES:
            return []
        if kind == "GY":
            given = (inward or outward)[:1]
            return [(i, name if inward else self._other(i, name)) for i in free] if given else []
        # One bond at a 0 junction brings the effort in, one at a 1 junction takes it out (it brings the flow).
        single, rest = (outward, inward) if kind == "1" else (inward, outward)
        to_single = [(i, self._other(i, name) if kind == "1" else name) for i in free]
        to_rest = [(i, name if kind == "1" else self._other(i, name)) for i in free]
        if single:
            return to_rest
        if len(rest) == len(here) - 1:
            return to_single
        return []

    def _fulfilled(self, name: str) -> bool:
        kind = self.elements[name].kind.removeprefix("M")
        inward = sum(self.effort_to[i] == name for i in self.at[name])
        outward = len(self.at[name]) - inward
        match kind:
            case "0" | "TF":
                return inward == 1
            case "1":
                return outward == 1
            case "GY":
                return inward != 1
            case _:
                return True


_RULES: Final = {
    "0": "needs one bond that decides its effort (pressure), and has none or several",
    "1": "needs one bond that decides its flow (speed), and has none or several",
    "TF": "must be given one effort and one flow",
    "GY": "must be given two efforts or two flows",
}
