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
from typing import Any, Final, Literal, Self

from seacrane.design import Crane
from seacrane.errors import ParameterError, Problem
from seacrane.model.dae import Variable
from seacrane.units import Angle, Force, Frequency, Length, Ratio, Time, deg, kN

State = tuple[float, ...]
"""The ramped command of each axis in their order, the hoist's last."""

SLEW: Final = "slew"
HOIST: Final = "hoist"

_ZERO: Final = 1e-6
"""A command below this is none: it does not lift the spool over the dead band of its valve."""


@dataclass(frozen=True, kw_only=True)
class Axis:
    """How one axis answers its stick."""

    dead_band: Ratio = 0.05
    expo: Ratio = 0.3
    ramp: Frequency = 1.0
    valve_dead_band: Ratio = 0.0


def axis_names(crane: Crane) -> tuple[str, ...]:
    """What the axis of each joint is called: slew, or after the cylinder that moves the joint, or after the joint."""
    moved = {cylinder.moves: cylinder.name.removesuffix("_cylinder") for cylinder in crane.cylinders}
    slewed = crane.slew.joint if crane.slew else None
    return tuple(SLEW if joint.name == slewed else moved.get(joint.name, joint.name) for joint in crane.joints)


@dataclass(frozen=True, kw_only=True)
class JointAxis:
    """An axis that moves a joint: its name and that of the joint, lower and upper end of travel or none [rad or m]."""

    name: str
    joint: str
    limits: tuple[float, float] | None
    unit: Literal["rad", "m"] = "rad"
    axis: Axis = field(default_factory=Axis)


