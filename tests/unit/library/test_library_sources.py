import pytest

from seacrane.errors import ParameterError
from seacrane.library import hydraulics as hyd
from seacrane.units import bar, cm3_rev, l_min, rpm


def test_a_constant_pressure_pump_holds_its_pressure_at_any_flow(law):
    pump = hyd.ConstantPressurePump(pressure=210 * bar)
    for flow in (-1e-3, 0.0, 1e-2):
        values = law(pump, {"p.q": flow}, through=("p",))
        assert values["p.p"] == 210 * bar
        assert values["supplied_power"] == pytest.approx(-210 * bar * flow)


def test_a_constant_flow_pump_delivers_displacement_times_speed(law):
    pump = hyd.ConstantFlowPump(displacement=100 * cm3_rev, speed=1500 * rpm)
    values = law(pump, {"p.p": 200 * bar})
    assert values["p.q"] == pytest.approx(-150 * l_min)
    assert values["supplied_power"] == pytest.approx(50e3)


def test_an_open_tank_is_at_gauge_pressure_zero(law):
    assert law(hyd.Tank(), {"p.q": 1e-2}, through=("p",))["p.p"] == 0.0


def test_a_plug_lets_nothing_pass(law):
    assert law(hyd.Plug(), {"a.p": 300 * bar})["a.q"] == 0.0


def test_boundary_inputs_give_what_they_are_told(law):
    assert law(hyd.FlowInput(), {"set": 1e-3, "p.p": 1e6})["p.q"] == -1e-3
    values = law(hyd.PressureInput(), {"set": 5e5, "p.q": -2e-3}, through=("p",))
    assert values["p.p"] == 5e5
    assert values["q"] == 2e-3


def test_a_pressure_typed_in_bar_is_questioned():
    with pytest.raises(ParameterError) as caught:
        hyd.ConstantPressurePump(pressure=210)
    assert "did you mean 210 bar?" in str(caught.value)


def test_a_volume_of_oil_rises_by_bulk_modulus_over_volume(law):
    volume = hyd.ControlVolume(volume=2e-3, bulk_modulus=1.2e9, pressure=50 * bar)
    values = law(volume, {"a.q": 1e-4}, through=("a",))
    assert values["a.p"] == 50 * bar
    assert values["der(pressure)"] == pytest.approx(1.2e9 / 2e-3 * 1e-4)
    assert values["stored_power"] == pytest.approx(50 * bar * 1e-4)
