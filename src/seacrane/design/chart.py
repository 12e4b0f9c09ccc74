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
the sea; what counts is the worst lead. About the slewing axis it leads to the side by half of that (ibid.), on a deck
that falls across the boom. What a limit bears, psi m = C, is solved for m: sqrt(m) = (sqrt(b^2 + 4 C) - b) / 2 with
b = v_r sqrt(k) / g.

These are computed capacities of a design, not a certified load chart.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seacrane.design.crane import Crane, Cylinder
from seacrane.design.geometry import retracted_length
from seacrane.design.planar import Array, Plane, Postures, evenly, grid, plane_joints
from seacrane.errors import DesignError
from seacrane.units import GRAVITY, bar, deg

NOTHING = "nothing"
"""What governs where no limit is given at all."""

_STROKE_MARGIN = 0.01
"""Share of the stroke below which the oil column is not taken shorter: ports and heads hold that much."""

_BLOCK = 8192
"""Postures whose loads are worked out at once: arrays of 64 kB, some dozens of which the second-level cache holds."""

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
    named += ["slew torque"] * (rating.slew_torque is not None)
    named += ["rope"] * (hoist.rope.breaking_load is not None) + ["winch"] * (hoist.line_pull is not None)
    named += ["load moment"] * (rating.load_moment is not None)
    named += ["ship stability"] * (rating.heeling_moment is not None)
    return tuple(named) or (NOTHING,)


def capacity(crane: Crane, postures: Postures, mode: Mode = HARBOUR) -> Capacity:
    """What the crane may lift in each posture of a set (see `planar`), and what governs.

    `DesignError` if the crane does not move in one plane.
    """
    shape = np.broadcast_shapes(*(np.shape(q) for q in postures.values()))
    found = Capacity(np.empty(shape), np.empty(shape), np.empty(shape), np.zeros(shape, np.int8), limits(crane))
    retracted = _retracted(crane)
    for some, rows in _blocks(postures, shape):
        lift = _Lift(crane, some, mode, retracted)
        found.radius[rows], found.height[rows] = lift.tip
        lift.hardest(found.swl[rows], found.governs[rows])
    np.maximum(found.swl - crane.hoist.hook_mass, 0.0, out=found.swl)
    return found


def _retracted(crane: Crane) -> list[float]:
    return [retracted_length(crane, cylinder) for cylinder in crane.cylinders]


