"""What is wrong with a run: why it stopped, or what it went through that the laws do not hold for.

Each finding names a variable and what to try.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from seacrane.errors import Problem, SolveError
from seacrane.numerics.equations import Reals
from seacrane.units import convert, with_unit

from .dae import Dae, Variable
from .singular import Point, components, undetermined_at

VACUUM = -1.0e5
"""Gauge pressure [Pa] below which there is no oil but vapour; laws without cavitation go there all the same."""

BURST = 2000e5
"""No hydraulic part stands more [Pa]."""

DEEP = 1e-3
"""[m] beyond its stroke: more than an end stop yields in service."""

EMPTY, FULL = 1.5e-3, 0.975
"""Shares of an accumulator's volume between which its oil is: the port has seated below, the gas gives way above."""

ABSURD = 1e6
"""A state beyond this many nominal values is on its way to infinity, and says nothing any more."""

LET_IN = "Let oil in: an AnticavitationValve from the tank, or a raised tank pressure."

Samples = Mapping[str, tuple[ArrayLike, ArrayLike]]


@dataclass(frozen=True)
class Stop:
    """Where a run stopped, its sampled inputs, whether these are joined by straight lines, and its tolerance.

    `seen` holds the recorded values by name, of all times up to there; `implicit` is False for a method that is stable
    in short steps only.
    """

    point: Point
    sampled: Samples
    linear: bool
    tolerance: float
    implicit: bool = True
    seen: Mapping[str, Reals] = field(default_factory=dict)


def explained(failure: SolveError, dae: Dae, stop: Stop) -> SolveError:
    """The failure with its findings: first what the solver said, then what stands out there."""
    first = failure.problems[0]
    stop = _before_it_escaped(dae, stop)
    findings = [*_findings(dae, stop)]
    told = " ".join([str(failure), *(p.path for p in findings)])
    if _named(dae, told) is None or not findings:
        findings += _culprit(dae, stop, str(failure))
    result = SolveError([Problem(first.path, first.message, hint=None if findings else first.hint), *findings])
    result.results = failure.results
    return result


def _before_it_escaped(dae: Dae, stop: Stop) -> Stop:
    """The same stop, or the last recorded one at which all states had values that something can be told from."""
    nominal = np.array([v.nominal for v in dae.states])
    names = [v.name for v in dae.states]
    if np.all(np.abs(stop.point.x) <= ABSURD * nominal) or not all(n in stop.seen for n in names):
        return stop
    rows = np.array([stop.seen[n] for n in names])
    sane = np.flatnonzero(np.all(np.abs(rows) <= ABSURD * nominal[:, None], axis=0))
    if not sane.size:
        return stop
    last = int(sane[-1])
    x = rows[:, last]
    z, u = (
        np.array(
            [stop.seen[v.name][last] if v.name in stop.seen else value for v, value in zip(group, old, strict=True)]
        )
        for group, old in ((dae.algebraics, stop.point.z), (dae.inputs, stop.point.u))
    )
    return replace(stop, point=Point(stop.point.time, x, z, u, stop.point.p))


def _findings(dae: Dae, stop: Stop) -> Iterator[Problem]:
    yield from undetermined_at(dae, stop.point, f"t = {stop.point.time:.9g} s")
    # Too long an explicit step drives pressures anywhere: they are no finding then.
    yield from _impossible_pressures(dae, stop) if stop.implicit else _too_fast(dae, stop)
    yield from _beyond_the_stroke(dae, stop)
    yield from _jumps(dae, stop)


def _values(dae: Dae, stop: Stop) -> Iterator[tuple[Variable, float]]:
    """States, and what was recorded last."""
    yield from zip(dae.states, stop.point.x.tolist(), strict=True)
    for v in dae.algebraics:
        if len(stop.seen.get(v.name, ())):
            yield v, float(stop.seen[v.name][-1])


def _impossible_pressures(dae: Dae, stop: Stop) -> Iterator[Problem]:
    for v, value in _values(dae, stop):
        if not _is_pressure(v):
            continue
        if value < VACUUM:
            yield Problem(
                v.name,
                f"is at {_shown(v, value)} (gauge), at or below vacuum: the oil there would cavitate",
                hint=LET_IN,
            )
        elif value > BURST:
            yield Problem(
                v.name,
                f"is at {_shown(v, value)}: oil is locked in where something moves on",
                hint="Let it out: a ReliefValve, leakage, or more volume.",
            )


