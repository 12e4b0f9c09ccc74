"""A bond graph as SVG: half arrows, causal strokes, domain colours; what is wrong with the causality in amber.

A diagram placed in another is drawn as a word with its ports, and laid open in a frame of its own below; diagrams that
are alike share a frame. A source that many branches hang on (a tank, a ring line) is drawn anew at each of them, as it
is in circuit diagrams. Signals are dashed, with full arrows, between elements and the blocks that they come through.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from .canvas import ALARM, COLOURS, FAINT, INK, Canvas, Point, stacked
from .placement import Cell, Edge, compact, connected, improve, packed, sketch

if TYPE_CHECKING:
    from seacrane.model.bondgraph import DomainBond, Element, Link, SystemBondGraph

SPACING: Final = (92.0, 66.0)
"""Width and height of a cell of the grid [px]."""
BRANCHES: Final = 3
"""From this many branches on, a source is drawn at each."""
COPY: Final = "#"
"""Stands before the number of a copy in the names of copies."""
PORT: Final = "port"
"""Kind of the element that stands for a port of the diagram that a sheet shows."""


@dataclass(frozen=True)
class Sheet:
    """What one frame shows: the inside of a diagram, with words for the diagrams in it and its own ports."""

    scope: str
    elements: tuple[Element, ...]
    bonds: tuple[DomainBond, ...]
    links: tuple[Link, ...]
    wrong: frozenset[str]

    def local(self, name: str) -> str:
        """A name without that of the diagram shown."""
        return name.replace(f"{self.scope}.", "") if self.scope else name

    @property
    def likeness(self) -> object:
        """What it has in common with the sheets that look like it."""
        return (
            tuple((self.local(e.name), e.kind, e.name in self.wrong) for e in self.elements),
            tuple((self.local(b.tail), self.local(b.head), b.effort_to == b.head) for b in self.bonds),
            tuple((self.local(link.tail), self.local(link.head)) for link in self.links),
        )


def bond_graph_svg(graph: SystemBondGraph) -> str:
    """See the module."""
    alike: dict[object, list[Sheet]] = {}
    for scope in _scopes(graph):
        sheet = _with_sources_at_hand(_sheet(graph, scope))
        alike.setdefault(sheet.likeness, []).append(sheet)
    frames = [(", ".join(sheet.scope for sheet in sheets), _drawn(sheets[0])) for sheets in alike.values()]
    findings = [f"{finding.sort}: {finding}" for finding in graph.findings]
    return stacked(frames, findings).document(f"Bond graph of {graph.name}")


# ---------------------------------------------------------------- sheets
def _scopes(graph: SystemBondGraph) -> list[str]:
    """The whole, and every diagram placed in it or in one of these."""
    found = [""]
    for element in graph.elements:
        steps = element.scope.split(".") if element.scope else []
        found += [".".join(steps[: i + 1]) for i in range(len(steps))]
    return list(dict.fromkeys(found))


def _sheet(graph: SystemBondGraph, scope: str) -> Sheet:
    """The elements of a diagram, words for the diagrams in it, and its ports."""
    from seacrane.model.bondgraph import WORD, Element

    known = {element.name: element for element in graph.elements}
    inside = f"{scope}." if scope else ""
    shown = {element.name: element for element in graph.elements if element.scope == scope}

    def end(name: str, ports: Mapping[str, str], other: str) -> str:
        """The element of this sheet that stands for one of the whole graph."""
        where = known[name].scope
        if where == scope:
            return name
        if where.startswith(inside):
            word = inside + where.removeprefix(inside).partition(".")[0]
            shown[word] = Element(word, WORD, "", scope)
            return word
        port = ports.get(scope, other)
        shown[f"{inside}{PORT} {port}"] = Element(f"{inside}{PORT} {port}", PORT, "", scope)
        return f"{inside}{PORT} {port}"

    def seen(tail: str, head: str) -> bool:
        near = [known[name].scope == scope or known[name].scope.startswith(inside) for name in (tail, head)]
        if not any(near):
            return False
        a, b = (known[name].scope for name in (tail, head))
        deeper = a != scope and b != scope and all(near)
        return not deeper or a.removeprefix(inside).partition(".")[0] != b.removeprefix(inside).partition(".")[0]

    bonds, links = [], []
    for bond in graph.bonds:
        if seen(bond.tail, bond.head):
            tail, head = end(bond.tail, bond.ports, bond.head), end(bond.head, bond.ports, bond.tail)
            effort_to = None if bond.effort_to is None else tail if bond.effort_to == bond.tail else head
            bonds.append(replace(bond, tail=tail, head=head, effort_to=effort_to))
    for link in graph.links:
        if seen(link.tail, link.head):
            tail, head = end(link.tail, link.ports, link.head), end(link.head, link.ports, link.tail)
            links.append(replace(link, tail=tail, head=head))
    single = {(link.tail, link.head): link for link in links}
    wrong = frozenset(finding.element for finding in graph.findings)
    return Sheet(scope, tuple(shown.values()), tuple(bonds), tuple(single.values()), wrong)


def _with_sources_at_hand(sheet: Sheet) -> Sheet:
    """The same with an Se at each branch of a 0 junction that an Se holds, and an Sf at each of a 1 junction."""
    elements = {element.name: element for element in sheet.elements}
    bonds, links = list(sheet.bonds), list(sheet.links)
    for source in sheet.elements:
        own = [bond for bond in bonds if source.name in (bond.tail, bond.head)]
        if source.kind not in ("Se", "Sf") or source.name in sheet.wrong or len(own) != 1:
            continue
        junction = own[0].head if own[0].tail == source.name else own[0].tail
        branches = [bond for bond in bonds if junction in (bond.tail, bond.head) and bond is not own[0]]
        kind = "0" if source.kind == "Se" else "1"
        if elements[junction].kind != kind or junction in sheet.wrong or len(branches) < BRANCHES:
            continue
        del elements[source.name], elements[junction]
        bonds.remove(own[0])
        for i, branch in enumerate(branches):
            name = f"{source.name}{COPY}{i}"
            elements[name] = replace(source, name=name)
            tail, head = (name if end == junction else end for end in (branch.tail, branch.head))
            effort_to = branch.effort_to if branch.effort_to != junction else name
            bonds[bonds.index(branch)] = replace(branch, tail=tail, head=head, effort_to=effort_to)
        first = f"{source.name}{COPY}0"
        links = [replace(link, tail=first) if link.tail in (junction, source.name) else link for link in links]
    return replace(sheet, elements=tuple(elements.values()), bonds=tuple(bonds), links=tuple(links))


# ---------------------------------------------------------------- places
def _places(sheet: Sheet) -> dict[str, Cell]:
    """The cell of each element; parts that do not hang together stand beside one another."""
    edges = [Edge(b.tail, b.head, 1.0) for b in sheet.bonds] + [Edge(s.tail, s.head, 0.4) for s in sheet.links]
    groups = connected([element.name for element in sheet.elements], [(e.a, e.b) for e in edges])
    placed = []
    for names in groups:
        own = [edge for edge in edges if edge.a in set(names)]
        first = sketch(names, [(e.a, e.b) for e in own], aspect=1.3)
        placed.append(compact(improve(first, own, SPACING)))
    sizes = [(max(x for x, _ in part.values()) + 1.0, max(y for _, y in part.values()) + 1.0) for part in placed]
    return {
        name: (x + round(left), y + round(top))
        for part, (left, top) in zip(placed, packed(sizes, 1), strict=True)
        for name, (x, y) in part.items()
    }


# ---------------------------------------------------------------- drawing
def _drawn(sheet: Sheet) -> Canvas:
    places = _places(sheet)
    at = {name: (x * SPACING[0], y * SPACING[1]) for name, (x, y) in places.items()}
    reach = {element.name: _reach(sheet, element) for element in sheet.elements}
    for element in sheet.elements:
        if element.kind in ("0", "1"):  # room for the strokes of many bonds around it
            room = max(9.0, 2.0 * sum(element.name in (bond.tail, bond.head) for bond in sheet.bonds))
            reach[element.name] = (room, room)
    canvas = Canvas()
    joined = [(link.tail, link.head) for link in sheet.links] + [(bond.tail, bond.head) for bond in sheet.bonds]
    lines = [(at[tail], at[head]) for tail, head in joined]
    bonded = {frozenset((bond.tail, bond.head)) for bond in sheet.bonds}
    for link in sheet.links:
        _draw_link(canvas, link, at, reach, aside=8.0 if frozenset((link.tail, link.head)) in bonded else 0.0)
    for bond in sheet.bonds:
        _draw_bond(canvas, bond, at, reach)
    taken = [(x - w, y - h, x + w, y + h) for (x, y), (w, h) in ((at[n], reach[n]) for n in at)]
    for element in sheet.elements:
        _draw_element(canvas, sheet, element, at[element.name])
        names = _names(sheet, element)
        if names:
            _draw_names(canvas, names, at[element.name], reach[element.name], lines, taken)
    return canvas


def _title(sheet: Sheet, element: Element) -> str:
    """The words that stand for an element of no kind of its own."""
    return sheet.local(element.name).removeprefix(f"{PORT} ").replace("_", " ")


def _boxed(element: Element) -> bool:
    return element.kind in ("word", "block")


def _reach(sheet: Sheet, element: Element) -> Point:
    """Half the width and height of what stands for an element."""
    if _boxed(element):
        return 2.8 * len(_title(sheet, element)) + 7, 11.0
    if element.kind == PORT:
        return 2.8 * len(_title(sheet, element)) + 4, 8.0
    return 5.0 * len(element.kind) + 3, 9.0


def _names(sheet: Sheet, element: Element) -> list[str]:
    """The names that stand beside an element: its own, and that of its component."""
    if element.kind in ("0", "1", PORT) or _boxed(element):
        return []
    whole, component = sheet.local(element.name.partition(COPY)[0]), sheet.local(element.component)
    own = whole.removeprefix(f"{component}.")
    return [name.replace("_", " ") for name in ([own, component] if component and own != component else [own])]


def _ends(a: Point, b: Point, reach_a: Point, reach_b: Point) -> tuple[Point, Point, float, float]:
    """Where a line from a to b leaves what stands there and where it arrives, and its direction."""
    distance = math.hypot(b[0] - a[0], b[1] - a[1])
    ux, uy = (b[0] - a[0]) / distance, (b[1] - a[1]) / distance

    def gap(reach: Point) -> float:
        return min((reach[0] + 5) / max(abs(ux), 1e-9), (reach[1] + 5) / max(abs(uy), 1e-9), math.hypot(*reach) + 5)

    start, stop = gap(reach_a), distance - gap(reach_b)
    return (a[0] + start * ux, a[1] + start * uy), (a[0] + stop * ux, a[1] + stop * uy), ux, uy


def _draw_bond(canvas: Canvas, bond: DomainBond, at: Mapping[str, Point], reach: Mapping[str, Point]) -> None:
    tail, head, ux, uy = _ends(at[bond.tail], at[bond.head], reach[bond.tail], reach[bond.head])
    colour = COLOURS[bond.domain]
    canvas.line([tail, head], colour)
    barb = (head[0] - 9 * ux + 5 * uy, head[1] - 9 * uy - 5 * ux)
    canvas.line([head, barb], colour)
    if bond.effort_to is not None:
        x, y = head if bond.effort_to == bond.head else tail
        canvas.line([(x - 6 * uy, y + 6 * ux), (x + 6 * uy, y - 6 * ux)], colour, width=2.2)


def _draw_link(
    canvas: Canvas, link: Link, at: Mapping[str, Point], reach: Mapping[str, Point], *, aside: float
) -> None:
    """The arrow of a signal, moved `aside` [px] where a bond runs between the same elements."""
    tail, head, ux, uy = _ends(at[link.tail], at[link.head], reach[link.tail], reach[link.head])
    tail, head = ((x - aside * uy, y + aside * ux) for x, y in (tail, head))
    colour = COLOURS["signal"]
    canvas.line([tail, head], colour, width=1.0, dash="4 3")
    for side in (1, -1):
        canvas.line([head, (head[0] - 7 * ux + side * 3 * uy, head[1] - 7 * uy - side * 3 * ux)], colour, width=1.0)


def _draw_element(canvas: Canvas, sheet: Sheet, element: Element, at: Point) -> None:
    x, y = at
    colour = ALARM if element.name in sheet.wrong else INK
    if element.kind == PORT:
        canvas.text((x, y + 4), _title(sheet, element), size=10, colour=FAINT)
    elif _boxed(element):
        width, height = _reach(sheet, element)
        word = element.kind == "word"
        canvas.box((x - width, y - height), (2 * width, 2 * height), colour, rounded=0 if word else 5)
        canvas.text((x, y + 3.5), _title(sheet, element), size=10 if word else 9, colour=colour, bold=word)
    else:
        canvas.text((x, y + 5), element.kind, size=15, colour=colour, bold=True)


Box = tuple[float, float, float, float]


def _draw_names(
    canvas: Canvas,
    names: Sequence[str],
    at: Point,
    reach: Point,
    lines: Sequence[tuple[Point, Point]],
    taken: list[Box],
) -> None:
    """The names on the side of an element where they meet the fewest lines and other words."""
    size, height = 8.5, 9.5
    width = 0.55 * size * max(map(len, names))
    boxes = [*_around(at, reach, width, height * len(names))]
    segments = np.array(lines, dtype=float).reshape(-1, 4)
    costs = [
        0.1 * i + 2 * _crossed(box, segments) + 3 * sum(_overlap(box, t) for t in taken) for i, box in enumerate(boxes)
    ]
    left, top, right, bottom = boxes[costs.index(min(costs))]
    taken.append((left, top, right, bottom))
    for i, line in enumerate(names):
        canvas.text(((left + right) / 2, top + height * (i + 0.8)), line, size=size, colour=FAINT)


def _around(at: Point, reach: Point, width: float, height: float) -> Iterator[Box]:
    """Places for words beside an element, the best first: below, above, at the sides, at the corners."""
    (x, y), (w, h) = at, reach
    for centre_x, top in (
        (x, y + h),
        (x, y - h - height),
        (x + w + 2 + width / 2, y - height / 2),
        (x - w - 2 - width / 2, y - height / 2),
        (x + 3 + width / 2, y + h - 2),
        (x - 3 - width / 2, y + h - 2),
        (x + 3 + width / 2, y - h - height + 2),
        (x - 3 - width / 2, y - h - height + 2),
    ):
        yield centre_x - width / 2, top, centre_x + width / 2, top + height


def _overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def _crossed(box: Box, segments: np.ndarray[tuple[int, ...], np.dtype[np.float64]]) -> int:
    """How many of the segments (rows x0, y0, x1, y1) pass through a box, by clipping them against its sides."""
    if not segments.size:
        return 0
    start, step = segments[:, :2], segments[:, 2:] - segments[:, :2]
    step = np.where(step == 0, 1e-9, step)
    first, second = (np.array(box[:2]) - start) / step, (np.array(box[2:]) - start) / step
    enter = np.minimum(first, second).max(axis=1)
    leave = np.maximum(first, second).min(axis=1)
    return int(np.count_nonzero((enter < leave) & (leave > 0) & (enter < 1)))
