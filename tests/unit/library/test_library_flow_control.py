"""Compensator, divider, filter, shuttle, reducing, relief and piloted check valves."""

from math import sqrt

import numpy as np
import pytest

from seacrane.errors import ParameterError
from seacrane.library import hydraulics as hyd
from seacrane.model import Diagram, simulate
from seacrane.units import bar, l_min, mm

FLOW = 100 * l_min


# ---------------------------------------------------------------- compensator
@pytest.mark.parametrize(("metering", "opening"), [(0, 0.9975), (5, 0.5), (9, 0.1), (12, 0.0), (-3, 1.0)])
def test_a_compensator_closes_as_the_metering_drop_comes_up_to_its_setting(law, metering, opening):
    valve = hyd.PressureCompensator(flow=FLOW, setting=10 * bar)
    sensed = {"s.p": 100 * bar, "ls.p": (100 - metering) * bar}
    values = law(valve, {"a.p": 105 * bar, "b.p": 100 * bar} | sensed)
    assert values["a.q"] == pytest.approx(opening * FLOW, rel=1e-9, abs=1e-15)
    assert values["s.q"] == values["ls.q"] == 0.0


def test_a_compensator_before_an_orifice_keeps_the_flow_over_the_load():
    flows = []
    for load in (20 * bar, 120 * bar):
        diagram = Diagram("compensated")
        supply = diagram.add("supply", hyd.ConstantPressurePump(pressure=200 * bar))
        valve = diagram.add("valve", hyd.PressureCompensator(flow=4 * FLOW, setting=10 * bar))
        room = diagram.add("room", hyd.ControlVolume(volume=1e-3))
        edge = diagram.add("edge", hyd.Orifice(diameter=8 * mm))
        end = diagram.add("end", hyd.ConstantPressurePump(pressure=load))
        diagram.connect(supply.p, valve.a)
        diagram.connect(valve.b, valve.s, room.a, edge.a)
        diagram.connect(edge.b, valve.ls, end.p)
        flows.append(simulate(diagram, 0.5, every=0.01)["edge.a.q"][-1])
    assert flows[1] == pytest.approx(flows[0], rel=0.02)


# ---------------------------------------------------------------- divider
def test_a_flow_divider_shares_its_flow_whatever_the_pressures(law):
    for p_b, p_c in ((10, 200), (200, 10)):
        divider = hyd.FlowDivider(share=0.4)
        values = law(divider, {"b.p": p_b * bar, "c.p": p_c * bar, "a.q": 1e-3}, through=("a",))
        assert values["b.q"] == pytest.approx(-0.4e-3)
        assert values["c.q"] == pytest.approx(-0.6e-3)
        assert values["a.p"] == pytest.approx((0.4 * p_b + 0.6 * p_c) * bar)
        assert values["lost_power"] == 0.0


def test_a_flow_divider_intensifies_the_pressure_of_the_loaded_side(law):
    values = law(hyd.FlowDivider(), {"a.p": 100 * bar, "c.p": 0.0, "b.q": -1e-3}, through=("b",))
    assert values["b.p"] == pytest.approx(200 * bar)


def test_friction_of_a_flow_divider_opposes_the_flow(law):
    divider = hyd.FlowDivider(friction=5 * bar)
    for q in (1e-3, -1e-3):
        values = law(divider, {"a.q": q}, through=("a",))
        assert values["a.p"] == pytest.approx(5 * bar * np.sign(q), rel=1e-3)
        assert values["lost_power"] == pytest.approx(5 * bar * 1e-3, rel=1e-3)


# ---------------------------------------------------------------- filter
def test_a_filter_has_the_drop_of_its_data_sheet_and_more_with_cold_oil(law):
    for viscosity, share in ((30e-6, 1.0), (300e-6, 0.1)):
        filter_ = hyd.Filter(flow=FLOW, at=0.5 * bar, viscosity=viscosity)
        assert law(filter_, {"a.p": 0.5 * bar})["a.q"] == pytest.approx(share * FLOW)


def test_dirt_closes_the_element_until_the_bypass_opens(law):
    shut = hyd.Filter(flow=FLOW, at=0.5 * bar, clogging=1.0)
    assert law(shut, {"a.p": 3 * bar})["a.q"] == 0.0
    assert law(shut, {"a.p": 5.1 * bar})["a.q"] == pytest.approx(FLOW * sqrt(5.1 / 5), rel=1e-3)
    half = hyd.Filter(flow=FLOW, at=0.5 * bar, clogging=0.5, viscosity=30e-6)
    assert law(half, {"a.p": 0.5 * bar})["a.q"] == pytest.approx(FLOW / 2)


# ---------------------------------------------------------------- shuttle
def test_a_shuttle_valve_joins_the_higher_pressure_and_shuts_the_lower(law):
    shuttle = hyd.ShuttleValve(flow=FLOW, at=5 * bar)
    values = law(shuttle, {"a.p": 105 * bar, "b.p": 40 * bar, "c.p": 100 * bar})
    assert values["a.q"] == pytest.approx(FLOW)
    assert values["b.q"] == 0.0
    mirrored = law(shuttle, {"a.p": 40 * bar, "b.p": 105 * bar, "c.p": 100 * bar})
    assert mirrored["b.q"] == -mirrored["c.q"] == pytest.approx(FLOW)
    assert mirrored["a.q"] == 0.0


