"""The C functions of FMI 1.0, 2.0 and 3.0 as ctypes sees them, and the loading of an FMU's library."""

from __future__ import annotations

import _ctypes
import ctypes
from collections.abc import Mapping
from ctypes import (
    POINTER,
    c_bool,
    c_char_p,
    c_double,
    c_float,
    c_int,
    c_int8,
    c_int16,
    c_int32,
    c_int64,
    c_size_t,
    c_uint8,
    c_uint16,
    c_uint32,
    c_uint64,
    c_void_p,
)
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from seacrane.errors import FmuError, Problem


class Callbacks1(ctypes.Structure):
    """fmiCallbackFunctions of FMI 1.0 for Co-Simulation."""

    _fields_ = (("logger", c_void_p), ("allocate", c_void_p), ("free", c_void_p), ("step_finished", c_void_p))


class Callbacks2(ctypes.Structure):
    """fmi2CallbackFunctions."""

    _fields_ = (
        ("logger", c_void_p),
        ("allocate", c_void_p),
        ("free", c_void_p),
        ("step_finished", c_void_p),
        ("environment", c_void_p),
    )


@dataclass(frozen=True)
class Api:
    """A version of the interface: the arguments of its functions and the C types of its values.

    Functions are named without their prefix. `state` are those that an FMU need not have, in the order get, set, free,
    measure, serialise and deserialise; so are `derivatives`.
    """

    prefix: str
    types: Mapping[str, Any]
    common: Mapping[str, list[Any]]
    slave: Mapping[str, list[Any]]
    model: Mapping[str, list[Any]]
    state: Mapping[str, list[Any]]
    derivatives: Mapping[str, list[Any]]
    creators: tuple[str, str]
    """The functions that make an instance for co-simulation and for model exchange."""
    free: str = "FreeInstance"
    terminate: str = "Terminate"
    reset: str = "Reset"

    def of_type(self, kind: str) -> str:
        """The type of the functions that set and get variables of this type."""
        return kind if kind != "Enumeration" else "Int64" if self is FMI3 else "Integer"


_ARRAY: Final = [c_void_p, c_void_p, c_size_t]

_ORDERS: Final = [*_ARRAY, c_void_p, c_void_p]
_SENSITIVITY: Final = [*_ARRAY, c_void_p, c_size_t]

FMI1: Final = Api(
    "fmi",
    {"Real": c_double, "Integer": c_int, "Boolean": c_int8, "String": c_char_p},
    {
        "InitializeSlave": [c_void_p, c_double, c_int8, c_double],
        "TerminateSlave": [c_void_p],
        "ResetSlave": [c_void_p],
        **{
            f"{verb}{kind}": [*_ARRAY, c_void_p]
            for verb in ("Get", "Set")
            for kind in ("Real", "Integer", "Boolean", "String")
        },
    },
    {"DoStep": [c_void_p, c_double, c_double, c_int8]},
    {},
    {},
    {"SetRealInputDerivatives": _ORDERS, "GetRealOutputDerivatives": _ORDERS},
    ("InstantiateSlave", ""),
    "FreeSlaveInstance",
    "TerminateSlave",
    "ResetSlave",
)
"""FMI 1.0 for Co-Simulation; a step takes its `newStep` where FMI 2.0 has `noSetFMUStatePriorToCurrentPoint`."""

