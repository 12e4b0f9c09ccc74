"""Macro steps chosen by their error: where they end, how small they get, and when they are repeated."""

import math

import numpy as np
import pytest
from oscillators import X1, exact, functions, models, system

from seacrane.cosim import (
    Adaptive,
    Execution,
    FunctionSlave,
    GaussSeidel,
    Iterative,
    Jacobi,
    Newton,
    PowerResidual,
    StepDoubling,
    System,
)
from seacrane.errors import CosimError
from seacrane.model.dae import Variable

LOOPS = pytest.mark.parametrize("loop", ["c", "python"])


def error(algorithm, slaves=functions) -> tuple[float, int]:
    with Execution(system(slaves()), algorithm) as run:
        run.record(["one.position"], every=0.1)
        recording = run.run(4.0)
        sweeps = run.usage.sweeps
    assert recording.time == pytest.approx(np.arange(41) * 0.1, abs=1e-12)
    return float(np.sqrt(np.mean((recording["one.position"] - exact(recording.time)) ** 2))), sweeps


@pytest.mark.parametrize("control", [PowerResidual, StepDoubling])
def test_the_error_falls_with_the_tolerance_and_the_cost_rises(control):
    found = [error(Adaptive(Jacobi(0.1), control(tolerance), smallest=1e-6)) for tolerance in (1e-1, 1e-2, 1e-3)]
    errors, sweeps = zip(*found, strict=True)
    assert errors[0] > 1.5 * errors[1] > 3 * errors[2]
    assert sweeps[0] < sweeps[1] < sweeps[2]


def test_doubling_keeps_the_error_near_its_tolerance():
    for tolerance in (1e-2, 1e-3):
        found, _ = error(Adaptive(GaussSeidel(0.1, extrapolation="linear"), StepDoubling(tolerance), smallest=1e-6))
        assert found < 5 * tolerance * X1


@LOOPS
@pytest.mark.parametrize("control", [PowerResidual(1e-3), StepDoubling(1e-3)])
def test_every_point_of_the_grid_is_reached_exactly(control, loop):
    ends: list[float] = []

    def clock(t, h, u):
        if h > 0:
            ends.append(t + h)
        return [t + h]

    whole = system(functions())
    whole.add("clock", FunctionSlave(clock, outputs=[Variable("t", "s")]))
    with Execution(whole, Adaptive(Jacobi(0.03), control, smallest=1e-5), loop=loop) as run:
        run.record(["clock.t", "macro_step"])
        recording = run.run(0.9)
        assert recording.time.tolist() == [i * 30_000_000 / 1e9 for i in range(31)]
        assert recording["clock.t"] == pytest.approx(recording.time, abs=1e-14)
        assert len(ends) > 60
        steps = recording["macro_step"][1:]
        assert steps.min() >= 1e-5
        assert steps.max() <= 0.03
        assert np.ptp(steps) > 0


def burst() -> System:
    """A force that rises from nothing at t = 1 s on a velocity that does not care: residual power from then on."""
    given = System("burst")
    force, velocity = Variable("force", "N"), Variable("velocity", "m/s")

    def push(t, h, u):
        return [max(0.0, math.sin(20.0 * (t + h - 1.0))) if t + h > 1.0 else 0.0]

    given.add("drive", FunctionSlave(push, [velocity], [force]))
    given.add("load", FunctionSlave(lambda t, h, u: [1.0], [force], [velocity]))
    given.bond("rod", effort=("drive.force", "load.force"), flow=("load.velocity", "drive.velocity"))
    return given


@LOOPS
def test_steps_are_long_while_nothing_is_lost_and_short_while_something_is(loop):
    with Execution(burst(), Adaptive(Jacobi(0.05), PowerResidual(1e-2)), loop=loop) as run:
        run.record(["macro_step", "coupling_error"])
        recording = run.run(2.0)
    step, quiet = recording["macro_step"], (recording.time > 0.5) & (recording.time < 1.0)
    assert np.all(step[quiet] == 0.05)
    assert np.all(recording["coupling_error"][quiet] == 0.0)
    assert step[recording.time > 1.2].min() < 0.01


def test_a_given_power_takes_the_place_of_the_greatest_one():
    def sweeps(power):
        with Execution(burst(), Adaptive(Jacobi(0.05), PowerResidual(1e-2, power))) as run:
            run.advance(2.0)
            return run.usage.sweeps

    assert sweeps(100.0) < 0.6 * sweeps(1.0)
    assert sweeps(1.0) <= sweeps(0.01)


