"""Hydraulic cylinders between attachment points of a chain.

A cylinder's length l(q) is the distance of its two pins. Its lever arm is dl/dq, its speed dl/dq qdot, and a force F
along it acts on the joints as F dl/dq (virtual work), so no closed loop has to be solved.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca

from seacrane.design import Attachment, Cylinder
from seacrane.multibody.chain import Frame

_TINY = 1e-6
"""Distance [m] below which a length is rounded off, so that its gradient stays finite where two points meet."""


def attachment_point(attachment: Attachment, poses: Mapping[str, Frame]) -> Any:
    """Position (3,) [m] in foot axes of an attachment in the plane of the crane."""
    return poses[attachment.link].point((attachment.x, 0.0, attachment.z))


def distance(a: Any, b: Any) -> Any:
    """Distance [m] of two points, differentiable everywhere."""
    d = b - a
    return ca.sqrt(ca.dot(d, d) + _TINY**2)


def lengths(cylinders: Sequence[Cylinder], poses: Mapping[str, Frame]) -> Any:
    """Lengths (m,) [m] between the pins of every cylinder."""
    return ca.vertcat(
        *(distance(attachment_point(c.base, poses), attachment_point(c.eye, poses)) for c in cylinders),
    )
