"""Where the tip of a crane is and how it moves, as numbers: for control, workspace and checks.

Shapes: q (n,) joint angles [rad] and extensions [m]; everything in foot axes (x forward, y port, z up), from the foot.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from seacrane.design import Crane
from seacrane.multibody.chain import frames
from seacrane.multibody.cylinder import attachment_point, lengths


class Kinematics:
    """Compiled forward kinematics of one crane.

    The Jacobian of a knuckle boom crane loses rank with a straight jib and with the tip over the slew axis:
    |det J| = L2 L3 |sin q3| (L2 cos q2 + L3 cos(q2 + q3)). Damp its inverse there.
    """

    def __init__(self, crane: Crane) -> None:
        q = ca.SX.sym("q", len(crane.links))
        poses = frames(crane.links, q)
        tip = attachment_point(crane.hoist.sheaves[-1], poses)
        cylinder = lengths(crane.cylinders, poses)
        axes = ca.densify(poses[crane.links[-1].name].axes)
        self._tip = ca.Function("tip", [q], [tip])
        self._axes = ca.Function("axes", [q], [axes])
        self._jacobian = ca.Function("jacobian", [q], [ca.densify(ca.jacobian(tip, q))])
        self._cylinders = ca.Function("cylinders", [q], [cylinder, ca.densify(ca.jacobian(cylinder, q))])

    def tip(self, q: Sequence[float]) -> NDArray[np.float64]:
        """Position (3,) [m] of the tip sheave."""
        return _numbers(self._tip(q)).ravel()

    def axes(self, q: Sequence[float]) -> NDArray[np.float64]:
        """Axes (3, 3) of the last link as columns."""
        return _numbers(self._axes(q))

    def jacobian(self, q: Sequence[float]) -> NDArray[np.float64]:
        """Derivative (3, n) of the tip's position by the joints [m/rad or 1]."""
        return _numbers(self._jacobian(q))

    def radius(self, q: Sequence[float]) -> float:
        """Horizontal distance [m] of the tip from the foot's vertical axis, the slew axis."""
        return float(np.hypot(*self.tip(q)[:2]))

    def cylinder_lengths(self, q: Sequence[float]) -> NDArray[np.float64]:
        """Length (m,) [m] of every cylinder between its pins."""
        return _numbers(self._cylinders(q)[0]).ravel()

    def cylinder_arms(self, q: Sequence[float]) -> NDArray[np.float64]:
        """Lever arms (m, n) [m/rad or 1] of the cylinders on the joints: derivative of length by joint."""
        return _numbers(self._cylinders(q)[1])


def _numbers(value: Any) -> NDArray[np.float64]:
    return np.asarray(value.full(), dtype=float)
