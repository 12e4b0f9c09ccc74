"""The linear system of an implicit step as straight code: (s M - df/dy) x = b, M = diag(1 for states, 0 for others).

Most of such a matrix is zeros, and where they are is known when the model is compiled. So the order of elimination is
chosen once, and only the few operations that are left are written down. No pivots are sought when the code runs:
whether the solution is accurate is for the caller to judge by its residual.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
from scipy.sparse import coo_array
from scipy.sparse.csgraph import maximum_bipartite_matching

from .dae import column

MOST_PRODUCTS = 5000
"""In an elimination; above it, a loop over the full matrix is better than straight code."""


@dataclass(frozen=True)
class Elimination:
    """`factors` of the matrix in terms of `nonzeros` of df/dy and `s`; `x` in terms of the symbols `factor` and of `b`.

    Without factors the matrix is not to be solved like this: it is singular whatever its nonzeros are, or too full.
    """

    nonzeros: Any
    s: Any
    factors: Any
    factor: Any
    b: Any
    x: Any


def eliminate(states: int, size: int, rows: Sequence[int], columns: Sequence[int]) -> Elimination:
    """Gaussian elimination where df/dy, of `size` unknowns of which the first are `states`, has nonzeros as given.

    The next pivot is the one of the diagonal that changes the fewest entries (H. M. Markowitz, The elimination form of
    the inverse and its application to linear programming, Management Science 3, 1957). Algebraic equations are first
    given an order in which the diagonal is full.
    """
    nonzeros, s, b = ca.SX.sym("nonzeros", len(rows)), ca.SX.sym("s"), ca.SX.sym("b", size)
    entries: list[dict[int, Any]] = [{} for _ in range(size)]  # of each row, by column
    for k, (i, j) in enumerate(zip(rows, columns, strict=True)):
        entries[i][j] = -nonzeros[k]
    for i in range(states):
        entries[i][i] = entries[i].get(i, 0) + s
    right = ca.vertsplit(b) if size else []
    factors: list[Any] = []
    symbols: list[Any] = []

    def keep(value: Any) -> Any:
        factors.append(value)
        symbols.append(ca.SX.sym("factor"))
        return symbols[-1]

    left = _equations(states, entries)  # for each unknown that is not yet eliminated the row that serves for it
    done: list[tuple[int, int, Any, list[tuple[int, Any]]]] = []
    products = 0
    while left and products <= MOST_PRODUCTS:
        height = {j: sum(j in entries[i] for i in left.values()) for j in left}
        pivot = min(left, key=lambda j: ((len(entries[left[j]]) - 1) * (height[j] - 1), j))
        row = left.pop(pivot)
        reciprocal = 1 / entries[row].pop(pivot)
        for i in left.values():
            if pivot in entries[i]:
                share = entries[i].pop(pivot) * reciprocal
                right[i] = right[i] - keep(share) * right[row]
                for j, value in entries[row].items():
                    entries[i][j] = entries[i].get(j, 0) - share * value
                products += len(entries[row])
        done.append((pivot, row, keep(reciprocal), [(j, keep(value)) for j, value in entries[row].items()]))
    if len(done) < size:
        return Elimination(nonzeros, s, ca.SX(0, 1), ca.SX(0, 1), b, ca.SX(0, 1))
    x: dict[int, Any] = {}
    for pivot, row, reciprocal, others in reversed(done):
        x[pivot] = (right[row] - sum(value * x[j] for j, value in others)) * reciprocal
    return Elimination(nonzeros, s, column(*factors), column(*symbols), b, column(*(x[i] for i in range(size))))


def _equations(states: int, entries: Sequence[dict[int, Any]]) -> dict[int, int]:
    """For each unknown an equation that has it: for a state its own; none where there are too few."""
    found = {i: i for i in range(states)}
    algebraic = [(i - states, j - states) for i in range(states, len(entries)) for j in entries[i] if j >= states]
    if len(entries) > states and algebraic:
        i, j = zip(*algebraic, strict=True)
        pattern = coo_array(([1] * len(i), (i, j)), shape=2 * [len(entries) - states]).tocsr()
        found |= {states + j: states + int(i) for j, i in enumerate(maximum_bipartite_matching(pattern)) if i >= 0}
    return found
