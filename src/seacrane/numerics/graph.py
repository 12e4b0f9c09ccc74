"""Graphs of equations and unknowns: maximum matching and strongly connected components in order of solution."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np


def match(incidence: Sequence[Sequence[int]], n_columns: int) -> list[int]:
    """A maximum matching of rows to columns.

    `incidence[i]` lists the columns in which row i occurs. Returns for each row its column, or -1 if it has none
    (Hopcroft and Karp, An n^5/2 algorithm for maximum matchings in bipartite graphs, 1973).
    """
    # Here, as it takes long to load: no process that only runs what is compiled needs it.
    from scipy.sparse import csr_matrix
    from scipy.sparse.csgraph import maximum_bipartite_matching

    n_rows = len(incidence)
    if n_rows == 0 or n_columns == 0:
        return [-1] * n_rows
    columns = np.concatenate([np.asarray(row, dtype=np.int32) for row in incidence])
    pointers = np.concatenate([[0], np.cumsum([len(row) for row in incidence])]).astype(np.int32)
    matrix = csr_matrix((np.ones(len(columns)), columns, pointers), shape=(n_rows, n_columns))
    return [int(column) for column in maximum_bipartite_matching(matrix, perm_type="column")]


def reachable(start: int, successors: Sequence[Sequence[int]]) -> set[int]:
    """All nodes that can be reached from `start`, itself included."""
    found, stack = {start}, [start]
    while stack:
        for node in successors[stack.pop()]:
            if node not in found:
                found.add(node)
                stack.append(node)
    return found


def components_in_order(successors: Sequence[Sequence[int]]) -> list[list[int]]:
    """Strongly connected components, each before every component that points to it.

    `successors[i]` lists the nodes that node i needs; so a component comes after all it needs
    (Tarjan, Depth-first search and linear graph algorithms, 1972; written without recursion).
    """
    n = len(successors)
    index, low, on_stack = [-1] * n, [0] * n, [False] * n
    stack: list[int] = []
    result: list[list[int]] = []
    counter = 0
    for root in range(n):
        if index[root] >= 0:
            continue
        work = [(root, 0)]
        while work:
            node, position = work.pop()
            if position == 0:
                index[node] = low[node] = counter
                counter += 1
                stack.append(node)
                on_stack[node] = True
            descended = False
            for k in range(position, len(successors[node])):
                needed = successors[node][k]
                if index[needed] < 0:
                    work += [(node, k + 1), (needed, 0)]
                    descended = True
                    break
                if on_stack[needed]:
                    low[node] = min(low[node], index[needed])
            if descended:
                continue
            if low[node] == index[node]:
                component = []
                while True:
                    member = stack.pop()
                    on_stack[member] = False
                    component.append(member)
                    if member == node:
                        break
                result.append(sorted(component))
            if work:
                parent = work[-1][0]
                low[parent] = min(low[parent], low[node])
    return result


@dataclass(frozen=True)
class Torn:
    """A block of equations made sequential: once the columns `tears` are known, each pair (row, column) of `order`
    gives its column by its row, and the rows `residuals` must hold. Residuals and tears are as many."""

    tears: list[int]
    order: list[tuple[int, int]]
    residuals: list[int]


def tear(rows: Sequence[Sequence[int]], solvable: Sequence[Sequence[int]], preferred: Sequence[int]) -> Torn:
    """Choose few columns of a square block such that the others follow from them one by one.

    `rows[i]` lists the columns in row i, `solvable[i]` those for which it can be solved, `preferred` all columns, those
    to be torn first in front. Greedy: of the columns in the most rows, take the one that lets the most others follow
    (after Cellier and Kofman, Continuous System Simulation, 2006, section 7.8).
    """
    where: list[list[int]] = [[] for _ in preferred]
    for i, row in enumerate(rows):
        for j in row:
            where[j].append(i)
    rank = {column: place for place, column in enumerate(preferred)}
    may = [frozenset(row) for row in solvable]
    open_of = [set(row) for row in rows]
    used = [False] * len(rows)
    known = [False] * len(preferred)
    tears: list[int] = []
    order: list[tuple[int, int]] = []

    def follow(start: int, opened: Callable[[int], set[int]], taken: set[int]) -> list[tuple[int, int]]:
        """What becomes known once `start` is: applied by the caller, or only counted."""
        found: list[tuple[int, int]] = []
        stack = [start]
        while stack:
            column = stack.pop()
            for i in where[column]:
                left = opened(i)
                left.discard(column)
                if len(left) != 1 or used[i] or i in taken:
                    continue
                (last,) = left
                if last in may[i] and not known[last] and all(last != j for _, j in found):
                    taken.add(i)
                    found.append((i, last))
                    stack.append(last)
        return found

    def attempt(column: int) -> int:
        copies: dict[int, set[int]] = {}
        return len(follow(column, lambda i: copies.setdefault(i, set(open_of[i])), set()))

    def settle(found: list[tuple[int, int]]) -> None:
        for i, column in found:
            used[i] = True
            known[column] = True
        order.extend(found)

    for i, row in enumerate(rows):  # what needs no tear at all
        if len(open_of[i]) == 1 and not used[i] and row[0] in may[i] and not known[row[0]]:
            settle([(i, row[0])])
            settle(follow(row[0], lambda k: open_of[k], set()))
    while not all(known):
        left = [j for j in preferred if not known[j]]
        crowd = {j: sum(not used[i] for i in where[j]) for j in left}
        candidates = sorted(left, key=lambda j: (-crowd[j], rank[j]))[:12]
        best = max(candidates, key=lambda j: (attempt(j), -rank[j]))
        tears.append(best)
        known[best] = True
        settle(follow(best, lambda k: open_of[k], set()))
    return Torn(tears, order, [i for i in range(len(rows)) if not used[i]])
