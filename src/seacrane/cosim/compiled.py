"""Slaves whose code is native: models compiled here, and FMUs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy.typing as npt

from seacrane.cosim.slave import Instance, Interface, NativeCalls, Vector
from seacrane.errors import SeacraneError
from seacrane.model.dae import Variable


class Calls(Protocol):
    """Addresses of C functions with the signatures of FMI 2; see `seacrane.cosim.slave.NativeCalls`."""

    @property
    def set(self) -> int: ...
    @property
    def get(self) -> int: ...
    @property
    def step(self) -> int: ...
    @property
    def derive(self) -> int: ...
    @property
    def save(self) -> int: ...
    @property
    def restore(self) -> int: ...
    @property
    def release(self) -> int: ...
    @property
    def directional(self) -> int: ...


class Inner(Protocol):
    """What instances of compiled models and of FMUs have in common."""

    @property
    def calls(self) -> Calls: ...
    @property
    def handle(self) -> int: ...
    def set(self, names: Sequence[str], values: npt.ArrayLike) -> None: ...
    def get(self, names: Sequence[str]) -> Any: ...
    def initialize(self, time: float) -> None: ...
    def step(self, time: float, size: float) -> None: ...
    def save(self) -> bytes: ...
    def restore(self, saved: bytes) -> None: ...
    def close(self) -> None: ...


class CompiledInstance(Instance):
    """A native instance with its variables by name; the loops call its C functions, not `advance`."""

    def __init__(self, name: str, inner: Inner, interface: Interface, references: Mapping[str, int]) -> None:
        self.inner = inner
        calls = inner.calls
        self.calls = NativeCalls(
            inner.handle, calls.set, calls.step, calls.get, references,
            calls.derive, calls.save, calls.restore, calls.release, calls.directional,
        )  # fmt: skip
        self._name = name
        self._input_names = [v.name for v in interface.inputs]
        self._output_names = [v.name for v in interface.outputs]

    def bind(self, inputs: Vector, outputs: Vector) -> None:
        self._inputs, self._outputs = inputs, outputs

    def set(self, values: Mapping[str, float]) -> None:
        if values:
            self.inner.set(list(values), list(values.values()))

    def initialise(self, time: float) -> None:
        self._give()
        self.inner.initialize(time)

    def evaluate(self) -> None:
        self._give()
        if self._output_names:
            self._outputs[:] = self.inner.get(self._output_names)

    def begin(self) -> None:
        """Nothing to do: inputs may still change where the instance already is at its start."""

    def advance(self, time: float, step: float) -> int:
        try:
            self._give()
            self.inner.step(time, step)
            if self._output_names:
                self._outputs[:] = self.inner.get(self._output_names)
        except SeacraneError as error:
            self.failure = error
            return 3
        return 0

    def save(self) -> bytes:
        return self.inner.save()

    def restore(self, state: bytes) -> None:
        self.inner.restore(state)

    def close(self) -> None:
        self.inner.close()

    def _give(self) -> None:
        if self._input_names:
            self.inner.set(self._input_names, self._inputs)


def started(variables: Sequence[Variable], values: Mapping[str, float]) -> tuple[Variable, ...]:
    """Variables with these start values in place of their own."""
    return tuple(replace(v, start=float(values[v.name])) if v.name in values else v for v in variables)
