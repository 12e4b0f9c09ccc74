from math import pi, sqrt

import pytest

from seacrane.errors import ParameterError
from seacrane.library import hydraulics as hyd
from seacrane.model import Diagram, simulate
from seacrane.units import bar, cm3_rev, l_min, mm, rpm

FLOW, DROP = 400 * l_min, 35 * bar


# ---------------------------------------------------------------- orifices
def test_orifice_flow_is_the_root_of_the_pressure_drop(law):
    orifice = hyd.Orifice(diameter=10 * mm, discharge=0.7, density=870.0)
    expected = 0.7 * pi / 4 * 0.01**2 * sqrt(2 * 50 * bar / 870)
    values = law(orifice, {"a.p": 60 * bar, "b.p": 10 * bar})
    assert values["a.q"] == pytest.approx(expected, rel=1e-6)
    assert values["b.q"] == -values["a.q"]
    assert values["lost_power"] == pytest.approx(expected * 50 * bar, rel=1e-6)


def test_orifice_flow_turns_round_with_the_pressure(law):
    orifice = hyd.Orifice(diameter=10 * mm)
    forth = law(orifice, {"a.p": 60 * bar, "b.p": 10 * bar})["a.q"]
    back = law(orifice, {"a.p": 10 * bar, "b.p": 60 * bar})["a.q"]
    assert back == -forth


def test_orifice_flow_is_linear_below_the_transition_pressure(law):
    orifice = hyd.Orifice(diameter=10 * mm, transition_pressure=0.1 * bar)
    one, two = (law(orifice, {"a.p": dp})["a.q"] for dp in (50.0, 100.0))
    assert two == pytest.approx(2 * one, rel=1e-4)


def test_a_variable_orifice_scales_with_its_signal_and_closes_tight(law):
    orifice = hyd.VariableOrifice(diameter=10 * mm)
    full, half, closed, beyond = (law(orifice, {"a.p": 1e6, "k": k})["a.q"] for k in (1.0, 0.5, 0.0, -1.0))
    assert full == pytest.approx(law(hyd.Orifice(diameter=10 * mm), {"a.p": 1e6})["a.q"])
    assert half == pytest.approx(full / 2)
    assert closed == beyond == 0.0


# ---------------------------------------------------------------- directional valve
def valve43(**changes):
    return hyd.DirectionalValve43(**({"flow": FLOW, "at": DROP, "leakage": 0.0} | changes))


@pytest.mark.parametrize(
    ("spool", "inlet", "outlet"),
    [(1.0, ("p", "a"), ("b", "t")), (-1.0, ("p", "b"), ("a", "t"))],
)
def test_a_fully_open_edge_passes_the_rated_flow_at_the_rated_drop(law, spool, inlet, outlet):
    pressures = {f"{inlet[0]}.p": 100 * bar, f"{inlet[1]}.p": 65 * bar, f"{outlet[0]}.p": 35 * bar, "x": spool}
    values = law(valve43(), pressures)
    assert values[f"{inlet[0]}.q"] == pytest.approx(FLOW, rel=1e-6)
    assert values[f"{inlet[1]}.q"] == pytest.approx(-FLOW, rel=1e-6)
    assert values[f"{outlet[0]}.q"] == pytest.approx(FLOW, rel=1e-6)
    assert values[f"{outlet[1]}.q"] == pytest.approx(-FLOW, rel=1e-6)


def test_the_valve_opens_in_proportion_beyond_its_dead_band(law):
    pressures = {"p.p": DROP}
    for spool, expected in ((0.0, 0.0), (0.04, 0.0), (0.05, 0.0025), (0.525, 0.5), (1.0, 1.0)):
        q = law(valve43(dead_band=0.05), pressures | {"x": spool})["p.q"]
        assert q / FLOW == pytest.approx(expected, rel=1e-4, abs=1e-9)


def test_a_command_beyond_full_travel_is_full_travel(law):
    assert law(valve43(), {"p.p": DROP, "x": 3.0})["p.q"] == law(valve43(), {"p.p": DROP, "x": 1.0})["p.q"]


def test_a_closed_edge_keeps_its_leakage(law):
    values = law(valve43(leakage=1e-3), {"p.p": DROP, "x": 0.0})
    assert values["a.q"] == pytest.approx(-1e-3 * FLOW, rel=1e-4)
    assert values["b.q"] == pytest.approx(-1e-3 * FLOW, rel=1e-4)