@dataclass(frozen=True, kw_only=True)
class Joystick:
    """Settings of the operator's control, and the control itself as a pure function of state and inputs.

    joints: the axes that move joints, each with an input `axis.<name>` and an output `spool.<name>`; the hoist has
    `axis.hoist` and `spool.winch`. A joint with limits is measured under its name, and `limit.<joint>` says which end
    holds it back. rope: shortest and longest unstretched length from drum to hook [m], the longest leaving the minimum
    wraps on the drum. `angle_margin`, `slide_margin`: where a joint stops before its end; `two_block`: hook to tip
    sheave at which hoisting stops (more than a folding jib draws in), and sliding out, which draws the hook in;
    `slack_tension`: below it the rope is slack and lowering stops, 0 never. `angle_zone`, `slide_zone`, `rope_zone`:
    the slow zones before a stop.

    `ParameterError` lists all that is wrong.
    """

    joints: tuple[JointAxis, ...]
    rope: tuple[Length, Length]
    hoist_axis: Axis = field(default_factory=Axis)
    release_time: Time = 0.2
    angle_zone: Angle = 6 * deg
    angle_margin: Angle = 0.5 * deg
    slide_zone: Length = 0.5
    slide_margin: Length = 0.05
    creep: Ratio = 0.1
    two_block: Length = 3.0
    rope_zone: Length = 5.0
    slack_tension: Force = 5 * kN

    _shaping: tuple[tuple[float, float, float, float, float], ...] = field(init=False, repr=False, compare=False)
    _stops: tuple[tuple[float, float, float, bool] | None, ...] = field(init=False, repr=False, compare=False)
    _release: float = field(init=False, repr=False, compare=False)

    @classmethod
    def of(
        cls,
        crane: Crane,
        *,
        rope: tuple[float, float],
        axis: Axis | None = None,
        slew_axis: Axis | None = None,
        **settings: Any,
    ) -> Self:
        """The control of a crane: an axis for each joint, with its limits, in the order of the chain.

        The slewing axis is called `slew`; one that a cylinder moves after the cylinder, such as boom of boom_cylinder;
        any other after its joint. `axis`, `slew_axis`: how they answer. `ParameterError` if a joint that is not slewed
        is endless.
        """
        axis, slew_axis = axis or Axis(), slew_axis or Axis(ramp=0.5)
        joints = tuple(
            JointAxis(
                name=name,
                joint=joint.name,
                limits=joint.limits,
                unit="rad" if joint.kind == "revolute" else "m",
                axis=slew_axis if name == SLEW else axis,
            )
            for name, joint in zip(axis_names(crane), crane.joints, strict=True)
        )
        endless = [item for item in joints if item.limits is None and item.name != SLEW]
        if endless:
            raise ParameterError(Problem(item.joint, "only a slewing joint may be endless") for item in endless)
        return cls(joints=joints, rope=rope, hoist_axis=axis, **settings)

    @property
    def axes(self) -> dict[str, Axis]:
        """The axes by name, in the order of the state."""
        return {item.name: item.axis for item in self.joints} | {HOIST: self.hoist_axis}

    @property
    def start(self) -> State:
        """All axes at rest."""
        return (0.0,) * len(self.axes)

    @property
    def inputs(self) -> tuple[Variable, ...]:
        """Sticks, the dead man's switch, the joints that have limits, the rope."""
        return (
            *(
                Variable(f"axis.{item.name}", minimum=-1.0, maximum=1.0, about=f"stick; positive moves {item.joint} up")
                for item in self.joints
            ),
            Variable(f"axis.{HOIST}", minimum=-1.0, maximum=1.0, about="stick; positive hoists"),
            Variable("deadman", minimum=0.0, maximum=1.0, about="dead man's switch: 1 held, 0 released"),
            *(Variable(item.joint, item.unit, about="position of the joint") for item in self.joints if item.limits),
            Variable("rope.unstretched_length", "m", about="rope from the drum to the hook"),
            Variable("rope.hanging", "m", about="distance from the tip sheave to the hook"),
            Variable("rope.tension", "N", about="tension of the rope"),
        )

    @property
    def outputs(self) -> tuple[Variable, ...]:
        """Spools, then what holds an axis back."""
        sides = "1 if the upper end of the joint holds it back, -1 if the lower, else 0"
        return (
            *(
                Variable(f"spool.{name}", minimum=-1.0, maximum=1.0, about=f"spool of the {name} valve")
                for name in (*(item.name for item in self.joints), "winch")
            ),
            *(Variable(f"limit.{item.joint}", about=sides) for item in self.joints if item.limits),
            Variable(
                "limit.two_block", about="1 if the hook is too near the tip to hoist, or slide out, at full speed"
            ),
            Variable(
                "limit.rope", about="1 if the rope is nearly all out, -1 if nearly all in and hoisting is held back"
            ),
            Variable("limit.slack", about="1 if the rope is slack and lowering is stopped"),
        )

    def __post_init__(self) -> None:
        problems = list(self._problems())
        if problems:
            raise ParameterError(problems)
        # All that a step needs, looked up once: a step is called every millisecond or two.
        axes = self.axes.values()
        shaping = tuple((a.dead_band, 1.0 / (1.0 - a.dead_band), a.expo, a.ramp, a.valve_dead_band) for a in axes)
        object.__setattr__(self, "_shaping", shaping)
        object.__setattr__(self, "_stops", tuple(self._stop(item) for item in self.joints))
        object.__setattr__(self, "_release", 1.0 / self.release_time)

    def _stop(self, item: JointAxis) -> tuple[float, float, float, bool] | None:
        """Where a joint stops below and above, its slow zone, and whether it slides; none if it is endless."""
        if item.limits is None:
            return None
        slides = item.unit == "m"
        margin, zone = (self.slide_margin, self.slide_zone) if slides else (self.angle_margin, self.angle_zone)
        return item.limits[0] + margin, item.limits[1] - margin, zone, slides

    def _problems(self) -> Iterator[Problem]:
        names = [item.name for item in self.joints]
        for name in sorted({n for n in names if names.count(n) > 1 or n in (HOIST, "winch")}):
            yield Problem(f"joints[{name}]", "is the name of two axes", hint="hoist and winch are taken by the hoist")
        for name, axis in self.axes.items():
            for what, low, high in (
                ("dead_band", 0.0, 0.9),
                ("expo", 0.0, 1.0),
                ("valve_dead_band", 0.0, 0.9),
                ("ramp", 1e-3, 1e3),
            ):
                value = getattr(axis, what)
                if not low <= value <= high:
                    yield Problem(f"{name}.axis.{what}", "is out of range", value, f"{low:g} to {high:g}")
        for item in self.joints:
            if item.limits is None:
                continue
            low, high = item.limits
            margin = self.slide_margin if item.unit == "m" else self.angle_margin
            if not low < high:
                yield Problem(item.joint, f"the lower limit must be below the upper [{item.unit}]", item.limits)
            elif not high - low > 2 * margin:
                allowed = f"over {2 * margin:g} {item.unit}"
                yield Problem(item.joint, "leaves no room between the margins", item.limits, allowed)
        if not self.rope[0] < self.rope[1]:
            yield Problem("rope", "the lower limit must be below the upper [m]", self.rope)
        if not 0.0 < self.release_time <= 1.0:
            yield Problem("release_time", "must stop the crane soon [s]", self.release_time, "above 0, up to 1 s")
        if not 0.0 <= self.creep <= 1.0:
            yield Problem("creep", "is a share of full speed", self.creep, "0 to 1")
        for name in (
            "angle_zone",
            "angle_margin",
            "slide_zone",
            "slide_margin",
            "two_block",
            "rope_zone",
            "slack_tension",
        ):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                yield Problem(name, "must not be negative", value, "0 or more")

    def step(self, state: State, inputs: list[float] | tuple[float, ...], dt: float) -> tuple[State, tuple[float, ...]]:
        """State and outputs after `dt` [s], from the state before and the inputs held meanwhile (in their order)."""
        count = len(self._stops)
        held = inputs[count + 1] >= 0.5
        length, hanging, tension = inputs[-3:]
        below = self._allowed(hanging - self.two_block, self.rope_zone)
        rope_in = self._allowed(length - self.rope[0], self.rope_zone)
        rope_out = self._allowed(self.rope[1] - length, self.rope_zone)
        slack = not tension >= self.slack_tension

        commands, spools, sides = [], [], []
        measured, drawn_in = count + 2, False  # whether the hook holds back a joint that draws it in
        for index, stop in enumerate(self._stops):
            upward = downward = 1.0
            if stop is not None:
                low, high, zone, slides = stop
                position = inputs[measured]
                measured += 1
                upward, downward = self._allowed(high - position, zone), self._allowed(position - low, zone)
                hook = slides and below < upward
                if hook:
                    upward = below
            command, spool, side = self._axis(index, state[index], inputs[index], held, dt, upward, downward)
            commands.append(command)
            spools.append(spool)
            if stop is not None:
                by_hook = hook and side > 0
                drawn_in = drawn_in or by_hook
                sides.append(0.0 if by_hook else side)
        up = below if below < rope_in else rope_in
        down = 0.0 if slack else rope_out
        hoist, spool_winch, at_hoist = self._axis(count, state[count], inputs[count], held, dt, up, down)
        return (*commands, hoist), (
            *spools,
            spool_winch,
            *sides,
            1.0 if drawn_in or (at_hoist > 0 and below < 1.0) else 0.0,
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
