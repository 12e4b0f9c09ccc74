"""The bond graph of a diagram: the graphs of its components joined, simplified, and given causality.

Where ports meet, hydraulic ones are joined by a 0 junction (one pressure), mechanical ones by a 1 junction (one speed).
Junctions of one kind that touch are merged, and one that only passes a bond on is left out.

Causality is assigned sequentially (SCAP): sources first, then stores in integral form, then what resistors are left,
each followed by what the junctions and transformers imply. Three things can go wrong and are reported: a store that is
left with derivative causality, resistors that had to be chosen freely (an algebraic loop), and an element whose rule
cannot be met.

(D. C. Karnopp, D. L. Margolis and R. C. Rosenberg, System Dynamics, 5th ed., 2012, sections 3.4 and 5.2.)
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Final, Literal

from .diagram import Diagram
from .net import Net, net
from .ports import PowerPort
from .structure import Bond

WORD: Final = "word"
"""Kind of the element that stands for a component without a bond graph of its own: it has no rule of causality."""

Sort = Literal["derivative", "loop", "conflict"]


@dataclass(frozen=True)
class Element:
    """An element of the joined graph: `cylinder.oil_a`, of kind C, of component `cylinder`."""

    name: str
    kind: str
    component: str


@dataclass(frozen=True)
class DomainBond(Bond):
    """A bond with the domain of its power: "hydraulic", "translational", "rotational", or "" if not known."""

    domain: str = ""


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
        return "\n".join(lines + [f"  {finding.sort}: {finding}" for finding in self.findings])


def bond_graph(diagram: Diagram) -> SystemBondGraph:
    """See the module."""
    elements, bonds = _joined(net(diagram))
    elements, bonds = _simplified(elements, bonds)
    bonds = _with_domains(elements, bonds)
    causal = _Causality(elements, bonds)
    causal.assign()
    bonds = [replace(bond, effort_to=end) for bond, end in zip(bonds, causal.effort_to, strict=True)]
    return SystemBondGraph(diagram.name, tuple(elements.values()), tuple(bonds), tuple(causal.findings))


# ---------------------------------------------------------------- joining
def _joined(joined: Net) -> tuple[dict[str, Element], list[DomainBond]]:
    elements: dict[str, Element] = {}
    bonds: list[DomainBond] = []
    junction: dict[str, tuple[str, str]] = {}
    for node in joined.nodes:
        port = node.ends[0].port
        if not isinstance(port, PowerPort):
            continue
        effort_is_common = port.across == "p"
        name = f"node {node.ends[0].path}"
        elements[name] = Element(name, "0" if effort_is_common else "1", "")
        junction.update({end.path: (name, port.domain) for end in node.ends})
        for outside in node.exposed:
            elements[outside] = Element(outside, "MSe" if effort_is_common else "MSf", "")
            bonds.append(DomainBond(outside, name, name if effort_is_common else outside, port.domain))
    for path, component in joined.components.items():
        own = f"{path}."
        ports = {key for key, port in component.interface().items() if isinstance(port, PowerPort)}
        if component.bond_graph is None:
            if ports:
                elements[path] = Element(path, WORD, path)
            for key in ports:
                name, domain = junction[own + key]
                bonds.append(DomainBond(name, path, None, domain))
            continue
        for key, kind in component.bond_graph.elements.items():
            elements[own + key] = Element(own + key, kind, path)
        for bond in component.bond_graph.bonds:
            domain = next((junction[own + end][1] for end in (bond.tail, bond.head) if end in ports), "")
            tail, head = (junction[own + end][0] if end in ports else own + end for end in (bond.tail, bond.head))
            effort_to = None if bond.effort_to is None else tail if bond.effort_to == bond.tail else head
            bonds.append(DomainBond(tail, head, effort_to, domain))
    return elements, bonds


def _simplified(elements: dict[str, Element], bonds: list[DomainBond]) -> tuple[dict[str, Element], list[DomainBond]]:
    """The same graph without junctions that only pass a bond on, and with touching junctions of one kind merged."""
    elements = dict(elements)

    def renamed(bond: DomainBond, old: str, new: str) -> DomainBond:
        def name(end: str) -> str:
            return new if end == old else end

        return replace(
            bond, tail=name(bond.tail), head=name(bond.head), effort_to=bond.effort_to and name(bond.effort_to)
        )

    while True:
        change = _next_change(elements, bonds)
        if change is None:
            return elements, bonds
        gone, kept, removed = change
        del elements[gone]
        bonds = [renamed(bond, gone, kept) for bond in bonds if bond is not removed]


def _next_change(elements: dict[str, Element], bonds: list[DomainBond]) -> tuple[str, str, DomainBond] | None:
    """The next junction to leave out, the element that takes its place, and the bond that goes with it."""
    at: dict[str, list[DomainBond]] = {name: [] for name in elements}
    for bond in bonds:
        at[bond.tail].append(bond)
        at[bond.head].append(bond)
    for bond in bonds:
        a, b = elements[bond.tail], elements[bond.head]
        if a.kind == b.kind and a.kind in "01" and a.name != b.name:
            gone, kept = (a, b) if not a.component and b.component else (b, a)
            return gone.name, kept.name, bond
    for name, here in at.items():
        if elements[name].kind in "01" and len(here) == 2:
            first, second = here
            passes = (first.head == name) != (second.head == name)
            if passes and first is not second:
                other = first.tail if first.head == name else first.head
                return name, other, first
    return None


def _with_domains(elements: dict[str, Element], bonds: list[DomainBond]) -> list[DomainBond]:
    """Domains carried from the ports through junctions."""
    domains = [bond.domain for bond in bonds]
    spreading = True
    while spreading:
        spreading = False
        known: dict[str, str] = {}
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
