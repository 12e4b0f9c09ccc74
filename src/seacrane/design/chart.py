"""The load chart: what a crane may lift in each posture, and what keeps it from more.

For a posture, virtual work gives what each joint bears: the crane's own weight S_i and, for each newton W on the hook,
the lever B_i of the load, with the rope led over the sheaves down to the drum (tension W / falls). A cylinder with the
lever l_i = d(length)/d(coordinate) then pushes with (S_i + W B_i) / l_i, which must lie between the pull of its rod
side and the push of its piston side. The other limits are the overturning moment of the slewing ring, the moments that
the structure bears, rope, winch, load moment and the ship's stability, each where the design gives it.

At sea the load is not steady. The dynamic factor of a load m on a crane of stiffness k that is met with the relative
speed v_r is psi = 1 + v_r/g sqrt(k/m), with v_r = v_L/2 + sqrt(v_d^2 + v_c^2): hoisting speed v_L of the hook, speed
of the supply vessel's deck v_d = 6 Hs / (Hs + 8) and of the crane's tip v_c (EN 13852-1:2013, dynamic coefficients for
lifts from a floating vessel). The load may also lead outboard by up to 2.5 m + 1.5 Hs over the height of the tip above
the sea; what counts is the worst lead.
What a limit bears, psi m = C, is solved for m: sqrt(m) = (sqrt(b^2 + 4 C) - b) / 2 with b = v_r sqrt(k) / g.

These are computed capacities of a design, not a certified load chart.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seacrane.design.crane import Crane, Cylinder
from seacrane.design.geometry import retracted_length
from seacrane.design.planar import Array, Plane, Postures, grid, plane_joints
from seacrane.errors import DesignError
from seacrane.units import GRAVITY

NOTHING = "nothing"
"""What governs where no limit is given at all."""

_STROKE_MARGIN = 0.01
"""Share of the stroke below which the oil column is not taken shorter: ports and heads hold that much."""

_LEAST_HANG = 1.0
"""Least height of the tip above the sea [m] in the lead of the load and the length of the rope."""


@dataclass(frozen=True)
class Mode:
    """A condition with a curve of its own: harbour, or a significant wave height [m]."""

    name: str
    wave_height: float = 0.0

    @property
    def at_sea(self) -> bool:
        return self.wave_height > 0


HARBOUR = Mode("harbour")


def modes(crane: Crane) -> tuple[Mode, ...]:
    """Harbour, and one mode for each wave height of the design, called `hs1.0` and so on."""
    return (HARBOUR, *(Mode(f"hs{height:.1f}", height) for height in crane.rating.wave_heights))


def mode(crane: Crane, name: str) -> Mode:
    """The mode of this name; `DesignError` with the names there are."""
    known = {m.name: m for m in modes(crane)}
    if name not in known:
        raise DesignError.at("mode", "is not one of this crane", value=name, allowed=", ".join(known))
    return known[name]


@dataclass(frozen=True)
class Capacity:
    """Loads for a set of postures; all arrays have the shape of the postures broadcast together.

    radius, height [m] of the tip from the slewing axis and the foot; swl [kg], 0 where not even the hook is held;
    governs: index into `limits` of what keeps it from more.
    """

    radius: Array
    height: Array
    swl: Array
    governs: NDArray[np.int8]
    limits: tuple[str, ...]


def limits(crane: Crane) -> tuple[str, ...]:
    """The names of the limits of a crane in their order."""
    rating, hoist = crane.rating, crane.hoist
    named = [cylinder.name for cylinder in crane.cylinders]
    named += [f"structure at {item.joint}" for item in rating.structure]
    named += ["slew moment"] * (rating.slew_moment is not None)
    named += ["rope"] * (hoist.rope.breaking_load is not None) + ["winch"] * (hoist.line_pull is not None)
    named += ["load moment"] * (rating.load_moment is not None)
    named += ["ship stability"] * (rating.heeling_moment is not None)
    return tuple(named) or (NOTHING,)


def capacity(crane: Crane, postures: Postures, mode: Mode = HARBOUR) -> Capacity:
    """What the crane may lift in each posture of a set (see `planar`), and what governs.

    `DesignError` if the crane does not move in one plane.
    """
    lift = _Lift(crane, postures, mode)
    shape = np.broadcast_shapes(*(np.shape(q) for q in postures.values()))
    swl, governs = np.full(shape, np.inf), np.zeros(shape, dtype=np.int8)
    for index, most in enumerate(lift.loads()):
        if index == 0:
            swl[...] = most
            continue
        less = most < swl
        np.copyto(swl, most, where=less)
        governs[less] = index
    swl -= crane.hoist.hook_mass
    np.maximum(swl, 0.0, out=swl)
    x, z = lift.tip
    return Capacity(np.broadcast_to(x, shape), np.broadcast_to(z, shape), swl, governs, limits(crane))


def each_limit(crane: Crane, posture: dict[str, float], mode: Mode = HARBOUR) -> dict[str, float]:
    """For one posture: by the name of each limit, what could be lifted if it were the only one [kg]."""
    lift = _Lift(crane, {name: np.asarray(q) for name, q in posture.items()}, mode)
    loads = (max(0.0, float(load) - crane.hoist.hook_mass) for load in lift.loads())
    return dict(zip(limits(crane), loads, strict=False))


@dataclass(frozen=True)
class Row:
    """One line of a load chart: a mode, a radius [m], the load [kg] of its best posture, what governs it there."""

    mode: str
    radius: float
    swl: float
    governs: str
    posture: dict[str, float]


def curve(crane: Crane, mode: Mode = HARBOUR, *, radii: Sequence[float] | None = None, count: int = 0) -> list[Row]:
    """The load chart of one mode: for each radius [m] the best posture; radii out of reach are left out.

    The tip of each posture of a grid of `count` per joint falls into a band about each radius, half as wide as the
    distance between radii (all whole metres, unless given) and at most 0.125 m; the load is scaled to the radius by the
    moment, which is exact where a moment governs and changes it by less than the width over the radius elsewhere.
    """
    joints = len(plane_joints(crane))
    postures = grid(crane, count or _COUNTS.get(joints, 16))
    found = capacity(crane, postures, mode)
    reach = found.radius.ravel()
    wanted = _whole(reach) if radii is None else np.asarray(radii, float)
    spacing = np.min(np.diff(np.sort(wanted))) if len(wanted) > 1 else 1.0
    band = min(0.125, 0.25 * float(spacing)) if spacing > 0 else 0.125
    order = np.argsort(reach, kind="stable")
    ordered, loads = reach[order], found.swl.ravel()
    rows = []
    for radius in wanted:
        inside = order[np.searchsorted(ordered, radius - band) : np.searchsorted(ordered, radius + band, "right")]
        if not inside.size:
            continue
        best = int(inside[np.argmax(loads[inside] * np.minimum(1.0, reach[inside] / radius))])
        at = np.unravel_index(best, found.swl.shape)
        swl = float(loads[best] * min(1.0, reach[best] / radius))
        name = found.limits[found.governs[at]]
        rows.append(Row(mode.name, float(radius), swl, name, _posture(postures, at)))
    return rows


def to_csv(rows: Sequence[Row]) -> str:
    """Rows as CSV with the columns mode, radius_m, swl_t, governs."""
    lines = [f"{row.mode},{row.radius:.10g},{row.swl / 1e3:.6g},{row.governs}" for row in rows]
    return "\n".join(["mode,radius_m,swl_t,governs", *lines]) + "\n"


_COUNTS = {1: 2000, 2: 256, 3: 40, 4: 16}
"""Postures per joint of a curve, by the number of joints in the plane."""


def _whole(reach: Array) -> Array:
    return np.arange(math.ceil(max(float(reach.min()), 1.0)), math.floor(float(reach.max())) + 1, dtype=float)


def _posture(postures: Postures, at: tuple[np.intp, ...]) -> dict[str, float]:
    full = np.broadcast_arrays(*postures.values())
    return {name: float(array[at]) for name, array in zip(postures, full, strict=True)}


def hook_speed_needed(crane: Crane, mode: Mode) -> float:
    """The least hook speed [m/s] for lifts in this mode: K sqrt(v_d^2 + v_c^2), K = 0.5 on a single fall, 0.28 on more.

    Source: EN 13852-1:2013, hoisting speed for lifts from a floating vessel.
    """
    return (0.5 if crane.hoist.falls == 1 else 0.28) * _meeting_speed(crane, mode)


def _meeting_speed(crane: Crane, mode: Mode) -> float:
    deck = 6 * mode.wave_height / (mode.wave_height + 8)
    return math.hypot(deck, crane.rating.tip_speed_per_height * mode.wave_height)


class _Lift:
    """The lift of a load in a set of postures: what each limit leaves for the hook with its load [kg]."""

    def __init__(self, crane: Crane, postures: Postures, mode: Mode) -> None:
        self.crane, self.mode = crane, mode
        self.plane = Plane(crane, postures)
        self.tip = self.plane.tip()
        heel = crane.rating.heel
        self.up = -math.sin(heel), math.cos(heel)
        self.hang = np.maximum(self.tip[1] + crane.pedestal[2], _LEAST_HANG)
        self.lead = (2.5 + 1.5 * mode.wave_height) / self.hang if mode.at_sea else np.zeros(())
        self.joints = [joint.name for joint in plane_joints(crane)]
        self.levers = {c.name: self.plane.distance_by_joint(c.moves, c.base, c.eye) for c in crane.cylinders}
        self.impact = self._impact() if mode.at_sea else None

    def loads(self) -> Iterator[Array]:
        """What each limit leaves, in the order of `limits` [kg]."""
        dynamic = (self._steady(force / GRAVITY) for force in self._dynamic())
        static = (moment / GRAVITY for moment in self._static())
        found = itertools.chain(dynamic, static)
        first = next(found, None)
        yield np.asarray(np.inf) if first is None else first
        yield from found

    def _steady(self, borne: Array) -> Array:
        """The mass whose weight with dynamics is what is borne, psi m = borne [kg]."""
        steady = borne / self.crane.rating.harbour_factor
        if self.impact is None:
            return steady
        b = self.impact
        with np.errstate(invalid="ignore"):
            root = 0.5 * (np.sqrt(b * b + 4 * np.maximum(borne, 0.0)) - b)
        return np.minimum(steady, np.where(np.isinf(borne), np.inf, root * root))

    def _impact(self) -> Array:
        """b = v_r sqrt(k) / g [sqrt(kg)]."""
        hoist = self.crane.hoist
        speed = 0.5 * hoist.speed / hoist.falls + _meeting_speed(self.crane, self.mode)
        return speed * np.sqrt(self._stiffness()) / GRAVITY

    def _stiffness(self) -> Array:
        """Vertical stiffness at the hook [N/m]: rope and oil columns in series; the structure is taken as rigid."""
        hoist = self.crane.hoist
        compliance = (self.plane.rope_length() / hoist.falls**2 + self.hang / hoist.falls) / hoist.rope.EA
        for cylinder in self.crane.cylinders:
            ratio = _over(self._load_levers(cylinder.moves)[0], self.levers[cylinder.name])
            oil = _oil_stiffness(self.crane, cylinder, self.plane.distance(cylinder.base, cylinder.eye))
            compliance = compliance + np.where(np.isfinite(ratio), ratio * ratio, 0.0) / oil
        return 1.0 / compliance

    def _load_levers(self, joint: str) -> tuple[Array, Array]:
        """d(height of the hook along the load's line)/d(coordinate), rope and all: hanging plumb, and led outboard."""
        dx, dz = self.plane.by_joint(joint, self.tip)
        plumb = self.up[0] * dx + self.up[1] * dz + self.plane.rope_by_joint(joint) / self.crane.hoist.falls
        return plumb, plumb - self.lead * (self.up[1] * dx - self.up[0] * dz) if self.mode.at_sea else plumb

    def _own(self, joint: str) -> Array:
        return GRAVITY * self.plane.own_moment(joint, self.up)

    def _dynamic(self) -> Iterator[Array]:
        """Weights with dynamics [N] at the limits that dynamics use up."""
        crane, rating, hoist = self.crane, self.crane.rating, self.crane.hoist
        for cylinder in crane.cylinders:
            lever = self.levers[cylinder.name]
            own = _over(self._own(cylinder.moves), lever)
            loads = [_over(load, lever) for load in self._load_levers(cylinder.moves)]
            push, pull = forces(cylinder)
            yield _between(own, loads, -pull, push)
        for item in rating.structure:
            yield _between(self._own(item.joint), self._load_levers(item.joint), -item.moment, item.moment)
        if rating.slew_moment is not None:
            yield _between(*self._overturning(), -rating.slew_moment, rating.slew_moment)
        eta = _reeving(hoist.falls, hoist.sheave_efficiency)
        if hoist.rope.breaking_load is not None:
            yield np.asarray(hoist.falls * eta * hoist.rope.breaking_load / hoist.rope.safety_factor)
        if hoist.line_pull is not None:
            yield np.asarray(hoist.falls * eta * hoist.line_pull)

    def _overturning(self) -> tuple[Array, tuple[Array, Array]]:
        """Moment about the slewing ring of the crane itself [N.m] and of each newton on the hook [m]."""
        up = self.up
        own: Array = np.zeros(())
        for link in self.crane.links:
            x, z = self.plane.point(link.name, link.com[0], link.com[2])
            own = own + GRAVITY * link.mass * (up[1] * x - up[0] * z)
        x, z = self.tip
        plumb = up[1] * x - up[0] * z
        return own, (plumb, plumb + self.lead * (up[0] * x + up[1] * z))

    def _static(self) -> Iterator[Array]:
        """Weights without dynamics [N] at the limits that take none."""
        rating = self.crane.rating
        radius = np.maximum(self.tip[0], 1e-9)
        if rating.load_moment is not None:
            yield rating.load_moment / radius
        if rating.heeling_moment is not None:
            yield rating.heeling_moment / (radius + abs(self.crane.pedestal[1]))


def forces(cylinder: Cylinder) -> tuple[float, float]:
    """The largest push and pull of a cylinder set at its working pressure, the other side empty [N]."""
    bore, annulus = _areas(cylinder)
    return cylinder.efficiency * cylinder.pressure * bore, cylinder.efficiency * cylinder.pressure * annulus


def _areas(cylinder: Cylinder) -> tuple[float, float]:
    quarter = cylinder.count * math.pi / 4
    return quarter * cylinder.bore**2, quarter * (cylinder.bore**2 - cylinder.rod**2)


def _oil_stiffness(crane: Crane, cylinder: Cylinder, length: Array) -> Array:
    """Stiffness of both oil columns of a locked cylinder set [N/m]: beta (A_a / s + A_b / (stroke - s))."""
    bore, annulus = _areas(cylinder)
    margin = _STROKE_MARGIN * cylinder.stroke
    out = np.clip(length - retracted_length(crane, cylinder), margin, cylinder.stroke - margin)
    return crane.bulk_modulus * (bore / out + annulus / (cylinder.stroke - out))


def _reeving(falls: int, sheave: float) -> float:
    """Weight on the hook over (falls times tension at the winch): (1 - eta^n) / (n (1 - eta)), each sheave turning."""
    return sum(sheave**i for i in range(falls)) / falls


def _over(moment: Array, lever: Array) -> Array:
    """Force of a cylinder that holds a moment; infinite, with the moment's sign, where it has no lever."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.divide(moment, lever)


def _between(own: Array, loads: Sequence[Array], low: float, high: float) -> Array:
    """The largest W >= 0 with low <= own + W load <= high for both of `loads`; 0 where `own` alone is outside."""
    first, second = loads
    up, down = (first, first) if first is second else (np.maximum(first, second), np.minimum(first, second))
    with np.errstate(divide="ignore", invalid="ignore"):
        most = np.minimum(np.where(up > 0, (high - own) / up, np.inf), np.where(down < 0, (low - own) / down, np.inf))
    held: Array = np.where((own >= low) & (own <= high), np.maximum(most, 0.0), 0.0)
    return held
