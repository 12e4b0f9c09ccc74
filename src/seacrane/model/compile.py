"""From a diagram to a DAE of index 1: lay flat, reduce, match, order, tear, solve.

1. Lay all components side by side and join them at nodes (`flatten`).
2. Match every equation to the unknown it determines. States that are tied rigidly become fewer (`reduce`); what stays
   unmatched is a fault of structure, told by name (`diagnose`).
3. Order the equations into blocks that can be solved one after the other (block-triangular form).
4. Solve scalar linear blocks symbolically. In a larger block choose few unknowns from which the others follow one by
   one (tearing). If what is left is linear and small, solve that symbolically too; else it stays as algebraic unknowns.

(Cellier and Kofman, Continuous System Simulation, 2006, chapter 7.)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from seacrane.errors import Problem, StructureError
from seacrane.numerics.graph import components_in_order, tear

from .dae import Dae, Divisor, Event, Variable, column
from .diagnose import places, undetermined
from .diagram import Diagram
from .flatten import Flat, Unknown, flatten
from .reduce import Reduced, Tie, at_random, reduce_index, scaled
from .start import contradictions, with_solved_start

LARGEST_SYMBOLIC_BLOCK = 4
"""Torn linear blocks up to this size are solved symbolically; larger ones are cheaper as algebraic unknowns."""

LEAST_PIVOT = 1e-3
"""An equation is solved for an unknown only if it has this weight in it, measured in nominal values."""


UNTIE = "Put something yielding between the two: a shaft, a spring or a hose."


@dataclass(frozen=True)
class Loop:
    """Equations that can only be solved together: where, for what, and the unknowns `torn` that remain for the solver.

    No torn unknowns: the loop is linear and solved in closed form.
    """

    where: str
    unknowns: tuple[str, ...]
    torn: tuple[str, ...]


@dataclass(frozen=True)
class Compiled:
    """A model with what the compiler did to get it."""

    dae: Dae
    ties: tuple[Tie, ...]
    loops: tuple[Loop, ...]


@dataclass
class _Solution:
    """What has been solved, in order, and what stays algebraic."""

    symbols: list[Any]
    expressions: list[Any]
    algebraic: list[Unknown]
    residuals: list[Any]
    loops: list[Loop]
    divisors: list[Divisor]


def compile_diagram(diagram: Diagram) -> Compiled:
    """See the module, `Diagram.compile` and `Diagram.report`."""
    flat = flatten(diagram)
    reduced = reduce_index(diagram.name, flat)
    equation_of = {unknown: equation for equation, unknown in enumerate(reduced.matched)}
    needs = [[equation_of[j] for j in row if j != reduced.matched[i]] for i, row in enumerate(reduced.incidence)]
    solution = _Blocks(diagram.name, flat, reduced).solve(components_in_order(needs))
    dae = with_solved_start(_assemble(diagram, flat, reduced, solution))
    demoted = [flat.states[x][0] for tie in reduced.ties for x in tie.demoted]
    problems = [*contradictions(dae, demoted, reduced.ties)]
    if problems:
        raise StructureError(problems)
    return Compiled(dae, reduced.ties, tuple(solution.loops))


class _Blocks:
    """The equations of a matched system with their Jacobian, from which every block takes its part."""

    def __init__(self, name: str, flat: Flat, reduced: Reduced) -> None:
        self.name = name
        self.equations, self.unknowns, self.matched = reduced.equations, reduced.unknowns, reduced.matched
        self.residuals = [e.residual for e in self.equations]
        self.symbols = [u.symbol for u in self.unknowns]
        self.jacobian = ca.jacobian(column(*self.residuals), column(*self.symbols))
        self.somewhere = at_random(self.jacobian)
        self.fixed = self._fixed_coefficients(flat)

    def _fixed_coefficients(self, flat: Flat) -> dict[tuple[int, int], float]:
        """The coefficients that depend on nothing but parameters, with their values in nominal values."""
        entries = column(*self.jacobian.nonzeros())
        parameters = column(*[s for _, s in flat.parameters.values()])
        moving = [s for s in ca.symvar(entries) if s.name() not in flat.parameters]
        free = set(range(entries.numel())) - set(ca.jacobian_sparsity(entries, column(*moving)).row())
        chosen = sorted(free)
        function = ca.Function("c", [parameters], [entries[chosen]] if chosen else [ca.SX(0, 1)])
        values = np.asarray(function([v.start for v, _ in flat.parameters.values()])).ravel()
        rows, columns = self.jacobian.sparsity().row(), self.jacobian.sparsity().get_col()
        return {
            (rows[k], columns[k]): abs(value) * self.unknowns[columns[k]].variable.nominal
            for k, value in zip(chosen, values, strict=True)
        }

    def solve(self, blocks: Sequence[Sequence[int]]) -> _Solution:
        """All blocks in order. Raises `StructureError` for those that have no solution, whatever the numbers are."""
        solution = _Solution([], [], [], [], [], [])
        problems: list[Problem] = []
        for block in blocks:
            columns = [self.matched[i] for i in block]
            part = scaled(self.somewhere[np.ix_(block, columns)])
            if np.linalg.matrix_rank(part, tol=1e-10) < len(block):
                wanted = [self.unknowns[j] for j in columns]
                problems.append(undetermined(self.name, wanted, [self.equations[i] for i in block]))
            elif len(block) == 1:
                self._single(solution, block[0], columns[0])
            else:
                self._several(solution, block, columns)
        if problems:
            raise StructureError(problems)
        return solution

    def _single(self, solution: _Solution, row: int, column_: int) -> None:
        symbol, slope = self.symbols[column_], self.jacobian[row, column_]
        if ca.depends_on(slope, symbol):
            self._leave(solution, [row], [column_], [row], [column_], [self.residuals[row]])
        else:
            self._divide(solution, [column_], slope)
            solution.symbols.append(symbol)
            solution.expressions.append(self._solved(row, column_))

    def _divide(self, solution: _Solution, columns: Sequence[int], coefficients: Any) -> None:
        if not coefficients.is_constant():
            names = tuple(_as_algebraic(self.unknowns[j]).name for j in columns)
            solution.divisors.append(Divisor(names, coefficients))

    def _solved(self, row: int, column_: int) -> Any:
        """The unknown from an equation that is linear in it."""
        slope = self.jacobian[row, column_]
        return -ca.substitute(self.residuals[row], self.symbols[column_], ca.SX(0)) / slope

    def _several(self, solution: _Solution, block: Sequence[int], columns: Sequence[int]) -> None:
        place = {j: k for k, j in enumerate(columns)}
        rows: list[list[int]] = []
        solvable: list[list[int]] = []
        for i in block:
            inside = [j for j in columns if self.jacobian.sparsity().has_nz(i, j)]
            rows.append([place[j] for j in inside])
            weights = {j: self.fixed[i, j] for j in inside if (i, j) in self.fixed}
            least = LEAST_PIVOT * max(weights.values(), default=0.0)
            solvable.append([place[j] for j, weight in weights.items() if weight > 0 and weight >= least])
        preferred = sorted(range(len(columns)), key=lambda k: self._preference(columns[k]))
        torn = tear(rows, solvable, preferred)
        order = [(block[i], columns[k]) for i, k in torn.order]
        tears = [columns[k] for k in torn.tears]
        rest = [block[i] for i in torn.residuals]
        symbols = [self.symbols[j] for _, j in order]
        expressions = [self._solved(i, j) for i, j in order]
        residual, tear_symbols = column(*[self.residuals[i] for i in rest]), column(*[self.symbols[j] for j in tears])
        if symbols:
            residual = ca.substitute_inplace(symbols, expressions, [residual], False)[1][0]
        if len(tears) <= LARGEST_SYMBOLIC_BLOCK and not any(ca.which_depends(residual, tear_symbols, 2, True)):
            matrix = ca.jacobian(residual, tear_symbols)
            constant = ca.substitute(residual, tear_symbols, ca.SX.zeros(tear_symbols.shape))
            value = -constant / matrix if len(tears) == 1 else -ca.solve(matrix, constant)
            self._divide(solution, tears, matrix)
            solution.symbols.append(tear_symbols)
            solution.expressions.append(ca.densify(value))
            self._tell(solution, block, columns, [])
        else:
            self._leave(solution, block, columns, rest, tears, [self.residuals[i] for i in rest])
        solution.symbols += symbols
        solution.expressions += expressions

    def _preference(self, column_: int) -> tuple[int, int]:
        """What is torn rather: pressures, then what has a name for the user, then derivatives."""
        unknown = self.unknowns[column_]
        return (0 if unknown.variable.unit == "Pa" and unknown.shown else 1 if unknown.shown else 2), column_

    def _leave(
        self,
        solution: _Solution,
        block: Sequence[int],
        columns: Sequence[int],
        rest: Sequence[int],
        tears: Sequence[int],
        residuals: list[Any],
    ) -> None:
        solution.algebraic += [self.unknowns[j] for j in tears]
        solution.residuals += residuals
        self._tell(solution, block, columns, tears)

    def _tell(self, solution: _Solution, block: Sequence[int], columns: Sequence[int], tears: Sequence[int]) -> None:
        where = places(self.equations[i].origin for i in sorted(block))
        names = sorted(self.unknowns[j].variable.name for j in columns if self.unknowns[j].shown)
        torn = tuple(_as_algebraic(self.unknowns[j]).name for j in tears)
        solution.loops.append(Loop(where, tuple(names), torn))


def _as_algebraic(unknown: Unknown) -> Variable:
    """The variable of an algebraic unknown. A rate gets a name of its own: der(x) is the compiled model's word."""
    if unknown.shown:
        return unknown.variable
    return replace(unknown.variable, name=f"{unknown.symbol.name().replace('der(', '').replace(')', '')}.rate")


