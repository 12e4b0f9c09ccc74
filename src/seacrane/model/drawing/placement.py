"""Where the nodes of a drawing go: on a grid, near what they are joined to, with few crossings.

A first place comes from the stress-minimising layout of NetworkX (T. Kamada and S. Kawai, An algorithm for drawing
general undirected graphs, 1989), which shows the shape of the graph. Snapped to a grid, single nodes are then moved and
swapped as long as the drawing gets better by its own measure.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import networkx as nx
import numpy as np

Cell = tuple[int, int]


def connected(names: Sequence[str], edges: Iterable[tuple[str, str]]) -> list[list[str]]:
    """The nodes in groups that hang together, each in the order of `names`."""
    graph = nx.Graph()
    graph.add_nodes_from(names)
    graph.add_edges_from(edges)
    return [[name for name in names if name in part] for part in nx.connected_components(graph)]


def packed(sizes: Sequence[tuple[float, float]], gap: float) -> list[tuple[float, float]]:
    """Where to put boxes of these sizes: one beside another in rows, the whole about as wide as one and a half high."""
    area = sum((width + gap) * (height + gap) for width, height in sizes)
    widest = max([1.5 * math.sqrt(1.5 * area), *(width for width, _ in sizes)], default=0.0)
    x = y = row = 0.0
    corners = []
    for width, height in sizes:
        if x > 0 and x + width > widest:
            x, y, row = 0.0, y + row + gap, 0.0
        corners.append((x, y))
        x, row = x + width + gap, max(row, height)
    return corners


def sketch(names: Sequence[str], edges: Iterable[tuple[str, str]], *, aspect: float = 1.0) -> dict[str, Cell]:
    """A first place for each node of a connected graph, all different."""
    graph = nx.Graph()
    graph.add_nodes_from(names)
    graph.add_edges_from(edges)
    found = nx.kamada_kawai_layout(graph) if len(names) > 1 else dict.fromkeys(names, (0.0, 0.0))
    spread = 0.75 * math.sqrt(len(names)) + 1
    cells: dict[str, Cell] = {}
    for name in names:
        x, y = (float(v) for v in found[name])
        cells[name] = _nearest_free((round(x * spread * aspect), round(y * spread)), set(cells.values()))
    return cells


def _nearest_free(wanted: Cell, taken: set[Cell]) -> Cell:
    for radius in range(len(taken) + 2):
        ring = [
            (wanted[0] + dx, wanted[1] + dy)
            for dx in range(-radius, radius + 1)
            for dy in range(-radius, radius + 1)
            if max(abs(dx), abs(dy)) == radius and (wanted[0] + dx, wanted[1] + dy) not in taken
        ]
        if ring:
            return min(ring, key=lambda c: (abs(c[0] - wanted[0]) + abs(c[1] - wanted[1]), c))
    raise AssertionError("a ring around the taken cells is free")


@dataclass(frozen=True)
class Edge:
    """A line between two nodes; a light one may be longer and cross others sooner."""

    a: str
    b: str
    weight: float = 1.0


def improve(
    cells: Mapping[str, Cell], edges: Sequence[Edge], spacing: tuple[float, float], sweeps: int = 9
) -> dict[str, Cell]:
    """Move and swap nodes until no single change makes the drawing better, with a little shaking at first.

    `spacing` is the size of a cell [px].
    """
    measure = _Measure(cells, edges, spacing)
    occupant = {cell: i for i, cell in enumerate(measure.cells)}
    random = np.random.default_rng(1)
    for sweep in range(sweeps):
        warmth = 1.5 * max(0.0, 1 - 2 * sweep / sweeps)
        changed = False
        for node in range(len(measure.cells)):
            near = measure.candidates(node)
            free = [cell for cell in near if cell not in occupant]
            gains = list(zip(measure.gains(node, free), free, strict=True)) if free else []
            for cell in near:
                if cell in occupant and (gain := measure.swap_gain(node, occupant[cell])) is not None:
                    gains.append((gain, cell))
            shaken = [(gain + warmth * float(random.standard_normal()), cell) for gain, cell in gains]
            best, cell = max(shaken, default=(0.0, measure.cells[node]))
            if best <= 1e-9:
                continue
            changed = True
            home, other = measure.cells[node], occupant.get(cell)
            measure.move(node, cell)
            del occupant[home]
            if other is not None:
                measure.move(other, home)
                occupant[home] = other
            occupant[cell] = node
        if not changed and warmth == 0.0:
            break
    return dict(zip(cells, measure.cells, strict=True))


Floats = np.ndarray[tuple[int, ...], np.dtype[np.float64]]
Flags = np.ndarray[tuple[int, ...], np.dtype[np.bool_]]
Indices = np.ndarray[tuple[int, ...], np.dtype[np.intp]]


class _Measure:
    """How good a drawing is: short and straight lines that rarely cross, leave a node apart, and run over no other."""

    CROSSING = 2.0
    OVER, CLOSE = (20.0, 20.0), (32.0, 3.0)
    """Distance [px] within which a line runs over a node or close by it, and what that costs."""
    NARROW, MERGING = 0.93, 2.5
    """Cosine of the angle between lines at a node from which on they are hard to tell apart, and what that costs."""
    HOPELESS = 3.0
    """A swap that makes the lines of both nodes longer by this many cells is not looked at any further."""

    def __init__(self, cells: Mapping[str, Cell], edges: Sequence[Edge], spacing: tuple[float, float]) -> None:
        index = {name: i for i, name in enumerate(cells)}
        self.cells = list(cells.values())
        self.at = np.array(self.cells, dtype=float)
        self.ends = np.array([(index[e.a], index[e.b]) for e in edges if e.a != e.b], dtype=int).reshape(-1, 2)
        self.weight = np.array([e.weight for e in edges if e.a != e.b])
        self.spacing = np.array(spacing)
        count = len(self.cells)
        self.mine = [np.flatnonzero((self.ends == i).any(axis=1)) for i in range(count)]
        self.near = [[int(end) for end in self.ends[own].ravel() if end != i] for i, own in enumerate(self.mine)]
        a, b = self.ends[:, 0], self.ends[:, 1]
        shared = (a[:, None] == a) | (a[:, None] == b) | (b[:, None] == a) | (b[:, None] == b)
        self.may_cross = np.where(shared, 0.0, np.minimum(self.weight[:, None], self.weight) * self.CROSSING)
        turned = ((a[:, None] == b) | (b[:, None] == a)).astype(float)
        straight = ((a[:, None] == a) | (b[:, None] == b)).astype(float)
        self.sense = np.where(turned + straight == 1, straight - turned, 0.0)
        """For two lines that meet at one node, whether both leave it or arrive (1), or one does either (-1)."""
        nodes = np.arange(count)
        self.strange = ((a[:, None] != nodes) & (b[:, None] != nodes)) * np.maximum(self.weight, 0.5)[:, None]

    def move(self, node: int, cell: Cell) -> None:
        self.cells[node] = cell
        self.at[node] = cell

    def candidates(self, node: int) -> list[Cell]:
        """Cells beside this node and beside those that it is joined to."""
        x, y = self.cells[node]
        around = [(x, y), *(self.cells[other] for other in self.near[node][:4])]
        found = {(a + dx, b + dy) for a, b in around for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))}
        found |= {(x + dx, y + dy) for dx in (-1, 1) for dy in (-1, 1)}
        found.discard((x, y))
        return sorted(found)

    def gains(self, node: int, cells: Sequence[Cell]) -> list[float]:
        """How much better the drawing gets with the node in each of these cells, which are free."""
        at = np.repeat(self.at[None], len(cells) + 1, axis=0)
        at[1:, node] = cells
        cost = self._cost(at, self.mine[node], [node])
        return [float(g) for g in cost[0] - cost[1:]]

    def swap_gain(self, node: int, other: int) -> float | None:
        """How much better it gets with the two nodes exchanged; None if that is hopeless."""
        at = np.repeat(self.at[None], 2, axis=0)
        at[1, [node, other]] = at[0, [other, node]]
        touched = np.zeros(len(self.ends), dtype=bool)
        touched[self.mine[node]] = touched[self.mine[other]] = True
        involved = np.flatnonzero(touched)
        before, after = (self.weight[involved] * self._lengths(at, involved)).sum(axis=1)
        if after - before > self.HOPELESS:
            return None
        cost = self._cost(at, involved, [node, other])
        return float(cost[0] - cost[1])

    def _lengths(self, at: Floats, edges: Indices) -> Floats:
        """Lengths in cells; oblique lines count as longer. `at` has shape (places, nodes, 2)."""
        d = np.abs(at[:, self.ends[edges, 0]] - at[:, self.ends[edges, 1]])
        dx, dy = d[..., 0], d[..., 1]
        return np.asarray(dx + dy + np.where((dx == 0) | (dy == 0), 0.0, np.where(dx == dy, 0.5, 1.0)))

    def _cost(self, at: Floats, edges: Indices, moved: list[int]) -> Floats:
        """What is bad about these edges, and about these nodes beside other edges, for each of several placements."""
        p, q = at[:, self.ends[edges, 0]], at[:, self.ends[edges, 1]]
        all_p, all_q = at[:, self.ends[:, 0]], at[:, self.ends[:, 1]]
        total = (self.weight[edges] * self._lengths(at, edges)).sum(axis=1)
        total += (_cross(p, q, all_p, all_q) * self.may_cross[edges]).sum(axis=(1, 2))
        total += ((self.sense[edges] * _cosine(q - p, all_q - all_p) > self.NARROW) * self.MERGING).sum(axis=(1, 2))
        total += (self._nuisance(p, q, at) * self.strange[edges]).sum(axis=(1, 2))
        rest = np.ones(len(self.ends), dtype=bool)
        rest[edges] = False
        others = np.flatnonzero(rest)
        beside = self._nuisance(all_p[:, others], all_q[:, others], at[:, moved])
        return np.asarray(total + (beside * self.strange[others][:, moved]).sum(axis=(1, 2)))

    def _nuisance(self, p: Floats, q: Floats, points: Floats) -> Floats:
        """What it costs that lines p q run by the points; shape (places, lines, points)."""
        p, q, points = p * self.spacing, q * self.spacing, points * self.spacing
        along = (q - p)[:, :, None]
        to = points[:, None] - p[:, :, None]
        share = np.clip((to * along).sum(-1) / np.maximum((along * along).sum(-1), 1e-9), 0.0, 1.0)
        off = to - share[..., None] * along
        distance = np.sqrt((off * off).sum(-1))
        (over, dear), (close, cheap) = self.OVER, self.CLOSE
        return np.where(distance < over, dear, np.where(distance < close, cheap, 0.0))


def _cosine(a: Floats, b: Floats) -> Floats:
    """Cosines of the angles between vectors, shapes (places, lines, 2) and (places, others, 2)."""
    a = a / np.maximum(np.sqrt((a * a).sum(-1, keepdims=True)), 1e-9)
    b = b / np.maximum(np.sqrt((b * b).sum(-1, keepdims=True)), 1e-9)
    return np.asarray(a @ b.transpose(0, 2, 1))


def _cross(a: Floats, b: Floats, c: Floats, d: Floats) -> Flags:
    """Whether the open segments a b and c d cross; shapes (places, lines, 2) and (places, others, 2)."""
    a, b, c, d = a[:, :, None], b[:, :, None], c[:, None], d[:, None]

    def side(p: Floats, q: Floats, r: Floats) -> Floats:
        return np.asarray(
            (q[..., 0] - p[..., 0]) * (r[..., 1] - p[..., 1]) - (q[..., 1] - p[..., 1]) * (r[..., 0] - p[..., 0])
        )

    return np.asarray((side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0))


def compact(cells: Mapping[str, Cell]) -> dict[str, Cell]:
    """The same places without empty rows and columns."""
    columns = {x: i for i, x in enumerate(sorted({x for x, _ in cells.values()}))}
    rows = {y: i for i, y in enumerate(sorted({y for _, y in cells.values()}))}
    return {name: (columns[x], rows[y]) for name, (x, y) in cells.items()}
