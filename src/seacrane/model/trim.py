"""Trimming: the steady state of a model under constant inputs.

rest = trim(diagram, inputs={"spool": 0.0})
run = simulate(diagram, 10.0, inputs={"spool": 0.2}, parameters=rest.start)
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from seacrane.errors import ParameterError, Problem, SolveError, nearest
from seacrane.numerics.equations import Reals, solve_equations
from seacrane.units import convert, with_unit

from .dae import Dae, Variable
from .diagram import Diagram
from .singular import Point, undetermined_at
from .start import starts

STILL = 1e-7
"""A state is at rest when it changes by less than this share of its magnitude in a second [1/s]."""

FIRST_STEP, LEAST_STEP = 1e-4, 1e-13
"""Steps in pseudo-time [s]: where they begin, and where a solution is given up."""

MOST_STEPS = 500
MOST_CHANGE = 0.5
"""A step that changes a variable by more than this share of its magnitude is repeated shorter."""


@dataclass(frozen=True)
class Trim:
    """A steady state. `start` gives the states and algebraic unknowns, for `simulate(..., parameters=trim.start)`.

    `values` holds the outputs and observables there; `moving` the rates of the states that were held, and of those that
    nothing depends on (a counter of work done), where they are not zero.
    """

    start: Mapping[str, float]
    values: Mapping[str, float]
    moving: Mapping[str, float]


def trim(
    model: Diagram | Dae,
    *,
    inputs: Mapping[str, float] | None = None,
    parameters: Mapping[str, float] | None = None,
    hold: Iterable[str] = (),
) -> Trim:
    """The steady state that the model settles to from its start values, all inputs held (SI).

    parameters: values other than the model's own, start values of states included. hold: states that keep their start
    values whatever their rates are, such as the extension of a cylinder on its way.

    The model is followed in pseudo-time by a linearly implicit Euler method whose steps grow as it comes to rest
    (pseudo-transient continuation; Kelley and Keyes, SIAM J. Numer. Anal. 35, 1998), so that of several steady states
    it finds one that the machine would settle to. Nothing is compiled to C. Modes stay as they start.

    Raises `ParameterError` for an unknown name, `SolveError` with the states that do not settle, or with the events by
    which it would leave these modes.
    """
    dae = model.compile() if isinstance(model, Diagram) else model
    return _Trimming(dae, dict(inputs or {}), dict(parameters or {}), tuple(hold)).run()


class _Trimming:
    def __init__(self, dae: Dae, inputs: dict[str, float], parameters: dict[str, float], hold: tuple[str, ...]) -> None:
        self.dae = dae
        states = [v.name for v in dae.states]
        settable = [v.name for v in dae.states + dae.algebraics + dae.constants]
        problems = [*_unknown(dae, inputs, [v.name for v in dae.inputs], "input")]
        problems += _unknown(dae, parameters, settable, "parameter or state")
        problems += _unknown(dae, hold, states, "state")
        problems += [
            Problem(n, "is not a finite number", v)
            for n, v in (inputs | parameters).items()
            if not np.isfinite(float(v))
        ]
        if problems:
            raise ParameterError(problems)
        self.u = _given(dae.inputs, inputs)
        self.p = _given(dae.constants, parameters)
        self.x, self.z = _given(dae.states, parameters), _given(dae.algebraics, parameters)
        self.nominal = np.array([v.nominal for v in dae.states + dae.algebraics])
        self.scale = self.nominal[: len(states)] + np.abs(self.x)
        f, y = ca.vertcat(dae.ode, dae.alg), ca.vertcat(dae.x, dae.z)
        jacobian = ca.jacobian(f, y)
        arguments = [dae.t, dae.x, dae.z, dae.u, dae.p]
        self.function = ca.Function("f", arguments, ca.cse([ca.densify(f), ca.densify(jacobian)]))
        self.results = ca.Function("y", arguments, ca.cse([ca.densify(ca.vertcat(dae.out, dae.obs))]))
        used = set(jacobian.sparsity().get_col())
        self.free = np.array(
            [i for i, n in enumerate(states) if n not in hold and i in used]
            + [len(states) + k for k in range(len(dae.algebraics))],
            dtype=int,
        )

    def run(self) -> Trim:
        dae, n = self.dae, len(self.dae.states)
        self._solve_algebraic()
        y, step = np.concatenate([self.x, self.z]), FIRST_STEP
        mass = np.where(self.free < n, 1.0, 0.0)
        settling = self.free[self.free < n]
        f, jacobian = self._evaluate(y)
        for _ in range(MOST_STEPS):
            if not np.all(np.isfinite(f)):
                raise self._not_finite(f)
            matrix = np.diag(mass / step) - jacobian[np.ix_(self.free, self.free)]
            trial, change = y.copy(), np.inf
            try:
                correction = np.linalg.solve(matrix, f[self.free])
                trial[self.free] += correction
                change = float(np.max(np.abs(correction) / (self.nominal + np.abs(y))[self.free], initial=0.0))
            except np.linalg.LinAlgError:
                pass
            f_trial, jacobian_trial = self._evaluate(trial)
            if change > MOST_CHANGE or not np.all(np.isfinite(f_trial)):
                step /= 5.0
                if step < LEAST_STEP:
                    break
                continue
            y, f, jacobian = trial, f_trial, jacobian_trial
            at_rest = np.all(np.abs(f[settling]) <= STILL * self.scale[settling])
            if at_rest and change <= 1e-8:
                self._refuse_events(y)
                return self._result(dae, y, f, n)
            step = min(step * min(10.0, max(1.5, 0.2 / max(change, 1e-12))), 1e12)
        raise self._unsettled(y, f, settling)

    def _evaluate(self, y: Reals) -> tuple[Reals, Reals]:
        n = len(self.dae.states)
        f, jacobian = self.function(0.0, y[:n], y[n:], self.u, self.p)
        return np.asarray(f, dtype=np.float64).ravel(), np.asarray(jacobian, dtype=np.float64)

    def _solve_algebraic(self) -> None:
        n = len(self.dae.states)
        if not self.dae.algebraics:
            return

        def residual(z: Reals) -> tuple[Reals, Reals]:
            f, jacobian = self._evaluate(np.concatenate([self.x, z]))
            return f[n:], jacobian[n:, n:]

        z = solve_equations(residual, self.z, self.nominal[n:])
        if z is None:
            names = ", ".join(v.name for v in self.dae.algebraics[:4])
            told = Problem(
                self.dae.name,
                f"the algebraic equations have no solution at the start values (unknowns: {names})",
                hint="Give other start values to these or to the states around them, through `parameters`.",
            )
            raise SolveError([told, *self._undetermined(self.x, self.z, "the start values")])
        self.z = z

    def _result(self, dae: Dae, y: Reals, f: Reals, n: int) -> Trim:
        values = np.asarray(self.results(0.0, y[:n], y[n:], self.u, self.p)).ravel()
        moving = {v.name: float(f[i]) for i, v in enumerate(dae.states) if abs(f[i]) > STILL * self.scale[i]}
        return Trim(
            {v.name: float(value) for v, value in zip(dae.states + dae.algebraics, y, strict=True)},
            {v.name: float(value) for v, value in zip(dae.outputs + dae.observables, values, strict=True)},
            moving,
        )

    def _refuse_events(self, y: Reals) -> None:
        """Raises if an event would take the model out of the modes in which it has been trimmed."""
        dae, n = self.dae, len(self.dae.states)
        now = dict(zip([v.name for v in dae.states + dae.modes], [*y[:n], *self.p[len(dae.parameters) :]], strict=True))
        arguments = [dae.t, dae.x, dae.z, dae.u, dae.p]
        problems = []
        for event in dae.events:
            jump = ca.Function("jump", arguments, [ca.vertcat(event.indicator, *event.resets.values())])
            indicator, *values = np.asarray(jump(0.0, y[:n], y[n:], self.u, self.p)).ravel()
            if indicator > 0 and any(value != now[name] for name, value in zip(event.resets, values, strict=True)):
                modes = [v.name for v in dae.modes if v.name in event.resets]
                hint = f"Start it in the other mode: parameters={{{modes[0]!r}: ...}}." if modes else None
                told = "has happened before the model comes to rest in the modes that it starts in"
                problems.append(Problem(event.name, told, hint=hint))
        if problems:
            raise SolveError(problems)

    def _not_finite(self, f: Reals) -> SolveError:
        names = [v.name for v in self.dae.states + self.dae.algebraics]
        first = names[int(np.flatnonzero(~np.isfinite(f))[0])]
        told = Problem(
            self.dae.name,
            f"the equation of {first} gives no finite value at the start values",
            hint="Look at the parameters and start values of that component.",
        )
        return SolveError([told, *self._undetermined(self.x, self.z, "the start values")])

    def _undetermined(self, x: Reals, z: Reals, when: str) -> list[Problem]:
        return [*undetermined_at(self.dae, Point(0.0, x, z, self.u, self.p), when)]

    def _unsettled(self, y: Reals, f: Reals, settling: Any) -> SolveError:
        relative = np.abs(f[settling]) / self.scale[settling]
        worst = [settling[k] for k in np.argsort(-relative) if relative[k] > STILL][:3]
        if not worst:
            told = Problem(
                self.dae.name,
                "comes to no steady state, though no state moves: the algebraic equations are singular there",
                hint="A closed valve leaves pressures undetermined: give it a little leakage.",
            )
            n = len(self.dae.states)
            return SolveError([told, *self._undetermined(y[:n], y[n:], "that point")])
        problems = []
        for i in worst:
            v = self.dae.states[i]
            unit = v.display_unit
            rate = with_unit(convert(float(f[i]), v.unit, unit), unit, ".3g")
            problems.append(
                Problem(
                    v.name,
                    f"does not settle: it still changes by {rate} per second",
                    hint=f"Change the inputs, or keep it where it is: hold=[{v.name!r}].",
                )
            )
        return SolveError(problems)


def _given(variables: tuple[Variable, ...], values: Mapping[str, float]) -> Reals:
    result = starts(variables)
    for i, v in enumerate(variables):
        if v.name in values:
            result[i] = float(values[v.name])
    return result


def _unknown(dae: Dae, names: Iterable[str], known: list[str], what: str) -> list[Problem]:
    return [Problem(dae.name, f"has no {what} {n!r}", hint=nearest(n, known)) for n in names if n not in set(known)]
