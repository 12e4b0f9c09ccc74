"""Directional valves beyond the plain proportional one: on/off, rate-limited, pressure-compensated."""

import numpy as np
import pytest

from seacrane.library import hydraulics as hyd
from seacrane.model import Diagram, simulate
from seacrane.units import bar, l_min

FLOW, DROP = 400 * l_min, 35 * bar


def switching(cls, **run):
    diagram = Diagram("switching")
    valve = diagram.add("valve", cls(flow=FLOW, at=DROP, switching_time=0.1))
    diagram.expose(on=valve.on, **{n: getattr(valve, n) for n in cls.ports if n != "on"})
    return simulate(diagram, 0.5, every=0.001, **run)


# ---------------------------------------------------------------- on and off
def test_an_on_off_valve_opens_and_shuts_along_its_stated_ramp():
    command = (np.array([0.0, 0.1, 0.1001, 0.3, 0.3001]), np.array([0.0, 0.0, 1.0, 1.0, 0.0]))
    run = switching(hyd.DirectionalValve22, inputs={"on": command, "p.p": DROP}, linear=True)
    for time, opening in ((0.1, 0.0), (0.15, 0.5), (0.18, 0.8), (0.29, 1.0), (0.35, 0.5), (0.45, 0.0)):
        assert np.interp(time, run.time, run["valve.opening"]) == pytest.approx(opening, abs=0.01)
        assert np.interp(time, run.time, run["p.q"]) == pytest.approx(opening * FLOW, abs=0.011 * FLOW)


def test_an_open_valve_passes_its_rated_flow_both_ways_and_a_shut_one_its_leakage(law):
    valve = hyd.DirectionalValve22(flow=FLOW, at=DROP, leakage=1e-4)
    for pressures, sign in (({"p.p": DROP}, 1), ({"a.p": DROP}, -1)):
        assert law(valve, pressures, {"opening": 1.0})["p.q"] == pytest.approx(sign * FLOW, rel=1e-3)
        assert law(valve, pressures, {"opening": 0.0})["p.q"] == pytest.approx(sign * 1e-4 * FLOW, rel=1e-3)


def test_the_four_port_form_switches_both_paths_together(law):
    valve = hyd.FourPortDirectionalValve22(flow=FLOW, at=DROP, leakage=0.0)
    values = law(valve, {"p.p": 2 * DROP, "a.p": DROP, "b.p": DROP}, {"opening": 0.5})
    assert values["p.q"] == -values["a.q"] == pytest.approx(0.5 * FLOW)
    assert values["b.q"] == -values["t.q"] == pytest.approx(0.5 * FLOW)
    shut = law(valve, {"p.p": 200 * bar})
    assert [shut[f"{port}.q"] for port in "ptab"] == [0.0] * 4


def test_both_forms_are_the_same_edge(law):
    two = law(hyd.DirectionalValve22(flow=FLOW, at=DROP), {"p.p": 50 * bar}, {"opening": 0.3})
    four = law(hyd.FourPortDirectionalValve22(flow=FLOW, at=DROP), {"p.p": 50 * bar}, {"opening": 0.3})
    assert two["p.q"] == four["p.q"]


# ---------------------------------------------------------------- rate limit
def spool(level, step, **changes):
    diagram = Diagram("spool")
    given = {"flow": FLOW, "at": DROP, "natural_frequency": 100.0, "level": level}
    valve = diagram.add("valve", hyd.DirectionalValve43(**(given | changes)))
    for port in "ptab":
        end = diagram.add(f"end_{port}", hyd.Tank())
        diagram.connect(getattr(valve, port), end.p)
    diagram.expose(x=valve.x)
    return simulate(diagram, 0.5, every=0.001, inputs={"x": step})


def test_a_large_step_of_the_spool_takes_its_travel_time():
    run = spool("rate-limited", 1.0, travel_time=0.2)
    position = run["valve.spool_position"]
    assert np.diff(position).max() / 0.001 == pytest.approx(1 / 0.2, rel=0.01)
    assert np.interp(0.12, run.time, position) == pytest.approx(0.12 / 0.2, abs=0.01)
    assert position[-1] == pytest.approx(1.0, abs=1e-4)


def test_a_small_step_does_not_see_the_rate_limit():
    free, limited = spool("dynamic", 0.02), spool("rate-limited", 0.02, travel_time=0.01)
    assert limited["valve.spool_position"] == pytest.approx(free["valve.spool_position"], abs=1e-5)


# ---------------------------------------------------------------- pressure compensation
def compensated(**changes):
    given = {"flow": FLOW, "at": DROP, "margin": DROP, "leakage": 0.0, "dead_band": 0.05, "level": "compensated"}
    return hyd.DirectionalValve43(**(given | changes))


@pytest.mark.parametrize("load", [0.0, 50 * bar, 200 * bar])
@pytest.mark.parametrize("spool", [0.3, 1.0])
def test_a_compensated_valve_passes_the_flow_of_its_command_whatever_the_load(law, spool, load):
    values = law(compensated(), {"p.p": 250 * bar, "a.p": load, "x": spool})
    assert values["a.q"] == pytest.approx(-FLOW * (spool - 0.05) / 0.95, rel=1e-5)


def test_without_margin_to_spare_the_compensated_valve_is_a_plain_one(law):
    pressures = {"p.p": 250 * bar, "a.p": 230 * bar, "b.p": 15 * bar, "x": 0.7}
    plain = law(hyd.DirectionalValve43(flow=FLOW, at=DROP, leakage=0.0, dead_band=0.05), pressures)
    values = law(compensated(), pressures)
    for port in "ptab":
        assert values[f"{port}.q"] == pytest.approx(plain[f"{port}.q"], rel=1e-9)
