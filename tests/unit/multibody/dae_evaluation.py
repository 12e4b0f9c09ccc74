"""A `Dae` evaluated by variable name, for the tests of the multibody room."""

from __future__ import annotations

from collections.abc import Mapping

import casadi as ca
import numpy as np

from seacrane.model.dae import Dae


class Evaluation:
    """Rates, outputs and observables of a DAE without algebraic unknowns."""

    def __init__(self, dae: Dae) -> None:
        self.dae = dae
        self.function = ca.Function("dae", [dae.t, dae.x, dae.u, dae.p], [dae.ode, dae.out, dae.obs])

    def __call__(self, values: Mapping[str, float] | None = None) -> dict[str, float]:
        """All results by name, a state's rate as `der(name)`; what `values` leaves out is at its start."""
        values = dict(values or {})
        known = {v.name for v in self.dae.states + self.dae.inputs + self.dae.parameters}
        assert set(values) <= known, set(values) - known
        groups = (self.dae.states, self.dae.inputs, self.dae.parameters)
        ode, out, obs = self.function(0, *([values.get(v.name, v.start) for v in group] for group in groups))
        names = [f"der({v.name})" for v in self.dae.states]
        names += [v.name for v in self.dae.outputs + self.dae.observables]
        numbers = np.concatenate([part.full().ravel() for part in (ode, out, obs)])
        return dict(zip(names, numbers.tolist(), strict=True))


def vector(prefix: str, components: np.ndarray) -> dict[str, float]:
    """Three components as `prefix` + x, y, z."""
    return {prefix + axis: float(c) for axis, c in zip("xyz", components, strict=True)}
