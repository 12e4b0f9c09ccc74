"""What a slave in C may answer, from a slave in C that answers what it is told."""

import ctypes
import math
import re
import time

import pytest

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, Instance, Interface, NativeCalls, Slave, System
from seacrane.errors import CosimError
from seacrane.model.dae import Variable
from seacrane.native import build_library

SOURCE = """
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>
struct slave { double u, y, when, value; int set, step, get; double work; };
int slave_set(struct slave *s, const uint32_t *r, size_t n, const double *v) {
    for (size_t i = 0; i < n; ++i) s->u = v[i] + 0.0 * r[i];
    return s->y >= s->when ? s->set : 0;
}
int slave_step(struct slave *s, double t, double h, int discard) {
    (void)discard;
    s->y = t + h;
    if (s->y > s->when && s->work > 0)
        for (const clock_t end = clock() + (clock_t)(s->work * CLOCKS_PER_SEC); clock() < end;) {}
    return s->y > s->when ? s->step : 0;
}
int slave_get(struct slave *s, const uint32_t *r, size_t n, double *v) {
    for (size_t i = 0; i < n; ++i) v[i] = r[i] && s->y > s->when ? s->value : s->y;
    return s->y > s->when ? s->get : 0;
}
"""


class Memory(ctypes.Structure):
    _fields_ = (
        *((name, ctypes.c_double) for name in ("u", "y", "when", "value")),
        *((name, ctypes.c_int) for name in ("set", "step", "get")),
        ("work", ctypes.c_double),
    )


class Obedient(Slave):
    """Beyond t = `when` its functions return these statuses, and its second output is `value`."""

    def __init__(self, when=0.45, value=1.0, **statuses):
        self.given = {"when": when, "value": value, **statuses}
        self.told = []

    @property
    def interface(self):
        return Interface((Variable("u"),), (Variable("y"), Variable("z")))

    def instantiate(self, name):
        return ObedientInstance(self)


class ObedientInstance(Instance):
    def __init__(self, slave):
        library = ctypes.CDLL(str(build_library("obedient", {"obedient.c": SOURCE}, ["-fvisibility=default"])))
        address = {
            n: ctypes.cast(getattr(library, f"slave_{n}"), ctypes.c_void_p).value for n in ("set", "step", "get")
        }
        self.memory = Memory(**slave.given)
        self.slave = slave
        self.calls = NativeCalls(ctypes.addressof(self.memory), references={"u": 0, "y": 0, "z": 1}, **address)

    def bind(self, inputs, outputs):
        self.outputs = outputs

    def evaluate(self):
        self.outputs[:] = self.memory.y

    def initialise(self, time):
        self.memory.y = time

    def failed(self, status):
        self.slave.told.append(status)

    def advance(self, time, step):
        raise AssertionError("the loops call the C functions")

    def set(self, values):
        pass

    def begin(self):
        pass

    def save(self):
        return bytes(self.memory)

    def restore(self, state):
        ctypes.memmove(ctypes.addressof(self.memory), state, ctypes.sizeof(self.memory))

    def close(self):
        pass


def run_of(slave, loop):
    system = System("s", {"clock": FunctionSlave(lambda t, h, u: [t], outputs=[Variable("t")]), "c": slave})
    system.connect("clock.t", "c.u")
    return Execution(system, GaussSeidel(0.125), loop=loop)


LOOPS = pytest.mark.parametrize("loop", ["c", "python"])


