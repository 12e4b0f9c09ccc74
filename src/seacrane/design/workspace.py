"""The workspace: where the tip can be, as a section in the plane of the crane and as the volume it sweeps in slewing.

Whether a point can be reached is answered by inverse kinematics of the last two joints in closed form (two revolute
joints: both elbows; a revolute and a sliding one: both extensions), for each of a row of coordinates of the joints
before them. A point is a cell's centre, so areas are right to the order of a cell and have no bias.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seacrane.design.chart import HARBOUR, Mode, capacity
from seacrane.design.crane import Crane, Joint
from seacrane.design.planar import Array, Plane, evenly, grid, plane_joints
from seacrane.errors import DesignError

_BEFORE = 121
"""Coordinates tried of a joint before the last two, for what can be reached."""

_BEFORE_LOADS = 91
"""The same for loads; with fewer, contours have teeth where a limit of the joint decides what is lifted."""

_MOST_BEFORE = 441
"""The same of several such joints together."""


@dataclass(frozen=True)
class Section:
    """The reachable part of the crane's plane.

    radius (n,), height (m,) [m] of the centres of the cells, from the slewing axis and the foot; reachable (m, n).
    """

    radius: Array
    height: Array
    reachable: NDArray[np.bool_]

    @property
    def cell(self) -> tuple[float, float]:
        """Width and height of a cell [m]."""
        return float(self.radius[1] - self.radius[0]), float(self.height[1] - self.height[0])

    @property
    def area(self) -> float:
        """Area of the section [m2]."""
        width, height = self.cell
        return float(np.count_nonzero(self.reachable)) * width * height

    def volume(self, crane: Crane) -> float:
        """Volume that the section outboard of the slewing axis sweeps in slewing [m3] (Pappus)."""
        width, height = self.cell
        moment = float(np.sum(self.reachable @ np.maximum(self.radius, 0.0))) * width * height
        return moment * slewing_range(crane)


def slewing_range(crane: Crane) -> float:
    """The angle through which the crane slews [rad]: 2 pi if endless, 0 if it does not slew."""
    if crane.slew is None:
        return 0.0
    limits = next(joint.limits for joint in crane.joints if joint.name == crane.slew.joint)
    return 2 * math.pi if limits is None else min(2 * math.pi, limits[1] - limits[0])


def extent(crane: Crane) -> tuple[float, float, float, float]:
    """Least and largest x and z [m] of the tip in the plane of the crane, to about a centimetre."""
    joints = len(plane_joints(crane))
    x, z = Plane(crane, grid(crane, evenly(joints, {1: 2000, 2: 400, 3: 60}, 400_000))).tip()
    return float(x.min()), float(x.max()), float(z.min()), float(z.max())


def section(crane: Crane, cells: int = 600) -> Section:
    """The section on a grid of `cells` by `cells` about the extent of the tip.

    `DesignError` if the crane has fewer than two joints in its plane, or its last two both slide.
    """
    joints = plane_joints(crane)
    if len(joints) < 2 or joints[-2].kind == "prismatic":
        raise DesignError.at(
            "links",
            "the section of a workspace needs two joints in the plane of the crane, the first of the last two turning",
            value=", ".join(f"{joint.name} {joint.kind}" for joint in joints),
        )
    left, right, low, high = extent(crane)
    radius, height = _centres(left, right, cells), _centres(low, high, cells)
    reachable = np.zeros((cells, cells), dtype=bool)
    for _, within in _solutions(crane, joints, radius[None, :], height[:, None], _BEFORE):
        reachable |= within
    return Section(radius, height, reachable)


def loads(crane: Crane, where: Section, mode: Mode = HARBOUR) -> Array:
    """What the best posture lifts at each cell of a section [kg], shape of `where.reachable`; nan out of reach.

    With three joints in the plane or more, of the best of a row of coordinates of the first ones.
    """
    x, z = np.broadcast_arrays(where.radius[None, :], where.height[:, None])
    best = np.full(where.reachable.shape, np.nan)
    for posture, within in _solutions(crane, plane_joints(crane), x, z, _BEFORE_LOADS):
        there = {name: np.broadcast_to(q, within.shape)[within] for name, q in posture.items()}
        if within.any():
            best[within] = np.fmax(best[within], capacity(crane, there, mode).swl)
    return best


def _solutions(
    crane: Crane, joints: tuple[Joint, ...], x: Array, z: Array, tried: int
) -> Iterator[tuple[dict[str, Array], NDArray[np.bool_]]]:
    """All postures for the points, of `tried` coordinates of each joint before the last two, and where they hold."""
    count = evenly(len(joints) - 2, {1: tried}, _MOST_BEFORE) if len(joints) > 2 else 0
    before = [np.linspace(*(joint.limits or (0.0, 0.0)), count) for joint in joints[:-2]]
    for values in itertools.product(*before):
        fixed = {joint.name: np.asarray(q) for joint, q in zip(joints, values, strict=False)}
        for posture, within in _reached(crane, joints, fixed, x, z):
            yield {**fixed, **posture}, within


def postures_at(crane: Crane, radius: float, height: float) -> list[dict[str, float]]:
    """The postures of a crane with two joints in its plane that bring the tip to a point [m]; none, one or two."""
    joints = plane_joints(crane)
    if len(joints) != 2:
        raise DesignError.at(
            "links", "the postures for a point are told only with two joints in the plane", value=len(joints)
        )
    found = []
    for posture, within in _reached(crane, joints, {}, np.asarray(radius), np.asarray(height)):
        if bool(within):
            found.append({name: float(q) for name, q in posture.items()})
    return found


def _centres(low: float, high: float, cells: int) -> Array:
    margin = 0.01 * max(high - low, 1e-3)
    edges = np.linspace(low - margin, high + margin, cells + 1)
    centres: Array = 0.5 * (edges[1:] + edges[:-1])
    return centres


def _reached(
    crane: Crane, joints: tuple[Joint, ...], fixed: dict[str, Array], x: Array, z: Array
) -> Iterator[tuple[dict[str, Array], NDArray[np.bool_]]]:
    """Coordinates of the last two joints that bring the tip to (x, z), one solution at a time, and where they hold.

    Works on the geometry at zero of both: complex numbers x + iz are points of the plane, their angles the joints'.
    """
    first, second = joints[-2:]
    rest = Plane(crane, {**fixed, first.name: np.zeros(()), second.name: np.zeros(())})
    heel, knuckle, tip = (complex(*p) for p in (rest.origin(first.name), rest.origin(second.name), rest.tip()))
    target: Any = (x + 1j * z) - heel
    distance = np.abs(target)
    with np.errstate(invalid="ignore", divide="ignore"):
        if second.kind == "revolute":
            inner, outer = knuckle - heel, tip - knuckle
            cosine = (distance**2 - abs(inner) ** 2 - abs(outer) ** 2) / (2 * abs(inner) * abs(outer))
            elbow = np.arccos(cosine)
            for sign in (1.0, -1.0):
                turned = sign * elbow - np.angle(outer / inner)
                yield _within(first, second, target, inner + outer * np.exp(1j * turned), _wrapped(turned), True)
        else:
            slide = complex(*rest.by_joint(second.name, rest.tip()))
            start = tip - heel
            along = (start * slide.conjugate()).real
            root = np.sqrt(along**2 - abs(start) ** 2 + distance**2)
            for sign in (1.0, -1.0):
                out = sign * root - along
                yield _within(first, second, target, start + out * slide, out, False)


def _within(
    first: Joint, second: Joint, target: Any, shape: Any, inner: Any, revolute: bool
) -> tuple[dict[str, Array], NDArray[np.bool_]]:
    """The coordinate of the first joint that turns `shape` onto `target`, and whether both are within their limits."""
    signs = [-joint.axis[1] / math.hypot(*joint.axis) for joint in (first, second)]
    outer = signs[0] * np.angle(target / shape)
    inner = signs[1] * inner if revolute else inner
    outer = _into(outer, first)
    inner = _into(inner, second) if revolute else inner
    good = np.isfinite(inner) & np.isfinite(outer)
    for joint, q in ((first, outer), (second, inner)):
        low, high = joint.limits or (-math.inf, math.inf)
        good &= (q >= low - 1e-12) & (q <= high + 1e-12)
    return {first.name: outer, second.name: inner}, good


def _wrapped(angle: Any) -> Any:
    return (angle + math.pi) % (2 * math.pi) - math.pi


def _into(angle: Any, joint: Joint) -> Any:
    """The angle plus whole turns, so that it is the first at or above the joint's lower limit."""
    low = joint.limits[0] if joint.limits else -math.pi
    return low - 1e-12 + (angle - low + 1e-12) % (2 * math.pi)
