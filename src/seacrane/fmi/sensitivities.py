"""Derivatives and continuous states of a running FMU, for linearisation, estimation and optimisation."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from ctypes import CFUNCTYPE, addressof, c_double, c_int, c_size_t, c_uint32, c_void_p
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seacrane.errors import FmuError
from seacrane.fmi.api import FMI3
from seacrane.fmi.component import Component
from seacrane.fmi.description import REALS, Variable
from seacrane.fmi.foreign import Calls

if TYPE_CHECKING:
    from seacrane.fmi.fmu import Fmu

Reals = NDArray[np.float64]
DeriveFunction = CFUNCTYPE(c_int, c_void_p, c_void_p, c_size_t, c_void_p, c_void_p)


class Sensitivities(ABC):
    """What `FmuInstance` has of derivatives. An array counts with all its elements, in row-major order."""

    fmu: Fmu
    name: str
    handle: int
    calls: Calls
    _c: Component

    def directional_derivative(self, unknowns: Sequence[str], knowns: Sequence[str], seed: ArrayLike) -> Reals:
        """The derivative of the unknowns in the direction `seed` of the knowns: J seed, shape (elements of unknowns,).

        Knowns are inputs, states and parameters that may change, unknowns outputs and derivatives of states. Raises
        `FmuError` if the FMU does not provide it, or refuses.
        """
        self._require(self.fmu.capabilities.directional_derivative, "directional derivatives")
        return self._derivative("GetDirectionalDerivative", unknowns, knowns, seed, knowns, unknowns)

    def adjoint_derivative(self, unknowns: Sequence[str], knowns: Sequence[str], seed: ArrayLike) -> Reals:
        """The derivative of `seed` times the unknowns by the knowns: J^T seed, shape (elements of knowns,).

        Only FMI 3.0 has it. Raises `FmuError` if the FMU does not provide it, or refuses.
        """
        self._require(self.fmu.capabilities.adjoint_derivative, "adjoint derivatives")
        return self._derivative("GetAdjointDerivative", unknowns, knowns, seed, unknowns, knowns)

    def output_derivatives(self, names: Sequence[str], order: int = 1) -> Reals:
        """Derivatives of outputs with respect to time at the end of the last step, shape (elements of names,).

        Only a co-simulation FMU has them, up to its `output_derivative_order`. Raises `FmuError` if it does not.
        """
        slave = self.fmu.description.co_simulation
        highest = 0 if slave is None or self.fmu.exchange else slave.output_derivative_order
        if not 1 <= order <= highest:
            message = f"the FMU gives derivatives of its outputs up to order {highest}"
            raise FmuError.at(self.name, message, value=order, allowed=f"1 to {highest}" if highest else "none")
        variables = self._reals(names)
        references, total = _references(variables), sum(v.count for v in variables)
        orders, values = (c_int * len(variables))(*[order] * len(variables)), (c_double * total)()
        if self.fmu.api is FMI3:
            self._c.call("GetOutputDerivatives", references, len(variables), orders, values, total)
        else:
            self._c.call("GetRealOutputDerivatives", references, len(variables), orders, values)
        return np.array(values)

    def set_derivatives(self, names: Sequence[str], values: ArrayLike) -> None:
        """Lets real scalar inputs vary with these slopes over the next step, from the values they have been set to.

        An FMU for model exchange can always do so; one for co-simulation if it interpolates its inputs. Raises
        `FmuError` if it cannot.
        """
        self._require(self.interpolates, "input that varies within a step")
        slopes = np.ascontiguousarray(values, dtype=np.float64).reshape(-1)
        variables = self._reals(names)
        wrong = [v.name for v in variables if v.causality != "input" or v.variability != "continuous" or v.dimensions]
        if wrong or slopes.size != len(variables):
            raise FmuError.at(self.name, f"{', '.join(wrong) or 'slopes'}: one slope for each continuous scalar input")
        orders = (c_int * len(variables))(*[1] * len(variables))
        references, function = _references(variables), DeriveFunction(self.calls.derive)
        arguments = addressof(references), len(variables), addressof(orders), slopes.ctypes.data
        self._c.check("setting input derivatives", function(self.handle, *arguments))

    @property
    def interpolates(self) -> bool:
        """Whether inputs can vary within a step."""
        return self.calls.derive != 0

    def _derivative(
        self,
        function: str,
        unknowns: Sequence[str],
        knowns: Sequence[str],
        seed: ArrayLike,
        seeded: Sequence[str],
        found: Sequence[str],
    ) -> Reals:
        rows, columns = self._reals(unknowns), self._reals(knowns)
        size, total = (sum(v.count for v in self._reals(names)) for names in (seeded, found))
        given = np.ascontiguousarray(seed, dtype=np.float64).reshape(-1)
        if given.size != size:
            message = f"a seed of {given.size} values does not fit {', '.join(seeded)}"
            raise FmuError.at(self.name, message, allowed=f"{size} values")
        values = (c_double * total)()
        arguments: list[Any] = [_references(rows), len(rows), _references(columns), len(columns), given.ctypes.data]
        if self.fmu.api is FMI3:
            arguments += [size, values, total]
        else:
            arguments += [values]
        self._c.call(function, *arguments)
        return np.array(values)

    def _reals(self, names: Sequence[str]) -> list[Variable]:
        variables = [self.fmu.description.variable(name) for name in names]
        for v in variables:
            if v.type not in REALS or v.type == "Float32":
                raise FmuError.at(v.name, f"is {v.type}, which has no derivatives here", allowed="Real, Float64")
        return variables

    def _require(self, there: bool, what: str) -> None:
        if not there:
            raise FmuError.at(self.name, f"the FMU provides no {what}")

    # ------------------------------------------------------------ continuous states of an FMU for model exchange
    @property
    def states(self) -> Reals:
        """The continuous states of an FMU for model exchange, in the order of its derivatives, shape (states,)."""
        return self._states("GetContinuousStates")

    @property
    def derivatives(self) -> Reals:
        """The time derivatives of the states at the present time, shape (states,)."""
        return self._states("GetContinuousStateDerivatives" if self.fmu.api is FMI3 else "GetDerivatives")

    @property
    def nominals(self) -> Reals:
        """The nominal values of the states, shape (states,)."""
        return self._states("GetNominalsOfContinuousStates")

    @property
    @abstractmethod
    def _state_count(self) -> int: ...

    def _states(self, function: str) -> Reals:
        if not self.fmu.exchange:
            raise FmuError.at(self.name, "only FMUs for model exchange show their continuous states")
        values = (c_double * self._state_count)()
        self._c.call(function, values, len(values))
        return np.array(values)


def _references(variables: Sequence[Variable]) -> Any:
    return (c_uint32 * len(variables))(*(v.value_reference for v in variables))
