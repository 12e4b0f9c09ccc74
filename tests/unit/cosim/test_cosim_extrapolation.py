"""Inputs between communication points: extrapolated, interpolated, started anew after a jump, and kept in balance."""

import math

import casadi as ca
import numpy as np
import pytest
from oscillators import functions, models, system

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, Jacobi, ModelSlave, Override, System
from seacrane.errors import CosimError
from seacrane.model.dae import Dae, Variable

LOOPS = pytest.mark.parametrize("loop", ["c", "python"])
STEP = 0.25


def seen_of(signal, algorithm, loop="auto", steps=8):
    """What a slave that holds its input sees in each step of a signal of time."""
    chain = System("chain")
    chain.add("source", FunctionSlave(lambda t, h, u: [signal(t + h)], outputs=[Variable("y")]))
    chain.add("sink", FunctionSlave(lambda t, h, u: u, inputs=[Variable("u")], outputs=[Variable("seen")]))
    chain.connect("source.y", "sink.u")
    with Execution(chain, algorithm, loop=loop) as run:
        run.record(["sink.u"])
        return run.run(steps * STEP)["sink.u"][1:]


def mean(integral):
    """The mean over each step of the function with this integral."""
    points = np.array([integral(STEP * i) for i in range(9)])
    return np.diff(points) / STEP


@LOOPS
def test_linear_extrapolation_gives_the_mean_of_a_straight_line_after_two_points(loop):
    seen = seen_of(lambda t: 1 + 3 * t, Jacobi(STEP, extrapolation="linear"), loop)
    assert seen[0] == 1.0  # no history yet: held
    assert seen[1:] == pytest.approx(mean(lambda t: t + 1.5 * t**2)[1:], rel=1e-12)


@LOOPS
def test_quadratic_extrapolation_gives_the_mean_of_a_parabola_after_three_points(loop):
    seen = seen_of(lambda t: 2 - t + 3 * t**2, Jacobi(STEP, extrapolation="quadratic"), loop)
    assert seen[2:] == pytest.approx(mean(lambda t: 2 * t - t**2 / 2 + t**3)[2:], rel=1e-12)


@LOOPS
def test_what_has_stepped_before_is_interpolated(loop):
    seen = seen_of(lambda t: 1 + 3 * t, GaussSeidel(STEP, extrapolation="linear"), loop)
    assert seen == pytest.approx(mean(lambda t: t + 1.5 * t**2), rel=1e-12)  # the very first step as well
    seen = seen_of(lambda t: 1 + t**2, GaussSeidel(STEP, extrapolation="quadratic"), loop)
    assert seen[1:] == pytest.approx(mean(lambda t: t + t**3 / 3)[1:], rel=1e-12)


def integrator() -> ModelSlave:
    """x' = u, y = x + u: takes the derivative of its input, and shows it at the end of the step."""
    x, u, none = ca.SX.sym("x"), ca.SX.sym("u"), ca.SX(0, 1)
    return ModelSlave(
        Dae(
            "integrator", (Variable("state"),), (), (Variable("u"),), (), (Variable("x"), Variable("end")), (),
            ca.SX.sym("t"), x, none, u, none, +u, none, ca.vertcat(x, u), none,
        )
    )  # fmt: skip


@LOOPS
@pytest.mark.parametrize(
    ("extrapolation", "signal", "integral", "first"),
    [
        ("linear", lambda t: 1 + 3 * t, lambda t: t + 1.5 * t**2, 1),
        ("quadratic", lambda t: 2 - t + 3 * t**2, lambda t: 2 * t - t**2 / 2 + t**3, 2),
    ],
)
def test_slaves_that_take_derivatives_get_a_line_with_the_mean_of_the_polynomial(
    extrapolation, signal, integral, first, loop
):
    chain = System("chain")
    chain.add("source", FunctionSlave(lambda t, h, u: [signal(t + h)], outputs=[Variable("y")]))
    chain.add("sink", integrator())
    chain.connect("source.y", "sink.u")
    with Execution(chain, Jacobi(STEP, extrapolation=extrapolation), loop=loop) as run:
        recording = run.run(2.0)
    gained = np.diff(recording["sink.x"]) / STEP
    assert gained[first:] == pytest.approx(mean(integral)[first:], rel=1e-9)
    if extrapolation == "linear":  # and it moves within the step: at its end it is where the line leads
        assert recording["sink.end"][2:] == pytest.approx([signal(t) for t in recording.time[2:]], rel=1e-12)


