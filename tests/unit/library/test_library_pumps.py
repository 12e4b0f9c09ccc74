"""Pumps and the power unit made of them."""

from math import pi

import numpy as np
import pytest

from seacrane.errors import ParameterError
from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mec
from seacrane.model import Diagram, simulate
from seacrane.units import bar, cm3_rev, kW, l_min, mm, rpm

SIZE = {"displacement": 100 * cm3_rev, "speed": 1500 * rpm}
FULL = 150 * l_min


def test_the_levels_of_a_pump_are_chosen_by_name():
    assert hyd.Pump(level="constant-flow", **SIZE) == hyd.ConstantFlowPump(**SIZE)
    assert hyd.Pump(level="constant-pressure", pressure=210 * bar) == hyd.ConstantPressurePump(pressure=210 * bar)


@pytest.mark.parametrize(
    ("pressure", "stroke"), [(0, 1.0), (190, 1.0), (205, 0.5), (207.5, 0.25), (211, 0.0), (300, 0.0)]
)
def test_a_pressure_controlled_pump_strokes_back_near_its_setting(law, pressure, stroke):
    pump = hyd.Pump(level="pressure-controlled", pressure=210 * bar, **SIZE)
    values = law(pump, {"p.p": pressure * bar})
    assert values["p.q"] == pytest.approx(-stroke * FULL, abs=1e-12)
    assert values["stroke"] == pytest.approx(stroke, abs=1e-12)


def test_pressure_control_tends_to_constant_pressure_and_to_constant_flow(law):
    """A steep controller holds its pressure at any flow; far below its setting it is a fixed pump."""
    steep = hyd.Pump(level="pressure-controlled", pressure=210 * bar, full_stroke=0.01 * bar, **SIZE)
    values = law(steep, {"p.p": 209.995 * bar})
    assert values["p.q"] == pytest.approx(-FULL / 2)
    fixed = law(hyd.Pump(level="constant-flow", **SIZE), {"p.p": 50 * bar})
    assert law(steep, {"p.p": 50 * bar})["p.q"] == pytest.approx(fixed["p.q"])


def test_a_variable_pump_follows_its_signal_within_its_stroke(law):
    one_way = hyd.Pump(level="variable-flow", **SIZE)
    over_centre = hyd.Pump(level="variable-flow", least_stroke=-1.0, **SIZE)
    for gain, forward, both in ((0.4, 0.4, 0.4), (2.0, 1.0, 1.0), (-0.5, 0.0, -0.5), (-3.0, 0.0, -1.0)):
        assert law(one_way, {"gain": gain})["p.q"] == pytest.approx(-forward * FULL, abs=1e-15)
        assert law(over_centre, {"gain": gain})["p.q"] == pytest.approx(-both * FULL, abs=1e-15)


# ---------------------------------------------------------------- load sensing
def sensing(**changes):
    return hyd.LoadSensingPump(**({"cut_off": 280 * bar, "margin": 20 * bar, "full_stroke": 4 * bar} | SIZE | changes))


@pytest.mark.parametrize(
    ("load", "pressure", "stroke"), [(100, 118, 0.5), (100, 110, 1.0), (100, 121, 0.0), (0, 18, 0.5), (275, 278, 0.5)]
)
def test_a_load_sensing_pump_keeps_its_margin_up_to_the_cut_off(law, load, pressure, stroke):
    values = law(sensing(), {"ls.p": load * bar, "p.p": pressure * bar})
    assert values["p.q"] == pytest.approx(-stroke * FULL, abs=1e-12)
    assert values["ls.q"] == 0.0


def test_the_swash_plate_follows_with_its_lag(law):
    pump = sensing(level="dynamic", time_constant=0.05)
    values = law(pump, {"ls.p": 100 * bar, "p.p": 118 * bar}, {"swash": 0.1})
    assert values["der(swash)"] == pytest.approx((0.5 - 0.1) / 0.05)
    settled = law(pump, {"ls.p": 100 * bar, "p.p": 118 * bar}, {"swash": 0.5})
    assert settled["p.q"] == pytest.approx(law(sensing(), {"ls.p": 100 * bar, "p.p": 118 * bar})["p.q"])


