"""The motion of a ship's crane foot is the exact derivative of its pose, at every level through the same ports."""

import math

import casadi as ca
import numpy as np
import pytest

from seacrane import ocean, vessel
from seacrane.errors import ParameterError
from seacrane.units import GRAVITY, deg

PEDESTAL = (-20.0, 7.0, 12.0)
VECTORS = ("w", "al", "a", "v", "g")


def outputs(ship, **parameters):
    """A function of time that gives the ship's outputs by name."""
    values = [parameters.get(v.name.replace(".", "_"), v.start) for v in ship.parameters]
    names = [v.name for v in ship.outputs]
    function = ca.Function("ship", [ship.t, ship.p], [ship.out])
    return lambda t: dict(zip(names, np.asarray(function(t, values)).ravel(), strict=True))


def vector(at, name):
    return np.array([at[f"foot.{name}{a}"] for a in "xyz"])


def pose(at):
    """Position and rotation matrix from the outputs."""
    w, x, y, z = (at[f"q{c}"] for c in "wxyz")
    rotation = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    return np.array([at["x"], at["y"], at["z"]]), rotation


def rough(ramp=10.0):
    return vessel.Harmonic(
        surge=vessel.Motion(amplitude=0.8, period=9.0, phase=0.3),
        sway=vessel.Motion(amplitude=0.5, period=11.0, phase=-1.0),
        heave=vessel.Motion(amplitude=1.2, period=7.0, phase=2.0),
        roll=vessel.Motion(amplitude=8 * deg, period=12.0, phase=0.7),
        pitch=vessel.Motion(amplitude=4 * deg, period=6.5, phase=1.1),
        yaw=vessel.Motion(amplitude=3 * deg, period=20.0, phase=-0.4),
        ramp=ramp,
    )


def central(f, t, h=1e-3):
    """First derivative, fourth order."""
    return (8 * (f(t + h) - f(t - h)) - (f(t + 2 * h) - f(t - 2 * h))) / (12 * h)


def test_every_level_has_the_ports_of_the_crane_foot_in_one_order():
    fixed, harmonic = vessel.Fixed().model(PEDESTAL), rough().model(PEDESTAL)
    names = ["x", "y", "z", "qw", "qx", "qy", "qz"]
    names += [f"foot.{v}{a}" for v in ("w", "al", "a", "v") for a in "xyz"]
    names += ["foot.z", "foot.gx", "foot.gy", "foot.gz"]
    for ship in (fixed, harmonic):
        assert ship.name == "ship"
        assert [v.name for v in ship.outputs] == names
        assert [v.name for v in ship.inputs] == [f"wrench.{v}{a}" for v in "fm" for a in "xyz"]
        assert ship.states == ()


def test_a_fixed_ship_only_weighs():
    at = outputs(vessel.Fixed().model(PEDESTAL))(123.0)
    moving = {name: value for name, value in at.items() if value != 0.0}
    assert moving == {"qw": 1.0, "foot.z": 12.0, "foot.gz": -GRAVITY}


def test_without_amplitude_the_harmonic_ship_is_the_fixed_one():
    fixed, still = (outputs(ship.model(PEDESTAL)) for ship in (vessel.Fixed(), vessel.Harmonic()))
    for t in (0.0, 3.0, 50.0):
        assert still(t) == pytest.approx(fixed(t), abs=1e-15)


@pytest.mark.parametrize("t", [1.3, 5.0, 9.7, 33.3])
def test_foot_motion_is_the_derivative_of_the_pose_while_growing_and_after(t):
    at = outputs(rough().model(PEDESTAL))

    def position(t):
        origin, rotation = pose(at(t))
        return origin + rotation @ PEDESTAL

    _, rotation = pose(at(t))
    velocity = central(position, t)
    spin = rotation.T @ central(lambda t: pose(at(t))[1], t)
    np.testing.assert_allclose(vector(at(t), "v"), rotation.T @ velocity, atol=1e-9)
    np.testing.assert_allclose(vector(at(t), "w"), [spin[2, 1], spin[0, 2], spin[1, 0]], atol=1e-9)
    np.testing.assert_allclose(vector(at(t), "al"), central(lambda t: vector(at(t), "w"), t), atol=1e-9)
    earth = central(lambda t: pose(at(t))[1] @ vector(at(t), "v"), t)
    np.testing.assert_allclose(vector(at(t), "a"), rotation.T @ earth, atol=1e-9)
    np.testing.assert_allclose(vector(at(t), "g"), rotation.T @ [0, 0, -GRAVITY], atol=1e-12)
    assert at(t)["foot.z"] == pytest.approx(position(t)[2], abs=1e-12)
    np.testing.assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-14)


