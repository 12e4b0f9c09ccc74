"""A crane in its own plane: where everything is, and how it moves with each joint, for arrays of postures at once.

Without its slewing joint a crane moves in one plane: x outboard from the slewing axis, z up, both from the foot. A
posture set gives an array of coordinates [rad or m] for each joint of the plane; arrays broadcast against each other,
so `{"luff": q[:, None], "jib": r[None, :]}` is a grid of postures, and what depends on the luffing only stays a
column. Points and their derivatives are pairs `(x, z)` of such arrays.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from seacrane.design.crane import FOOT, Attachment, Crane, Joint
from seacrane.errors import DesignError, Problem

Array = NDArray[np.float64]
Point = tuple[Array, Array]
Postures = Mapping[str, Array]


@dataclass(frozen=True)
class _Frame:
    """A link's frame as another sees it: origin, and the cosine and sine of the angle between them."""

    origin: Point
    cosine: Array
    sine: Array

    def point(self, x: Array | float, z: Array | float) -> Point:
        return self.origin[0] + x * self.cosine - z * self.sine, self.origin[1] + x * self.sine + z * self.cosine

    def then(self, outer: _Frame) -> _Frame:
        """The frame that this one sees as `outer`."""
        return _Frame(
            self.point(*outer.origin),
            self.cosine * outer.cosine - self.sine * outer.sine,
            self.sine * outer.cosine + self.cosine * outer.sine,
        )


_ONE, _ZERO = np.ones(()), np.zeros(())
_SELF = _Frame((_ZERO, _ZERO), _ONE, _ZERO)


def plane_joints(crane: Crane) -> tuple[Joint, ...]:
    """The joints that move the crane in its plane, from the foot to the tip: all but slewing."""
    slew = crane.slew.joint if crane.slew else None
    return tuple(joint for joint in crane.joints if joint.name != slew)


def check_plane(crane: Crane) -> list[Problem]:
    """Why the crane does not move in one plane; empty if it does."""
    problems = []
    slew = crane.slew.joint if crane.slew else None
    for index, link in enumerate(crane.links):
        joint, path = link.joint, f"links[{link.name}].joint"
        _, y, z = _direction(joint)
        if joint.name == slew:
            if index or joint.kind != "revolute" or abs(z) < 1 - 1e-9:
                problems.append(
                    Problem(path, "the slewing joint must be the first, turning about the vertical", value=joint.axis)
                )
        elif joint.kind == "revolute" and abs(y) < 1 - 1e-9:
            problems.append(
                Problem(
                    f"{path}.axis", "turns out of the plane of the crane", joint.axis, "(0, -1, 0): raising positive"
                )
            )
        elif joint.kind == "prismatic" and abs(y) > 1e-9:
            problems.append(Problem(f"{path}.axis", "slides out of the plane of the crane", joint.axis, "y = 0"))
        if joint.name != slew and joint.limits is None:
            problems.append(Problem(f"{path}.limits", "are needed: only slewing may be endless", joint.name))
    return problems


def grid(crane: Crane, count: int | Sequence[int]) -> dict[str, Array]:
    """Postures that fill the joints' limits evenly: `count` for each joint of the plane, or one number for all."""
    joints = plane_joints(crane)
    counts = [count] * len(joints) if isinstance(count, int) else list(count)
    postures = {}
    for place, (joint, number) in enumerate(zip(joints, counts, strict=True)):
        shape = [1] * len(joints)
        shape[place] = number
        low, high = joint.limits or (0.0, 0.0)
        postures[joint.name] = np.linspace(low, high, number).reshape(shape)
    return postures


def evenly(joints: int, usual: Mapping[int, int], most: int) -> int:
    """How many coordinates to take of each of so many joints: the usual number, or so many that all are `most`."""
    return usual.get(joints) or max(2, int(most ** (1 / joints)))


