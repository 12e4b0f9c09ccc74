"""Solvers of other libraries, to compare with: SUNDIALS' CVODES through CasADi, and scipy's.

They solve explicit equations, dy/dt = F(t, y). Algebraic unknowns become states by differentiating their equations once
(index reduction), dz/dt = -(d alg/dz)^-1 (d alg/dx f + d alg/dt + k alg): the last term draws a drifting solution back
(Baumgarte, Computer Methods in Applied Mechanics and Engineering 1, 1972). CasADi's IDAS would take them as they are,
but fails on kinks of the equations.
"""

from __future__ import annotations

import re
import time
import warnings
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from seacrane.errors import Problem, SolveError

from .dae import Dae
from .singular import Point
from .solvers import Outcome, Reals, RunStatistics, Task

DRAWN_BACK = 10.0
"""k above [1/s]: below the rates of a hydraulic drive, so that it costs no steps."""

MOST_STEPS = 200_000
"""Between two output times."""

LEAST_STEP = 1e-13
"""[s]; below it a solution is escaping."""

LEAST_RTOL = 1e-13
"""Below it scipy warns and does what it can."""


class ExplicitForm:
    """dy/dt of a model as CasADi functions of (t, y, c): y = [x; z] over nominal values, c = [u; du/dt; t_0].

    The inputs are u + du/dt (t - t_0).
    """

    def __init__(self, dae: Dae, task: Task) -> None:
        if dae.events:
            told = ", ".join(e.name for e in dae.events[:3])
            raise SolveError.at(
                dae.name,
                f"has events ({told}), which solvers of other libraries do not locate here",
                hint="Take one of our own: 'rodas4', 'implicit-euler', 'explicit-euler' or 'rk4'.",
            )
        self.dae, self.task = dae, task
        with task.start() as instance:
            self.start = instance.get([v.name for v in dae.states + dae.algebraics])
            self.inputs = instance.get([v.name for v in dae.inputs])
            self.parameters = instance.get([v.name for v in dae.constants])
        self.nominal = np.array([v.nominal for v in dae.states + dae.algebraics])
        n, nu = self.nominal.size, len(dae.inputs)
        self.t, self.y, self.c = ca.SX.sym("t"), ca.SX.sym("y", n), ca.SX.sym("c", 2 * nu + 1)
        scaled = self.y * ca.DM(self.nominal)
        u = self.c[:nu] + self.c[nu : 2 * nu] * (self.t - self.c[-1])
        here: list[Any] = [self.t, scaled[: len(dae.states)], scaled[len(dae.states) :], u, ca.DM(self.parameters)]
        original: list[Any] = [dae.t, dae.x, dae.z, dae.u, dae.p]
        rate = dae.ode
        if dae.algebraics:
            moved = ca.jtimes(dae.alg, dae.x, dae.ode) + ca.jtimes(dae.alg, dae.t, ca.SX(1)) + DRAWN_BACK * dae.alg
            if dae.inputs:
                du = ca.SX.sym("du", nu)
                moved += ca.jtimes(dae.alg, dae.u, du)
                original, here = [*original, du], [*here, self.c[nu : 2 * nu]]
            rate = ca.vertcat(rate, -ca.solve(ca.jacobian(dae.alg, dae.z), moved))
        names = self._expressions()
        wanted = ca.vertcat(*[names[name] for name in task.names])
        rate, wanted = ca.Function("put", original, [rate, wanted]).call(here)
        self.rate = ca.densify(ca.cse(rate / ca.DM(self.nominal)))
        self._record = ca.Function("record", [self.t, self.y, self.c], [ca.densify(wanted)])

    def _expressions(self) -> dict[str, Any]:
        d = self.dae
        pairs = (
            (d.states, d.x),
            (d.algebraics, d.z),
            (d.inputs, d.u),
            (d.constants, d.p),
            (d.outputs, d.out),
            (d.observables, d.obs),
        )
        return {v.name: expressions[i] for variables, expressions in pairs for i, v in enumerate(variables)}

    def controls(self, grid: Reals) -> Reals:
        """c for each interval of the grid, one row each."""
        nu = len(self.dae.inputs)
        c = np.zeros((grid.size - 1, 2 * nu + 1))
        c[:, :nu] = self.inputs
        c[:, -1] = grid[:-1]
        middle = (grid[:-1] + grid[1:]) / 2
        for i, v in enumerate(self.dae.inputs):
            if v.name in self.task.sampled:
                c[:, i], c[:, nu + i] = _pieces(*self.task.sampled[v.name], grid[:-1], middle, self.task.linear)
        return c

    def breaks(self) -> Reals:
        """Sample times of the inputs within the run, its beginning and its end."""
        first, last = self.task.times[[0, -1]]
        samples = [np.asarray(t, dtype=np.float64).reshape(-1) for t, _ in self.task.sampled.values()]
        every: Reals = np.unique(np.concatenate([[first, last], *samples]))
        return np.array(every[(every >= first) & (every <= last)])

    def record(self, times: Reals, scaled: Reals, controls: Reals) -> Reals:
        """The recorded variables, a row for each time."""
        if not times.size:
            return np.empty((0, len(self.task.names)))
        return np.asarray(self._record(times[None, :], scaled.T, controls.T)).T

    def point(self, time: float, scaled: Reals, control: Reals) -> Point:
        """Where a run stands, for its diagnosis."""
        nx, nu = len(self.dae.states), len(self.dae.inputs)
        y, u = scaled * self.nominal, control[:nu] + control[nu : 2 * nu] * (time - control[-1])
        return Point(time, y[:nx], y[nx:], u, self.parameters)

    def initial(self) -> Reals:
        start: Reals = np.array(self.start / self.nominal)
        return start


