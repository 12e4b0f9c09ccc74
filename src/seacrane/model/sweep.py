"""One parameter through a range of values, everything else the same."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seacrane.errors import ParameterError
from seacrane.results import family

from .dae import Variable
from .simulate import Model, Run, compiled, simulate

if TYPE_CHECKING:
    from seacrane.results import Figure


@dataclass(frozen=True, eq=False)
class Sweep:
    """The runs for the `values` [SI] of a parameter, in their order."""

    parameter: Variable
    values: tuple[float, ...]
    runs: tuple[Run, ...]

    def measure(self, of: Callable[[Run], float]) -> NDArray[np.float64]:
        """A number of each run, such as `lambda run: run["piston.force"].max()`."""
        return np.array([of(run) for run in self.runs])

    def plot(self, signal: str, unit: str | None = None) -> Figure:
        """One signal of all runs, over time."""
        shown = self.parameter.display_unit
        return family(signal, list(self.runs), list(self.values), self.parameter.name, self.parameter.unit, shown, unit)


def sweep(
    model: Model,
    parameter: str,
    values: ArrayLike,
    until: float,
    *,
    parameters: Mapping[str, float] | None = None,
    **settings: Any,
) -> Sweep:
    """Runs the model once for each value [SI] of a parameter, input or start; compiled once.

    `settings` are those of `simulate`. Raises `ParameterError` for an unknown name or no value.
    """
    native = compiled(model)
    native.value_reference(parameter)
    numbers = tuple(float(v) for v in np.asarray(values, dtype=np.float64).reshape(-1))
    if not numbers:
        raise ParameterError.at(parameter, "needs at least one value")
    runs = tuple(
        simulate(native, until, parameters={**(parameters or {}), parameter: value}, **settings) for value in numbers
    )
    return Sweep(native.variables[parameter].variable, numbers, runs)
