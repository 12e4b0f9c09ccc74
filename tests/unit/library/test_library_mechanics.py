from math import pi, sqrt

import pytest

from seacrane.library import mechanics as mec
from seacrane.units import mm


def test_a_mass_accelerates_by_force_over_mass(law):
    values = law(mec.Mass(mass=2e3, speed=0.5), {"flange.F": 4e3}, through=("flange",))
    assert values["der(speed)"] == pytest.approx(2.0)
    assert values["flange.v"] == 0.5
    assert values["stored_power"] == pytest.approx(4e3 * 0.5)


def test_a_vertical_mass_falls_with_gravity(law):
    values = law(mec.Mass(mass=2e3, gravity=9.81, speed=-1.0), {}, through=("flange",))
    assert values["der(speed)"] == pytest.approx(-9.81)
    assert values["supplied_power"] == pytest.approx(2e3 * 9.81)


def test_an_inertia_accelerates_by_torque_over_inertia(law):
    assert law(mec.Inertia(inertia=5.0), {"flange.T": 20.0}, through=("flange",))["der(speed)"] == pytest.approx(4.0)


@pytest.mark.parametrize(
    ("component", "across", "through", "state"),
    [(mec.SpringDamper, "v", "F", "compression"), (mec.TorsionalSpringDamper, "w", "T", "twist")],
)
def test_spring_and_damper_push_both_ends_apart(law, component, across, through, state):
    part = component(stiffness=1e5, damping=2e3)
    values = law(part, {f"a.{across}": 0.3, f"b.{across}": 0.1}, {state: 0.01})
    assert values[f"a.{through}"] == pytest.approx(1e5 * 0.01 + 2e3 * 0.2)
    assert values[f"b.{through}"] == -values[f"a.{through}"]
    assert values[f"der({state})"] == pytest.approx(0.2)
    assert values["lost_power"] == pytest.approx(2e3 * 0.04)


@pytest.mark.parametrize(
    ("component", "across", "through", "state"),
    [(mec.SpringDamper, "v", "F", "compression"), (mec.TorsionalSpringDamper, "w", "T", "twist")],
)
def test_spring_and_damper_alone_add_up_to_both(law, component, across, through, state):
    speeds = {f"a.{across}": 0.3, f"b.{across}": 0.1}
    both = law(component(stiffness=1e5, damping=2e3, **{state: 0.01}), speeds)
    spring = law(component(level="spring", stiffness=1e5, **{state: 0.01}), speeds)
    damper = law(component(level="damper", damping=2e3), speeds)
    assert spring[f"a.{through}"] == pytest.approx(1e5 * 0.01)
    assert damper[f"a.{through}"] == pytest.approx(2e3 * 0.2)
    for account in (f"a.{through}", f"b.{through}", "stored_power", "lost_power"):
        assert both[account] == pytest.approx(spring[account] + damper[account])
    assert f"der({state})" not in damper
    assert law(component(stiffness=1e5, damping=0.0, **{state: 0.01}), speeds) == pytest.approx(spring)


def test_bearing_friction_opposes_the_speed(law):
    friction = mec.RotationalFriction(viscous=100.0, coulomb=5e3, friction_speed=1e-4)
    for w in (-0.5, 0.5):
        assert law(friction, {"flange.w": w})["flange.T"] == pytest.approx(100 * w + 5e3 * (1 if w > 0 else -1))


def test_a_gear_divides_speed_and_multiplies_torque(law):
    values = law(mec.Gear(reduction=100.0), {"a.T": 30.0, "b.w": 0.2}, through=("a",))
    assert values["a.w"] == pytest.approx(20.0)
    assert values["b.T"] == pytest.approx(-3000.0)


# ---------------------------------------------------------------- drum
def test_the_drum_turns_pull_into_torque_and_speed_into_rope_speed(law):
    values = law(mec.WinchDrum(radius=0.6), {"shaft.w": 2.0, "rope.F": -50e3}, through=("rope",))
    assert values["rope.v"] == pytest.approx(1.2)
    assert values["shaft.T"] == pytest.approx(30e3)
    assert values["pull"] == 50e3


