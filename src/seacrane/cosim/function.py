"""Slaves written in Python: controllers, test signals, anything small."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from seacrane.cosim.slave import Instance, Interface, Slave, Vector
from seacrane.errors import CosimError, ParameterError
from seacrane.model.dae import Variable

ERROR = 3
"""FMI 2 status of a step that failed."""


@dataclass(frozen=True, eq=False)
class FunctionSlave(Slave):
    """A pure Python function as a slave.

    Without state, `function(t, h, u) -> y`: the outputs at t + h from the inputs held over [t, t + h].
    With a start `state` vector, `function(t, h, x, u) -> (x_next, y)`.

    u, x and y are in the order of `inputs`, `state` and `outputs`; u and x are read-only and valid during the call.
    At the start the function is called with h = 0 for the outputs that belong to the first inputs; the state it then
    returns is not used. All state is in x, so that a run can be saved, restored and repeated; an exception in the
    function ends the run with a `CosimError` that names slave and time.
    """

    function: Callable[..., Any]
    inputs: Sequence[Variable] = ()
    outputs: Sequence[Variable] = ()
    state: npt.ArrayLike | None = None

    @property
    def interface(self) -> Interface:
        return Interface(tuple(self.inputs), tuple(self.outputs))

    @property
    def fingerprint(self) -> str:
        """Of the function's name and compiled code, the variables and the start state.

        What the function takes from outside (globals, closures, defaults) has no part in it.
        """
        function = self.function
        name = f"{function.__module__}.{getattr(function, '__qualname__', type(function).__qualname__)}"
        state = None if self.state is None else np.asarray(self.state, dtype=np.float64).ravel().tolist()
        return repr((name, _code(getattr(function, "__code__", None)), self.interface, state))

    def instantiate(self, name: str) -> Instance:
        state = None if self.state is None else np.array(self.state, dtype=np.float64).ravel()
        return FunctionInstance(name, self.function, state)


def _code(code: Any) -> str:
    """The hash of a function's instructions, with those of the functions in it."""
    if code is None:
        return ""
    constants = [_code(c) if hasattr(c, "co_code") else repr(c) for c in code.co_consts if not isinstance(c, frozenset)]
    return hashlib.sha256(repr((code.co_code, code.co_names, constants)).encode()).hexdigest()


class FunctionInstance(Instance):
    """The state vector of a `FunctionSlave` and the arrays it works on."""

    def __init__(self, name: str, function: Callable[..., Any], state: Vector | None) -> None:
        self._name = name
        self._function = function
        self._start = state
        self._state = None if state is None else state.copy()
        self._inputs = self._outputs = np.empty(0)
        self._time = 0.0

    def bind(self, inputs: Vector, outputs: Vector) -> None:
        self._inputs = inputs.view()
        self._inputs.flags.writeable = False
        self._outputs = outputs

    def set(self, values: Mapping[str, float]) -> None:
        if values:
            raise ParameterError.at(f"{self._name}.{next(iter(values))}", "a Python function has no parameters")

    def initialise(self, time: float) -> None:
        self._time = time
        self._state = None if self._start is None else self._start.copy()

    def evaluate(self) -> None:
        try:
            self._call(self._time, 0.0)
        except Exception as error:
            raise CosimError.at(
                self._name, f"failed at the start (t = {self._time:g} s): {type(error).__name__}: {error}"
            ) from error

    def begin(self) -> None:
        """Nothing to do: the state is at its start value."""

    def advance(self, time: float, step: float) -> int:
        # Called from C too, where an exception cannot pass: it is kept, and raised again by the execution.
        try:
            following = self._call(time, step)
            if self._state is not None:
                self._state[:] = following
        except BaseException as error:
            self.failure = error
            return ERROR
        return 0

    def save(self) -> bytes:
        return b"" if self._state is None else self._state.tobytes()

    def restore(self, state: bytes) -> None:
        self.failure = None
        if self._state is not None:
            self._state[:] = np.frombuffer(state)

    def close(self) -> None:
        """Nothing to free."""

    def _call(self, time: float, step: float) -> Any:
        following = None
        if self._state is None:
            result = self._function(time, step, self._inputs)
        else:
            held = self._state.view()
            held.flags.writeable = False
            following, result = self._function(time, step, held, self._inputs)
            if np.shape(following) != self._state.shape:
                raise ValueError(f"the state has shape {np.shape(following)}, but began with {self._state.shape}")
        if np.shape(result) != self._outputs.shape:
            raise ValueError(f"the outputs have shape {np.shape(result)}, but {self._outputs.size} are declared")
        self._outputs[:] = result
        return following
