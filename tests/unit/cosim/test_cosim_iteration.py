"""Macro steps that are repeated: what they converge to, how fast, and what is told when they do not."""

import casadi as ca
import numpy as np
import pytest
from oscillators import X1, exact, functions, models, system

from seacrane.cosim import (
    Adaptive,
    Execution,
    FixedPoint,
    FunctionSlave,
    GaussSeidel,
    Iterative,
    Jacobi,
    ModelSlave,
    Newton,
    StepDoubling,
    System,
)
from seacrane.errors import CosimError
from seacrane.model.dae import Dae, Variable

LOOPS = pytest.mark.parametrize("loop", ["c", "python"])


def loop_of(gain: float) -> System:
    """y_a = 1 + gain y_b and y_b = gain y_a, both without delay: y_a = 1 / (1 - gain^2)."""
    looped = System("loop")
    looped.add("a", FunctionSlave(lambda t, h, u: 1 + gain * u, [Variable("u")], [Variable("y")]))
    looped.add("b", FunctionSlave(lambda t, h, u: gain * u, [Variable("u")], [Variable("y")]))
    looped.connect("a.y", "b.u")
    looped.connect("b.y", "a.u")
    return looped


def moved(algorithm, slaves=functions, until=1.0, loop="auto"):
    with Execution(system(slaves()), algorithm, loop=loop) as run:
        recording = run.run(until)
        return recording["one.position"], run.usage.sweeps


@LOOPS
@pytest.mark.parametrize("base", [Jacobi, GaussSeidel])
def test_all_solvers_come_to_the_same_motion(base, loop):
    found = [
        moved(Iterative(base(0.02, extrapolation="linear"), solver, tolerance=1e-10), loop=loop)[0]
        for solver in (FixedPoint(), FixedPoint(0.6, aitken=False), Newton())
    ]
    assert np.ptp(found, axis=0).max() < 1e-9


@LOOPS
def test_aitken_converges_where_plain_iteration_swings_up(loop):
    # y = 1 - 1.5 y around the loop: passed back as it is, it grows by 1.5 each time.
    looped = System("loop")
    looped.add("a", FunctionSlave(lambda t, h, u: 1.0 + t - 1.5 * u, [Variable("u")], [Variable("y")]))
    looped.add("b", FunctionSlave(lambda t, h, u: u, [Variable("u")], [Variable("y")]))
    looped.connect("a.y", "b.u")
    looped.connect("b.y", "a.u")
    plain = Iterative(GaussSeidel(0.5), FixedPoint(aitken=False))
    with Execution(looped, plain, loop=loop) as run, pytest.raises(CosimError, match="does not converge"):
        run.step(3)
    with Execution(looped, Iterative(GaussSeidel(0.5)), loop=loop) as run:
        run.step(3)
        assert run.values(["a.y"])[0] == pytest.approx((1.0 + 1.0) / 2.5, rel=1e-5)


def test_newton_needs_a_fraction_of_the_steps_of_the_slaves():
    def sweeps(solver):
        algorithm = Iterative(Jacobi(0.1, extrapolation="linear"), solver, tolerance=1e-9)
        return moved(algorithm, until=4.0)[1]

    assert sweeps(Newton()) < 0.25 * min(sweeps(FixedPoint(1.0, aitken=False)), sweeps(FixedPoint()))


@LOOPS
def test_iteration_is_stable_at_a_step_at_which_explicit_coupling_is_not(loop):
    wild = moved(Jacobi(0.1), until=100.0, loop=loop)[0]
    tame = moved(Iterative(Jacobi(0.1), Newton()), until=100.0, loop=loop)[0]
    assert np.abs(wild).max() > 1e3
    assert np.abs(tame).max() <= X1


@LOOPS
@pytest.mark.parametrize("gain", [0.5, 2.0, 20.0])
def test_newton_solves_loops_without_delay_whatever_their_gain(gain, loop):
    with Execution(loop_of(gain), Iterative(Jacobi(0.1), Newton(), tolerance=1e-12), loop=loop) as run:
        run.step(3)
        assert run.values(["a.y", "b.y"]) == pytest.approx([1 / (1 - gain**2), gain / (1 - gain**2)], rel=1e-9)


def test_what_does_not_converge_is_named_with_the_step():
    def growing(t, h, u):
        return [1.0 + (0.5 if t < 0.25 else 3.0) * u[0]]

    looped = System("loop")
    looped.add("a", FunctionSlave(growing, [Variable("u")], [Variable("y")]))
    looped.add("b", FunctionSlave(lambda t, h, u: u, [Variable("u")], [Variable("y")]))
    looped.connect("a.y", "b.u")
    looped.connect("b.y", "a.u")
    with Execution(looped, Iterative(GaussSeidel(0.1), FixedPoint(1.0, aitken=False), most=9)) as run:
        with pytest.raises(CosimError) as caught:
            run.step(10)
        assert run.time == pytest.approx(0.3)
        assert isinstance(run.error, CosimError)
    assert [p.path for p in caught.value.problems] == ["a.y", "b.y"][: len(caught.value.problems)]
    said = str(caught.value.problems[0])
    assert "does not converge in the step from t = 0.3 to 0.4 s (after 9 iterations, tolerance 1e-06) (got " in said
    assert "float64" not in said
    assert "Take a shorter step, Newton()" in said


