"""Other people's FMUs (and ours): unpacked into a private folder, loaded, and run for co-simulation.

with Fmu("pump.fmu") as pump, pump.instantiate("pump1") as run:
    run.set("speed", 150.0)
    run.initialize(0.0)
    run.step(0.0, 0.01)
    run.get("flow")
"""

from __future__ import annotations

import _ctypes
import ctypes
import logging
import shutil
import tempfile
import weakref
from collections.abc import Mapping, Sequence
from ctypes import CFUNCTYPE, POINTER, byref, c_char_p, c_double, c_int, c_size_t, c_uint32, c_void_p
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self

import numpy as np

from seacrane.errors import FmuError, Problem, nearest
from seacrane.fmi.archive import opened, unpack
from seacrane.fmi.description import ModelDescription, Variable
from seacrane.fmi.platforms import binary_path, host, platforms
from seacrane.fmi.reading import read_archive

logger = logging.getLogger(__name__)

STATUS: Final = ("OK", "Warning", "Discard", "Error", "Fatal", "Pending")
OK, WARNING, DISCARD, ERROR, FATAL, PENDING = range(6)
_LEVELS: Final = (logging.INFO, logging.WARNING, logging.WARNING, logging.ERROR, logging.CRITICAL, logging.INFO)

_Logger = CFUNCTYPE(None, c_void_p, c_char_p, c_int, c_char_p, c_char_p)


class _Callbacks(ctypes.Structure):
    _fields_ = (
        ("logger", _Logger),
        ("allocate", c_void_p),
        ("free", c_void_p),
        ("step_finished", c_void_p),
        ("environment", c_void_p),
    )


@dataclass(frozen=True)
class Calls:
    """Addresses of fmi2SetReal, fmi2GetReal and fmi2DoStep of an FMU."""

    set: int
    get: int
    step: int


def read(path: str | Path) -> ModelDescription:
    """The model description of an FMU, without unpacking or loading it. Raises `FmuError` with all problems."""
    with opened(Path(path)) as archive:
        return read_archive(archive)


class Fmu:
    """An FMU, unpacked and its library loaded; close it, or use it in a `with` block.

    Raises `FmuError` if the archive, the model description or the library for this platform is not as it must be. The
    private folder is removed in any case.
    """

    def __init__(self, path: str | Path) -> None:
        self.path = Path(path)
        with opened(self.path) as archive:
            self.description = read_archive(archive)
            binary = self._binary(archive.namelist())
            self.folder = Path(tempfile.mkdtemp(prefix="seacrane-fmu-"))
            self._remove = weakref.finalize(self, shutil.rmtree, self.folder, ignore_errors=True)
            try:
                unpack(archive, self.folder)
                self.library = _load(self.folder / binary, self.path.name)
            except BaseException:
                self._remove()
                raise
        self._instances = 0
        self._unloaded = False
        self.calls = Calls(
            *(_address(getattr(self.library, name)) for name in ("fmi2SetReal", "fmi2GetReal", "fmi2DoStep"))
        )

    def _binary(self, names: Sequence[str]) -> str:
        slave = self.description.co_simulation
        if slave is None:
            raise FmuError.at(
                self.path.name,
                "is for model exchange only",
                allowed="an FMU with a <CoSimulation> element",
                hint="Export it for co-simulation.",
            )
        if slave.needs_execution_tool:
            raise FmuError.at(self.path.name, "needs the tool that made it in order to run, and cannot run by itself")
        binary = binary_path(slave.model_identifier)
        if binary not in names:
            raise FmuError.at(
                self.path.name,
                f"has no binary for this platform: {binary}",
                value=", ".join(platforms(names)) or "none",
                allowed=host()[0],
            )
        return binary

    def instantiate(self, name: str = "", *, logging: bool = False) -> FmuInstance:
        """A new slave; `logging` asks the FMU for its debug log. Raises `FmuError` if it refuses."""
        if self._unloaded:
            raise FmuError.at(self.path.name, "has been closed")
        return FmuInstance(self, name or self.description.model_name, logging)

    def close(self) -> None:
        """Removes the private folder and unloads the library, which stays while an instance of it is not closed."""
        self._remove()
        if not self._instances and not self._unloaded:
            self._unloaded = True
            _ctypes.dlclose(self.library._handle)  # ctypes itself never unloads: many loads would fill the memory

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