FMI2: Final = Api(
    "fmi2",
    {"Real": c_double, "Integer": c_int, "Boolean": c_int, "String": c_char_p},
    {
        "SetupExperiment": [c_void_p, c_int, c_double, c_double, c_int, c_double],
        "EnterInitializationMode": [c_void_p],
        "ExitInitializationMode": [c_void_p],
        "Terminate": [c_void_p],
        "Reset": [c_void_p],
        **{
            f"{verb}{kind}": [*_ARRAY, c_void_p]
            for verb in ("Get", "Set")
            for kind in ("Real", "Integer", "Boolean", "String")
        },
    },
    {"DoStep": [c_void_p, c_double, c_double, c_int]},
    {
        "EnterEventMode": [c_void_p],
        "NewDiscreteStates": [c_void_p, c_void_p],
        "EnterContinuousTimeMode": [c_void_p],
        "CompletedIntegratorStep": [c_void_p, c_int, c_void_p, c_void_p],
        "SetTime": [c_void_p, c_double],
        "SetContinuousStates": [c_void_p, c_void_p, c_size_t],
        "GetContinuousStates": [c_void_p, c_void_p, c_size_t],
        "GetDerivatives": [c_void_p, c_void_p, c_size_t],
        "GetEventIndicators": [c_void_p, c_void_p, c_size_t],
        "GetNominalsOfContinuousStates": [c_void_p, c_void_p, c_size_t],
    },
    {
        "GetFMUstate": [c_void_p, POINTER(c_void_p)],
        "SetFMUstate": [c_void_p, c_void_p],
        "FreeFMUstate": [c_void_p, POINTER(c_void_p)],
        "SerializedFMUstateSize": [c_void_p, c_void_p, POINTER(c_size_t)],
        "SerializeFMUstate": [c_void_p, c_void_p, c_char_p, c_size_t],
        "DeSerializeFMUstate": [c_void_p, c_char_p, c_size_t, POINTER(c_void_p)],
    },
    {
        "GetDirectionalDerivative": [*_ARRAY, c_void_p, c_size_t, c_void_p, c_void_p],
        "SetRealInputDerivatives": _ORDERS,
        "GetRealOutputDerivatives": _ORDERS,
    },
    ("Instantiate", "Instantiate"),
)

FMI3: Final = Api(
    "fmi3",
    {
        "Float32": c_float, "Float64": c_double, "Int8": c_int8, "UInt8": c_uint8, "Int16": c_int16,
        "UInt16": c_uint16, "Int32": c_int32, "UInt32": c_uint32, "Int64": c_int64, "UInt64": c_uint64,
        "Boolean": c_bool, "String": c_char_p, "Binary": c_void_p,
    },
    {
        "EnterInitializationMode": [c_void_p, c_bool, c_double, c_double, c_bool, c_double],
        "ExitInitializationMode": [c_void_p],
        "Terminate": [c_void_p],
        "Reset": [c_void_p],
        **{
            f"{verb}{kind}": [*_ARRAY, *([c_void_p] if kind == "Binary" else []), c_void_p, c_size_t]
            for verb in ("Get", "Set")
            for kind in (
                "Float32", "Float64", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64",
                "Boolean", "String", "Binary",
            )
        },
    },
    {"DoStep": [c_void_p, c_double, c_double, c_bool, c_void_p, c_void_p, c_void_p, c_void_p]},
    {
        "EnterEventMode": [c_void_p],
        "UpdateDiscreteStates": [c_void_p] * 7,
        "EnterContinuousTimeMode": [c_void_p],
        "CompletedIntegratorStep": [c_void_p, c_bool, c_void_p, c_void_p],
        "SetTime": [c_void_p, c_double],
        "SetContinuousStates": [c_void_p, c_void_p, c_size_t],
        "GetContinuousStates": [c_void_p, c_void_p, c_size_t],
        "GetContinuousStateDerivatives": [c_void_p, c_void_p, c_size_t],
        "GetEventIndicators": [c_void_p, c_void_p, c_size_t],
        "GetNominalsOfContinuousStates": [c_void_p, c_void_p, c_size_t],
        "GetNumberOfEventIndicators": [c_void_p, POINTER(c_size_t)],
        "GetNumberOfContinuousStates": [c_void_p, POINTER(c_size_t)],
    },
    {
        "GetFMUState": [c_void_p, POINTER(c_void_p)],
        "SetFMUState": [c_void_p, c_void_p],
        "FreeFMUState": [c_void_p, POINTER(c_void_p)],
        "SerializedFMUStateSize": [c_void_p, c_void_p, POINTER(c_size_t)],
        "SerializeFMUState": [c_void_p, c_void_p, c_char_p, c_size_t],
        "DeserializeFMUState": [c_void_p, c_char_p, c_size_t, POINTER(c_void_p)],
    },
    {
        "GetDirectionalDerivative": [*_SENSITIVITY, c_void_p, c_size_t, c_void_p, c_size_t],
        "GetAdjointDerivative": [*_SENSITIVITY, c_void_p, c_size_t, c_void_p, c_size_t],
        "GetOutputDerivatives": [*_ORDERS, c_size_t],
    },
    ("InstantiateCoSimulation", "InstantiateModelExchange"),
)  # fmt: skip

