"""A model close to one point: matrices, natural frequencies, responses.

    dx/dt = A x + B u,   y = C x + D u        x, u, y: deviations from the point

The derivatives are exact. Algebraic unknowns are eliminated, dz = -(d alg/dz)^-1 (d alg/dx dx + d alg/du du). Where a
law has a kink at the very point, its slope is the mean of both sides.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from seacrane.errors import ParameterError, Problem, SolveError, nearest
from seacrane.results import Recording, Signal, bode
from seacrane.units import labelled

from .dae import Dae, Variable
from .simulate import Model, compiled

if TYPE_CHECKING:
    from seacrane.results import Figure

Reals = NDArray[np.float64]
Complexes = NDArray[np.complex128]

TAKES_PART = 0.05
"""Share below which a state is not named with a mode."""


@dataclass(frozen=True)
class Mode:
    """A real eigenvalue or a conjugate pair of A.

    natural_frequency [Hz] is |eigenvalue| / (2 pi), damping the ratio -Re / |eigenvalue| (1 for a decaying real one,
    below zero for one that grows). `states` are those that take part, by participation factor (scale-free shares, the
    largest first): I. J. Perez-Arriaga et al., IEEE Transactions on Power Apparatus and Systems 101, 1982.
    """

    eigenvalue: complex
    natural_frequency: float
    damping: float
    states: tuple[tuple[str, float], ...]

    def __str__(self) -> str:
        shares = ", ".join(f"{name} {share:.0%}" for name, share in self.states)
        return f"{self.natural_frequency:10.4g} Hz  damping {self.damping:8.4f}  {shares}"


@dataclass(frozen=True, eq=False)
class Linearised:
    """The matrices with the names and units (SI) of their rows and columns, and the point they belong to."""

    states: tuple[Variable, ...]
    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    A: Reals
    B: Reals
    C: Reals
    D: Reals
    time: float
    point: Mapping[str, float]

    def modes(self) -> tuple[Mode, ...]:
        """All modes, the slowest first."""
        from scipy.linalg import eig

        if not self.states:
            return ()
        nominal = np.array([v.nominal for v in self.states])
        values, left, right = eig(self.A * nominal / nominal[:, None], left=True, right=True)
        found = []
        for i in np.argsort(np.abs(values), kind="stable"):
            value = complex(values[i])
            if value.imag < 0:
                continue  # the other one of the pair stands for both
            part = np.abs(left[:, i].conj() * right[:, i])
            part = part / part.sum()
            order = np.argsort(-part, kind="stable")
            names = tuple((self.states[j].name, float(part[j])) for j in order if part[j] >= TAKES_PART)
            size = abs(value)
            found.append(Mode(value, size / (2 * math.pi), -value.real / size if size else 0.0, names))
        return tuple(found)

    def response(self, frequency: ArrayLike, source: str, output: str) -> Complexes:
        """C (j w I - A)^-1 B + D from one input to one output, at frequencies [Hz]; SI over SI."""
        i, o = _index(self.inputs, source, "input"), _index(self.outputs, output, "output")
        w = 2j * np.pi * np.asarray(frequency, dtype=np.float64).reshape(-1)
        eye = np.eye(len(self.states))
        inside = np.linalg.solve(
            w[:, None, None] * eye - self.A, np.broadcast_to(self.B[:, i : i + 1], (w.size, *eye[:, :1].shape))
        )
        result: Complexes = (self.C[o] @ inside)[:, 0] + self.D[o, i]
        return result

    def bode(self, source: str, *outputs: str, frequency: ArrayLike | None = None) -> Figure:
        """Magnitude and phase from one input to outputs (all by default) over `frequency` [Hz] (around the modes)."""
        if frequency is None:
            seen = [m.natural_frequency for m in self.modes() if m.natural_frequency > 1e-6] or [1.0]
            frequency = np.geomspace(min(seen) / 10, max(seen) * 10, 1000)
        hertz = np.asarray(frequency, dtype=np.float64).reshape(-1)
        names = outputs or tuple(v.name for v in self.outputs)
        labels = {}
        for name in names:
            gives, takes = (
                self.outputs[_index(self.outputs, name, "output")],
                self.inputs[_index(self.inputs, source, "input")],
            )
            labels[f"{labelled(name, gives.unit)} / {labelled(source, takes.unit)}"] = self.response(
                hertz, source, name
            )
        return bode(hertz, labels)

    def step(self, source: str, until: float, *, size: float = 1.0, every: float | None = None) -> Recording:
        """What all outputs do after the input has jumped by `size` [SI] at t = 0: deviations from the point."""
        from scipy.linalg import expm

        if not (0 < until < math.inf):
            raise ParameterError.at("until", "cannot be the end of a step response", value=until, allowed="above 0 s")
        i, n = _index(self.inputs, source, "input"), len(self.states)
        times = np.linspace(0.0, until, 1001 if every is None else round(until / every) + 1)
        block = np.zeros((n + 1, n + 1))
        block[:n, :n], block[:n, n] = self.A, self.B[:, i] * size
        onward = expm(block * (times[1] - times[0]))
        x = np.zeros((times.size, n + 1))
        x[0, n] = 1.0
        for k in range(1, times.size):
            x[k] = onward @ x[k - 1]
        y = x[:, :n] @ self.C.T + self.D[:, i] * size
        return Recording(times, {v.name: Signal(v.unit, v.display_unit, y[:, j]) for j, v in enumerate(self.outputs)})

    def __str__(self) -> str:
        return "\n".join(["natural frequency, damping ratio, states that take part", *map(str, self.modes())])


def linearise(
    model: Model,
    *,
    at: float | Mapping[str, float] = 0.0,
    inputs: Mapping[str, float] | None = None,
    parameters: Mapping[str, float] | None = None,
    outputs: Sequence[str] | None = None,
) -> Linearised:
    """The model linearised at its start values, at other values of its states, or at a time it is run to.

    at: a time [s], up to which the model is integrated with constant inputs; or values of states by name. inputs,
    parameters: values there (SI). outputs: names of any variables; by default the model's outputs.

    Raises `ParameterError` for an unknown name, `SolveError` if the point cannot be reached or the algebraic equations
    are singular there.
    """
    native = compiled(model)
    d = native.dae
    expressions = _expressions(d)
    names = [v.name for v in d.outputs] if outputs is None else list(outputs)
    problems = [
        Problem(d.name, f"has no variable {n!r}", hint=nearest(n, expressions)) for n in names if n not in expressions
    ]
    if problems:
        raise ParameterError(problems)
    settings = {**(parameters or {}), **(inputs or {}), **(at if isinstance(at, Mapping) else {})}
    with native.instantiate() as instance:
        instance.set("solver.tolerance", 1e-8)
        instance.set(list(settings), list(settings.values()))
        instance.initialize(0.0)
        if not isinstance(at, Mapping) and at > 0:
            instance.simulate([at], [])
        time = instance.time
        x, z, u, p = (
            instance.get([v.name for v in group]) for group in (d.states, d.algebraics, d.inputs, d.constants)
        )
    wanted = ca.vertcat(*[expressions[n] for n in names])
    pairs = [(e, v) for e in (d.ode, d.alg, wanted) for v in (d.x, d.z, d.u)]
    function = ca.Function("slopes", [d.t, d.x, d.z, d.u, d.p], [ca.jacobian(e, v) for e, v in pairs])
    f_x, f_z, f_u, g_x, g_z, g_u, y_x, y_z, y_u = (np.asarray(ca.DM(j)) for j in function(time, x, z, u, p))
    if d.algebraics:
        try:
            z_x, z_u = -np.linalg.solve(g_z, g_x), -np.linalg.solve(g_z, g_u)
        except np.linalg.LinAlgError:
            raise SolveError.at(d.name, f"the algebraic equations are singular at t = {time:g} s") from None
        f_x, f_u, y_x, y_u = f_x + f_z @ z_x, f_u + f_z @ z_u, y_x + y_z @ z_x, y_u + y_z @ z_u
    if not all(np.isfinite(matrix).all() for matrix in (f_x, f_u, y_x, y_u)):
        raise SolveError.at(d.name, f"a slope is not finite at t = {time:g} s")
    variables = {v.name: v for v in d.variables}
    point = dict(zip([v.name for v in (*d.states, *d.algebraics, *d.inputs)], map(float, (*x, *z, *u)), strict=True))
    return Linearised(d.states, d.inputs, tuple(variables[n] for n in names), f_x, f_u, y_x, y_u, time, point)


def _expressions(d: Dae) -> dict[str, Any]:
    groups = ((d.states, d.x), (d.algebraics, d.z), (d.outputs, d.out), (d.observables, d.obs))
    return {v.name: expressions[i] for variables, expressions in groups for i, v in enumerate(variables)}


def _index(variables: Sequence[Variable], name: str, what: str) -> int:
    names = [v.name for v in variables]
    if name not in names:
        raise ParameterError.at("linear model", f"has no {what} {name!r}", hint=nearest(name, names))
    return names.index(name)
