"""A bond graph as SVG: half arrows, causal strokes, domain colours; what is wrong with the causality in amber."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Final

from .canvas import ALARM, COLOURS, FAINT, INK, Canvas, Point
from .placement import Cell, compact, improve, sketch

if TYPE_CHECKING:
    from seacrane.model.bondgraph import DomainBond, Element, SystemBondGraph

SPACING: Final = (92.0, 66.0)
"""Width and height of a cell of the grid [px]."""


def bond_graph_svg(graph: SystemBondGraph) -> str:
    """See the module."""
    places = compact(_places(graph))
    at = {name: (x * SPACING[0], y * SPACING[1]) for name, (x, y) in places.items()}
    wrong = {finding.element for finding in graph.findings}
    canvas = Canvas()
    for bond in graph.bonds:
        _draw_bond(canvas, bond, at)
    for element in graph.elements:
        joined = [b.tail if b.head == element.name else b.head for b in graph.at(element.name)]
        below = any(at[other][1] > at[element.name][1] for other in joined)
        _draw_element(canvas, element, at[element.name], wrong=element.name in wrong, below=below)
    for i, finding in enumerate(graph.findings):
        low = (max(y for _, y in at.values()) if at else 0.0) + 60
        left = min((x for x, _ in at.values()), default=0.0) - 30
        canvas.text((left, low + 16 * i), f"{finding.sort}: {finding}", colour=ALARM, anchor="start")
    return canvas.document(f"Bond graph of {graph.name}")


def _places(graph: SystemBondGraph) -> dict[str, Cell]:
    names = [element.name for element in graph.elements]
    edges = [(bond.tail, bond.head) for bond in graph.bonds]
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
                total += sum(4.0 for name in names if name not in (tail, head) and _passes(a, b, cells[name]))
            else:
                total += sum(4.0 for name in here if _passes(cells[tail], cells[head], cells[name]))
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


def _draw_element(canvas: Canvas, element: Element, at: Point, *, wrong: bool, below: bool) -> None:
    """The kind, and the names above it if a bond comes from `below`."""
    x, y = at
    own = element.name.removeprefix(f"{element.component}.")
    kind = element.kind if element.kind != "word" else element.name
    canvas.text((x, y + 5), kind, size=15, colour=ALARM if wrong else INK, bold=True)
    if element.kind not in ("0", "1", "word"):
        names = [own, element.component] if element.component and own != element.component else [own]
        top = y - 11 - 9 * (len(names) - 1) if below else y + 16
        for i, name in enumerate(names):
            canvas.text((x, top + 9 * i), name.replace("_", " "), size=8.5, colour=FAINT)
