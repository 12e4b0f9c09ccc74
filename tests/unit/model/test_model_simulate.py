"""A compiled model runs as its closed form says."""

import numpy as np
import pytest
from parts import Lag, MassBlock, Spring, Wall

from seacrane.errors import ParameterError, SolveError
from seacrane.model import Diagram, simulate


def lag():
    diagram = Diagram("following")
    part = diagram.add("lag", Lag(rate=2.0))
    diagram.expose(u=part.u, y=part.y)
    return diagram


def test_a_lag_answers_a_step_by_the_exponential():
    run = simulate(lag(), 3.0, inputs={"u": 1.0}, tolerance=1e-9)
    assert run["y"] == pytest.approx(1 - np.exp(-2.0 * run.time), abs=1e-8)
    assert run.signal("y").unit == "m"


def test_a_lag_follows_a_ramp_at_its_time_constant():
    run = simulate(lag(), 5.0, inputs={"u": ([0.0, 5.0], [0.0, 5.0])}, linear=True, tolerance=1e-9)
    assert run["y"][-1] == pytest.approx(5.0 - 0.5 + 0.5 * np.exp(-10.0), abs=1e-7)


def test_an_oscillator_keeps_its_energy():
    diagram = Diagram("oscillator")
    wall, spring = diagram.add("wall", Wall()), diagram.add("spring", Spring(stiffness=4e4))
    block = diagram.add("block", MassBlock(mass=100.0))
    diagram.connect(wall.flange, spring.b)
    diagram.connect(spring.a, block.flange)
    run = simulate(diagram, 5.0, parameters={"spring.f": 4000.0}, tolerance=1e-9)
    energy = 0.5 * 100.0 * run["block.v"] ** 2 + 0.5 * run["spring.f"] ** 2 / 4e4
    assert energy == pytest.approx(np.full_like(energy, 200.0), rel=1e-6)


def test_unknown_names_and_impossible_times_are_refused():
    with pytest.raises(ParameterError, match=r"Did you mean 'lag.rate'"):
        simulate(lag(), 1.0, parameters={"lag.rat": 1.0})
    with pytest.raises(SolveError, match="0 < every <= until"):
        simulate(lag(), -1.0)
