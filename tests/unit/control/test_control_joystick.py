"""The operator's control moves only while the dead man's switch is held, and never into a stop."""

import math
import timeit
from dataclasses import replace

import msgspec
import numpy as np
import pytest

from seacrane import design
from seacrane.control import Axis, JointAxis, Joystick
from seacrane.errors import ParameterError
from seacrane.units import deg, kN

LINEAR = Axis(dead_band=0.0, expo=0.0, ramp=1.0)
ROPE = (38.0, 300.0)
SAFE = {
    "deadman": 1.0,
    "luff": 40 * deg,
    "jib": -60 * deg,
    "rope.unstretched_length": 100.0,
    "rope.hanging": 20.0,
    "rope.tension": 400 * kN,
}


def axes(axis=LINEAR, **others):
    """Slewing, boom and jib, each answering like `axis` unless told otherwise."""
    ends = {"slew": ("slew", None), "boom": ("luff", (0.0, 78 * deg)), "jib": ("jib", (-115 * deg, 0.0))}
    return tuple(
        JointAxis(name=name, joint=joint, limits=limits, axis=others.get(name, axis))
        for name, (joint, limits) in ends.items()
    )


@pytest.fixture
def joystick():
    return Joystick(joints=axes(), rope=ROPE, hoist_axis=LINEAR)


def values_of(joystick, signals):
    return [float(signals.get(v.name, 0.0)) for v in joystick.inputs]


def drive(joystick, seconds, state=None, dt=0.002, **signals):
    """State and named outputs after holding the inputs for a while; dots in names are written as double underscores."""
    values = values_of(joystick, SAFE | {name.replace("__", "."): value for name, value in signals.items()})
    state = joystick.start if state is None else state
    for _ in range(round(seconds / dt)):
        state, outputs = joystick.step(state, values, dt)
    return state, dict(zip((v.name for v in joystick.outputs), outputs, strict=True))


@pytest.mark.parametrize(("axis", "spool"), [("slew", "slew"), ("boom", "boom"), ("jib", "jib"), ("hoist", "winch")])
@pytest.mark.parametrize("stick", [1.0, -1.0])
def test_each_stick_moves_its_own_spool_and_no_other(joystick, axis, spool, stick):
    _, out = drive(joystick, 2.0, **{f"axis__{axis}": stick})
    expected = dict.fromkeys((v.name for v in joystick.outputs), 0.0) | {f"spool.{spool}": stick}
    assert out == pytest.approx(expected)


def test_the_command_ramps_at_its_rate_and_comes_back_at_it(joystick):
    state, out = drive(joystick, 0.5, axis__boom=1.0)
    assert out["spool.boom"] == pytest.approx(0.5)
    state, out = drive(joystick, 0.2, state, axis__boom=0.0)
    assert out["spool.boom"] == pytest.approx(0.3)
    _, out = drive(joystick, 1.0, state, axis__boom=0.0)
    assert out["spool.boom"] == 0.0


def test_the_ramp_does_not_depend_on_the_step(joystick):
    results = [drive(joystick, 0.3, dt=dt, axis__slew=-0.8)[1]["spool.slew"] for dt in (0.001, 0.005, 0.1)]
    assert results == pytest.approx([-0.3] * 3)


def test_releasing_the_dead_man_stops_all_axes_in_the_release_time(joystick):
    sticks = {f"axis__{axis}": 1.0 for axis in ("slew", "boom", "jib", "hoist")}
    state, _ = drive(joystick, 2.0, **sticks)
    assert state == (1.0, 1.0, 1.0, 1.0)
    state, out = drive(joystick, 0.1, state, deadman=0.0, **sticks)
    assert out["spool.boom"] == pytest.approx(0.5)
    state, out = drive(joystick, 0.1 + 0.002, state, deadman=0.0, **sticks)
    assert state == (0.0, 0.0, 0.0, 0.0)
    assert all(out[f"spool.{name}"] == 0.0 for name in ("slew", "boom", "jib", "winch"))
    assert drive(joystick, 5.0, state, deadman=0.0, **sticks)[0] == (0.0, 0.0, 0.0, 0.0)


