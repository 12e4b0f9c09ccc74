"""Ships whose motion is given: fixed (level 0) and harmonic (level 1). The crane's wrench is taken but moves nothing.

Frames. The earth frame has z up and its origin at the still water. The ship frame has its origin midship at the
waterline, x forward, y to port, z up; at rest the two coincide. With surge, sway and heave p(t) of the ship's origin
and R = Rz(yaw) Ry(pitch) Rx(roll) from ship to earth axes, a foot at r in the ship has, all in ship axes,

    velocity       R' p_dot + w x r
    acceleration   R' p_ddot + alpha x r + w x (w x r)        (gravity is not in it)
    gravity        R' (0, 0, -g)

with w the angular velocity and alpha its derivative. Positive roll raises port, positive pitch lowers the bow,
positive yaw turns to port. Velocity and acceleration are exact derivatives of the motion, made by CasADi.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, fields
from typing import Any, Final

import casadi as ca

from seacrane import ocean
from seacrane.errors import ParameterError, Problem
from seacrane.model.dae import Dae, PowerBond, Variable, column
from seacrane.units import GRAVITY, deg

Point = tuple[float, float, float]

STEEPEST: Final = 45 * deg
"""Largest amplitude of a rotation that is taken for a ship's."""

OUTPUTS: Final = (
    *(Variable(a, "m", about=f"{a} of the ship's origin in earth axes") for a in "xyz"),
    Variable("qw", "1", start=1.0, about="attitude of the ship, quaternion from ship to earth axes"),
    *(Variable(f"q{a}", "1", about="attitude of the ship, quaternion from ship to earth axes") for a in "xyz"),
    *(Variable(f"foot.w{a}", "rad/s", about="angular velocity in ship axes") for a in "xyz"),
    *(Variable(f"foot.al{a}", "rad/s2", about="angular acceleration in ship axes") for a in "xyz"),
    *(
        Variable(f"foot.a{a}", "m/s2", about="acceleration of the crane's foot in ship axes, without gravity")
        for a in "xyz"
    ),
    *(Variable(f"foot.v{a}", "m/s", about="velocity of the crane's foot in ship axes") for a in "xyz"),
    Variable("foot.z", "m", about="height of the crane's foot over the still water"),
    *(Variable(f"foot.g{a}", "m/s2", about="gravity in ship axes") for a in "xyz"),
)
"""What every ship gives, in this order: its pose and the motion of the crane's foot."""

INPUTS: Final = (
    *(Variable(f"wrench.f{a}", "N", nominal=1e6, about="force of the crane on the ship, ship axes") for a in "xyz"),
    *(Variable(f"wrench.m{a}", "N.m", nominal=1e7, about="moment of the crane about its foot") for a in "xyz"),
)

BONDS: Final = (
    *(PowerBond(f"foot_{a}", f"foot.v{a}", f"wrench.f{a}") for a in "xyz"),
    *(PowerBond(f"foot_r{a}", f"foot.w{a}", f"wrench.m{a}") for a in "xyz"),
)
"""What the crane does to the ship: power into it."""

_OBSERVABLES: Final = tuple(Variable(name, "rad", about=f"{name} angle") for name in ("roll", "pitch", "yaw"))


@dataclass(frozen=True)
class Fixed:
    """A ship that does not move: level 0, or a crane on a quay."""

    def model(self, pedestal: Point) -> Dae:
        """The model "ship" with the crane's foot at `pedestal` [m] in the ship frame."""
        still = ca.SX.zeros(3)
        return _ship(pedestal, ca.SX.sym("t"), still, still, (), (), "ship that does not move (level 0)")