@LOOPS
@pytest.mark.parametrize(("status", "word"), [(2, "discard"), (3, "error"), (4, "fatal"), (5, "pending"), (-1, "-1")])
@pytest.mark.parametrize(
    ("stage", "doing"), [("set", "taking its inputs"), ("step", "stepping"), ("get", "giving its outputs")]
)
def test_every_status_worse_than_a_warning_stops_in_its_macro_step(loop, status, word, stage, doing):
    slave = Obedient(**{stage: status})
    run = run_of(slave, loop)
    recorder = run.record(["c.y"])
    # The inputs of the step from 0.5 are the first that are taken beyond 0.45.
    begin, end = (0.5, 0.625) if stage == "set" else (0.375, 0.5)
    with pytest.raises(CosimError) as caught:
        run.advance(2.0)
    message = f"c: failed with status '{word}' when {doing} in the step from t = {begin:g} to {end:g} s"
    assert str(caught.value) == message
    assert slave.told == [status]
    assert recorder.recording().time[-1] == run.time == begin


@LOOPS
@pytest.mark.parametrize("stage", ["set", "step", "get"])
def test_a_warning_is_no_failure(loop, stage):
    run = run_of(Obedient(**{stage: 1}), loop)
    run.advance(2.0)
    assert run.values(["c.y"])[0] == 2.0


@LOOPS
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_an_output_that_is_not_finite_stops_in_its_macro_step(loop, value):
    run = run_of(Obedient(value=value), loop)
    recorder = run.record()
    with pytest.raises(CosimError) as caught:
        run.advance(2.0)
    assert str(caught.value) == f"c.z: is not finite in the step from t = 0.375 to 0.5 s (got {value!r})"
    assert recorder.recording()["c.z"].tolist() == [0.0, 0.125, 0.25, 0.375]


# ---------------------------------------------------------------- slaves that take too long
def napping(t, h, u):
    if t >= 0.375:
        time.sleep(1.0)
    return [t]


@LOOPS
@pytest.mark.parametrize("slave", [Obedient(work=1.0), FunctionSlave(napping, [Variable("u")], [Variable("y")])])
def test_a_slave_that_takes_too_long_is_named_while_it_does_and_ends_the_run(loop, slave, caplog):
    system = System("s", {"clock": FunctionSlave(lambda t, h, u: [t], outputs=[Variable("t")]), "c": slave})
    system.connect("clock.t", "c.u")
    with Execution(system, GaussSeidel(0.125), loop=loop, time_limit=0.1) as run:
        recorder = run.record(["c.y"])
        began = time.time()
        with pytest.raises(CosimError) as caught:
            run.advance(2.0)
        returned = time.time()
        with pytest.raises(CosimError, match=r"the run ended at t = 0\.5 s \(c: took too long"):
            run.step()
    message = str(caught.value)
    took = re.match(r"c: took too long in the step from t = 0\.375 to 0\.5 s \(got ([\d.]+)\);", message)
    assert took, message
    assert 0.5 < float(took[1]) <= returned - began
    assert message.endswith("allowed: at most 0.1 s of wall time")
    assert re.match(r"c: has been at work for 0\.\d+ s in a macro step after t = 0\.375 s", caplog.messages[0])
    assert returned - caplog.records[0].created > 0.2
    assert recorder.recording().time.tolist() == [0.0, 0.125, 0.25, 0.375, 0.5]


def test_a_run_may_go_on_after_a_late_step_if_that_is_wanted(caplog):
    slow = FunctionSlave(napping, [Variable("u")], [Variable("y")])
    with Execution(System("s", {"c": slow}), GaussSeidel(0.125), time_limit=0.1, when_late="warn") as run:
        began = time.time()
        run.advance(0.5)
        assert (run.time, run.late[0].slave) == (0.5, "c")
        assert 0.5 < run.late[0].seconds <= time.time() - began
    assert "the limit is 0.1 s" in caplog.text


def test_a_slave_within_its_time_is_left_alone(caplog):
    with Execution(System("s", {"c": Obedient()}), GaussSeidel(0.001), time_limit=0.05) as run:
        run.advance(5.0)
        assert run.late == ()
    assert not caplog.records


def test_a_time_limit_that_is_none_is_refused():
    with pytest.raises(CosimError, match=r"time_limit: must be positive \(got 0\.0\)"):
        Execution(System("s", {"c": Obedient()}), GaussSeidel(0.1), time_limit=0.0)