def _pieces(t: ArrayLike, v: ArrayLike, begin: Reals, middle: Reals, linear: bool) -> tuple[Reals, Reals]:
    """Value at the beginning of each interval and slope in it, of a sampled signal."""
    times, values = (np.asarray(a, dtype=np.float64).reshape(-1) for a in (t, v))
    at = np.clip(np.searchsorted(times, middle, side="right") - 1, 0, times.size - 1)
    after = np.minimum(at + 1, times.size - 1)
    length = times[after] - times[at]
    rising = linear & (length > 0) & (middle > times[0])
    slope = np.where(rising, (values[after] - values[at]) / np.where(length > 0, length, 1.0), 0.0)
    return values[at] + slope * (begin - times[at]), slope


# ---------------------------------------------------------------- SUNDIALS
@dataclass(frozen=True)
class _Sundials:
    method: ClassVar[str]
    name: ClassVar[str]
    iteration: Literal["newton", "functional"] = "newton"

    def run(self, task: Task) -> Outcome:
        form = ExplicitForm(task.native.dae, task)
        grid = np.union1d(form.breaks(), task.times)
        controls = np.ascontiguousarray(form.controls(grid))
        options: Any = {
            "reltol": task.tolerance,
            "abstol": task.tolerance,
            "linear_multistep_method": self.method,
            "nonlinear_solver_iteration": self.iteration,
            "max_num_steps": MOST_STEPS,
            "min_step_size": LEAST_STEP,
            "show_eval_warnings": False,
            "disable_internal_warnings": True,
        }
        equations: Any = {"t": form.t, "x": form.y, "u": form.c, "ode": form.rate}
        solver = ca.integrator("solver", "cvodes", equations, float(grid[0]), grid[1:].tolist(), options)
        y = np.full((grid.size, form.nominal.size), np.nan)
        y[0] = start = form.initial()
        reached, error = y[1:], None
        buffer: Any
        buffer, evaluate = solver.buffer()
        buffer.set_arg(solver.index_in("x0"), _memory(start))
        buffer.set_arg(solver.index_in("u"), _memory(controls))
        buffer.set_res(solver.index_out("xf"), _memory(reached))
        begun = time.process_time()
        try:
            evaluate()
        except RuntimeError as failure:
            error = str(failure)
        spent = time.process_time() - begun
        good = np.isfinite(y).all(axis=1)
        rows = int(good.size if good.all() else np.argmin(good))
        task.progress(float(grid[rows - 1]), float(grid[-1]))
        kept = np.isin(grid[:rows], task.times)
        held = np.vstack([controls, controls[-1:]])[:rows]  # what holds after a time, as a jump is recorded
        values = form.record(grid[:rows][kept], y[:rows][kept], held[kept])
        try:
            counts = solver.stats(1)
        except RuntimeError:
            counts = {}
        statistics = RunStatistics(
            self.name,
            int(counts.get("nsteps", 0)),
            int(counts.get("netfails", 0)),
            int(counts.get("nfevals", 0)),
            int(counts.get("nlinsetups", 0)),
            spent,
            float(grid[rows - 1] - grid[0]),
        )
        if rows == grid.size:
            return Outcome(values, statistics)
        told = re.search(r'CVode returned "(\w+)"', error or "")
        message = told[1] if told else "a value is not finite"
        here = form.point(float(grid[rows - 1]), y[rows - 1], controls[min(rows, len(controls)) - 1])
        return Outcome(values, statistics, _stopped(task, self.name, here, message))


@dataclass(frozen=True)
class Adams(_Sundials):
    """SUNDIALS' Adams-Moulton methods of variable order and step: for models that are not stiff.

    Each step is solved by Newton's method or, as codes of the field did, by `iteration="functional"`, which holds the
    step down to the fastest rate of the model.
    """

    method = "adams"
    name = "Adams (SUNDIALS)"