class Forgetful(FunctionSlave):
    """A slave that cannot be saved, as many FMUs."""

    def instantiate(self, name):
        instance = super().instantiate(name)

        def save():
            raise CosimError.at(name, "has no way to save its state")

        instance.save = save
        return instance


@pytest.mark.parametrize(
    "algorithm",
    [Iterative(GaussSeidel(0.1)), Adaptive(GaussSeidel(0.1), StepDoubling())],
    ids=["iterative", "doubling"],
)
def test_slaves_that_cannot_be_brought_back_are_named_at_the_start(algorithm):
    system = System(
        "s", {n: Forgetful(lambda t, h, u: u, [Variable("u")], [Variable("y")]) for n in ("first", "second")}
    )
    run = Execution(system, algorithm)
    with pytest.raises(CosimError) as caught:
        run.start()
    assert [p.path for p in caught.value.problems] == ["first", "second"]
    assert "cannot be saved and restored, which" in caught.value.problems[0].message
    assert "has no way to save its state" in caught.value.problems[0].message


def test_the_iterations_of_each_step_can_be_recorded():
    with Execution(system(functions()), Iterative(GaussSeidel(0.01))) as run:
        run.record(["iterations"])
        recording = run.run(0.2)
    assert recording["iterations"][0] == 0
    assert recording["iterations"][1:].min() >= 1
    assert recording["iterations"].max() < 10


def test_the_tolerance_is_kept():
    until = 2.0
    tight = moved(Iterative(GaussSeidel(0.02, extrapolation="linear"), tolerance=1e-12), until=until)[0]
    errors = []
    for tolerance in (1e-3, 1e-5, 1e-7):
        loose = moved(Iterative(GaussSeidel(0.02, extrapolation="linear"), tolerance=tolerance), until=until)[0]
        errors.append(np.abs(loose - tight).max())
        assert errors[-1] < 10 * tolerance
    assert errors[2] < errors[1] < errors[0]


def test_compiled_models_iterate_like_functions():
    algorithm = Iterative(GaussSeidel(0.01), Newton(), tolerance=1e-9)
    assert moved(algorithm, models)[0] == pytest.approx(moved(algorithm)[0], abs=1e-8)
    assert np.abs(moved(algorithm)[0] - exact(np.linspace(0, 1, 101))).max() < 0.02


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Iterative(GaussSeidel(0.1), tolerance=0.0), "tolerance: must be positive"),
        (lambda: Iterative(GaussSeidel(0.1), most=0), "most: is no number of iterations"),
        (lambda: Iterative(GaussSeidel(0.1, conserve=True)), "conserve: has no meaning"),
        (lambda: FixedPoint(0.0), "relaxation: is no factor"),
        (lambda: FixedPoint(2.5), "relaxation: is no factor"),
    ],
)
def test_settings_without_meaning_are_refused(make, said):
    with pytest.raises(CosimError, match=said):
        make()


def quasistatic(name: str, gain: float) -> ModelSlave:
    """y = gain u + w of a compiled model: all its sensitivity is in its directional derivative."""
    u, none = ca.SX.sym("u", 2), ca.SX(0, 1)
    return ModelSlave(
        Dae(
            name, (), (), (Variable("u"), Variable("w")), (), (Variable("y"),), (), ca.SX.sym("t"), none, none, u, none,
            none, none, gain * u[0] + u[1], none,
        )
    )  # fmt: skip


@LOOPS
@pytest.mark.parametrize("extrapolation", ["hold", "linear"])
def test_directional_derivatives_spare_the_steps_for_differences(extrapolation, loop):
    looped = System("loop", {"a": quasistatic("a", 3.0), "b": quasistatic("b", 2.0)})
    looped.connect("a.y", "b.u")
    looped.connect("b.y", "a.u")
    algorithm = Iterative(Jacobi(0.1, extrapolation=extrapolation), Newton(), tolerance=1e-12)
    with Execution(looped, algorithm, loop=loop) as run:
        run.start()
        run.set("a.w", 1.0)
        called = run._plan.calls.copy()
        run.step(1)
        assert run.values(["a.y", "b.y"]) == pytest.approx([-0.2, -0.4], rel=1e-12)
        assert (run._plan.calls - called).tolist() == [4, 4]  # two for each step: one before and one after