class FmuInstance:
    """A running slave. Its methods are those of `seacrane.model.native.NativeInstance`.

    What the FMU logs goes to Python's logging under this module's name, with the instance's name; the text is passed
    on as it is, since the arguments of a printf format do not reach Python.
    """

    def __init__(self, fmu: Fmu, name: str, debug: bool) -> None:
        self.fmu = fmu
        self.name = name
        self.calls = fmu.calls
        self.handle: int = 0
        self._c = fmu.library
        self._last_log = ""
        self._status = OK
        self._running = False
        self._resolved: dict[tuple[str | int, ...], Any] = {}
        self._by_name: Mapping[str, Variable] = fmu.description.by_name
        self._by_reference = {(v.type, v.value_reference): v for v in fmu.description.variables}
        own = weakref.ref(self)

        def log(_: object, instance: bytes | None, status: int, category: bytes | None, message: bytes | None) -> None:
            text = (message or b"").decode(errors="replace").strip()
            if (this := own()) is not None and status not in (OK, PENDING):
                this._last_log = text
            level = _LEVELS[status] if 0 <= status < len(_LEVELS) else logging.ERROR
            logger.log(level, "%s: %s [%s]", name, text, (category or b"").decode(errors="replace"))

        process = ctypes.CDLL(None)
        self._callbacks = _Callbacks(_Logger(log), _address(process.calloc), _address(process.free), None, None)
        resources = (fmu.folder / "resources").as_uri()
        self.handle = (
            self._c.fmi2Instantiate(
                name.encode(),
                1,
                fmu.description.guid.encode(),
                resources.encode(),
                byref(self._callbacks),
                0,
                int(debug),
            )
            or 0
        )
        if not self.handle:
            error = FmuError.at(name, f"fmi2Instantiate gave no instance{self._said()}")
            error.function = "fmi2Instantiate"
            raise error
        fmu._instances += 1

    def set(self, names: str | int | Sequence[str | int], values: Any) -> None:
        """Sets variables by name (a number is the value reference of a Real): Real, Integer, Boolean or String."""
        single = isinstance(names, (str, int))
        groups, count = self._resolve(names)
        given = [values] if single and not isinstance(values, (list, tuple, np.ndarray)) else list(values)
        if len(given) != count:
            raise FmuError.at(self.name, f"{count} variables cannot take {len(given)} values")
        for kind, places, references in groups:
            part = [given[i] for i in places]
            try:
                array = (_C_TYPES[kind] * len(part))(*(_to_c(kind, value) for value in part))
            except (TypeError, ValueError):
                raise FmuError.at(self.name, f"a value does not fit the type {kind}", value=part) from None
            self._call(f"fmi2Set{kind}", references, len(part), array)

    def get(self, names: str | int | Sequence[str | int]) -> Any:
        """The value of one variable, or several: an array if all are Real, otherwise a list."""
        groups, count = self._resolve(names)
        values: list[Any] = [None] * count
        for kind, places, references in groups:
            array = (_C_TYPES[kind] * len(places))()
            self._call(f"fmi2Get{kind}", references, len(places), array)
            for i, value in zip(places, array, strict=True):
                values[i] = bool(value) if kind == "Boolean" else value.decode() if kind == "String" else value
        if isinstance(names, (str, int)):
            return values[0]
        return np.array(values) if all(kind == "Real" for kind, _, _ in groups) else values

    @property
    def last_log(self) -> str:
        """The last thing the FMU logged with a warning or worse; it may say why a call failed."""
        return self._last_log

    def initialize(self, time: float = 0.0, stop: float | None = None, tolerance: float | None = None) -> None:
        """Sets up the experiment and goes through initialization mode; then the slave can be stepped."""
        self.enter_initialization(time, stop, tolerance)
        self.exit_initialization()

    def enter_initialization(
        self, time: float = 0.0, stop: float | None = None, tolerance: float | None = None
    ) -> None:
        """Sets up the experiment and enters initialization mode, in which outputs follow inputs that are set."""
        self._call(
            "fmi2SetupExperiment",
            int(tolerance is not None),
            tolerance or 0.0,
            time,
            int(stop is not None),
            stop or 0.0,
        )
        self._call("fmi2EnterInitializationMode")

    def exit_initialization(self) -> None:
        """Leaves initialization mode; from now on the slave can be stepped."""
        self._call("fmi2ExitInitializationMode")
        self._running = True

    def note_failure(self, status: int) -> None:
        """Tells that a call through `calls` gave this status, which decides how the slave may still be closed."""
        if status in (ERROR, FATAL):
            self._status = max(self._status, status)

    def step(self, time: float, size: float) -> None:
        """Advances from `time` by `size` [s]. Raises `FmuError`, with the status, if the slave does not get there."""
        self._call("fmi2DoStep", time, size, 1)

    def save(self) -> bytes:
        """The complete state as bytes. Raises `FmuError` if the FMU cannot give it."""
        self._need_state()
        state, size = c_void_p(), c_size_t()
        self._call("fmi2GetFMUstate", byref(state))
        try:
            self._call("fmi2SerializedFMUstateSize", state, byref(size))
            block = ctypes.create_string_buffer(size.value)
            self._call("fmi2SerializeFMUstate", state, block, size)
        finally:
            self._c.fmi2FreeFMUstate(self._live, byref(state))
        return block.raw

    def restore(self, saved: bytes) -> None:
        """Returns to a saved state."""
        self._need_state()
        state = c_void_p()
        self._call("fmi2DeSerializeFMUstate", saved, len(saved), byref(state))
        try:
            self._call("fmi2SetFMUstate", state)
        finally:
            self._c.fmi2FreeFMUstate(self._live, byref(state))

    def reset(self) -> None:
        """Back to the start values, as just instantiated."""
        self._call("fmi2Reset")
        self._running = False
        self._status = OK

    def close(self) -> None:
        """Terminates and frees the slave; after an error only frees it, after a fatal one neither."""
        if self.handle and self._status != FATAL:
            if self._running and self._status < ERROR:
                self._c.fmi2Terminate(self.handle)
            self._c.fmi2FreeInstance(self.handle)
            self.fmu._instances -= 1
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
            raise FmuError.at(self.name, "the instance is closed")
        return self.handle

    def _need_state(self) -> None:
        slave = self.fmu.description.co_simulation
        if slave is None or not (slave.saves_state and slave.serializes_state):
            raise FmuError.at(
                self.name, "the FMU cannot save its state", allowed="canGetAndSetFMUstate and canSerializeFMUstate"
            )

    def _call(self, function: str, *arguments: Any) -> None:
        self._last_log = ""
        status = getattr(self._c, function)(self._live, *arguments)
        if status in (OK, WARNING):
            return
        self._status = max(self._status, status) if status in (ERROR, FATAL) else self._status
        name = STATUS[status] if 0 <= status < len(STATUS) else str(status)
        error = FmuError.at(self.name, f"{function} returned {name}{self._said()}")
        error.function, error.status = function, status
        raise error

    def _said(self) -> str:
        return f": {self._last_log}" if self._last_log else ""

    def _resolve(self, names: str | int | Sequence[str | int]) -> tuple[list[tuple[str, list[int], Any]], int]:
        """Variables grouped by type: type, places in the caller's order, value references."""
        key = (names,) if isinstance(names, (str, int)) else tuple(names)
        found = self._resolved.get(key)
        if found is None:
            variables = [
                self._by_name.get(n) if isinstance(n, str) else self._by_reference.get(("Real", n)) for n in key
            ]
            unknown = [n for n, v in zip(key, variables, strict=True) if v is None]
            if unknown:
                raise FmuError(
                    Problem(self.name, f"has no variable {n!r}", hint=nearest(str(n), self._by_name)) for n in unknown
                )
            grouped: dict[str, tuple[list[int], list[int]]] = {}
            for i, v in enumerate(variables):
                assert v is not None
                kind = "Integer" if v.type == "Enumeration" else v.type
                places, references = grouped.setdefault(kind, ([], []))
                places.append(i)
                references.append(v.value_reference)
            found = self._resolved[key] = [
                (kind, places, (c_uint32 * len(references))(*references))
                for kind, (places, references) in grouped.items()
            ]
        return found, len(key)


