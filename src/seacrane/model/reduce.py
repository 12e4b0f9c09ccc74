"""Index reduction: states that are tied rigidly to each other become fewer states.

Two volumes on one node, or a motor, a gear, a drum and a load on one shaft, hold more states than can move
independently. The equations that tie them are differentiated (Pantelides, The consistent initialization of
differential-algebraic systems, SIAM J. Sci. Stat. Comput. 9, 1988), and then one state for each tie is demoted to an
ordinary unknown, its derivative with it (Mattsson and Soederlind, Index reduction in differential-algebraic equations
using dummy derivatives, SIAM J. Sci. Comput. 14, 1993).

Which state stays is chosen once, when the diagram is compiled: one that an event sets rather than another, one with a
start value other than zero rather than one without, then the first in the diagram.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from seacrane.errors import Problem, StructureError
from seacrane.numerics.graph import match

from .dae import Variable, column
from .diagnose import explain, is_prescribed, overdetermined, places
from .flatten import Equation, Flat, Unknown

MOST_SWEEPS = 6
"""Equations of machines need one differentiation, or two if positions are tied; more than this is a fault."""

Reals = NDArray[np.float64]


@dataclass(frozen=True)
class Tie:
    """States of which not all can move independently: those `demoted`, the one or more they follow, and where."""

    demoted: tuple[str, ...]
    kept: tuple[str, ...]
    where: str


@dataclass(frozen=True)
class Reduced:
    """Equations and unknowns of index 1, each equation matched to its unknown; `kept` are the names of the states."""

    equations: list[Equation]
    unknowns: list[Unknown]
    incidence: list[list[int]]
    matched: list[int]
    kept: list[str]
    ties: tuple[Tie, ...] = ()


def incidence_of(equations: Sequence[Equation], unknowns: Sequence[Unknown]) -> list[list[int]]:
    """For each equation the unknowns that occur in it."""
    residuals = column(*[e.residual for e in equations])
    rows: list[list[int]] = [[] for _ in equations]
    if equations and unknowns:
        sparsity = ca.jacobian_sparsity(residuals, column(*[u.symbol for u in unknowns]))
        for row, col in zip(sparsity.row(), sparsity.get_col(), strict=True):
            rows[row].append(col)
    return rows


def at_random(matrix: Any) -> Reals:
    """A matrix of expressions at a random point, where no entry is zero by chance; rows and columns scaled to one."""
    symbols = ca.symvar(matrix)
    point = np.random.default_rng(1).uniform(0.5, 1.5, len(symbols))
    values = np.asarray(ca.Function("J", [column(*symbols)], [ca.densify(matrix)])(point), dtype=np.float64)
    return scaled(values.reshape(matrix.shape))


def scaled(values: Reals) -> Reals:
    """Rows, then columns, to a largest entry of one: units must not decide."""
    for axis in (1, 0):
        largest = np.abs(values).max(axis=axis, keepdims=True, initial=0.0)
        values = values / np.where(largest > 0, largest, 1.0)
    return values


def reduce_index(name: str, flat: Flat) -> Reduced:
    """Equations of index 1. Raises `StructureError` with every fault of the structure."""
    unknowns = list(flat.unknowns.values())
    incidence = incidence_of(flat.equations, unknowns)
    matched = match(incidence, len(unknowns))
    if -1 not in matched:
        if len(matched) < len(unknowns):
            raise StructureError(explain(name, flat.equations, unknowns, incidence, matched, set(flat.states)))
        return Reduced(flat.equations, unknowns, incidence, matched, list(flat.states))
    if any(
        is_prescribed(group, flat.equations, incidence, matched, set(flat.states))
        for group in overdetermined(incidence, matched)
    ):
        raise StructureError(explain(name, flat.equations, unknowns, incidence, matched, set(flat.states)))
    return _Reduction(name, flat).run()


class _Reduction:
    """Variables with their derivatives (x, der(x), der(der(x))), and equations with theirs."""

    def __init__(self, name: str, flat: Flat) -> None:
        self.name, self.flat = name, flat
        self.equations = list(flat.equations)
        self.parent: dict[int, int] = {}  # equation -> the one it is the derivative of
        self.variables: dict[str, Unknown] = {n: Unknown(v, s) for n, (v, s) in flat.states.items()}
        self.up: dict[str, str] = {}  # variable -> its derivative
        for u in flat.unknowns.values():
            self.variables[u.symbol.name()] = u
            if u.state is not None:
                self.up[u.state] = u.symbol.name()
        self.down = {derivative: x for x, derivative in self.up.items()}
        self.highest_equations = list(range(len(self.equations)))
        self.highest = [u.symbol.name() for u in flat.unknowns.values()]
        self.groups: list[set[int]] = []

    def run(self) -> Reduced:
        self._differentiate()
        dummies = self._dummies()
        kept = [x for x, derivative in self.up.items() if derivative not in dummies]
        strange = [x for x in kept if x not in self.flat.states]
        if strange:
            raise StructureError.at(
                self.name,
                f"{' and '.join(strange)} would have to become a state to untie what is tied rigidly",
                hint="Put something yielding between the stores: a hose, a spring or a shaft.",
            )
        unknowns = [self._unknown(n, set(kept)) for n in self.variables if n not in kept]
        incidence = incidence_of(self.equations, unknowns)
        matched = match(incidence, len(unknowns))
        if len(matched) != len(unknowns) or -1 in matched:
            states = set(self.flat.states)
            raise StructureError(explain(self.name, self.equations, unknowns, incidence, matched, states))
        in_order = [x for x in self.flat.states if x in kept]
        return Reduced(self.equations, unknowns, incidence, matched, in_order, self._ties(set(kept)))

    def _unknown(self, name: str, kept: set[str]) -> Unknown:
        variable = self.variables[name]
        below = self.down.get(name)
        return variable if below is None or below in kept else replace(variable, state=None, shown=False)

    # ---------------------------------------------------------------- Pantelides
    def _differentiate(self) -> None:
        for _ in range(MOST_SWEEPS):
            equations = [self.equations[i] for i in self.highest_equations]
            unknowns = [self.variables[n] for n in self.highest]
            incidence = incidence_of(equations, unknowns)
            matched = match(incidence, len(unknowns))
            groups = overdetermined(incidence, matched)
            if not groups:
                return
            states = set(self.flat.states)
            if any(is_prescribed(g, equations, incidence, matched, states) for g in groups):
                raise StructureError(explain(self.name, equations, unknowns, incidence, matched, states))
            self.groups += [{self.highest_equations[i] for i in group} for group in groups]
            together = sorted(set().union(*groups))
            for j in sorted({j for i in together for j in incidence[i]}):
                self.highest[j] = self._derivative(self.highest[j])
            for i in together:
                self.highest_equations[i] = self._differentiated(self.highest_equations[i])
        where = places(self.equations[i].origin for i in self.highest_equations if i in self.parent)
        raise StructureError.at(self.name, f"the equations at {where} stay tied however often they are differentiated")

    def _derivative(self, name: str) -> str:
        derivative = f"der({name})"
        variable = Variable(derivative, "1", nominal=self.variables[name].variable.nominal)
        self.variables[derivative] = Unknown(variable, ca.SX.sym(derivative), shown=False)
        self.up[name], self.down[derivative] = derivative, name
        return derivative

    def _differentiated(self, index: int) -> int:
        equation = self.equations[index]
        symbols = ca.symvar(equation.residual)
        rates, problems = [], []
        for symbol in symbols:
            name = symbol.name()
            if name in self.up:
                rates.append(self.variables[self.up[name]].symbol)
            else:
                rates.append(ca.SX(1.0 if name == "t" else 0.0))
            if name in self.flat.inputs:
                problems.append(
                    Problem(
                        self.name,
                        f"the rate of change of the input {name} would be needed: it moves states that are tied"
                        f" rigidly to each other at {equation.origin} (derivative causality)",
                        hint="Put something yielding there: a hose, a spring or a shaft; or give the input a lag.",
                    )
                )
        if problems:
            raise StructureError(problems)
        rate = ca.jtimes(equation.residual, column(*symbols), column(*rates))
        self.equations.append(Equation(rate, equation.origin))
        self.parent[len(self.equations) - 1] = index
        return len(self.equations) - 1

    # ---------------------------------------------------------------- dummy derivatives
    def _dummies(self) -> set[str]:
        """The derivatives that are solved for instead of integrated."""
        dummies: set[str] = set()
        equations = [i for i in self.highest_equations if i in self.parent]
        candidates = [n for n in self.highest if n in self.down]
        while equations:
            candidates.sort(key=self._reluctance)
            residuals = column(*[self.equations[i].residual for i in equations])
            symbols = column(*[self.variables[n].symbol for n in candidates])
            chosen = [candidates[j] for j in independent_columns(at_random(ca.jacobian(residuals, symbols)))]
            if len(chosen) < len(equations):
                where = places(self.equations[i].origin for i in equations)
                raise StructureError.at(
                    self.name,
                    f"the equations at {where} say the same thing twice, or contradict each other",
                    hint="Remove one of the rigid connections that go round in a circle.",
                )
            dummies.update(chosen)
            equations = [self.parent[i] for i in equations if self.parent[i] in self.parent]
            candidates = [self.down[n] for n in chosen if self.down[n] in self.down]
        return dummies

    def _reluctance(self, derivative: str) -> tuple[int, int]:
        """The order in which states are given up: what is no state; those that start at zero; others; those that events
        set; of each the later ones first.
        """
        name = self.down[derivative]
        if name not in self.flat.states:
            return 0, 0
        position = list(self.flat.states).index(name)
        if any(name == target for event in self.flat.events.values() for target, _ in event.resets):
            return 3, -position
        return (2 if self.flat.states[name][0].start != 0 else 1), -position

    def _ties(self, kept: set[str]) -> tuple[Tie, ...]:
        ties: dict[tuple[str, ...], Tie] = {}
        for group in self.groups:
            origins = [self.equations[i] for i in sorted(group)]
            states = {s.name() for e in origins for s in ca.symvar(e.residual)} & set(self.flat.states)
            demoted = tuple(x for x in self.flat.states if x in states and x not in kept)
            if demoted:
                stay = tuple(x for x in self.flat.states if x in states and x in kept)
                ties.setdefault(demoted, Tie(demoted, stay, places(e.origin for e in origins)))
        return tuple(ties.values())


def independent_columns(matrix: Reals, threshold: float = 1e-9) -> list[int]:
    """The first linearly independent columns, in their order (Gram-Schmidt, twice for accuracy)."""
    basis: list[Reals] = []
    chosen = []
    for j, vector in enumerate(matrix.T):
        size = np.linalg.norm(vector)
        if size == 0 or len(basis) == len(vector):
            continue
        rest = vector / size
        for _ in range(2):
            for b in basis:
                rest = rest - (b @ rest) * b
        norm = np.linalg.norm(rest)
        if norm > threshold:
            basis.append(rest / norm)
            chosen.append(j)
    return chosen
