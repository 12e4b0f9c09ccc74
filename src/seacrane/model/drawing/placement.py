"""Where the nodes of a drawing go: on a grid, near what they are joined to, with few crossings.

A first place comes from the stress-minimising layout of NetworkX (T. Kamada and S. Kawai, An algorithm for drawing
general undirected graphs, 1989), which shows the shape of the graph. Snapped to a grid, single nodes are then moved and
swapped as long as the drawing gets better by its own measure.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence

import networkx as nx
import numpy as np

Cell = tuple[int, int]
Cost = Callable[[Mapping[str, Cell], Iterable[str]], float]
"""What is bad about the edges (and places) of the named nodes, all others staying where they are."""


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


def improve(
    cells: Mapping[str, Cell], near: Mapping[str, Sequence[str]], cost: Cost, sweeps: int = 12
) -> dict[str, Cell]:
    """Move and swap nodes until no single change makes the drawing better, with a little shaking at first."""
    cells = dict(cells)
    occupant = {cell: name for name, cell in cells.items()}
    random = np.random.default_rng(1)
    for sweep in range(sweeps):
        warmth = 1.5 * max(0.0, 1 - 2 * sweep / sweeps)
        changed = False
        for name in cells:
            best, gain = None, 1e-9
            for cell in _candidates(name, cells, near):
                other = occupant.get(cell)
                moved = [name] if other is None else [name, other]
                before = cost(cells, moved)
                home = cells[name]
                cells[name] = cell
                if other is not None:
                    cells[other] = home
                better = before - cost(cells, moved) + warmth * float(random.standard_normal())
                cells[name] = home
                if other is not None:
                    cells[other] = cell
                if better > gain:
                    best, gain = cell, better
            if best is not None:
                changed = True
                other, home = occupant.get(best), cells[name]
                cells[name], occupant[best] = best, name
                if other is None:
                    del occupant[home]
                else:
                    cells[other], occupant[home] = home, other
        if not changed and warmth == 0.0:
            break
    return cells


def _candidates(name: str, cells: Mapping[str, Cell], near: Mapping[str, Sequence[str]]) -> list[Cell]:
    x, y = cells[name]
    around = [(x, y), *(cells[other] for other in near[name][:4])]
    found = {(a + dx, b + dy) for a, b in around for dx, dy in ((1, 0), (-1, 0), (0, 1), (0, -1))}
    found |= {(x + dx, y + dy) for dx in (-1, 1) for dy in (-1, 1)}
    found.discard((x, y))
    return sorted(found)


def compact(cells: Mapping[str, Cell]) -> dict[str, Cell]:
    """The same places without empty rows and columns."""
    columns = {x: i for i, x in enumerate(sorted({x for x, _ in cells.values()}))}
    rows = {y: i for i, y in enumerate(sorted({y for _, y in cells.values()}))}
    return {name: (columns[x], rows[y]) for name, (x, y) in cells.items()}
