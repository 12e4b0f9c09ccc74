"""Signals of any type as real numbers for the master loop: `native/typed.c` and the structures it works on."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Mapping
from ctypes import addressof, c_double, c_int64, c_uint32, c_void_p
from functools import cache
from typing import Final

from seacrane.errors import CompileError
from seacrane.fmi.api import FMI3, Api, Library, address
from seacrane.fmi.description import INTEGERS, Variable
from seacrane.fmi.foreign import Calls, adapter

_TYPES: Final = (
    "Float64", "Float32", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64", "Bool8", "Bool32",
)  # fmt: skip


class _Signal(ctypes.Structure):
    _fields_ = (
        *((name, c_uint32) for name in ("reference", "type", "element", "count")),
        *((name, c_int64) for name in ("place", "first", "discrete", "known")),
        *((name, c_double) for name in ("sign", "low", "high")),
    )


class _Typed(ctypes.Structure):
    _fields_ = (
        *((name, c_void_p) for name in ("fmu", "inner", "set_reals", "get_reals", "step", "derive", "open")),
        ("set", c_void_p * len(_TYPES)),
        ("get", c_void_p * len(_TYPES)),
        *((name, c_void_p) for name in ("signals", "buffer")),
        *((name, c_int64) for name in ("version", "failed")),
        ("value", c_double),
    )


class Exchange:
    """The C functions that exchange these signals, each a variable and the element of it if that is an array.

    `references` maps their names to what the functions of `calls` take as value references, with `handle` first.
    """

    def __init__(
        self,
        library: Library,
        api: Api,
        component: int,
        inner: tuple[int, Calls, int | None],
        signals: Mapping[str, tuple[Variable, int | None]],
    ) -> None:
        self._c = adapter()
        self._names = list(signals)
        self.references = {name: i for i, name in enumerate(self._names)}
        handle, calls, enter_events = inner
        self._signals = (_Signal * len(signals))()
        room = 0
        places: dict[str, tuple[int, int]] = {}
        for i, (signal, (v, element)) in enumerate(zip(self._signals, signals.values(), strict=True)):
            if v.name not in places:
                places[v.name] = room, i
                room += v.count  # no type is longer than a double
            low, high = bounds(v)
            signal.place, signal.first = places[v.name]
            signal.reference, signal.type = v.value_reference, _TYPES.index(_kind(v, api))
            signal.element, signal.count = element or 0, v.count
            signal.sign, signal.low, signal.high = -1.0 if v.negated else 1.0, low, high
            signal.discrete = int(v.variability != "continuous")
        self._buffer = (c_double * room)()
        state = self._state = _Typed(
            fmu=component, inner=handle, set_reals=calls.set, get_reals=calls.get, step=calls.step, derive=calls.derive,
            open=enter_events, signals=addressof(self._signals), buffer=addressof(self._buffer),
            version=3 if api is FMI3 else 2, failed=-1,
        )  # fmt: skip
        for i, name in enumerate(_TYPES):
            kind = _FUNCTIONS[api.prefix].get(name, name)
            state.set[i], state.get[i] = library.address(f"Set{kind}"), library.address(f"Get{kind}")
        self.handle = addressof(state)
        functions = ["set", "get", "step", *(["derive"] if calls.derive else [])]
        self.calls = Calls(*(address(getattr(self._c, f"seacrane_typed_{name}")) for name in functions))

    def forget(self) -> None:
        """Told when the FMU may hold other values than it was set to through `calls`."""
        self._c.seacrane_typed_forget(c_void_p(self.handle), ctypes.c_size_t(len(self._signals)))

    @property
    def message(self) -> str:
        """Which signal was given a value that it cannot take; empty if none was."""
        if self._state.failed < 0:
            return ""
        low, high = self._signals[self._state.failed].low, self._signals[self._state.failed].high
        allowed = f"a whole number from {low:.0f} to {high:.0f}"
        return f"{self._names[self._state.failed]} cannot take {self._state.value:g}; allowed: {allowed}"


_FUNCTIONS: Final = {
    "fmi": {"Float64": "Real", "Int32": "Integer", "Bool8": "Boolean"},
    "fmi2": {"Float64": "Real", "Int32": "Integer", "Bool32": "Boolean"},
    "fmi3": {"Bool8": "Boolean"},
}
"""The functions for a type of C, where they are not called after it."""


@cache
def exchanges_all_types() -> bool:
    """Whether `Exchange` works here, for which there must be a C compiler."""
    try:
        adapter()
    except CompileError:
        return False
    return True


def _kind(v: Variable, api: Api) -> str:
    if v.type == "Boolean":
        return "Bool32" if api.prefix == "fmi2" else "Bool8"
    if v.type == "Enumeration":
        return "Int64" if api is FMI3 else "Int32"
    return {"Real": "Float64", "Integer": "Int32"}.get(v.type, v.type)


def bounds(v: Variable) -> tuple[float, float]:
    """The least and the greatest number that a variable takes because of its type."""
    if v.items:
        return min(v.items.values()), max(v.items.values())
    if v.type not in INTEGERS:
        return (0.0, 1.0) if v.type == "Boolean" else (-math.inf, math.inf)
    low, high = INTEGERS[v.type]
    return float(low), float(high) if high < 2**53 else math.nextafter(float(high), 0)  # which rounds up to too much
