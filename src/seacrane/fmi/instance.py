"""An instance of an FMU that runs, for co-simulation or with our solver for model exchange."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from ctypes import byref, c_size_t, c_void_p
from types import TracebackType
from typing import TYPE_CHECKING, Any, Final, Self

import numpy as np
from numpy.typing import ArrayLike

from seacrane.errors import FmuError, Problem
from seacrane.fmi.api import FMI1, FMI2, FMI3, address
from seacrane.fmi.component import Component
from seacrane.fmi.creation import create
from seacrane.fmi.description import Variable
from seacrane.fmi.foreign import Calls, Foreign
from seacrane.fmi.logs import ERROR, FATAL, OK, Log
from seacrane.fmi.sensitivities import Sensitivities
from seacrane.fmi.typed import Exchange
from seacrane.fmi.values import Name, Values

if TYPE_CHECKING:
    from seacrane.fmi.fmu import Fmu

INSTANTIATED: Final = "before the start"
INITIALIZING: Final = "in initialization"
RUNNING: Final = "while it runs"


class FmuInstance(Sensitivities):
    """A running FMU. Its methods are those of `seacrane.model.native.NativeInstance`.

    `calls` are addresses of C functions with the signatures of FMI 2, whatever the version and kind of the FMU, and
    `handle` is what they take first. What the FMU logs goes to Python's logging under this package's name, with the
    instance's name.
    """

    def __init__(self, fmu: Fmu, name: str, debug: bool, tolerance: float | None) -> None:
        self.fmu = fmu
        self.name = name
        self.handle: int = 0
        self._api = fmu.api
        self._c = Component(fmu.library, Log(name))
        self._phase = INSTANTIATED
        self._values = Values(self._c, self._api, fmu.description)
        slave = fmu.description.co_simulation
        self._event_mode = self._api is FMI3 and not fmu.exchange and slave is not None and slave.event_mode
        if tolerance is None:
            tolerance = fmu.description.experiment.tolerance or 1e-6
        self._foreign: Foreign | None = None
        if fmu.exchange or self._api is FMI3:
            self._foreign = Foreign(
                name, fmu.library, self._api, fmu.description, fmu.exchange, self._event_mode, max(tolerance, 1e-12)
            )
        component, self._kept = create(fmu, self._c.log, debug, self._event_mode)
        if not component:
            function = fmu.library.prefix + self._api.creators[int(fmu.exchange)]
            tool = fmu.description.generation_tool or "the tool that made it"
            hint = f"It needs {tool} to run." if fmu.capabilities.needs_execution_tool else None
            error = FmuError.at(name, f"{function} gave no instance{self._c.said}", hint=hint)
            error.function = function
            raise error
        self._c.pointer = component
        fmu.open_instances += 1
        if self._foreign is None:
            self.handle = component
            names = {"set": "SetReal", "get": "GetReal", "step": "DoStep"}
            if slave is not None and slave.interpolates_inputs and fmu.library.has("SetRealInputDerivatives"):
                names["derive"] = "SetRealInputDerivatives"
            if fmu.capabilities.saves_state:
                names |= {"save": "GetFMUstate", "restore": "SetFMUstate", "release": "FreeFMUstate"}
            if fmu.capabilities.directional_derivative:
                names["directional"] = "GetDirectionalDerivative"
            self.calls = Calls(**{call: address(fmu.library.function(name)) for call, name in names.items()})
        else:
            self.handle = self._foreign.handle
            self._foreign.state.fmu = component
            self.calls = self._foreign.calls

    def set(self, names: Name | Sequence[Name], values: Any) -> None:
        """Sets variables by name; an array takes all its elements, and `x[2,3]` is one of them (counted from 1).

        An enumeration takes the name of an item or its number. A number in place of a name is the value reference of a
        real variable, which the FMU has to judge. `FmuError` naming all variables that cannot be set now.
        """
        keys, given = ([names], [values]) if isinstance(names, (str, int)) else (list(names), list(values))
        if len(given) != len(keys):
            raise FmuError.at(self.name, f"{len(keys)} variables cannot take {len(given)} values")
        found = self._values.find(keys)
        problems = [
            problem
            for key, (v, _) in zip(keys, found, strict=True)
            if isinstance(key, str) and (problem := self._forbidden(v)) is not None
        ]
        if problems:
            raise FmuError(problems)
        if self._phase == RUNNING and self._foreign is not None:
            self._adapted("seacrane_foreign_open")
        self._values.set(keys, given)

    def get(self, names: Name | Sequence[Name]) -> Any:
        """The value of one variable, or several: an array if all are real scalars, otherwise a list.

        Of an array variable it is a numpy array of its shape; `x[2,3]` is one of its elements (counted from 1).
        """
        if isinstance(names, (str, int)):
            return self._values.get([names])[0][0]
        values, reals = self._values.get(list(names))
        return np.array(values, dtype=np.float64) if reals else values

    def variable(self, name: str) -> Variable:
        """The variable of this name, or the array of which this is an element; `FmuError` if there is none."""
        return self._values.find([name])[0][0]

    def exchange(self, names: Sequence[str]) -> Exchange:
        """C functions that set and get variables of all types, and elements of arrays, as real numbers.

        `CompileError` if there is no C compiler.
        """
        found = self._values.find(names)
        enter_events = address(self._foreign.c.seacrane_foreign_open) if self._foreign is not None else None
        inner = (self.handle, self.calls, enter_events)
        signals = dict(zip(names, found, strict=True))
        return Exchange(self.fmu.library, self._api, self._c.live, inner, signals)

    def _forbidden(self, v: Variable) -> Problem | None:
        """Why a variable cannot be set now (FMI 2.0, section 2.2.7 and the state machines; FMI 3.0 alike)."""
        if v.causality == "structuralParameter":
            return Problem(self.name, f"{v.name} sizes arrays, and changing it is not supported")
        allowed = "inputs, parameters, and variables whose initial is exact or approx"
        if self._phase == INSTANTIATED:
            may = v.causality == "input" or v.initial in ("exact", "approx")
        elif self._phase == INITIALIZING:
            may = v.causality == "input" or v.initial == "exact"
            allowed = "inputs, parameters, and variables whose initial is exact"
        else:
            may = v.causality == "input" or (v.causality == "parameter" and v.variability == "tunable")
            allowed = "inputs and tunable parameters"
        if may and v.variability != "constant":
            return None
        what = f"{v.variability} {v.causality}"
        what += f" whose initial is {v.initial}" if v.initial and self._phase != RUNNING else ""
        article = "an" if what[0] in "aeiou" else "a"
        return Problem(self.name, f"{v.name} is {article} {what} and cannot be set {self._phase}", allowed=allowed)

    @property
    def last_log(self) -> str:
        """The last thing the FMU logged with a warning or worse; it may say why a call failed."""
        return self._c.log.last or (self._foreign.message if self._foreign is not None else "")

    def initialize(self, time: float = 0.0, stop: float | None = None, tolerance: float | None = None) -> None:
        """Sets up the experiment and goes through initialization mode; then the slave can be stepped."""
        self.enter_initialization(time, stop, tolerance)
        self.exit_initialization()

    def enter_initialization(
        self, time: float = 0.0, stop: float | None = None, tolerance: float | None = None
    ) -> None:
        """Sets up the experiment and enters initialization mode, in which outputs follow inputs that are set.

        FMI 1.0 has no such mode: the slave is initialised here, and can be stepped.
        """
        end = int(stop is not None), stop or 0.0
        known = int(tolerance is not None), tolerance or 0.0, time, *end
        if self._api is FMI1:
            self._c.call("InitializeSlave", time, *end)
        elif self._api is FMI2:
            self._c.call("SetupExperiment", *known)
            self._c.call("EnterInitializationMode")
        else:
            self._c.call("EnterInitializationMode", *known)
        self._time = time
        self._phase = RUNNING if self._api is FMI1 else INITIALIZING
        self._values.started(True)

    def exit_initialization(self) -> None:
        """Leaves initialization mode, and the events at the start; from now on the instance can be stepped."""
        if self._api is not FMI1:
            self._c.call("ExitInitializationMode")
        if self._foreign is not None:
            self._foreign.size(*self._sizes())
            self._adapted("seacrane_foreign_begin", self._time)
        self._phase = RUNNING

    def _sizes(self) -> tuple[int, int]:
        """How many continuous states and event indicators the model has."""
        if not self.fmu.exchange:
            return 0, 0
        if self._api is FMI2:
            return len(self.fmu.description.derivatives), self.fmu.description.event_indicators
        states, indicators = c_size_t(), c_size_t()
        self._c.call("GetNumberOfContinuousStates", byref(states))
        self._c.call("GetNumberOfEventIndicators", byref(indicators))
        return states.value, indicators.value

    @property
    def _state_count(self) -> int:
        return self._sizes()[0]

    def set_states(self, values: ArrayLike) -> None:
        """Sets the continuous states of an FMU for model exchange that runs; the solver goes on from there."""
        if not self.fmu.exchange or self._foreign is None or self._phase != RUNNING:
            raise FmuError.at(self.name, "only the continuous states of a running FMU for model exchange can be set")
        given = np.ascontiguousarray(values, dtype=np.float64).reshape(-1)
        if given.size != self._foreign.state.n or not np.isfinite(given).all():
            raise FmuError.at(self.name, "states", value=given.tolist(), allowed=f"{self._foreign.state.n} numbers")
        self._adapted("seacrane_foreign_states", given.ctypes.data)

    def note_failure(self, status: int) -> None:
        """Tells that a call through `calls` gave this status, which decides how the slave may still be closed."""
        self._c.note(status)

    def step(self, time: float, size: float) -> None:
        """Advances from `time` by `size` [s]. Raises `FmuError`, with the status, if it does not get there."""
        if self._foreign is None:
            self._c.call("DoStep", time, size, 1)
        else:
            self._adapted("seacrane_foreign_step", time, size, 1)

    def save(self) -> bytes:
        """The complete state as bytes. Raises `FmuError` if the FMU cannot give it."""
        get, _, free, size_of, serialize, _ = self._state_functions()
        state, size = c_void_p(), c_size_t()
        self._c.call(get, byref(state))
        try:
            self._c.call(size_of, state, byref(size))
            block = ctypes.create_string_buffer(size.value)
            self._c.call(serialize, state, block, size)
        finally:
            self._c.library.function(free)(self._c.live, byref(state))
        return (self._foreign.save() if self._foreign is not None else b"") + block.raw

    def restore(self, saved: bytes) -> None:
        """Returns to a saved state; `FmuError` with the FMU's reason if it is not one of this FMU in this kind."""
        _, set_, free, _, _, deserialize = self._state_functions()
        size = self._foreign.saved_size if self._foreign is not None else 0
        own, block = saved[:size], saved[size:]
        if not block:
            raise FmuError.at(self.name, "the saved state is not one of this FMU", value=f"{len(saved)} bytes")
        state = c_void_p()
        self._c.call(deserialize, block, len(block), byref(state))
        try:
            self._c.call(set_, state)
        finally:
            self._c.library.function(free)(self._c.live, byref(state))
        if self._foreign is not None:
            self._foreign.restore(own)

    def reset(self) -> None:
        """Back to the start values, as just instantiated."""
        self._c.call(self._api.reset)
        self._phase = INSTANTIATED
        self._c.status = OK
        self._values.started(False)

    def close(self) -> None:
        """Terminates and frees the slave; after an error only frees it, after a fatal one neither."""
        component, library = self._c.pointer, self.fmu.library
        if component and self._c.status != FATAL:
            if self._phase == RUNNING and self._c.status < ERROR:
                library.function(self._api.terminate)(component)
            library.function(self._api.free)(component)
            self.fmu.open_instances -= 1
        self._c.pointer = self.handle = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __del__(self) -> None:
        if hasattr(self, "_c") and self._c.pointer:
            self.close()

    def _state_functions(self) -> list[str]:
        """Names of the functions that get, set, free, measure, serialise and deserialise a state."""
        can = self.fmu.capabilities
        if self._api is FMI1:
            raise FmuError.at(self.name, "the FMU cannot save its state: FMI 1.0 has no functions for it")
        if not can.saves_state:
            raise FmuError.at(self.name, "the FMU cannot save its state", allowed="canGetAndSetFMUstate")
        if not can.serializes_state:
            message = "the FMU can keep its state, but not give it away as bytes"
            raise FmuError.at(self.name, message, allowed="canSerializeFMUstate")
        return list(self._api.state)

    def _adapted(self, function: str, *arguments: Any) -> None:
        """Calls a function of the adapter, which calls several of the FMU."""
        assert self._foreign is not None
        self._c.log.last = ""
        _ = self._c.live
        status = getattr(self._foreign.c, function)(self._foreign.handle, *arguments)
        self._c.check("the step" if function.endswith("step") else "event handling", status, self._foreign.message)
