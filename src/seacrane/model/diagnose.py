"""Why a diagram has no solution, in one plain sentence per fault.

The matching of equations to unknowns fails in two ways (Dulmage and Mendelsohn, Coverings of bipartite graphs, 1958).
Equations left over: the unknowns they can reach are determined more than once. Unknowns left over: nothing determines
them. The names of the components behind either set say where to look.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Final

import casadi as ca

from seacrane.errors import Problem
from seacrane.numerics.graph import reachable

if TYPE_CHECKING:
    from .flatten import Equation, Unknown


def explain(
    name: str,
    equations: Sequence[Equation],
    unknowns: Sequence[Unknown],
    incidence: Sequence[Sequence[int]],
    matched: Sequence[int],
    states: set[str],
) -> list[Problem]:
    """The problems behind an incomplete matching (`matched[i]` is the unknown of equation i, or -1)."""
    too_much = [*_too_much(name, equations, unknowns, incidence, matched, states)]
    # What is determined twice leaves as many unknowns without an equation: those are its shadow, not further faults.
    shadows = matched.count(-1) >= len(unknowns) - (len(matched) - matched.count(-1))
    return (
        too_much if too_much and shadows else [*too_much, *_too_little(name, equations, unknowns, incidence, matched)]
    )


def overdetermined(incidence: Sequence[Sequence[int]], matched: Sequence[int]) -> list[set[int]]:
    """Equations that determine their unknowns more than once, those that share an equation together."""
    equation_of = {unknown: equation for equation, unknown in enumerate(matched) if unknown >= 0}
    successors = [[equation_of[j] for j in row if j in equation_of] for row in incidence]
    groups: list[set[int]] = []
    for start in (i for i, unknown in enumerate(matched) if unknown < 0):
        group = reachable(start, successors)
        for other in [g for g in groups if g & group]:
            groups.remove(other)
            group |= other
        groups.append(group)
    return groups


def is_prescribed(
    group: set[int],
    equations: Sequence[Equation],
    incidence: Sequence[Sequence[int]],
    matched: Sequence[int],
    states: set[str],
) -> bool:
    """Whether a group with equations left over fixes everything in it, instead of tying states to each other."""
    left_over = sum(matched[i] < 0 for i in group)
    return len(_states_in(group, equations, states)) <= left_over


def _states_in(group: set[int], equations: Sequence[Equation], states: set[str]) -> list[str]:
    return sorted({s.name() for i in group for s in ca.symvar(equations[i].residual)} & states)


def _too_much(
    name: str,
    equations: Sequence[Equation],
    unknowns: Sequence[Unknown],
    incidence: Sequence[Sequence[int]],
    matched: Sequence[int],
    states: set[str],
) -> Iterator[Problem]:
    for group in overdetermined(incidence, matched):
        if not is_prescribed(group, equations, incidence, matched, states):
            continue
        where = places(equations[i].origin for i in sorted(group))
        quantities = sorted({unknowns[j].variable.name for i in group for j in incidence[i]})
        tied = _states_in(group, equations, states)
        if tied:
            what = "is a state, but its value is" if len(tied) == 1 else "are states, but their values are"
            yield Problem(
                name,
                f"{' and '.join(tied)} {what} also prescribed (derivative causality at {where})",
                hint="Put an orifice, hose or spring between the source and the store.",
            )
        else:
            what = " and ".join(quantities[:4]) if quantities else "nothing that is unknown"
            units = {unknowns[j].variable.unit for i in group for j in incidence[i]}
            yield Problem(name, f"{where} determine {what} more than once", hint=_cure(units, _TWICE))


def _too_little(
    name: str,
    equations: Sequence[Equation],
    unknowns: Sequence[Unknown],
    incidence: Sequence[Sequence[int]],
    matched: Sequence[int],
) -> Iterator[Problem]:
    rows: list[list[int]] = [[] for _ in unknowns]
    for i, row in enumerate(incidence):
        for j in row:
            rows[j].append(i)
    successors = [[matched[i] for i in rows[j] if matched[i] >= 0] for j in range(len(unknowns))]
    told: set[int] = set()
    for left_over in sorted(set(range(len(unknowns))) - set(matched)):
        if left_over in told:
            continue
        group = reachable(left_over, successors)
        told |= group
        beside = [equations[i] for j in sorted(group) for i in rows[j]]
        yield undetermined(name, [unknowns[j] for j in sorted(group)], beside)


def undetermined(name: str, unknowns: Sequence[Unknown], equations: Sequence[Equation]) -> Problem:
    """The problem of unknowns that the equations around them leave open."""
    names = sorted(u.variable.name for u in unknowns if u.shown) or sorted(u.variable.name for u in unknowns)
    where = places(e.origin for e in equations)
    shown = " and ".join(names[:4]) + (", ..." if len(names) > 4 else "")
    at = f" at {where}" if where else ""
    return Problem(
        name,
        f"nothing determines {shown}{at}",
        hint=_cure({u.variable.unit for u in unknowns if u.shown}, _NOT_AT_ALL),
    )


_TWICE: Final = {
    "Pa": "Two pressures on one node? Remove one source, or put an orifice or a hose between them.",
    "m3/s": "Flow imposed from both sides? Put a ControlVolume or a hose there, to take up the difference.",
    "m/s": "Two speeds on one node? Remove one source, or put a SpringDamper between them.",
    "N": "Force imposed from both sides? Put a Mass there, to take up the difference.",
    "rad/s": "Two speeds on one shaft? Remove one source, or put a TorsionalSpringDamper between them.",
    "N.m": "Torque imposed from both sides? Put an Inertia there, to take up the difference.",
    "": "Two sources of the same kind on one node? Remove one, or put a resistance between them.",
}
_NOT_AT_ALL: Final = {
    "Pa": "Add what holds the pressure there: a Tank, a ControlVolume, or a leak.",
    "m3/s": "Add what limits the flow there: an orifice, a pipe or a pump.",
    "m/s": "Add what holds the speed there: a Mass, or a prescribed motion.",
    "N": "Add what gives the force there: a SpringDamper, or something that is moved.",
    "rad/s": "Add what holds the speed there: an Inertia, or a prescribed speed.",
    "N.m": "Add what gives the torque there: a TorsionalSpringDamper, or something that is turned.",
    "": "Add a store or a source there (a tank, volume, mass or prescribed motion), or an equation.",
}
"""What to do about quantities of this unit that are determined more than once, or not at all; "" for mixed ones."""


def _cure(units: set[str], cures: Mapping[str, str]) -> str:
    (unit,) = units if len(units) == 1 else ("",)
    return cures.get(unit, cures[""])


def places(origins: Iterator[str]) -> str:
    """Paths in the order of their first appearance."""
    return ", ".join(dict.fromkeys(origins))
