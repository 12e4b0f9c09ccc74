from math import pi, sin

import numpy as np
import pytest

from seacrane.errors import ParameterError, StructureError
from seacrane.library import signals as sig
from seacrane.model import Diagram, simulate


def test_sources_follow_their_formulas(law):
    assert law(sig.Constant(value=3.5))["y"] == 3.5
    wave = sig.Sine(amplitude=0.4, period=12.0, phase=0.3, bias=0.7)
    step = sig.Step(before=1.0, after=-2.0, at=3.0, rise=0.5)
    ramp = sig.Ramp(slope=0.2, start=1.0, at=3.0)
    for t in (0.0, 2.9, 3.25, 3.5, 10.0):
        assert law(wave, t=t)["y"] == pytest.approx(0.7 + 0.4 * sin(2 * pi * t / 12 + 0.3))
        assert law(step, t=t)["y"] == pytest.approx(np.interp(t, [3.0, 3.5], [1.0, -2.0]))
        assert law(ramp, t=t)["y"] == pytest.approx(1.0 + 0.2 * max(t - 3, 0))


def test_a_recording_is_joined_by_lines_and_held_at_its_ends(law):
    points = ((1.0, 0.0), (2.0, 1.0), (2.001, -1.0), (6.0, 0.5))
    recording = sig.RecordedInput(points=points)
    for t in (0.0, 1.5, 2.0005, 4.0, 9.0):
        assert law(recording, t=t)["y"] == pytest.approx(np.interp(t, *zip(*points, strict=True)), abs=1e-12)


def test_a_joystick_is_dead_in_its_centre_fine_beside_it_and_full_at_its_end(law):
    straight = sig.JoystickInput(dead_zone=0.1, scale=2.0)
    curved = sig.JoystickInput(dead_zone=0.1, progression=0.7, scale=2.0)
    for axis, share in ((0.0, 0.0), (0.09, 0.0), (0.55, 0.5), (-0.55, -0.5), (1.0, 1.0), (-1.7, -1.0)):
        assert law(straight, {"u": axis})["y"] == pytest.approx(2 * share)
        assert law(curved, {"u": axis})["y"] == pytest.approx(2 * (0.3 * share + 0.7 * share**3))


def test_a_table_is_a_characteristic(law):
    table = sig.Table(points=((-1.0, -10.0), (0.0, 0.0), (1.0, 30.0)), takes="1", gives="bar")
    assert [law(table, {"u": u})["y"] for u in (-2.0, -0.5, 0.5, 2.0)] == pytest.approx([-10, -5, 15, 30])


def test_gain_and_sum(law):
    assert law(sig.Gain(gain=-2.0, bias=1.0), {"u": 3.0})["y"] == -5.0
    assert law(sig.Sum(signs="+-+"), {"u1": 1.0, "u2": 10.0, "u3": 100.0})["y"] == 91.0


def test_saturation_and_dead_band(law):
    saturation, dead = sig.Saturation(low=-1.0, high=2.0), sig.DeadBand(width=0.1)
    assert [law(saturation, {"u": u})["y"] for u in (-5.0, 0.5, 5.0)] == [-1.0, 0.5, 2.0]
    assert [law(dead, {"u": u})["y"] for u in (-0.3, -0.05, 0.0, 0.05, 0.3)] == pytest.approx([-0.2, 0, 0, 0, 0.2])


def test_the_rate_limit_is_the_steepest_slope(law):
    limited = sig.RateLimit(rate=2.0, lag=0.01)
    assert law(limited, {"u": 1.0})["der(output)"] == 2.0
    assert law(limited, {"u": -1.0})["der(output)"] == -2.0
    assert law(limited, {"u": 0.01})["der(output)"] == pytest.approx(1.0)


def test_lags_tend_to_their_input(law):
    first = sig.FirstOrderLag(time_constant=0.5, start=1.0)
    assert law(first, {"u": 3.0})["der(output)"] == pytest.approx(4.0)
    second = sig.SecondOrderLag(natural_frequency=10.0, damping=0.7)
    values = law(second, {"u": 1.0}, {"output": 0.2, "rate": 3.0})
    assert values["der(output)"] == 3.0
    assert values["der(rate)"] == pytest.approx(100 * 0.8 - 2 * 0.7 * 10 * 3)


