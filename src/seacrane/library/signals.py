"""Signal blocks: sources, algebra, limits, lags and the PID controller.

A block carries numbers, not power. Its signals are plain numbers unless the block is told their units: a block that
keeps the unit of what it is given has `unit="m/s"`; one that changes it has `takes="m", gives="m/s"`. Parameters are
numbers in those units.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import isfinite, pi
from typing import Any, ClassVar

import casadi as ca

from seacrane.errors import Problem, nearest
from seacrane.library import symbols
from seacrane.library.references import ASTROM_MURRAY, DISSERTATION, HYSTERESIS
from seacrane.model import BondGraph, Component, SignalIn, SignalOut, initial, option, parameter
from seacrane.model.ports import Port
from seacrane.numerics.regularise import limit, maximum, piecewise_linear
from seacrane.units import UNITS, Angle, AngularFrequency, Ratio, Time

Points = Sequence[tuple[float, float]]


class _Keeping(Component):
    """A block whose signals are all in one unit."""

    unit: str = option("unit of the signals", default="1")
    bond_graph = BondGraph()
    sources: ClassVar[tuple[str, ...]] = (DISSERTATION,)

    def check(self) -> Iterator[Problem]:
        yield from _unit_problem("unit", self.unit)

    def interface(self) -> Mapping[str, Port]:
        return _in_units(type(self).ports, self.unit, self.unit)


class _Changing(Component):
    """A block that takes signals in one unit and gives them in another."""

    takes: str = option("unit of the inputs", default="1")
    gives: str = option("unit of the output", default="1")
    bond_graph = BondGraph()
    sources: ClassVar[tuple[str, ...]] = (DISSERTATION,)

    def check(self) -> Iterator[Problem]:
        yield from _unit_problem("takes", self.takes)
        yield from _unit_problem("gives", self.gives)

    def interface(self) -> Mapping[str, Port]:
        return _in_units(type(self).ports, self.takes, self.gives)


def _in_units(ports: Mapping[str, Port], takes: str, gives: str) -> Mapping[str, Port]:
    return {
        name: replace(port, unit=takes)
        if isinstance(port, SignalIn)
        else replace(port, unit=gives)
        if isinstance(port, SignalOut)
        else port
        for name, port in ports.items()
    }


def _unit_problem(name: str, unit: object) -> Iterator[Problem]:
    if unit not in UNITS:
        yield Problem(name, f"unknown unit {unit!r}", hint=nearest(str(unit), UNITS))


# ---------------------------------------------------------------- sources
class Constant(_Keeping):
    """y = value."""

    value: Ratio = parameter("value", least=-1e12, most=1e12)
    ports = {"y": SignalOut()}
    icon = symbols.CONSTANT

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.y, self.value


class Sine(_Keeping):
    """y = bias + amplitude sin(2 pi t / period + phase)."""

    amplitude: Ratio = parameter("amplitude", least=-1e12, most=1e12)
    period: Time = parameter("period", above=0, most=1e6)
    phase: Angle = parameter("phase at t = 0", default=0.0, least=-10 * pi, most=10 * pi)
    bias: Ratio = parameter("mean value", default=0.0, least=-1e12, most=1e12)
    ports = {"y": SignalOut()}
    icon = symbols.SINE

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.y, self.bias + self.amplitude * ca.sin(2 * pi * m.time / self.period + self.phase)


class Step(_Keeping):
    """y goes from `before` to `after`, from time `at` on, along a line of duration `rise`.

    The rise keeps the signal continuous for the solver; make it shorter than anything that should notice it.
    """

    after: Ratio = parameter("value after the step", least=-1e12, most=1e12)
    before: Ratio = parameter("value before the step", default=0.0, least=-1e12, most=1e12)
    at: Time = parameter("time of the step", default=0.0, least=-1e6, most=1e6)
    rise: Time = parameter(
        "duration of the rise", default=1e-3, reason="shorter than anything hydraulic", above=0, most=1e6
    )
    ports = {"y": SignalOut()}
    icon = symbols.STEP

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.y, self.before + (self.after - self.before) * limit((m.time - self.at) / self.rise, 0.0, 1.0)


class Ramp(_Keeping):
    """y = start + slope (t - at) after the time `at`, `start` before."""

    slope: Ratio = parameter("slope, per second", least=-1e12, most=1e12)
    start: Ratio = parameter("value before the ramp", default=0.0, least=-1e12, most=1e12)
    at: Time = parameter("time at which it begins", default=0.0, least=-1e6, most=1e6)
    ports = {"y": SignalOut()}
    icon = symbols.RAMP

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.y, self.start + self.slope * maximum(m.time - self.at, 0.0)


class RecordedInput(_Keeping):
    """A recorded signal: y is the line through `points`, pairs (time [s], value), constant before and after.

    A jump is two points a little apart in time. An axis of a recorded joystick has values in [-1, 1]; put a
    `JoystickInput` behind it. Meant for tens to hundreds of points: each is part of the equations.
    """

    points: Points = option("pairs (time, value), times strictly rising")
    ports = {"y": SignalOut()}
    icon = symbols.RECORDED

    def check(self) -> Iterator[Problem]:
        yield from super().check()
        yield from _point_problems(self.points)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.y, piecewise_linear(m.time, self.points)


class JoystickInput(Component):
    """One axis of a joystick, from the angle of its lever to a command.

        u in [-1, 1] ──►[ _/ ]──► y = scale ((1 - c) s + c s^3) sign(u),  s = max(|u| - dead_zone, 0) / (1 - dead_zone)

    c `progression` makes small commands finer; at full deflection y = scale. The lever is held within [-1, 1]. There is
    no ramp and no dead man's switch in it: see `RateLimit` for the one; the other belongs to the control system.
    """

    dead_zone: Ratio = parameter(
        "deflection below which nothing happens", default=0.05, reason="the play of a worn lever", least=0, most=0.5
    )
    progression: Ratio = parameter("share c of the cubic part", default=0.0, least=0, most=1)
    scale: Ratio = parameter("output at full deflection", default=1.0, least=-1e12, most=1e12)
    gives: str = option("unit of the output", default="1")
    bond_graph = BondGraph()
    ports = {"u": SignalIn("1", "deflection of the lever", minimum=-1, maximum=1), "y": SignalOut()}
    icon = symbols.JOYSTICK
    sources = (DISSERTATION,)

    def check(self) -> Iterator[Problem]:
        yield from _unit_problem("gives", self.gives)

    def interface(self) -> Mapping[str, Port]:
        return _in_units(type(self).ports, "1", self.gives)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        u = limit(m.u, -1.0, 1.0)
        s = (u - limit(u, -self.dead_zone, self.dead_zone)) / (1 - self.dead_zone)
        yield m.y, self.scale * ((1 - self.progression) * s + self.progression * s**3)


# ---------------------------------------------------------------- algebra
class Gain(_Changing):
    """y = gain u + bias."""

    gain: Ratio = parameter("gain", least=-1e12, most=1e12)
    bias: Ratio = parameter("output at u = 0", default=0.0, least=-1e12, most=1e12)
    ports = {"u": SignalIn(), "y": SignalOut()}
    icon = symbols.GAIN

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.y, self.gain * m.u + self.bias


class Sum(_Keeping):
    """y = +-u1 +- u2 ...; `signs` says how many inputs there are and their signs, as "+-"."""

    signs: str = option("one sign for each input", default="++")
    ports = {"u1": SignalIn(), "u2": SignalIn(), "y": SignalOut()}
    icon = symbols.SUM

    def check(self) -> Iterator[Problem]:
        yield from super().check()
        if not isinstance(self.signs, str) or not self.signs or set(self.signs) - {"+", "-"}:
            yield Problem("signs", "must be one sign for each input", self.signs, "such as '+-'")

    def interface(self) -> Mapping[str, Port]:
        inputs = {f"u{i}": SignalIn(self.unit) for i in range(1, len(self.signs) + 1)}
        return {**inputs, "y": SignalOut(self.unit)}

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        terms = (m.ports[f"u{i}"] * (1 if sign == "+" else -1) for i, sign in enumerate(self.signs, start=1))
        yield m.y, sum(terms)


class Table(_Changing):
    """A characteristic: y is the line through `points`, pairs (u, y), constant beyond the first and last."""

    points: Points = option("pairs (u, y), u strictly rising")
    ports = {"u": SignalIn(), "y": SignalOut()}
    icon = symbols.TABLE

    def check(self) -> Iterator[Problem]:
        yield from super().check()
        yield from _point_problems(self.points)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.y, piecewise_linear(m.u, self.points)


def _point_problems(points: Any) -> Iterator[Problem]:
    try:
        pairs = [(float(x), float(y)) for x, y in points]
    except (TypeError, ValueError):
        yield Problem("points", "must be pairs of numbers", points)
        return
    if len(pairs) < 2:
        yield Problem("points", f"needs at least two points, has {len(pairs)}")
    if not all(isfinite(number) for pair in pairs for number in pair):
        yield Problem("points", "must be finite numbers")
    for (x0, _), (x1, _) in itertools.pairwise(pairs):
        if x1 <= x0:
            yield Problem("points", f"must rise strictly, but {x1:g} follows {x0:g}")
            return


# ---------------------------------------------------------------- limits
class Saturation(_Keeping):
    """y = u held within [low, high]."""

    low: Ratio = parameter("lower limit", least=-1e12, most=1e12)
    high: Ratio = parameter("upper limit", least=-1e12, most=1e12)
    ports = {"u": SignalIn(), "y": SignalOut()}
    icon = symbols.SATURATION

    def check(self) -> Iterator[Problem]:
        yield from super().check()
        yield from _limit_problem(self.low, self.high)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.y, limit(m.u, self.low, self.high)


class DeadBand(_Keeping):
    """y = 0 where |u| < width, else u moved towards zero by `width`."""

    width: Ratio = parameter("half width of the dead band", least=0, most=1e12)
    ports = {"u": SignalIn(), "y": SignalOut()}
    icon = symbols.DEAD_BAND

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.y, m.u - limit(m.u, -self.width, self.width)


class Relay(_Changing):
    """A switch with hysteresis: y = `on` once u has risen above `high`, `off` once it has fallen below `low`.

    It switches at once, at a located instant. Where y acts back on u, the two limits must be far enough apart for what
    is switched: nothing switches a thousand times in a second.
    """

    low: Ratio = parameter("input below which it switches off", least=-1e12, most=1e12)
    high: Ratio = parameter("input above which it switches on", least=-1e12, most=1e12)
    off: Ratio = parameter("output when off", default=0.0, least=-1e12, most=1e12)
    on: Ratio = parameter("output when on", default=1.0, least=-1e12, most=1e12)
    switched: Ratio = initial("1 if it starts on, 0 if off", least=0, most=1)
    ports = {"u": SignalIn(), "y": SignalOut()}
    icon = symbols.RELAY
    sources = (HYSTERESIS,)

    def check(self) -> Iterator[Problem]:
        yield from super().check()
        yield from _limit_problem(self.low, self.high)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        switched = m.mode("switched", start=round(self.switched), about="1 when on, 0 when off")
        yield m.y, self.off + (self.on - self.off) * switched
        span = self.high - self.low
        m.when(
            "rises", (1 - switched) * (m.u - self.high) / span, (switched, 1), about="input rises above its upper limit"
        )
        m.when("falls", switched * (self.low - m.u) / span, (switched, 0), about="input falls below its lower limit")


class RateLimit(_Keeping):
    """y follows u no faster than `rate`: dy/dt = (u - y) / lag, held within [-rate, rate].

    Within rate * lag of u the approach is a first-order lag, which keeps the law smooth.
    """

    rate: Ratio = parameter("greatest rate, per second", above=0, most=1e12)
    lag: Time = parameter(
        "time constant of the approach", default=0.01, reason="shorter than anything mechanical", above=0, most=1e3
    )
    start: Ratio = initial("output at the start", least=-1e12, most=1e12)
    ports = {"u": SignalIn(), "y": SignalOut()}
    icon = symbols.RATE_LIMIT

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        y = m.state("output", unit=self.unit, start=self.start, about="rate-limited signal")
        yield m.der(y), limit((m.u - y) / self.lag, -self.rate, self.rate)
        yield m.y, y


def _limit_problem(low: float, high: float) -> Iterator[Problem]:
    if low >= high:
        yield Problem("high", f"{high:g} must be above low = {low:g}")


# ---------------------------------------------------------------- dynamics
class FirstOrderLag(_Keeping):
    """T dy/dt + y = u."""

    time_constant: Time = parameter("time constant", above=0, most=1e6)
    start: Ratio = initial("output at the start", least=-1e12, most=1e12)
    ports = {"u": SignalIn(), "y": SignalOut()}
    icon = symbols.FIRST_ORDER_LAG
    sources = (f"{ASTROM_MURRAY}, chapter 'Linear Systems'",)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        y = m.state("output", unit=self.unit, start=self.start, about="lagged signal")
        yield m.der(y), (m.u - y) / self.time_constant
        yield m.y, y


class SecondOrderLag(_Keeping):
    """y'' + 2 zeta w y' + w^2 y = w^2 u."""

    natural_frequency: AngularFrequency = parameter("natural frequency w", above=0, most=1e6)
    damping: Ratio = parameter("damping ratio zeta", least=0, most=100)
    start: Ratio = initial("output at the start", least=-1e12, most=1e12)
    ports = {"u": SignalIn(), "y": SignalOut()}
    icon = symbols.SECOND_ORDER_LAG
    sources = (f"{ASTROM_MURRAY}, chapter 'Linear Systems'",)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = self.natural_frequency
        y = m.state("output", unit=self.unit, start=self.start, about="lagged signal")
        rate = m.state("rate", unit="1", about="rate of the lagged signal, per second")
        yield m.der(y), rate
        yield m.der(rate), w * w * (m.u - y) - 2 * self.damping * w * rate
        yield m.y, y


