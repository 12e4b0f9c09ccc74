"""The integration methods of the C core, examined on problems with closed solutions."""

import math
from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np
import pytest

from seacrane.errors import SolveError
from seacrane.model.dae import Dae, Variable, column
from seacrane.model.native import NativeInstance, NativeModel, build

LOOSE = 1e6  # as nominal value: every step passes the error test, so the caller's step is the solver's step


def scalar(ode: Callable[[Any, Any], Any], start: float = 1.0, nominal: float = 1.0) -> NativeModel:
    """x' = ode(t, x)."""
    t, x, none = ca.SX.sym("t"), ca.SX.sym("x"), ca.SX(0, 1)
    state = Variable("x", start=start, nominal=nominal)
    return build(Dae("scalar", (state,), (), (), (), (), (), t, x, none, none, none, ode(t, x), none, none, none))


def implicit(nominal: float = 1.0) -> NativeModel:
    """x' = z, 0 = z^3 + z - cos^3 t - cos t + (x - sin t): a nonlinear index-1 DAE with x = sin t and z = cos t."""
    t, x, z, none = ca.SX.sym("t"), ca.SX.sym("x"), ca.SX.sym("z"), ca.SX(0, 1)
    alg = z**3 + z - ca.cos(t) ** 3 - ca.cos(t) + (x - ca.sin(t))
    states, algebraics = (Variable("x", nominal=nominal),), (Variable("z", start=5.0, nominal=nominal),)
    return build(Dae("implicit", states, algebraics, (), (), (), (), t, x, z, none, none, z, alg, none, none))


def error_after(model: NativeModel, step: float, end: float, exact: dict[str, float], **settings: float) -> float:
    with model.instantiate() as run:
        for name, value in settings.items():
            run.set(f"solver.{name}", value)
        run.initialize(0.0)
        for k in range(round(end / step)):
            run.step(k * step, step)
        return max(abs(run.get(name) - value) for name, value in exact.items())


def orders(model: NativeModel, steps: list[float], end: float, exact: dict[str, float], fixed: bool) -> list[float]:
    errors = [error_after(model, h, end, exact, **({"fixed_step": h} if fixed else {"tolerance": 0.1})) for h in steps]
    return [math.log(a / b) / math.log(g / h) for a, b, g, h in zip(errors, errors[1:], steps, steps[1:], strict=False)]


def test_the_rosenbrock_method_is_of_order_4_on_a_nonlinear_equation_that_depends_on_time() -> None:
    riccati = scalar(lambda t, x: -2 * t * x**2, nominal=LOOSE)  # x = 1/(1 + t^2)
    found = orders(riccati, [0.1, 0.05, 0.025], 2.0, {"x": 1 / 5}, fixed=False)
    assert found == pytest.approx([4, 4], abs=0.25)


def test_the_rosenbrock_method_is_of_order_4_on_states_and_unknowns_of_a_nonlinear_dae() -> None:
    exact = {"x": math.sin(2.0), "z": math.cos(2.0)}
    assert min(orders(implicit(nominal=LOOSE), [0.1, 0.05, 0.025], 2.0, exact, fixed=False)) > 3.75


def test_the_linearly_implicit_euler_method_is_of_order_1() -> None:
    riccati = scalar(lambda t, x: -2 * t * x**2)
    assert orders(riccati, [0.02, 0.01, 0.005], 2.0, {"x": 1 / 5}, fixed=True) == pytest.approx([1, 1], abs=0.05)
    exact = {"x": math.sin(2.0)}
    assert orders(implicit(), [0.02, 0.01, 0.005], 2.0, exact, fixed=True) == pytest.approx([1, 1], abs=0.1)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8])
def test_the_error_follows_the_tolerance(tolerance: float) -> None:
    exact = {"x": math.sin(10.0), "z": math.cos(10.0)}
    assert error_after(implicit(), 10.0, 10.0, exact, tolerance=tolerance) < 20 * tolerance


def test_a_rate_of_a_million_per_second_costs_no_small_steps() -> None:
    stiff = scalar(lambda t, x: -1e6 * (x - ca.cos(t)) - ca.sin(t))  # x = cos t
    with stiff.instantiate() as run:
        run.set("solver.tolerance", 1e-6)
        run.initialize(0.0)
        times = np.linspace(0, 10, 21)
        assert run.simulate(times, ["x"])[:, 0] == pytest.approx(np.cos(times), abs=1e-5)
        assert run.statistics.steps < 500