_C_TYPES: Final[dict[str, Any]] = {"Real": c_double, "Integer": c_int, "Boolean": c_int, "String": c_char_p}


def _to_c(kind: str, value: Any) -> Any:
    if kind == "String":
        return str(value).encode()
    return float(value) if kind == "Real" else int(value)


_SIGNATURES: Final[dict[str, list[Any]]] = {
    "fmi2SetupExperiment": [c_void_p, c_int, c_double, c_double, c_int, c_double],
    "fmi2EnterInitializationMode": [c_void_p],
    "fmi2ExitInitializationMode": [c_void_p],
    "fmi2Terminate": [c_void_p],
    "fmi2Reset": [c_void_p],
    "fmi2DoStep": [c_void_p, c_double, c_double, c_int],
    **{
        f"fmi2{verb}{kind}": [c_void_p, c_void_p, c_size_t, c_void_p]
        for verb in ("Get", "Set")
        for kind in ("Real", "Integer", "Boolean", "String")
    },
}
_STATE_SIGNATURES: Final[dict[str, list[Any]]] = {
    "fmi2GetFMUstate": [c_void_p, POINTER(c_void_p)],
    "fmi2SetFMUstate": [c_void_p, c_void_p],
    "fmi2FreeFMUstate": [c_void_p, POINTER(c_void_p)],
    "fmi2SerializedFMUstateSize": [c_void_p, c_void_p, POINTER(c_size_t)],
    "fmi2SerializeFMUstate": [c_void_p, c_void_p, c_char_p, c_size_t],
    "fmi2DeSerializeFMUstate": [c_void_p, c_char_p, c_size_t, POINTER(c_void_p)],
}


