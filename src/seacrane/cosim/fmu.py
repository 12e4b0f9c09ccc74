"""Slaves from FMU files."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path

from seacrane import fmi
from seacrane.cosim.compiled import CompiledInstance, started
from seacrane.cosim.slave import Instance, Interface, Slave, check_values
from seacrane.errors import ParameterError, Problem, nearest
from seacrane.fmi.symbols import known_units, unit_symbol
from seacrane.model.dae import Variable
from seacrane.units import UNITS

_REALS = ("Real", "Float64")
_NO_NUMBERS = ("String", "Binary", "Clock")


class FmuSlave(Slave):
    """An FMU as a slave. It is read here, and unpacked and loaded when it is first instantiated.

    `parameters` gives values of parameters, and start values of inputs and of other variables that have one, by name,
    in the units of the FMU; those of type String take texts. Inputs and outputs are its real scalars of that
    causality; its other real scalars can be recorded as well. What cannot be exchanged, because it is no real scalar
    or its unit is unknown here, is `left_out`.

    An FMU of both kinds is run for co-simulation unless `kind` is "model-exchange"; then it is integrated here to the
    relative `tolerance`, with its events located.

    `FmuError` if the file is not an FMU that runs here, `ParameterError` naming every value that does not fit.
    """

    def __init__(
        self,
        path: str | Path,
        parameters: Mapping[str, float | str] | None = None,
        *,
        kind: fmi.Kind | None = None,
        tolerance: float | None = None,
    ) -> None:
        self.path = Path(path)
        self.kind = kind
        self.tolerance = tolerance
        self.description = fmi.read(self.path)
        self.parameters = dict(parameters or {})
        self._loaded: fmi.Fmu | None = None
        self._open = 0
        groups: dict[str, list[Variable]] = {"input": [], "output": [], "parameter": [], "local": [], "start": []}
        left_out = {}
        units = known_units(self.description)
        for v in self.description.variables:
            symbol = unit_symbol(v, units)
            group = "local" if v.causality == "calculatedParameter" else v.causality
            real = v.type in _REALS and not v.dimensions
            if group == "independent":
                continue
            signal = real and not v.negated
            if v.type in _NO_NUMBERS or v.dimensions or symbol is None or (not signal and group != "parameter"):
                left_out[v.name] = _why_not(v)
            else:
                groups.setdefault(group, []).append(_variable(v, symbol))
                if group == "local" and v.start is not None:
                    groups["start"].append(_variable(v, symbol))
        self.left_out = tuple(left_out)
        settable = (*groups["parameter"], *groups["input"], *groups["start"])
        numbers = {n: v for n, v in self.parameters.items() if not isinstance(v, str)}
        self._texts = {n: v for n, v in self.parameters.items() if isinstance(v, str)}
        self._check_texts()
        check_values(numbers, settable, self.path.name)
        self._numbers = numbers
        self._interface = Interface(
            inputs=started(groups["input"], numbers),
            outputs=tuple(groups["output"]),
            parameters=started(groups["parameter"], numbers),
            watchable=tuple(groups["local"]),
            left_out=left_out,
        )

    @property
    def interface(self) -> Interface:
        return self._interface

    @property
    def about(self) -> str:
        return self.description.description or f"FMU {self.path.name}"

    @cached_property
    def fingerprint(self) -> str:
        """Of the content of the file, the parameters and how it is run."""
        content = hashlib.sha256(self.path.read_bytes()).hexdigest()
        return f"{content} {sorted(self.parameters.items())} {self.kind} {self.tolerance}"

    def instantiate(self, name: str) -> Instance:
        """A new instance. The FMU is unpacked and loaded with the first and gone with the last that is open."""
        fmu = self._loaded = self._loaded or fmi.Fmu(self.path, self.kind)
        self._open += 1
        references = {v.name: v.value_reference for v in self.description.variables if v.type in _REALS}
        try:
            inner = fmu.instantiate(name, tolerance=self.tolerance)
        except BaseException:
            self._closed()
            raise
        instance = FmuSlaveInstance(name, inner, self._interface, references, self._closed)
        try:
            if self._texts:
                inner.set(list(self._texts), list(self._texts.values()))
            instance.set(self._numbers)
        except BaseException:
            instance.close()
            raise
        return instance

    def _check_texts(self) -> None:
        known = [v.name for v in self.description.variables if v.type == "String" and not v.dimensions]
        problems = [
            Problem(f"{self.path.name}.{name}", "no such variable of type String", text, hint=nearest(name, known))
            for name, text in self._texts.items()
            if name not in known
        ]
        if problems:
            raise ParameterError(problems)

    def _closed(self) -> None:
        self._open -= 1
        if self._open == 0 and self._loaded is not None:
            self._loaded.close()
            self._loaded = None


class FmuSlaveInstance(CompiledInstance):
    """An instance of an FMU, which stays in initialisation mode until the coupled start values are found."""

    inner: fmi.FmuInstance

    def __init__(
        self,
        name: str,
        inner: fmi.FmuInstance,
        interface: Interface,
        references: Mapping[str, int],
        closed: Callable[[], None],
    ) -> None:
        super().__init__(name, inner, interface, references)
        self._begun = self._over = False
        self._told_when_closed = closed

    def set(self, values: Mapping[str, float]) -> None:
        if self._begun:
            variables = self.inner.fmu.description.by_name
            problems = [
                Problem(f"{self._name}.{n}", f"is {variables[n].variability} and can be set before the start only")
                for n in values
                if variables[n].variability != "tunable"
            ]
            if problems:
                raise ParameterError(problems)
        super().set(values)

    def initialise(self, time: float) -> None:
        self._give()
        self.inner.enter_initialization(time)

    def begin(self) -> None:
        self.inner.exit_initialization()
        self._begun = True

    def close(self) -> None:
        if not self._over:
            self._over = True
            super().close()
            self._told_when_closed()

    @property
    def message(self) -> str:
        return self.inner.last_log

    def failed(self, status: int) -> None:
        self.inner.note_failure(status)


def _why_not(v: fmi.Variable) -> str:
    """Why a variable cannot be exchanged."""
    if v.dimensions:
        return f"it is an array of {v.type}"
    if v.negated:
        return "it is the negative of another variable"
    return f"its unit {v.unit!r} is unknown here" if v.type in _REALS else f"it is {v.type}"


def _variable(v: fmi.Variable, symbol: str) -> Variable:
    start = float(v.start) if isinstance(v.start, (int, float)) else 0.0
    return Variable(
        v.name,
        symbol,
        start,
        v.nominal or 1.0,
        -math.inf if v.minimum is None else v.minimum,
        math.inf if v.maximum is None else v.maximum,
        v.description,
        v.display_unit if v.display_unit in UNITS else "",
    )
