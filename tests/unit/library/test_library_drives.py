"""Small circuits run in time: what an engineer expects a cylinder drive to do."""

from math import pi, sqrt

import numpy as np
import pytest

from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mec
from seacrane.library import signals as sig
from seacrane.model import Diagram, simulate
from seacrane.model.native import build
from seacrane.units import GRAVITY, bar, l, l_min, mm

BORE, ROD, STROKE = 280 * mm, 200 * mm, 1.4
A, B = pi / 4 * BORE**2, pi / 4 * (BORE**2 - ROD**2)
LOAD = 20e3
SUPPLY = 210 * bar
HOLDING = LOAD * GRAVITY / A
"""Piston-side pressure that carries the load alone."""


def lifting_drive(level="extended", **cylinder):
    """Pump, 4/3 valve, counterbalance valve on the piston side, cylinder under a hanging mass."""
    drive = Diagram("lifting")
    pump = drive.add("pump", hyd.ConstantPressurePump(pressure=SUPPLY))
    tank = drive.add("tank", hyd.Tank())
    valve = drive.add(
        "valve",
        hyd.DirectionalValve43(flow=400 * l_min, at=35 * bar, float_centre=0.1, level="dynamic", natural_frequency=60),
    )
    counterbalance = drive.add(
        "counterbalance",
        hyd.CounterbalanceValve(flow=400 * l_min, at=10 * bar, crack=1.3 * HOLDING, full=2 * HOLDING, ratio=3.0),
    )
    line_a = drive.add("line_a", hyd.ControlVolume(volume=2 * l))
    line_b = drive.add("line_b", hyd.ControlVolume(volume=2 * l))
    hose = drive.add("hose", hyd.ControlVolume(volume=1 * l, pressure=HOLDING))
    given = {"bore": BORE, "rod": ROD, "stroke": STROKE, "extension": 0.7, "level": level}
    if level == "extended":
        given |= {"pressure_a": HOLDING, "viscous_friction": 5e4}
    cyl = drive.add("cylinder", hyd.DoubleActingCylinder(**(given | cylinder)))
    load = drive.add("load", mec.Mass(mass=LOAD, gravity=GRAVITY))
    drive.connect(pump.p, valve.p)
    drive.connect(valve.a, line_a.a, counterbalance.a)
    drive.connect(counterbalance.b, hose.a, cyl.a)
    drive.connect(valve.b, line_b.a, cyl.b, counterbalance.pilot)
    for name, line in (("filling_a", line_a), ("filling_b", line_b)):
        filling = drive.add(name, hyd.AnticavitationValve(flow=400 * l_min, at=0.5 * bar))
        drive.connect(filling.t, tank.p)
        drive.connect(filling.a, line.a)
    drive.connect(valve.t, tank.p)
    drive.connect(cyl.rod, load.flange)
    drive.expose(spool=valve.x)
    return drive


@pytest.fixture(scope="module")
def extended():
    return build(lifting_drive().compile())


def test_a_closed_valve_holds_the_load(extended):
    run = simulate(extended, 10.0, every=0.1, inputs={"spool": 0.0})
    assert run["cylinder.extension"][-1] == pytest.approx(0.7, abs=0.2 * mm)
    assert run["cylinder.pressure_a"][-1] == pytest.approx(HOLDING, rel=1e-2)
    assert run["line_b.pressure"][-1] < 1 * bar