def test_two_points_of_a_rigid_ship_differ_by_the_rigid_body_identity():
    other = (35.0, -4.0, 3.0)
    arm = np.subtract(other, PEDESTAL)
    one, two = (outputs(rough().model(p))(27.0) for p in (PEDESTAL, other))
    w, alpha = vector(one, "w"), vector(one, "al")
    np.testing.assert_allclose(vector(two, "v"), vector(one, "v") + np.cross(w, arm), atol=1e-12)
    expected = vector(one, "a") + np.cross(alpha, arm) + np.cross(w, np.cross(w, arm))
    np.testing.assert_allclose(vector(two, "a"), expected, atol=1e-12)
    for name in ("w", "al", "g"):
        np.testing.assert_array_equal(vector(one, name), vector(two, name))


def test_pure_heave_follows_its_closed_form():
    at = outputs(vessel.Harmonic(heave=vessel.Motion(amplitude=1.5, period=8.0, phase=0.4), ramp=0.0).model(PEDESTAL))
    omega = 2 * math.pi / 8.0
    for t in (0.0, 0.1, 5.0):
        angle = omega * t + 0.4
        assert at(t)["foot.z"] == pytest.approx(12.0 + 1.5 * math.cos(angle))
        np.testing.assert_allclose(vector(at(t), "v"), [0, 0, -1.5 * omega * math.sin(angle)], atol=1e-14)
        np.testing.assert_allclose(vector(at(t), "a"), [0, 0, -1.5 * omega**2 * math.cos(angle)], atol=1e-14)
        assert not vector(at(t), "w").any()


def test_pure_roll_raises_port_and_follows_its_closed_form():
    at = outputs(vessel.Harmonic(roll=vessel.Motion(amplitude=0.2, period=12.0), ramp=0.0).model(PEDESTAL))
    omega, t = 2 * math.pi / 12.0, 1.0
    roll, rate, acceleration = (
        0.2 * math.cos(omega * t),
        -0.2 * omega * math.sin(omega * t),
        -0.2 * omega**2 * math.cos(omega * t),
    )
    assert at(t)["foot.z"] == pytest.approx(12 * math.cos(roll) + 7 * math.sin(roll))
    np.testing.assert_allclose(vector(at(t), "w"), [rate, 0, 0], atol=1e-15)
    np.testing.assert_allclose(vector(at(t), "v"), [0, -12 * rate, 7 * rate], atol=1e-14)
    expected = [0, -12 * acceleration - 7 * rate**2, 7 * acceleration - 12 * rate**2]
    np.testing.assert_allclose(vector(at(t), "a"), expected, atol=1e-14)
    gravity = [0, -GRAVITY * math.sin(roll), -GRAVITY * math.cos(roll)]
    np.testing.assert_allclose(vector(at(t), "g"), gravity, atol=1e-14)


def test_positive_pitch_lowers_the_bow_and_positive_yaw_turns_to_port():
    bow = (40.0, 0.0, 0.0)
    pitched = outputs(vessel.Harmonic(pitch=vessel.Motion(amplitude=0.1), ramp=0.0).model(bow))(0.0)
    assert pitched["foot.z"] == pytest.approx(-40 * math.sin(0.1))
    yawed = outputs(vessel.Harmonic(yaw=vessel.Motion(amplitude=0.1), ramp=0.0).model(bow))(0.0)
    assert (pose(yawed)[1] @ bow)[1] > 0


def test_the_motion_starts_from_rest_and_its_acceleration_never_jumps():
    at = outputs(rough(ramp=10.0).model(PEDESTAL))
    start = at(0.0)
    for name in ("w", "al", "a", "v"):
        assert not vector(start, name).any()
    assert start["foot.z"] == 12.0
    for t in (0.0, 10.0):
        for name in VECTORS:
            np.testing.assert_allclose(vector(at(t - 1e-7), name), vector(at(t + 1e-7), name), atol=1e-6)
    full = outputs(rough(ramp=0.0).model(PEDESTAL))
    assert at(10.0) == pytest.approx(full(10.0), abs=1e-12)
    assert at(47.0) == pytest.approx(full(47.0), abs=1e-12)


def test_amplitudes_are_parameters_of_the_model():
    ship = rough(ramp=0.0).model(PEDESTAL)
    assert [v.name for v in ship.parameters][:3] == ["surge.amplitude", "surge.period", "surge.phase"]
    assert outputs(ship)(0.0)["z"] == pytest.approx(1.2 * math.cos(2.0))
    assert outputs(ship, heave_amplitude=0.5)(0.0)["z"] == pytest.approx(0.5 * math.cos(2.0))