@dataclass(frozen=True)
class BDF(_Sundials):
    """SUNDIALS' backward differentiation formulas of variable order and step: for stiff models.

    Source: A. C. Hindmarsh et al., SUNDIALS, ACM Transactions on Mathematical Software 31, 2005.
    """

    method = "bdf"
    name = "BDF (SUNDIALS)"


# ---------------------------------------------------------------- scipy
@dataclass(frozen=True)
class _Scipy:
    method: ClassVar[str]
    name: ClassVar[str]

    def run(self, task: Task) -> Outcome:
        import scipy.integrate

        form = ExplicitForm(task.native.dae, task)
        breaks = form.breaks()
        controls = form.controls(breaks)
        rhs = _Buffered([form.t, form.y, form.c], form.rate)
        jacobian = _Buffered([form.t, form.y, form.c], ca.densify(ca.jacobian(form.rate, form.y)))
        method = getattr(scipy.integrate, self.method)
        accuracy = {"rtol": max(task.tolerance, LEAST_RTOL), "atol": task.tolerance}
        y, end = form.initial(), float(breaks[-1])
        values = [form.record(breaks[:1], y[None, :], controls[:1])]
        steps = evaluations = jacobians = 0
        spent, error = 0.0, None
        for c, a, b in zip(controls, breaks[:-1].tolist(), breaks[1:].tolist(), strict=True):
            wanted = task.times[(task.times > a) & (task.times <= b)]
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # what goes wrong is told by the status
                begun = time.process_time()
                solver = method(
                    lambda t, y, c=c: rhs(t, y, c),
                    a,
                    y,
                    b,
                    jac=lambda t, y, c=c: np.atleast_2d(jacobian(t, y, c)),
                    **accuracy,
                )
                while solver.status == "running":
                    before = solver.y
                    try:
                        message = solver.step()
                    except (ValueError, np.linalg.LinAlgError):  # a matrix of this method is not finite, or singular
                        solver.status, message = "failed", "its equations are singular or not finite"
                    vanished = solver.status == "running" and solver.t - solver.t_old < LEAST_STEP
                    if solver.status == "failed" or vanished or not np.isfinite(solver.y).all():
                        here = form.point(float(a if solver.t_old is None else solver.t_old), before, c)
                        error = _stopped(task, self.name, here, message or "no further step is possible")
                        break
                    steps += 1
                    within = wanted[(wanted > solver.t_old) & (wanted <= solver.t)]
                    if within.size:
                        found = solver.dense_output()(within).T
                        values.append(form.record(within, found, np.repeat(c[None, :], within.size, axis=0)))
                    task.progress(float(solver.t), end)
                spent += time.process_time() - begun
            evaluations, jacobians = evaluations + solver.nfev, jacobians + solver.njev
            reached, y = float(solver.t), solver.y
            if error is not None:
                break
        statistics = RunStatistics(self.name, steps, 0, evaluations, jacobians, spent, reached - float(breaks[0]))
        return Outcome(np.concatenate(values), statistics, error)


def _memory(array: Any) -> Any:
    return memoryview(array)


class _Buffered:
    """A CasADi function of (t, y, c) called without its own wrapping, which costs twenty times as much."""

    def __init__(self, arguments: list[Any], expression: Any) -> None:
        function = ca.Function("f", arguments, [ca.cse(expression)])
        self._arguments = tuple(np.zeros(a.numel()) for a in arguments)
        self._result = np.zeros(expression.shape, order="F")
        buffer: Any
        buffer, self._evaluate = function.buffer()
        self._buffer = buffer
        for i, a in enumerate(self._arguments):
            buffer.set_arg(i, _memory(a))
        buffer.set_res(0, _memory(self._result.T))

    def __call__(self, *values: Any) -> Reals:
        for argument, value in zip(self._arguments, values, strict=True):
            argument[:] = value
        self._evaluate()
        return self._result[:, 0].copy() if self._result.shape[1] == 1 else self._result.copy()


@dataclass(frozen=True)
class LSODA(_Scipy):
    """scipy's LSODA: Adams or BDF, whichever the model asks for."""

    method = "LSODA"
    name = "LSODA (scipy)"


@dataclass(frozen=True)
class Radau(_Scipy):
    """scipy's implicit Runge-Kutta method of order 5, slow and of high accuracy: a reference for the others."""

    method = "Radau"
    name = "Radau (scipy)"


def _stopped(task: Task, solver: str, here: Point, message: str) -> SolveError:
    hint = "Another solver may manage (RODAS4 says which state is at fault), or a longer tolerance."
    told = Problem(task.native.name, f"{solver} stopped after t = {here.time:.9g} s: {message}", hint=hint)
    return task.explained(SolveError(told), here)
