"""What a co-simulation steps: a `Slave` describes it, an `Instance` is one of it that runs.

A slave is immutable and serves any number of runs. The order of calls on an instance is

    bind -> (set)* -> initialise -> evaluate* -> begin -> (advance | set | save | restore)* -> close

`close` may come at any time and ends everything. After a failed `advance` only `restore` and `close` are allowed.
"""

from __future__ import annotations

import ctypes
import math
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from seacrane.errors import ParameterError, Problem, nearest
from seacrane.model.dae import Variable
from seacrane.units import with_unit

Vector = npt.NDArray[np.float64]

SetFunction = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p)
GetFunction = SetFunction
StepFunction = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int)
DeriveFunction = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_void_p
)
DirectionalFunction = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t, ctypes.c_void_p, ctypes.c_size_t,
    ctypes.c_void_p, ctypes.c_void_p,
)  # fmt: skip
SaveFunction = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.POINTER(ctypes.c_void_p))
RestoreFunction = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)
Callback = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_double)


@dataclass(frozen=True)
class Interface:
    """The variables of a slave by causality; `watchable` are internal ones that can only be read.

    `left_out` says of further variables, by name, why they cannot be exchanged. `kinds` says of variables of which the
    type is fixed what they hold: Real, Integer or Boolean.
    """

    inputs: tuple[Variable, ...] = ()
    outputs: tuple[Variable, ...] = ()
    parameters: tuple[Variable, ...] = ()
    watchable: tuple[Variable, ...] = ()
    left_out: Mapping[str, str] = field(default_factory=dict)
    kinds: Mapping[str, str] = field(default_factory=dict)

    @property
    def names(self) -> dict[str, Variable]:
        return {v.name: v for v in (*self.inputs, *self.outputs, *self.parameters, *self.watchable)}


@dataclass(frozen=True)
class NativeCalls:
    """C functions with FMI 2 signatures, as addresses, and the handle they take first.

    `derive` is that of fmi2SetRealInputDerivatives,
    `int (void *, const uint32_t *references, size_t n, const int32_t *order, const double *value)`: called after `set`,
    it lets inputs vary within the next step, by their derivatives with respect to time at its beginning. It is 0 where
    the slave only takes inputs that are held.

    `directional` is that of fmi2GetDirectionalDerivative, 0 where the slave gives none.

    `save`, `restore` and `release` are those of fmi2GetFMUstate, fmi2SetFMUstate and fmi2FreeFMUstate, for macro steps
    that are repeated; they are 0 where the methods of the instance have to be called.
    """

    handle: int
    set: int
    step: int
    get: int
    references: Mapping[str, int] = field(repr=False)
    derive: int = 0
    save: int = 0
    restore: int = 0
    release: int = 0
    directional: int = 0


class Slave(ABC):
    """A model with an interface, from which instances are made."""

    @property
    @abstractmethod
    def interface(self) -> Interface:
        """The variables; fixed for the life of the slave."""

    @abstractmethod
    def instantiate(self, name: str) -> Instance:
        """A new instance, called `name` in messages."""

    @property
    def feedthrough(self) -> Mapping[str, Collection[str]] | None:
        """For each output, the inputs that it depends on without delay; None where that is not known."""
        return None

    @property
    def about(self) -> str:
        """One line that says what this is."""
        return type(self).__name__

    @property
    def fingerprint(self) -> str:
        """A text that differs where slaves behave differently: a saved state goes on only in one with the same.

        This one is of class and interface; a slave that is given more than that adds it.
        """
        return repr((type(self).__module__, type(self).__qualname__, self.interface))


class Instance(ABC):
    """One running slave.

    A native instance gives its `calls`, and a master may use them in place of `advance`. Any other instance works on
    the arrays it was bound to: `advance` reads the inputs, and leaves the outputs at the end of the step.
    """

    calls: NativeCalls | None = None
    failure: BaseException | None = None
    """What `advance` raised, when its status says that it failed."""

    @property
    def message(self) -> str:
        """Why the last call failed, in the slave's own words; empty if it says nothing."""
        return ""

    @abstractmethod
    def bind(self, inputs: Vector, outputs: Vector) -> None:
        """Use these arrays, in the order of the interface, for all exchange from now on."""

    @abstractmethod
    def set(self, values: Mapping[str, float]) -> None:
        """Set parameters and start values; once begun, those that may change while it runs."""

    @abstractmethod
    def initialise(self, time: float) -> None:
        """Enter initialisation at `time` [s]."""

    @abstractmethod
    def evaluate(self) -> None:
        """In initialisation: the outputs that belong to the bound inputs."""

    @abstractmethod
    def begin(self) -> None:
        """Leave initialisation: time advances from now on."""

    @abstractmethod
    def advance(self, time: float, step: float) -> int:
        """From `time` to `time + step` [s] with the bound inputs held; the FMI 2 status (0, or 1 for a warning)."""

    def failed(self, status: int) -> None:
        """Told when a call through `calls` gave an FMI 2 status that ends the run."""
        del status

    @abstractmethod
    def save(self) -> bytes:
        """The whole state; `CosimError` if this slave cannot."""

    @abstractmethod
    def restore(self, state: bytes) -> None:
        """Go back to a saved state, exactly."""

    @abstractmethod
    def close(self) -> None:
        """Free everything; closing twice does no harm."""


def check_values(
    values: Mapping[str, float], known: Iterable[Variable], path: str = "", what: str = "parameter"
) -> None:
    """`ParameterError` with every value that is unknown by name, not a finite number or out of its bounds."""
    variables = {v.name: v for v in known}
    problems = []
    for name, value in values.items():
        at = f"{path}.{name}" if path else name
        if name not in variables:
            problems.append(Problem(at, f"no such {what}", hint=nearest(name, variables)))
            continue
        variable = variables[name]
        allowed = with_unit(f"{variable.minimum:g} to {variable.maximum:g}", variable.unit)
        if not math.isfinite(value):
            problems.append(Problem(at, "is not a finite number", value, allowed))
        elif not variable.minimum <= value <= variable.maximum:
            problems.append(Problem(at, "is out of its bounds", value, allowed))
    if problems:
        raise ParameterError(problems)
