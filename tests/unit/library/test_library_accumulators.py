"""Accumulators against their gas laws, and volumes against the closed forms of their kind."""

from math import exp, log

import numpy as np
import pytest

from seacrane import fmi
from seacrane.errors import ParameterError
from seacrane.library import hydraulics as hyd
from seacrane.library.hydraulics import nitrogen
from seacrane.library.hydraulics.fluid import ATMOSPHERE
from seacrane.model import Diagram, simulate
from seacrane.units import bar, l

SPAN = {
    (263.15, 50): (2335.483, 21.259),
    (263.15, 200): (8938.072, 22.212),
    (300.0, 100): (3988.273, 21.426),
    (300.0, 200): (7586.962, 21.882),
    (300.0, 300): (10522.835, 22.235),
    (350.0, 300): (8912.857, 21.941),
    (400.0, 300): (7768.846, 21.810),
}
"""Nitrogen by temperature [K] and pressure [bar]: mol/m3 and c_v [J/(mol.K)], by the equation of Span et al., 2000."""


def accumulator(level, **changes):
    extra = {"time_constant": 20.0} if level == "real-gas" else {}
    return hyd.GasAccumulator(level=level, **({"volume": 50 * l, "precharge": 100 * bar} | extra | changes))


# ---------------------------------------------------------------- nitrogen
@pytest.mark.parametrize(("state", "expected"), SPAN.items())
def test_nitrogen_has_the_density_and_heat_capacity_of_the_reference_equation(state, expected):
    (temperature, pressure), (density, capacity) = state, expected
    assert float(nitrogen.pressure(1 / density, temperature)) == pytest.approx(pressure * bar, rel=0.01)
    assert float(nitrogen.heat_capacity(1 / density, temperature)) == pytest.approx(capacity, rel=0.03)


@pytest.mark.parametrize("temperature", [220.0, 300.0, 400.0])
@pytest.mark.parametrize("pressure", [1 * bar, 100 * bar, 1000 * bar])
def test_molar_volume_undoes_the_equation_of_state(temperature, pressure):
    v = nitrogen.molar_volume(pressure, temperature)
    assert float(nitrogen.pressure(v, temperature)) == pytest.approx(pressure, rel=1e-9)


@pytest.mark.parametrize("v", [2e-3, 2e-4, 7e-5])
def test_the_slopes_of_nitrogen_hang_together_as_thermodynamics_demands(v):
    """(dp/dT)_v by differences, and (d c_v / d v)_T = T (d^2 p / d T^2)_v."""
    t, dt, dv = 300.0, 0.05, 1e-4 * v
    low, mid, high = (float(nitrogen.pressure(v, t + s * dt)) for s in (-1, 0, 1))
    assert float(nitrogen.pressure_slope(v, t)) == pytest.approx((high - low) / (2 * dt), rel=1e-6)
    growth = (float(nitrogen.heat_capacity(v + dv, t)) - float(nitrogen.heat_capacity(v - dv, t))) / (2 * dv)
    assert growth == pytest.approx(t * (high - 2 * mid + low) / dt**2, rel=1e-2)


# ---------------------------------------------------------------- accumulator
@pytest.mark.parametrize(("level", "exponent"), [("isothermal", 1.0), ("adiabatic", 1.4)])
def test_the_oil_takes_its_room_from_the_gas(law, level, exponent):
    for oil in (0.0, 10 * l, 30 * l):
        values = law(accumulator(level), {"a.q": 1e-3}, {"oil": oil}, through=("a",))
        expected = (100 * bar + ATMOSPHERE) * (50 * l / (50 * l - oil)) ** exponent
        assert values["a.p"] == pytest.approx(expected - ATMOSPHERE)
        assert values["gas_pressure"] == pytest.approx(expected)
        assert values["der(oil)"] == 1e-3


def test_isothermal_work_is_that_of_the_closed_form():
    """Filling stores p_0 V_0 ln(V_0 / V), less what the atmosphere gives."""
    filling = Diagram("filling")
    part = filling.add("part", accumulator("isothermal"))
    source = filling.add("source", hyd.FlowInput())
    filling.connect(source.p, part.a)
    filling.expose(q=source.set)
    run = simulate(filling, 10.0, every=0.01, inputs={"q": 2e-3}, tolerance=1e-9)
    work = np.trapezoid(run["part.stored_power"], run.time)
    expected = (100 * bar + ATMOSPHERE) * 50 * l * log(50 / 30) - ATMOSPHERE * 20 * l
    assert work == pytest.approx(expected, rel=1e-5)