# ---------------------------------------------------------------- responses
def response(block, until, **exposed):
    diagram = Diagram("response")
    part = diagram.add("block", block)
    diagram.expose(**{name: getattr(part, port) for name, port in exposed.items()})
    return simulate(diagram, until, every=until / 50, inputs={"u": 1.0})


def test_the_step_response_of_a_first_order_lag_is_exponential():
    run = response(sig.FirstOrderLag(time_constant=0.5), 2.0, u="u", y="y")
    assert run["y"] == pytest.approx(1 - np.exp(-run.time / 0.5), abs=1e-5)


def test_the_step_response_of_a_second_order_lag_is_a_damped_wave():
    w, zeta = 10.0, 0.5
    run = response(sig.SecondOrderLag(natural_frequency=w, damping=zeta), 1.5, u="u", y="y")
    wd, t = w * (1 - zeta**2) ** 0.5, run.time
    exact = 1 - np.exp(-zeta * w * t) * (np.cos(wd * t) + zeta * w / wd * np.sin(wd * t))
    assert run["y"] == pytest.approx(exact, abs=1e-5)


# ---------------------------------------------------------------- PID
def test_the_step_response_of_a_pid_is_its_closed_form():
    controller = sig.PID(kp=2.0, ki=0.5, kd=0.1, filter_time=0.2, low=-10.0, high=10.0)
    diagram = Diagram("pid")
    part = diagram.add("pid", controller)
    diagram.expose(reference=part.reference, measured=part.measured, u=part.u)
    run = simulate(diagram, 2.0, every=0.05, inputs={"reference": 1.0})
    exact = 2.0 + 0.5 * run.time + 0.1 / 0.2 * np.exp(-run.time / 0.2)
    assert run["u"] == pytest.approx(exact, abs=1e-5)


def test_the_pid_output_stays_within_its_limits_and_its_integral_does_not_wind_up(law):
    controller = sig.PID(kp=2.0, ki=0.5, low=-1.0, high=1.0)
    held = law(controller, {"reference": 5.0})
    assert held["u"] == 1.0
    # it settles at the upper limit itself, so that the output leaves the limit as soon as the error changes sign
    settled = law(controller, {"reference": 5.0}, {"integral": 1.0})
    assert settled["der(integral)"] == pytest.approx(0.0)
    wound = law(controller, {"reference": 5.0}, {"integral": 3.0})
    assert wound["der(integral)"] < 0


# ---------------------------------------------------------------- refusals
def test_signals_of_different_units_are_not_joined():
    diagram = Diagram("d")
    source = diagram.add("source", sig.Constant(value=1.0, unit="m"))
    sink = diagram.add("sink", sig.Gain(gain=1.0, takes="bar"))
    with pytest.raises(StructureError) as caught:
        diagram.connect(source.y, sink.u)
    assert str(caught.value) == "sink.u: takes a signal in bar, but source.y gives one in m"


def test_signals_of_one_dimension_are_converted():
    diagram = Diagram("d")
    source = diagram.add("source", sig.Constant(value=250.0, unit="bar"))
    sink = diagram.add("sink", sig.Gain(gain=1.0, takes="Pa", gives="Pa"))
    diagram.connect(source.y, sink.u)
    diagram.expose(y=sink.y)
    assert simulate(diagram, 0.1, every=0.1)["y"][-1] == pytest.approx(250e5)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: sig.Constant(value=1.0, unit="bars"), "Constant.unit: unknown unit 'bars'. Did you mean 'bar'?"),
        (lambda: sig.Saturation(low=1.0, high=1.0), "Saturation.high: 1 must be above low = 1"),
        (lambda: sig.Sum(signs="+*"), "Sum.signs: must be one sign for each input (got '+*'); allowed: such as '+-'"),
        (
            lambda: sig.RecordedInput(points=((0.0, 1.0), (0.0, 2.0))),
            "RecordedInput.points: must rise strictly, but 0 follows 0",
        ),
        (lambda: sig.RecordedInput(points=((0.0, 1.0),)), "RecordedInput.points: needs at least two points, has 1"),
        (lambda: sig.Table(points=3.0), "Table.points: must be pairs of numbers (got 3.0)"),
        (
            lambda: sig.Table(points=((0.0, float("nan")), (1.0, 2.0))),
            "Table.points: must be finite numbers",
        ),
    ],
)
def test_a_wrong_block_says_what_is_wrong(make, message):
    with pytest.raises(ParameterError) as caught:
        make()
    assert str(caught.value) == message