def test_the_pressure_behind_a_shuttle_valve_is_the_higher_of_two():
    diagram = Diagram("sensing")
    shuttle = diagram.add("shuttle", hyd.ShuttleValve(flow=FLOW, at=5 * bar))
    hose = diagram.add("hose", hyd.ControlVolume(volume=1e-4))
    diagram.connect(shuttle.c, hose.a)
    diagram.expose(a=shuttle.a, b=shuttle.b)
    times = np.array([0.0, 1.0])
    ramps = {"a.p": (times, np.array([0.0, 100 * bar])), "b.p": (times, np.array([80 * bar, 20 * bar]))}
    run = simulate(diagram, 1.0, every=0.01, inputs=ramps, linear=True)
    higher = np.maximum(100 * bar * run.time, 80 * bar - 60 * bar * run.time)
    assert run["hose.pressure"][5:] == pytest.approx(higher[5:], abs=1.5 * bar)


# ---------------------------------------------------------------- reducing and relief
@pytest.mark.parametrize(("reduced", "opening"), [(10, 1.0), (27.5, 0.75), (35, 0.0), (60, 0.0)])
def test_a_reducing_valve_shuts_as_the_reduced_pressure_comes_up(law, reduced, opening):
    valve = hyd.PressureReducingValve(shut=35 * bar, full=25 * bar, flow=FLOW, at=10 * bar)
    values = law(valve, {"a.p": 200 * bar, "b.p": reduced * bar})
    expected = opening * FLOW * sqrt((200 - reduced) / 10)
    assert values["a.q"] == pytest.approx(expected, rel=1e-4, abs=0.003 * FLOW * sqrt(20))


def test_a_reducing_valve_feeds_a_pilot_line_at_its_pressure():
    diagram = Diagram("pilot")
    supply = diagram.add("supply", hyd.ConstantPressurePump(pressure=250 * bar))
    valve = diagram.add(
        "valve",
        hyd.PressureReducingValve(
            level="dynamic", shut=35 * bar, full=30 * bar, flow=FLOW, at=10 * bar, time_constant=0.01
        ),
    )
    line = diagram.add("line", hyd.ControlVolume(volume=2e-3))
    drain = diagram.add("drain", hyd.Orifice(diameter=1 * mm))
    tank = diagram.add("tank", hyd.Tank())
    diagram.connect(supply.p, valve.a)
    diagram.connect(valve.b, line.a, drain.a)
    diagram.connect(drain.b, tank.p)
    run = simulate(diagram, 2.0, every=0.01)
    assert 30 * bar < run["line.pressure"][-1] < 35 * bar
    assert run["valve.a.q"][-1] == pytest.approx(run["drain.a.q"][-1], rel=1e-3)


def test_a_slow_relief_valve_settles_where_the_static_one_is_and_overshoots_before():
    peaks, ends = [], []
    for level, extra in (("static", {}), ("dynamic", {"time_constant": 0.02})):
        diagram = Diagram("relief")
        source = diagram.add("source", hyd.ConstantFlowPump(displacement=1e-5, speed=100.0))
        line = diagram.add("line", hyd.ControlVolume(volume=5e-3, pressure=100 * bar))
        relief = diagram.add(
            "relief", hyd.ReliefValve(level=level, crack=200 * bar, full=240 * bar, flow=2e-3, **extra)
        )
        tank = diagram.add("tank", hyd.Tank())
        diagram.connect(source.p, line.a, relief.a)
        diagram.connect(relief.b, tank.p)
        pressure = simulate(diagram, 1.0, every=0.001)["line.pressure"]
        peaks.append(pressure.max())
        ends.append(pressure[-1])
    assert ends[1] == pytest.approx(ends[0], rel=1e-3)
    assert peaks[0] == pytest.approx(ends[0], rel=1e-4)
    assert peaks[1] > 1.02 * ends[1]


def test_a_reducing_valve_whose_pressures_are_the_wrong_way_round_is_refused():
    with pytest.raises(ParameterError) as caught:
        hyd.PressureReducingValve(shut=20 * bar, full=25 * bar, flow=FLOW, at=10 * bar)
    assert str(caught.value) == "PressureReducingValve(level='static').shut: 20 bar must be above full = 25 bar"


# ---------------------------------------------------------------- pilot-operated check valve
def piloted():
    return hyd.PilotOperatedCheckValve(flow=FLOW, at=5 * bar, ratio=4.0)


def test_a_pilot_operated_check_valve_holds_the_load_without_leakage(law):
    assert law(piloted(), {"b.p": 250 * bar})["b.q"] == 0.0
    assert law(piloted(), {"a.p": 255 * bar, "b.p": 250 * bar})["a.q"] == pytest.approx(FLOW)


def test_the_pilot_lets_the_load_go_at_the_pressure_of_its_ratio(law):
    """Seat shut at p_pilot = p_b / R, open a little above (p_b + full) / R."""
    for pilot, flow in ((250 / 4, 0.0), ((250 + 2.1) / 4, FLOW * sqrt(50))):
        values = law(piloted(), {"b.p": 250 * bar, "pilot.p": pilot * bar})
        assert values["b.q"] == pytest.approx(flow, rel=1e-3, abs=1e-15)
        assert values["pilot.q"] == 0.0


def test_back_pressure_at_the_valve_side_holds_the_pilot_back(law):
    pressures = {"b.p": 250 * bar, "pilot.p": 70 * bar}
    assert law(piloted(), pressures)["opening"] == 1.0
    assert law(piloted(), pressures | {"a.p": 30 * bar})["opening"] == 0.0
