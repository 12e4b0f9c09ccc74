"""Slaves that step more or less often than the macro step, and the order in which slaves step."""

import numpy as np
import pytest
from oscillators import exact, functions, system

from seacrane.cosim import (
    Adaptive,
    Execution,
    FunctionSlave,
    GaussSeidel,
    Interface,
    Iterative,
    Jacobi,
    Newton,
    PowerResidual,
    Slave,
    System,
)
from seacrane.errors import CosimError
from seacrane.model.dae import Variable

LOOPS = pytest.mark.parametrize("loop", ["c", "python"])


def clocks() -> tuple[System, list]:
    calls: list[tuple[str, float, float]] = []

    def clock(name):
        def step(t, h, u):
            if h > 0:
                calls.append((name, round(t, 9), round(h, 9)))
            return [t + h]

        return FunctionSlave(step, outputs=[Variable("t", "s")])

    return System("clocks", {name: clock(name) for name in ("fast", "plain", "slow")}), calls


@LOOPS
@pytest.mark.parametrize("algorithm", [Jacobi, GaussSeidel])
def test_each_slave_steps_at_its_own_rate_without_gaps(algorithm, loop):
    whole, calls = clocks()
    with Execution(whole, algorithm(0.1, rates={"fast": 3, "slow": 1 / 4}), loop=loop, start=5.0) as run:
        recording = run.run(6.0)
    for name, size, count in (("fast", 0.1 / 3, 30), ("plain", 0.1, 10), ("slow", 0.4, 2)):
        own = [(t, h) for n, t, h in calls if n == name]
        assert len(own) == count
        assert np.allclose([h for _, h in own], size, atol=2e-9)
        assert np.allclose([t for t, _ in own], 5.0 + size * np.arange(count), atol=2e-9)
    # A slower slave is where the others are at the end of each of its steps, and shows its last outputs between.
    assert recording["slow.t"] == pytest.approx([5.0] * 4 + [5.4] * 4 + [5.8] * 3, abs=1e-9)
    assert recording["fast.t"] == pytest.approx(recording.time, abs=1e-9)


def error(algorithm) -> float:
    with Execution(system(functions()), algorithm) as run:
        run.record(["one.position"], every=0.16)  # where slower slaves are as far as the others
        recording = run.run(4.0)
    return float(np.sqrt(np.mean((recording["one.position"] - exact(recording.time)) ** 2)))


@pytest.mark.parametrize("base", [Jacobi, GaussSeidel])
@pytest.mark.parametrize("rates", [{"one": 4}, {"two": 2}, {"one": 1 / 2}, {"two": 1 / 4}])
def test_linear_extrapolation_keeps_its_order_at_all_rates(base, rates):
    errors = [error(base(step, rates=rates, extrapolation="linear")) for step in (0.008, 0.004, 0.002)]
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2.0, abs=0.2)


def test_a_slower_slave_moves_between_full_and_full_times_its_step():
    whole, twice, both = error(Jacobi(0.004)), error(Jacobi(0.004, rates={"two": 1 / 2})), error(Jacobi(0.008))
    assert 0.9 * whole < twice < 1.2 * both


def test_the_account_of_a_slower_slave_closes_at_its_steps():
    with Execution(system(functions()), Jacobi(0.002, rates={"two": 1 / 5})) as run:
        run.step(5 * 200)
        assert run.bonds["spring"].relative_error < 0.05


@pytest.mark.parametrize(
    ("rates", "said"),
    [
        ({"tow": 2}, "rates.tow: no such slave in the system. Did you mean 'two'?"),
        ({"two": 1.5}, "rates.two: is no rate (got 1.5); allowed: a whole number, or 1 over one"),
        ({"two": 0}, "rates.two: is no rate (got 0); allowed: a whole number, or 1 over one"),
        ({"two": float("nan")}, "rates.two: is no rate (got nan); allowed: a whole number, or 1 over one"),
    ],
)
def test_rates_that_make_no_sense_are_refused(rates, said):
    with pytest.raises(CosimError) as caught:
        Execution(system(functions()), Jacobi(0.1, rates=rates))
    assert [str(p) for p in caught.value.problems] == [said]


def test_a_slower_slave_does_not_go_with_a_step_that_varies():
    algorithm = Adaptive(Jacobi(0.1, rates={"two": 1 / 2}), PowerResidual())
    with pytest.raises(CosimError, match=r"rates\.two: steps less often than the macro step, which is not fixed here"):
        Execution(system(functions()), algorithm)


def test_iteration_goes_with_all_rates():
    rates = {"one": 3, "two": 1 / 2}
    with Execution(system(functions()), Iterative(Jacobi(0.02, rates=rates, extrapolation="linear"), Newton())) as run:
        recording = run.run(2.0)
    assert np.abs(recording["one.position"] - exact(recording.time)).max() < 0.02


# ---------------------------------------------------------------- order
class Known(Slave):
    """A slave that says which outputs depend on which inputs."""

    def __init__(self, inputs, outputs, feedthrough=None):
        self._interface = Interface(tuple(Variable(n) for n in inputs), tuple(Variable(n) for n in outputs))
        self._feedthrough = feedthrough

    @property
    def interface(self):
        return self._interface

    @property
    def feedthrough(self):
        return self._feedthrough

    def instantiate(self, name):
        raise NotImplementedError


def order(whole: System) -> tuple[str, ...]:
    return GaussSeidel(0.1, "derived").schedule(tuple(whole.slaves), whole).order


def test_the_derived_order_of_a_chain_is_that_of_its_signals():
    names = ["d", "b", "a", "c"]
    whole = System("chain", {n: Known(["u"], ["y"]) for n in names})
    for source, target in ("ab", "bc", "cd"):
        whole.connect(f"{source}.y", f"{target}.u")
    assert order(whole) == ("a", "b", "c", "d")


def test_the_derived_order_delays_the_input_that_no_output_depends_on_directly():
    whole = System("pair")
    whole.add("state", Known(["u"], ["y"], {"y": []}))
    whole.add("direct", Known(["u"], ["y"], {"y": ["u"]}))
    whole.connect("state.y", "direct.u")
    whole.connect("direct.y", "state.u")
    assert order(whole) == ("state", "direct")
    turned = System("pair", {"direct": whole.slaves["direct"], "state": whole.slaves["state"]}, whole.connections)
    assert order(turned) == ("state", "direct")


def test_the_derived_order_delays_as_few_connections_as_can_be():
    # Three signals from b to a, one from a to b; nothing is known of either.
    whole = System("pair")
    whole.add("a", Known(["u1", "u2", "u3"], ["y"]))
    whole.add("b", Known(["u"], ["y"]))
    whole.connect("a.y", "b.u")
    whole.connect("b.y", "a.u1", "a.u2", "a.u3")
    assert order(whole) == ("b", "a")


def test_a_large_loop_is_ordered_with_one_delay():
    names = [f"s{i}" for i in np.random.default_rng(3).permutation(40)]
    whole = System("ring", {n: Known(["u"], ["y"]) for n in names})
    for i in range(40):
        whole.connect(f"s{i}.y", f"s{(i + 1) % 40}.u")
    found = order(whole)
    place = {n: i for i, n in enumerate(found)}
    delayed = [i for i in range(40) if place[f"s{i}"] > place[f"s{(i + 1) % 40}"]]
    assert len(delayed) <= 3


def test_models_and_functions_know_what_they_depend_on():
    from oscillators import models

    one, two = models()
    assert two.feedthrough == {"force": set()}
    assert one.feedthrough == {"velocity": set(), "position": set()}
    assert functions()[0].feedthrough is None
