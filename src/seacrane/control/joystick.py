"""From the operator's sticks to the valves' spools: shaping, ramps, dead man's switch and limit stops.

For every axis, in this order:

1. dead band and shaping: a stick within its dead band is at rest; beyond, the rest of the travel s is stretched to
   0..1 and shaped to (1 - expo) s + expo s^3, fine near the middle and whole at the end;
2. ramp: the command follows by at most `ramp` per second; with the dead man's switch released it goes to zero within
   `release_time` instead, whatever the stick says;
3. stops: towards a limit the command is at most 1 outside the slow zone, falls in it linearly to `creep` and is 0 at
   the stop; away from a limit it is free. This bound is not ramped: a stop acts at once;
4. valve: a command other than zero jumps over the dead band of the valve, c -> d + (1 - d) c.

A value that is not a number is the safe one: a stick at rest, a released switch, a limit that is reached.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, ClassVar, Final, Self

from seacrane.design import Crane
from seacrane.errors import ParameterError, Problem
from seacrane.model.dae import Variable
from seacrane.units import Angle, Force, Frequency, Length, Ratio, Time, deg, kN

State = tuple[float, float, float, float]
"""The ramped command of each axis: slew, boom, jib, hoist."""

AXES: Final = ("slew", "boom", "jib", "hoist")

_ZERO: Final = 1e-6
"""A command below this is none: it does not lift the spool over the dead band of its valve."""


@dataclass(frozen=True, kw_only=True)
class Axis:
    """How one axis answers its stick."""

    dead_band: Ratio = 0.05
    expo: Ratio = 0.3
    ramp: Frequency = 1.0
    valve_dead_band: Ratio = 0.0


@dataclass(frozen=True, kw_only=True)
class Joystick:
    """Settings of the operator's control, and the control itself as a pure function of state and inputs.

    luff, jib: lower and upper end of travel [rad]; rope: shortest and longest unstretched length from drum to hook
    [m], the longest leaving the minimum wraps on the drum. `angle_margin`: where a joint stops before its end;
    `two_block`: hook to tip sheave at which hoisting stops (more than a folding jib draws in); `slack_tension`: below
    it the rope is slack and lowering stops, 0 never. `angle_zone`, `rope_zone`: the slow zones before a stop.

    `ParameterError` lists all that is wrong.
    """

    luff: tuple[Angle, Angle]
    jib: tuple[Angle, Angle]
    rope: tuple[Length, Length]
    slew_axis: Axis = field(default_factory=lambda: Axis(ramp=0.5))
    boom_axis: Axis = field(default_factory=Axis)
    jib_axis: Axis = field(default_factory=Axis)
    hoist_axis: Axis = field(default_factory=Axis)
    release_time: Time = 0.2
    angle_zone: Angle = 6 * deg
    angle_margin: Angle = 0.5 * deg
    creep: Ratio = 0.1
    two_block: Length = 3.0
    rope_zone: Length = 5.0
    slack_tension: Force = 5 * kN

    _shaping: tuple[tuple[float, float, float, float, float], ...] = field(init=False, repr=False, compare=False)
    _release: float = field(init=False, repr=False, compare=False)

    start: ClassVar[State] = (0.0, 0.0, 0.0, 0.0)

    inputs: ClassVar[tuple[Variable, ...]] = (
        Variable("axis.slew", minimum=-1.0, maximum=1.0, about="stick; positive turns to port"),
        Variable("axis.boom", minimum=-1.0, maximum=1.0, about="stick; positive raises the boom"),
        Variable("axis.jib", minimum=-1.0, maximum=1.0, about="stick; positive raises the jib"),
        Variable("axis.hoist", minimum=-1.0, maximum=1.0, about="stick; positive hoists"),
        Variable("deadman", minimum=0.0, maximum=1.0, about="dead man's switch: 1 held, 0 released"),
        Variable("luff", "rad", about="luffing angle of the boom"),
        Variable("jib", "rad", about="angle of the jib against the boom"),
        Variable("rope.unstretched_length", "m", about="rope from the drum to the hook"),
        Variable("rope.hanging", "m", about="distance from the tip sheave to the hook"),
        Variable("rope.tension", "N", about="tension of the rope"),
    )

    outputs: ClassVar[tuple[Variable, ...]] = (
        Variable("spool.slew", minimum=-1.0, maximum=1.0, about="spool of the slewing valve"),
        Variable("spool.boom", minimum=-1.0, maximum=1.0, about="spool of the boom valve"),
        Variable("spool.jib", minimum=-1.0, maximum=1.0, about="spool of the jib valve"),
        Variable("spool.winch", minimum=-1.0, maximum=1.0, about="spool of the winch valve"),
        Variable("limit.luff", about="1 if the upper end of luffing holds the boom back, -1 if the lower, else 0"),
        Variable("limit.jib", about="1 if the upper end holds the jib back, -1 if the lower, else 0"),
        Variable("limit.two_block", about="1 if the hook is too near the tip to hoist on at full speed"),
        Variable("limit.rope", about="1 if the rope is nearly all out, -1 if nearly all in and hoisting is held back"),
        Variable("limit.slack", about="1 if the rope is slack and lowering is stopped"),
    )

    @classmethod
    def of(cls, crane: Crane, *, rope: tuple[float, float], **settings: Any) -> Self:
        """The control of a crane with joints named luff and jib: their limits are taken from the design.

        `ParameterError` if the crane has no such joints or they are endless.
        """
        limits = {joint.name: joint.limits for joint in crane.joints}
        luff, jib = limits.get("luff"), limits.get("jib")
        if luff is None or jib is None:
            raise ParameterError(
                Problem(name, "the crane has no joint of this name with limits", allowed=", ".join(limits))
                for name in ("luff", "jib")
                if limits.get(name) is None
            )
        return cls(luff=luff, jib=jib, rope=rope, **settings)

    @property
    def axes(self) -> tuple[Axis, Axis, Axis, Axis]:
        """The axes in the order of the state."""
        return self.slew_axis, self.boom_axis, self.jib_axis, self.hoist_axis

    def __post_init__(self) -> None:
        problems = list(self._problems())
        if problems:
            raise ParameterError(problems)
        # All that a step needs, looked up once: a step is called every millisecond or two.
        shaping = tuple((a.dead_band, 1.0 / (1.0 - a.dead_band), a.expo, a.ramp, a.valve_dead_band) for a in self.axes)
        object.__setattr__(self, "_shaping", shaping)
        object.__setattr__(self, "_release", 1.0 / self.release_time)

    def _problems(self) -> Iterator[Problem]:
        for name, axis in zip(AXES, self.axes, strict=True):
            for what, low, high in (
                ("dead_band", 0.0, 0.9),
                ("expo", 0.0, 1.0),
                ("valve_dead_band", 0.0, 0.9),
                ("ramp", 1e-3, 1e3),
            ):
                value = getattr(axis, what)
                if not low <= value <= high:
                    yield Problem(f"{name}_axis.{what}", "is out of range", value, f"{low:g} to {high:g}")
        for name, (low, high), symbol in (
            ("luff", self.luff, "rad"),
            ("jib", self.jib, "rad"),
            ("rope", self.rope, "m"),
        ):
            if not low < high:
                yield Problem(name, f"the lower limit must be below the upper [{symbol}]", (low, high))
            elif symbol == "rad" and not high - low > 2 * self.angle_margin:
                yield Problem(
                    name, "leaves no room between the margins", (low, high), f"over {2 * self.angle_margin:g}"
                )
        if not 0.0 < self.release_time <= 1.0:
            yield Problem("release_time", "must stop the crane soon [s]", self.release_time, "above 0, up to 1 s")
        if not 0.0 <= self.creep <= 1.0:
            yield Problem("creep", "is a share of full speed", self.creep, "0 to 1")
        for name in ("angle_zone", "angle_margin", "two_block", "rope_zone", "slack_tension"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                yield Problem(name, "must not be negative", value, "0 or more")

    def step(self, state: State, inputs: list[float] | tuple[float, ...], dt: float) -> tuple[State, tuple[float, ...]]:
        """State and outputs after `dt` [s], from the state before and the inputs held meanwhile (in their order)."""
        held = inputs[4] >= 0.5
        luff, jib, length, hanging, tension = inputs[5:]

        angle_zone, rope_zone = self.angle_zone, self.rope_zone
        raising = self._allowed(self.luff[1] - self.angle_margin - luff, angle_zone)
        lowering = self._allowed(luff - self.luff[0] - self.angle_margin, angle_zone)
        stretching = self._allowed(self.jib[1] - self.angle_margin - jib, angle_zone)
        folding = self._allowed(jib - self.jib[0] - self.angle_margin, angle_zone)
        below = self._allowed(hanging - self.two_block, rope_zone)
        rope_in = self._allowed(length - self.rope[0], rope_zone)
        rope_out = self._allowed(self.rope[1] - length, rope_zone)
        slack = not tension >= self.slack_tension

        up = below if below < rope_in else rope_in
        down = 0.0 if slack else rope_out
        slew, spool_slew, _ = self._axis(0, state[0], inputs[0], held, dt, 1.0, 1.0)
        boom, spool_boom, at_luff = self._axis(1, state[1], inputs[1], held, dt, raising, lowering)
        fold, spool_jib, at_jib = self._axis(2, state[2], inputs[2], held, dt, stretching, folding)
        hoist, spool_winch, at_hoist = self._axis(3, state[3], inputs[3], held, dt, up, down)
        return (slew, boom, fold, hoist), (
            spool_slew,
            spool_boom,
            spool_jib,
            spool_winch,
            at_luff,
            at_jib,
            1.0 if at_hoist > 0 and below < 1.0 else 0.0,
            -1.0 if at_hoist > 0 and rope_in < 1.0 else 1.0 if at_hoist < 0 and rope_out < 1.0 else 0.0,
            1.0 if slack else 0.0,
        )

    def __call__(self, time: float, step: float, state: Any, inputs: Any) -> tuple[State, tuple[float, ...]]:
        """The same as a slave function of co-simulation: arrays of the state and the inputs in, tuples out."""
        return self.step(state.tolist(), inputs.tolist(), step)

    def _allowed(self, distance: float, zone: float) -> float:
        """The largest command towards a stop that is `distance` away; 0 where the distance is not a number."""
        if not distance > 0.0:
            return 0.0
        if distance >= zone:
            return 1.0
        return self.creep + (1.0 - self.creep) * distance / zone

    def _axis(
        self, index: int, command: float, stick: float, held: bool, dt: float, upward: float, downward: float
    ) -> tuple[float, float, float]:
        """New command, spool, and the side (+1, -1) on which a limit holds the stick back."""
        dead_band, stretch, expo, ramp, valve = self._shaping[index]
        target = 0.0
        if held:
            size = abs(stick)
            if size > dead_band:  # also false for a stick that is not a number
                size = (size if size < 1.0 else 1.0) - dead_band
                size *= stretch
                size = (1.0 - expo) * size + expo * size**3
                target = size if stick > 0.0 else -size
        else:
            ramp = max(ramp, self._release)
        most = ramp * dt
        change = target - command
        command = target if -most <= change <= most else command + (most if change > 0.0 else -most)

        side = 1.0 if target > upward else -1.0 if target < -downward else 0.0
        if command > upward:
            command = upward
        elif command < -downward:
            command = -downward

        if command > _ZERO:
            return command, valve + (1.0 - valve) * command, side
        if command < -_ZERO:
            return command, (1.0 - valve) * command - valve, side
        return command, 0.0, side
