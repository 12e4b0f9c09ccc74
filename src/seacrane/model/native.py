"""Compiled models: the C of a model built by the system's compiler, and its instances, driven by name.

native = build(dae)
with native.instantiate() as pump:
    pump.set("shaft.w", 150.0)
    pump.initialize(0.0)
    pump.step(0.0, 0.01)
    pump.get("port.q")
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping, Sequence
from ctypes import POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint32, c_uint64, c_void_p
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seacrane.errors import ParameterError, Problem, SolveError, nearest
from seacrane.model.codegen import Entry, Generated, generate
from seacrane.model.dae import Dae, Variable
from seacrane.model.failure import Stop, explained
from seacrane.model.singular import Point
from seacrane.native import build_library
from seacrane.units import in_unit, with_unit

Reals = NDArray[np.float64]
Reference = str | int
"""A variable by name or by value reference."""

OK: Final = 0
DISCARD: Final = 2
ERROR: Final = 3


@dataclass(frozen=True)
class Calls:
    """Addresses of the C functions of a slave: fmi2SetReal, fmi2GetReal, fmi2DoStep, fmi2SetRealInputDerivatives."""

    set: int
    get: int
    step: int
    derive: int = 0
    """That of fmi2SetRealInputDerivatives; 0 where inputs are held over a step."""
    save: int = 0
    restore: int = 0
    release: int = 0
    """Those of fmi2GetFMUstate, fmi2SetFMUstate and fmi2FreeFMUstate."""
    directional: int = 0
    """That of fmi2GetDirectionalDerivative."""


@dataclass(frozen=True)
class Statistics:
    """What an instance has done since it was made or reset."""

    steps: int
    rejected: int
    residuals: int
    jacobians: int
    factorizations: int


@dataclass(frozen=True)
class Happening:
    """An event that has happened, and when [s]."""

    time: float
    name: str


KEPT_EVENTS: Final = 256
"""How many events an instance remembers."""


class _Samples(ctypes.Structure):
    _fields_ = (
        ("inputs", c_size_t),
        ("count", c_size_t),
        ("reference", c_void_p),
        ("time", c_void_p),
        ("value", c_void_p),
        ("linear", c_int),
    )


def build(dae: Dae) -> NativeModel:
    """Compiles a model, or finds it compiled before.

    Raises `CompileError` if there is no C compiler or it fails, `StructureError` if start or nominal values are unfit.
    """
    generated = generate(dae)
    return NativeModel(generated, build_library("model", generated.sources, ["-w"]))


class NativeModel:
    """A compiled model: immutable, shared by its instances.

    `variables` maps each name to its entry (variable, kind, value reference); it includes `solver.tolerance`,
    `solver.fixed_step` and `der(x)` of each state x.
    """

    def __init__(self, generated: Generated, path: Path) -> None:
        self.dae = generated.dae
        self.name = generated.dae.name
        self.guid = generated.guid
        self.path = path
        self.sources = generated.sources
        self.entries = generated.entries
        self.time = generated.time
        self.variables: Mapping[str, Entry] = {e.variable.name: e for e in generated.entries}
        self.by_reference: Mapping[int, Entry] = {e.reference: e for e in generated.entries}
        self.library = _declare(ctypes.CDLL(str(path)))
        names = (
            "SetReal",
            "GetReal",
            "DoStep",
            "SetRealInputDerivatives",
            "GetFMUstate",
            "SetFMUstate",
            "FreeFMUstate",
            "GetDirectionalDerivative",
        )
        self.calls = Calls(*(_address(getattr(self.library, f"fmi2{name}")) for name in names))

    def value_reference(self, name: str) -> int:
        """The value reference of a variable; `ParameterError` with the nearest names if there is none of this name."""
        try:
            return self.variables[name].reference
        except KeyError:
            raise ParameterError.at(
                self.name, f"has no variable {name!r}", hint=nearest(name, self.variables)
            ) from None  # fmt: skip

    def instantiate(self, name: str = "") -> NativeInstance:
        """A new instance, named for its messages; it holds the start values until `initialize`."""
        return NativeInstance(self, name or self.name)


class NativeInstance:
    """One running copy of a compiled model.

    Variables are given by name or value reference, one or several. `handle` is the C instance, for `calls`.
    """

    def __init__(self, model: NativeModel, name: str) -> None:
        self.model = model
        self.name = name
        self.calls = model.calls
        self._c = model.library
        self._references: dict[tuple[Reference, ...], Any] = {}
        self._implicit = True
        self.handle: int = self._c.fmi2Instantiate(name.encode(), 1, model.guid.encode(), None, None, 0, 0)
        if not self.handle:
            raise SolveError.at(name, "could not be instantiated: not enough memory")

    @property
    def time(self) -> float:
        """The present time [s]."""
        return float(self._c.seacrane_time(self._live))

    @property
    def statistics(self) -> Statistics:
        """Steps and evaluations so far."""
        counts = (c_uint64 * 5)()
        self._c.seacrane_statistics(self._live, counts)
        return Statistics(*counts)

    def events(self, first: int = 0) -> tuple[int, tuple[Happening, ...]]:
        """How many events have happened since the instance was made or reset, and those from number `first` on.

        The last 256 are remembered; of those before nothing but their number is known.
        """
        count = int(self._c.seacrane_events(self._live, 0, 0, None, None))
        first = max(first, count - KEPT_EVENTS)
        time, index = (c_double * (count - first))(), (c_int * (count - first))()
        self._c.seacrane_events(self._live, first, count - first, time, index)
        names = [e.name for e in self.model.dae.events]
        return count, tuple(Happening(t, names[i]) for t, i in zip(time, index, strict=True))

    def set(self, names: Reference | Sequence[Reference], values: ArrayLike) -> None:
        """Sets inputs and parameters at any time, states and starts of algebraic unknowns before `initialize`.

        Raises `ParameterError` for an unknown name, a value that is not finite or out of its bounds, or a variable that
        cannot be set now; then nothing is set.
        """
        references, count = self._resolve(names)
        array = np.ascontiguousarray(values, dtype=np.float64).reshape(-1)
        if array.size != count:
            raise ParameterError.at(self.name, f"{count} variables cannot take {array.size} values")
        if self._c.fmi2SetReal(self._live, references, count, array.ctypes.data) != OK:
            raise ParameterError(self._refused(names, array))

    @overload
    def get(self, names: Reference) -> float: ...  # type: ignore[overload-overlap]  # a text is a sequence of texts
    @overload
    def get(self, names: Sequence[Reference]) -> Reals: ...
    def get(self, names: Reference | Sequence[Reference]) -> float | Reals:
        """The present value of one variable, or the values of several as an array."""
        references, count = self._resolve(names)
        array = np.empty(count)
        if self._c.fmi2GetReal(self._live, references, count, array.ctypes.data) != OK:
            raise self._failure()
        return float(array[0]) if isinstance(names, (str, int)) else array

    def initialize(self, time: float = 0.0) -> None:
        """Solves the algebraic equations at the start time [s]; from now on the instance can be stepped.

        Raises `SolveError` if they have no solution that Newton's method finds from the start values.
        """
        if (
            self._c.fmi2SetupExperiment(self._live, 0, 0.0, time, 0, 0.0) != OK
            or self._c.fmi2EnterInitializationMode(self._live) != OK
            or self._c.fmi2ExitInitializationMode(self._live) != OK
        ):
            raise self._failure()

    def step(self, time: float, size: float) -> None:
        """Advances from `time`, which must be the present time, by `size` [s], with the inputs held.

        Raises `SolveError` if it cannot, with what stands out where it stopped; the instance is then left at the last
        good point, `self.time`.
        """
        status = self._c.fmi2DoStep(self._live, time, size, 0)
        if status != OK:
            failure = self._failure(status)
            raise self.explained(failure) if status == DISCARD else failure

    def explained(self, failure: SolveError) -> SolveError:
        """The failure of a step with what stands out at the point where the instance stopped, and what to try."""
        stop = Stop(self.point(), {}, False, self.get("solver.tolerance"), self._implicit)
        return explained(failure, self.model.dae, stop)

    def point(self) -> Point:
        """Where the instance stands. Algebraic unknowns that have no solution there are told by their start values."""
        dae = self.model.dae
        x, u, p = (self.get([v.name for v in group]) for group in (dae.states, dae.inputs, dae.constants))
        try:
            z = self.get([v.name for v in dae.algebraics])
        except SolveError:
            z = np.array([v.start for v in dae.algebraics])
        return Point(self.time, x, z, u, p)

    def set_derivatives(self, names: Reference | Sequence[Reference], values: ArrayLike, order: int = 1) -> None:
        """Time derivatives of inputs at the present time, for the next `step` alone: lines, or parabolas by `order` 2.

        After that step the inputs stay where it has brought them. Raises `ParameterError` for what is no input, a value
        that is not finite, or another order.
        """
        references, count = self._resolve(names)
        array = np.ascontiguousarray(values, dtype=np.float64).reshape(-1)
        if array.size != count:
            raise ParameterError.at(self.name, f"{count} variables cannot take {array.size} values")
        orders = (c_int * count)(*[order] * count)
        status = self._c.fmi2SetRealInputDerivatives(self._live, references, count, orders, array.ctypes.data)
        if status != OK:
            raise ParameterError.at(self.name, self._message())

    def simulate(
        self,
        times: ArrayLike,
        record: Sequence[Reference],
        inputs: Mapping[str, tuple[ArrayLike, ArrayLike]] | None = None,
        *,
        linear: bool = False,
    ) -> Reals:
        """Runs over `times` [s] in one call and returns the variables of `record` at each: (len(times), len(record)).

        Outputs end no step of the adaptive method, unless the model has events; they are interpolated to the tolerance.
        `inputs` gives for each input its sample times and values: held between samples, or joined by straight lines if
        `linear`. A time given twice is a jump. Raises `SolveError` if a step fails, with the rows before as `results`.
        """
        grid = np.ascontiguousarray(times, dtype=np.float64).reshape(-1)
        if not np.all(np.isfinite(grid)) or np.any(np.diff(grid) < 0) or (grid.size and grid[0] < self.time):
            raise SolveError.at(
                self.name, f"output times must be finite, not falling, and not before the present time {self.time:g} s"
            )
        result = np.empty((grid.size, len(record)))
        done = c_size_t()
        references, count = self._resolve(list(record))
        samples, _kept = self._samples(inputs or {}, linear)
        status = self._c.seacrane_simulate(
            self._live, grid.size, grid.ctypes.data, byref(samples), count, references, result.ctypes.data, byref(done)
        )
        if status != OK:
            failure = self._failure(status)
            failure.results = result[: done.value]
            raise failure
        return result

    def step_explicitly(self, order: int, step: float) -> None:
        """Uses an explicit method of fixed `step` [s] from now on: Euler's (order 1) or Runge-Kutta's (order 4).

        For comparison: the implicit methods, to which order 0 returns, are faster on every stiff model.
        """
        if order not in (0, 1, 4) or not (order == 0 or 0 < step < np.inf):
            raise SolveError.at(self.name, f"has no explicit method of order {order} and step {step:g} s")
        self._c.seacrane_explicit(self._live, order, step)
        self._implicit = order == 0

    def save(self) -> bytes:
        """The complete state; `restore` brings it back bit for bit."""
        block = ctypes.create_string_buffer(self._c.seacrane_state_size())
        self._c.seacrane_save(self._live, block)
        return block.raw

    def restore(self, saved: bytes) -> None:
        """Returns to a saved state. Raises `SolveError` if it is not one of this model."""
        size = self._c.seacrane_state_size()
        if len(saved) != size:
            raise SolveError.at(self.name, f"{len(saved)} bytes are not a state of this model, which has {size}")
        if self._c.seacrane_restore(self._live, saved) != OK:
            raise self._failure()

    def reset(self) -> None:
        """Back to the start values, as just instantiated."""
        self._c.fmi2Reset(self._live)

    def close(self) -> None:
        """Frees the instance; it cannot be used afterwards."""
        if self.handle:
            self._c.fmi2FreeInstance(self.handle)
            self.handle = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "handle", 0):
            self.close()

    @property
    def _live(self) -> int:
        if not self.handle:
            raise SolveError.at(self.name, "the instance is closed")
        return self.handle

    def _resolve(self, names: Reference | Sequence[Reference]) -> tuple[Any, int]:
        """Value references as a C array, kept so that a repeated call costs one look-up."""
        key = (names,) if isinstance(names, (str, int)) else tuple(names)
        found = self._references.get(key)
        if found is None:
            unknown = [
                n for n in key if n not in (self.model.variables if isinstance(n, str) else self.model.by_reference)
            ]
            if unknown:
                raise ParameterError(
                    Problem(self.name, f"has no variable {n!r}", hint=nearest(str(n), self.model.variables))
                    for n in unknown
                )
            numbers = [self.model.variables[n].reference if isinstance(n, str) else n for n in key]
            found = self._references[key] = (c_uint32 * len(numbers))(*numbers)
        return found, len(key)

    def _samples(
        self, inputs: Mapping[str, tuple[ArrayLike, ArrayLike]], linear: bool
    ) -> tuple[_Samples, tuple[Any, ...]]:
        """All inputs on the union of their sample times, and the arrays to keep alive."""
        if not inputs:
            return _Samples(), ()
        names = list(inputs)
        references, count = self._resolve(names)
        problems = []
        series = []
        for name in names:
            t, v = (np.asarray(a, dtype=np.float64).reshape(-1) for a in inputs[name])
            if self.model.variables[name].kind != "INPUT":
                problems.append(
                    Problem(name, "is not an input", hint=nearest(name, [i.name for i in self.model.dae.inputs]))
                )
            if t.size != v.size or t.size == 0:
                problems.append(Problem(name, f"has {t.size} sample times for {v.size} values"))
            elif np.any(np.diff(t) < 0) or not (np.all(np.isfinite(t)) and np.all(np.isfinite(v))):
                problems.append(Problem(name, "sample times must not fall, and times and values must be finite"))
            series.append((t, v))
        if problems:
            raise ParameterError(problems)
        first = series[0][0]
        if all(t.shape == first.shape and np.array_equal(t, first) for t, _ in series):
            time, columns = first, [v for _, v in series]
        else:
            time, columns = _on_one_axis(series, linear)
        time = np.ascontiguousarray(time)
        values = np.ascontiguousarray(np.stack(columns, axis=1))
        samples = _Samples(
            count, time.size, ctypes.addressof(references), time.ctypes.data, values.ctypes.data, int(linear)
        )
        return samples, (references, time, values)

    def _refused(self, names: Reference | Sequence[Reference], values: Reals) -> list[Problem]:
        """Why the core refused to set these values, one problem for each that is wrong in itself."""
        key = (names,) if isinstance(names, (str, int)) else tuple(names)
        problems = []
        for name, value in zip(key, values.tolist(), strict=True):
            entry = self.model.variables[name] if isinstance(name, str) else self.model.by_reference[name]
            v = entry.variable
            bounded = entry.kind in ("PARAMETER", "SETTING")
            if not np.isfinite(value) or (bounded and not v.minimum <= value <= v.maximum):
                problems.append(Problem(v.name, f"cannot be {with_unit(value, v.unit)}", allowed=_range(v, bounded)))
        return problems or [Problem(self.name, self._message())]

    def _message(self) -> str:
        return str(self._c.seacrane_message(self._live).decode())

    def _failure(self, status: int = ERROR) -> SolveError:
        hint = None
        if status == DISCARD:
            hint = "Look at the parameters around that variable, at inputs that jump, and at solver.tolerance."
        return SolveError.at(self.name, self._message(), hint=hint)


def _range(variable: Variable, bounded: bool) -> str:
    if not bounded or (np.isinf(variable.minimum) and np.isinf(variable.maximum)):
        return in_unit("a finite number", variable.unit)
    if np.isinf(variable.maximum):
        return f"at least {with_unit(variable.minimum, variable.unit)}"
    if np.isinf(variable.minimum):
        return f"at most {with_unit(variable.maximum, variable.unit)}"
    return with_unit(f"{variable.minimum:g} to {variable.maximum:g}", variable.unit)


def _on_one_axis(series: Sequence[tuple[Reals, Reals]], linear: bool) -> tuple[Reals, list[Reals]]:
    """Several sampled signals on the union of their times, each time twice: its value before and after."""
    union = np.unique(np.concatenate([t for t, _ in series]))
    time = np.repeat(union, 2)
    columns = []
    for t, v in series:
        left = np.clip(np.searchsorted(t, union, side="left") - 1, 0, t.size - 1)
        right = np.clip(np.searchsorted(t, union, side="right") - 1, 0, t.size - 1)
        column = np.empty(time.size)
        column[1::2] = v[right]
        column[0::2] = v[left]
        if linear:
            exact = np.isin(union, t)
            column[0::2][exact] = v[np.searchsorted(t, union[exact], side="left")]
            between = np.interp(union[~exact], t, v)
            column[0::2][~exact] = between
            column[1::2][~exact] = between
        columns.append(column)
    return time, columns


def _address(function: Any) -> int:
    address = ctypes.cast(function, c_void_p).value
    assert address is not None  # a resolved symbol has one
    return address


def _declare(library: ctypes.CDLL) -> ctypes.CDLL:
    signatures: dict[str, tuple[Any, list[Any]]] = {
        "fmi2Instantiate": (c_void_p, [c_char_p, c_int, c_char_p, c_char_p, c_void_p, c_int, c_int]),
        "fmi2FreeInstance": (None, [c_void_p]),
        "fmi2SetupExperiment": (c_int, [c_void_p, c_int, c_double, c_double, c_int, c_double]),
        "fmi2EnterInitializationMode": (c_int, [c_void_p]),
        "fmi2ExitInitializationMode": (c_int, [c_void_p]),
        "fmi2Reset": (c_int, [c_void_p]),
        "fmi2SetReal": (c_int, [c_void_p, c_void_p, c_size_t, c_void_p]),
        "fmi2GetReal": (c_int, [c_void_p, c_void_p, c_size_t, c_void_p]),
        "fmi2DoStep": (c_int, [c_void_p, c_double, c_double, c_int]),
        "fmi2SetRealInputDerivatives": (c_int, [c_void_p, c_void_p, c_size_t, c_void_p, c_void_p]),
        "seacrane_events": (c_uint64, [c_void_p, c_uint64, c_size_t, c_void_p, c_void_p]),
        "seacrane_simulate": (
            c_int,
            [c_void_p, c_size_t, c_void_p, POINTER(_Samples), c_size_t, c_void_p, c_void_p, POINTER(c_size_t)],
        ),
        "seacrane_explicit": (None, [c_void_p, c_int, c_double]),
        "seacrane_message": (c_char_p, [c_void_p]),
        "seacrane_time": (c_double, [c_void_p]),
        "seacrane_state_size": (c_size_t, []),
        "seacrane_save": (None, [c_void_p, c_void_p]),
        "seacrane_restore": (c_int, [c_void_p, c_char_p]),
        "seacrane_statistics": (None, [c_void_p, c_void_p]),
    }
    for name, (result, arguments) in signatures.items():
        function = getattr(library, name)
        function.restype, function.argtypes = result, arguments
    return library
