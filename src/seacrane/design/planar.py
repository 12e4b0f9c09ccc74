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

import numpy as np
from numpy.typing import NDArray

from seacrane.design.crane import FOOT, Attachment, Crane, Joint, Link
from seacrane.errors import DesignError, Problem

Array = NDArray[np.float64]
Point = tuple[Array, Array]
Postures = Mapping[str, Array]


@dataclass(frozen=True)
class _Frame:
    """A link's frame: origin, and the cosine and sine of its angle from the horizontal."""

    origin: Point
    cosine: Array
    sine: Array

    def point(self, x: float, z: float) -> Point:
        return self.origin[0] + x * self.cosine - z * self.sine, self.origin[1] + x * self.sine + z * self.cosine


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
        _, y, z = (c / math.hypot(*joint.axis) for c in joint.axis)
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


class Plane:
    """The frames of a crane's links for a set of postures, and the derivatives of points by the joints."""

    def __init__(self, crane: Crane, postures: Postures) -> None:
        """`DesignError` if the crane does not move in one plane; every joint of the plane must be in `postures`."""
        if problems := check_plane(crane):
            raise DesignError(problems)
        self.crane = crane
        self._joints: dict[str, tuple[int, Joint, _Frame]] = {}
        """By joint: its place in the chain, itself, and the frame of its link."""
        self._place = {FOOT: -1} | {link.name: i for i, link in enumerate(crane.links)}
        frame = _Frame((np.zeros(()), np.zeros(())), np.ones(()), np.zeros(()))
        self._frames = {FOOT: frame}
        for index, link in enumerate(crane.links):
            frame = self._moved(frame, link, postures)
            self._frames[link.name] = frame
            if link.joint.name in postures:
                self._joints[link.joint.name] = index, link.joint, frame

    def _moved(self, before: _Frame, link: Link, postures: Postures) -> _Frame:
        joint = link.joint
        origin = before.point(joint.origin[0], joint.origin[2])
        if self.crane.slew and joint.name == self.crane.slew.joint:
            return _Frame(origin, before.cosine, before.sine)
        q = np.asarray(postures[joint.name], dtype=float)
        ax, ay, az = (c / math.hypot(*joint.axis) for c in joint.axis)
        if joint.kind == "prismatic":
            dx, dz = ax * before.cosine - az * before.sine, ax * before.sine + az * before.cosine
            return _Frame((origin[0] + q * dx, origin[1] + q * dz), before.cosine, before.sine)
        c, s = np.cos(q), np.sin(q) * -ay
        return _Frame(origin, before.cosine * c - before.sine * s, before.sine * c + before.cosine * s)

    def point(self, link: str, x: float, z: float) -> Point:
        """A point fixed to a link [m]."""
        return self._frames[link].point(x, z)

    def attachment(self, at: Attachment) -> Point:
        """Where a pin or sheave is [m]."""
        return self.point(at.link, at.x, at.z)

    def tip(self) -> Point:
        """The tip sheave [m]."""
        return self.attachment(self.crane.hoist.sheaves[-1])

    def origin(self, joint: str) -> Point:
        """The origin of the link that a joint carries [m]: on the axis of a revolute joint."""
        return self._joints[joint][2].origin

    def carries(self, joint: str, link: str) -> bool:
        """Whether the joint moves the link."""
        return self._joints[joint][0] <= self._place[link]

    def by_joint(self, joint: str, point: Point) -> Point:
        """d(point)/d(coordinate) of a point that the joint carries [m/rad, or 1]."""
        _, what, frame = self._joints[joint]
        ax, ay, az = (c / math.hypot(*what.axis) for c in what.axis)
        if what.kind == "prismatic":
            return ax * frame.cosine - az * frame.sine, ax * frame.sine + az * frame.cosine
        return ay * (point[1] - frame.origin[1]), -ay * (point[0] - frame.origin[0])

    def distance(self, a: Attachment, b: Attachment) -> Array:
        """Distance between two pins [m]."""
        (ax, az), (bx, bz) = self.attachment(a), self.attachment(b)
        return np.hypot(bx - ax, bz - az)

    def distance_by_joint(self, joint: str, a: Attachment, b: Attachment) -> Array:
        """d(distance)/d(coordinate) of two pins [m/rad, or 1]: the lever of a cylinder or rope about the joint."""
        outer, inner = (a, b) if self._place[a.link] >= self._place[b.link] else (b, a)
        if self.carries(joint, inner.link) or not self.carries(joint, outer.link):
            return np.zeros(())
        moving, still = self.attachment(outer), self.attachment(inner)
        dx, dz = self.by_joint(joint, moving)
        ex, ez = moving[0] - still[0], moving[1] - still[1]
        length = np.hypot(ex, ez)
        lever: Array = np.divide(ex * dx + ez * dz, length, out=np.zeros_like(length), where=length > 0)
        return lever

    def own_moment(self, joint: str, up: tuple[float, float]) -> Array:
        """Derivative by a joint of the mass moment of the crane's own parts along `up` [kg.m/rad, or kg].

        Times g it is the generalised force with which the joint must bear the crane itself.
        """
        total: Array = np.zeros(())
        for link in self.crane.links:
            if self.carries(joint, link.name):
                dx, dz = self.by_joint(joint, self.point(link.name, link.com[0], link.com[2]))
                total = total + link.mass * (up[0] * dx + up[1] * dz)
        return total

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