def test_a_floating_centre_bleeds_both_working_ports_and_fades_over_the_dead_band(law):
    floating = valve43(float_centre=0.1, dead_band=0.05)
    pressures = {"p.p": DROP, "a.p": DROP, "b.p": DROP}
    for spool, expected in ((0.0, 0.1), (0.025, 0.1 * 0.75**2), (-0.025, 0.1 * 0.75**2)):
        values = law(floating, pressures | {"x": spool})
        assert values["a.q"] / FLOW == values["b.q"] / FLOW == pytest.approx(expected)
    assert law(floating, pressures | {"x": 1.0})["a.q"] == 0.0


def test_a_floating_centre_without_a_dead_band_is_refused():
    with pytest.raises(ParameterError) as caught:
        valve43(float_centre=0.1, dead_band=0.0)
    assert str(caught.value) == (
        "DirectionalValve43(level='static').float_centre: needs a dead band to fade out in (got 0.1);"
        " allowed: 0, or dead_band above 0"
    )


def test_the_dynamic_spool_at_rest_is_where_the_static_one_is(law):
    dynamic = hyd.DirectionalValve43(flow=FLOW, at=DROP, level="dynamic", natural_frequency=60.0)
    static = hyd.DirectionalValve43(flow=FLOW, at=DROP, level="static")
    pressures = {"p.p": 200 * bar, "a.p": 80 * bar, "b.p": 30 * bar, "x": 0.7}
    settled = law(dynamic, pressures, {"spool_position": 0.7})
    assert settled["der(spool_speed)"] == 0.0
    for port in "ptab":
        assert settled[f"{port}.q"] == pytest.approx(law(static, pressures)[f"{port}.q"])


def test_the_dynamic_spool_accelerates_as_a_second_order_lag(law):
    dynamic = hyd.DirectionalValve43(flow=FLOW, at=DROP, level="dynamic", natural_frequency=60.0, damping=0.8)
    values = law(dynamic, {"x": 1.0}, {"spool_position": 0.25, "spool_speed": 2.0})
    assert values["der(spool_position)"] == 2.0
    assert values["der(spool_speed)"] == pytest.approx(3600 * 0.75 - 2 * 0.8 * 60 * 2.0)


# ---------------------------------------------------------------- counterbalance valve
def counterbalance(**changes):
    given = {"flow": FLOW, "at": 20 * bar, "crack": 250 * bar, "full": 300 * bar, "ratio": 4.0, "leakage": 0.0}
    return hyd.CounterbalanceValve(**(given | changes))


@pytest.mark.parametrize(
    ("effective", "expected"),
    [(200, 0.0), (249, 0.0), (250, 0.0025), (275, 0.5), (300, 0.9975), (301, 1.0), (400, 1.0)],
)
def test_the_relief_opens_from_crack_to_full_with_load_plus_ratio_times_pilot(law, effective, expected):
    load = 180 * bar
    pilot = (effective * bar - load) / 4
    values = law(counterbalance(), {"b.p": load, "a.p": load - 20 * bar, "pilot.p": pilot})
    assert values["relief_opening"] == pytest.approx(expected, abs=1e-9)
    assert values["b.q"] == pytest.approx(expected * FLOW, rel=1e-5, abs=1e-9)


def test_the_load_alone_is_held_below_the_crack_pressure(law):
    values = law(counterbalance(), {"b.p": 240 * bar})
    assert values["b.q"] == 0.0
    assert values["pilot.q"] == 0.0


def test_oil_passes_freely_towards_the_load(law):
    values = law(counterbalance(), {"a.p": 120 * bar, "b.p": 100 * bar})
    assert values["a.q"] == pytest.approx(FLOW, rel=1e-6)


def test_the_dynamic_relief_follows_the_static_opening(law):
    dynamic = counterbalance(level="dynamic", time_constant=0.02)
    values = law(dynamic, {"b.p": 275 * bar}, {"relief_position": 0.1})
    assert values["der(relief_position)"] == pytest.approx((0.5 - 0.1) / 0.02)


