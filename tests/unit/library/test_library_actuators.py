from math import exp, pi, sqrt

import pytest

from seacrane.errors import ParameterError
from seacrane.library import hydraulics as hyd
from seacrane.units import bar, cm3_rev, l_min, mm, rpm

BORE, ROD = 280 * mm, 200 * mm
A, B = pi / 4 * BORE**2, pi / 4 * (BORE**2 - ROD**2)


def cylinder(level="extended", **changes):
    given = {"bore": BORE, "rod": ROD, "stroke": 1.4, "extension": 0.7, "level": level}
    if level == "extended":
        given |= {"leakage": 0.0, "bulk_modulus": 1.2e9}
    return hyd.DoubleActingCylinder(**(given | changes))


# ---------------------------------------------------------------- cylinder
@pytest.mark.parametrize("count", [1, 2])
@pytest.mark.parametrize("level", ["simplified", "extended"])
def test_static_force_is_pressure_times_area(law, level, count):
    inside = {"pressure_a": 191 * bar, "pressure_b": 12 * bar} if level == "extended" else {}
    values = law(cylinder(level, count=count), {"a.p": 191 * bar, "b.p": 12 * bar}, inside)
    expected = count * (191 * bar * A - 12 * bar * B)
    assert values["force"] == pytest.approx(expected)
    assert values["rod.F"] == pytest.approx(-expected)


@pytest.mark.parametrize("count", [1, 2])
def test_the_simplified_cylinder_takes_area_times_speed(law, count):
    values = law(cylinder("simplified", count=count), {"rod.v": 0.1})
    assert values["a.q"] == pytest.approx(count * A * 0.1)
    assert values["b.q"] == pytest.approx(-count * B * 0.1)
    assert values["der(extension)"] == 0.1


def test_a_locked_chamber_is_a_spring_of_bulk_modulus_times_area_over_height(law):
    at_port = {"a.p": 100 * bar, "b.p": 100 * bar, "rod.v": 0.01}
    values = law(cylinder(dead_length=0.05), at_port, {"pressure_a": 100 * bar, "pressure_b": 100 * bar})
    volume_a, volume_b = A * (0.05 + 0.7), B * (0.05 + 0.7)
    assert values["der(pressure_a)"] / 0.01 == pytest.approx(-1.2e9 * A / volume_a)
    assert values["der(pressure_b)"] / 0.01 == pytest.approx(1.2e9 * B / volume_b)


def test_two_cylinders_draw_twice_the_flow_at_the_same_pressure_rate(law):
    given = {"a.p": 150 * bar}
    one, two = (law(cylinder(count=n), given, {"pressure_a": 100 * bar}) for n in (1, 2))
    assert two["a.q"] == pytest.approx(2 * one["a.q"])
    assert two["der(pressure_a)"] == pytest.approx(one["der(pressure_a)"])


def test_port_flow_is_that_of_an_orifice(law):
    values = law(
        cylinder(port_diameter=25 * mm, discharge=0.6, density=850.0), {"a.p": 150 * bar}, {"pressure_a": 100 * bar}
    )
    assert values["a.q"] == pytest.approx(0.6 * pi / 4 * 0.025**2 * sqrt(2 * 50 * bar / 850), rel=1e-5)


def test_leakage_takes_oil_from_the_high_side_to_the_low_side(law):
    states = {"pressure_a": 200 * bar, "pressure_b": 0.0}
    tight, leaking = (law(cylinder(leakage=g), {"a.p": 200 * bar}, states) for g in (0.0, 1e-11))
    height = 0.03 + 0.7
    lost_a = leaking["der(pressure_a)"] - tight["der(pressure_a)"]
    won_b = leaking["der(pressure_b)"] - tight["der(pressure_b)"]
    assert lost_a == pytest.approx(-1.2e9 / (A * height) * 200 * bar * 1e-11)
    assert won_b == pytest.approx(1.2e9 / (B * height) * 200 * bar * 1e-11)


def test_friction_is_stribeck_at_low_speed_and_viscous_at_high(law):
    rough = cylinder(
        viscous_friction=5e4, coulomb_friction=3e3, static_friction=2e3, stribeck_speed=0.01, friction_speed=1e-4
    )

    def friction(v):
        return -law(rough, {"rod.v": v})["force"]

    assert friction(0.0) == 0.0
    assert friction(0.005) == pytest.approx(5e4 * 0.005 + 3e3 + 2e3 * exp(-0.25), rel=1e-3)
    assert friction(0.2) == pytest.approx(5e4 * 0.2 + 3e3, rel=1e-6)
    assert friction(-0.2) == pytest.approx(-friction(0.2))


