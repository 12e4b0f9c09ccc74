"""Whatever is done to a run: both loops give the same bits, and a run that goes on from a saved state does too."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from seacrane.cosim import (
    Above,
    Adaptive,
    Event,
    Execution,
    FixedPoint,
    Freeze,
    FunctionSlave,
    GaussSeidel,
    Iterative,
    Jacobi,
    Newton,
    Offset,
    Override,
    Ramp,
    Release,
    Scale,
    Scenario,
    Set,
    StepDoubling,
    Stop,
    System,
)
from seacrane.model.dae import Variable

UNTIL = 1.0
NAMES = [f"{slave}.{variable}" for slave in "ab" for variable in ("u", "v", "y")]


def lag(t, h, x, u):
    following = x + h * (np.sin(5 * t) + u[0] - u[1] - x)
    return following, following


def system() -> System:
    """Two lags in a loop, each with a further input that nothing drives."""
    inputs = [Variable("u"), Variable("v", start=0.25)]
    slaves = {name: FunctionSlave(lag, inputs, [Variable("y")], [start]) for name, start in (("a", 0.5), ("b", -0.5))}
    made = System("loop", slaves)
    made.connect("a.y", "b.u", gain=0.7)
    made.connect("b.y", "a.u", gain=-1.3, bias=0.1)
    return made


VALUES, VARIABLES = st.floats(-2, 2), st.sampled_from(NAMES)
ACTIONS = st.one_of(
    st.builds(Set, st.sampled_from(["a.v", "b.v"]), VALUES),
    st.builds(Override, VARIABLES, VALUES),
    st.builds(Ramp, VARIABLES, VALUES, st.floats(1e-3, 1.0)),
    st.builds(Freeze, VARIABLES),
    st.builds(Offset, VARIABLES, VALUES),
    st.builds(Scale, VARIABLES, VALUES),
    st.builds(Release, VARIABLES),
    st.builds(Stop, st.sampled_from("ab")),
)
DUE = st.one_of(st.floats(0, UNTIL), st.tuples(st.builds(Above, VARIABLES, VALUES)))
SCENARIOS = st.lists(st.builds(Event, DUE, ACTIONS), max_size=8).map(lambda events: Scenario("random", tuple(events)))
ALGORITHMS = st.sampled_from(
    [
        GaussSeidel(0.03),
        Jacobi(0.03),
        Jacobi(0.03, rates={"a": 3}, extrapolation="quadratic"),
        GaussSeidel(0.03, rates={"b": 1 / 2}, extrapolation="linear"),
        Iterative(GaussSeidel(0.03, extrapolation="linear"), FixedPoint(), tolerance=1e-4),
        Iterative(Jacobi(0.03), Newton(), tolerance=1e-4),
        Adaptive(GaussSeidel(0.03), StepDoubling(1e-2), smallest=1e-3),
    ]
)


def table(run: Execution, until: float) -> np.ndarray:
    recorder = run.record(NAMES)
    run.advance(until)
    run.flush()
    recording = recorder.recording()
    return np.column_stack([recording.time, *(recording[name] for name in NAMES)])


@settings(max_examples=60, deadline=None)
@given(SCENARIOS, ALGORITHMS)
def test_both_loops_carry_a_scenario_out_alike(scenario, algorithm):
    tables = []
    for loop in ("c", "python"):
        with Execution(system(), algorithm, loop=loop) as run:
            run.follow(scenario)
            tables.append(table(run, UNTIL))
    assert np.array_equal(*tables)


@settings(max_examples=40, deadline=None)
@given(SCENARIOS, ALGORITHMS, st.integers(0, 33))
def test_a_scenario_goes_on_from_a_saved_state_in_another_run(scenario, algorithm, steps):
    with Execution(system(), algorithm) as run:
        run.follow(scenario)
        run.step(steps)
        state = run.save()
        whole = table(run, UNTIL)
    with Execution(system(), algorithm) as run:
        run.follow(scenario)
        run.start()
        run.restore(state)
        assert np.array_equal(table(run, UNTIL), whole)