@dataclass(frozen=True, kw_only=True)
class Motion:
    """One degree of freedom: amplitude * cos(2 pi t / period + phase); amplitude in [m] or [rad]."""

    amplitude: float = 0.0
    period: float = 10.0
    phase: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Harmonic:
    """A ship in prescribed harmonic motion: level 1.

    During the first `ramp` seconds the motion grows from rest by the factor 10 s^3 - 15 s^4 + 6 s^5, s = t/ramp, whose
    first two derivatives vanish at both ends; velocity and acceleration include the growth. Amplitudes, periods,
    phases and the ramp are parameters of the model (`heave.amplitude`, ...).

    `ParameterError` lists all that is wrong.
    """

    surge: Motion = field(default_factory=Motion)
    sway: Motion = field(default_factory=Motion)
    heave: Motion = field(default_factory=Motion)
    roll: Motion = field(default_factory=Motion)
    pitch: Motion = field(default_factory=Motion)
    yaw: Motion = field(default_factory=Motion)
    ramp: float = 10.0

    def __post_init__(self) -> None:
        problems = []
        for name, motion in self._motions():
            if not math.isfinite(motion.amplitude):
                problems.append(Problem(f"{name}.amplitude", "must be a finite number", motion.amplitude))
            elif name in ("roll", "pitch", "yaw") and abs(motion.amplitude) > STEEPEST:
                degrees = abs(motion.amplitude) * deg <= STEEPEST
                hint = f"Did you mean {motion.amplitude:g} deg?" if degrees else None
                allowed = f"up to {STEEPEST:.3g} rad"
                problems.append(Problem(f"{name}.amplitude", "is too large [rad]", motion.amplitude, allowed, hint))
            if not (math.isfinite(motion.period) and motion.period > 0.0):
                problems.append(Problem(f"{name}.period", "must be positive [s]", motion.period, "above 0 s"))
            if not math.isfinite(motion.phase):
                problems.append(Problem(f"{name}.phase", "must be a finite number", motion.phase))
        if not (math.isfinite(self.ramp) and self.ramp >= 0.0):
            problems.append(Problem("ramp", "must not be negative [s]", self.ramp, "0 s or more"))
        if problems:
            raise ParameterError(problems)

    def _motions(self) -> Iterator[tuple[str, Motion]]:
        for f in fields(self):
            if f.name != "ramp":
                yield f.name, getattr(self, f.name)

    @classmethod
    def following(
        cls,
        height: float,
        period: float,
        direction: float = 0.0,
        phase: float = 0.0,
        *,
        length: float,
        beam: float,
        draught: float,
        ramp: float = 10.0,
    ) -> Harmonic:
        """Plausible prescribed motion of a box-shaped ship in a regular wave: it follows the water, and no more.

        The wave has `height` crest to trough [m], `period` [s] and goes to `direction` [rad], with the `phase` of
        `ocean.regular`. With a the amplitude, k the wave number, b the direction, u = k L cos(b)/2, v = k B sin(b)/2,
        s(u) = sin(u)/u and l(u) = 3 (sin u - u cos u)/u^3, the means over the waterplane, taken at the draught D, are

            heave  a exp(-k D) s(u) s(v)                surge, sway   the same times cos b, sin b, a quarter later
            pitch  a k cos(b) exp(-k D) l(u) s(v)       roll          a k sin(b) exp(-k D) s(u) l(v)

        (pitch and roll are the slopes of the plane fitted to the wave by least squares). In long waves heave is the
        wave's amplitude and the ship lies in the wave's slope. There is no inertia, damping or resonance in this: a
        real ship rolls far more near its natural period. It is motion to work in, not a prediction of motion.
        """
        problems = [
            Problem(name, "must be positive [m]", value, "above 0 m")
            for name, value in (("length", length), ("beam", beam), ("draught", draught))
            if not (math.isfinite(value) and value > 0.0)
        ]
        if problems:
            raise ParameterError(problems)
        wave = ocean.regular(height, period, direction, phase)
        k = float(wave.k[0])
        kx, ky = k * math.cos(direction), k * math.sin(direction)
        u, v = 0.5 * kx * length, 0.5 * ky * beam
        a = 0.5 * height * math.exp(-k * draught)
        crest, later = -phase, -phase - 0.5 * math.pi
        mean = a * _mean(u) * _mean(v)

        def motion(amplitude: float, phase: float) -> Motion:
            return Motion(amplitude=amplitude, period=period, phase=phase)

        return cls(
            surge=motion(mean * math.cos(direction), later),
            sway=motion(mean * math.sin(direction), later),
            heave=motion(mean, crest),
            roll=motion(a * ky * _mean(u) * _slope(v), later),
            pitch=motion(-a * kx * _slope(u) * _mean(v), later),
            ramp=ramp,
        )

    def model(self, pedestal: Point) -> Dae:
        """The model "ship" with the crane's foot at `pedestal` [m] in the ship frame."""
        t = ca.SX.sym("t")
        ramp = ca.SX.sym("ramp")
        share = ca.fmin(t / ca.fmax(ramp, 1e-6), 1.0) * (t > 0)
        grown = ca.if_else(ramp > 0, share**3 * (10 - 15 * share + 6 * share**2), 1.0)
        parameters, symbols, motions = [], [], []
        for name, motion in self._motions():
            unit = "rad" if name in ("roll", "pitch", "yaw") else "m"
            a, period, phase = (ca.SX.sym(f"{name}_{what}") for what in ("amplitude", "period", "phase"))
            motions.append(grown * a * ca.cos(2 * math.pi * t / period + phase))
            symbols += [a, period, phase]
            parameters += [
                Variable(f"{name}.amplitude", unit, start=motion.amplitude, about=f"amplitude of {name}"),
                Variable(f"{name}.period", "s", start=motion.period, minimum=1e-3, about=f"period of {name}"),
                Variable(f"{name}.phase", "rad", start=motion.phase, about=f"phase of {name} at time zero"),
            ]
        parameters.append(Variable("ramp", "s", start=self.ramp, minimum=0.0, about="time over which motion grows"))
        return _ship(
            pedestal,
            t,
            ca.vertcat(*motions[:3]),
            ca.vertcat(*motions[3:]),
            tuple(parameters),
            (*symbols, ramp),
            "ship in prescribed harmonic motion (level 1)",
        )


