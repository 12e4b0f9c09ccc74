"""An FMU behind the three C functions of the master loop: `native/foreign.c` and the structure it works on."""

from __future__ import annotations

import ctypes
from ctypes import addressof, c_char, c_double, c_int, c_int64, c_size_t, c_uint32, c_void_p
from dataclasses import dataclass
from functools import cache
from typing import Any, Final

from seacrane.errors import FmuError, Problem
from seacrane.fmi.api import FMI2, Api, Library, address
from seacrane.fmi.description import REALS, ModelDescription
from seacrane.fmi.reading3 import MOST_ELEMENTS
from seacrane.native import build_library, source


class State(ctypes.Structure):
    """foreign_t of `native/foreign.c`."""

    _fields_ = (
        *(
            (name, c_void_p)
            for name in (
                "fmu", "set", "get", "do_step", "enter_event", "update", "resume", "set_time", "set_states",
                "get_states", "derivatives", "indicators", "completed", "nominals", "directional",
                "state_references", "derivative_references", "memory", "ramp",
                "input_references",
            )
        ),
        *((name, c_int64) for name in ("inputs", "version", "exchange", "event_mode", "discrete_inputs", "n", "m")),
        ("tolerance", c_double),
        *((name, c_double) for name in ("time", "next_event", "next_step", "ramp_start")),
        *((name, c_int64) for name in ("ramping", "mode", "event_known", "steps", "rejected", "events", "jacobians")),
        ("message", c_char * 256),
    )  # fmt: skip


MOST_STATES: Final = 5000
"""Continuous states that the solver takes: its two dense matrices then need 400 MB."""

_SAVED: Final = slice(State.time.offset, State.message.offset)


@cache
def adapter() -> ctypes.CDLL:
    """The compiled adapter. `CompileError` if there is no C compiler."""
    sources = source("rodas.h", "foreign.h", "foreign.c", "foreign_solver.c", "logger.c", "typed.c")
    library = ctypes.CDLL(str(build_library("foreign", sources)))
    library.seacrane_foreign_room.restype = c_size_t
    library.seacrane_foreign_room.argtypes = [c_int64, c_int64]
    library.seacrane_foreign_begin.argtypes = [c_void_p, c_double]
    library.seacrane_foreign_open.argtypes = [c_void_p]
    library.seacrane_foreign_states.argtypes = [c_void_p, c_void_p]
    library.seacrane_foreign_step.argtypes = [c_void_p, c_double, c_double, c_int]
    return library


@dataclass(frozen=True)
class Calls:
    """Addresses of C functions with the signatures of fmi2SetReal, fmi2GetReal and fmi2DoStep.

    `derive` is that of fmi2SetRealInputDerivatives, 0 if the FMU holds its inputs over a step. `save`, `restore` and
    `release` are those of fmi2GetFMUstate, fmi2SetFMUstate and fmi2FreeFMUstate, 0 if the methods are to be called.
    `directional` is that of fmi2GetDirectionalDerivative, 0 if the FMU gives none.
    """

    set: int
    get: int
    step: int
    derive: int = 0
    save: int = 0
    restore: int = 0
    release: int = 0
    directional: int = 0


class Foreign:
    """The state of one FMU instance in the adapter. `handle` goes with the adapter's functions."""

    def __init__(
        self,
        name: str,
        library: Library,
        api: Api,
        description: ModelDescription,
        exchange: bool,
        event_mode: bool,
        tolerance: float,
    ) -> None:
        self.c = adapter()
        self._memory: Any = (c_double * 0)()
        if event_mode:
            needed = ("EnterEventMode", "UpdateDiscreteStates", "EnterStepMode")
            missing = [library.prefix + function for function in needed if not library.has(function)]
            if missing:
                raise FmuError(Problem(name, f"the library lacks the function {function}") for function in missing)
        at = library.address
        two = api is FMI2
        real = "Real" if two else "Float64"
        state = self.state = State(
            version=2 if two else 3,
            exchange=int(exchange),
            event_mode=int(event_mode),
            tolerance=tolerance,
            set=at(f"Set{real}"),
            get=at(f"Get{real}"),
            do_step=at("DoStep"),
            enter_event=at("EnterEventMode"),
            update=at("NewDiscreteStates" if two else "UpdateDiscreteStates"),
            resume=at("EnterContinuousTimeMode" if exchange else "EnterStepMode"),
            set_time=at("SetTime"),
            set_states=at("SetContinuousStates"),
            get_states=at("GetContinuousStates"),
            derivatives=at("GetDerivatives" if two else "GetContinuousStateDerivatives"),
            indicators=at("GetEventIndicators"),
            nominals=at("GetNominalsOfContinuousStates"),
        )
        discrete = (v for v in description.inputs if v.variability == "discrete" and v.type in REALS)
        state.discrete_inputs = int((exchange or event_mode) and any(True for _ in discrete))
        model = description.model_exchange
        if model is not None and exchange:
            if model.needs_completed_step:
                state.completed = at("CompletedIntegratorStep")
            derivatives = [description.variables[u.index - 1] for u in description.derivatives]
            if model.directional_derivative and all(not v.shape and v.derivative for v in derivatives):
                state.directional = at("GetDirectionalDerivative")
            states = [description.variables[v.derivative - 1] for v in derivatives if v.derivative is not None]
            self._references = [
                (c_uint32 * max(1, len(group)))(*(v.value_reference for v in group)) for group in (states, derivatives)
            ]
            state.state_references, state.derivative_references = map(addressof, self._references)
            reals = ("Real", "Float64")
            inputs = [
                v for v in description.inputs if v.type in reals and v.variability == "continuous" and not v.shape
            ]
            self._inputs = (c_uint32 * max(1, len(inputs)))(*(v.value_reference for v in inputs))
            self._ramp = (c_double * max(1, 3 * len(inputs)))()
            state.inputs = len(inputs)
            state.input_references, state.ramp = addressof(self._inputs), addressof(self._ramp)

    @property
    def handle(self) -> int:
        return addressof(self.state)

    @property
    def calls(self) -> Calls:
        names = ["set", "get", "step", *(["derive"] if self.state.inputs else [])]
        return Calls(*(address(getattr(self.c, f"seacrane_foreign_{name}")) for name in names))

    def size(self, states: int, indicators: int) -> None:
        """Gives the solver its memory. `FmuError` if the model is too large for its dense matrices."""
        if states > MOST_STATES or indicators > MOST_ELEMENTS:
            allowed = f"at most {MOST_STATES} states and {MOST_ELEMENTS} event indicators"
            raise FmuError.at("", "the model is too large to be integrated here", value=states, allowed=allowed)
        self.state.n, self.state.m = states, indicators
        self._memory = (c_double * self.c.seacrane_foreign_room(states, indicators))()
        self.state.memory = addressof(self._memory)

    @property
    def message(self) -> str:
        return bytes(self.state.message).decode(errors="replace")

    def save(self) -> bytes:
        """Time, step size and the solver's vectors, beside the FMU's own state."""
        return bytes(self.state)[_SAVED] + bytes(self._memory)

    def restore(self, saved: bytes) -> None:
        length = _SAVED.stop - _SAVED.start
        ctypes.memmove(self.handle + _SAVED.start, saved[:length], length)
        ctypes.memmove(self._memory, saved[length:], ctypes.sizeof(self._memory))

    @property
    def saved_size(self) -> int:
        return _SAVED.stop - _SAVED.start + ctypes.sizeof(self._memory)