def test_a_fast_ramp_is_not_slowed_by_the_release(joystick):
    fast = replace(joystick, joints=axes(boom=Axis(dead_band=0.0, expo=0.0, ramp=20.0)))
    state, _ = drive(fast, 1.0, axis__boom=1.0)
    assert drive(fast, 0.05, state, deadman=0.0)[0][1] == pytest.approx(0.0, abs=1e-12)


def test_a_stick_in_its_dead_band_rests_and_the_full_stick_is_full_speed(joystick):
    shaped = replace(joystick, joints=axes(boom=Axis(dead_band=0.1, expo=0.4, ramp=10.0)))
    assert drive(shaped, 1.0, axis__boom=0.1)[1]["spool.boom"] == 0.0
    assert drive(shaped, 1.0, axis__boom=1.0)[1]["spool.boom"] == pytest.approx(1.0)
    assert drive(shaped, 1.0, axis__boom=7.0)[1]["spool.boom"] == pytest.approx(1.0)
    half = 0.6 * 0.5 + 0.4 * 0.5**3
    assert drive(shaped, 1.0, axis__boom=-0.55)[1]["spool.boom"] == pytest.approx(-half)


def test_the_spool_jumps_over_the_dead_band_of_its_valve_and_back_to_the_middle(joystick):
    valve = replace(joystick, joints=axes(boom=replace(LINEAR, valve_dead_band=0.1)))
    _, out = drive(valve, 0.004, axis__boom=0.5)
    assert out["spool.boom"] == pytest.approx(0.1 + 0.9 * 0.004)
    state, out = drive(valve, 2.0, axis__boom=1.0)
    assert out["spool.boom"] == pytest.approx(1.0)
    assert drive(valve, 2.0, axis__boom=-0.5)[1]["spool.boom"] == pytest.approx(-0.1 - 0.9 * 0.5)
    assert drive(valve, 2.0, state, axis__boom=0.0)[1]["spool.boom"] == 0.0


@pytest.mark.parametrize(
    ("axis", "spool", "angle", "low", "high", "limit"),
    [("boom", "boom", "luff", 0.0, 78.0, "limit.luff"), ("jib", "jib", "jib", -115.0, 0.0, "limit.jib")],
)
def test_a_joint_slows_before_its_end_stops_at_the_margin_and_may_go_back(
    joystick, axis, spool, angle, low, high, limit
):
    def command(degrees, stick):
        _, out = drive(joystick, 2.0, **{angle: degrees * deg, f"axis__{axis}": stick})
        return out[f"spool.{spool}"], out[limit]

    assert command(high - 7, 1.0) == (1.0, 0.0)
    assert command(high - 0.5 - 3, 1.0) == pytest.approx((0.1 + 0.9 * 0.5, 1.0))
    assert command(high - 0.5, 1.0) == (0.0, 1.0)
    assert command(high + 1, 1.0) == (0.0, 1.0)
    assert command(high + 1, -1.0) == (-1.0, 0.0)
    assert command(low + 0.5 + 3, -1.0) == pytest.approx((-0.1 - 0.9 * 0.5, -1.0))
    assert command(low, -1.0) == (0.0, -1.0)
    assert command(low, 1.0) == (1.0, 0.0)


def test_a_stop_acts_at_once_and_not_by_the_ramp(joystick):
    state, _ = drive(joystick, 2.0, axis__boom=1.0)
    assert drive(joystick, 0.002, state, axis__boom=1.0, luff=78 * deg)[1]["spool.boom"] == 0.0


def test_the_hook_stops_before_the_tip_and_may_be_lowered(joystick):
    def command(hanging, stick):
        _, out = drive(joystick, 2.0, rope__hanging=hanging, axis__hoist=stick)
        return out["spool.winch"], out["limit.two_block"]

    assert command(8.5, 1.0) == (1.0, 0.0)
    assert command(5.5, 1.0) == pytest.approx((0.55, 1.0))
    assert command(3.0, 1.0) == (0.0, 1.0)
    assert command(1.0, -1.0) == (-1.0, 0.0)