@pytest.mark.parametrize("beyond", [2 * mm, 10 * mm])
def test_an_end_stop_is_a_spring_and_a_damper(law, beyond):
    stiff = cylinder(stop_stiffness=1e8, stop_damping=1e6)
    assert law(stiff, {}, {"extension": -beyond})["force"] == pytest.approx(1e8 * beyond)
    assert law(stiff, {}, {"extension": 1.4 + beyond})["force"] == pytest.approx(-1e8 * beyond)
    hitting = law(stiff, {"rod.v": -0.01}, {"extension": -beyond})["force"]
    assert hitting == pytest.approx(1e8 * beyond + 1e6 * 0.01)


def test_an_end_stop_never_pulls(law):
    stiff = cylinder(stop_stiffness=1e8, stop_damping=1e6)
    for v in (-1.0, -0.1, 0.0, 0.1, 1.0, 10.0):
        assert law(stiff, {"rod.v": v}, {"extension": -1 * mm})["force"] >= 0
        assert law(stiff, {"rod.v": v}, {"extension": 1.401})["force"] <= 0
        assert law(stiff, {"rod.v": v}, {"extension": 0.5})["force"] == 0


def test_chambers_keep_their_dead_volume_beyond_the_end(law):
    for x, side in ((-0.02, "a"), (1.42, "b")):
        rate = law(cylinder(), {"rod.v": 0.01}, {"extension": x})[f"der(pressure_{side})"]
        assert abs(rate) == pytest.approx(1.2e9 / 0.03 * 0.01)


def test_levels_agree_when_oil_is_stiff_and_ports_are_wide(law):
    """With oil at its steady pressure the extended law tends to the simplified one as ports open."""
    v, p_a, p_b = 0.2, 150 * bar, 20 * bar
    simple = law(cylinder("simplified"), {"rod.v": v, "a.p": p_a, "b.p": p_b})
    for port, close in ((32 * mm, 0.02), (100 * mm, 2e-3), (400 * mm, 1e-4)):
        extended = cylinder(port_diameter=port, transition_pressure=1e-3, dead_length=0.03)
        coefficient = 0.7 * pi / 4 * port**2 * sqrt(2 / 870)
        # the chamber pressures at which the oil neither gathers nor thins
        inside = {"pressure_a": p_a - (A * v / coefficient) ** 2, "pressure_b": p_b + (B * v / coefficient) ** 2}
        steady = law(extended, {"rod.v": v, "a.p": p_a, "b.p": p_b}, inside)
        assert steady["der(pressure_a)"] == pytest.approx(0.0, abs=1e-6 * 1.2e9)
        assert steady["a.q"] == pytest.approx(simple["a.q"], rel=1e-6)
        assert steady["b.q"] == pytest.approx(simple["b.q"], rel=1e-6)
        assert steady["force"] == pytest.approx(simple["force"], rel=close)


def test_a_rod_as_thick_as_the_piston_is_refused():
    with pytest.raises(ParameterError) as caught:
        cylinder(rod=300 * mm)
    assert "rod: 300 mm must be below bore = 280 mm" in str(caught.value)


def test_a_start_beyond_the_stroke_is_refused():
    with pytest.raises(ParameterError) as caught:
        cylinder(extension=2.0)
    assert "extension: 2 m must not be above stroke = 1.4 m" in str(caught.value)


# ---------------------------------------------------------------- motor
@pytest.mark.parametrize("count", [1, 3])
def test_motor_torque_is_displacement_times_pressure_and_flow_displacement_times_speed(law, count):
    motor = hyd.HydraulicMotor(displacement=500 * cm3_rev, count=count)
    values = law(motor, {"a.p": 210 * bar, "b.p": 10 * bar, "shaft.w": 60 * rpm})
    assert values["shaft.T"] == pytest.approx(-count * 500e-6 / (2 * pi) * 200 * bar)
    assert values["a.q"] == pytest.approx(count * 30 * l_min)
    assert values["b.q"] == -values["a.q"]
    assert values["lost_power"] == 0.0


def test_motor_losses_take_flow_and_torque(law):
    motor = hyd.HydraulicMotor(
        displacement=500 * cm3_rev, leakage=1e-11, viscous_friction=2.0, coulomb_friction=50.0, friction_speed=1e-3
    )
    values = law(motor, {"a.p": 200 * bar, "shaft.w": 10.0})
    assert values["a.q"] == pytest.approx(500 * cm3_rev * 10 + 1e-11 * 200 * bar)
    assert values["torque"] == pytest.approx(500 * cm3_rev * 200 * bar - 2.0 * 10 - 50)
    assert values["lost_power"] == pytest.approx(1e-11 * (200 * bar) ** 2 + 2.0 * 100 + 500)
