"""A bond graph as SVG: half arrows, causal strokes, domain colours; what is wrong with the causality in amber.

A source that many branches hang on (a tank, a ring line) is drawn anew at each of them, as it is in circuit diagrams.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Final

from .canvas import ALARM, COLOURS, FAINT, INK, Canvas, Point
from .placement import Cell, compact, connected, improve, packed, sketch

if TYPE_CHECKING:
    from seacrane.model.bondgraph import DomainBond, Element, SystemBondGraph

SPACING: Final = (92.0, 66.0)
"""Width and height of a cell of the grid [px]."""
BRANCHES: Final = 3
"""From this many branches on, a source is drawn at each."""
COPY: Final = "#"
"""Stands before the number of a copy in the names of copies."""


def bond_graph_svg(graph: SystemBondGraph) -> str:
    """See the module."""
    graph = _with_sources_at_hand(graph)
    places = _places(graph)
    at = {name: (x * SPACING[0], y * SPACING[1]) for name, (x, y) in places.items()}
    wrong = {finding.element for finding in graph.findings}
    canvas = Canvas()
    for bond in graph.bonds:
        _draw_bond(canvas, bond, at)
    for element in graph.elements:
        x, y = at[element.name]
        joined = [at[b.tail if b.head == element.name else b.head] for b in graph.at(element.name)]
        directions = {(_sign(other[0] - x), _sign(other[1] - y)) for other in joined}
        _draw_element(canvas, element, (x, y), wrong=element.name in wrong, directions=directions)
    for i, finding in enumerate(graph.findings):
        low = (max(y for _, y in at.values()) if at else 0.0) + 60
        left = min((x for x, _ in at.values()), default=0.0) - 30
        canvas.text((left, low + 16 * i), f"{finding.sort}: {finding}", colour=ALARM, anchor="start")
    return canvas.document(f"Bond graph of {graph.name}")


def _with_sources_at_hand(graph: SystemBondGraph) -> SystemBondGraph:
    """The same graph with an Se at each branch of a 0 junction that an Se holds, and an Sf at each of a 1 junction."""
    elements = {element.name: element for element in graph.elements}
    bonds = list(graph.bonds)
    wrong = {finding.element for finding in graph.findings}
    for source in graph.elements:
        if source.kind not in ("Se", "Sf") or source.name in wrong:
            continue
        (own,) = graph.at(source.name)
        junction = own.head if own.tail == source.name else own.tail
        branches = [bond for bond in bonds if junction in (bond.tail, bond.head) and bond is not own]
        kind = "0" if source.kind == "Se" else "1"
        if elements[junction].kind != kind or junction in wrong or len(branches) < BRANCHES:
            continue
        del elements[source.name], elements[junction]
        bonds.remove(own)
        for i, branch in enumerate(branches):
            name = f"{source.name}{COPY}{i}"
            elements[name] = replace(source, name=name)
            tail, head = (name if end == junction else end for end in (branch.tail, branch.head))
            effort_to = branch.effort_to if branch.effort_to != junction else name
            bonds[bonds.index(branch)] = replace(branch, tail=tail, head=head, effort_to=effort_to)
    return replace(graph, elements=tuple(elements.values()), bonds=tuple(bonds))


def _sign(value: float) -> int:
    return (value > 0) - (value < 0)


def _places(graph: SystemBondGraph) -> dict[str, Cell]:
    """The cell of each element; parts of the graph that do not hang together stand beside one another."""
    edges = [(bond.tail, bond.head) for bond in graph.bonds]
    groups = connected([element.name for element in graph.elements], edges)
    placed = [compact(_places_of(names, [edge for edge in edges if edge[0] in set(names)])) for names in groups]
    sizes = [(max(x for x, _ in part.values()) + 1.0, max(y for _, y in part.values()) + 1.0) for part in placed]
    return {
        name: (x + round(left), y + round(top))
        for part, (left, top) in zip(placed, packed(sizes, 1), strict=True)
        for name, (x, y) in part.items()
    }


def _places_of(names: list[str], edges: list[tuple[str, str]]) -> dict[str, Cell]:
    near: dict[str, list[str]] = {name: [] for name in names}
    for tail, head in edges:
        near[tail].append(head)
        near[head].append(tail)

    def length(a: Cell, b: Cell) -> float:
        dx, dy = abs(a[0] - b[0]), abs(a[1] - b[1])
        return dx + dy + (0.0 if not dx or not dy else 0.5 if dx == dy else 1.0)

    def cost(cells: Mapping[str, Cell], moved: Iterable[str]) -> float:
        here = set(moved)
        total = 0.0
        for tail, head in edges:
            if tail in here or head in here:
                a, b = cells[tail], cells[head]
                total += length(a, b)
                total += sum(2.0 for s, t in edges if len({tail, head, s, t}) == 4 and _meet(a, b, cells[s], cells[t]))
                total += sum(12.0 for name in names if name not in (tail, head) and _passes(a, b, cells[name]))
            else:
                total += sum(12.0 for name in here if _passes(cells[tail], cells[head], cells[name]))
        return total

    return improve(sketch(names, edges, aspect=1.3), near, cost)


def _meet(a: Cell, b: Cell, c: Cell, d: Cell) -> bool:
    """Whether the open segments a b and c d cross."""

    def side(p: Cell, q: Cell, r: Cell) -> int:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


def _passes(a: Cell, b: Cell, p: Cell) -> bool:
    """Whether p lies on the segment a b, between its ends."""
    if (b[0] - a[0]) * (p[1] - a[1]) != (b[1] - a[1]) * (p[0] - a[0]):
        return False
    along = (p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1])
    return 0 < along < (b[0] - a[0]) ** 2 + (b[1] - a[1]) ** 2


def _draw_bond(canvas: Canvas, bond: DomainBond, at: Mapping[str, Point]) -> None:
    (x0, y0), (x1, y1) = at[bond.tail], at[bond.head]
    distance = math.hypot(x1 - x0, y1 - y0)
    ux, uy = (x1 - x0) / distance, (y1 - y0) / distance
    gap = 15.0 + 5.0 * abs(ux)  # words are wider than they are high
    tail, head = (x0 + gap * ux, y0 + gap * uy), (x1 - gap * ux, y1 - gap * uy)
    colour = COLOURS[bond.domain]
    canvas.line([tail, head], colour)
    barb = (head[0] - 9 * ux + 5 * uy, head[1] - 9 * uy - 5 * ux)
    canvas.line([head, barb], colour)
    if bond.effort_to is not None:
        x, y = head if bond.effort_to == bond.head else tail
        canvas.line([(x - 6 * uy, y + 6 * ux), (x + 6 * uy, y - 6 * ux)], colour, width=2.2)


def _draw_element(
    canvas: Canvas, element: Element, at: Point, *, wrong: bool, directions: set[tuple[int, int]]
) -> None:
    """The kind, and the names on a side that no bond comes from: below, above, right or left."""
    x, y = at
    name = element.name.partition(COPY)[0]
    own = name.removeprefix(f"{element.component}.")
    kind = element.kind if element.kind != "word" else name
    canvas.text((x, y + 5), kind, size=15, colour=ALARM if wrong else INK, bold=True)
    if element.kind in ("0", "1", "word"):
        return
    lines = [own, element.component] if element.component and own != element.component else [own]
    above = y - 11 - 9 * (len(lines) - 1)
    beside = y + 3 - 4.5 * (len(lines) - 1)
    half = 5.0 * len(kind) + 3
    sides = {(0, 1): (x, y + 16, "middle"), (0, -1): (x, above, "middle")}
    sides |= {(1, 0): (x + half, beside, "start"), (-1, 0): (x - half, beside, "end")}
    left, top, anchor = next((place for side, place in sides.items() if side not in directions), sides[0, 1])
    for i, line in enumerate(lines):
        canvas.text((left, top + 9 * i), line.replace("_", " "), size=8.5, colour=FAINT, anchor=anchor)