def test_below_its_precharge_the_oil_port_shuts(law):
    empty = law(accumulator("isothermal"), {}, {"oil": -0.05 * l}, through=("a",))
    assert empty["a.p"] == pytest.approx(0.0, abs=0.6 * (100 * bar + ATMOSPHERE))
    assert law(accumulator("isothermal"), {}, {"oil": -0.1 * l}, through=("a",))["a.p"] < 0


def cycle(level, rate, **changes):
    """Pressure after 15 l of oil were pressed in at `rate` [m3/s]."""
    diagram = Diagram("cycle")
    part = diagram.add("part", accumulator(level, **changes))
    source = diagram.add("source", hyd.FlowInput())
    diagram.connect(source.p, part.a)
    diagram.expose(q=source.set)
    time = 15 * l / rate
    return simulate(diagram, time, every=time / 100, inputs={"q": rate}, tolerance=1e-8)


def test_a_thin_real_gas_without_heat_exchange_is_an_adiabatic_one():
    thin = {"precharge": 2 * bar}
    real = cycle("real-gas", 1e-2, time_constant=1e6, **thin)
    ideal = cycle("adiabatic", 1e-2, **thin)
    assert real["part.a.p"] == pytest.approx(ideal["part.a.p"], rel=3e-3)
    heated = 293.15 * (50 / 35) ** 0.4
    assert real["part.temperature"][-1] == pytest.approx(heated, rel=3e-3)


def test_a_thin_real_gas_that_is_filled_slowly_is_an_isothermal_one():
    thin = {"precharge": 2 * bar}
    real = cycle("real-gas", 1e-4, time_constant=0.05, **thin)
    assert real["part.a.p"] == pytest.approx(cycle("isothermal", 1e-4, **thin)["part.a.p"], rel=3e-3)


def test_real_nitrogen_at_working_pressure_is_stiffer_than_an_ideal_gas():
    """At 200 bar and more the repulsion of the molecules shows: the isotherm by the equation of state, not by Boyle."""
    shape = {"precharge": 200 * bar, "oil": 0.0}
    real = cycle("real-gas", 1e-5, time_constant=1.0, **shape)["part.gas_pressure"][-1]
    v = nitrogen.molar_volume(200 * bar + ATMOSPHERE, 293.15) * 35 / 50
    assert real == pytest.approx(float(nitrogen.pressure(v, 293.15)), rel=1e-3)
    assert real > 1.08 * (200 * bar + ATMOSPHERE) * 50 / 35


def test_a_gas_left_alone_cools_with_its_time_constant():
    diagram = Diagram("cooling")
    part = diagram.add("part", accumulator("real-gas", oil=10 * l, temperature_difference=40.0))
    plug = diagram.add("plug", hyd.Plug())
    diagram.connect(part.a, plug.a)
    run = simulate(diagram, 60.0, every=0.5, tolerance=1e-8)
    assert run["part.temperature_difference"] == pytest.approx(40.0 * np.exp(-run.time / 20.0), rel=1e-5)


@pytest.mark.parametrize("level", ["isothermal", "real-gas"])
def test_the_oil_at_a_pressure_holds_that_pressure(law, level):
    oil = accumulator(level).oil_at(180 * bar)
    values = law(accumulator(level, oil=oil), {}, through=("a",))
    assert values["a.p"] == pytest.approx(180 * bar, rel=1e-9)
    assert accumulator(level).oil_at(90 * bar) == 0.0


def test_an_accumulator_without_room_for_its_gas_is_refused():
    with pytest.raises(ParameterError) as caught:
        accumulator("adiabatic", oil=50 * l)
    assert str(caught.value) == (
        "GasAccumulator(level='adiabatic').oil: 50 l leave no room for the gas; allowed: at most 49 l"
    )


# ---------------------------------------------------------------- volumes
def mixture(p, air, beta=1.2e9, n=1.4):
    """Volume of oil and air, of what it is at atmospheric pressure."""
    return (1 - air) * exp(-p / beta) + air * (ATMOSPHERE / (p + ATMOSPHERE)) ** (1 / n)


@pytest.mark.parametrize("air", [0.0, 0.01, 0.1])
@pytest.mark.parametrize("p", [0.0, 5 * bar, 200 * bar])
def test_entrained_air_yields_as_its_volume_over_pressure_says(law, p, air):
    values = law(
        hyd.Volume(level="entrained-air", volume=1 * l, air=air), {"a.q": 1e-4}, {"pressure": p}, through=("a",)
    )
    step = 1e-4 * (p + ATMOSPHERE)
    slope = (mixture(p + step, air) - mixture(p - step, air)) / (2 * step)
    assert values["effective_modulus"] == pytest.approx(-mixture(p, air) / slope, rel=1e-5)
    assert values["der(pressure)"] == pytest.approx(values["effective_modulus"] / (1 * l) * 1e-4)