def test_the_rope_is_neither_wound_in_nor_paid_out_beyond_its_ends(joystick):
    def command(length, stick):
        _, out = drive(joystick, 2.0, rope__unstretched_length=length, axis__hoist=stick)
        return out["spool.winch"], out["limit.rope"]

    assert command(300.0, -1.0) == (0.0, 1.0)
    assert command(297.5, -1.0) == pytest.approx((-0.55, 1.0))
    assert command(300.0, 1.0) == (1.0, 0.0)
    assert command(38.0, 1.0) == (0.0, -1.0)
    assert command(38.0, -1.0) == (-1.0, 0.0)


def test_a_slack_rope_stops_lowering_only(joystick):
    _, out = drive(joystick, 2.0, rope__tension=1 * kN, axis__hoist=-1.0)
    assert (out["spool.winch"], out["limit.slack"]) == (0.0, 1.0)
    _, out = drive(joystick, 2.0, rope__tension=1 * kN, axis__hoist=1.0)
    assert (out["spool.winch"], out["limit.slack"]) == (1.0, 1.0)
    never = replace(joystick, slack_tension=0.0)
    assert drive(never, 2.0, rope__tension=0.0, axis__hoist=-1.0)[1]["spool.winch"] == -1.0


def test_what_is_not_a_number_is_the_safe_value(joystick):
    assert drive(joystick, 2.0, axis__boom=math.nan)[1]["spool.boom"] == 0.0
    assert drive(joystick, 2.0, axis__boom=1.0, deadman=math.nan)[1]["spool.boom"] == 0.0
    for stick in (1.0, -1.0):
        assert drive(joystick, 2.0, axis__boom=stick, luff=math.nan)[1]["spool.boom"] == 0.0
        assert drive(joystick, 2.0, axis__jib=stick, jib=math.nan)[1]["spool.jib"] == 0.0
        assert drive(joystick, 2.0, axis__hoist=stick, rope__unstretched_length=math.nan)[1]["spool.winch"] == 0.0
    assert drive(joystick, 2.0, axis__hoist=1.0, rope__hanging=math.nan)[1]["spool.winch"] == 0.0
    assert drive(joystick, 2.0, axis__hoist=-1.0, rope__tension=math.nan)[1]["spool.winch"] == 0.0


def test_a_boom_driven_into_its_stop_creeps_up_to_the_margin_and_stands():
    joystick = Joystick(joints=axes(Axis()), rope=ROPE)
    state, luff, dt, speeds = joystick.start, 70 * deg, 0.01, []
    for _ in range(4000):
        inputs = SAFE | {"axis.boom": 1.0, "luff": luff}
        state, outputs = joystick.step(state, values_of(joystick, inputs), dt)
        luff += 2 * deg * outputs[1] * dt  # a boom that follows its spool at 2 deg/s
        speeds.append(outputs[1])
    assert luff == pytest.approx(77.5 * deg, abs=0.01 * deg)
    assert speeds[-1] == 0.0
    assert max(speeds) == pytest.approx(1.0)


def test_a_zero_step_gives_the_outputs_of_the_state_and_moves_nothing(joystick):
    state = (0.5, -0.25, 0.0, 1.0)
    values = values_of(joystick, SAFE)
    after, outputs = joystick.step(state, values, 0.0)
    assert after == state
    assert outputs[:4] == state


def test_as_a_slave_function_it_is_the_same_pure_step(joystick):
    values = values_of(joystick, SAFE | {"axis.slew": 0.7})
    state = np.array([0.1, 0.2, 0.3, 0.4])
    first = joystick(3.0, 0.01, state, np.array(values))
    assert first == joystick.step((0.1, 0.2, 0.3, 0.4), values, 0.01)
    assert first == joystick(9.0, 0.01, state, np.array(values))
    np.testing.assert_array_equal(state, [0.1, 0.2, 0.3, 0.4])


def test_a_call_takes_microseconds(joystick):
    state, values = (
        np.zeros(4),
        np.array(values_of(joystick, dict.fromkeys((v.name for v in joystick.inputs), 0.5) | SAFE)),
    )
    best = min(timeit.repeat(lambda: joystick(0.0, 0.002, state, values), number=200, repeat=20)) / 200
    assert best < 30e-6  # about 3 on an idle machine; the loop of the co-simulation has 2000


