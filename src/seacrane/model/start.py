"""Start values: algebraic unknowns that solve their equations, and states that do not contradict each other."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, TypeAlias

import casadi as ca
import numpy as np

from seacrane.errors import Problem
from seacrane.numerics.equations import Reals, solve_equations
from seacrane.units import convert, with_unit

from .dae import Dae, Variable

if TYPE_CHECKING:
    from .reduce import Tie


HIGH = 1e8
"""[Pa] More than any valve is set to: at a lower pressure, shut valves alone give a solver no hint where to go."""

Residual: TypeAlias = Callable[[Reals], tuple[Reals, Reals]]
"""The equations and their Jacobian at values of the unknowns."""


def starts(variables: Sequence[Variable]) -> Reals:
    """Start values as an array."""
    return np.array([v.start for v in variables], dtype=np.float64)


def with_solved_start(dae: Dae) -> Dae:
    """The model with algebraic unknowns that start where they solve its equations at the start values of all else.

    Tried from the declared start values, then with pressures and other unknowns at half and at their whole nominal
    value, and at last from where all relief valves are open, with leaks that close. If none leads to a solution the
    model is returned as it is: other start values may be given before it runs.
    """
    if not dae.algebraics:
        return dae
    function = ca.Function("g", [dae.t, dae.x, dae.z, dae.u, dae.p], [dae.alg, ca.densify(ca.jacobian(dae.alg, dae.z))])
    x, u, p = starts(dae.states), starts(dae.inputs), starts(dae.constants)
    nominal = np.array([v.nominal for v in dae.algebraics])

    def residual(z: Reals) -> tuple[Reals, Reals]:
        g, jacobian = function(0.0, x, z, u, p)
        return np.asarray(g).ravel(), np.asarray(jacobian).reshape(z.size, z.size)

    guesses = (starts(dae.algebraics), 0.5 * nominal, nominal)
    z = next((z for guess in guesses if (z := solve_equations(residual, guess, nominal)) is not None), None)
    if z is None:
        high = np.array([HIGH if v.unit == "Pa" else v.nominal for v in dae.algebraics])
        z = _as_leaks_close(residual, high, nominal)
    if z is None:
        return dae
    solved = tuple(replace(v, start=float(value)) for v, value in zip(dae.algebraics, z, strict=True))
    return replace(dae, algebraics=solved)


def _as_leaks_close(residual: Residual, high: Reals, nominal: Reals) -> Reals | None:
    """The solution to which that of the system with a leak at each node tends as the leaks close, or None.

    A leak passes as much as the equation of its node does at `high`, and gives a direction where valves are shut.
    """
    z, leak = high, np.diagonal(residual(high)[1])
    for share in (*np.logspace(0, -8, 9), 0.0):

        def leaking(y: Reals, share: float = share) -> tuple[Reals, Reals]:
            g, jacobian = residual(y)
            return g + share * leak * y, jacobian + share * np.diag(leak)

        found = solve_equations(leaking, z, nominal)
        if found is None:
            return None
        z = found
    return z


def contradictions(dae: Dae, demoted: Sequence[Variable], ties: Sequence[Tie]) -> Iterator[Problem]:
    """States with a start value of their own that is not the one which the states they are tied to give them."""
    given = [v for v in demoted if v.start != 0.0]
    if not given:
        return
    names = [v.name for v in dae.algebraics + dae.observables]
    values = ca.Function("v", [dae.t, dae.x, dae.z, dae.u, dae.p], [ca.vertcat(dae.z, dae.obs)])(
        0.0, starts(dae.states), starts(dae.algebraics), starts(dae.inputs), starts(dae.constants)
    )
    found = dict(zip(names, np.asarray(values).ravel(), strict=True))
    for v in given:
        value = float(found[v.name])
        if abs(value - v.start) > 1e-6 * (abs(v.start) + 1e-3 * v.nominal):
            tie = next(t for t in ties if v.name in t.demoted)
            yield Problem(
                v.name,
                f"starts at {_shown(v, v.start)}, but {' and '.join(tie.kept)}, to which it is tied rigidly at"
                f" {tie.where}, gives it {_shown(v, value)}",
                hint="Give a start value to one of them, or values that fit.",
            )


def _shown(variable: Variable, value: float) -> str:
    unit = variable.display_unit
    return with_unit(convert(value, variable.unit, unit), unit)