def test_a_counterbalance_valve_that_closes_as_it_should_open_is_refused():
    with pytest.raises(ParameterError) as caught:
        counterbalance(full=200 * bar)
    assert str(caught.value) == "CounterbalanceValve(level='static').full: 200 bar must be above crack = 250 bar"


# ---------------------------------------------------------------- relief, check, anti-cavitation
def test_a_relief_valve_opens_from_crack_to_full(law):
    relief = hyd.ReliefValve(crack=280 * bar, full=320 * bar, flow=FLOW)
    expected = {100: 0.0, 270: 0.0, 300: 0.5 * sqrt(300 / 320), 330: sqrt(330 / 320)}
    for pressure, flow in expected.items():
        assert law(relief, {"a.p": pressure * bar})["a.q"] / FLOW == pytest.approx(flow, rel=1e-5, abs=1e-12)


def test_a_relief_valve_passes_its_rated_flow_at_full_opening(law):
    relief = hyd.ReliefValve(crack=280 * bar, full=320 * bar, flow=FLOW)
    assert law(relief, {"a.p": 320 * bar})["a.q"] == pytest.approx(FLOW, rel=3e-3)


def test_a_relief_valve_passes_nothing_backwards(law):
    relief = hyd.ReliefValve(crack=280 * bar, full=320 * bar, flow=FLOW)
    assert law(relief, {"b.p": 400 * bar})["a.q"] == 0.0


def test_a_check_valve_passes_one_way_only(law):
    check = hyd.CheckValve(flow=FLOW, at=5 * bar)
    assert law(check, {"a.p": 5 * bar})["a.q"] == pytest.approx(FLOW, rel=1e-6)
    assert law(check, {"a.p": 0.4 * bar})["a.q"] == 0.0
    assert law(check, {"b.p": 300 * bar})["a.q"] == 0.0


def test_an_anticavitation_valve_fills_a_line_that_is_sucked_empty(law):
    valve = hyd.AnticavitationValve(flow=FLOW, at=1 * bar)
    assert law(valve, {"a.p": -0.5 * bar})["a.q"] == pytest.approx(-FLOW * sqrt(0.5), rel=1e-2)
    assert law(valve, {"a.p": 200 * bar})["a.q"] == 0.0


@pytest.mark.parametrize(("size", "pressure"), [(75 * l_min, 220.13), (150 * l_min, 210.23)])
def test_a_pump_on_a_relief_valve_alone_starts_at_the_pressure_that_opens_it(size, pressure):
    """With all of the flow over it, a valve of this size is fully open; one of twice the size is half open."""
    diagram = Diagram("relieved")
    pump = diagram.add("pump", hyd.ConstantFlowPump(displacement=50 * cm3_rev, speed=1500 * rpm))
    valve = diagram.add("valve", hyd.ReliefValve(crack=200 * bar, full=220 * bar, flow=size))
    tank = diagram.add("tank", hyd.Tank())
    diagram.connect(pump.p, valve.a)
    diagram.connect(valve.b, tank.p)
    run = simulate(diagram, until=0.1)
    assert run["pump.p.p"] / bar == pytest.approx(pressure, abs=0.01)
    assert run["valve.a.q"] == pytest.approx(75 * l_min, rel=1e-9)


def test_a_check_valve_before_a_relief_valve_passes_the_flow_to_where_it_opens_first():
    diagram = Diagram("relieved")
    pump = diagram.add("pump", hyd.ConstantFlowPump(displacement=50 * cm3_rev, speed=1500 * rpm))
    near = diagram.add("near", hyd.ReliefValve(crack=200 * bar, full=220 * bar, flow=150 * l_min))
    check = diagram.add("check", hyd.CheckValve(flow=75 * l_min, at=3 * bar))
    far = diagram.add("far", hyd.ReliefValve(crack=100 * bar, full=120 * bar, flow=150 * l_min))
    tank = diagram.add("tank", hyd.Tank())
    diagram.connect(pump.p, near.a, check.a)
    diagram.connect(check.b, far.a)
    diagram.connect(near.b, far.b, tank.p)
    run = simulate(diagram, until=0.1)
    assert run["pump.p.p"] - run["far.a.p"] == pytest.approx(3 * bar, rel=0.01)
    assert run["far.a.q"] == pytest.approx(75 * l_min, rel=1e-9)