class Plane:
    """The frames of a crane's links for a set of postures, and the derivatives of points by the joints.

    What lies between two links is worked out as the inner one sees the outer one, so that its arrays have no more
    dimensions than there are joints between them.
    """

    def __init__(self, crane: Crane, postures: Postures) -> None:
        """`DesignError` if the crane does not move in one plane, or a joint of the plane is not in `postures`."""
        if problems := check_plane(crane):
            raise DesignError(problems)
        names = [joint.name for joint in plane_joints(crane)]
        if missing := [name for name in names if name not in postures]:
            raise DesignError.at("posture", "lacks a joint", value=", ".join(missing), allowed=", ".join(names))
        self.crane = crane
        self._place = {FOOT: -1} | {link.name: i for i, link in enumerate(crane.links)}
        self._joints = {link.joint.name: (i, link.joint) for i, link in enumerate(crane.links)}
        self._steps = [self._step(link.joint, postures) for link in crane.links]
        self._seen: dict[tuple[int, int], _Frame] = {}

    def _step(self, joint: Joint, postures: Postures) -> _Frame:
        """The frame of a joint's link as the link before sees it."""
        x, _, z = joint.origin
        if self.crane.slew and joint.name == self.crane.slew.joint:
            return _Frame((np.asarray(x), np.asarray(z)), _ONE, _ZERO)
        q = np.asarray(postures[joint.name], dtype=float)
        ax, ay, az = _direction(joint)
        if joint.kind == "prismatic":
            return _Frame((x + q * ax, z + q * az), _ONE, _ZERO)
        return _Frame((np.asarray(x), np.asarray(z)), np.cos(q), np.sin(q) * -ay)

    def _frame(self, place: int, seen_from: int = -1) -> _Frame:
        """The frame of a link as a link before it sees it, both by their place in the chain; the foot's is -1."""
        if place == seen_from:
            return _SELF
        key = place, seen_from
        if key not in self._seen:
            self._seen[key] = self._frame(place - 1, seen_from).then(self._steps[place])
        return self._seen[key]

    def point(self, link: str, x: float, z: float) -> Point:
        """A point fixed to a link [m]."""
        return self._frame(self._place[link]).point(x, z)

    def attachment(self, at: Attachment) -> Point:
        """Where a pin or sheave is [m]."""
        return self.point(at.link, at.x, at.z)

    def tip(self) -> Point:
        """The tip sheave [m]."""
        return self.attachment(self.crane.hoist.sheaves[-1])

    def origin(self, joint: str) -> Point:
        """The origin of the link that a joint carries [m]: on the axis of a revolute joint."""
        return self._frame(self._joints[joint][0]).origin

    def by_joint(self, joint: str, point: Point) -> Point:
        """d(point)/d(coordinate) of a point that the joint carries [m/rad, or 1]."""
        return self._by_joint(joint, point, -1)

    def _by_joint(self, joint: str, point: Point, seen_from: int) -> Point:
        place, what = self._joints[joint]
        ax, ay, az = _direction(what)
        frame = self._frame(place, seen_from)
        if what.kind == "prismatic":
            return ax * frame.cosine - az * frame.sine, ax * frame.sine + az * frame.cosine
        return ay * (point[1] - frame.origin[1]), -ay * (point[0] - frame.origin[0])

    def distance(self, a: Attachment, b: Attachment) -> Array:
        """Distance between two pins [m]."""
        (x, z), _ = self._apart(a, b)
        length: Array = np.sqrt(x * x + z * z)
        return length

    def distance_by_joint(self, joint: str, a: Attachment, b: Attachment) -> Array:
        """d(distance)/d(coordinate) of two pins [m/rad, or 1]: the lever of a cylinder or rope about the joint."""
        inner, outer = sorted((a, b), key=lambda pin: self._place[pin.link])
        base = self._place[inner.link]
        if not base < self._joints[joint][0] <= self._place[outer.link]:
            return _ZERO
        (x, z), moving = self._apart(a, b)
        dx, dz = self._by_joint(joint, moving, base)
        length = np.sqrt(x * x + z * z)
        lever: Array = np.divide(x * dx + z * dz, length, out=np.zeros_like(length), where=length > 0)
        return lever

    def _apart(self, a: Attachment, b: Attachment) -> tuple[Point, Point]:
        """From the inner to the outer of two pins, and where the outer is, as the link of the inner sees them [m]."""
        inner, outer = sorted((a, b), key=lambda pin: self._place[pin.link])
        x, z = self._frame(self._place[outer.link], self._place[inner.link]).point(outer.x, outer.z)
        return (x - inner.x, z - inner.z), (x, z)

    @cached_property
    def _carried(self) -> list[tuple[float, Array, Array]]:
        """By place in the chain: the mass of a link with all it carries [kg], and its moments about the foot [kg.m]."""
        mass, moment_x, moment_z = 0.0, _ZERO, _ZERO
        sums = []
        for link in reversed(self.crane.links):
            x, z = self.point(link.name, link.com[0], link.com[2])
            mass, moment_x, moment_z = mass + link.mass, moment_x + link.mass * x, moment_z + link.mass * z
            sums.append((mass, moment_x, moment_z))
        return sums[::-1]

    def mass_moment(self) -> Point:
        """Mass times position of the whole crane, from the foot [kg.m]."""
        return self._carried[0][1:]

    def own_moment(self, joint: str, up: tuple[float, float]) -> Array:
        """Derivative by a joint of the mass moment of the crane's own parts along `up` [kg.m/rad, or kg].

        Times g it is the generalised force with which the joint must bear the crane itself.
        """
        mass, x, z = self._carried[self._joints[joint][0]]
        dx, dz = self.by_joint(joint, (x / mass, z / mass))
        return mass * (up[0] * dx + up[1] * dz)

    def rope_length(self) -> Array:
        """Length of the rope from the drum over the sheaves to the tip [m], along the pins (the wraps left out)."""
        path = (self.crane.hoist.drum, *self.crane.hoist.sheaves)
        total: Array = np.zeros(())
        for a, b in itertools.pairwise(path):
            total = total + self.distance(a, b)
        return total

    def rope_by_joint(self, joint: str) -> Array:
        """d(rope length)/d(coordinate) [m/rad, or 1]: how much rope a joint pulls in over the sheaves."""
        path = (self.crane.hoist.drum, *self.crane.hoist.sheaves)
        total: Array = np.zeros(())
        for a, b in itertools.pairwise(path):
            total = total + self.distance_by_joint(joint, a, b)
        return total


def _direction(joint: Joint) -> tuple[float, float, float]:
    """The unit vector of a joint's axis."""
    x, y, z = joint.axis
    size = math.hypot(x, y, z)
    return x / size, y / size, z / size
