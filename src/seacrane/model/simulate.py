"""Run one model by itself: compiled, integrated by RODAS4, recorded with units."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import ArrayLike

from seacrane.errors import SolveError
from seacrane.results import Recording, Signal

from .dae import Dae
from .diagram import Diagram
from .native import NativeModel, build


def simulate(
    model: Diagram | Dae | NativeModel,
    until: float,
    *,
    every: float = 0.01,
    inputs: Mapping[str, float | tuple[ArrayLike, ArrayLike]] | None = None,
    parameters: Mapping[str, float] | None = None,
    record: Sequence[str] | None = None,
    tolerance: float = 1e-6,
    linear: bool = False,
) -> Recording:
    """The behaviour of a model from 0 to `until` [s], recorded every `every` [s].

    inputs: a constant, or sample times and values, for each input (SI); samples are held, or joined by straight lines
    if `linear`. parameters: values other than the model's own, start values of states included. record: names of
    variables, by default all. tolerance: relative, of the adaptive solver.

    Raises `ParameterError` for an unknown name, `SolveError` where the integration fails.
    """
    if not (math.isfinite(until) and until > 0 and 0 < every <= until):
        raise SolveError.at(
            "simulate", f"cannot run until {until:g} s with output every {every:g} s", allowed="0 < every <= until"
        )
    native = (
        model if isinstance(model, NativeModel) else build(model.compile() if isinstance(model, Diagram) else model)
    )
    variables = {v.name: v for v in native.dae.variables}
    names = list(variables) if record is None else list(record)
    times = np.linspace(0.0, until, round(until / every) + 1)
    constants = {n: float(v) for n, v in (inputs or {}).items() if not isinstance(v, tuple)}
    sampled = {n: v for n, v in (inputs or {}).items() if isinstance(v, tuple)}
    with native.instantiate() as instance:
        settings = {"solver.tolerance": tolerance, **(parameters or {}), **constants}
        instance.set(list(settings), list(settings.values()))
        if sampled:
            first = [float(np.asarray(values).reshape(-1)[0]) for _, values in sampled.values()]
            instance.set(list(sampled), first)
        instance.initialize(0.0)
        values = instance.simulate(times, names, sampled, linear=linear)
    return Recording(
        times,
        {n: Signal(variables[n].unit, variables[n].display_unit, values[:, i]) for i, n in enumerate(names)},
    )