@pytest.mark.parametrize("spool", [0.5, 1.0])
def test_lifting_settles_where_the_flow_balances_the_pressures(extended, spool):
    """Edges, counterbalance valve and ports are orifices in series: the speed follows from one force balance."""
    run = simulate(extended, 2.0, every=0.02, inputs={"spool": spool})
    middle = (run.time > 0.8) & (run["cylinder.extension"] < 1.3)
    speed = run["load.speed"][middle][-1]
    opening = (spool - 0.05) / 0.95
    edge = 400 * l_min * opening / sqrt(35 * bar)
    beside_check = run["counterbalance.relief_opening"][middle][-1]
    check = 400 * l_min * (1 + beside_check) / sqrt(10 * bar)
    port = 0.7 * pi / 4 * (32 * mm) ** 2 * sqrt(2 / 870)
    resist_a = sum((A / c) ** 2 for c in (edge, check, port))
    resist_b = sum((B / c) ** 2 for c in (edge, port))
    # (SUPPLY - resist_a v^2) A - resist_b v^2 B - 5e4 v - m g = 0
    c2, c1, c0 = resist_a * A + resist_b * B, 5e4, LOAD * GRAVITY - SUPPLY * A
    expected = (-c1 + sqrt(c1**2 - 4 * c2 * c0)) / (2 * c2)
    assert speed == pytest.approx(expected, rel=0.01)


def test_the_load_does_not_run_away_when_it_is_lowered(extended):
    """The counterbalance valve lets down no more oil than the valve feeds to the other side."""
    run = simulate(extended, 2.0, every=0.02, inputs={"spool": -1.0})
    settled = run.time > 1.0
    fed = -run["valve.b.q"][settled] / B
    assert run["load.speed"][settled] == pytest.approx(-fed, rel=1e-2)
    assert run["load.speed"].min() > -2 * fed[-1]
    assert run["cylinder.extension"][-1] < 0.6


def test_no_line_is_sucked_below_vacuum(extended):
    times = np.array([0.0, 1.0, 1.001, 2.0, 2.001, 3.0])
    spool = np.array([1.0, 1.0, -1.0, -1.0, 1.0, 1.0])
    run = simulate(extended, 4.0, every=0.005, inputs={"spool": (times, spool)}, linear=True)
    for pressure in ("cylinder.pressure_a", "cylinder.pressure_b", "line_a.pressure", "line_b.pressure"):
        assert run[pressure].min() > -1 * bar


def test_at_the_end_stop_the_piston_rests_and_the_pressures_go_to_supply_and_tank(extended):
    run = simulate(extended, 8.0, every=0.02, inputs={"spool": 1.0})
    assert run["load.speed"][-1] == pytest.approx(0.0, abs=1e-3)
    assert run["cylinder.pressure_a"][-1] == pytest.approx(SUPPLY, rel=0.01)
    assert run["cylinder.pressure_b"][-1] == pytest.approx(0.0, abs=1 * bar)
    beyond = (SUPPLY * A - LOAD * GRAVITY) / 2e8
    assert run["cylinder.extension"][-1] == pytest.approx(STROKE + beyond, abs=0.1 * mm)


def test_both_levels_of_the_cylinder_lift_alike_with_stiff_oil_and_wide_ports():
    spool = {"spool": (np.array([0.0, 0.2, 0.4, 1.5]), np.array([0.0, 0.0, 0.6, 0.6]))}
    simple = simulate(lifting_drive("simplified"), 1.5, every=0.01, inputs=spool, linear=True)
    errors = []
    for bulk, port in ((1.2e9, 32 * mm), (1.2e11, 300 * mm)):
        drive = lifting_drive(bulk_modulus=bulk, port_diameter=port, leakage=0.0, viscous_friction=0.0)
        run = simulate(drive, 1.5, every=0.01, inputs=spool, linear=True)
        errors.append(abs(run["cylinder.extension"] - simple["cylinder.extension"]).max())
    assert errors[0] > 10 * errors[1]
    assert errors[1] < 1 * mm


