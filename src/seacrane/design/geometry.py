"""Kinematics of a design: where its frames, pins and tip are for given joint coordinates.

Pure NumPy on plain data, for validation, load charts and pictures. All results are in the foot frame (at the slewing
ring, x forward, y to port, z up). A posture is a mapping from joint name to coordinate [rad or m]; a joint that is
left out stands at zero.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from seacrane.design.crane import FOOT, Attachment, Crane, Cylinder, Joint

Array = NDArray[np.float64]
Posture = Mapping[str, float]

_SAMPLES = 241
"""Points at which a cylinder's length is taken over the range of its joint, before the extremes are refined."""


@dataclass(frozen=True)
class Frame:
    """Orientation (3, 3) and origin (3,) [m] of a link's frame in the foot frame."""

    rotation: Array
    origin: Array

    def point(self, local: Array | tuple[float, float, float]) -> Array:
        """A point (3,) given in this frame, in foot axes [m]."""
        moved: Array = self.origin + self.rotation @ np.asarray(local, float)
        return moved


def axis_rotation(axis: Array, angle: float) -> Array:
    """The rotation (3, 3) by `angle` [rad] about `axis` (Rodrigues' formula)."""
    x, y, z = axis / np.linalg.norm(axis)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    rotation: Array = np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * (k @ k)
    return rotation


def frames(crane: Crane, posture: Posture) -> dict[str, Frame]:
    """The frame of every link by its name, and of the foot, for a posture."""
    frame = Frame(np.eye(3), np.zeros(3))
    result = {FOOT: frame}
    for link in crane.links:
        frame = _moved(frame, link.joint, posture.get(link.joint.name, 0.0))
        result[link.name] = frame
    return result


def _moved(frame: Frame, joint: Joint, coordinate: float) -> Frame:
    axis, origin = np.array(joint.axis, float), frame.point(joint.origin)
    if joint.kind == "revolute":
        return Frame(frame.rotation @ axis_rotation(axis, coordinate), origin)
    return Frame(frame.rotation, origin + frame.rotation @ (axis / np.linalg.norm(axis) * coordinate))


def position(crane: Crane, attachment: Attachment, posture: Posture) -> Array:
    """An attachment point (3,) in foot axes [m]."""
    return frames(crane, posture)[attachment.link].point((attachment.x, 0.0, attachment.z))


def tip(crane: Crane, posture: Posture) -> Array:
    """The tip sheave, the last of the hoist, (3,) in foot axes [m]."""
    return position(crane, crane.hoist.sheaves[-1], posture)


def radius(crane: Crane, posture: Posture) -> float:
    """The working radius: horizontal distance of the tip from the slewing axis [m]."""
    x, y, _ = tip(crane, posture)
    return math.hypot(x, y)


def cylinder_length(crane: Crane, cylinder: Cylinder, posture: Posture) -> float:
    """Length between the pins of a cylinder [m]."""
    at = frames(crane, posture)
    base, eye = cylinder.base, cylinder.eye
    return float(np.linalg.norm(at[eye.link].point((eye.x, 0, eye.z)) - at[base.link].point((base.x, 0, base.z))))


def cylinder_range(crane: Crane, cylinder: Cylinder) -> tuple[float, float]:
    """Shortest and longest length between the pins of a cylinder [m] over the limits of the joint that it moves.

    The joint must have limits; all others stand at zero. Sampled over the range; the exact length at both ends is
    included, and an inner extreme is off by no more than the curvature of the length over half a sample (below 0.1 mm
    for a real crane).
    """
    lengths = _lengths_over_travel(crane, cylinder)
    return float(lengths.min()), float(lengths.max())


def longest_lever(crane: Crane, cylinder: Cylinder) -> float:
    """The longest lever |d(length)/d(coordinate)| of a cylinder in its joint's travel [m/rad, or 1], to about 0.1 %."""
    low, high = next(joint.limits for joint in crane.joints if joint.name == cylinder.moves) or (0.0, 0.0)
    lengths = _lengths_over_travel(crane, cylinder)
    return float(np.abs(np.gradient(lengths, (high - low) / (_SAMPLES - 1), edge_order=2)).max())


def extends_upward(crane: Crane, cylinder: Cylinder) -> bool | None:
    """Whether the joint of a cylinder goes up as the cylinder comes out; none if it passes a dead point on the way."""
    steps = np.diff(_lengths_over_travel(crane, cylinder))
    if np.all(steps > 0):
        return True
    return False if np.all(steps < 0) else None


def _lengths_over_travel(crane: Crane, cylinder: Cylinder) -> Array:
    """Lengths between the pins [m], evenly over the limits of the joint that the cylinder moves."""
    place, joint = next((i, joint) for i, joint in enumerate(crane.joints) if joint.name == cylinder.moves)
    if joint.limits is None:
        raise ValueError(f"joint {joint.name!r} has no limits")
    origins, carried = _origins_at_zero(crane), {link.name for link in crane.links[place:]}
    base, eye = (origins[pin.link] + (pin.x, 0.0, pin.z) for pin in (cylinder.base, cylinder.eye))
    if (cylinder.base.link in carried) == (cylinder.eye.link in carried):
        return np.full(_SAMPLES, np.linalg.norm(eye - base))
    moved, still = (base, eye) if cylinder.base.link in carried else (eye, base)
    q = np.linspace(*joint.limits, _SAMPLES)[:, None]
    axis = np.array(joint.axis, float) / math.hypot(*joint.axis)
    if joint.kind == "prismatic":
        apart = moved - still + q * axis
    else:
        arm = moved - origins[crane.links[place].name]
        along = axis * (axis @ arm)
        apart = (moved - still - arm + along) + np.cos(q) * (arm - along) + np.sin(q) * _cross(axis, arm)
    lengths: Array = np.sqrt((apart * apart).sum(axis=1))
    return lengths


def _origins_at_zero(crane: Crane) -> dict[str, Array]:
    """The origin of every link (3,) [m] with all joints at zero, when all frames are parallel; and of the foot."""
    origin = np.zeros(3)
    origins = {FOOT: origin}
    for link in crane.links:
        origin = origin + link.joint.origin
        origins[link.name] = origin
    return origins


def _cross(a: Array, b: Array) -> Array:
    """a x b of two vectors (3,), without the preparations of `numpy.cross` for arrays of any shape."""
    return np.array((a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]))


def retracted_length(crane: Crane, cylinder: Cylinder) -> float:
    """Length between the pins with the rod fully in [m]: as given, or so that the travel is centred in the stroke."""
    if cylinder.retracted is not None:
        return cylinder.retracted
    shortest, longest = cylinder_range(crane, cylinder)
    return 0.5 * (shortest + longest - cylinder.stroke)