def test_load_sensing_holds_the_drop_over_an_orifice_whatever_the_load():
    """Flow = orifice at the margin: the same at any load pressure."""
    flows = []
    for load in (50 * bar, 200 * bar):
        diagram = Diagram("sensing")
        pump = diagram.add("pump", sensing(full_stroke=1 * bar))
        line = diagram.add("line", hyd.ControlVolume(volume=1e-3))
        edge = diagram.add("edge", hyd.Orifice(diameter=6 * mm))
        end = diagram.add("end", hyd.ConstantPressurePump(pressure=load))
        diagram.connect(pump.p, line.a, edge.a)
        diagram.connect(edge.b, end.p, pump.ls)
        flows.append(simulate(diagram, 0.5, every=0.01)["edge.a.q"][-1])
    expected = 0.7 * pi / 4 * (6 * mm) ** 2 * (2 * 20 * bar / 870) ** 0.5
    assert flows[0] == pytest.approx(flows[1], rel=1e-6)
    assert flows[0] == pytest.approx(expected, rel=0.03)


# ---------------------------------------------------------------- shaft pump
def on_shaft(**changes):
    given = {"displacement": 100 * cm3_rev, "pressure": 250 * bar, "power_limit": 50 * kW}
    return hyd.ShaftPump(**(given | changes))


def test_a_shaft_pump_turns_torque_into_pressure_and_speed_into_flow(law):
    values = law(on_shaft(), {"p.p": 100 * bar, "s.p": 1 * bar, "shaft.w": 1500 * rpm})
    assert values["p.q"] == pytest.approx(-FULL)
    assert values["s.q"] == pytest.approx(FULL)
    assert values["shaft.T"] == pytest.approx(100 * cm3_rev * 99 * bar)
    assert values["lost_power"] == 0.0


def test_a_shaft_pump_strokes_back_where_its_power_would_be_exceeded(law):
    for pressure in (200, 220, 239):
        values = law(on_shaft(), {"p.p": pressure * bar, "shaft.w": 1500 * rpm})
        unbounded = 100 * cm3_rev * 1500 * rpm * pressure * bar
        assert -values["p.q"] * pressure * bar == pytest.approx(min(unbounded, 50 * kW), rel=2e-3)
    assert law(on_shaft(), {"p.p": 251 * bar, "shaft.w": 1500 * rpm})["p.q"] == pytest.approx(0.0, abs=1e-12)


def test_a_shaft_pump_leaks_and_rubs(law):
    values = law(
        on_shaft(leakage=1e-12, viscous_friction=0.1, coulomb_friction=5.0), {"p.p": 100 * bar, "shaft.w": 1500 * rpm}
    )
    assert values["p.q"] == pytest.approx(-FULL + 1e-5)
    assert values["shaft.T"] == pytest.approx(100 * cm3_rev * 100 * bar + 0.1 * 1500 * rpm + 5.0)


def test_a_control_that_begins_below_zero_pressure_is_refused():
    with pytest.raises(ParameterError) as caught:
        on_shaft(pressure=5 * bar)
    assert str(caught.value) == "ShaftPump.full_stroke: 10 bar must not be above pressure = 5 bar"


# ---------------------------------------------------------------- electric motor and power unit
def test_the_electric_motor_gives_its_breakdown_torque_at_the_breakdown_slip(law):
    motor = mec.ElectricMotor(breakdown_torque=800.0, breakdown_slip=0.2, mains=50.0, pole_pairs=2, inertia=1.0)
    synchronous = 1500 * rpm
    for slip, torque in ((0.2, 800.0), (0.0, 0.0), (0.02, 2 * 800 * 0.1 / 1.01), (1.0, 2 * 800 * 5 / 26)):
        values = law(motor, {}, {"speed": (1 - slip) * synchronous}, through=("shaft",))
        assert values["torque"] == pytest.approx(torque, abs=1e-9)
        assert values["der(speed)"] == pytest.approx(torque, abs=1e-9)
        assert values["lost_power"] == pytest.approx(torque * slip * synchronous, abs=1e-6)


