"""Levels of one component agree in the limit that they share, found by the registry where they have the same names."""

from __future__ import annotations

from pathlib import Path

import pytest

from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mec
from seacrane.model import REGISTRY
from seacrane.model.component import interface_of
from seacrane.units import bar, cm3_rev, l_min, rpm

LAGGING = {
    hyd.CounterbalanceValve: (
        {"flow": 400 * l_min, "at": 10 * bar, "crack": 200 * bar, "full": 300 * bar, "ratio": 3.0},
        {"a.p": 20 * bar, "b.p": 150 * bar, "pilot.p": 30 * bar},
        ("relief_position", "relief_opening"),
    ),
    hyd.ReliefValve: (
        {"flow": 400 * l_min, "crack": 200 * bar, "full": 220 * bar},
        {"a.p": 211 * bar, "b.p": 1 * bar},
        ("poppet", "opening"),
    ),
    hyd.PressureReducingValve: (
        {"flow": 100 * l_min, "at": 10 * bar, "full": 45 * bar, "shut": 50 * bar},
        {"a.p": 100 * bar, "b.p": 47 * bar},
        ("spool", "opening"),
    ),
    hyd.LoadSensingPump: (
        {"displacement": 100 * cm3_rev, "speed": 1500 * rpm, "cut_off": 250 * bar},
        {"p.p": 117 * bar, "ls.p": 100 * bar},
        ("swash", "stroke"),
    ),
}
"""Parameters, pressures at which it is half open, and the names of the state and of what it follows."""

EXTRA = {"time_constant": 0.05}
COVERED = {
    **dict.fromkeys(LAGGING, ("test_a_lagging_valve_or_pump_that_has_come_to_rest_is_the_static_one",)),
    hyd.DirectionalValve43: (
        "test_the_dynamic_spool_at_rest_is_where_the_static_one_is",
        "test_a_rate_limited_spool_that_has_come_to_rest_is_the_static_one",
        "test_without_margin_to_spare_the_compensated_valve_is_a_plain_one",
    ),
    hyd.GasAccumulator: (
        "test_a_thin_real_gas_without_heat_exchange_is_an_adiabatic_one",
        "test_a_thin_real_gas_that_is_filled_slowly_is_an_isothermal_one",
    ),
    hyd.Pipe: (
        "test_a_line_in_steady_flow_has_the_drop_of_its_resistance",
        "test_a_line_yields_as_a_whole_like_a_compressible_pipe",
        "test_a_shut_line_rings_at_the_closed_form_frequency_of_its_chain",
    ),
    hyd.Volume: ("test_without_air_the_volume_is_a_control_volume", "test_a_wide_column_is_an_open_tank"),
    hyd.Pump: ("test_pressure_control_tends_to_constant_pressure_and_to_constant_flow",),
    hyd.HydraulicMotor: ("test_motor_levels_agree_without_losses",),
    hyd.VariableHydraulicMotor: ("test_a_variable_motor_at_full_stroke_is_the_fixed_motor",),
    hyd.DoubleActingCylinder: ("test_levels_agree_when_oil_is_stiff_and_ports_are_wide",),
    hyd.SingleActingCylinder: ("test_plunger_levels_agree_on_the_flow_of_a_steady_speed",),
    mec.WinchDrum: ("test_drum_levels_agree_on_an_empty_drum",),
    mec.Mass: ("test_the_levels_of_a_mass_agree_on_a_slope_that_stands_upright",),
    mec.SpringDamper: ("test_spring_and_damper_alone_add_up_to_both",),
    mec.TorsionalSpringDamper: ("test_spring_and_damper_alone_add_up_to_both",),
}
"""Where the limits of each interface with levels are tested."""


def test_no_component_with_levels_is_forgotten() -> None:
    library = [cls for cls in REGISTRY if cls.__module__.startswith("seacrane.library")]
    assert {interface_of(cls) for cls in library if cls.level is not None} == set(COVERED)
    here = "".join(path.read_text() for path in Path(__file__).parent.glob("test_library_*.py"))
    for tests in COVERED.values():
        for test in tests:
            assert f"def {test}(" in here


@pytest.mark.parametrize("interface", LAGGING, ids=lambda c: c.__name__)
def test_a_lagging_valve_or_pump_that_has_come_to_rest_is_the_static_one(law, interface) -> None:
    parameters, pressures, (state, follows) = LAGGING[interface]
    static = law(interface(level="static", **parameters), pressures)
    assert 0.1 < static[follows] < 0.9
    settled = law(interface(level="dynamic", **parameters, **EXTRA), pressures, {state: static[follows]})
    assert settled[f"der({state})"] == pytest.approx(0.0, abs=1e-12)
    for port in (name.removesuffix(".p") for name in pressures):
        assert settled[f"{port}.q"] == pytest.approx(static[f"{port}.q"], rel=1e-12)


def test_a_rate_limited_spool_that_has_come_to_rest_is_the_static_one(law) -> None:
    given = {"x": 0.6, "p.p": 210 * bar, "t.p": 2 * bar, "a.p": 120 * bar, "b.p": 40 * bar}
    parameters = {"flow": 400 * l_min, "at": 35 * bar}
    limited = hyd.DirectionalValve43(level="rate-limited", natural_frequency=60.0, travel_time=0.1, **parameters)
    settled = law(limited, given, {"spool_position": 0.6})
    static = law(hyd.DirectionalValve43(**parameters), given)
    assert settled["der(spool_speed)"] == pytest.approx(0.0, abs=1e-9)
    for port in "ptab":
        assert settled[f"{port}.q"] == pytest.approx(static[f"{port}.q"], rel=1e-12)
