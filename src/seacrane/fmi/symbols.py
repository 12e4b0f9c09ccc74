"""Units of FMUs as symbols of `seacrane.units`."""

from __future__ import annotations

import math
from collections.abc import Mapping

from seacrane.fmi.description import ModelDescription, UnitDefinition, Variable
from seacrane.units import UNITS, Unit


def known_units(description: ModelDescription) -> dict[str, str | None]:
    """The symbol for each unit that the FMU defines, None where there is none here."""
    return {unit.name: known_unit(unit) for unit in description.units}


def unit_symbol(v: Variable, units: Mapping[str, str | None]) -> str | None:
    """The symbol of the unit of an FMU's variable, or None if it is unknown here."""
    if not v.unit:
        return "1"
    return v.unit if v.unit in UNITS else units.get(v.unit)


def known_unit(definition: UnitDefinition) -> str | None:
    """The symbol of the unit with the exponents and the factor of an FMU's definition."""
    if definition.exponents is None:
        return definition.name if definition.name in UNITS else None
    exponents = {name: n for name, n in definition.exponents.items() if n}
    dimension = tuple(exponents.pop(base, 0) for base in ("kg", "m", "s", "rad"))
    kelvin = exponents.pop("K", 0)
    if exponents or definition.offset or definition.name in UNITS:
        return definition.name if definition.name in UNITS else None

    def same(unit: Unit) -> bool:
        same_dimension = unit.dimension == dimension and unit.kelvin == kelvin
        return same_dimension and math.isclose(unit.factor, definition.factor, rel_tol=1e-12)

    return next((unit.symbol for unit in UNITS.values() if same(unit)), None)