BY_VERSION: Final = {"1.0": FMI1, "2.0": FMI2, "3.0": FMI3}

_CREATE1: Final = [c_char_p, c_char_p, c_char_p, c_char_p, c_double, c_int8, c_int8, Callbacks1, c_int8]
_CREATE2: Final = [c_char_p, c_int, c_char_p, c_char_p, POINTER(Callbacks2), c_int, c_int]
_CREATE3: Final = [c_char_p, c_char_p, c_char_p, c_bool, c_bool]


class Library:
    """The library of an FMU; its functions are named as in `Api`, without their prefix."""

    def __init__(self, loaded: ctypes.CDLL, prefix: str) -> None:
        self.loaded = loaded
        self.prefix = prefix

    def has(self, name: str) -> bool:
        return hasattr(self.loaded, self.prefix + name)

    def function(self, name: str) -> Any:
        return getattr(self.loaded, self.prefix + name)

    def address(self, name: str) -> int | None:
        """Where a function is, None if there is none of this name."""
        return address(self.function(name)) if self.has(name) else None

    def unload(self) -> None:
        """What ctypes itself never does: many loads would fill the memory."""
        _ctypes.dlclose(self.loaded._handle)


def load(path: Path, fmu: str, api: Api, identifier: str, exchange: bool) -> Library:
    """The library with its functions declared. `FmuError` if it does not load or lacks any of them."""
    try:
        loaded = ctypes.CDLL(str(path))
    except OSError as error:
        reason = str(error).replace(str(path.parent) + "/", "")
        raise FmuError.at(
            fmu, f"its library cannot be loaded: {reason}", hint="It may be built for another system or lack a library."
        ) from None
    library = Library(loaded, f"{identifier}_{api.prefix}" if api is FMI1 else api.prefix)
    creator = api.creators[int(exchange)]
    needed = {**api.common, **(api.model if exchange else api.slave)}
    missing = [name for name in (creator, api.free, *needed) if not library.has(name)]
    if missing:
        library.unload()
        raise FmuError(Problem(fmu, f"its library lacks the function {library.prefix}{name}") for name in missing)
    create = library.function(creator)
    create.restype = c_void_p
    if api is FMI1:
        create.argtypes = _CREATE1
    elif api is FMI2:
        create.argtypes = _CREATE2
    elif exchange:
        create.argtypes = [*_CREATE3, c_void_p, c_void_p]
    else:
        create.argtypes = [*_CREATE3, c_bool, c_bool, c_void_p, c_size_t, c_void_p, c_void_p, c_void_p]
    free = library.function(api.free)
    free.restype, free.argtypes = None, [c_void_p]
    for name, arguments in {**needed, **api.slave, **api.model, **api.state, **api.derivatives}.items():
        if library.has(name):  # what is needed is there; an FMU that saves no state may lack the rest
            function = library.function(name)
            function.restype, function.argtypes = c_int, arguments
    return library


def address(function: Any) -> int:
    """Where a function of a library is."""
    found = ctypes.cast(function, c_void_p).value
    assert found is not None  # a resolved symbol has one
    return found
