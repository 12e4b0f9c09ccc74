"""The load chart against free bodies: Newton's equations of each link, and no lever, derivative or share of anything.

The chart works by virtual work. Here every link is cut free; its weight, the rope on its sheaves, its cylinders and the
load act on it at their points, pins and slides bear what they can, and the equations of all links are solved together.
What a limit leaves is the largest load that it still holds, by bisection, with the dynamic factor written out and the
give of rope and oil by the method of the unit load.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass

import msgspec
import numpy as np
import pytest

from seacrane import design
from seacrane.design import Crane, chart
from seacrane.units import deg, kN

G = 9.81
Vector = np.ndarray
Forces = dict[str, list[tuple[Vector, Vector]]]
"""By link: forces (x, z) [N] with the points (x, z) [m] at which they act."""


def turned(x: float, z: float, angle: float) -> Vector:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([c * x - s * z, s * x + c * z])


def moment(force: Vector, at: Vector) -> float:
    return float(at[0] * force[1] - at[1] * force[0])


@dataclass
class Solved:
    """Thrust of each cylinder set [N]; all forces on each link but those of pins, slides and cylinders."""

    thrust: dict[str, float]
    acting: Forces


class FreeBodies:
    """A crane in one posture, cut into its links; everything in its plane, from the foot."""

    def __init__(self, crane: Crane, posture: dict[str, float]) -> None:
        self.crane, self.names = crane, [link.name for link in crane.links]
        self.frames: dict[str, tuple[Vector, float]] = {"foot": (np.zeros(2), 0.0)}
        origin, angle = np.zeros(2), 0.0
        for link in crane.links:
            joint, (x, y, z) = link.joint, link.joint.axis
            origin = origin + turned(joint.origin[0], joint.origin[2], angle)
            if joint.kind == "prismatic":
                origin = origin + posture[joint.name] * turned(x, z, angle) / math.hypot(x, z)
            elif joint.name in posture:
                angle -= posture[joint.name] * math.copysign(1.0, y)
            self.frames[link.name] = origin, angle

    def place(self, link: str, x: float, z: float) -> Vector:
        origin, angle = self.frames[link]
        there: Vector = origin + turned(x, z, angle)
        return there

    def rope(self) -> list[tuple[str, Vector]]:
        path = (self.crane.hoist.drum, *self.crane.hoist.sheaves)
        return [(at.link, self.place(at.link, at.x, at.z)) for at in path]

    def cylinder(self, name: str) -> float:
        """Length between the pins [m]."""
        base, eye = self.pins(name)
        return float(np.linalg.norm(eye - base))

    def pins(self, name: str) -> tuple[Vector, Vector]:
        base, eye = (getattr(self.crane.cylinder(name), end) for end in ("base", "eye"))
        return self.place(base.link, base.x, base.z), self.place(eye.link, eye.x, eye.z)

    def _acting(self, load: float, lead: float, own: bool) -> Forces:
        crane, path = self.crane, self.rope()
        fall = slope(crane)
        down, out = np.array([math.sin(fall), -math.cos(fall)]), np.array([math.cos(fall), math.sin(fall)])
        acting: Forces = {name: [] for name in self.frames}
        for link in crane.links if own else ():
            acting[link.name].append((link.mass * G * down, self.place(link.name, link.com[0], link.com[2])))
        for (one, here), (other, there) in itertools.pairwise(path):
            pull = load / crane.hoist.falls * (there - here) / np.linalg.norm(there - here)
            acting[one].append((pull, here))
            acting[other].append((-pull, there))
        acting[path[-1][0]].append((load * (down + lead * out), path[-1][1]))
        return acting

    def solve(self, load: float, lead: float = 0.0, own: bool = True) -> Solved:
        """With a weight on the hook [N] that leads outboard with this slope, with or without the crane's own weight."""
        acting, cylinders = self._acting(load, lead, own), self.crane.cylinders
        count = 3 * len(self.names)
        matrix, right = np.zeros(2 * [count + len(cylinders)]), np.zeros(count + len(cylinders))

        def push(column: int, force: Vector, at: Vector, on: str, against: str) -> None:
            for link, sign in ((on, 1.0), (against, -1.0)):
                if link != "foot":
                    row = 3 * self.names.index(link)
                    matrix[row : row + 3, column] += sign * np.array([*force, moment(force, at)])

        for i, link in enumerate(self.crane.links):
            before = self.names[i - 1] if i else "foot"
            for k, force in enumerate(np.eye(2)):
                push(3 * i + k, force, self.frames[link.name][0], link.name, before)
            matrix[3 * i + 2, 3 * i + 2] = 1.0  # the couple of a joint
            if i:
                matrix[3 * i - 1, 3 * i + 2] = -1.0
            for force, at in acting[link.name]:
                right[3 * i : 3 * i + 3] -= [*force, moment(force, at)]
        for k, c in enumerate(cylinders):
            row, i = count + k, [link.joint.name for link in self.crane.links].index(c.moves)
            base, eye = self.pins(c.name)
            push(row, (eye - base) / np.linalg.norm(eye - base), eye, c.eye.link, c.base.link)
            joint = self.crane.links[i].joint
            if joint.kind == "revolute":
                matrix[row, 3 * i + 2] = 1.0  # a pin passes on no couple,
            else:
                x, _, z = joint.axis  # and a slide no force along itself
                matrix[row, 3 * i : 3 * i + 2] = turned(x, z, self.frames[self.names[i]][1])
        forces = np.linalg.solve(matrix, right)[count:]
        return Solved(dict(zip((c.name for c in cylinders), forces.tolist(), strict=True)), acting)

    def outboard(self, joint: str, acting: Forces) -> float:
        """Moment about a joint of all forces on what it carries [N.m]."""
        i = [link.joint.name for link in self.crane.links].index(joint)
        about = self.frames[self.names[i]][0]
        return sum(moment(force, at - about) for name in self.names[i:] for force, at in acting[name])