def _load(path: Path, fmu: str) -> ctypes.CDLL:
    try:
        library = ctypes.CDLL(str(path))
    except OSError as error:
        reason = str(error).replace(str(path.parent) + "/", "")
        raise FmuError.at(
            fmu, f"its library cannot be loaded: {reason}", hint="It may be built for another system or lack a library."
        ) from None
    needed = ("fmi2Instantiate", "fmi2FreeInstance", *_SIGNATURES)
    missing = [name for name in needed if not hasattr(library, name)]
    if missing:
        raise FmuError(Problem(fmu, f"its library lacks the function {name}") for name in missing)
    library.fmi2Instantiate.restype = c_void_p
    library.fmi2Instantiate.argtypes = [c_char_p, c_int, c_char_p, c_char_p, POINTER(_Callbacks), c_int, c_int]
    library.fmi2FreeInstance.restype = None
    library.fmi2FreeInstance.argtypes = [c_void_p]
    for name, arguments in (_SIGNATURES | _STATE_SIGNATURES).items():
        if hasattr(library, name):  # what is needed is there; an FMU that saves no state may lack the rest
            getattr(library, name).restype = c_int
            getattr(library, name).argtypes = arguments
    return library


def _address(function: Any) -> int:
    address = ctypes.cast(function, c_void_p).value
    assert address is not None  # a resolved symbol has one
    return address
