"""Units: SI floats everywhere, engineering units at the edges.

A quantity is a plain `float` in SI. Its unit lives in its type, `Annotated[float, Quantity("Pa", ...)]`, from which
FMI unit definitions, JSON schemas and labels are made. Convert at the edges with constants: `280 * bar`,
`pressure / bar`. An angle is in radian, a rotational speed in rad/s.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Annotated, Final, get_args

from seacrane.errors import UnitError, nearest

# ---------------------------------------------------------------- constants: one engineering unit, in SI
mm: Final = 1e-3
cm: Final = 1e-2
km: Final = 1e3
ft: Final = 0.3048
inch: Final = 0.0254
l: Final = 1e-3  # noqa: E741  (the litre's own symbol)
cm3: Final = 1e-6
l_min: Final = 1e-3 / 60
cm3_rev: Final = 1e-6 / (2 * math.pi)
"""Displacement in m3/rad of one cm3 per revolution."""
bar: Final = 1e5
MPa: Final = 1e6
kN: Final = 1e3
kNm: Final = 1e3
kg: Final = 1.0
t: Final = 1e3
kW: Final = 1e3
deg: Final = math.pi / 180
rpm: Final = 2 * math.pi / 60
ms: Final = 1e-3
knot: Final = 1852 / 3600

GRAVITY: Final = 9.81
"""Acceleration of gravity [m/s2] used by every room."""


@dataclass(frozen=True)
class Unit:
    """A unit by its symbol: exponents of (kg, m, s, rad) and of kelvin, and the factor to SI."""

    symbol: str
    dimension: tuple[int, int, int, int]
    factor: float
    kelvin: int = 0

    def same_dimension(self, other: Unit) -> bool:
        return (self.dimension, self.kelvin) == (other.dimension, other.kelvin)


_NONE, _MASS, _LENGTH, _TIME, _ANGLE = (0, 0, 0, 0), (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)
_PRESSURE, _FLOW, _FORCE, _TORQUE = (1, -1, -2, 0), (0, 3, -1, 0), (1, 1, -2, 0), (1, 2, -2, 0)
_POWER, _SPEED, _ACCELERATION, _RATE = (1, 2, -3, 0), (0, 1, -1, 0), (0, 1, -2, 0), (0, 0, -1, 1)

UNITS: Final[dict[str, Unit]] = {
    unit.symbol: unit
    for unit in (
        Unit("1", _NONE, 1.0),
        Unit("%", _NONE, 1e-2),
        Unit("kg", _MASS, 1.0),
        Unit("t", _MASS, t),
        Unit("m", _LENGTH, 1.0),
        Unit("mm", _LENGTH, mm),
        Unit("cm", _LENGTH, cm),
        Unit("km", _LENGTH, km),
        Unit("ft", _LENGTH, ft),
        Unit("in", _LENGTH, inch),
        Unit("m2", (0, 2, 0, 0), 1.0),
        Unit("mm2", (0, 2, 0, 0), 1e-6),
        Unit("m3", (0, 3, 0, 0), 1.0),
        Unit("l", (0, 3, 0, 0), l),
        Unit("cm3", (0, 3, 0, 0), cm3),
        Unit("s", _TIME, 1.0),
        Unit("ms", _TIME, ms),
        Unit("min", _TIME, 60.0),
        Unit("rad", _ANGLE, 1.0),
        Unit("deg", _ANGLE, deg),
        Unit("Pa", _PRESSURE, 1.0),
        Unit("bar", _PRESSURE, bar),
        Unit("MPa", _PRESSURE, MPa),
        Unit("m3/s", _FLOW, 1.0),
        Unit("l/min", _FLOW, l_min),
        Unit("m3/rad", (0, 3, 0, -1), 1.0),
        Unit("cm3/rev", (0, 3, 0, -1), cm3_rev),
        Unit("N", _FORCE, 1.0),
        Unit("kN", _FORCE, kN),
        Unit("N.m", _TORQUE, 1.0),
        Unit("kN.m", _TORQUE, kNm),
        Unit("W", _POWER, 1.0),
        Unit("kW", _POWER, kW),
        Unit("J", _TORQUE, 1.0),
        Unit("kJ", _TORQUE, 1e3),
        Unit("m/s", _SPEED, 1.0),
        Unit("m/min", _SPEED, 1 / 60),
        Unit("mm/s", _SPEED, mm),
        Unit("kn", _SPEED, knot),
        Unit("m/s2", _ACCELERATION, 1.0),
        Unit("rad/s", _RATE, 1.0),
        Unit("deg/s", _RATE, deg),
        Unit("rpm", _RATE, rpm),
        Unit("rad/s2", (0, 0, -2, 1), 1.0),
        Unit("1/s", (0, 0, -1, 0), 1.0),
        Unit("Hz", (0, 0, -1, 0), 1.0),
        Unit("kg/m", (1, -1, 0, 0), 1.0),
        Unit("kg/m3", (1, -3, 0, 0), 1.0),
        Unit("kg.m2", (1, 2, 0, 0), 1.0),
        Unit("N/m", (1, 0, -2, 0), 1.0),
        Unit("kN/m", (1, 0, -2, 0), kN),
        Unit("N.s/m", (1, 0, -1, 0), 1.0),
        Unit("kN.s/m", (1, 0, -1, 0), kN),
        Unit("N.m/rad", (1, 2, -2, -1), 1.0),
        Unit("N.m.s/rad", (1, 2, -1, -1), 1.0),
        Unit("m3/(s.Pa)", (-1, 4, 1, 0), 1.0),
        Unit("m2/s", (0, 2, -1, 0), 1.0),
        Unit("mm2/s", (0, 2, -1, 0), 1e-6),
        Unit("K", _NONE, 1.0, kelvin=1),
        Unit("1/m", (0, -1, 0, 0), 1.0),
        Unit("rad/m", (0, -1, 0, 1), 1.0),
    )
}

DISPLAY: Final[dict[str, str]] = {
    "m3/s": "l/min",
    "m3/rad": "cm3/rev",
    "m3": "l",
    "m2/s": "mm2/s",
    "Pa": "bar",
    "N": "kN",
    "N.m": "kN.m",
    "W": "kW",
    "J": "kJ",
    "rad": "deg",
    "rad/s": "deg/s",
    "kg": "t",
    "N/m": "kN/m",
    "N.s/m": "kN.s/m",
}
"""The engineering unit in which a quantity of this SI unit is shown unless it says otherwise."""


def unit(symbol: str, path: str = "") -> Unit:
    """The unit of this symbol; `UnitError` with the nearest symbols if there is none."""
    try:
        return UNITS[symbol]
    except KeyError:
        raise UnitError.at(path, f"unknown unit {symbol!r}", hint=nearest(symbol, UNITS)) from None


def compatible(first: str, second: str) -> bool:
    """Whether two unit symbols are of one dimension."""
    return unit(first).same_dimension(unit(second))


def convert(value: float, source: str, target: str, path: str = "") -> float:
    """`value` given in `source`, expressed in `target`; `UnitError` if their dimensions differ."""
    a, b = unit(source, path), unit(target, path)
    if not a.same_dimension(b):
        raise UnitError.at(path, f"a quantity in {source!r} cannot be given in {target!r}", allowed=_same_dimension(b))
    return value * (a.factor / b.factor)


def display(si_symbol: str) -> str:
    """The symbol of the engineering unit in which a quantity of `si_symbol` is shown."""
    return DISPLAY.get(si_symbol, si_symbol)


# ---------------------------------------------------------------- in words: the unit "1" is never written
def with_unit(number: float | str, symbol: str, form: str = "g") -> str:
    """A number (or words such as "0 to 5") with its unit: "5 bar", and "5" if it has none."""
    text = number if isinstance(number, str) else f"{number:{form}}"
    return text if symbol == "1" else f"{text} {symbol}"


def in_unit(words: str, symbol: str) -> str:
    """ "a number in bar", and "a number" if it has no unit."""
    return words if symbol == "1" else f"{words} in {symbol}"


def labelled(name: str, symbol: str) -> str:
    """ "pressure [bar]", and the name alone if it has no unit."""
    return name if symbol == "1" else f"{name} [{symbol}]"


_QUANTITY = re.compile(r"^\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(\S.*?)?\s*$")


def parse(text: str, si_symbol: str, path: str = "") -> float:
    """The SI value of a text such as `"420 mm"` where a quantity in `si_symbol` is needed.

    A bare number is refused: in a text, the unit must be there. `UnitError` names what is allowed.
    """
    match = _QUANTITY.match(text)
    needed = unit(si_symbol)
    if match is None:
        raise UnitError.at(path, "is not a number with a unit", value=text, allowed=_same_dimension(needed))
    number, symbol = match.groups()
    if symbol is None and not needed.same_dimension(UNITS["1"]):
        raise UnitError.at(path, "the unit is missing", value=text, allowed=_same_dimension(needed))
    return convert(float(number), symbol or "1", si_symbol, path)


def value_of(text: str, symbol: str, path: str = "") -> float:
    """What a text that a user has typed means for a variable in the unit `symbol`, in that unit.

    A bare number is in the variable's own unit, that in which it is declared, recorded and shown in lists; any other
    unit of its kind may be given: 2.1e7 and "210 bar" are the same for a pressure in Pa. `UnitError` as from `parse`.
    """
    try:
        return float(text)
    except ValueError:
        return parse(text, symbol, path)


def _same_dimension(wanted: Unit) -> str:
    return ", ".join(u.symbol for u in UNITS.values() if u.same_dimension(wanted))


# ---------------------------------------------------------------- quantities: the unit in the type
@dataclass(frozen=True)
class Quantity:
    """What stands in a type: the SI unit, the engineering unit shown, and the range in which a value is plausible.

    A value outside `plausible` is not refused by itself; it is questioned when a common slip (a value typed in the
    engineering unit) would explain it.
    """

    unit: str
    shown: str = ""
    plausible: tuple[float, float] | None = None

    @property
    def display(self) -> str:
        return self.shown or display(self.unit)

    def slip(self, value: float) -> str | None:
        """The likely mistake behind an implausible value, in one sentence, or None."""
        if self.plausible is None or value == 0 or not math.isfinite(value):
            return None
        low, high = self.plausible
        if low <= abs(value) <= high:
            return None
        for symbol in dict.fromkeys((self.display, "mm", "bar", "l/min", "deg", "kN", "t", "cm3/rev", "rpm")):
            candidate = UNITS[symbol]
            same = candidate.same_dimension(UNITS[self.unit])
            if same and candidate.factor != 1.0 and low <= abs(value) * candidate.factor <= high:
                meant = f"did you mean {value:g} {symbol}?"
                return f"{with_unit(value, self.unit)} is implausible; {meant}"
        return None


Ratio = Annotated[float, Quantity("1")]
Mass = Annotated[float, Quantity("kg", plausible=(0.1, 1e9))]
Length = Annotated[float, Quantity("m", plausible=(1e-6, 5e4))]
Diameter = Annotated[float, Quantity("m", "mm", plausible=(1e-4, 20.0))]
Area = Annotated[float, Quantity("m2", "mm2", plausible=(1e-9, 1e4))]
Volume = Annotated[float, Quantity("m3", "l", plausible=(1e-7, 1e5))]
Time = Annotated[float, Quantity("s")]
Angle = Annotated[float, Quantity("rad", plausible=(1e-6, 4 * math.pi))]
Pressure = Annotated[float, Quantity("Pa", plausible=(1e3, 1e10))]
FlowRate = Annotated[float, Quantity("m3/s", plausible=(1e-9, 1.0))]
Displacement = Annotated[float, Quantity("m3/rad", plausible=(1e-9, 1e-2))]
Force = Annotated[float, Quantity("N")]
Torque = Annotated[float, Quantity("N.m")]
Power = Annotated[float, Quantity("W")]
Speed = Annotated[float, Quantity("m/s")]
Acceleration = Annotated[float, Quantity("m/s2")]
AngularSpeed = Annotated[float, Quantity("rad/s")]
ShaftSpeed = Annotated[float, Quantity("rad/s", "rpm")]
AngularFrequency = Annotated[float, Quantity("rad/s", "rad/s")]
Frequency = Annotated[float, Quantity("1/s")]
Density = Annotated[float, Quantity("kg/m3", plausible=(1.0, 2e4))]
MassPerLength = Annotated[float, Quantity("kg/m")]
Inertia = Annotated[float, Quantity("kg.m2")]
Stiffness = Annotated[float, Quantity("N/m", plausible=(1.0, 1e13))]
Damping = Annotated[float, Quantity("N.s/m")]
RotationalStiffness = Annotated[float, Quantity("N.m/rad")]
RotationalDamping = Annotated[float, Quantity("N.m.s/rad")]
Leakage = Annotated[float, Quantity("m3/(s.Pa)")]
KinematicViscosity = Annotated[float, Quantity("m2/s", "mm2/s", plausible=(1e-7, 1e-2))]
Temperature = Annotated[float, Quantity("K", plausible=(100.0, 1000.0))]


def quantity_of(annotation: object) -> Quantity | None:
    """The `Quantity` in an annotated type, or None if it carries none."""
    return next((extra for extra in get_args(annotation)[1:] if isinstance(extra, Quantity)), None)
