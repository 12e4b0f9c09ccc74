"""The order in which slaves step, derived from who depends on whom."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seacrane.cosim.system import System

EXACT = 12
"""Slaves in a loop up to which the best order is found for certain, by trying all subsets of them."""


def links(system: System | None) -> Counter[tuple[str, str]]:
    """How many connections lead from one slave to another."""
    if system is None:
        return Counter()
    return Counter((system.split(c.source)[0], system.split(c.target)[0]) for c in system.connections)


def feedthrough(system: System | None) -> Counter[tuple[str, str]]:
    """How many connections lead from one slave to another whose outputs depend on the input without delay.

    Of a slave that does not know, all outputs are taken to depend on all inputs.
    """
    found: Counter[tuple[str, str]] = Counter()
    for connection in system.connections if system is not None else ():
        assert system is not None
        slave, variable = system.split(connection.target)
        known = system.slaves[slave].feedthrough
        if known is None or any(variable in inputs for inputs in known.values()):
            found[system.split(connection.source)[0], slave] += 1
    return found


def derived_order(
    slaves: Sequence[str], joined: Mapping[tuple[str, str], int], direct: Mapping[tuple[str, str], int]
) -> tuple[str, ...]:
    """The order with the fewest connections that go backwards, of direct ones first of all; that of `slaves` among
    equals.

    Loops of up to `EXACT` slaves are ordered best for certain, longer ones by a greedy choice improved by exchanges.
    (A minimum feedback arc set; that of a directed graph is NP-hard to find in general.)
    """
    heavier = sum(joined.values()) + 1
    weight = {link: count + heavier * direct.get(link, 0) for link, count in joined.items() if link[0] != link[1]}
    order: list[str] = []
    for loop in _components(slaves, weight):
        order += _best(loop, weight) if len(loop) <= EXACT else _good(loop, weight)
    return tuple(order)


def _components(slaves: Sequence[str], weight: Mapping[tuple[str, str], int]) -> list[list[str]]:
    """Slaves that depend on each other in loops, sources first (strongly connected components)."""
    after: dict[str, set[str]] = {name: set() for name in slaves}
    for source, target in weight:
        after[source].add(target)

    def reached(start: str) -> set[str]:
        found, pending = {start}, [start]
        while pending:
            new = after[pending.pop()] - found
            found |= new
            pending += new
        return found

    reach = {name: reached(name) for name in slaves}
    loop_of: dict[str, int] = {}
    loops: list[list[str]] = []
    for name in slaves:
        if name not in loop_of:
            loop = [m for m in slaves if m in reach[name] and name in reach[m]]
            loop_of |= dict.fromkeys(loop, len(loops))
            loops.append(loop)
    edges = {(loop_of[a], loop_of[b]) for a, b in weight} - {(i, i) for i in range(len(loops))}
    waiting = [sum(b == i for _, b in edges) for i in range(len(loops))]
    ready = [i for i, count in enumerate(waiting) if count == 0]
    ordered = []
    while ready:
        ready.sort(reverse=True)
        done = ready.pop()
        ordered.append(loops[done])
        for following in (b for a, b in edges if a == done):
            waiting[following] -= 1
            if waiting[following] == 0:
                ready.append(following)
    return ordered


def _best(loop: Sequence[str], weight: Mapping[tuple[str, str], int]) -> list[str]:
    """The best order by dynamic programming over subsets: who comes last in each, and at which cost."""
    count = len(loop)
    backwards = [[weight.get((a, b), 0) for b in loop] for a in loop]
    cost, last = [0] * (1 << count), [0] * (1 << count)
    for subset in range(1, 1 << count):
        best = None
        for i in reversed(range(count)):
            if not subset >> i & 1:
                continue
            before = subset ^ (1 << i)
            here = cost[before] + sum(backwards[i][j] for j in range(count) if before >> j & 1)
            if best is None or here < best:
                best, last[subset] = here, i
        cost[subset] = best or 0
    order: list[str] = []
    subset = (1 << count) - 1
    while subset:
        order.append(loop[last[subset]])
        subset ^= 1 << last[subset]
    return order[::-1]


def _good(loop: Sequence[str], weight: Mapping[tuple[str, str], int]) -> list[str]:
    """Whoever gives most and takes least comes first; then neighbours change places while that helps."""
    rest, order = list(loop), []
    while rest:
        first = max(rest, key=lambda n: sum(weight.get((n, m), 0) - weight.get((m, n), 0) for m in rest))
        rest.remove(first)
        order.append(first)
    changed = True
    while changed:
        changed = False
        for i, (a, b) in enumerate(list(pairwise(order))):
            if order[i : i + 2] == [a, b] and weight.get((b, a), 0) > weight.get((a, b), 0):
                order[i : i + 2] = [b, a]
                changed = True
    return order
