"""Motors by efficiency and of variable stroke, single-acting cylinders, cushions, ropes and stops."""

from math import pi, sqrt

import numpy as np
import pytest

from seacrane.errors import ParameterError
from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mec
from seacrane.model import Diagram, simulate
from seacrane.units import GRAVITY, bar, cm3_rev, mm, rpm

D = 250 * cm3_rev
RATED = {"rated_pressure": 280 * bar, "rated_speed": 1500 * rpm}


# ---------------------------------------------------------------- motors
def test_a_motor_has_its_efficiencies_at_the_rated_point(law):
    motor = hyd.HydraulicMotor(
        level="efficiency", displacement=D, volumetric_efficiency=0.96, mechanical_efficiency=0.92, **RATED
    )
    values = law(motor, {"a.p": 280 * bar, "shaft.w": 1500 * rpm})
    assert values["a.q"] == pytest.approx(D * 1500 * rpm / 0.96)
    assert values["torque"] == pytest.approx(0.92 * D * 280 * bar, rel=1e-5)
    power_in, power_out = values["a.q"] * 280 * bar, values["torque"] * 1500 * rpm
    assert power_out / power_in == pytest.approx(0.96 * 0.92, rel=1e-5)
    assert values["lost_power"] == pytest.approx(power_in - power_out)


def test_a_motor_driven_by_its_load_takes_more_torque_than_it_gives_pressure(law):
    motor = hyd.HydraulicMotor(level="efficiency", displacement=D, mechanical_efficiency=0.92, **RATED)
    values = law(motor, {"b.p": 100 * bar, "shaft.w": 1000 * rpm})
    assert values["torque"] == pytest.approx(-1.08 * D * 100 * bar, rel=1e-4)


def test_motor_levels_agree_without_losses(law):
    given = {"a.p": 200 * bar, "b.p": 20 * bar, "shaft.w": 50.0}
    ideal = law(hyd.HydraulicMotor(displacement=D), given)
    perfect = law(
        hyd.HydraulicMotor(
            level="efficiency", displacement=D, volumetric_efficiency=1.0, mechanical_efficiency=1.0, **RATED
        ),
        given,
    )
    for name in ("a.q", "b.q", "shaft.T"):
        assert perfect[name] == pytest.approx(ideal[name])


@pytest.mark.parametrize(("signal", "stroke"), [(0.5, 0.5), (1.5, 1.0), (-0.3, -0.3), (-2.0, -1.0), (0.0, 0.0)])
def test_a_variable_motor_is_a_fixed_one_of_the_displacement_set(law, signal, stroke):
    values = law(hyd.VariableHydraulicMotor(displacement=D), {"a.p": 200 * bar, "shaft.w": 50.0, "r": signal})
    assert values["a.q"] == pytest.approx(stroke * D * 50.0)
    assert values["torque"] == pytest.approx(stroke * D * 200 * bar)


@pytest.mark.parametrize(("level", "extra"), [("friction", {"coulomb_friction": 50.0}), ("efficiency", RATED)])
def test_a_variable_motor_at_full_stroke_is_the_fixed_motor(law, level, extra):
    given = {"a.p": 200 * bar, "shaft.w": 50.0}
    variable = law(hyd.VariableHydraulicMotor(level=level, displacement=D, **extra), given | {"r": 1.0})
    fixed = law(hyd.HydraulicMotor(level=level, displacement=D, **extra), given)
    assert variable["torque"] == fixed["torque"]
    assert variable["a.q"] == fixed["a.q"]


def test_a_motor_of_one_direction_does_not_stroke_below_its_least(law):
    motor = hyd.VariableHydraulicMotor(displacement=D, least_stroke=0.3)
    assert law(motor, {"a.p": 100 * bar, "r": 0.0})["torque"] == pytest.approx(0.3 * D * 100 * bar)


# ---------------------------------------------------------------- single-acting cylinder
BORE = 200 * mm
A = pi / 4 * BORE**2


def plunger(level="extended", **changes):
    return hyd.SingleActingCylinder(**({"bore": BORE, "stroke": 2.0, "extension": 0.8, "level": level} | changes))


def test_a_plunger_pushes_with_pressure_times_area(law):
    simple = law(plunger("simplified", count=2), {"a.p": 100 * bar, "rod.v": 0.1})
    assert simple["force"] == pytest.approx(2 * 100 * bar * A)
    assert simple["a.q"] == pytest.approx(2 * A * 0.1)
    extended = law(plunger(count=2), {}, {"pressure": 100 * bar}, through=("a",))
    assert extended["force"] == pytest.approx(simple["force"])


def test_plunger_levels_agree_on_the_flow_of_a_steady_speed(law):
    """The flow that keeps the pressure of the extended level is the flow of the simplified one."""
    flow = law(plunger("simplified"), {"rod.v": 0.1})["a.q"]
    values = law(plunger(), {"rod.v": 0.1, "a.q": flow}, {"pressure": 100 * bar}, through=("a",))
    assert values["der(pressure)"] == pytest.approx(0.0, abs=1.0)