def layered(**changes):
    given = {"radius": 0.6, "rope_diameter": 76 * mm, "width": 1.8, "level": "layers"}
    return mec.WinchDrum(**(given | changes))


def test_the_wound_rope_fills_the_volume_between_core_and_running_radius(law):
    for length in (0.0, 50.0, 400.0):
        radius = law(layered(wound=length), through=("rope",))["radius_now"]
        assert pi * (radius**2 - 0.6**2) * 1.8 == pytest.approx(length * (76 * mm) ** 2, abs=1e-12)


def test_one_full_layer_raises_the_radius_by_about_one_rope_diameter(law):
    """A layer at running radius 0.6 + d/2 has width/d turns of 2 pi (0.6 + d/2) each."""
    d = 76 * mm
    turns = 1.8 / d
    radius = law(layered(wound=turns * 2 * pi * (0.6 + d / 2)), through=("rope",))["radius_now"]
    assert radius == pytest.approx(0.6 + d, rel=1e-12)


def test_drum_levels_agree_on_an_empty_drum(law):
    given = {"shaft.w": 2.0, "rope.F": -50e3}
    layers = law(layered(wound=0.0), given, through=("rope",))
    constant = law(mec.WinchDrum(radius=0.6, level="constant-radius"), given, through=("rope",))
    assert layers["rope.v"] == pytest.approx(constant["rope.v"])
    assert layers["shaft.T"] == pytest.approx(constant["shaft.T"])


def test_hoisting_winds_rope_onto_the_drum(law):
    values = law(layered(wound=100.0), {"shaft.w": 1.0}, through=("rope",))
    assert values["der(wound)"] == values["rope.v"] == pytest.approx(sqrt(0.36 + 100 * 0.076**2 / (pi * 1.8)))


# ---------------------------------------------------------------- boundaries
def test_a_motion_input_moves_its_flange_with_the_partner(law):
    boundary = mec.MotionInput(position=2.0)
    values = law(boundary, {"v": 0.3, "x": 2.0, "flange.F": 80e3}, through=("flange",))
    assert values["flange.v"] == 0.3


def test_the_force_reported_is_what_pushes_the_partner_along_its_motion(law):
    """A cylinder that pushes the flange with 80 kN while both move along +v does work on the partner."""
    values = law(mec.MotionInput(), {"v": 0.3, "flange.F": 80e3}, through=("flange",))
    assert values["F"] == 80e3
    assert values["der(work_done)"] == pytest.approx(24e3)
    assert values["supplied_power"] == pytest.approx(-24e3)


def test_a_motion_input_pulls_its_own_position_to_the_partners(law):
    boundary = mec.MotionInput(position=2.0, correction=5.0)
    ahead = law(boundary, {"v": 0.3, "x": 2.01}, through=("flange",))
    assert ahead["flange.v"] == ahead["der(position)"] == pytest.approx(0.35)


def test_a_speed_input_turns_its_flange_and_reports_the_torque(law):
    values = law(mec.SpeedInput(), {"w": 2.0, "flange.T": 5e3}, {"work_done": 7.0}, through=("flange",))
    assert values["flange.w"] == 2.0
    assert values["T"] == 5e3
    assert values["der(work_done)"] == pytest.approx(10e3)
    assert values["work"] == 7.0


def test_force_and_torque_inputs_push_the_drive(law):
    force = law(mec.ForceInput(position=1.0), {"F": -40e3, "flange.v": 0.2})
    assert force["flange.F"] == 40e3
    assert (force["v"], force["x"]) == (0.2, 1.0)
    assert force["der(work_done)"] == pytest.approx(8e3)
    torque = law(mec.TorqueInput(), {"T": 500.0, "flange.w": 3.0})
    assert torque["flange.T"] == -500.0
    assert torque["w"] == 3.0
