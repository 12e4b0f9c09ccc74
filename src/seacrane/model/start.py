"""Start values: algebraic unknowns that solve their equations, and states that do not contradict each other."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import casadi as ca
import numpy as np

from seacrane.errors import Problem
from seacrane.numerics.equations import Reals, solve_equations
from seacrane.units import convert, with_unit

from .dae import Dae, Variable

if TYPE_CHECKING:
    from .reduce import Tie


def starts(variables: Sequence[Variable]) -> Reals:
    """Start values as an array."""
    return np.array([v.start for v in variables], dtype=np.float64)


def with_solved_start(dae: Dae) -> Dae:
    """The model with algebraic unknowns that start where they solve its equations at the start values of all else.

    Tried from the declared start values, then with pressures and other unknowns at half and at their whole nominal
    value. If none leads to a solution the model is returned as it is: other start values may be given before it runs.
    """
    if not dae.algebraics:
        return dae
    function = ca.Function("g", [dae.t, dae.x, dae.z, dae.u, dae.p], [dae.alg, ca.densify(ca.jacobian(dae.alg, dae.z))])
    x, u, p = starts(dae.states), starts(dae.inputs), starts(dae.constants)
    nominal = np.array([v.nominal for v in dae.algebraics])

    def residual(z: Reals) -> tuple[Reals, Reals]:
        g, jacobian = function(0.0, x, z, u, p)
        return np.asarray(g).ravel(), np.asarray(jacobian).reshape(z.size, z.size)

    for guess in (starts(dae.algebraics), 0.5 * nominal, nominal):
        z = solve_equations(residual, guess, nominal)
        if z is not None:
            solved = tuple(replace(v, start=float(value)) for v, value in zip(dae.algebraics, z, strict=True))
            return replace(dae, algebraics=solved)
    return dae


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