@LOOPS
def test_a_step_that_a_slave_discards_is_repeated_with_a_smaller_one(loop):
    class Choosy(FunctionSlave):
        def instantiate(self, name):
            instance = super().instantiate(name)
            advance = instance.advance
            instance.advance = lambda t, h: 2 if t >= 1.0 and h > 0.011 else advance(t, h)
            return instance

    whole = System("s", {"f": Choosy(lambda t, h, x, u: (x + h, x + h), [], [Variable("y")], [0.0])})
    with Execution(whole, Adaptive(Jacobi(0.1), StepDoubling(), smallest=1e-3), loop=loop) as run:
        run.record(["f.y", "rejected"])
        recording = run.run(2.0)
    assert recording["f.y"] == pytest.approx(recording.time, abs=1e-12)
    assert recording["rejected"][10] == 0
    assert recording["rejected"][-1] > 0
    with Execution(whole, Adaptive(Jacobi(0.1), StepDoubling(), smallest=0.05), loop=loop) as run:
        with pytest.raises(CosimError, match=r"f: failed with status 'discard' when stepping in the step from t = 1 "):
            run.run(2.0)
        assert run.time == 1.0


def test_a_step_whose_iteration_does_not_converge_is_repeated_with_a_smaller_one():
    # Plain iteration over a step h converges where h^2 32/1.5 / 4 is below 1, roughly: not at 0.6 s.
    inner = Iterative(Jacobi(0.6, extrapolation="linear"), most=8)
    with pytest.raises(CosimError, match="does not converge"), Execution(system(functions()), inner) as run:
        run.run(6.0)
    with Execution(system(functions()), Adaptive(inner, StepDoubling(0.5), smallest=1e-3)) as run:
        run.record(["rejected"])
        assert run.run(6.0)["rejected"][-1] > 0


def test_all_that_composes_gives_compiled_models_the_motion_of_functions():
    algorithm = Adaptive(Iterative(GaussSeidel(0.1, extrapolation="linear"), Newton()), StepDoubling(1e-4))
    assert error(algorithm, models)[0] < 1e-3
    assert error(algorithm, functions)[0] < 1e-3


def test_power_residual_needs_a_bond():
    alone = System("alone", {"f": FunctionSlave(lambda t, h, u: [t], outputs=[Variable("y")])})
    with pytest.raises(CosimError, match=r"control: PowerResidual needs a power bond in the system.*StepDoubling"):
        Execution(alone, Adaptive(GaussSeidel(0.1), PowerResidual()))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: Adaptive(Adaptive(GaussSeidel(0.1))), "base: is no algorithm that goes inside"),
        (lambda: Iterative(Iterative(GaussSeidel(0.1))), "allowed: Jacobi, GaussSeidel. From the inside out"),
        (lambda: Adaptive(0.1), r"base: is no algorithm that goes inside \(got 0\.1\)"),
        (lambda: Adaptive(GaussSeidel(0.1), smallest=0.2), r"smallest: is above the greatest step \(got 0\.2\)"),
        (lambda: Adaptive(GaussSeidel(0.1), smallest=0.0), "smallest: is not a duration"),
        (lambda: Adaptive(GaussSeidel(0.1), safety=1.5), "safety: is no share"),
        (lambda: PowerResidual(0.0), "tolerance: must be positive"),
        (lambda: PowerResidual(1e-3, power=-1.0), "power: must be positive"),
        (lambda: StepDoubling(math.nan), "tolerance: must be positive"),
    ],
)
def test_settings_without_meaning_are_refused(make, said):
    with pytest.raises(CosimError, match=said):
        make()


@LOOPS
@pytest.mark.parametrize("slaves", [functions, models])
@pytest.mark.parametrize(
    "algorithm",
    [
        Jacobi(0.02, conserve=True),
        Adaptive(Jacobi(0.02, extrapolation="linear", conserve=True), PowerResidual(1e-4)),
        Adaptive(Iterative(GaussSeidel(0.02, extrapolation="quadratic"), Newton()), PowerResidual(1e-5)),
    ],
    ids=["conserve", "power", "newton"],
)
def test_what_an_algorithm_remembers_belongs_to_the_state(algorithm, slaves, loop):
    with Execution(system(slaves()), algorithm, loop=loop) as run:
        whole = run.run(1.0)
    with Execution(system(slaves()), algorithm, loop=loop) as run:
        run.advance(0.34)
        state = run.save()
    with Execution(system(slaves()), algorithm, loop="python" if loop == "c" else "c") as run:
        run.start()
        run.restore(state)
        rest = run.run(1.0)
    for name in whole:
        assert np.array_equal(rest[name], whole[name][-len(rest) :]), name