class PID(_Changing):
    """A PID controller with limits: u = kp e + i + d within [low, high], e = reference - measured.

        di/dt = ki (e + (u - u_free) / kp)      d = kd (e - f) / T_f,   T_f df/dt = e - f

    u_free is the output before the limits; where it is beyond them, the integral runs back (back-calculation with the
    tracking time kp/ki), so it never winds up. The derivative is filtered with T_f.

    Source: K. J. Astrom and T. Hagglund, Advanced PID Control, 2006, chapter 3.
    """

    kp: Ratio = parameter("proportional gain", above=0, most=1e12)
    ki: Ratio = parameter("integral gain, per second", default=0.0, least=0, most=1e12)
    kd: Ratio = parameter("derivative gain, times second", default=0.0, least=0, most=1e12)
    filter_time: Time = parameter(
        "time constant T_f of the derivative filter", default=0.01, reason="one control step", above=0, most=1e3
    )
    low: Ratio = parameter("lowest output", least=-1e12, most=1e12)
    high: Ratio = parameter("highest output", least=-1e12, most=1e12)
    integral: Ratio = initial("integral at the start", least=-1e12, most=1e12)
    ports = {"reference": SignalIn(), "measured": SignalIn(), "u": SignalOut()}
    icon = symbols.CONTROLLER
    sources = ("K. J. Astrom and T. Hagglund, Advanced PID Control, 2006, chapter 3",)

    def check(self) -> Iterator[Problem]:
        yield from super().check()
        yield from _limit_problem(self.low, self.high)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        e = m.reference - m.measured
        i = m.state("integral", unit=self.gives, start=self.integral, about="integral part of the output")
        f = m.state("filtered_error", unit=self.takes, about="filtered error")
        free = self.kp * e + i + self.kd * (e - f) / self.filter_time
        yield m.u, limit(free, self.low, self.high)
        yield m.der(i), self.ki * (e + (m.u - free) / self.kp)
        yield m.der(f), (e - f) / self.filter_time
