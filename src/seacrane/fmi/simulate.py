"""An FMU run by itself, and two of them compared."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from seacrane.errors import FmuError, ParameterError, Problem, nearest
from seacrane.fmi.description import REALS, ModelDescription, Variable
from seacrane.fmi.fmu import Fmu, Kind
from seacrane.fmi.instance import FmuInstance
from seacrane.fmi.symbols import known_units, unit_symbol
from seacrane.fmi.values import element_of
from seacrane.results import Recording, Signal
from seacrane.units import UNITS, compatible, convert, display, value_of

_Driven = tuple[str, Any, Any]
_NO_NUMBERS = ("String", "Binary", "Clock")


@dataclass(frozen=True)
class Deviation:
    """How far one signal of two runs is apart, in its unit; `relative` is the largest over the largest value."""

    name: str
    unit: str
    largest: float
    rms: float
    relative: float
    at: float


def run(
    path: str | Path,
    until: float,
    step: float,
    *,
    values: Mapping[str, Any] | None = None,
    inputs: Recording | None = None,
    outputs: Sequence[str] | None = None,
    kind: Kind | None = None,
    tolerance: float | None = None,
) -> Recording:
    """The outputs (or the variables asked for) of an FMU from its start time to `until` [s], a row each `step` [s].

    A name is that of a scalar or of an element of an array, `x[2,3]`.

    `values` are set before it starts. `inputs` are set at the beginning of each step, interpolated, in their units;
    where the FMU can take their slopes (model exchange, or canInterpolateInputs) they go on as straight lines to the
    end of the step, and are held otherwise. A doubled time in them is a jump.
    Variables in a unit that is unknown here are recorded without one. `ParameterError` with all names that do not fit,
    `FmuError` if the FMU fails.
    """
    if not 0 < step < math.inf:
        raise ParameterError.at("step", "must be a positive number of seconds", value=step)
    if not math.isfinite(until):
        raise ParameterError.at("until", "must be a finite number of seconds", value=until)
    with Fmu(path, kind) as fmu:
        d = fmu.description
        names = _outputs(d, outputs)
        driven = _inputs(d, inputs)
        begin = d.experiment.start or 0.0
        count = round((until - begin) / step)
        if count < 1:
            raise ParameterError.at("until", f"must be at least a step after the start at {begin:g} s", value=until)
        times = np.array([begin + step * i for i in range(count + 1)])
        table = np.empty((count + 1, len(names)))
        with fmu.instantiate(tolerance=tolerance) as instance:
            if values:
                instance.set(list(values), list(values.values()))
            _drive(instance, driven, begin)
            instance.initialize(begin, tolerance=tolerance)
            table[0] = instance.get(names)
            for i in range(count):
                _drive(instance, driven, times[i], times[i + 1])
                instance.step(times[i], times[i + 1] - times[i])
                table[i + 1] = instance.get(names)
        units = known_units(d)
        signals = {}
        for i, name in enumerate(names):
            v = d.by_name[name] if name in d.by_name else instance.variable(name)
            unit = unit_symbol(v, units) or "1"
            shown = v.display_unit if v.display_unit in UNITS and compatible(unit, v.display_unit) else display(unit)
            signals[name] = Signal(unit, shown, table[:, i])
        return Recording(times, signals)


def compare(first: Recording, second: Recording) -> list[Deviation]:
    """How far the signals that both have are apart, at the times of the first; the largest relative one comes first.

    `ParameterError` if they have no signal or no time in common.
    """
    names = [name for name in first if name in second]
    if not names:
        raise ParameterError.at("", "the two have no output in common")
    inside = (first.time >= second.time[0] - 1e-12) & (first.time <= second.time[-1] + 1e-12)
    if not inside.any():
        raise ParameterError.at("time", "the two have no time in common")
    deviations = []
    for name in names:
        a, b = first.signal(name), second.signal(name)
        factor = convert(1.0, b.unit, a.unit, name)
        difference = np.abs(np.interp(first.time[inside], second.time, factor * b.values) - a.values[inside])
        worst = int(np.argmax(difference))
        scale = float(max(np.abs(a.values).max(), np.abs(factor * b.values).max()))
        largest = float(difference[worst])
        deviations.append(
            Deviation(
                name,
                a.unit,
                largest,
                float(np.sqrt(np.mean(difference**2))),
                largest / scale if scale > 0 else 0.0,
                float(first.time[inside][worst]),
            )
        )
    return sorted(deviations, key=lambda deviation: -deviation.relative)


def parse(v: Variable, text: str, unit: str | None = None) -> Any:
    """The value that a text gives to a variable: of an array, its elements with spaces between them.

    A real scalar may have a unit, as "210 bar", if that of the variable is known (`unit`, a symbol of
    `seacrane.units`); a bare number is in the variable's own. An enumeration takes the name of an item or its number.
    """
    if v.dimensions and v.type not in _NO_NUMBERS:
        return [_scalar(v, item, None) for item in text.replace(",", " ").split()]
    return _scalar(v, text, unit)


def _scalar(v: Variable, text: str, unit: str | None) -> Any:
    try:
        if v.type in REALS:
            return float(text) if unit is None else value_of(text, unit, v.name)
        if v.type == "Boolean":
            return {"true": True, "1": True, "false": False, "0": False}[text.strip().lower()]
        if v.type == "Binary":
            return bytes.fromhex(text)
        return text if v.type == "String" or text in v.items else int(text)
    except (ValueError, KeyError):
        allowed = ", ".join(v.items) or None
        raise FmuError.at(v.name, f"is {v.type} and cannot take this value", value=text, allowed=allowed) from None


def _outputs(d: ModelDescription, asked: Sequence[str] | None) -> list[str]:
    numbers = [v.name for v in d.variables if v.type not in _NO_NUMBERS and not v.dimensions]
    if asked is None:
        found = [n for n in numbers if d.by_name[n].causality == "output"]
        if not found:
            raise ParameterError.at(d.model_name, "has no outputs that are numbers; name the variables to record")
        return found
    elements = {n for n in asked if (e := element_of(n, d.by_name)) is not None and e[0].type not in _NO_NUMBERS}
    unknown = [name for name in asked if name not in numbers and name not in elements]
    if unknown:
        raise ParameterError(Problem(n, "is no number that can be recorded", hint=nearest(n, numbers)) for n in unknown)
    return list(asked)


def _inputs(d: ModelDescription, given: Recording | None) -> list[_Driven]:
    """Name, times and values in the FMU's unit of each input that is given."""
    if given is None:
        return []
    known = {v.name: v for v in d.inputs if v.type in REALS and not v.dimensions}
    unknown = [name for name in given if name not in known]
    if unknown:
        raise ParameterError(Problem(n, "is no input of real numbers", hint=nearest(n, known)) for n in unknown)
    units = known_units(d)
    driven = []
    for name in given:
        signal, unit = given.signal(name), unit_symbol(known[name], units)
        factor = 1.0 if unit is None else convert(1.0, signal.unit, unit, name)
        driven.append((name, given.time, factor * signal.values))
    return driven


def _drive(instance: FmuInstance, driven: Sequence[_Driven], time: float, end: float | None = None) -> None:
    """Sets the inputs of a step from `time` to `end` [s], with their slopes if the FMU takes them."""
    if not driven:
        return
    names = [name for name, _, _ in driven]
    values = np.array([np.interp(time, t, x) for _, t, x in driven])
    instance.set(names, values)
    if end is None or not instance.interpolates:
        return
    just_before = time + (end - time) * (1 - 1e-12)
    ramps = np.array([np.interp(just_before, t, x) for _, t, x in driven])
    continuous = [i for i, name in enumerate(names) if instance.variable(name).variability == "continuous"]
    slopes = (ramps - values) / (just_before - time)
    instance.set_derivatives([names[i] for i in continuous], slopes[continuous])