def _beyond_the_stroke(dae: Dae, stop: Stop) -> Iterator[Problem]:
    parameters = {v.name: float(p) for v, p in zip(dae.constants, stop.point.p, strict=True)}
    for v, value in zip(dae.states, stop.point.x.tolist(), strict=True):
        stroke = _stroke(v, parameters)
        if stroke is not None and not -DEEP <= value <= stroke + DEEP:
            message = f"is at {value:.4g} m, beyond its stroke of 0 to {stroke:g} m"
            yield Problem(v.name, message, hint=_before_the_stop(v, parameters))


def _stroke(variable: Variable, parameters: Mapping[str, float]) -> float | None:
    owner, _, name = variable.name.rpartition(".")
    return parameters.get(f"{owner}.stroke") if name == "extension" else None


def _before_the_stop(variable: Variable, parameters: Mapping[str, float]) -> str:
    owner = variable.name.rpartition(".")[0]
    if f"{owner}.stop_stiffness" in parameters:
        return f"Brake earlier, or see whether {owner}.stop_stiffness and {owner}.stop_damping fit the load."
    return "This level has no end stops: brake earlier, or take the level 'extended'."


def _shell(variable: Variable, parameters: Mapping[str, float]) -> float | None:
    """The volume [m3] of the accumulator that the state is the oil of, or None."""
    owner, _, name = variable.name.rpartition(".")
    is_oil = name == "oil" and f"{owner}.precharge" in parameters
    return parameters.get(f"{owner}.volume") if is_oil else None


def _beyond_the_shell(v: Variable, times: Reals, values: Reals, shell: float) -> Iterator[Problem]:
    """Where an accumulator was drawn below empty, or its gas squeezed to less than its law goes."""
    room = f"its {with_unit(f'{shell * 1e3:g}', 'l')}"
    if at := _first(values < -EMPTY * shell):
        message = f"is drawn below empty from t = {times[at[0]]:g} s on, by up to {_shown(v, -float(np.min(values)))}"
        yield Problem(
            v.name, message, hint="Take a larger accumulator, more oil at the start, or let oil in elsewhere."
        )
    if at := _first(values > FULL * shell):
        message = f"leaves the gas no room in {room} from t = {times[at[0]]:g} s on, with up to "
        hint = "Take a larger accumulator or a higher precharge, or a relief valve beside it."
        yield Problem(v.name, message + _shown(v, float(np.max(values))), hint=hint)


def _is_pressure(variable: Variable) -> bool:
    """Whether it is a pressure of oil; a signal or a difference in pascal is none."""
    name = variable.name.rpartition(".")[2]
    return variable.unit == "Pa" and (name == "p" or name.startswith("pressure"))


def doubts(dae: Dae, times: Reals, seen: Mapping[str, Reals], settings: Mapping[str, float]) -> Iterator[Problem]:
    """What a run went through that its laws do not hold for: inputs out of range, extensions beyond strokes, vacuum.

    `seen` holds recorded values by name, `settings` the parameters that are not the model's own.
    """
    parameters = {v.name: settings.get(v.name, v.start) for v in dae.parameters}
    for v in dae.inputs:
        values = seen.get(v.name, times[:0])
        if at := _first((values < v.minimum - 1e-9) | (values > v.maximum + 1e-9)):
            message = f"is {values[at[0]]:g} at t = {times[at[0]]:g} s, outside its range"
            yield Problem(v.name, message, allowed=with_unit(f"{v.minimum:g} to {v.maximum:g}", v.unit))
    for v in dae.states + dae.algebraics:
        values = seen.get(v.name, times[:0])
        stroke = _stroke(v, parameters)
        if stroke is not None:
            beyond = np.maximum(-values, values - stroke)
            if at := _first(beyond > DEEP):
                message = f"is beyond its stroke of 0 to {stroke:g} m from t = {times[at[0]]:g} s on"
                most = f", by up to {np.max(beyond):.4g} m"
                yield Problem(v.name, message + most, hint=_before_the_stop(v, parameters))
        elif (shell := _shell(v, parameters)) is not None:
            yield from _beyond_the_shell(v, times, values, shell)
        elif _is_pressure(v) and (at := _first(values < VACUUM)):
            message = (
                f"is at or below vacuum from t = {times[at[0]]:g} s on, down to {_shown(v, float(np.min(values)))}"
            )
            yield Problem(v.name, message + ": the oil there would cavitate", hint=LET_IN)


def _first(found: Any) -> list[int]:
    """The index of the first true entry, or nothing."""
    return [int(i) for i in np.flatnonzero(found)[:1]]