def _assemble(diagram: Diagram, flat: Flat, reduced: Reduced, solution: _Solution) -> Dae:
    kept = {x: flat.states[x] for x in reduced.kept}
    rates = {u.state: u.symbol for u in reduced.unknowns if u.state is not None}
    looked_at = dict(flat.observables)
    algebraic = {u.symbol.name() for u in solution.algebraic}
    for u in reduced.unknowns:
        name = u.symbol.name()
        if u.shown and name not in algebraic and name not in flat.outputs:
            looked_at[name] = (u.variable, u.symbol)
    problems = [
        Problem(event.name, f"sets {target}, which is tied rigidly to another state and follows it", hint=UNTIE)
        for event in flat.events.values()
        for target, _ in event.resets
        if target in flat.states and target not in kept
    ]
    if problems:
        raise StructureError(problems)
    jumps = [[event.indicator, *(value for _, value in event.resets)] for event in flat.events.values()]
    targets = [
        column(*[rates[name] for name in kept]),
        column(*solution.residuals),
        column(*[e for _, e in flat.outputs.values()]),
        column(*[e for _, e in looked_at.values()]),
        *[column(*jump) for jump in jumps],
        *[d.coefficients for d in solution.divisors],
    ]
    if solution.symbols:
        _, targets = ca.substitute_inplace(solution.symbols, solution.expressions, targets, False)
    # A rate that is itself an algebraic unknown (in a nonlinear block) is that unknown: nothing more to do.
    ode, alg, out, obs = (ca.densify(e) for e in targets[:4])
    events = [
        Event(e.name, values[0], {target: values[i] for i, (target, _) in enumerate(e.resets, start=1)}, e.about)
        for e, values in zip(flat.events.values(), map(ca.densify, targets[4:]), strict=False)
    ]
    coefficients = targets[4 + len(events) :]
    divisors = [replace(d, coefficients=c) for d, c in zip(solution.divisors, coefficients, strict=True)]
    return Dae(
        name=diagram.name,
        states=tuple(v for v, _ in kept.values()),
        algebraics=tuple(_as_algebraic(u) for u in solution.algebraic),
        inputs=tuple(v for v, _ in flat.inputs.values()),
        parameters=tuple(v for v, _ in flat.parameters.values()),
        outputs=tuple(v for v, _ in flat.outputs.values()),
        observables=tuple(v for v, _ in looked_at.values()),
        t=flat.t,
        x=column(*[s for _, s in kept.values()]),
        z=column(*[u.symbol for u in solution.algebraic]),
        u=column(*[s for _, s in flat.inputs.values()]),
        p=column(*[s for _, s in (*flat.parameters.values(), *flat.modes.values())]),
        ode=ode,
        alg=alg,
        out=out,
        obs=obs,
        sources=tuple(flat.sources),
        divisors=tuple(divisors),
        bonds=tuple(flat.bonds),
        modes=tuple(v for v, _ in flat.modes.values()),
        events=tuple(events),
    )
