"""Lines at right angles on a grid, around the symbols: each is a cheapest path; bends and crossings cost extra."""

from __future__ import annotations

import heapq
import itertools
from collections.abc import Iterable, Sequence
from typing import Final

from .arrangement import GRID, Box
from .canvas import Point

BEND: Final = 5.0
CROSSING: Final = 8.0
BESIDE: Final = 1.5
"""Cost of one grid step beside another line or a symbol; a free step costs 1."""
MARGIN: Final = 12
"""Grid steps around everything within which lines may run."""

Cell = tuple[int, int]
Step = tuple[int, int]
_STEPS: Final[tuple[Step, ...]] = ((1, 0), (0, 1), (-1, 0), (0, -1))


class Router:
    """Finds lines one after the other; each keeps clear of the symbols and of the lines before it."""

    def __init__(self, boxes: Iterable[Box]) -> None:
        self._blocked: set[Cell] = set()
        self._used: dict[Cell, set[bool]] = {}
        """Cells that lines pass through, with whether they run horizontally there."""
        self._reserved: dict[Cell, Cell] = {}
        """Cells in front of a port, where only the line of that port may run."""
        self._bounds = [0, 0, 0, 0]
        for box in boxes:
            self.block(box)

    def block(self, box: Box) -> None:
        """Keep lines out of a box."""
        left, top, right, bottom = (round(v / GRID) for v in box)
        self._blocked |= {(x, y) for x in range(left, right + 1) for y in range(top, bottom + 1)}
        b = self._bounds
        self._bounds = [min(b[0], left), min(b[1], top), max(b[2], right), max(b[3], bottom)]

    def reserve(self, at: Point, step: Step) -> None:
        """Keep the cells in front of a port free for its own line."""
        port = (round(at[0] / GRID), round(at[1] / GRID))
        for i in (1, 2):
            self._reserved.setdefault((port[0] + i * step[0], port[1] + i * step[1]), port)

    def tree(self, ends: Sequence[tuple[Point, Step]]) -> tuple[list[list[Point]], list[Point]]:
        """Lines that join all ends (points with the direction in which a line leaves them), and where lines meet."""
        starts = [((round(x / GRID), round(y / GRID)), step) for (x, y), step in ends]
        joined = {starts[0][0]}
        own = {cell for cell, _ in starts}
        paths: list[list[Cell]] = []
        joints: list[Cell] = []
        first, leaves = starts[0]
        rest = sorted(starts[1:], key=lambda s: abs(s[0][0] - first[0]) + abs(s[0][1] - first[1]))
        for cell, step in rest:
            path = self._path(cell, step, joined, own, first, leaves)
            paths.append(path)
            if path[-1] != first or len(paths) > 1:
                joints.append(path[-1])
            joined.update(path)
        for path in paths:
            for a, b in itertools.pairwise(path):
                for cell in (a, b):
                    self._used.setdefault(cell, set()).add(a[1] == b[1])
        return (
            [[(x * GRID, y * GRID) for x, y in _corners(path)] for path in paths],
            [(x * GRID, y * GRID) for x, y in joints if (x, y) not in own],
        )

    def _path(
        self, start: Cell, step: Step, targets: set[Cell], own: set[Cell], first: Cell, leaves: Step
    ) -> list[Cell]:
        """The cheapest way from a port to any cell of the tree; the first port is entered against its direction."""
        queue: list[tuple[float, Cell, Step]] = [(0.0, start, step)]
        best: dict[tuple[Cell, Step], float] = {(start, step): 0.0}
        came: dict[tuple[Cell, Step], tuple[Cell, Step]] = {}
        low_x, low_y, high_x, high_y = self._bounds
        while queue:
            cost, cell, heading = heapq.heappop(queue)
            if cost > best[cell, heading]:
                continue
            if cell in targets and cell != start:
                if cell != first or heading == (-leaves[0], -leaves[1]):
                    return _walk_back(came, (cell, heading), start)
                continue
            for turn in _STEPS:
                if turn == (-heading[0], -heading[1]) or (cell == start and turn != step):
                    continue
                after = (cell[0] + turn[0], cell[1] + turn[1])
                inside = low_x - MARGIN <= after[0] <= high_x + MARGIN and low_y - MARGIN <= after[1] <= high_y + MARGIN
                if not inside or (after in self._blocked and after not in targets):
                    continue
                friction = self._friction(after, turn)
                if friction is None or self._reserved.get(after, start) not in own:
                    continue
                total = cost + 1.0 + (BEND if turn != heading else 0.0) + friction
                if total < best.get((after, turn), float("inf")):
                    best[after, turn] = total
                    came[after, turn] = (cell, heading)
                    heapq.heappush(queue, (total, after, turn))
        return [start, first]  # walled in: a straight line is better than none

    def _friction(self, cell: Cell, step: Step) -> float | None:
        """What a step into a cell costs beside its length; None where it would run on top of another line."""
        horizontal = step[1] == 0
        here = self._used.get(cell)
        if here is not None:
            return None if horizontal in here else CROSSING
        x, y = cell
        sides = ((x, y - 1), (x, y + 1)) if horizontal else ((x - 1, y), (x + 1, y))
        beside = any(side in self._blocked or horizontal in self._used.get(side, ()) for side in sides)
        return BESIDE if beside else 0.0


def _walk_back(came: dict[tuple[Cell, Step], tuple[Cell, Step]], state: tuple[Cell, Step], start: Cell) -> list[Cell]:
    path = [state[0]]
    while state in came:
        state = came[state]
        path.append(state[0])
    assert path[-1] == start
    return path[::-1]


def _corners(path: Sequence[Cell]) -> list[Cell]:
    """The ends and the bends of a path."""
    kept = [path[0]]
    for before, here, after in zip(path, path[1:], path[2:], strict=False):
        if (here[0] - before[0], here[1] - before[1]) != (after[0] - here[0], after[1] - here[1]):
            kept.append(here)
    return [*kept, path[-1]]
