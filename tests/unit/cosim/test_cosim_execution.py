import gc
import itertools
import math
import weakref

import casadi as ca
import numpy as np
import pytest
from oscillators import dae, functions, models, system

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, Jacobi, ModelSlave, RealTime, System
from seacrane.errors import CosimError, ParameterError
from seacrane.model.dae import Dae, Variable

LOOPS = pytest.mark.parametrize("loop", ["c", "python"])


def alone(function, inputs=(), outputs=("y",), **more) -> System:
    slave = FunctionSlave(
        function, [Variable(n, minimum=-1, maximum=1) for n in inputs], [Variable(n) for n in outputs], **more
    )
    return System("alone", {"f": slave})


def escape() -> Dae:
    """x' = x^2 from x = 1: escapes to infinity at t = 1 s."""
    x, none = ca.SX.sym("x"), ca.SX(0, 1)
    gain = ca.SX.sym("k")
    return Dae(
        "escape", (Variable("x", start=1.0),), (), (), (Variable("k", start=1.0, minimum=0.5, maximum=2.0),),
        (Variable("y"),), (Variable("twice"),), ca.SX.sym("t"), x, none, none, gain, gain * x**2, none, +x, 2 * x,
    )  # fmt: skip


# ---------------------------------------------------------------- start
def test_outputs_are_consistent_at_the_start_whatever_the_order_of_a_chain():
    system = System("chain")
    names = [f"s{i}" for i in range(8)]
    for name in reversed(names):
        system.add(name, FunctionSlave(lambda t, h, u: u + 1, [Variable("u")], [Variable("y")]))
    for before, after in itertools.pairwise(names):
        system.connect(f"{before}.y", f"{after}.u")
    with Execution(system, Jacobi(0.1)) as run:
        run.start()
        assert run.values([f"{name}.y" for name in names]).tolist() == [1, 2, 3, 4, 5, 6, 7, 8]


def feedthrough(gain: float) -> System:
    system = System("loop")
    system.add("a", FunctionSlave(lambda t, h, u: 1 + gain * u, [Variable("u")], [Variable("y")]))
    system.add("b", FunctionSlave(lambda t, h, u: gain * u, [Variable("u")], [Variable("y")]))
    system.connect("a.y", "b.u")
    system.connect("b.y", "a.u")
    return system


def test_a_contracting_loop_of_feedthrough_settles_at_its_solution():
    with Execution(feedthrough(0.5), GaussSeidel(0.1)) as run:
        run.start()
        assert run.values(["a.y", "b.y"]) == pytest.approx([4 / 3, 2 / 3], rel=1e-8)


@pytest.mark.parametrize("gain", [2.0, -3.0, 1e4])
def test_a_loop_that_amplifies_is_solved_at_the_start_too(gain):
    with Execution(feedthrough(gain), GaussSeidel(0.1)) as run:
        run.start()
        assert run.values(["a.y", "b.y"]) == pytest.approx([1 / (1 - gain**2), gain / (1 - gain**2)], rel=1e-8)


def test_a_nonlinear_loop_is_solved_from_its_start_values():
    system = System("loop")  # y = u^2 - 2 and u = y: 2 and -1, both of them repelling
    system.add("a", FunctionSlave(lambda t, h, u: u * u - 2, [Variable("u")], [Variable("y", start=3.0)]))
    system.add("b", FunctionSlave(lambda t, h, u: u, [Variable("u")], [Variable("y", start=3.0)]))
    system.connect("a.y", "b.u")
    system.connect("b.y", "a.u")
    with Execution(system, GaussSeidel(0.1)) as run:
        run.start()
        assert run.values(["a.y", "b.y"]) == pytest.approx([2.0, 2.0], rel=1e-8)


def test_a_loop_that_does_not_settle_is_told_with_its_variables():
    run = Execution(feedthrough(1.0), GaussSeidel(0.1))
    with pytest.raises(CosimError) as caught:
        run.start()
    assert [problem.path for problem in caught.value.problems] == ["a.y", "b.y"]
    assert "loop of direct feedthrough" in caught.value.problems[0].message
    with pytest.raises(CosimError, match="the run ended at t = 0 s"):
        run.step()


def test_a_run_may_start_at_any_time():
    with Execution(alone(lambda t, h, u: [t + h]), GaussSeidel(0.25), start=100.0) as run:
        run.start()
        assert run.values(["f.y"])[0] == 100.0
        run.advance(100.6)
        assert (run.time, run.values(["f.y"])[0]) == (100.75, 100.75)
        run.advance(100.6)
        assert run.time == 100.75