def _mean(u: float) -> float:
    """sin(u)/u: the mean of cos over -u..u."""
    return math.sin(u) / u if abs(u) > 1e-9 else 1.0


def _slope(u: float) -> float:
    """3 (sin u - u cos u)/u^3: slope of the line fitted to sin over -u..u."""
    return 3.0 * (math.sin(u) - u * math.cos(u)) / u**3 if abs(u) > 1e-3 else 1.0 - u * u / 10.0


def _ship(
    pedestal: Point,
    t: Any,
    position: Any,
    angles: Any,
    parameters: tuple[Variable, ...],
    symbols: tuple[Any, ...],
    about: str,
) -> Dae:
    """The model from the motion p(t) (3) and roll, pitch, yaw (3)."""
    if len(pedestal) != 3 or not all(math.isfinite(c) for c in pedestal):
        raise ParameterError.at("pedestal", "must be three finite coordinates [m]", value=pedestal)
    foot = ca.SX(ca.DM(list(pedestal)))
    roll, pitch, yaw = ca.vertsplit(angles)
    rates = ca.jacobian(angles, t)
    rotation = _about_z(yaw) @ _about_y(pitch) @ _about_x(roll)
    w = ca.vertcat(
        rates[0] - rates[2] * ca.sin(pitch),
        rates[1] * ca.cos(roll) + rates[2] * ca.sin(roll) * ca.cos(pitch),
        -rates[1] * ca.sin(roll) + rates[2] * ca.cos(roll) * ca.cos(pitch),
    )
    alpha = ca.jacobian(w, t)
    velocity = ca.jacobian(position, t)
    acceleration = ca.jacobian(velocity, t)
    outputs = column(
        position,
        _quaternion(roll, pitch, yaw),
        w,
        alpha,
        rotation.T @ acceleration + ca.cross(alpha, foot) + ca.cross(w, ca.cross(w, foot)),
        rotation.T @ velocity + ca.cross(w, foot),
        (position + rotation @ foot)[2],
        rotation.T @ ca.vertcat(0, 0, -GRAVITY),
    )
    none = column()
    return Dae(
        name="ship",
        states=(),
        algebraics=(),
        inputs=INPUTS,
        parameters=parameters,
        outputs=OUTPUTS,
        observables=_OBSERVABLES,
        t=t,
        x=none,
        z=none,
        u=ca.SX.sym("u", len(INPUTS)),
        p=column(*symbols),
        ode=none,
        alg=none,
        out=outputs,
        obs=column(angles),
        about=about,
        sources=("T. I. Fossen, Handbook of Marine Craft Hydrodynamics and Motion Control (2011), section 2.2",),
        bonds=BONDS,
    )


def _about_x(angle: Any) -> Any:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, c, -s), ca.horzcat(0, s, c))


def _about_y(angle: Any) -> Any:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, 0, s), ca.horzcat(0, 1, 0), ca.horzcat(-s, 0, c))


def _about_z(angle: Any) -> Any:
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))


def _quaternion(roll: Any, pitch: Any, yaw: Any) -> Any:
    """The unit quaternion (w, x, y, z) of Rz(yaw) Ry(pitch) Rx(roll); smooth in the angles, no change of sign."""
    cr, sr, cp, sp, cy, sy = (f(0.5 * angle) for angle in (roll, pitch, yaw) for f in (ca.cos, ca.sin))
    return ca.vertcat(
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )
