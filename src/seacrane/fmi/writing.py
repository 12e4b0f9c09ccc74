"""What the model descriptions of FMI 2.0 and FMI 3.0 have in common when we write them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Final
from xml.sax.saxutils import quoteattr

import seacrane
from seacrane.fmi.naming import is_structured
from seacrane.model.codegen import Entry, Generated
from seacrane.units import UNITS

HEAD: Final = '<?xml version="1.0" encoding="UTF-8"?>'

KINDS: Final = {
    "INPUT": ("input", "continuous", None),
    "OUTPUT": ("output", "continuous", "calculated"),
    "PARAMETER": ("parameter", "tunable", "exact"),
    "MODE": ("local", "discrete", "exact"),
    "SETTING": ("parameter", "tunable", "exact"),
    "STATE": ("local", "continuous", "exact"),
    "DERIVATIVE": ("local", "continuous", "calculated"),
    "ALGEBRAIC": ("local", "continuous", "approx"),
    "OBSERVABLE": ("local", "continuous", "calculated"),
    "INDICATOR": ("local", "continuous", "calculated"),
    "TIME": ("independent", "continuous", None),
}
"""Causality, variability and initial for each kind of variable."""

LOG_CATEGORIES: Final = (
    "  <LogCategories>",
    '    <Category name="logStatusError" description="a call that failed, and why"/>',
    '    <Category name="logStatusDiscard" description="a step that could not be done, and why"/>',
    "  </LogCategories>",
)
EXPERIMENT: Final = '  <DefaultExperiment startTime="0" stopTime="10" tolerance="1e-05"/>'


def model_identifier(name: str) -> str:
    """The name as a C identifier, which names the binary."""
    identifier = re.sub(r"\W", "_", name, flags=re.ASCII)
    return f"m_{identifier}" if not identifier or identifier[0].isdigit() else identifier


def attributes(values: Mapping[str, str | None]) -> str:
    """XML attributes, each after a space; those that are None are left out."""
    return "".join(f" {key}={quoteattr(value)}" for key, value in values.items() if value is not None)


def about(model: Generated) -> dict[str, str | None]:
    """Attributes of the root element that both versions have."""
    structured = all(is_structured(e.variable.name) for e in model.entries)
    return {
        "description": model.dae.about or None,
        "generationTool": f"seacrane {seacrane.__version__}",
        "variableNamingConvention": "structured" if structured else "flat",
    }


def starts(entry: Entry) -> bool:
    """Whether the variable has a start value."""
    causality, _, initial = KINDS[entry.kind]
    return causality == "input" or initial in ("exact", "approx")


def number(entry: Entry) -> dict[str, str | None]:
    """Unit, bounds, nominal and start value of a variable, as attributes."""
    v = entry.variable
    return {
        "unit": v.unit or None,
        "displayUnit": v.display_unit if v.unit and v.display_unit != v.unit else None,
        "min": _bound(v.minimum),
        "max": _bound(v.maximum),
        "nominal": repr(float(v.nominal)) if v.nominal != 1 and entry.kind != "SETTING" else None,
        "start": repr(float(v.start)) if starts(entry) else None,
    }


def state_of(derivative: Entry) -> str:
    """The name of the state of which this entry is the derivative."""
    return derivative.variable.name[len("der(") : -1]


def names(entries: Sequence[Entry], *kinds: str) -> list[str]:
    """The names of the variables of these kinds, kind by kind."""
    return [e.variable.name for kind in kinds for e in entries if e.kind == kind]


def units(entries: Iterable[Entry]) -> list[str]:
    """The lines of <UnitDefinitions>: every unit that is used, with the units in which it is shown."""
    shown: dict[str, set[str]] = {}
    for entry in entries:
        v = entry.variable
        if v.unit:
            shown.setdefault(v.unit, set()).update({v.display_unit} - {v.unit})
    lines = ["  <UnitDefinitions>"]
    for symbol in sorted(shown):
        unit = UNITS[symbol]
        base = {e: str(n) for e, n in zip(("kg", "m", "s", "rad"), unit.dimension, strict=True) if n}
        if unit.kelvin:
            base["K"] = str(unit.kelvin)
        if unit.factor != 1:
            base["factor"] = repr(unit.factor)
        lines.append(f'    <Unit name="{symbol}"><BaseUnit{attributes(base)}/>')
        for display in sorted(shown[symbol]):
            factor = unit.factor / UNITS[display].factor
            lines.append(f'      <DisplayUnit name="{display}" factor="{factor!r}"/>')
        lines.append("    </Unit>")
    return [*lines, "  </UnitDefinitions>"]


def _bound(value: float) -> str | None:
    return None if math.isinf(value) else repr(float(value))