def unit(**changes):
    given = {"displacement": 100 * cm3_rev, "pressure": 250 * bar, "power": 55 * kW, "inertia": 0.6}
    return hyd.power_unit(**(given | changes))


def test_a_power_unit_runs_up_from_standstill_and_then_delivers_what_its_power_allows():
    load = (np.array([0.0, 2.0, 2.5, 4.0]), np.array([0.0, 0.0, 200 * bar, 200 * bar]))
    run = simulate(unit(running=False), 4.0, every=0.005, inputs={"p.p": load}, linear=True)
    synchronous = 1800 * rpm
    assert run["motor.speed"][0] == 0.0
    assert 0.95 * synchronous < run["motor.speed"][-1] < synchronous
    hydraulic = -run["pump.p.q"][-1] * run["manifold.pressure"][-1]
    assert hydraulic == pytest.approx(0.9 * 55 * kW, rel=0.05)
    assert run["p.q"][-1] == pytest.approx(run["pump.p.q"][-1], rel=1e-3)


def test_a_power_unit_idles_at_its_pressure_without_a_consumer():
    run = simulate(unit(), 2.0, every=0.005, inputs={"p.p": 300 * bar})
    assert 240 * bar < run["manifold.pressure"][-1] < 250 * bar
    assert run["p.q"][-1] == pytest.approx(0.0, abs=1e-9)
    assert run["motor.power"][-1] < 0.15 * 55 * kW


def test_the_mains_pay_for_the_oil_the_heat_and_the_flywheel():
    load = (np.array([0.0, 2.0, 2.5, 3.0]), np.array([0.0, 0.0, 150 * bar, 150 * bar]))
    run = simulate(unit(running=False), 3.0, every=0.001, inputs={"p.p": load}, linear=True, tolerance=1e-8)
    parts = ("motor", "pump", "relief", "check", "manifold", "tank")

    def power(kind):
        return sum(run[f"{part}.{kind}_power"] for part in parts if f"{part}.{kind}_power" in run.signals)

    delivered = -run["p.q"] * run["check.b.p"]
    balance = power("supplied") - power("lost") - power("stored") - delivered
    assert np.abs(balance).max() < 1e-6 * np.abs(delivered).max()
    assert power("supplied")[-1] > delivered[-1] > 0.7 * power("supplied")[-1]


def test_a_power_unit_placed_in_a_circuit_feeds_it():
    """A variable motor turns a flywheel, fed by the unit through its outlet: the flow is what the motor takes."""
    circuit = Diagram("circuit")
    supply = circuit.add("supply", unit())
    motor = circuit.add("motor", hyd.VariableHydraulicMotor(displacement=200 * cm3_rev))
    wheel = circuit.add("wheel", mec.Inertia(inertia=2.0))
    bearing = circuit.add("bearing", mec.RotationalFriction(viscous=5.0, coulomb=10.0))
    line = circuit.add("line", hyd.ControlVolume(volume=2e-3))
    tank = circuit.add("tank", hyd.Tank())
    circuit.connect(supply.p, line.a, motor.a)
    circuit.connect(motor.b, tank.p)
    circuit.connect(motor.shaft, wheel.flange, bearing.flange)
    circuit.expose(r=motor.r)
    run = simulate(circuit, 6.0, every=0.01, inputs={"r": 0.5})
    speed = run["wheel.speed"][-1]
    assert run["motor.a.q"][-1] == pytest.approx(0.5 * 200 * cm3_rev * speed)
    assert -run["supply.pump.p.q"][-1] == pytest.approx(run["motor.a.q"][-1], rel=0.02)
    assert run["motor.torque"][-1] == pytest.approx(5.0 * speed + 10.0, rel=0.05)


def test_a_power_unit_without_power_is_refused():
    with pytest.raises(ParameterError) as caught:
        unit(power=0.0)
    assert str(caught.value) == "power_unit: needs power and mains above 0 and at least one pair of poles"
