"""Mineral oil at a temperature, and what a diagram shares."""

from __future__ import annotations

from math import log10

import pytest

from seacrane.errors import ParameterError
from seacrane.library import hydraulics as hyd
from seacrane.model import Diagram, simulate
from seacrane.units import bar, l, l_min, mm


def celsius(degrees: float) -> float:
    return degrees + 273.15


def test_at_40_degrees_the_oil_is_that_of_the_defaults() -> None:
    oil = hyd.mineral_oil(celsius(40))
    component = hyd.Pipe(level="line", length=1.0, diameter=20 * mm)
    diagram = Diagram("line")
    diagram.expose(a=diagram.add("pipe", component).a)
    defaults = {p.name: p.start for p in diagram.parameters()}
    assert {name: defaults[name] for name in oil} == pytest.approx(oil, rel=1e-12)


def test_viscosity_passes_through_both_grades_and_falls_on_a_straight_line_of_its_chart() -> None:
    def chart(degrees: float) -> float:
        return log10(log10(hyd.mineral_oil(celsius(degrees))["viscosity"] * 1e6 + 0.7))

    assert hyd.mineral_oil(celsius(100))["viscosity"] == pytest.approx(6.8e-6)
    slope = (chart(40) - chart(100)) / (log10(celsius(40)) - log10(celsius(100)))
    for degrees in (-20, 0, 60, 90):
        assert chart(degrees) == pytest.approx(chart(40) + slope * (log10(celsius(degrees)) - log10(celsius(40))))


def test_an_iso_vg_46_oil_has_the_viscosity_that_its_data_sheets_give() -> None:
    """Typical of mineral oils of viscosity index 95 to 105, to 10 %: 20 mm2/s at 60 degrees, 130 at 20, 570 at 0."""
    for degrees, typical in ((60, 20.5e-6), (20, 130e-6), (0, 570e-6)):
        assert hyd.mineral_oil(celsius(degrees))["viscosity"] == pytest.approx(typical, rel=0.1)


def test_warm_oil_is_lighter_and_softer() -> None:
    cold, warm = hyd.mineral_oil(celsius(20)), hyd.mineral_oil(celsius(70))
    assert cold["density"] / warm["density"] == pytest.approx(1 + 50 * 7e-4, rel=1e-3)
    assert cold["bulk_modulus"] / warm["bulk_modulus"] == pytest.approx(10 ** (0.0024 * 50))


def test_a_temperature_in_degrees_celsius_is_questioned() -> None:
    with pytest.raises(ParameterError) as caught:
        hyd.mineral_oil(60.0)
    assert str(caught.value) == (
        "mineral_oil.temperature: 60 K is out of range; allowed: 233.15 to 393.15 K."
        " Did you mean 60 degrees Celsius, 333.15 K?"
    )


def test_viscosities_the_wrong_way_round_are_refused() -> None:
    with pytest.raises(ParameterError, match=r"viscosity_100: 46 mm2/s must be .* below viscosity_40 = 32 mm2/s"):
        hyd.mineral_oil(celsius(40), viscosity_40=32e-6, viscosity_100=46e-6)


def test_cold_oil_costs_pressure_in_proportion_to_its_dynamic_viscosity(law) -> None:
    drops = []
    for degrees in (0, 40):
        oil = hyd.mineral_oil(celsius(degrees))
        given = {name: oil[name] for name in ("density", "viscosity")}
        part = hyd.Pipe(length=10.0, diameter=25 * mm, **given)
        values = law(part, {"a.q": 10 * l_min}, through=("a",))
        drops.append(values["a.p"] / (oil["density"] * oil["viscosity"]))
    assert drops[0] == pytest.approx(drops[1], rel=1e-9)


def test_one_compiled_model_runs_at_any_temperature() -> None:
    diagram = Diagram("filling")
    source = diagram.add("source", hyd.Pump(level="constant-flow", displacement=1e-6, speed=100.0))
    room = diagram.add("room", hyd.Volume(volume=10 * l))
    diagram.connect(source.p, room.a)
    dae = diagram.compile()
    pressures = []
    for degrees in (40, 80):
        modulus = hyd.mineral_oil(celsius(degrees))["bulk_modulus"]
        run = simulate(dae, 1.0, parameters={"bulk_modulus": modulus})
        pressures.append(run["room.pressure"][-1])
        assert pressures[-1] == pytest.approx(modulus * 1e-4 / (10 * l), rel=1e-6)
    assert pressures[1] < 0.85 * pressures[0]


def test_the_atmosphere_is_shared_and_gas_feels_it(law) -> None:
    """In the deep a gauge precharge of 100 bar is 200 bar absolute, and the same oil squeezes the gas less."""

    def pressure(atmosphere: float) -> float:
        gas = hyd.GasAccumulator(
            volume=50 * l, precharge=100 * bar, oil=10 * l, level="isothermal", atmospheric_pressure=atmosphere
        )
        return law(gas, through=("a",))["a.p"]

    assert pressure(1.01325 * bar) == pytest.approx((101.01325 / 0.8 - 1.01325) * bar)
    assert pressure(100 * bar) == pytest.approx((200 / 0.8 - 100) * bar)


def test_a_diagram_may_be_given_all_of_the_oil_though_its_components_use_a_part_of_it() -> None:
    diagram = Diagram("warm", **hyd.mineral_oil(celsius(60)))
    source = diagram.add("source", hyd.FlowInput())
    diagram.connect(source.p, diagram.add("room", hyd.Volume(volume=1 * l)).a)
    diagram.expose(flow=source.set)
    values = {p.name: p.start for p in diagram.compile().parameters}
    assert values["bulk_modulus"] == hyd.mineral_oil(celsius(60))["bulk_modulus"]
    assert "viscosity" not in values
