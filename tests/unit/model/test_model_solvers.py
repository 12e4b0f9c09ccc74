"""Every solver comes to the same solution, at its own order, and says where it had to stop."""

import io
import math

import casadi as ca
import numpy as np
import pytest
from parts import Lag

from seacrane.errors import ParameterError, SolveError
from seacrane.model import SOLVERS, Dae, Diagram, ExplicitEuler, RungeKutta4, Variable, simulate
from seacrane.model.solvers import ProgressBar


def lag():
    diagram = Diagram("following")
    part = diagram.add("lag", Lag(rate=2.0))
    diagram.expose(u=part.u, y=part.y)
    return diagram


def equation(ode, start=1.0, alg=None):
    """dx/dt = ode(x, z, u), 0 = alg(x, z, u)."""
    x, u, none = ca.SX.sym("x"), ca.SX.sym("u"), ca.SX(0, 1)
    z = ca.SX.sym("z") if alg else none
    return Dae(
        "equation",
        (Variable("x", start=start),),
        (Variable("z", nominal=0.5),) if alg else (),
        (Variable("u"),),
        (),
        (),
        (Variable("seen"),),
        t=ca.SX.sym("t"), x=x, z=z, u=u, p=none, ode=ca.SX(ode(x, z, u)), alg=ca.SX(alg(x, z, u)) if alg else none,
        out=none, obs=x - u,
    )  # fmt: skip


every_solver = pytest.mark.parametrize("solver", [ExplicitEuler(1e-4), *(s for s in SOLVERS if s != "explicit-euler")])


@every_solver
def test_every_solver_follows_the_exponential(solver):
    run = simulate(lag(), 2.0, every=0.1, inputs={"u": 1.0}, solver=solver, tolerance=1e-8)
    assert run["y"] == pytest.approx(1 - np.exp(-2.0 * run.time), abs=5e-4)
    assert run.statistics.simulated == pytest.approx(2.0)
    assert run.statistics.steps > 0
    assert run.statistics.real_time_factor == pytest.approx(run.statistics.cpu_time / 2.0)


@every_solver
def test_every_solver_takes_a_jump_and_a_ramp_where_they_are(solver):
    held = {"u": ([0.0, 0.75], [1.0, 3.0])}
    run = simulate(equation(lambda x, z, u: u, 0.0), 1.5, every=0.5, inputs=held, solver=solver)
    assert run["x"] == pytest.approx([0.0, 0.5, 1.5, 3.0], abs=1e-3)
    assert run["seen"] == pytest.approx(run["x"] - [1.0, 1.0, 3.0, 3.0], abs=1e-9)
    ramp = {"u": ([0.5, 1.0, 1.0], [0.0, 1.0, 5.0])}
    run = simulate(equation(lambda x, z, u: u, 0.0), 1.5, every=0.5, inputs=ramp, solver=solver, linear=True)
    assert run["x"] == pytest.approx([0.0, 0.0, 0.25, 2.75], abs=1e-3)


@every_solver
def test_every_solver_takes_algebraic_unknowns_along(solver):
    """z^3 + z = x and dx/dt = -z give dz/dt = -z / (3 z^2 + 1): 3 z^2 / 2 + ln z falls by t."""
    model = equation(lambda x, z, u: -z, 2.0, lambda x, z, u: z**3 + z - x)
    run = simulate(model, 2.0, every=0.25, solver=solver, tolerance=1e-8)
    z = run["z"]
    assert z**3 + z == pytest.approx(run["x"], rel=1e-5)
    assert 1.5 * z**2 + np.log(z) == pytest.approx(1.5 - run.time, abs=1e-3)


@pytest.mark.parametrize(("solver", "order"), [(ExplicitEuler, 1), (RungeKutta4, 4)])
def test_explicit_methods_converge_at_their_order(solver, order):
    errors = [
        abs(simulate(lag(), 1.0, every=1.0, inputs={"u": 1.0}, solver=solver(step))["y"][-1] - (1 - math.exp(-2.0)))
        for step in (0.1, 0.05, 0.025)
    ]
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx([order, order], abs=0.15)


@pytest.mark.parametrize("solver", [*(s for s in SOLVERS if s not in ("rk4", "explicit-euler", "implicit-euler"))])
def test_a_solution_that_escapes_leaves_what_was_computed_before(solver):
    """dx/dt = x^2 from 1 is 1 / (1 - t): nothing lies beyond t = 1."""
    with pytest.raises(SolveError, match=r"t = (0\.9|1\.00|1 s)") as failure:
        simulate(equation(lambda x, z, u: x * x), 2.0, every=0.1, solver=solver, tolerance=1e-8)
    run = failure.value.results
    assert len(run) >= 10
    assert run["x"][:10] == pytest.approx(1 / (1 - run.time[:10]), rel=1e-5)
    assert run.statistics.simulated == pytest.approx(1.0, abs=0.11)  # SUNDIALS tells the last output


def test_too_long_a_step_of_an_explicit_method_is_told_with_state_and_time():
    with pytest.raises(
        SolveError, match=r"lag.level is not finite after the step of 2 s .* too long a step"
    ) as failure:
        simulate(lag(), 4000.0, every=2.0, inputs={"u": 1.0}, solver=ExplicitEuler(2.0))
    assert 500 < len(failure.value.results) < 2000


def test_an_unknown_solver_and_an_impossible_step_are_refused():
    with pytest.raises(SolveError, match="Did you mean 'rodas4'"):
        simulate(lag(), 1.0, solver="rodas")
    with pytest.raises(ParameterError, match="above 0 s"):
        RungeKutta4(step=0.0)


@pytest.mark.parametrize("solver", ["rodas4", "bdf", "lsoda"])
def test_progress_ends_at_the_end(solver):
    seen = []
    simulate(lag(), 1.0, inputs={"u": 1.0}, solver=solver, progress=lambda now, until: seen.append((now, until)))
    assert seen == sorted(seen)
    assert seen[-1] == pytest.approx((1.0, 1.0))


def test_a_progress_bar_waits_for_a_run_to_be_long():
    for after, shown in ((60.0, False), (0.0, True)):
        stream = io.StringIO()
        bar = ProgressBar(after=after, stream=stream)
        bar(5.0, 10.0)
        bar(10.0, 10.0)
        assert ("10 of 10 s" in stream.getvalue()) is shown
