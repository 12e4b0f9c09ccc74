"""Slaves from FMU files."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path

import numpy as np

from seacrane import fmi
from seacrane.cosim.compiled import CompiledInstance, started
from seacrane.cosim.slave import Instance, Interface, NativeCalls, Slave, check_values
from seacrane.errors import ParameterError, Problem, nearest
from seacrane.fmi.description import REALS
from seacrane.fmi.symbols import known_units, unit_symbol
from seacrane.model.dae import Variable
from seacrane.units import UNITS

MOST_ELEMENTS = 4096
"""Elements of an array that are signals; a larger one is left out."""
MOST_SIGNALS = 200_000
"""Signals of an FMU; what would make more of them is left out."""


class FmuSlave(Slave):
    """An FMU as a slave. It is read here, and unpacked and loaded when it is first instantiated.

    Its numbers of all types are signals: reals, integers, truths (0 or 1) and enumerations (the numbers of the items);
    of an array each element, `x[2,3]`, counted from 1. Integers are exact up to 2^53, and what is given to one must be
    whole. Inputs and outputs are those of that causality; what is local can be recorded as well. What cannot be
    exchanged, such as texts, binaries and variables in a unit that is unknown here, is `left_out` with the reason.

    `parameters` gives values of parameters, and start values of inputs and of other variables that have one, by name,
    in the units of the FMU: texts and bytes for what is String or Binary, and the name of an item for an enumeration.

    An FMU of both kinds is run for co-simulation unless `kind` is "model-exchange"; then it is integrated here to the
    relative `tolerance`, with its events located.

    `FmuError` if the file is not an FMU that runs here, `ParameterError` naming every value that does not fit.
    """

    def __init__(
        self,
        path: str | Path,
        parameters: Mapping[str, float | str | bytes] | None = None,
        *,
        kind: fmi.Kind | None = None,
        tolerance: float | None = None,
    ) -> None:
        self.path = Path(path)
        self.kind = kind
        self.tolerance = tolerance
        self.description = fmi.read(self.path)
        self.parameters = dict(parameters or {})
        self.folder: object | None = None
        """What must live as long as the file is needed: the private folder of the archive that it came in."""
        self._loaded: fmi.Fmu | None = None
        self._open = 0
        groups: dict[str, list[Variable]] = {"input": [], "output": [], "parameter": [], "local": [], "start": []}
        left_out: dict[str, str] = {}
        kinds: dict[str, str] = {}
        self._plain = True
        count = 0
        units = known_units(self.description)
        for v in self.description.variables:
            symbol = unit_symbol(v, units)
            if v.causality == "independent":
                continue
            reason = _why_not(v, symbol)
            if not reason and (count := count + v.count) > MOST_SIGNALS:
                reason = f"the FMU has more than {MOST_SIGNALS} signals before it"
            if not reason and v.causality != "parameter" and not _is_plain(v) and not fmi.exchanges_all_types():
                reason = f"it is {v.type}, which needs a C compiler to be exchanged"
            if reason or symbol is None:
                left_out[v.name] = reason
                continue
            group = "local" if v.causality == "calculatedParameter" else v.causality
            signals = _signals(v, symbol)
            groups[group] += signals
            kinds |= dict.fromkeys((s.name for s in signals), kind_of(v))
            if group in ("local", "output") and v.initial in ("exact", "approx") and v.variability != "constant":
                groups["start"] += signals
            if group != "parameter":
                self._plain = self._plain and _is_plain(v)
        self.left_out = tuple(left_out)
        numbers, self._others = self._sorted_parameters()
        self.settable = (*groups["parameter"], *groups["input"], *groups["start"])
        check_values(numbers, self.settable, self.path.name)
        self._numbers = numbers
        self._interface = Interface(
            inputs=started(groups["input"], numbers),
            outputs=started(groups["output"], numbers),
            parameters=started(groups["parameter"], numbers),
            watchable=started(groups["local"], numbers),
            left_out=left_out,
            kinds=kinds,
        )

    def _sorted_parameters(self) -> tuple[dict[str, float], dict[str, str | bytes]]:
        """What was given as numbers, names of items turned into them, and what was given as text or bytes."""
        numbers: dict[str, float] = {}
        others: dict[str, str | bytes] = {}
        problems = []
        texts = [v.name for v in self.description.variables if v.type in ("String", "Binary") and not v.dimensions]
        for name, value in self.parameters.items():
            v = self.description.by_name.get(name)
            if not isinstance(value, (str, bytes)):
                numbers[name] = float(value)
            elif v is not None and v.items and isinstance(value, str):
                if value in v.items:
                    numbers[name] = v.items[value]
                else:
                    problems.append(Problem(f"{self.path.name}.{name}", "no such item", value, ", ".join(v.items)))
            else:
                kind = "String" if isinstance(value, str) else "Binary"
                if v is None or v.type != kind or v.dimensions:
                    hint = nearest(name, texts)
                    problems.append(
                        Problem(f"{self.path.name}.{name}", f"no such variable of type {kind}", value, hint=hint)
                    )
                others[name] = value
        if problems:
            raise ParameterError(problems)
        return numbers, others

    @property
    def interface(self) -> Interface:
        return self._interface

    @cached_property
    def feedthrough(self) -> Mapping[str, Collection[str]]:
        """From the model structure; an output that it says nothing of depends on all inputs."""
        names = {i: v.name for i, v in enumerate(self.description.variables, 1)}
        inputs = {v.name for v in self._interface.inputs}
        known = {names[u.index]: u.dependencies for u in self.description.outputs}
        found: dict[str, Collection[str]] = {}
        for output in self._interface.outputs:
            on = known.get(output.name)
            found[output.name] = inputs if on is None else inputs.intersection(names[i] for i in on)
        return found

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
        try:
            inner = fmu.instantiate(name, tolerance=self.tolerance)
        except BaseException:
            self._closed()
            raise
        try:
            instance = FmuSlaveInstance(name, inner, self._interface, self._plain, self._closed)
        except BaseException:
            inner.close()
            self._closed()
            raise
        try:
            if self._others:
                inner.set(list(self._others), list(self._others.values()))
            instance.set(self._numbers)
        except BaseException:
            instance.close()
            raise
        return instance

    @contextmanager
    def held(self) -> Iterator[None]:
        """The FMU stays unpacked and loaded within, so that instances after the first are made in less time."""
        self._loaded = self._loaded or fmi.Fmu(self.path, self.kind)
        self._open += 1
        try:
            yield
        finally:
            self._closed()

    def _closed(self) -> None:
        self._open -= 1
        if self._open == 0 and self._loaded is not None:
            self._loaded.close()
            self._loaded = None


class FmuSlaveInstance(CompiledInstance):
    """An instance of an FMU, which stays in initialisation mode until the coupled start values are found."""

    inner: fmi.FmuInstance

    def __init__(
        self, name: str, inner: fmi.FmuInstance, interface: Interface, plain: bool, closed: Callable[[], None]
    ) -> None:
        names = [v.name for v in (*interface.inputs, *interface.outputs, *interface.watchable)]
        variables = inner.fmu.description.by_name
        references = {n: variables[n].value_reference for n in names} if plain else {}
        super().__init__(name, inner, interface, references)
        self._exchange: fmi.Exchange | None = None
        if not plain:
            exchange = self._exchange = inner.exchange(names)
            calls = exchange.calls
            self.calls = NativeCalls(
                exchange.handle, calls.set, calls.step, calls.get, exchange.references, calls.derive
            )
        self._begun = self._over = False
        self._told_when_closed = closed

    def set(self, values: Mapping[str, float]) -> None:
        if self._begun:
            problems = [
                Problem(f"{self._name}.{n}", f"is {v.variability} and can be set before the start only")
                for n in values
                if (v := self.inner.variable(n)).variability != "tunable"
            ]
            if problems:
                raise ParameterError(problems)
        super().set(values)

    def restore(self, state: bytes) -> None:
        super().restore(state)
        if self._exchange is not None:
            self._exchange.forget()

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
        said = self.inner.last_log
        return said or (self._exchange.message if self._exchange is not None else "")

    def failed(self, status: int) -> None:
        self.inner.note_failure(status)


def _why_not(v: fmi.Variable, symbol: str | None) -> str:
    """Why a variable cannot be exchanged; empty if it can."""
    if v.type == "Clock":
        return "it is a clock, and clocks are not supported"
    if v.type in ("String", "Binary"):
        return f"it is {v.type}, which is no signal, and can be given as a parameter"
    if v.causality == "structuralParameter":
        return "it sizes arrays, and changing it is not supported"
    if v.count > MOST_ELEMENTS:
        return f"it is an array of {v.count} elements, more than {MOST_ELEMENTS}"
    return "" if symbol is not None else f"its unit {v.unit!r} is unknown here"


def kind_of(v: fmi.Variable) -> str:
    """What a variable holds, whatever its width: Real, Integer (the item of an enumeration too), or its other type."""
    if v.type in ("Boolean", "String", "Binary", "Clock"):
        return v.type
    return "Real" if v.type in REALS else "Integer"


def _is_plain(v: fmi.Variable) -> bool:
    """Whether the FMU's own functions for real numbers exchange it."""
    return v.type in ("Real", "Float64") and not v.dimensions and not v.negated


def _signals(v: fmi.Variable, symbol: str) -> list[Variable]:
    """The variable, or each element of an array."""
    low, high = fmi.bounds(v)
    about = v.description
    if v.items:
        about = "; ".join(filter(None, (about, ", ".join(f"{n} {name}" for name, n in v.items.items()))))
    starts = v.start if isinstance(v.start, tuple) else (v.start,)
    places: Iterable[tuple[int, ...]] = np.ndindex(*v.shape) if v.dimensions else ((),)
    return [
        Variable(
            f"{v.name}[{','.join(str(n + 1) for n in place)}]" if v.dimensions else v.name,
            symbol,
            float(start) if isinstance(start := starts[i if len(starts) == v.count else 0], (int, float)) else 0.0,
            v.nominal or 1.0,
            low if v.minimum is None else max(low, v.minimum),
            high if v.maximum is None else min(high, v.maximum),
            about,
            v.display_unit if v.display_unit in UNITS else "",
        )
        for i, place in enumerate(places)
    ]
