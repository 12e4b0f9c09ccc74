"""Threads change the time a run takes, and not one bit of its results."""

import ctypes

import numpy as np
import pytest
from oscillators import dae

from seacrane.cosim import (
    Execution,
    FunctionSlave,
    GaussSeidel,
    Instance,
    Interface,
    Iterative,
    Jacobi,
    ModelSlave,
    NativeCalls,
    Newton,
    Slave,
    System,
)
from seacrane.errors import CosimError
from seacrane.model.dae import Variable
from seacrane.native import build_library

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


# ---------------------------------------------------------------- whether threads pay
SLEEPER = """
#include <pthread.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>
struct slave { pthread_t home; double y; int64_t sleep_us, more_us, elsewhere; };
void slave_begin(struct slave *s) { s->home = pthread_self(); }
int slave_set(struct slave *s, const uint32_t *r, size_t n, const double *v) { return s && r && v ? 0 : (int)n; }
int slave_step(struct slave *s, double t, double h, int discard) {
    const int elsewhere = !pthread_equal(pthread_self(), s->home);
    const int64_t us = s->sleep_us + elsewhere * s->more_us;
    const struct timespec pause = {us / 1000000, us % 1000000 * 1000};
    nanosleep(&pause, NULL);
    s->elsewhere += elsewhere;
    s->y = t + h + 0 * discard;
    return 0;
}
int slave_get(struct slave *s, const uint32_t *r, size_t n, double *v) {
    for (size_t i = 0; i < n; ++i) v[i] = s->y + 0 * r[i];
    return 0;
}
"""


class Bed(ctypes.Structure):
    _fields_ = (
        ("home", ctypes.c_ulong),
        ("y", ctypes.c_double),
        *((name, ctypes.c_int64) for name in ("sleep_us", "more_us", "elsewhere")),
    )


class Sleeper(Slave):
    """Sleeps in its step, so that two may do so at once on any machine, and for longer off the thread of the run."""

    def __init__(self):
        self.bed = Bed(sleep_us=200)

    @property
    def interface(self):
        return Interface((), (Variable("y"),))

    def instantiate(self, name):
        return SleeperInstance(self.bed)


class SleeperInstance(Instance):
    def __init__(self, bed):
        flags = ["-fvisibility=default", "-pthread"]
        self.library = ctypes.CDLL(str(build_library("sleeper", {"sleeper.c": SLEEPER}, flags)))
        self.bed, self.handle = bed, ctypes.addressof(bed)
        address = {
            n: ctypes.cast(getattr(self.library, f"slave_{n}"), ctypes.c_void_p).value for n in ("set", "step", "get")
        }
        self.calls = NativeCalls(self.handle, references={"y": 0}, **address)

    def bind(self, inputs, outputs):
        self.outputs = outputs

    def evaluate(self):
        self.outputs[:] = self.bed.y

    def initialise(self, time):
        self.library.slave_begin(ctypes.c_void_p(self.handle))

    def advance(self, time, step):
        raise AssertionError("the loop calls the C functions")

    def set(self, values):
        pass

    def begin(self):
        pass

    def save(self):
        return bytes(self.bed)

    def restore(self, state):
        ctypes.memmove(self.handle, state, ctypes.sizeof(self.bed))

    def close(self):
        pass


def test_a_decision_for_or_against_threads_is_revised_when_it_turns_out_wrong():
    sleepers = [Sleeper(), Sleeper()]
    beds = [sleeper.bed for sleeper in sleepers]

    def share(run, steps=100):
        """Of so many sweeps, those in which another thread has taken a slave."""
        for bed in beds:
            bed.elsewhere = 0
        run.step(steps)
        return sum(bed.elsewhere for bed in beds) / steps

    def disturb(us):
        for bed in beds:
            bed.more_us = us

    with Execution(System("beds", dict(zip("ab", sleepers, strict=True))), Jacobi(1e-3), threads=2) as run:
        disturb(50_000)  # as if another process held the second processor while threads are tried
        assert share(run, 300) < 0.1
        disturb(0)
        assert any(share(run) > 0.5 for _ in range(40))
        disturb(50_000)  # and now that they are taken
        assert any(share(run) < 0.1 for _ in range(40))
        disturb(0)
        assert any(share(run) > 0.5 for _ in range(40))
