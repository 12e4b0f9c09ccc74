"""Components that jump: relay, pressure switch and holding brake against closed forms."""

import math

import numpy as np
import pytest

from seacrane.errors import ParameterError, StructureError
from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mec
from seacrane.library import signals as sig
from seacrane.library.hydraulics.fluid import ATMOSPHERE
from seacrane.model import Diagram, ImplicitEuler, RungeKutta4, linearise, simulate
from seacrane.units import bar, l, l_min

SOLVERS = ["rodas4", RungeKutta4(step=1e-3), ImplicitEuler(step=1e-3)]


def times(run, name):
    return [e.time for e in run.events if e.name == name]


# ---------------------------------------------------------------- relay
def test_a_relay_switches_where_its_input_passes_the_limits_and_nowhere_else():
    diagram = Diagram("switching")
    wave = diagram.add("wave", sig.Sine(amplitude=1.0, period=1.0))
    relay = diagram.add("relay", sig.Relay(low=-0.5, high=0.9, on=3.0, off=-3.0))
    diagram.connect(wave.y, relay.u)
    diagram.expose(y=relay.y)
    run = simulate(diagram, 100.0, every=50.0)  # steps as long as they like
    rise, fall = math.asin(0.9) / (2 * math.pi), (math.pi + math.asin(0.5)) / (2 * math.pi)
    assert times(run, "relay.rises") == pytest.approx(np.arange(100) + rise, abs=1e-9)
    assert times(run, "relay.falls") == pytest.approx(np.arange(100) + fall, abs=1e-9)
    assert list(run["y"]) == [-3.0, -3.0, -3.0]
    assert simulate(diagram, 0.5)["y"][-1] == 3.0


def test_a_relay_between_its_limits_stays_as_it_starts():
    for switched in (0, 1):
        diagram = Diagram("waiting")
        relay = diagram.add("relay", sig.Relay(low=1.0, high=2.0, switched=switched, takes="m"))
        diagram.expose(u=relay.u, y=relay.y)
        run = simulate(diagram, 1.0, inputs={"u": 1.5})
        assert set(run["y"]) == {float(switched)}
        assert run.events == ()
        jumping = simulate(diagram, 1.0, inputs={"u": ([0.0, 0.4, 0.6], [1.5, 2.5, 0.5])})
        assert times(jumping, "relay.falls") == [0.6]
        assert times(jumping, "relay.rises") == ([] if switched else [0.4])


def test_limits_the_wrong_way_round_are_refused():
    with pytest.raises(ParameterError, match=r"Relay.high: 1 must be above low = 2"):
        sig.Relay(low=2.0, high=1.0)
    with pytest.raises(ParameterError, match=r"PressureSwitch.high: 100 bar must be above low = 150 bar"):
        hyd.PressureSwitch(low=150 * bar, high=100 * bar)


# ---------------------------------------------------------------- pressure switch
LOW, HIGH, PRECHARGE, VOLUME = 160 * bar, 200 * bar, 120 * bar, 20 * l
PUMPED, DRAWN = 60 * l_min, 15 * l_min


def gas_volume(pressure):
    return VOLUME * (PRECHARGE + ATMOSPHERE) / (pressure + ATMOSPHERE)


def charging():
    """A pump that a switch loads and unloads, an accumulator, and a steady draw of oil."""
    diagram = Diagram("charging")
    pump = diagram.add("pump", hyd.VariableFlowPump(displacement=PUMPED / 150.0, speed=150.0))
    store = diagram.add(
        "store",
        hyd.GasAccumulator(volume=VOLUME, precharge=PRECHARGE, oil=VOLUME - gas_volume(LOW), level="isothermal"),
    )
    switch = diagram.add("switch", hyd.PressureSwitch(low=LOW, high=HIGH))
    draw = diagram.add("draw", hyd.FlowInput())
    diagram.connect(pump.p, store.a, switch.p, draw.p)
    diagram.connect(switch.below, pump.gain)
    diagram.expose(draw=draw.set)
    return diagram