@pytest.mark.parametrize("until", [100.25, 0.0, -1.0, math.nan, math.inf])
def test_a_time_that_is_over_is_refused_rather_than_passed_in_silence(until):
    with Execution(alone(lambda t, h, u: [t + h]), GaussSeidel(0.25), start=100.0) as run:
        run.advance(100.5)
        for go in (run.run, run.advance, RealTime(run, speed=1000.0).advance):
            with pytest.raises(CosimError, match=r"until: is no time to come \(got .*\); allowed: from 100\.5 s on"):
                go(until)
        run.run(100.5)
        assert run.time == 100.5


# ---------------------------------------------------------------- setting and reading
def test_an_input_that_nothing_drives_keeps_what_was_set():
    with Execution(alone(lambda t, h, u: u, ["u"]), GaussSeidel(0.1)) as run:
        run.set("f.u", 0.25)
        run.start()
        assert run.values(["f.y"])[0] == 0.25
        run.set("f.u", -0.5)
        run.step(3)
        assert run.values(["f.u", "f.y"]).tolist() == [-0.5, -0.5]


def test_what_cannot_be_set_is_refused_with_the_reason():
    run = Execution(feedthrough(0.5), GaussSeidel(0.1))
    with pytest.raises(CosimError, match=r"a\.u: is driven by 'b\.y' and cannot be set"):
        run.set("a.u", 1.0)
    with pytest.raises(CosimError, match=r"a\.y: is an output variable and cannot be set"):
        run.set("a.y", 1.0)
    with pytest.raises(CosimError, match=r"a\.v: no such variable in the system\. Did you mean"):
        run.set("a.v", 1.0)
    run = Execution(alone(lambda t, h, u: u, ["u"]), GaussSeidel(0.1))
    with pytest.raises(ParameterError, match=r"f\.u: is out of its bounds \(got 2\.0\); allowed: -1 to 1$"):
        run.set("f.u", 2.0)
    with pytest.raises(ParameterError, match=r"f\.u: is not a finite number"):
        run.set("f.u", math.nan)


def test_parameters_and_start_values_of_a_model_are_set_by_name():
    model = ModelSlave(escape(), {"k": 2.0, "x": 0.125})
    with Execution(System("s", {"m": model}), GaussSeidel(0.5)) as run:
        run.start()
        assert run.values(["m.y"])[0] == 0.125
        run.set("m.k", 1.0)
        run.advance(4.0)
        assert run.values(["m.y"])[0] == pytest.approx(1 / (1 / 0.125 - 4.0), rel=1e-4)
        with pytest.raises(ParameterError, match=r"m\.k: is out of its bounds"):
            run.set("m.k", 3.0)


def test_all_wrong_parameters_of_a_model_are_told_at_once():
    with pytest.raises(ParameterError) as caught:
        ModelSlave(escape(), {"kk": 1.0, "k": 5.0, "x": math.inf})
    assert [problem.path for problem in caught.value.problems] == ["escape.kk", "escape.k", "escape.x"]


@LOOPS
def test_internal_variables_of_a_model_can_be_read_and_recorded(loop):
    with Execution(System("s", {"m": ModelSlave(escape())}), GaussSeidel(0.01), loop=loop) as run:
        read = run.reader(["m.twice", "m.x", "m.y"])
        recorder = run.record(["m.twice", "m.y"], every=0.05)
        run.advance(0.5)
        twice, x, y = read()
        assert (twice, x) == (2 * y, y)
        filled = np.zeros(3)
        assert read(filled) is filled
        assert filled.tolist() == [twice, x, y]
        run.flush()
        recording = recorder.recording()
    assert np.array_equal(recording["m.twice"], 2 * recording["m.y"])
    assert len(recording) == 11


def test_all_unknown_names_to_record_are_told_at_once():
    run = Execution(feedthrough(0.5), GaussSeidel(0.1))
    with pytest.raises(CosimError) as caught:
        run.record(["a.y", "a.z", "c.y"])
    assert [problem.path for problem in caught.value.problems] == ["a.z", "c.y"]


# ---------------------------------------------------------------- faults
@LOOPS
def test_an_exception_in_a_function_ends_the_run_with_slave_time_and_cause(loop):
    def fails(t, h, u):
        if t > 0.25:
            raise ZeroDivisionError("no pressure")
        return [t]

    run = Execution(alone(fails), GaussSeidel(0.1), loop=loop)
    recorder = run.record()
    with pytest.raises(CosimError) as caught:
        run.run(1.0)
    assert str(caught.value) == "f: failed in the step from t = 0.3 to 0.4 s: ZeroDivisionError: no pressure"
    assert isinstance(caught.value.__cause__, ZeroDivisionError)
    assert recorder.recording().time.tolist() == [0.0, 0.1, 0.2, 0.3]
    assert run.error is caught.value
    with pytest.raises(CosimError, match=r"the run ended at t = 0\.3 s \(f: failed in the step"):
        run.step()


