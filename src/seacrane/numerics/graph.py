"""Graphs of equations and unknowns: maximum matching and strongly connected components in order of solution."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import maximum_bipartite_matching


def match(incidence: Sequence[Sequence[int]], n_columns: int) -> list[int]:
    """A maximum matching of rows to columns.

    `incidence[i]` lists the columns in which row i occurs. Returns for each row its column, or -1 if it has none
    (Hopcroft and Karp, An n^5/2 algorithm for maximum matchings in bipartite graphs, 1973).
    """
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