def test_air_hardly_counts_at_high_pressure_and_rules_at_low(law):
    def modulus(p):
        return law(hyd.Volume(level="entrained-air", volume=1 * l), {}, {"pressure": p}, through=("a",))[
            "effective_modulus"
        ]

    assert modulus(0.0) < 0.02 * 1.2e9
    assert modulus(300 * bar) > 0.98 * 1.2e9


def test_without_air_the_volume_is_a_control_volume(law):
    given, states = {"a.q": 1e-4}, {"pressure": 50 * bar}
    airless = law(hyd.Volume(level="entrained-air", volume=1 * l, air=0.0), given, states, through=("a",))
    control = law(hyd.ControlVolume(volume=1 * l), given, states, through=("a",))
    assert airless["der(pressure)"] == pytest.approx(control["der(pressure)"])


def test_a_column_presses_on_its_foot_with_its_height(law):
    column = hyd.FluidColumn(area=2.0, height=3.0, density=870.0)
    values = law(column, {"a.q": 0.1}, through=("a",))
    assert values["a.p"] == pytest.approx(870 * 9.81 * 3.0)
    assert values["der(height)"] == pytest.approx(0.05)
    assert values["stored_power"] == pytest.approx(870 * 9.81 * 3.0 * 0.1)


def test_a_wide_column_is_an_open_tank(law):
    height = 2 * bar / (870 * 9.81)
    column = law(hyd.FluidColumn(area=1e4, height=height, density=870.0), {"a.q": 0.1}, through=("a",))
    tank = law(hyd.Volume(level="open-tank", pressure=2 * bar), {"a.q": 0.1}, through=("a",))
    assert column["a.p"] == pytest.approx(tank["a.p"]) == pytest.approx(2 * bar)
    assert column["der(height)"] < 1e-4


# ---------------------------------------------------------------- heave
def test_gas_that_swings_at_its_own_time_constant_turns_work_into_heat():
    """Over a closed cycle the oil gives less work than it took; far faster or slower cycles lose hardly anything."""

    def lost_share(period):
        diagram = Diagram("heave")
        part = diagram.add("part", accumulator("real-gas", oil=15 * l, time_constant=5.0))
        source = diagram.add("source", hyd.FlowInput())
        diagram.connect(source.p, part.a)
        diagram.expose(q=source.set)
        times = np.linspace(0.0, 20 * period, 4001)
        flow = 10 * l * np.pi / period * np.sin(2 * np.pi * times / period)
        run = simulate(diagram, 20 * period, every=period / 200, inputs={"q": (times, flow)}, linear=True)
        last = run.time >= 19 * period - 1e-9
        power = (run["part.a.p"] * run["part.a.q"])[last]
        return np.trapezoid(power, run.time[last]) / (np.trapezoid(abs(power), run.time[last]) / 2)

    near, fast, slow = (lost_share(2 * np.pi * 5.0 * factor) for factor in (1.0, 0.01, 100.0))
    assert near > 0.05
    assert 0 < fast < near / 5
    assert 0 < slow < near / 5


def test_a_temperature_keeps_its_unit_in_an_fmu(tmp_path):
    diagram = Diagram("gas")
    part = diagram.add("part", accumulator("real-gas"))
    source = diagram.add("source", hyd.FlowInput())
    diagram.connect(source.p, part.a)
    diagram.expose(q=source.set)
    fmi.export(diagram, tmp_path / "gas.fmu")
    assert fmi.check(tmp_path / "gas.fmu") == []
    description = fmi.read(tmp_path / "gas.fmu")
    (kelvin,) = [unit for unit in description.units if unit.name == "K"]
    assert {base: n for base, n in kelvin.exponents.items() if n} == {"K": 1}


@pytest.mark.parametrize("level", list(hyd.GasAccumulator.levels))
def test_a_run_that_overfills_an_accumulator_or_draws_it_empty_says_so(level):
    def run(flow):
        diagram = Diagram("bottle")
        bottle = diagram.add("bottle", accumulator(level, volume=10 * l, precharge=5 * bar, oil=5.003 * l))
        source = diagram.add("source", hyd.FlowInput())
        diagram.connect(source.p, bottle.a)
        diagram.expose(flow=source.set)
        return [str(problem) for problem in simulate(diagram, until=10.0, inputs={"flow": flow}).doubts]

    assert run(0.4 * l) == run(-0.4 * l) == []
    (full,) = run(1 * l)
    assert full.startswith("bottle.oil: leaves the gas no room in its 10 l from t = 4.75 s on, with up to 15")
    (empty,) = run(-1 * l)
    assert empty.startswith("bottle.oil: is drawn below empty from t = 5.02 s on, by up to 4.997 l. Take a larger")
