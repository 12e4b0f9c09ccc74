"""Where the symbols of an iconic diagram go: short lines, ports that face each other, no overlaps.

The first arrangement is that of `placement.sketch`; annealing (S. Kirkpatrick, C. D. Gelatt and M. P. Vecchi,
Optimization by simulated annealing, 1983) then moves and exchanges symbols, from a fixed seed: the same diagram is
drawn the same each time.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Final

import numpy as np

from .canvas import Point
from .placement import connected, packed, sketch

GRID: Final = 10.0
CLEARANCE: Final = 20.0
"""Least distance between symbols [px]: room for a line."""
WIDEST_GAP: Final = 70.0
"""An empty band across the whole drawing is made this narrow [px]."""
MOVES_PER_SYMBOL: Final = 1500

Box = tuple[float, float, float, float]


@dataclass(frozen=True)
class Item:
    """A symbol of a size; `extras` also belong to it (its name, tanks on its ports), `room` is for its lines.

    All boxes are relative to its origin.
    """

    width: float
    height: float
    extras: tuple[Box, ...] = ()
    room: tuple[Box, ...] = ()

    @cached_property
    def reach(self) -> Box:
        boxes = [(0.0, 0.0, self.width, self.height), *self.extras, *self.room]
        return (
            min(b[0] for b in boxes),
            min(b[1] for b in boxes),
            max(b[2] for b in boxes),
            max(b[3] for b in boxes),
        )

    def box_at(self, at: Point, *, body: bool = False) -> Box:
        left, top, right, bottom = (0.0, 0.0, self.width, self.height) if body else self.reach
        return at[0] + left, at[1] + top, at[0] + right, at[1] + bottom


@dataclass(frozen=True)
class Wire:
    """A line that joins ports: (owner, point on its symbol, direction away from it); which ends take a signal."""

    ends: tuple[tuple[str, Point, tuple[int, int]], ...]
    domain: str
    takes: tuple[bool, ...]

    def span(self, at: Mapping[str, Point]) -> float:
        """Half the perimeter of the box around the ends."""
        xs = [at[owner][0] + x for owner, (x, _), _ in self.ends]
        ys = [at[owner][1] + y for owner, (_, y), _ in self.ends]
        return max(xs) - min(xs) + max(ys) - min(ys)

    def cost(self, at: Mapping[str, Point]) -> float:
        """Length, and what makes a line hard to follow: bends, and ports that look away from where the line goes."""
        points = [(at[owner][0] + x, at[owner][1] + y) for owner, (x, y), _ in self.ends]
        total = self.span(at)
        count = len(points)
        cx, cy = sum(x for x, _ in points) / count, sum(y for _, y in points) / count
        for (x, y), (_, _, (dx, dy)) in zip(points, self.ends, strict=True):
            ahead = (cx - x) * dx + (cy - y) * dy
            if ahead < 0:
                total += 60.0 - ahead
            elif ahead < 10:
                total += 30.0
        if count == 2:
            (x0, y0), (x1, y1) = points
            (_, _, (dx, _)), (_, _, (ex, _)) = self.ends
            if (dx and ex and y0 != y1) or (not dx and not ex and x0 != x1):
                total += 25.0
        return total


def arrange(items: Mapping[str, Item], wires: Sequence[Wire]) -> dict[str, Point]:
    """The origin of each symbol, on the grid; parts that no wire joins stand beside one another."""
    pairs = sorted(
        {(a, b) for wire in wires for a, b in itertools.combinations([owner for owner, _, _ in wire.ends], 2) if a != b}
    )
    placed = []
    for names in connected(list(items), pairs):
        inside = {name: items[name] for name in names}
        own = [wire for wire in wires if wire.ends[0][0] in inside]
        placed.append(_arranged(inside, own, [pair for pair in pairs if pair[0] in inside]))
    frames = [_frame(part, items) for part in placed]
    corners = packed([(right - left, bottom - top) for left, top, right, bottom in frames], 4 * GRID)
    return {
        name: (_on_grid(x - left + dx), _on_grid(y - top + dy))
        for part, (left, top, _, _), (dx, dy) in zip(placed, frames, corners, strict=True)
        for name, (x, y) in part.items()
    }


def _arranged(items: Mapping[str, Item], wires: Sequence[Wire], pairs: Sequence[tuple[str, str]]) -> dict[str, Point]:
    """The origins of symbols that are joined, directly or through others."""
    pitch = max(max(i.reach[2] - i.reach[0], i.reach[3] - i.reach[1]) for i in items.values())
    pitch = GRID * math.ceil(pitch / GRID + 6)
    at: dict[str, Point] = {name: (x * pitch, y * pitch) for name, (x, y) in sketch(list(items), pairs).items()}
    if len(items) > 1:
        _anneal(at, items, wires)
    return _squeezed(at, items)


def _squeezed(at: Mapping[str, Point], items: Mapping[str, Item]) -> dict[str, Point]:
    """The same arrangement with wide empty bands across the whole made narrow."""
    boxes = {name: items[name].box_at(point) for name, point in at.items()}
    moved = {}
    for axis in (0, 1):
        reached, shift = -math.inf, 0.0
        for name in sorted(boxes, key=lambda n: boxes[n][axis]):
            gap = boxes[name][axis] - reached
            if math.isfinite(gap) and gap > WIDEST_GAP:
                shift += _on_grid(gap - WIDEST_GAP)
            reached = max(reached, boxes[name][axis + 2])
            moved[name, axis] = at[name][axis] - shift
    return {name: (moved[name, 0], moved[name, 1]) for name in at}


def _frame(at: Mapping[str, Point], items: Mapping[str, Item]) -> Box:
    boxes = [items[name].box_at(point) for name, point in at.items()]
    return min(b[0] for b in boxes), min(b[1] for b in boxes), max(b[2] for b in boxes), max(b[3] for b in boxes)


def _on_grid(value: float) -> float:
    return GRID * round(value / GRID)


def _anneal(at: dict[str, Point], items: Mapping[str, Item], wires: Sequence[Wire]) -> None:
    names = list(items)
    mine: dict[str, list[Wire]] = {name: [] for name in names}
    for wire in wires:
        for owner in {owner for owner, _, _ in wire.ends}:
            mine[owner].append(wire)
    random = np.random.default_rng(7)
    moves = MOVES_PER_SYMBOL * len(names)
    draws = random.random((moves, 4))
    reach = 150.0 * math.sqrt(len(names))
    for step in range(moves):
        cooling = 1 - step / moves
        temperature = 60.0 * cooling**2
        name = names[int(draws[step, 0] * len(names))]
        involved = mine[name]
        if draws[step, 1] < 0.15:
            other = names[int(draws[step, 2] * len(names))]
            if other == name:
                continue
            change = {name: at[other], other: at[name]}
            involved = involved + [wire for wire in mine[other] if wire not in involved]
        elif draws[step, 1] < 0.5 and involved:
            change = {name: _facing(name, involved[int(draws[step, 2] * len(involved))], at, draws[step, 3])}
        else:
            size = max(GRID, reach * cooling**1.5)
            dx, dy = ((2 * d - 1) * size for d in draws[step, 2:])
            x, y = at[name]
            change = {name: (round((x + dx) / GRID) * GRID, round((y + dy) / GRID) * GRID)}
        if _collides(change, at, items):
            continue
        before = sum(wire.cost(at) for wire in involved) + 0.02 * sum(_far(at[n]) for n in change)
        home = {n: at[n] for n in change}
        at.update(change)
        after = sum(wire.cost(at) for wire in involved) + 0.02 * sum(_far(at[n]) for n in change)
        if after > before and draws[step, 3] >= math.exp((before - after) / max(temperature, 1e-6)):
            at.update(home)


def _far(point: Point) -> float:
    return abs(point[0]) + abs(point[1])


def _facing(name: str, wire: Wire, at: Mapping[str, Point], draw: float) -> Point:
    """A place for `name` straight in front of one of the ports that this line joins it to."""
    own = next(end for end in wire.ends if end[0] == name)
    others = [end for end in wire.ends if end[0] != name] or [own]
    owner, (px, py), (dx, dy) = others[int(draw * 997) % len(others)]
    distance = GRID * (3 + int(draw * 7919) % 4)
    x, y = at[owner][0] + px + dx * distance, at[owner][1] + py + dy * distance
    return x - own[1][0], y - own[1][1]


def _collides(change: Mapping[str, Point], at: Mapping[str, Point], items: Mapping[str, Item]) -> bool:
    for name, point in change.items():
        left, top, right, bottom = items[name].box_at(point)
        for other, item in items.items():
            if other == name:
                continue
            a, b, c, d = item.box_at(change.get(other, at[other]))
            apart = right + CLEARANCE <= a or c + CLEARANCE <= left or bottom + CLEARANCE <= b or d + CLEARANCE <= top
            if not apart:
                return True
    return False
