"""A compiled model runs as its closed form says."""

import math

import numpy as np
import pytest
from parts import Chamber, Lag, MassBlock, Orifice, PressureSource, Spring, Wall

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


def filling():
    diagram = Diagram("filling")
    pump, orifice = diagram.add("pump", PressureSource(pressure=200e5)), diagram.add("orifice", Orifice(diameter=5e-3))
    chamber = diagram.add("chamber", Chamber(volume=1e-3, pressure=10e5))
    diagram.connect(pump.p, orifice.a)
    diagram.connect(orifice.b, chamber.a)
    return diagram


@pytest.mark.parametrize(
    ("parameters", "text"),
    [
        ({"pump.pressure": 280}, "pump.pressure: 280 Pa is implausible; did you mean 280 bar?"),
        ({"orifice.diameter": -0.005}, "orifice.diameter: -0.005 m = -5 mm is out of range; allowed: above 0 m"),
        ({"orifice.diameter": 0.0}, "allowed: above 0 m"),
        ({"chamber.volume": -1e-3}, "chamber.volume: -0.001 m3 = -1 l is out of range"),
        ({"chamber.pressure": math.nan}, "chamber.pressure: must be a finite number in Pa"),
        ({"pump.pressure": "280 bar"}, "pump.pressure: must be a number in Pa (got '280 bar')"),
    ],
)
def test_values_given_to_a_run_are_checked_as_those_of_a_component(parameters, text):
    with pytest.raises(ParameterError) as caught:
        simulate(filling(), 1.0, parameters=parameters)
    assert text in str(caught.value)


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ("1 m", "u: must be a number in m (got '1 m')"),
        (([], []), "u: has 0 sample times for 0 values"),
        (([0.0, 1.0], [1.0]), "u: has 2 sample times for 1 values"),
        (([0.0, 1.0], ["a", "b"]), "u: must be sample times and as many values"),
        (([0.0, 1.0], [0.0, math.inf]), "u: sample times must not fall, and times and values must be finite"),
        (math.nan, "u: cannot be nan"),
    ],
)
def test_inputs_that_are_none_are_refused_by_name(given, text):
    with pytest.raises(ParameterError) as caught:
        simulate(lag(), 1.0, inputs={"u": given})
    assert text in str(caught.value)