def _blocks(postures: Postures, shape: tuple[int, ...]) -> Iterator[tuple[Postures, Any]]:
    """Postures in runs along their first axis, each few enough for the processor's cache, and where in `shape`."""
    if not shape:
        yield postures, ...
        return
    each = max(1, _BLOCK // max(1, math.prod(shape[1:])))
    for start in range(0, shape[0], each):
        rows = slice(start, start + each)
        yield (
            {name: q[rows] if np.ndim(q) == len(shape) and len(q) > 1 else q for name, q in postures.items()},
            rows,
        )


def each_limit(crane: Crane, posture: Mapping[str, float], mode: Mode = HARBOUR) -> dict[str, float]:
    """For one posture: by the name of each limit, what could be lifted if it were the only one [kg]."""
    lift = _Lift(crane, {name: np.asarray(q) for name, q in posture.items()}, mode, _retracted(crane))
    masses = itertools.chain((lift.steady(share) for share in lift.shares()), lift.static())
    loads = [max(0.0, float(mass) - crane.hoist.hook_mass) for mass in masses]
    return dict(zip(limits(crane), loads or [math.inf], strict=True))


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

    Radii are all whole metres and the end of the reach to a decimetre, unless given. The tip of each posture of a grid
    of `count` per joint falls into a band of 0.125 m to both sides of a radius; about the best of them ever finer grids
    are searched. The load is scaled to the radius by the moment, which is exact where a moment governs and changes it
    by less than the band over the radius elsewhere.
    """
    joints = len(plane_joints(crane))
    postures = grid(crane, count or evenly(joints, COUNTS, _MOST_POSTURES))
    found = capacity(crane, postures, mode)
    reach = found.radius.ravel()
    wanted = _whole(reach) if radii is None else np.asarray(radii, float)
    loads = found.swl.ravel()
    order = np.argsort(reach)
    radii, starts = [], []
    for radius in wanted:
        inside = order[slice(*np.searchsorted(reach, (radius - _BAND, radius + _BAND), sorter=order))]
        if inside.size:
            best = inside[np.argmax(loads[inside] * np.minimum(1.0, reach[inside] / radius))]
            radii.append(float(radius))
            starts.append(_posture(postures, np.unravel_index(int(best), found.swl.shape)))
    return _refined(crane, mode, radii, starts, {name: _step(q) for name, q in postures.items()})


def _refined(
    crane: Crane,
    mode: Mode,
    radii: Sequence[float],
    starts: Sequence[Mapping[str, float]],
    steps: dict[str, float],
) -> list[Row]:
    """For each radius the best of the postures about its start, searched with ever finer steps; all radii at once."""
    if not radii:
        return []
    joints = plane_joints(crane)
    about = _about(len(joints))
    wanted = np.asarray(radii)
    best = {joint.name: np.array([start[joint.name] for start in starts]) for joint in joints}
    rows = np.arange(len(radii))
    for scale in _ZOOMS:
        near = {}
        for joint, offset in zip(joints, about, strict=True):
            middle = best[joint.name].reshape(-1, *[1] * offset.ndim)
            near[joint.name] = np.clip(middle + scale * steps[joint.name] * offset, *(joint.limits or (0.0, 0.0)))
        found = capacity(crane, near, mode)
        radius, swl, governs = (a.reshape(len(rows), -1) for a in (found.radius, found.swl, found.governs))
        scaled = swl * np.minimum(1.0, radius / wanted[:, None])
        at = np.argmax(np.where(np.abs(radius - wanted[:, None]) <= _BAND + 1e-9, scaled, -1.0), axis=1)
        shape = found.swl.shape
        best = {name: np.broadcast_to(q, shape).reshape(len(rows), -1)[rows, at] for name, q in near.items()}
    return [
        Row(
            mode.name,
            float(wanted[row]),
            float(scaled[row, k]),
            found.limits[governs[row, k]],
            {name: float(q[row]) for name, q in best.items()},
        )
        for row, k in enumerate(at)
    ]


def _about(joints: int) -> list[Array]:
    """For each joint offsets about a posture, 0 among them: a grid of all joints, or of many one by one."""
    if joints not in _ABOUT:
        return list(np.hstack([np.zeros((joints, 1)), *(share * np.eye(joints) for share in (-1, -0.5, 0.5, 1))]))
    return list(np.meshgrid(*[np.linspace(-1.0, 1.0, _ABOUT[joints])] * joints, indexing="ij", sparse=True))


def _step(coordinates: Array) -> float:
    """Distance between the coordinates of a grid along its joint."""
    row = coordinates.ravel()
    return float(row[1] - row[0]) if len(row) > 1 else 0.0


def to_csv(rows: Sequence[Row]) -> str:
    """Rows as CSV with the columns mode, radius_m, swl_t, governs."""
    lines = [f"{row.mode},{row.radius:.10g},{row.swl / 1e3:.6g},{row.governs}" for row in rows]
    return "\n".join(["mode,radius_m,swl_t,governs", *lines]) + "\n"


COUNTS = {1: 2000, 2: 256, 3: 40, 4: 16}
"""Postures per joint of a curve, by the number of joints in the plane."""

_BAND = 0.125
"""How far from a radius the tip of its posture may be [m]."""

_END = 0.25
"""How far beyond the last whole metre the end of the reach has a row of its own [m]."""

_MOST_POSTURES = 65536
"""Postures of a curve in all, of a crane with more joints."""


_ABOUT = {1: 41, 2: 9, 3: 7, 4: 5}
"""Postures per joint about the best so far, by the number of joints: odd numbers, so that it is one of them."""

_ZOOMS = (1.5, 1.0, 0.6, 0.3, 0.15)
"""How far to both sides, one search after the other, in steps of the grid before."""


def _whole(reach: Array) -> Array:
    """Whole metres within reach, and its end to a decimetre where that is a quarter of a metre further."""
    least, most = max(float(reach.min()), 1.0), float(reach.max())
    whole = np.arange(math.ceil(least), math.floor(most) + 1, dtype=float)
    end = math.floor(10 * most + 1e-6) / 10
    return np.append(whole, end) if len(whole) and end >= whole[-1] + _END else whole


def _posture(postures: Postures, at: tuple[np.intp, ...]) -> dict[str, float]:
    full = np.broadcast_arrays(*postures.values())
    return {name: float(array[at]) for name, array in zip(postures, full, strict=True)}


def hook_speed_needed(crane: Crane, mode: Mode) -> float:
    """The least hook speed [m/s] for lifts in this mode: K sqrt(v_d^2 + v_c^2), K = 0.5 on a single fall, 0.28 on more.

    Source: EN 13852-1:2013, hoisting speed for lifts from a floating vessel.
    """
    return (0.5 if crane.hoist.falls == 1 else 0.28) * _meeting_speed(crane, mode)


def conditions(crane: Crane) -> list[str]:
    """What the chart takes for granted and leaves out, one sentence or two each: the foot notes of a load chart."""
    rating, hoist = crane.rating, crane.hoist
    block = f"the hook block of {hoist.hook_mass / 1e3:.3g} t" if hoist.hook_mass else "the hook (no block is given)"
    falls = "1 fall" if hoist.falls == 1 else f"{hoist.falls} falls with {hoist.sheave_efficiency:g} per sheave"
    absent = [
        what
        for what, given in (
            ("the slewing ring", rating.slew_moment or not crane.slew),
            ("the slewing gear", rating.slew_torque or not crane.slew),
            ("the structure", rating.structure),
            ("the rope", hoist.rope.breaking_load),
            ("the winch", hoist.line_pull),
            ("the load moment", rating.load_moment),
            ("the ship's stability", rating.heeling_moment),
        )
        if not given
    ]
    bears = [f"{c.count} x {c.name} at {c.pressure / bar:.0f} bar" for c in crane.cylinders]
    notes = [
        f"Loads hang below {block}, on {falls}; the rope's own weight is not taken off. Radii are from the slewing "
        "axis to the tip; each load is that of the best posture.",
        f"Cylinders push and pull with their working pressure on piston or annulus, the other side empty: "
        f"{', '.join(bears) or 'none'}. The crane's own weight is borne first.",
        f"Harbour: dynamic factor {rating.harbour_factor:g}, which is the least at sea too.",
    ]
    if rating.wave_heights:
        notes.append(
            "At sea: dynamic factor 1 + v_r/g sqrt(k/m) with v_r = v_L/2 + sqrt(v_d^2 + v_c^2) (EN 13852-1:2013), "
            f"hook v_L {hoist.speed / hoist.falls:.3g} m/s, deck v_d = 6 Hs/(Hs + 8), tip v_c = "
            f"{rating.tip_speed_per_height:g} Hs, k of rope and oil; offlead 2.5 m + 1.5 Hs at the sea's surface."
        )
    for at_sea in modes(crane)[1:]:
        need, have = hook_speed_needed(crane, at_sea), hoist.speed / hoist.falls
        if have < need:
            notes.append(f"{at_sea.name}: the hook at {have:.2f} m/s is slower than the {need:.2f} m/s of EN 13852-1")
    notes.append(
        f"Heel {rating.heel / deg:.3g} deg and trim {rating.trim / deg:.3g} deg, slewed to where the deck falls "
        "outboard; for the slewing gear to where it falls across the boom, with a sidelead of half the offlead."
    )
    if absent:
        notes.append(f"No limit is given for {', '.join(absent)}: none is checked.")
    notes.append("Left out: wind, side loads of the structure, buckling of rods, fatigue, layers on the drum.")
    return notes


def _meeting_speed(crane: Crane, mode: Mode) -> float:
    deck = 6 * mode.wave_height / (mode.wave_height + 8)
    return math.hypot(deck, crane.rating.tip_speed_per_height * mode.wave_height)


class _Lift:
    """The lift of a load in a set of postures, limit by limit.

    What a limit leaves is worked out as its inverse, the share of it that each newton on the hook takes: the limit that
    governs is the one of the largest share, and one that the crane itself exceeds is taken whole, a share without end.
    """

    def __init__(self, crane: Crane, postures: Postures, mode: Mode, retracted: Sequence[float]) -> None:
        """`retracted`: of the cylinders in their order, the same for all postures [m]."""
        self.crane, self.mode, self.retracted = crane, mode, retracted
        self.plane = Plane(crane, postures)
        self.tip = self.plane.tip()
        tilt = crane.rating.tilt
        self.up = -math.sin(tilt), math.cos(tilt)
        self.hang = np.maximum(self.tip[1] + crane.pedestal[2], _LEAST_HANG)
        self.lead = (2.5 + 1.5 * mode.wave_height) / self.hang
        joints = {cylinder.moves for cylinder in crane.cylinders} | {item.joint for item in crane.rating.structure}
        self.own = {joint: GRAVITY * self.plane.own_moment(joint, self.up) for joint in joints}
        self.loads = {joint: self._load_levers(joint) for joint in joints}
        self.levers = {c.name: self.plane.distance_by_joint(c.moves, c.base, c.eye) for c in crane.cylinders}

    def hardest(self, mass: Array, governs: NDArray[np.int8]) -> None:
        """Fill in what all limits together leave for hook and load [kg], and which limit leaves the least."""
        taken, count = np.zeros(mass.shape), 0
        for share in self.shares():
            # The index grows from limit to limit: the largest is that of the last which was worse than all before.
            np.maximum(governs, (share > taken).view(np.int8) * np.int8(count), out=governs)
            np.maximum(taken, share, out=taken)
            count += 1
        mass[...] = self.steady(taken)
        for most in self.static():
            np.maximum(governs, (most < mass).view(np.int8) * np.int8(count), out=governs)
            np.minimum(mass, most, out=mass)
            count += 1

    def steady(self, share: Array) -> Array:
        """The mass whose weight with dynamics uses up a limit of which each newton takes this share [1/N] [kg]."""
        with np.errstate(divide="ignore"):
            borne = 1.0 / (GRAVITY * share)
        steady: Array = borne / self.crane.rating.harbour_factor
        if self.mode.at_sea:
            b = self._impact
            with np.errstate(invalid="ignore"):  # where nothing is a limit, nothing is subtracted from without end
                root = 0.5 * (np.sqrt(b * b + 4.0 * borne) - b)
            steady = np.fmin(steady, root * root)
        return steady

    @cached_property
    def _impact(self) -> Array:
        """b = v_r sqrt(k) / g [sqrt(kg)]."""
        hoist = self.crane.hoist
        speed = 0.5 * hoist.speed / hoist.falls + _meeting_speed(self.crane, self.mode)
        impact: Array = speed / GRAVITY / np.sqrt(self._compliance())
        return impact

    def _compliance(self) -> Array:
        """Vertical give at the hook [m/N]: rope and oil columns in series; the structure is taken as rigid."""
        hoist = self.crane.hoist
        total = (self.plane.rope_length() / hoist.falls**2 + self.hang / hoist.falls) / hoist.rope.EA
        for cylinder, retracted in zip(self.crane.cylinders, self.retracted, strict=True):
            lever, (plumb, _) = self.levers[cylinder.name], self.loads[cylinder.moves]
            oil = _oil_stiffness(self.crane, cylinder, self.plane.distance(cylinder.base, cylinder.eye) - retracted)
            give = np.divide(1.0, oil * lever * lever, out=np.zeros_like(lever), where=lever != 0)
            total = total + plumb * plumb * give
        return total

    def _load_levers(self, joint: str) -> tuple[Array, Array]:
        """d(height of the hook along the load's line)/d(coordinate), rope and all: hanging plumb, and led outboard."""
        dx, dz = self.plane.by_joint(joint, self.tip)
        plumb = self.up[0] * dx + self.up[1] * dz + self.plane.rope_by_joint(joint) / self.crane.hoist.falls
        return plumb, plumb - self.lead * (self.up[1] * dx - self.up[0] * dz) if self.mode.at_sea else plumb

    def shares(self) -> Iterator[Array]:
        """What each newton on the hook takes of each limit that dynamics use up, in the order of `limits` [1/N]."""
        crane, rating, hoist = self.crane, self.crane.rating, self.crane.hoist
        for cylinder in crane.cylinders:
            lever = self.levers[cylinder.name]
            push, pull = (force * lever for force in forces(cylinder))
            yield _share(
                self.own[cylinder.moves], self.loads[cylinder.moves], np.minimum(push, -pull), np.maximum(push, -pull)
            )
        for item in rating.structure:
            yield _share(self.own[item.joint], self.loads[item.joint], -item.moment, item.moment)
        if rating.slew_moment is not None:
            yield _share(*self._overturning(), -rating.slew_moment, rating.slew_moment)
        if rating.slew_torque is not None:
            yield _share(*self._turning(), -rating.slew_torque, rating.slew_torque)
        carried = hoist.falls * _reeving(hoist.falls, hoist.sheave_efficiency)
        if hoist.rope.breaking_load is not None:
            yield np.asarray(hoist.rope.safety_factor / (carried * hoist.rope.breaking_load))
        if hoist.line_pull is not None:
            yield np.asarray(1.0 / (carried * hoist.line_pull))

    def _overturning(self) -> tuple[Array, tuple[Array, Array]]:
        """Moment about the slewing ring of the crane itself [N.m] and of each newton on the hook [m]."""
        up, (x, z) = self.up, self.plane.mass_moment()
        own = GRAVITY * (up[1] * x - up[0] * z)
        x, z = self.tip
        plumb = up[1] * x - up[0] * z
        return own, (plumb, plumb + self.lead * (up[0] * x + up[1] * z) if self.mode.at_sea else plumb)

    def _turning(self) -> tuple[Array, tuple[Array, Array]]:
        """Torque about the slewing axis of the crane itself [N.m] and of each newton on the hook [m].

        The deck falls across the boom; the load leads to either side by half of what it leads outboard.
        """
        sine, cosine = -self.up[0], self.up[1]
        own, tip = GRAVITY * sine * self.plane.mass_moment()[0], self.tip[0]
        side = 0.5 * self.lead * cosine if self.mode.at_sea else 0.0
        return own, (tip * (sine + side), tip * (sine - side))

    def static(self) -> Iterator[Array]:
        """What each limit leaves that takes no dynamics, in the order of `limits` [kg]."""
        rating = self.crane.rating
        radius = np.maximum(self.tip[0], 1e-9)
        if rating.load_moment is not None:
            yield rating.load_moment / GRAVITY / radius
        if rating.heeling_moment is not None:
            yield rating.heeling_moment / GRAVITY / (radius + abs(self.crane.pedestal[1]))


def forces(cylinder: Cylinder) -> tuple[float, float]:
    """The largest push and pull of a cylinder set at its working pressure, the other side empty [N]."""
    bore, annulus = _areas(cylinder)
    return cylinder.efficiency * cylinder.pressure * bore, cylinder.efficiency * cylinder.pressure * annulus


def _areas(cylinder: Cylinder) -> tuple[float, float]:
    quarter = cylinder.count * math.pi / 4
    return quarter * cylinder.bore**2, quarter * (cylinder.bore**2 - cylinder.rod**2)


def _oil_stiffness(crane: Crane, cylinder: Cylinder, extension: Array) -> Array:
    """Stiffness of both oil columns of a locked cylinder set [N/m]: beta (A_a / s + A_b / (stroke - s))."""
    bore, annulus = _areas(cylinder)
    margin = _STROKE_MARGIN * cylinder.stroke
    out = np.clip(extension, margin, cylinder.stroke - margin)
    return crane.bulk_modulus * (bore / out + annulus / (cylinder.stroke - out))


def _reeving(falls: int, sheave: float) -> float:
    """Weight on the hook over (falls times tension at the winch): (1 - eta^n) / (n (1 - eta)), each sheave turning."""
    return sum(sheave**i for i in range(falls)) / falls


def _share(own: Array, loads: tuple[Array, Array], low: Array | float, high: Array | float) -> Array:
    """1/W of the largest W for which low < own + W load < high holds for both of `loads`; no end if for none.

    Of the room to the two ends a load takes a positive share of the one that it tends to, a negative of the other.
    """
    first, second = loads
    up, down = (first, first) if first is second else (np.maximum(first, second), np.minimum(first, second))
    above, below = high - own, low - own
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.asarray(np.maximum(up / above, down / below))
    share[(above <= 0) | (below >= 0)] = np.inf
    return share + 0.0  # -0 would be the inverse of a load without end downwards