def slope(crane: Crane) -> float:
    """How far the normal of the deck is off the plumb line [rad]: the deck falls by tan(heel) and by tan(trim)."""
    normal = np.array([-math.tan(crane.rating.trim), -math.tan(crane.rating.heel), 1.0])
    return math.acos(normal[2] / np.linalg.norm(normal))


def held(bodies: FreeBodies, limit: str, load: float, lead: float) -> bool:
    """Whether a limit that dynamics use up holds a weight on the hook [N]."""
    crane = bodies.crane
    found = bodies.solve(load, lead)
    if limit in found.thrust:
        c = crane.cylinder(limit)
        each = c.count * c.efficiency * c.pressure * math.pi / 4
        return -each * (c.bore**2 - c.rod**2) <= found.thrust[limit] <= each * c.bore**2
    if limit == "slew moment":
        about_foot = sum(moment(force, at) for forces in found.acting.values() for force, at in forces)
        return abs(about_foot) <= (crane.rating.slew_moment or 0.0)
    if limit == "slew torque":
        fall, tip = slope(crane), bodies.rope()[-1][1][0]
        across = sum(
            link.mass * G * math.sin(fall) * bodies.place(link.name, link.com[0], link.com[2])[0]
            for link in crane.links
        )
        led = [load * (math.sin(fall) + side * lead / 2 * math.cos(fall)) * tip for side in (-1, 1)]
        return all(abs(across + one) <= (crane.rating.slew_torque or 0.0) for one in led)
    if limit in ("rope", "winch"):
        parts = [crane.hoist.sheave_efficiency**i for i in range(crane.hoist.falls)]  # of the winch's tension
        rope, pull = crane.hoist.rope, crane.hoist.line_pull
        bears = pull if limit == "winch" else (rope.breaking_load or 0.0) / rope.safety_factor
        return load / sum(parts) <= (bears or 0.0)
    allowed = {f"structure at {item.joint}": item for item in crane.rating.structure}[limit]
    return abs(bodies.outboard(allowed.joint, found.acting)) <= allowed.moment