def test_a_mass_on_locked_oil_swings_at_the_closed_form_frequency():
    """Both columns act as springs side by side: k = beta (A / (h + x) + B / (h + s - x))."""
    diagram = Diagram("locked")
    cyl = diagram.add(
        "cylinder",
        hyd.DoubleActingCylinder(
            bore=BORE,
            rod=ROD,
            stroke=STROKE,
            level="extended",
            extension=0.5,
            pressure_a=100 * bar,
            pressure_b=100 * bar * A / B,
            leakage=0.0,
        ),
    )
    load = diagram.add("load", mec.Mass(mass=LOAD, speed=1e-3))
    for name in ("a", "b"):
        plug = diagram.add(f"plug_{name}", hyd.Plug())
        diagram.connect(getattr(cyl, name), plug.a)
    diagram.connect(cyl.rod, load.flange)
    run = simulate(diagram, 0.5, every=1e-4, tolerance=1e-8)
    stiffness = 1.2e9 * (A / 0.53 + B / 0.93)
    speed = run["load.speed"]
    rising = np.flatnonzero((speed[:-1] < 0) & (speed[1:] >= 0))
    crossing = run.time[rising] - speed[rising] * 1e-4 / (speed[rising + 1] - speed[rising])
    period = np.diff(crossing).mean()
    assert 2 * pi / period == pytest.approx(sqrt(stiffness / LOAD), rel=1e-3)


def test_held_speeds_do_not_let_the_two_positions_drift_apart():
    """A partner that moves as a sine is seen at 10 ms points; with the correction the error does not grow."""
    macro = np.arange(0, 60, 0.01)
    velocity = 0.3 * np.sin(macro) + 0.1 * np.cos(7 * macro)
    position = 1.0 - 0.3 * np.cos(macro) + 0.1 / 7 * np.sin(7 * macro)
    slightly_off = velocity + 1e-3
    errors = {}
    for correction in (0.0, 5.0):
        diagram = Diagram("boundary")
        boundary = diagram.add("boundary", mec.MotionInput(correction=correction, position=0.7))
        spring = diagram.add("spring", mec.SpringDamper(stiffness=1e4, damping=1e3))
        wall = diagram.add("wall", mec.MotionInput())
        zero = diagram.add("zero", sig.Constant(value=0.0, unit="m/s"))
        there = diagram.add("there", sig.Constant(value=0.0, unit="m"))
        diagram.connect(boundary.flange, spring.a)
        diagram.connect(spring.b, wall.flange)
        diagram.connect(zero.y, wall.v)
        diagram.connect(there.y, wall.x)
        diagram.expose(v=boundary.v, x=boundary.x)
        run = simulate(diagram, 59.0, every=0.01, inputs={"v": (macro, slightly_off), "x": (macro, position)})
        errors[correction] = abs(run["boundary.position"] - np.interp(run.time, macro, position))[-100:].max()
    assert errors[0.0] > 0.05
    assert errors[5.0] < 2 * mm


def test_the_motor_and_its_relief_stop_a_load_that_overruns():
    """With both lines shut, cross-port relief brakes a spinning drum with displacement times its setting."""
    diagram = Diagram("braking")
    motor = diagram.add("motor", hyd.HydraulicMotor(displacement=1e-4))
    drum = diagram.add("drum", mec.Inertia(inertia=50.0, speed=20.0))
    lines = {name: diagram.add(f"line_{name}", hyd.ControlVolume(volume=1 * l)) for name in "ab"}
    for one, other in ("ab", "ba"):
        relief = diagram.add(f"relief_{one}", hyd.ReliefValve(crack=200 * bar, full=240 * bar, flow=400 * l_min))
        diagram.connect(relief.a, lines[one].a)
        diagram.connect(relief.b, lines[other].a)
        diagram.connect(getattr(motor, one), lines[one].a)
    diagram.connect(motor.shaft, drum.flange)
    run = simulate(diagram, 1.0, every=0.005)
    assert abs(run["motor.pressure_drop"]).max() < 240 * bar
    braking = run["drum.speed"] > 5
    assert run["motor.torque"][braking][5:].max() < -1e-4 * 200 * bar
    # the relief takes the energy: the drum is slow, swinging on its oil
    assert abs(run["drum.speed"][-1]) < 5