def forced(model: NativeModel, tolerance: float, count: int, x: str = "x") -> tuple[float, int]:
    """The largest error against cos t of a run over 10 s that gives so many values, and its steps."""
    times = np.linspace(0, 10, count)
    with model.instantiate() as run:
        run.set("solver.tolerance", tolerance)
        run.initialize(0.0)
        return float(abs(run.simulate(times, [x])[:, 0] - np.cos(times)).max()), run.statistics.steps


@pytest.mark.parametrize("rate", [0.0, 1.0, 30.0, 1e6])
def test_values_between_steps_are_as_good_as_the_tolerance_and_end_no_step(rate: float) -> None:
    model = scalar(lambda t, x: -rate * (x - ca.cos(t)) - ca.sin(t))  # x = cos t
    for tolerance in (1e-4, 1e-7):
        error, steps = forced(model, tolerance, 5001)
        assert error < 10 * tolerance
        assert steps < 600
        assert abs(steps - forced(model, tolerance, 501)[1]) < 5


def test_unknowns_that_follow_time_alone_are_right_between_steps() -> None:
    t, z, none = ca.SX.sym("t"), ca.SX.sym("z"), ca.SX(0, 1)
    alg = z + z**3 - ca.cos(t) - ca.cos(t) ** 3
    model = build(Dae("led", (), (Variable("z"),), (), (), (), (), t, none, z, none, none, none, alg, none, none))
    assert forced(model, 1e-5, 1001, "z")[0] < 1e-4


def test_an_oscillator_loses_energy_only_within_the_tolerance_and_never_gains() -> None:
    t, x, none = ca.SX.sym("t"), ca.SX.sym("x", 2), ca.SX(0, 1)
    energy = column((x[0] ** 2 + x[1] ** 2) / 2)
    states = (Variable("x", "m", 1.0), Variable("v", "m/s"))
    model = build(
        Dae(
            "oscillator",
            states,
            (),
            (),
            (),
            (),
            (Variable("E", "J"),),
            t,
            x,
            none,
            none,
            none,
            column(x[1], -x[0]),
            none,
            none,
            energy,
        )
    )
    with model.instantiate() as run:
        run.set("solver.tolerance", 1e-7)
        run.initialize(0.0)
        stored = [run.get("E")]
        for t in range(0, 200, 2):  # at the ends of steps
            run.step(t, 2)
            stored.append(run.get("E"))
    assert np.all(np.diff(stored) <= 1e-12)
    assert stored[-1] == pytest.approx(0.5, rel=1e-4)


def test_unknowns_start_consistent_even_from_a_guess_far_off() -> None:
    with implicit().instantiate() as run:
        run.initialize(0.5)  # x(0.5) starts at 0, which is not on the closed solution, but z must still fit it
        z = run.get("z")
        assert z**3 + z == pytest.approx(math.cos(0.5) ** 3 + math.cos(0.5) + math.sin(0.5), rel=1e-12)


def fed(name: str = "fed") -> NativeModel:
    """x' = u, 0 = z - 2 u, y = x + z: an integrator with feedthrough through an algebraic unknown."""
    t, x, z, u, none = (*(ca.SX.sym(s) for s in "txzu"), ca.SX(0, 1))
    return build(
        Dae(
            name,
            (Variable("x"),),
            (Variable("z"),),
            (Variable("u"),),
            (),
            (Variable("y"),),
            (),
            t,
            x,
            z,
            u,
            none,
            u,
            z - 2 * u,
            x + z,
            none,
        )
    )


def test_an_input_shows_at_once_in_an_output_that_depends_on_it_through_an_unknown() -> None:
    with fed().instantiate() as run:
        run.initialize(0.0)
        run.set("u", 3.0)
        assert run.get("y") == pytest.approx(6.0, rel=1e-14)