def test_the_observables_are_the_angles():
    ship = rough(ramp=0.0).model(PEDESTAL)
    function = ca.Function("ship", [ship.t, ship.p], [ship.obs])
    angles = np.asarray(function(0.0, [v.start for v in ship.parameters])).ravel()
    expected = [8 * deg * math.cos(0.7), 4 * deg * math.cos(1.1), 3 * deg * math.cos(-0.4)]
    np.testing.assert_allclose(angles, expected, atol=1e-15)


SHIP = {"length": 90.0, "beam": 20.0, "draught": 6.5}


@pytest.mark.parametrize("direction", [0.0, 60 * deg, 150 * deg, -90 * deg])
def test_in_a_long_wave_the_ship_lies_on_the_water(direction):
    height, period, phase, ramp = 4.0, 55.0, 0.6, 0.0
    wave = ocean.regular(height, period, direction, phase)
    ship = vessel.Harmonic.following(height, period, direction, phase, **SHIP, ramp=ramp)
    at = outputs(ship.model((0.0, 0.0, 0.0)))
    for t in (0.0, 8.0, 21.0):
        origin, rotation = pose(at(t))
        assert origin[2] == pytest.approx(float(wave.elevation(0, 0, t)), abs=0.02 * height)
        normal = np.array(
            [
                -float(central(lambda x, t=t: wave.elevation(x, 0, t), 0.0)),
                -float(central(lambda y, t=t: wave.elevation(0, y, t), 0.0)),
                1.0,
            ]
        )
        slope = float(wave.k[0]) * height / 2
        np.testing.assert_allclose(rotation[:, 2][:2], normal[:2], atol=0.03 * slope)


def test_in_a_long_wave_the_ship_drifts_with_the_orbits_of_the_water():
    ship = vessel.Harmonic.following(4.0, 55.0, 0.0, **SHIP, ramp=0.0)
    at = outputs(ship.model((0.0, 0.0, 0.0)))
    # under a crest the water moves with the wave
    assert at(0.0)["foot.vx"] > 0.9 * 2.0 * 2 * math.pi / 55.0


def test_following_is_the_mean_of_the_wave_over_the_waterplane():
    height, period, direction = 2.0, 8.0, 35 * deg
    wave = ocean.regular(height, period, direction)
    ship = vessel.Harmonic.following(height, period, direction, **SHIP)
    x, y = (np.arange(-0.5 + 1 / 800, 0.5, 1 / 400) * size for size in (90.0, 20.0))
    decay = math.exp(-float(wave.k[0]) * 6.5)
    crest, quarter = (wave.elevation_grid(x, y, t) * decay for t in (0.0, period / 4))
    assert ship.heave.amplitude == pytest.approx(crest.mean(), rel=1e-4)
    assert -ship.pitch.amplitude == pytest.approx((quarter * x[:, None]).mean() / (x**2).mean(), rel=1e-4)
    assert ship.roll.amplitude == pytest.approx((quarter * y).mean() / (y**2).mean(), rel=1e-4)
    assert ship.yaw.amplitude == 0.0


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"roll": vessel.Motion(amplitude=5.0)}, r"roll.amplitude: is too large \[rad\] .*Did you mean 5 deg?"),
        ({"heave": vessel.Motion(amplitude=math.nan)}, "heave.amplitude: must be a finite number"),
        ({"heave": vessel.Motion(period=0.0)}, r"heave.period: must be positive \[s\]"),
        ({"sway": vessel.Motion(phase=math.inf)}, "sway.phase: must be a finite number"),
        ({"ramp": -1.0}, "ramp: must not be negative"),
    ],
)
def test_no_ship_moves_by_wrong_numbers(wrong, message):
    with pytest.raises(ParameterError, match=message):
        vessel.Harmonic(**wrong)


def test_all_that_is_wrong_with_a_motion_is_said_at_once():
    with pytest.raises(ParameterError) as caught:
        vessel.Harmonic(roll=vessel.Motion(amplitude=5.0, period=-1.0), ramp=math.nan)
    assert [problem.path for problem in caught.value.problems] == ["roll.amplitude", "roll.period", "ramp"]


def test_a_foot_needs_three_coordinates_and_a_ship_its_size():
    with pytest.raises(ParameterError, match="pedestal: must be three finite"):
        vessel.Fixed().model((0.0, math.nan, 1.0))
    with pytest.raises(ParameterError, match=r"beam: must be positive \[m\]"):
        vessel.Harmonic.following(2.0, 8.0, length=90.0, beam=0.0, draught=6.5)
    with pytest.raises(ParameterError, match="height: is too steep"):
        vessel.Harmonic.following(9.0, 5.0, **SHIP)