@LOOPS
def test_nothing_is_extrapolated_across_what_was_set(loop):
    # A step of the input from 0 to 1 at t = 1 s: a line through both would give 1.5.
    chain = System("chain")
    chain.add("source", FunctionSlave(lambda t, h, u: u, [Variable("u")], [Variable("y")]))
    chain.add("sink", FunctionSlave(lambda t, h, u: u, [Variable("u")], [Variable("y")]))
    chain.connect("source.y", "sink.u")
    with Execution(chain, Jacobi(STEP, extrapolation="linear"), loop=loop) as run:
        run.record(["sink.u"])
        run.advance(1.0)
        run.set("source.u", 1.0)
        seen = run.run(2.0)["sink.u"]
    assert set(seen.tolist()) == {0.0, 1.0}


def test_setting_the_same_value_again_changes_nothing():
    def moved(again):
        whole = system(functions())
        whole.add("extra", FunctionSlave(lambda t, h, u: u, [Variable("u")], [Variable("y")]))
        with Execution(whole, Jacobi(0.01, extrapolation="linear")) as run:
            for _ in range(50):
                run.step()
                if again:
                    run.set("extra.u", 0.0)
            return run.values(["one.position"])[0]

    assert moved(True) == moved(False)


@LOOPS
def test_what_is_conserved_reaches_the_other_side_in_full(loop):
    """All that a prescribed flow has moved, the other side has received but for the last step's share."""
    given = System("given")
    given.add(
        "pump",
        FunctionSlave(lambda t, h, u: [math.sin(3 * (t + h)) ** 2], [Variable("p", "Pa")], [Variable("q", "m3/s")]),
    )
    given.add(
        "tank",
        FunctionSlave(
            lambda t, h, x, u: (x + h * u, [x[0] + h * u[0], 1.0]),
            [Variable("q", "m3/s")],
            [Variable("volume", "m3"), Variable("p", "Pa")],
            [0.0],
        ),
    )
    given.bond("pipe", effort=("tank.p", "pump.p"), flow=("pump.q", "tank.q"))
    received = {}
    for conserve in (False, True):
        with Execution(given, Jacobi(0.1, conserve=conserve), loop=loop) as run:
            recording = run.run(10.0)
        q = recording["pump.q"]
        moved = np.concatenate([[0.0], np.cumsum(0.5 * (q[1:] + q[:-1]) * 0.1)])
        received[conserve] = np.abs(recording["tank.volume"] - moved)
    assert received[True][1:] == pytest.approx(0.5 * 0.1 * np.abs(np.diff(q)), abs=1e-12)  # the last step's alone
    assert received[True].max() <= received[False].max()


def test_unknown_extrapolations_and_missing_bonds_are_refused():
    with pytest.raises(CosimError, match=r"extrapolation: is unknown \(got 'liner'\).*Did you mean 'linear'"):
        Jacobi(0.1, extrapolation="liner")
    alone = System("alone", {"f": FunctionSlave(lambda t, h, u: [t], outputs=[Variable("y")])})
    with pytest.raises(CosimError, match="conserve: needs a power bond in the system"):
        Execution(alone, GaussSeidel(0.1, conserve=True))


@pytest.mark.parametrize("slaves", [functions, models])
def test_manipulated_inputs_stay_what_they_were_made(slaves):
    with Execution(system(slaves()), GaussSeidel(0.01, extrapolation="linear")) as run:
        run.step(5)
        run.apply(Override("one.force", 2.0))
        run.step(200)
        free = run.values(["one.position", "one.velocity", "one.force"])
        # Mass 1 alone under a constant force of 2 N from where it was: its energy about the new rest only falls.
        assert free[2] == 2.0
        energy = []
        for _ in range(10):
            run.step(20)
            x, v = run.values(["one.position", "one.velocity"])
            energy.append(0.5 * 2.0 * v**2 + 0.5 * 30.0 * (x - 2.0 / 30.0) ** 2)
    assert np.all(np.diff(energy) < 0)
