"""Threads change the time a run takes, and not one bit of its results."""

import numpy as np
import pytest
from oscillators import dae

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, Iterative, Jacobi, ModelSlave, Newton, System
from seacrane.errors import CosimError
from seacrane.model.dae import Variable

FINE = 2e-6
"""Step of the models' own solver [s]: some 500 in a macro step of 1 ms, which makes them worth a thread."""


def ring(size: int, python: bool = True) -> System:
    """Masses in a ring of springs, each a compiled model, and a Python slave that listens to all of them."""
    whole = System("ring")
    matrices = np.array([[0.0, 1.0], [-400.0, -2.0]]), np.array([[0.0], [1.0]]), np.array([[1.0, 0.0]])
    mass = dae("mass", matrices, [0.0, 0.0], [Variable("u")], [Variable("y")])
    for i in range(size):
        whole.add(f"m{i}", ModelSlave(mass, {"solver.fixed_step": FINE, "x0": 0.1 * (i + 1)}))
    for i in range(size):
        whole.connect(f"m{i}.y", f"m{(i + 1) % size}.u", gain=30.0)
    if python:
        ears = [Variable(f"u{i}") for i in range(size)]
        whole.add("sum", FunctionSlave(lambda t, h, u: [u.sum()], ears, [Variable("y")]))
        for i in range(size):
            whole.connect(f"m{i}.y", f"sum.u{i}")
    return whole


def integrator():
    return dae(
        "integrator", (np.zeros((1, 1)), np.ones((1, 1)), np.ones((1, 1))), [0.0], [Variable("u")], [Variable("y")]
    )


@pytest.mark.parametrize(
    "algorithm",
    [
        Jacobi(1e-3),
        Jacobi(1e-3, extrapolation="quadratic"),
        GaussSeidel(1e-3, extrapolation="linear"),
        Iterative(Jacobi(1e-3), Newton()),
    ],
    ids=["jacobi", "quadratic", "gauss-seidel", "newton"],
)
def test_results_are_the_same_bits_with_any_number_of_threads(algorithm):
    tables = []
    for threads in (1, 2, 3, 8):
        with Execution(ring(4), algorithm, threads=threads) as run:
            recording = run.run(0.06)
            tables.append(np.column_stack([recording[name] for name in recording]))
    for table in tables[1:]:
        assert np.array_equal(table, tables[0])


def test_gauss_seidel_puts_side_by_side_what_is_not_connected():
    # Two pairs that know nothing of each other: one after the other within a pair, side by side across.
    whole = System("pairs", {n: FunctionSlave(lambda t, h, u: u, [Variable("u")], [Variable("y")]) for n in "abcd"})
    for source, target in ("ab", "cd"):
        whole.connect(f"{source}.y", f"{target}.u")
    schedule = GaussSeidel(0.1).schedule(tuple(whole.slaves), whole)
    assert schedule.order == ("a", "b", "c", "d")
    assert schedule.groups == (("a", "c"), ("b", "d"))
    assert GaussSeidel(0.1, order=["b", "a", "c", "d"]).schedule(tuple(whole.slaves), whole).groups == (
        ("b", "c"),
        ("a", "d"),
    )


def test_a_run_with_threads_can_be_closed_and_repeated():
    for _ in range(20):
        with Execution(ring(3, python=False), Jacobi(1e-3), threads=4) as run:
            run.step(15)


def test_of_several_slaves_that_fail_together_the_first_is_named_with_any_number_of_threads():
    said = set()
    for threads in (1, 4):
        whole = ring(4, python=False)
        whole.add("clock", FunctionSlave(lambda t, h, u: [1e308 if t > 0.03 else 0.0], [], [Variable("y")]))
        for i in (0, 1, 2):
            whole.add(f"e{i}", ModelSlave(integrator(), {"solver.fixed_step": FINE}))
            whole.connect("clock.y", f"e{i}.u", gain=10.0)
        with Execution(whole, Jacobi(1e-3), threads=threads) as run, pytest.raises(CosimError) as caught:
            run.step(50)
        said.add(str(caught.value))
    assert len(said) == 1
    assert "e0: failed" in said.pop()


def test_a_number_of_threads_is_one_or_more():
    with pytest.raises(CosimError, match="threads: is no number of threads"):
        Execution(ring(2), Jacobi(1e-3), threads=0)
