"""Parameters are checked when a component is made, all at once, in the user's units."""

import dataclasses

import numpy as np
import pytest
from parts import Chamber, LinearOrifice, Orifice, PressureSource

from seacrane.errors import ParameterError
from seacrane.units import bar, mm


def refused(make):
    with pytest.raises(ParameterError) as caught:
        make()
    return str(caught.value)


def test_every_problem_is_reported_at_once():
    text = refused(lambda: Orifice(diametr=3 * mm, cd=-1.0))
    assert "diametr: is not a parameter. Did you mean 'diameter'?" in text
    assert "diameter: is missing: bore of the orifice [m]" in text
    assert "cd: -1 is out of range; allowed: above 0" in text


def test_a_value_in_the_wrong_unit_is_questioned():
    assert "280 Pa is implausible; did you mean 280 bar?" in refused(lambda: PressureSource(pressure=280))
    assert "did you mean 42 mm?" in refused(lambda: Orifice(diameter=42.0))


@pytest.mark.parametrize("value", [float("nan"), float("inf"), "5 mm", None, True, [1.0], np.ones(2)])
def test_what_is_not_a_finite_number_is_refused(value):
    assert "number in m" in refused(lambda: Orifice(diameter=value))


def test_an_unknown_level_names_the_levels_there_are():
    text = refused(lambda: Orifice(diameter=5 * mm, level="turbulant"))
    assert "has no level 'turbulant'; allowed: turbulent, linear. Did you mean 'turbulent'?" in text
    assert "Chamber: has no levels, so no 'real'" in refused(lambda: Chamber(volume=1.0, level="real"))
    assert "LinearOrifice: is the level 'linear', not 'real'" in refused(
        lambda: LinearOrifice(diameter=5 * mm, level="real")
    )


def test_a_parameter_is_named_as_the_user_has_written_it():
    text = refused(lambda: Orifice(diameter=-5 * mm, level="linear"))
    assert text.startswith("Orifice(level='linear').diameter: -0.005 m")
    assert refused(lambda: Chamber(volume=-1.0)).startswith("Chamber.volume: ")


def test_out_of_range_is_shown_in_si_and_in_the_engineering_unit():
    assert "-0.005 m = -5 mm is out of range; allowed: above 0 m" in refused(lambda: Orifice(diameter=-5 * mm))


def test_components_are_frozen_values():
    source = PressureSource(pressure=200 * bar)
    assert source == PressureSource(pressure=200 * bar)
    with pytest.raises(dataclasses.FrozenInstanceError):
        source.pressure = 1.0
    assert Chamber(volume=1e-3).pressure == 0.0