@LOOPS
def test_a_value_that_is_not_finite_stops_in_that_macro_step_and_is_named(loop):
    run = Execution(
        alone(lambda t, h, u: [1.0, math.nan if t > 0.15 else t], outputs=["good", "bad"]), GaussSeidel(0.1), loop=loop
    )
    with pytest.raises(CosimError) as caught:
        run.run(1.0)
    assert str(caught.value) == "f.bad: is not finite in the step from t = 0.2 to 0.3 s (got nan)"
    assert run.time == 0.2


@LOOPS
def test_a_model_that_cannot_go_on_is_told_in_its_own_words(loop):
    run = Execution(System("s", {"m": ModelSlave(escape())}), GaussSeidel(0.3), loop=loop)
    recorder = run.record()
    with pytest.raises(
        CosimError, match=r"m: failed with status 'discard' when stepping in the step from t = 0\.9 to 1\.2 s: .*\bx\b"
    ):
        run.run(2.0)
    assert recorder.recording()["m.y"] == pytest.approx(1 / (1 - recorder.recording().time), rel=1e-3)


@LOOPS
def test_an_interrupt_from_the_keyboard_is_passed_on_as_it_is(loop):
    def interrupted(t, h, u):
        if t > 0.25:
            raise KeyboardInterrupt
        return [t]

    run = Execution(alone(interrupted), GaussSeidel(0.1), loop=loop)
    with pytest.raises(KeyboardInterrupt):
        run.run(1.0)
    with pytest.raises(CosimError, match="f: was interrupted"):
        run.step()


def test_outputs_of_the_wrong_number_are_refused():
    with pytest.raises(CosimError, match=r"f: failed at the start .*shape \(1,\), but 2 are declared"):
        Execution(alone(lambda t, h, u: [t], outputs=["a", "b"]), GaussSeidel(0.1)).start()


# ---------------------------------------------------------------- state
@LOOPS
@pytest.mark.parametrize("slaves", [functions, models])
def test_a_restored_run_goes_on_exactly_as_the_uninterrupted_one(slaves, loop):
    with Execution(system(slaves()), GaussSeidel(0.01), loop=loop) as run:
        run.advance(1.0)
        state = run.save()
        whole = run.run(3.0)
        bonds = run.bonds
        run.restore(state)
        assert run.time == 1.0
        again = run.run(3.0)
        assert run.bonds == bonds
    assert np.array_equal(again.time, whole.time)
    for name in whole:
        assert np.array_equal(again[name], whole[name])


def test_a_state_goes_into_another_run_of_the_same_system():
    joined = system(models())
    with Execution(joined, GaussSeidel(0.01)) as first, Execution(joined, GaussSeidel(0.01)) as second:
        first.advance(1.0)
        second.start()
        second.restore(first.save())
        first.advance(2.0)
        second.advance(2.0)
        assert (
            first.values(["one.position", "spring.energy"]).tolist()
            == second.values(["one.position", "spring.energy"]).tolist()
        )


def test_a_failed_run_comes_back_when_it_is_restored():
    with Execution(System("s", {"m": ModelSlave(escape())}), GaussSeidel(0.1)) as run:
        run.advance(0.5)
        state = run.save()
        with pytest.raises(CosimError):
            run.advance(2.0)
        run.restore(state)
        assert run.error is None
        run.step()
        assert run.values(["m.y"])[0] == pytest.approx(1 / 0.4, rel=1e-4)


def test_a_state_of_another_system_is_refused():
    with Execution(feedthrough(0.5), GaussSeidel(0.1)) as one, Execution(system(functions()), GaussSeidel(0.1)) as two:
        one.start()
        two.start()
        with pytest.raises(CosimError, match="is that of another system"):
            two.restore(one.save())


# ---------------------------------------------------------------- end
def test_a_closed_run_says_so():
    run = Execution(feedthrough(0.5), GaussSeidel(0.1))
    run.step()
    run.close()
    with pytest.raises(CosimError, match="the run has been closed"):
        run.step()
    run.close()


def test_a_run_that_is_no_longer_used_frees_its_slaves():
    run = Execution(
        System(
            "s", {"m": ModelSlave(dae("m", (np.eye(1), np.eye(1), np.eye(1)), [1.0], [Variable("u")], [Variable("y")]))}
        ),
        GaussSeidel(0.1),
    )
    run.step()
    inner = weakref.ref(run._plan.parts[0].instance.inner)
    del run
    gc.collect()
    assert inner() is None


def test_progress_is_told_and_ends_at_the_end():
    told = []
    with Execution(alone(lambda t, h, u: [t]), GaussSeidel(0.001)) as run:
        run.run(2.0, progress=lambda time, until: told.append((time, until)))
    assert told[-1] == (2.0, 2.0)
    assert run.usage.macro_steps == 2000
    assert run.usage.simulated_s == pytest.approx(2.0)
    assert 0 < run.usage.real_time_factor < 0.5
