"""Closed-form kinematics of the knuckle boom crane (slew, luff, jib), for controllers.

With c1 = cos q1, s23 = sin(q2 + q3) and so on, heel height L1 over the foot, boom L2, jib L3:

    tip = [c1 (L2 c2 + L3 c23),  s1 (L2 c2 + L3 c23),  L1 + L2 s2 + L3 s23]

q1 slew about z up, q2 luffing angle (0 horizontal, positive up), q3 jib against the boom (0 straight, negative folded),
all [rad]; everything in foot axes. The Jacobian loses rank where the jib is straight (q3 = 0) and where the tip is over
the slewing axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from seacrane.design import Crane
from seacrane.errors import DesignError

Array = NDArray[np.float64]


@dataclass(frozen=True)
class KnuckleBoom:
    """Lengths of a knuckle boom crane [m]: heel height over the foot, boom, jib."""

    heel: float
    boom: float
    jib: float

    @classmethod
    def of(cls, crane: Crane) -> Self:
        """The lengths of a design; `DesignError` if it is no plain knuckle boom crane."""
        axes = [tuple(float(c) for c in joint.axis) for joint in crane.joints]
        tip = crane.hoist.sheaves[-1]
        plain = (
            all(joint.kind == "revolute" for joint in crane.joints)
            and axes == [(0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (0.0, -1.0, 0.0)]
            and crane.joints[0].origin == (0.0, 0.0, 0.0)
            and crane.joints[1].origin[:2] == (0.0, 0.0)
            and crane.joints[2].origin[1:] == (0.0, 0.0)
            and tip.z == 0.0
        )
        if not plain:
            raise DesignError.at(
                crane.name,
                "has no closed form: it is no knuckle boom crane with its joints and tip in line",
                allowed="slew about z, luff and jib about -y, heel over the foot, knuckle and tip on the links' axes",
            )
        return cls(heel=crane.joints[1].origin[2], boom=crane.joints[2].origin[0], jib=tip.x)

    def tip(self, slew: float, luff: float, jib: float) -> Array:
        """The tip sheave (3,) [m]."""
        reach, height = self._plane(luff, jib)
        return np.array([math.cos(slew) * reach, math.sin(slew) * reach, self.heel + height])

    def rotation(self, slew: float, luff: float, jib: float) -> Array:
        """Axes of the jib (3, 3): along it, up from it in the crane's plane, and to starboard of the plane."""
        c1, s1, c23, s23 = math.cos(slew), math.sin(slew), math.cos(luff + jib), math.sin(luff + jib)
        return np.array([[c1 * c23, -c1 * s23, s1], [s1 * c23, -s1 * s23, -c1], [s23, c23, 0.0]])

    def jacobian(self, slew: float, luff: float, jib: float) -> Array:
        """Velocity of the tip by the joint rates (3, 3) [m/rad]."""
        reach, height = self._plane(luff, jib)
        c1, s1 = math.cos(slew), math.sin(slew)
        along, up = self.jib * math.cos(luff + jib), self.jib * math.sin(luff + jib)
        return np.array(
            [[-s1 * reach, -c1 * height, -c1 * up], [c1 * reach, -s1 * height, -s1 * up], [0, reach, along]]
        )

    def determinant(self, luff: float, jib: float) -> float:
        """|det J| = L2 L3 |s3 (L2 c2 + L3 c23)| [m3/rad3]: zero where the tip cannot move in every direction."""
        return abs(self.boom * self.jib * math.sin(jib) * self._plane(luff, jib)[0])

    def _plane(self, luff: float, jib: float) -> tuple[float, float]:
        """Reach from the slewing axis and height over the heel [m]."""
        return (
            self.boom * math.cos(luff) + self.jib * math.cos(luff + jib),
            self.boom * math.sin(luff) + self.jib * math.sin(luff + jib),
        )