def test_a_mass_on_a_locked_plunger_swings_at_the_closed_form_frequency():
    """w = sqrt(beta A / ((h + x) m))."""
    mass = 20e3
    diagram = Diagram("locked")
    cylinder = diagram.add("cylinder", plunger(pressure=mass * GRAVITY / A))
    load = diagram.add("load", mec.Mass(level="vertical", mass=mass, speed=1e-3))
    plug = diagram.add("plug", hyd.Plug())
    diagram.connect(cylinder.a, plug.a)
    diagram.connect(cylinder.rod, load.flange)
    run = simulate(diagram, 1.0, every=2e-4, tolerance=1e-9)
    speed = run["load.speed"]
    rising = np.flatnonzero((speed[:-1] < 0) & (speed[1:] >= 0))
    crossing = run.time[rising] - speed[rising] * 2e-4 / (speed[rising + 1] - speed[rising])
    expected = sqrt(1.2e9 * A / (0.83 * mass))
    assert 2 * pi / np.diff(crossing).mean() == pytest.approx(expected, rel=5e-3)


def test_a_plunger_rests_on_its_end_stop(law):
    resting = law(plunger(stop_stiffness=1e8), {}, {"extension": -5 * mm}, through=("a",))
    assert resting["force"] == pytest.approx(5e5)


def test_a_plunger_that_starts_beyond_its_stroke_is_refused():
    with pytest.raises(ParameterError) as caught:
        plunger(extension=2.5)
    assert str(caught.value) == "SingleActingCylinder(level='extended').extension: 2.5 m must not be above stroke = 2 m"


# ---------------------------------------------------------------- cushion
def port_flow(law, x, at_port, inside, **cushion):
    cylinder = hyd.DoubleActingCylinder(
        bore=BORE, rod=140 * mm, stroke=1.0, cushion_length=50 * mm, level="extended", **cushion
    )
    return law(cylinder, {"b.p": at_port}, {"pressure_b": inside, "extension": x})["b.q"]


def test_a_cushion_throttles_outflow_over_the_end_of_the_stroke(law):
    free = port_flow(law, 0.5, 0.0, 100 * bar)
    for x, share in ((0.5, 1.0), (0.95, 1.0), (0.975, 0.55), (1.0, 0.1), (1.01, 0.1)):
        assert port_flow(law, x, 0.0, 100 * bar, cushion_opening=0.1) == pytest.approx(share * free, rel=1e-4)
        assert port_flow(law, x, 0.0, 100 * bar) == pytest.approx(free)


def test_oil_flows_freely_into_a_cushioned_end(law):
    free = port_flow(law, 0.5, 100 * bar, 0.0)
    assert port_flow(law, 1.0, 100 * bar, 0.0, cushion_opening=0.1) == pytest.approx(free, rel=1e-4)


# ---------------------------------------------------------------- ropes and stops
def test_a_rope_pulls_but_does_not_push(law):
    rope = mec.RopeSpring(stiffness=1e6, damping=1e4)
    tight = law(rope, {"b.v": 0.2}, {"stretch": 0.05})
    assert tight["pull"] == pytest.approx(1e6 * 0.05 + 1e4 * 0.2)
    assert tight["a.F"] == -tight["b.F"] == -tight["pull"]
    assert law(rope, {"b.v": 0.2}, {"stretch": -0.01})["pull"] == 0.0
    assert law(rope, {"b.v": -100.0}, {"stretch": 0.05})["pull"] == 0.0


def test_a_tight_rope_is_a_spring_and_damper(law):
    given = {"a.v": 0.1, "b.v": 0.3}
    rope = law(mec.RopeSpring(stiffness=1e6, damping=1e4), given, {"stretch": 0.05})
    spring = law(mec.SpringDamper(stiffness=1e6, damping=1e4), given, {"compression": -0.05})
    assert rope["a.F"] == pytest.approx(spring["a.F"])


def test_a_mass_thrown_on_a_stop_comes_back_with_its_energy_and_is_not_held():
    diagram = Diagram("bounce")
    mass = diagram.add("mass", mec.Mass(mass=100.0, speed=1.0))
    stop = diagram.add("stop", mec.EndStop(stiffness=1e6, damping=0.0, depth=-0.1))
    wall = diagram.add("wall", mec.Mass(mass=1e9))
    diagram.connect(mass.flange, stop.a)
    diagram.connect(stop.b, wall.flange)
    run = simulate(diagram, 0.5, every=1e-3, tolerance=1e-9)
    assert run["mass.speed"][-1] == pytest.approx(-1.0, rel=1e-4)
    assert run["stop.depth"].max() == pytest.approx(1.0 * sqrt(100 / 1e6), rel=1e-3)
    assert run["stop.a.F"].min() >= 0.0


def test_a_vertical_mass_falls_from_its_height():
    diagram = Diagram("falling")
    mass = diagram.add("mass", mec.Mass(level="vertical", mass=50.0, height=10.0))
    push = diagram.add("push", mec.ForceInput())
    diagram.connect(mass.flange, push.flange)
    diagram.expose(F=push.F)
    run = simulate(diagram, 1.0, inputs={"F": 0.0})
    assert run["mass.height"] == pytest.approx(10.0 - GRAVITY / 2 * run.time**2)


def test_the_levels_of_a_mass_agree_on_a_slope_that_stands_upright(law):
    given = {"flange.F": 800.0}
    upright = law(mec.Mass(level="horizontal", mass=50.0, gravity=GRAVITY), given, through=("flange",))
    vertical = law(mec.Mass(level="vertical", mass=50.0), given, through=("flange",))
    assert vertical["der(speed)"] == upright["der(speed)"] == pytest.approx(800 / 50 - GRAVITY)