def test_axes_and_limits_come_from_the_design():
    crane = design.load("offshore-100t")
    joystick = Joystick.of(crane, rope=ROPE, release_time=0.3)
    assert [(item.name, item.joint, item.limits) for item in joystick.joints] == [
        ("slew", "slew", None),
        ("boom", "luff", pytest.approx((0.0, 78 * deg))),
        ("jib", "jib", pytest.approx((-115 * deg, 0.0))),
    ]
    assert joystick.release_time == 0.3
    frame = Joystick.of(design.load("a-frame-30t"), rope=ROPE)
    assert [(item.name, item.joint, item.unit) for item in frame.joints] == [
        ("frame", "luff", "rad"),
        ("leg", "telescope", "m"),
    ]
    assert {v.name: v.unit for v in frame.inputs if v.name in ("luff", "telescope")} == {
        "luff": "rad",
        "telescope": "m",
    }
    jib = crane.links[2]
    free = msgspec.structs.replace(jib, joint=msgspec.structs.replace(jib.joint, limits=None))
    with pytest.raises(ParameterError, match="jib: only a slewing joint may be endless"):
        Joystick.of(msgspec.structs.replace(crane, links=(*crane.links[:2], free)), rope=ROPE)


def test_a_telescope_stops_at_its_ends_and_slides_out_no_further_than_the_hook_allows():
    slide = JointAxis(name="telescope", joint="telescope", limits=(0.0, 10.0), unit="m", axis=LINEAR)
    joystick = Joystick(joints=(slide,), rope=ROPE, hoist_axis=LINEAR)

    def command(stick, position, hanging=20.0):
        _, out = drive(joystick, 2.0, axis__telescope=stick, telescope=position, rope__hanging=hanging)
        return out["spool.telescope"], out["limit.telescope"], out["limit.two_block"]

    assert command(1.0, 5.0) == (1.0, 0.0, 0.0)
    assert command(1.0, 10.0 - 0.05 - 0.25) == pytest.approx((0.55, 1.0, 0.0))
    assert command(-1.0, 0.05) == (0.0, -1.0, 0.0)
    assert command(1.0, 5.0, hanging=5.5) == pytest.approx((0.55, 0.0, 1.0))
    assert command(1.0, 5.0, hanging=2.0) == (0.0, 0.0, 1.0)
    assert command(-1.0, 5.0, hanging=2.0) == (-1.0, 0.0, 0.0)


def joint(name, limits, unit="rad"):
    return (JointAxis(name=name, joint=name, limits=limits, unit=unit),)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"joints": joint("luff", (1.0, 0.0))}, r"luff: the lower limit must be below the upper \[rad\]"),
        (
            {"joints": joint("jib", (0.0, 0.01))},
            "jib: leaves no room between the margins .*allowed: over 0.0174533 rad",
        ),
        ({"joints": joint("slide", (0.0, 0.1), "m")}, "slide: leaves no room .*allowed: over 0.1 m"),
        ({"joints": joint("hoist", (0.0, 1.0))}, r"joints\[hoist\]: is the name of two axes"),
        ({"joints": joint("luff", None) * 2}, r"joints\[luff\]: is the name of two axes"),
        ({"rope": (math.nan, 3.0)}, "rope: the lower limit"),
        ({"joints": axes(boom=Axis(dead_band=1.0))}, r"boom.axis.dead_band: is out of range .*allowed: 0 to 0.9"),
        ({"hoist_axis": Axis(ramp=math.nan)}, r"hoist.axis.ramp: is out of range"),
        ({"release_time": 5.0}, "release_time: must stop the crane soon"),
        ({"creep": 2.0}, "creep: is a share of full speed"),
        ({"two_block": -1.0}, "two_block: must not be negative"),
    ],
)
def test_settings_that_are_wrong_are_refused(wrong, message):
    with pytest.raises(ParameterError, match=message):
        Joystick(**({"joints": axes(), "rope": ROPE} | wrong))
