"""An instance of an FMU that runs, of FMI 2.0 or 3.0, for co-simulation or with our solver for model exchange."""

from __future__ import annotations

import ctypes
import logging
import weakref
from collections.abc import Mapping, Sequence
from ctypes import byref, c_size_t, c_uint32, c_void_p
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np

from seacrane.errors import FmuError, Problem, nearest
from seacrane.fmi.api import FMI2, FMI3, Callbacks2, Logger2, Logger3, address
from seacrane.fmi.description import REALS, Variable
from seacrane.fmi.foreign import Foreign

if TYPE_CHECKING:
    from seacrane.fmi.fmu import Fmu

logger = logging.getLogger(__name__)

STATUS: Final = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
_LEVELS: Final = (logging.INFO, logging.WARNING, logging.WARNING, logging.ERROR, logging.CRITICAL, logging.INFO)


@dataclass(frozen=True)
class Calls:
    """Addresses of C functions with the signatures of fmi2SetReal, fmi2GetReal and fmi2DoStep.

    `derive` is that of fmi2SetRealInputDerivatives, 0 if the FMU holds its inputs over a step.
    """

    set: int
    get: int
    step: int
    derive: int = 0


class FmuInstance:
    """A running FMU. Its methods are those of `seacrane.model.native.NativeInstance`.

    `calls` are addresses of C functions with the signatures of FMI 2, whatever the version and kind of the FMU, and
    `handle` is what they take first. What the FMU logs goes to Python's logging under this package's name, with the
    instance's name; the text is passed on as it is, since the arguments of a printf format do not reach Python.
    """

    def __init__(self, fmu: Fmu, name: str, debug: bool, tolerance: float | None) -> None:
        self.fmu = fmu
        self.name = name
        self.handle: int = 0
        self._component: int = 0
        self._api = fmu.api
        self._c = fmu.library
        self._last_log = ""
        self._status = OK
        self._running = False
        self._resolved: dict[tuple[str | int, ...], Any] = {}
        self._by_name: Mapping[str, Variable] = fmu.description.by_name
        reals = ("Real", "Float64")
        self._by_reference = {v.value_reference: v for v in reversed(fmu.description.variables) if v.type in reals}
        slave = fmu.description.co_simulation
        self._event_mode = self._api is FMI3 and not fmu.exchange and slave is not None and slave.event_mode
        if tolerance is None:
            tolerance = fmu.description.experiment.tolerance or 1e-6
        self._foreign: Foreign | None = None
        if fmu.exchange or self._api is FMI3:
            self._foreign = Foreign(
                name, self._c, self._api, fmu.description, fmu.exchange, self._event_mode, max(tolerance, 1e-12)
            )
        self._component = self._create(debug) or 0
        if not self._component:
            function = self._api.prefix + self._api.creators[int(fmu.exchange)]
            tool = fmu.description.generation_tool or "the tool that made it"
            hint = f"It needs {tool} to run." if fmu.capabilities.needs_execution_tool else None
            error = FmuError.at(name, f"{function} gave no instance{self._said()}", hint=hint)
            error.function = function
            raise error
        fmu.open_instances += 1
        if self._foreign is None:
            self.handle = self._component
            names = ["SetReal", "GetReal", "DoStep"]
            if slave is not None and slave.interpolates_inputs and hasattr(self._c, "fmi2SetRealInputDerivatives"):
                names.append("SetRealInputDerivatives")
            self.calls = Calls(*(address(getattr(self._c, f"fmi2{name}")) for name in names))
        else:
            self.handle = self._foreign.handle
            self._foreign.state.fmu = self._component
            c = self._foreign.c
            self.calls = Calls(*(address(getattr(c, f"seacrane_foreign_{n}")) for n in ("set", "get", "step")))

    def _create(self, debug: bool) -> int | None:
        own, name = weakref.ref(self), self.name

        def log(status: int, category: bytes | None, message: bytes | None) -> None:
            text = (message or b"").decode(errors="replace").strip()
            if (this := own()) is not None and status not in (OK, PENDING):
                this._last_log = text
            level = _LEVELS[status] if 0 <= status < len(_LEVELS) else logging.ERROR
            logger.log(level, "%s: %s [%s]", name, text, (category or b"").decode(errors="replace"))

        resources = self.fmu.folder / "resources"
        guid = self.fmu.description.guid.encode()
        create = getattr(self._c, self._api.prefix + self._api.creators[int(self.fmu.exchange)])
        made: int | None
        if self._api is FMI2:
            process = ctypes.CDLL(None)
            self._logger: Any = Logger2(lambda _, __, status, category, message: log(status, category, message))
            self._callbacks = Callbacks2(self._logger, address(process.calloc), address(process.free), None, None)
            kind = 0 if self.fmu.exchange else 1
            made = create(name.encode(), kind, guid, resources.as_uri().encode(), byref(self._callbacks), 0, int(debug))
            return made
        self._logger = Logger3(lambda _, status, category, message: log(status, category, message))
        folder = f"{resources}/".encode() if resources.is_dir() else None
        if self.fmu.exchange:
            made = create(name.encode(), guid, folder, False, debug, None, self._logger)
        else:
            mode = self._event_mode
            made = create(name.encode(), guid, folder, False, debug, mode, mode, None, 0, None, self._logger, None)
        return made

    def set(self, names: str | int | Sequence[str | int], values: Any) -> None:
        """Sets variables by name (a number is the value reference of a real one); an array takes all its elements."""
        single = isinstance(names, (str, int))
        groups, count = self._resolve(names)
        given = [values] if single else list(values)
        if len(given) != count:
            raise FmuError.at(self.name, f"{count} variables cannot take {len(given)} values")
        for v in (
            self._by_name[n] for n in ([names] if isinstance(names, (str, int)) else names) if isinstance(n, str)
        ):
            if v.causality == "structuralParameter":
                raise FmuError.at(self.name, f"{v.name} sizes arrays, and changing it is not supported")
        if self._running and self._foreign is not None:
            self._adapted("seacrane_foreign_open")
        for group in groups:
            flat = [item for i, size in group.places for item in self._flat(given[i], size, names, i)]
            try:
                array = (self._api.types[group.kind] * len(flat))(*(_to_c(group.kind, value) for value in flat))
            except (TypeError, ValueError):
                raise FmuError.at(self.name, f"a value does not fit the type {group.kind}", value=flat) from None
            if group.kind == "Binary":
                kept = [ctypes.create_string_buffer(bytes(value), len(value) or 1) for value in flat]
                array = (c_void_p * len(flat))(*(ctypes.addressof(block) for block in kept))
                sizes = (c_size_t * len(flat))(*(len(value) for value in flat))
                self._call("SetBinary", group.references, len(group.places), sizes, array, len(flat))
            elif self._api is FMI2:
                self._call(f"Set{group.kind}", group.references, len(group.places), array)
            else:
                self._call(f"Set{group.kind}", group.references, len(group.places), array, len(flat))

    def _flat(self, value: Any, size: int | None, names: Any, i: int) -> list[Any]:
        """The elements of what was given for one variable; `size` is None for a scalar."""
        if size is None:
            return [value.item() if isinstance(value, np.ndarray) and value.size == 1 else value]
        elements = [value] if isinstance(value, (str, bytes)) else list(np.asarray(value, dtype=object).ravel())
        if len(elements) != size:
            name = names if isinstance(names, (str, int)) else names[i]
            raise FmuError.at(self.name, f"{name} has {size} elements and cannot take {len(elements)} values")
        return elements

    def get(self, names: str | int | Sequence[str | int]) -> Any:
        """The value of one variable, or several: an array if all are real scalars, otherwise a list.

        Of an array variable it is a numpy array of its shape.
        """
        groups, count = self._resolve(names)
        values: list[Any] = [None] * count
        for group in groups:
            total = sum(1 if size is None else size for _, size in group.places)
            array = (self._api.types[group.kind] * total)()
            read: list[Any]
            if group.kind == "Binary":
                sizes = (c_size_t * total)()
                self._call("GetBinary", group.references, len(group.places), sizes, array, total)
                read = [ctypes.string_at(p, n) if p else b"" for p, n in zip(array, sizes, strict=True)]
            elif self._api is FMI2:
                self._call(f"Get{group.kind}", group.references, len(group.places), array)
                read = list(array)
            else:
                self._call(f"Get{group.kind}", group.references, len(group.places), array, total)
                read = list(array)
            if group.kind in ("Boolean", "String"):
                read = [bool(v) if group.kind == "Boolean" else (v or b"").decode(errors="replace") for v in read]
            start = 0
            for (i, size), shape in zip(group.places, group.shapes, strict=True):
                if size is None:
                    values[i] = read[start]
                else:
                    part = read[start : start + size]
                    values[i] = np.array(part, dtype=None if group.kind != "Binary" else object).reshape(shape)
                start += 1 if size is None else size
        if isinstance(names, (str, int)):
            return values[0]
        scalars = all(g.kind in REALS and all(size is None for _, size in g.places) for g in groups)
        return np.array(values) if scalars else values

    @property
    def last_log(self) -> str:
        """The last thing the FMU logged with a warning or worse; it may say why a call failed."""
        return self._last_log or (self._foreign.message if self._foreign is not None else "")

    def initialize(self, time: float = 0.0, stop: float | None = None, tolerance: float | None = None) -> None:
        """Sets up the experiment and goes through initialization mode; then the slave can be stepped."""
        self.enter_initialization(time, stop, tolerance)
        self.exit_initialization()

    def enter_initialization(
        self, time: float = 0.0, stop: float | None = None, tolerance: float | None = None
    ) -> None:
        """Sets up the experiment and enters initialization mode, in which outputs follow inputs that are set."""
        known = int(tolerance is not None), tolerance or 0.0, time, int(stop is not None), stop or 0.0
        if self._api is FMI2:
            self._call("SetupExperiment", *known)
            self._call("EnterInitializationMode")
        else:
            self._call("EnterInitializationMode", *known)
        self._time = time

    def exit_initialization(self) -> None:
        """Leaves initialization mode, and the events at the start; from now on the instance can be stepped."""
        self._call("ExitInitializationMode")
        if self._foreign is not None:
            self._foreign.size(*self._sizes())
            self._adapted("seacrane_foreign_begin", self._time)
        self._running = True

    def _sizes(self) -> tuple[int, int]:
        """How many continuous states and event indicators the model has."""
        if not self.fmu.exchange:
            return 0, 0
        if self._api is FMI2:
            return len(self.fmu.description.derivatives), self.fmu.description.event_indicators
        states, indicators = c_size_t(), c_size_t()
        self._call("GetNumberOfContinuousStates", byref(states))
        self._call("GetNumberOfEventIndicators", byref(indicators))
        return states.value, indicators.value

    def note_failure(self, status: int) -> None:
        """Tells that a call through `calls` gave this status, which decides how the slave may still be closed."""
        if status in (ERROR, FATAL):
            self._status = max(self._status, status)

    def step(self, time: float, size: float) -> None:
        """Advances from `time` by `size` [s]. Raises `FmuError`, with the status, if it does not get there."""
        if self._foreign is None:
            self._call("DoStep", time, size, 1)
        else:
            self._adapted("seacrane_foreign_step", time, size, 1)

    def save(self) -> bytes:
        """The complete state as bytes. Raises `FmuError` if the FMU cannot give it."""
        get, _, free, size_of, serialize, _ = self._state_functions()
        state, size = c_void_p(), c_size_t()
        self._call(get, byref(state))
        try:
            self._call(size_of, state, byref(size))
            block = ctypes.create_string_buffer(size.value)
            self._call(serialize, state, block, size)
        finally:
            getattr(self._c, self._api.prefix + free)(self._live, byref(state))
        return (self._foreign.save() if self._foreign is not None else b"") + block.raw

    def restore(self, saved: bytes) -> None:
        """Returns to a saved state."""
        _, set_, free, _, _, deserialize = self._state_functions()
        own = self._foreign.saved_size if self._foreign is not None else 0
        if len(saved) < own:
            raise FmuError.at(self.name, "the saved state is not one of this FMU", value=f"{len(saved)} bytes")
        block = saved[own:]
        state = c_void_p()
        self._call(deserialize, block, len(block), byref(state))
        try:
            self._call(set_, state)
        finally:
            getattr(self._c, self._api.prefix + free)(self._live, byref(state))
        if self._foreign is not None:
            self._foreign.restore(saved[:own])

    def reset(self) -> None:
        """Back to the start values, as just instantiated."""
        self._call("Reset")
        self._running = False
        self._status = OK

    def close(self) -> None:
        """Terminates and frees the slave; after an error only frees it, after a fatal one neither."""
        if self._component and self._status != FATAL:
            if self._running and self._status < ERROR:
                getattr(self._c, f"{self._api.prefix}Terminate")(self._component)
            getattr(self._c, f"{self._api.prefix}FreeInstance")(self._component)
            self.fmu.open_instances -= 1
        self._component = self.handle = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __del__(self) -> None:
        if getattr(self, "_component", 0):
            self.close()

    @property
    def _live(self) -> int:
        if not self._component:
            raise FmuError.at(self.name, "the instance is closed")
        return self._component

    def _state_functions(self) -> list[str]:
        """Names of the functions that get, set, free, measure, serialise and deserialise a state."""
        can = self.fmu.capabilities
        if not (can.saves_state and can.serializes_state):
            raise FmuError.at(
                self.name, "the FMU cannot save its state", allowed="canGetAndSetFMUstate and canSerializeFMUstate"
            )
        return list(self._api.state)

    def _call(self, function: str, *arguments: Any) -> None:
        self._last_log = ""
        name = self._api.prefix + function
        self._check(name, getattr(self._c, name)(self._live, *arguments))

    def _adapted(self, function: str, *arguments: Any) -> None:
        """Calls a function of the adapter, which calls several of the FMU."""
        assert self._foreign is not None
        self._last_log = ""
        _ = self._live
        status = getattr(self._foreign.c, function)(self._foreign.handle, *arguments)
        self._check("the step" if function.endswith("step") else "event handling", status, self._foreign.message)

    def _check(self, what: str, status: int, reason: str = "") -> None:
        if status in (OK, WARNING):
            return
        self._status = max(self._status, status) if status in (ERROR, FATAL) else self._status
        name = STATUS[status] if 0 <= status < len(STATUS) else str(status)
        error = FmuError.at(self.name, f"{what} returned {name}{f': {reason}' if reason else ''}{self._said()}")
        error.function, error.status = what, status
        raise error

    def _said(self) -> str:
        return f": {self._last_log}" if self._last_log else ""

    def _resolve(self, names: str | int | Sequence[str | int]) -> tuple[list[_Group], int]:
        """Variables grouped by the type of the functions that set and get them."""
        key = (names,) if isinstance(names, (str, int)) else tuple(names)
        found = self._resolved.get(key)
        if found is None:
            variables = [self._by_name.get(n) if isinstance(n, str) else self._by_reference.get(n) for n in key]
            unknown = [n for n, v in zip(key, variables, strict=True) if v is None]
            if unknown:
                raise FmuError(
                    Problem(self.name, f"has no variable {n!r}", hint=nearest(str(n), self._by_name)) for n in unknown
                )
            grouped: dict[str, list[tuple[int, Variable]]] = {}
            for i, v in enumerate(variables):
                assert v is not None
                if v.type == "Clock":
                    raise FmuError.at(self.name, f"{v.name} is a clock, and clocks are not supported")
                kind = v.type
                if kind == "Enumeration":
                    kind = "Integer" if self._api is FMI2 else "Int64"
                grouped.setdefault(kind, []).append((i, v))
            found = self._resolved[key] = [
                _Group(
                    kind,
                    [(i, v.count if v.dimensions else None) for i, v in members],
                    [v.shape for _, v in members],
                    (c_uint32 * len(members))(*(v.value_reference for _, v in members)),
                )
                for kind, members in grouped.items()
            ]
        return found, len(key)


@dataclass(frozen=True)
class _Group:
    """Variables of one type: place among the names and number of elements of each (None for a scalar), references."""

    kind: str
    places: list[tuple[int, int | None]]
    shapes: list[tuple[int, ...]]
    references: Any


def _to_c(kind: str, value: Any) -> Any:
    if kind == "String":
        return str(value).encode()
    if kind == "Binary":
        if not isinstance(value, bytes):
            raise TypeError(value)
        return None  # the address is set later
    return float(value) if kind in REALS else int(value)