def test_sampled_inputs_are_integrated_as_steps_or_as_straight_lines() -> None:
    inputs = {"u": ([0.0, 1.0, 3.0], [1.0, 2.0, 0.0])}
    with fed().instantiate() as run:
        run.initialize(0.0)
        assert run.simulate([1.0, 2.0, 4.0], ["x", "u"], inputs) == pytest.approx(np.array([[1, 2], [3, 2], [5, 0]]))
        run.reset()
        run.initialize(0.0)
        lines = run.simulate([1.0, 2.0, 4.0], ["x", "u"], inputs, linear=True)
        assert lines == pytest.approx(np.array([[1.5, 2], [3, 1], [3.5, 0]]))


def test_order_4_holds_with_inputs_on_straight_lines() -> None:
    t, x, u, none = (*(ca.SX.sym(s) for s in "txu"), ca.SX(0, 1))
    states = (Variable("x", start=1.0, nominal=LOOSE),)
    model = build(
        Dae("ramp", states, (), (Variable("u"),), (), (), (), t, x, none, u, none, -2 * u * x**2, none, none, none)
    )
    errors = []
    for h in (0.1, 0.05, 0.025):
        with model.instantiate() as run:
            run.set("solver.tolerance", 0.1)
            run.initialize(0.0)
            grid = h * np.arange(round(2 / h) + 2)  # a step ends at each sample
            errors.append(abs(run.simulate([2.0], ["x"], {"u": (grid, grid)}, linear=True)[0, 0] - 1 / 5))
    assert np.log2(errors[:-1] / np.array(errors[1:])) == pytest.approx([4, 4], abs=0.25)


def test_inputs_on_different_sample_times_are_merged() -> None:
    t, x, u, none = ca.SX.sym("t"), ca.SX.sym("x"), ca.SX.sym("u", 2), ca.SX(0, 1)
    two = (Variable("a"), Variable("b"))
    model = build(
        Dae("two", (Variable("x"),), (), two, (), (), (), t, x, none, u, none, u[0] + 10 * u[1], none, none, none)
    )
    inputs = {"a": ([0.0, 1.0], [0.0, 1.0]), "b": ([0.0, 0.5], [0.0, 1.0])}
    for linear, expected in ((False, 1 + 15), (True, 0.5 + 1 + 10 * 1.75)):
        with model.instantiate() as run:
            run.initialize(0.0)
            assert run.simulate([2.0], ["x"], inputs, linear=linear)[0, 0] == pytest.approx(expected)


def test_a_model_without_any_state_only_moves_on_in_time() -> None:
    t, none = ca.SX.sym("t"), ca.SX(0, 1)
    model = build(
        Dae("ship", (), (), (), (), (Variable("z", "m"),), (), t, none, none, none, none, none, none, ca.sin(t), none)
    )
    with model.instantiate() as run:
        run.initialize(0.0)
        run.step(0.0, 0.5)
        assert (run.time, run.get("z")) == (0.5, math.sin(0.5))


def blow_up(run: NativeInstance) -> SolveError:
    run.initialize(0.0)
    with pytest.raises(SolveError) as caught:
        run.step(0.0, 2.0)
    return caught.value


def test_a_step_that_cannot_be_done_names_the_state_and_leaves_the_last_good_point() -> None:
    runaway = scalar(lambda t, x: x**2)  # x = 1/(1 - t)
    with runaway.instantiate("runaway") as run:
        message = str(blow_up(run))
        assert run.time == pytest.approx(1.0, abs=1e-3)
        assert 1e3 < run.get("x") < math.inf
    assert message.startswith("runaway: the step size fell below")
    assert "x could not be integrated" in message
    assert "x: is at" in message
    assert "Look at its equation" in message


def test_equations_that_are_not_finite_name_the_first_such_state() -> None:
    root = scalar(lambda t, x: ca.sqrt(0.5 - t))
    with root.instantiate("root") as run:
        message = str(blow_up(run))
        assert run.time < 0.5
    assert " x " in message


def test_algebraic_equations_without_a_solution_say_so_at_the_start() -> None:
    t, z, none = ca.SX.sym("t"), ca.SX.sym("z"), ca.SX(0, 1)
    model = build(
        Dae("none", (), (Variable("p"),), (), (), (), (), t, none, z, none, none, none, z**2 + 1 + z, none, none)
    )
    with model.instantiate() as run, pytest.raises(SolveError, match=r"algebraic equations .* at t = 0 s.* p\b"):
        run.initialize(0.0)