def stiffness(bodies: FreeBodies) -> float:
    """Load over give at the hook [N/m], by the unit load: sum of N^2 / k over all that gives."""
    crane, hoist = bodies.crane, bodies.crane.hoist
    thrust = bodies.solve(1.0, own=False).thrust
    give = 0.0
    for c in crane.cylinders:
        straight = {joint.name: 0.0 for joint in moving(crane)}
        travel = next(joint.limits for joint in crane.joints if joint.name == c.moves) or (0.0, 0.0)
        lengths = [FreeBodies(crane, {**straight, c.moves: q}).cylinder(c.name) for q in np.linspace(*travel, 241)]
        closed = 0.5 * (min(lengths) + max(lengths) - c.stroke) if c.retracted is None else c.retracted
        out = float(np.clip(bodies.cylinder(c.name) - closed, 0.01 * c.stroke, 0.99 * c.stroke))
        bore, ring = math.pi / 4 * c.bore**2, math.pi / 4 * (c.bore**2 - c.rod**2)
        oil = c.count * crane.bulk_modulus * (bore / out + ring / (c.stroke - out))
        give += thrust[c.name] ** 2 / oil
    path = bodies.rope()
    for (_, here), (_, there) in itertools.pairwise(path):
        give += (1 / hoist.falls) ** 2 * float(np.linalg.norm(there - here)) / hoist.rope.EA
    give += hoist.falls * (1 / hoist.falls) ** 2 * height_over_sea(bodies) / hoist.rope.EA
    return 1 / give


def height_over_sea(bodies: FreeBodies) -> float:
    return max(float(bodies.rope()[-1][1][1]) + bodies.crane.pedestal[2], 1.0)


def moving(crane: Crane) -> list[design.Joint]:
    return [joint for joint in crane.joints if crane.slew is None or joint.name != crane.slew.joint]


def largest(bodies: FreeBodies, limit: str, wave_height: float) -> float:
    """The largest load [kg] that a limit holds, at rest and with all that a sea state adds."""
    crane, hoist = bodies.crane, bodies.crane.hoist
    hang = height_over_sea(bodies)
    deck, tip = 6 * wave_height / (8 + wave_height), crane.rating.tip_speed_per_height * wave_height
    speed, k = 0.5 * hoist.speed / hoist.falls + math.sqrt(deck**2 + tip**2), stiffness(bodies)
    lead = (2.5 + 1.5 * wave_height) / hang

    def holds(mass: float) -> bool:
        factor = crane.rating.harbour_factor
        if not wave_height:
            return held(bodies, limit, factor * mass * G, 0.0)
        factor = max(factor, 1 + speed / G * math.sqrt(k / mass))
        return all(held(bodies, limit, factor * mass * G, slope) for slope in (0.0, lead))

    low, high = 0.0, 2e7
    if not held(bodies, limit, 0.0, 0.0):
        return 0.0
    while high - low > 2e-6 * high + 0.01:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return max(0.0, low - hoist.hook_mass)


def fitted_out(name: str) -> Crane:
    """A shipped design with every kind of limit, three falls with losses, a hook block, and heel."""
    crane = design.load(name)
    rope = msgspec.structs.replace(crane.hoist.rope, breaking_load=900 * kN, safety_factor=4.0)
    hoist = msgspec.structs.replace(
        crane.hoist, rope=rope, falls=3, sheave_efficiency=0.97, line_pull=200 * kN, hook_mass=700.0
    )
    structure = tuple(design.JointMoment(joint=c.moves, moment=4e6) for c in crane.cylinders if "leg" not in c.name)
    rating = msgspec.structs.replace(
        crane.rating,
        heel=4 * deg,
        trim=1 * deg,
        harbour_factor=1.15,
        tip_speed_per_height=0.35,
        slew_moment=9e6 if crane.slew else None,
        slew_torque=2e6 if crane.slew else None,
        structure=structure,
    )
    return msgspec.structs.replace(crane, hoist=hoist, rating=rating)


@pytest.mark.parametrize("name", design.names())
@pytest.mark.parametrize("wave_height", [0.0, 2.0])
@pytest.mark.parametrize("of", [design.load, fitted_out], ids=["as shipped", "with every limit, falls and heel"])
def test_each_limit_leaves_what_the_free_bodies_hold(name: str, wave_height: float, of: Callable[[str], Crane]) -> None:
    crane = of(name)
    mode = chart.mode(crane, f"hs{wave_height:.1f}" if wave_height else "harbour")
    random, compared = np.random.default_rng(11), 0
    for _ in range(2):
        posture = {joint.name: float(random.uniform(*(joint.limits or (0, 0)))) for joint in moving(crane)}
        bodies = FreeBodies(crane, posture)
        for limit, mass in chart.each_limit(crane, posture, mode).items():
            if mass < 1e7:  # beyond, a limit has next to no lever here
                assert mass == pytest.approx(largest(bodies, limit, wave_height), rel=1e-5, abs=0.5), limit
                compared += mass > 0
    assert compared >= 2
