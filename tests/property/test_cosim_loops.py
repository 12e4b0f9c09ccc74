"""Whatever the structure: the C loop and the Python loop give the same bits, and so does a run that was restored."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from seacrane.cosim import (
    Adaptive,
    Execution,
    FixedPoint,
    FunctionSlave,
    GaussSeidel,
    Iterative,
    Jacobi,
    Newton,
    StepDoubling,
    System,
)
from seacrane.errors import CosimError
from seacrane.model.dae import Variable


def mixing(inputs: int, outputs: int, seed: int):
    """A stable linear slave of one state for each output."""
    random = np.random.default_rng(seed)
    weights = random.uniform(-1, 1, (outputs, max(inputs, 1)))

    def step(t, h, x, u):
        drive = weights[:, :inputs] @ np.tanh(u) + np.sin(t)
        following = x + h * (drive - x)
        return following, following

    return FunctionSlave(
        step,
        [Variable(f"u{i}", "N", start=0.1 * i) for i in range(inputs)],
        [Variable(f"y{i}", "kN") for i in range(outputs)],
        random.uniform(-1, 1, outputs),
    )


@st.composite
def systems(draw):
    sizes = draw(st.lists(st.tuples(st.integers(0, 4), st.integers(1, 4)), min_size=1, max_size=5))
    seed = draw(st.integers(0, 2**32 - 1))
    system = System("random", {f"s{i}": mixing(*size, seed + i) for i, size in enumerate(sizes)})
    outputs = [f"s{i}.y{j}" for i, (_, count) in enumerate(sizes) for j in range(count)]
    for i, (count, _) in enumerate(sizes):
        for j in range(count):
            source = draw(st.sampled_from([None, *outputs]))
            if source is not None:
                gain = draw(st.floats(-1e-3, 1e-3))
                system.connect(source, f"s{i}.u{j}", gain=gain, bias=draw(st.floats(-1, 1)))
    return system, draw(st.permutations(list(system.slaves)))


def table(run, until):
    recording = run.run(until)
    return np.column_stack([recording.time, *(recording[name] for name in recording)])


@st.composite
def algorithms(draw, order, step):
    """Anything that composes, but for what needs a bond."""
    names = list(order)
    rates = draw(st.dictionaries(st.sampled_from(names), st.sampled_from([2, 3, 1 / 2, 1 / 3]), max_size=2))
    extrapolation = draw(st.sampled_from(["hold", "linear", "quadratic"]))
    common = {"rates": rates, "extrapolation": extrapolation}
    base = Jacobi(step, **common) if draw(st.booleans()) else GaussSeidel(step, order=order, **common)
    solver = draw(st.sampled_from([None, None, FixedPoint(), FixedPoint(0.5, aitken=False), Newton()]))
    algorithm = base if solver is None else Iterative(base, solver, tolerance=1e-3, most=200)
    if draw(st.booleans()) and min(rates.values(), default=1) >= 1:
        return Adaptive(algorithm, StepDoubling(1e-2), smallest=step / 20)
    return algorithm


def run_of(system, algorithm, loop):
    """The table, or what was said when an iteration did not converge, up to there."""
    with Execution(system, algorithm, loop=loop) as run:
        recorder = run.record()
        try:
            run.run(12 * algorithm.step)
            said = ""
        except CosimError as error:
            said = str(error)
            run.flush()
        recording = recorder.recording()
        return np.column_stack([recording.time, *(recording[name] for name in recording)]), said, run.usage.sweeps


@settings(max_examples=40, deadline=None)
@given(st.data(), systems(), st.floats(1e-3, 0.1))
def test_both_loops_agree_bit_by_bit_whatever_the_algorithm(data, given_system, step):
    system, order = given_system
    algorithm = data.draw(algorithms(order, step))
    (c, c_said, c_sweeps), (python, python_said, python_sweeps) = (
        run_of(system, algorithm, loop) for loop in ("c", "python")
    )
    assert np.array_equal(c, python)
    assert (c_said, c_sweeps) == (python_said, python_sweeps)


@settings(max_examples=20, deadline=None)
@given(st.data(), systems(), st.integers(1, 10), st.sampled_from(["c", "python"]))
def test_a_restored_run_repeats_itself_whatever_the_algorithm(data, given_system, steps, loop):
    """Histories, step sizes and Jacobians are part of the state: going back and going on is as if never interrupted."""
    system, order = given_system
    algorithm = data.draw(algorithms(order, 0.01))
    with Execution(system, algorithm, loop=loop) as run:
        run.step(steps)
        state = run.save()
        whole = table(run, 0.25)
        run.restore(state)
        assert np.array_equal(table(run, 0.25), whole)


@settings(max_examples=40, deadline=None)
@given(systems(), st.booleans(), st.floats(1e-4, 0.1))
def test_both_loops_agree_bit_by_bit(given_system, simultaneous, step):
    system, order = given_system
    algorithm = Jacobi(step) if simultaneous else GaussSeidel(step, order=order)
    tables = []
    for loop in ("c", "python"):
        with Execution(system, algorithm, loop=loop) as run:
            tables.append(table(run, 20 * step))
    assert np.array_equal(*tables)


@settings(max_examples=20, deadline=None)
@given(systems(), st.integers(1, 15))
def test_a_restored_run_repeats_itself(given_system, steps):
    system, order = given_system
    with Execution(system, GaussSeidel(0.01, order=order)) as run:
        run.step(steps)
        state = run.save()
        whole = table(run, 0.3)
        run.restore(state)
        assert np.array_equal(table(run, 0.3), whole)
