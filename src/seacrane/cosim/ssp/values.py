"""Units, parameter sets (.ssv) and parameter mappings (.ssm)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from seacrane.cosim.documents import Document
from seacrane.cosim.ssp.schema import INTEGERS, REALS
from seacrane.fmi.description import UnitDefinition
from seacrane.fmi.symbols import known_unit
from seacrane.fmi.xml import EXPONENTS, Element
from seacrane.units import UNITS, compatible, convert

Units = Mapping[str, str | None]
"""Our symbol for each unit that a file defines; None where there is none."""


@dataclass(frozen=True)
class Value:
    """A value of a parameter: a number in a unit, if it states one, or a text.

    In the unit of what takes it, the number is multiplied by `gain`, and `bias` is added.
    """

    value: float | str
    unit: str = ""
    gain: float = 1.0
    bias: float = 0.0

    def within(self, unit: str) -> float | str:
        """The value for a variable in a unit of the same dimension, or in one that is not stated (`1`)."""
        if isinstance(self.value, str):
            return self.value
        number = self.value if "1" in (unit, self.unit or "1") else convert(self.value, self.unit, unit)
        return self.gain * number + self.bias

    def fits(self, unit: str) -> bool:
        """Whether the dimension of the value is that of a unit, as far as both are stated."""
        return "1" in (unit, self.unit or "1") or compatible(self.unit, unit)


def read_units(document: Document, parent: Element) -> Units:
    """Units as the file defines them under this element."""
    found: dict[str, str | None] = {}
    for group in parent.all("Units"):
        for element in group.all("Unit"):
            name = document.text(element, "name")
            base = element.first("BaseUnit") or Element("BaseUnit", {}, element.line)
            exponents = {k: n for k in EXPONENTS if (n := document.integer(base, k, 0))}
            factor, offset = document.number(base, "factor", 1.0), document.number(base, "offset", 0.0)
            found[name] = known_unit(UnitDefinition(name, exponents, factor, offset))
    return found


def symbol(document: Document, element: Element, units: Units) -> str:
    """The unit that an element states, or nothing; a unit that is unknown here is a problem."""
    name = element.attributes.get("unit", "")
    found = units.get(name, name if name in UNITS else None)
    if name and found is None:
        document.found(element, f"unit {name!r} is unknown here")
    return found or ""


def read_set(document: Document, root: Element, defined: Units) -> dict[str, Value]:
    """The values of a parameter set by name."""
    units = {**defined, **read_units(document, root)}
    items = {
        document.text(e, "name"): {document.text(i, "name"): document.number(i, "value") for i in e.all("Item")}
        for group in root.all("Enumerations")
        for e in group.all("Enumeration")
    }
    values = {}
    for group in root.all("Parameters"):
        for parameter in group.all("Parameter"):
            typed = next((e for e in parameter.children if e.tag != "Annotations"), None)
            if typed is None:
                document.found(parameter, "<Parameter> has no value")
                continue
            value = _value(document, typed, units, items)
            if value is not None:
                values[document.text(parameter, "name")] = value
    return values


def _value(document: Document, typed: Element, units: Units, items: Mapping[str, Mapping[str, float]]) -> Value | None:
    text = document.text(typed, "value")
    if typed.tag in REALS:
        return Value(document.number(typed, "value"), symbol(document, typed, units))
    if typed.tag in INTEGERS:
        return Value(float(document.integer(typed, "value")))
    if typed.tag == "Boolean":
        return Value(float(document.boolean(typed, "value")))
    if typed.tag == "Enumeration":
        tables = [items[typed.attributes["name"]]] if typed.attributes.get("name") in items else items.values()
        number = next((table[text] for table in tables if text in table), None)
        if number is None:
            document.found(typed, f"{text!r} is an item of no enumeration of the file")
        return None if number is None else Value(number)
    if typed.tag in ("String", "Binary"):
        return Value(text)
    document.found(typed, f"<{typed.tag}> is no type", allowed="Real, Integer, Boolean, String, Enumeration, Binary")
    return None


def mapped(document: Document, root: Element, values: Mapping[str, Value]) -> dict[str, Value]:
    """What a parameter mapping makes of values: only those it maps, under their new names."""
    found = {}
    for entry in root.all("MappingEntry"):
        source, target = document.text(entry, "source"), document.text(entry, "target")
        if source in values:
            value = transformed(document, entry, values[source])
            found[target] = replace(value, unit="") if document.boolean(entry, "suppressUnitConversion") else value
    return found


def transformed(document: Document, parent: Element, value: Value) -> Value:
    """A value after the transformation that an element holds, if it holds one."""
    for element in parent.children:
        if element.tag == "LinearTransformation":
            factor, offset = linear(document, element)
            return replace(value, gain=factor * value.gain, bias=factor * value.bias + offset)
        if element.tag in ("BooleanMappingTransformation", "IntegerMappingTransformation"):
            read = document.boolean if element.tag.startswith("Boolean") else document.integer
            table = {float(read(e, "source")): float(read(e, "target")) for e in element.all("MapEntry")}
            return replace(value, value=table.get(float(value.value), value.value))
        if element.tag == "EnumerationMappingTransformation":
            document.found(element, "mappings of enumerations by the names of their items are not supported")
    return value


def linear(document: Document, element: Element) -> tuple[float, float]:
    """Factor and offset of a linear transformation: target = factor * source + offset."""
    return document.number(element, "factor", 1.0), document.number(element, "offset", 0.0)


def below(values: Mapping[str, Value], element: str) -> dict[str, Value]:
    """Those values whose hierarchical names begin with an element's, under their names in it."""
    prefix = f"{element}."
    return {name[len(prefix) :]: value for name, value in values.items() if name.startswith(prefix)}
