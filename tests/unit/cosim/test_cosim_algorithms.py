import numpy as np
import pytest
from oscillators import exact, functions, models, system

from seacrane.cosim import Execution, FunctionSlave, GaussSeidel, Jacobi, System
from seacrane.errors import CosimError
from seacrane.model.dae import Variable

UNTIL = 4.0


def error(algorithm) -> float:
    with Execution(system(functions()), algorithm) as run:
        recording = run.run(UNTIL)
    times = recording.time[:: len(recording) // 20]
    return float(np.sqrt(np.mean((recording.at(times)["one.position"] - exact(times)) ** 2)))


@pytest.mark.parametrize("algorithm", [GaussSeidel, Jacobi])
def test_the_error_is_of_first_order_in_the_macro_step(algorithm):
    errors = [error(algorithm(step)) for step in (0.008, 0.004, 0.002)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert orders == pytest.approx(1.0, abs=0.1)


def test_gauss_seidel_is_more_accurate_than_jacobi_at_the_same_step():
    assert error(GaussSeidel(0.004)) < 0.7 * error(Jacobi(0.004))


@pytest.mark.parametrize("slaves", [functions, models])
@pytest.mark.parametrize("algorithm", [GaussSeidel(0.003), Jacobi(0.003)])
def test_the_c_loop_and_the_python_loop_give_the_same_bits(slaves, algorithm):
    tables = []
    for loop in ("c", "python"):
        with Execution(system(slaves()), algorithm, loop=loop) as run:
            assert run.loop == loop
            recording = run.run(UNTIL)
            tables.append(np.column_stack([recording.time, *(recording[name] for name in recording)]))
    assert tables[0].shape == (1335, 1 + 3 + 7)
    assert np.array_equal(*tables)


def test_compiled_models_move_like_the_exact_functions():
    recordings = []
    for slaves in (functions, models):
        with Execution(system(slaves()), GaussSeidel(0.005)) as run:
            recordings.append(run.run(UNTIL))
    assert recordings[0].rmse(recordings[1], "one.position") < 1e-8


def test_gauss_seidel_hands_on_the_newest_output_and_jacobi_that_of_the_last_step():
    chain = System("chain")
    chain.add("clock", FunctionSlave(lambda t, h, u: [t + h], outputs=[Variable("t", "s")]))
    chain.add("copy", FunctionSlave(lambda t, h, u: u, inputs=[Variable("u", "s")], outputs=[Variable("y", "s")]))
    chain.connect("clock.t", "copy.u")

    def seen(algorithm):
        with Execution(chain, algorithm) as run:
            run.step(3)
            return run.values(["clock.t", "copy.y"]).tolist()

    assert seen(GaussSeidel(0.5)) == [1.5, 1.5]
    assert seen(GaussSeidel(0.5, order=["copy", "clock"])) == [1.5, 1.0]
    assert seen(Jacobi(0.5)) == [1.5, 1.0]


def test_an_order_must_name_each_slave_once():
    with pytest.raises(CosimError) as caught:
        GaussSeidel(0.1, order=["one", "one", "tow"]).schedule(["one", "two", "three"])
    assert [str(problem) for problem in caught.value.problems] == [
        "order.tow: no such slave in the system. Did you mean 'two'?",
        "order.one: stands in the order twice",
        "order.two: is missing in the order",
        "order.three: is missing in the order",
    ]


@pytest.mark.parametrize("step", [0.0, -0.1, float("nan"), 1e-10])
def test_a_macro_step_must_be_a_duration(step):
    with pytest.raises(CosimError, match="step: is not a duration"):
        GaussSeidel(step)


def test_communication_times_are_exact_multiples_after_a_million_steps():
    lone = System("lone")
    lone.add("clock", FunctionSlave(lambda t, h, u: [t], outputs=[Variable("t", "s")]))
    with Execution(lone, Jacobi(1e-3)) as run:
        run.record(every=100.0)
        recording = run.run(1000.0)
    assert recording.time.tolist() == [100.0 * i for i in range(11)]
    assert recording["clock.t"].tolist()[1:] == [100.0 * i - 1e-3 for i in range(1, 11)]
