"""Units convert as an independent library says, and refuse what is no such quantity."""

import pint
import pytest

from seacrane import units
from seacrane.errors import UnitError
from seacrane.units import UNITS, Pressure, Quantity, compatible, convert, parse, quantity_of

ORACLE = pint.UnitRegistry()
SPELT = {
    "%": "percent",
    "t": "metric_ton",
    "l": "liter",
    "l/min": "liter/minute",
    "cm3/rev": "cm**3/revolution",
    "kn": "knot",
    "in": "inch",
    "1": "dimensionless",
    "rpm": "revolution/minute",
}


def spelt(symbol):
    text = SPELT.get(symbol, symbol).replace(".", "*")
    for power in "23":
        for base in ("mm", "cm", "m", "s"):
            text = text.replace(f"{base}{power}", f"{base}**{power}")
    return ORACLE(text)


@pytest.mark.parametrize("symbol", sorted(UNITS))
def test_every_unit_has_the_factor_of_an_independent_library(symbol):
    assert UNITS[symbol].factor == pytest.approx(spelt(symbol).to_base_units().magnitude, rel=1e-12)


@pytest.mark.parametrize("symbol", sorted(UNITS))
def test_every_unit_has_the_dimension_of_an_independent_library(symbol):
    mass, length, time, angle = UNITS[symbol].dimension
    kelvin = UNITS[symbol].kelvin
    assert spelt(symbol).check(f"[mass]**{mass} * [length]**{length} * [time]**{time} * [temperature]**{kelvin}")
    assert (angle != 0) == any(a in symbol for a in ("rad", "deg", "rev", "rpm"))


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("420 mm", "m", 0.42),
        ("280bar", "Pa", 280e5),
        ("-5 deg", "rad", -5 * units.deg),
        ("1e3", "1", 1e3),
        (".5 t", "kg", 500),
    ],
)
def test_texts_are_read_with_their_unit(text, unit, value):
    assert parse(text, unit) == pytest.approx(value)


@pytest.mark.parametrize(
    ("text", "unit", "says"),
    [
        ("420 kg", "m", "'kg' cannot be given in 'm'; allowed: m, mm, cm, km, ft, in"),
        ("420", "m", "the unit is missing"),
        ("420 mmm", "m", "unknown unit 'mmm'. Did you mean 'mm'"),
        ("wide", "m", "is not a number with a unit"),
    ],
)
def test_a_wrong_text_says_what_is_allowed(text, unit, says):
    with pytest.raises(UnitError) as caught:
        parse(text, unit, "crane.boom.bore")
    assert says in str(caught.value)
    assert "crane.boom.bore" in str(caught.value)


def test_what_is_shown_converts_back():
    for si, shown in units.DISPLAY.items():
        assert compatible(si, shown)
        assert convert(convert(3.5, shown, si), si, shown) == pytest.approx(3.5)


def test_a_slip_of_the_unit_is_recognised_only_where_it_explains_the_value():
    pressure = quantity_of(Pressure)
    assert isinstance(pressure, Quantity)
    assert pressure.slip(280.0) == "280 Pa is implausible; did you mean 280 bar?"
    assert pressure.slip(280e5) is None
    assert pressure.slip(0.0) is None


def test_a_number_without_a_unit_is_written_without_one():
    assert units.with_unit(5.0, "1") == "5"
    assert units.with_unit(1.23456, "bar", ".3g") == "1.23 bar"
    assert units.with_unit("0 to 5", "m") == "0 to 5 m"
    assert units.in_unit("a number", "1") == "a number"
    assert units.in_unit("a number", "bar") == "a number in bar"
    assert units.labelled("spool", "1") == "spool"
    assert units.labelled("p", "bar") == "p [bar]"