def _jumps(dae: Dae, stop: Stop) -> Iterator[Problem]:
    if stop.linear:
        return
    for name, (times, values) in stop.sampled.items():
        t, v = (np.asarray(a, dtype=np.float64).reshape(-1) for a in (times, values))
        here = np.flatnonzero(np.abs(t[1:] - stop.point.time) <= 1e-6 * (1 + abs(stop.point.time))) + 1
        for i in here:
            if v[i] != v[i - 1]:
                yield Problem(
                    name,
                    f"jumps from {v[i - 1]:g} to {v[i]:g} at t = {t[i]:g} s, where the run stopped",
                    hint="No machine jumps: give it as a ramp (linear=True), or put a RateLimit behind it.",
                )


def _too_fast(dae: Dae, stop: Stop) -> Iterator[Problem]:
    """The fastest rate of the model, which bounds the step of an explicit method."""
    blocks = [ca.jacobian(f, y) for f in (dae.ode, dae.alg) for y in (dae.x, dae.z)]
    arguments = [dae.t, dae.x, dae.z, dae.u, dae.p]
    function = ca.Function("J", arguments, [ca.densify(b) for b in blocks])
    results: Any = function.call(list(stop.point.values))
    fx, fz, gx, gz = (np.asarray(r, dtype=np.float64).reshape(b.shape) for r, b in zip(results, blocks, strict=True))
    try:
        matrix = fx - fz @ np.linalg.solve(gz, gx)
        size, vectors = np.linalg.eig(np.nan_to_num(matrix))
    except np.linalg.LinAlgError:
        return
    if not size.size or np.max(np.abs(size)) == 0:
        return
    fastest = int(np.argmax(np.abs(size)))
    rate = abs(size[fastest])
    nominal = np.array([v.nominal for v in dae.states])
    v = dae.states[int(np.argmax(np.abs(vectors[:, fastest]) / nominal))]
    yield Problem(
        v.name,
        f"has a rate of {rate:.3g} 1/s there, which an explicit method must resolve",
        hint=f"Take a step below {2 / rate:.1g} s, or an implicit solver such as 'rodas4'.",
    )


def _named(dae: Dae, text: str) -> Variable | None:
    """The variable that the solver's message names."""
    words = set(re.findall(r"[\w.()]+", text.replace(". ", " ")))
    return next((v for v in dae.states + dae.algebraics if v.name in words), None)


def _culprit(dae: Dae, stop: Stop, text: str) -> Iterator[Problem]:
    """The state at fault: that of the message, or else the one that moves fastest."""
    f, y = ca.vertcat(dae.ode, dae.alg), dae.states + dae.algebraics
    function = ca.Function("f", [dae.t, dae.x, dae.z, dae.u, dae.p], [ca.densify(f)])
    rates: Reals = np.asarray(function(*stop.point.values), dtype=np.float64).ravel()
    lost = np.flatnonzero(~np.isfinite(rates))
    if lost.size:
        i = int(lost[0])
        owners = components(dae, f[i]) or [y[i].name.rpartition(".")[0] or dae.name]
        yield Problem(
            y[i].name,
            f"has no finite rate there; {' and '.join(owners)} take part in it",
            hint="Look there for a root or logarithm of what has become negative, or a division by what is zero.",
        )
        return
    variable = _named(dae, text)
    if variable is None and dae.states:
        scale = np.array([v.nominal for v in dae.states]) + np.abs(stop.point.x)
        variable = dae.states[int(np.argmax(np.abs(rates[: len(dae.states)]) / scale))]
    if variable is None:
        return
    owner = variable.name.rpartition(".")[0]
    where = f"Look at the parameters of {owner}" if owner else "Look at its equation"
    described = f" ({variable.about})" if variable.about else ""
    finer = f" If not, try another tolerance than {stop.tolerance:g}." if stop.implicit else ""
    states = [v.name for v in dae.states]
    if variable.name in states:
        i = states.index(variable.name)
        value, rate = _shown(variable, float(stop.point.x[i])), _shown(variable, float(rates[i]))
        message = f"is at {value}{described} and changes by {rate} per second there"
    else:
        message = f"is the unknown for which no solution was found{described}"
    yield Problem(variable.name, message, hint=f"{where}: is something there very stiff, very small or zero?{finer}")


def _shown(variable: Variable, value: float) -> str:
    unit = variable.display_unit
    return with_unit(convert(value, variable.unit, unit), unit, ".4g")