@pytest.mark.parametrize("solver", SOLVERS, ids=["rodas4", "runge-kutta", "implicit-euler"])
def test_a_pressure_switch_loads_and_unloads_the_pump_of_an_accumulator_on_time(solver):
    run = simulate(charging(), 120.0, every=0.5, inputs={"draw": -DRAWN}, solver=solver, tolerance=1e-8)
    useful = gas_volume(LOW) - gas_volume(HIGH)
    filling, emptying = useful / (PUMPED - DRAWN), useful / DRAWN
    count = int(120 // (filling + emptying))
    rises, falls = times(run, "switch.rises"), times(run, "switch.falls")
    cycle = (filling + emptying) * np.arange(count)
    assert count > 5
    assert rises[:count] == pytest.approx(filling + cycle, abs=1e-6)
    assert falls[:count] == pytest.approx(filling + emptying + cycle, abs=1e-6)
    assert run["store.gas_pressure"].max() - ATMOSPHERE <= HIGH * (1 + 1e-9)
    assert run["store.gas_pressure"][2:].min() - ATMOSPHERE >= LOW * (1 - 1e-9)


def test_the_energy_account_of_the_pump_and_its_accumulator_closes_over_the_jumps():
    run = simulate(charging(), 60.0, every=1e-3, inputs={"draw": -DRAWN})
    pump, store, draw = (run[f"{n}_power"] for n in ("pump.supplied", "store.stored", "draw.supplied"))
    assert len(run.events) > 4
    assert pump + draw - store == pytest.approx(np.zeros_like(store), abs=1e-9 * np.abs(pump).max())


# ---------------------------------------------------------------- brake
CAPACITY, LOAD, DISC, DRUM = 5000.0, 3000.0, 2.0, 38.0


def winch(release, until=2.0, *, speed=0.0, every=0.01, **changes):
    """A load torque on a drum with a brake on its shaft."""
    diagram = Diagram("winch")
    given = {"capacity": CAPACITY, "inertia": DISC, "speed": speed}
    brake = diagram.add("brake", mec.HoldingBrake(**(given | changes)))
    drum = diagram.add("drum", mec.Inertia(inertia=DRUM))
    load = diagram.add("load", mec.TorqueInput())
    diagram.connect(brake.shaft, drum.flange, load.flange)
    diagram.expose(release=brake.release, torque=load.T)
    return simulate(diagram, until, every=every, inputs={"release": release, "torque": -LOAD}, tolerance=1e-9)


def test_a_brake_holds_a_load_without_creeping():
    run = winch(0.0, 1000.0, every=100.0)
    assert set(run["drum.flange.w"]) == {0.0}
    assert run["brake.torque"] == pytest.approx(np.full(11, -LOAD))
    assert run.events == ()


def test_a_brake_stops_a_lowering_load_at_the_time_of_the_closed_form_and_keeps_it():
    run = winch(0.0, speed=-10.0)
    stop = 10.0 * (DISC + DRUM) / (CAPACITY - LOAD)
    assert times(run, "brake.sticks") == pytest.approx([stop], rel=1e-9)
    assert run["drum.flange.w"] == pytest.approx(np.minimum(-10.0 + run.time * 10.0 / stop, 0.0), abs=1e-8)
    assert set(run["drum.flange.w"][run.time > stop]) == {0.0}
    lost = run["brake.lost_power"]
    energy = np.sum((lost[1:] + lost[:-1]) / 2 * np.diff(run.time))
    assert energy == pytest.approx(0.5 * (DISC + DRUM) * 100.0 + LOAD * 0.5 * 10.0 * stop, rel=1e-3)


def test_a_released_brake_lets_the_load_fall_freely_and_catches_it_again():
    run = winch(([0.0, 0.5, 1.0], [0.0, 1.0, 0.0]), 4.0)
    fallen = LOAD / (DISC + DRUM) * 0.5
    assert np.interp(1.0, run.time, run["drum.flange.w"]) == pytest.approx(-fallen, rel=1e-9)
    caught = 1.0 + fallen * (DISC + DRUM) / (CAPACITY - LOAD)
    assert [(e.name, e.time) for e in run.events] == [
        ("brake.slips_back", 0.5),
        ("brake.sticks", pytest.approx(caught, rel=1e-9)),
    ]


def test_a_brake_that_is_too_weak_slips_and_one_at_rest_holds_more_than_one_that_slips():
    run = winch(0.0, 1.0, capacity=2000.0)
    assert run["drum.flange.w"][-1] == pytest.approx(-(LOAD - 2000.0) / (DISC + DRUM), rel=1e-9)
    assert winch(0.0, 1.0, capacity=2000.0, static_ratio=1.6)["drum.flange.w"][-1] == 0.0
    easing = winch(([0.0, 1.0], [0.0, 1.0]), 1.0, static_ratio=1.2)  # held samples: opens at the end of the run
    assert easing["drum.flange.w"][-1] == 0.0


def test_a_brake_eased_slowly_slips_when_it_holds_less_than_the_load():
    diagram = Diagram("easing")
    brake = diagram.add("brake", mec.HoldingBrake(capacity=CAPACITY, inertia=DISC, static_ratio=1.2))
    load = diagram.add("load", mec.TorqueInput())
    ramp = diagram.add("ramp", sig.Ramp(slope=0.25))
    diagram.connect(brake.shaft, load.flange)
    diagram.connect(ramp.y, brake.release)
    diagram.expose(torque=load.T)
    run = simulate(diagram, 3.0, inputs={"torque": LOAD})
    assert times(run, "brake.slips") == pytest.approx([(1 - LOAD / (1.2 * CAPACITY)) / 0.25], abs=1e-9)


def test_a_brake_rubbing_on_a_shaft_driven_to_and_fro_dissipates_and_sticks_between():
    diagram = Diagram("shaken")
    brake = diagram.add("brake", mec.HoldingBrake(capacity=100.0, inertia=1.0))
    drive = diagram.add("drive", mec.TorqueInput())
    wave = diagram.add("wave", sig.Sine(amplitude=150.0, period=4.0, unit="N.m"))
    diagram.connect(brake.shaft, drive.flange)
    diagram.connect(wave.y, drive.T)
    diagram.expose(release=brake.release)
    run = simulate(diagram, 39.0 - 0.75, every=1e-3)
    breakaway = 4.0 * math.asin(100 / 150) / (2 * math.pi)
    assert times(run, "brake.slips")[:3] == pytest.approx(breakaway + 4.0 * np.arange(3), abs=1e-7)
    assert len(times(run, "brake.sticks")) == len(times(run, "brake.slips")) + len(times(run, "brake.slips_back"))
    work, lost = (run[name] for name in ("drive.supplied_power", "brake.lost_power"))
    stored = 0.5 * run["brake.speed"] ** 2
    passed = np.concatenate([[0.0], np.cumsum((work - lost)[1:] + (work - lost)[:-1]) * 5e-4])
    assert passed == pytest.approx(stored, abs=1e-3 * stored.max())
    assert lost.min() >= 0.0


def test_a_brake_on_a_shaft_whose_speed_is_given_is_refused_with_the_shaft():
    diagram = Diagram("given")
    brake = diagram.add("brake", mec.HoldingBrake(capacity=100.0, inertia=1.0))
    partner = diagram.add("partner", mec.SpeedInput())
    diagram.connect(brake.shaft, partner.flange)
    diagram.expose(release=brake.release, w=partner.w)
    with pytest.raises(StructureError, match="brake"):
        diagram.compile()


def test_a_held_brake_is_linearised_as_held():
    diagram = Diagram("held")
    brake = diagram.add("brake", mec.HoldingBrake(capacity=100.0, inertia=1.0))
    load = diagram.add("load", mec.TorqueInput())
    diagram.connect(brake.shaft, load.flange)
    diagram.expose(release=brake.release, torque=load.T, w=load.w)
    held = linearise(diagram, inputs={"torque": 50.0}, outputs=["w"])
    slipping = linearise(diagram, inputs={"torque": 150.0}, outputs=["w"])
    i = [v.name for v in held.inputs].index("torque")
    j = [v.name for v in held.states].index("brake.speed")
    assert held.B[j, i] == 0.0
    assert slipping.B[j, i] == 1.0
