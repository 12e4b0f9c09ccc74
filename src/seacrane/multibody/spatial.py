"""Spatial (six-dimensional) vector algebra over CasADi matrices.

A spatial motion vector is [angular; linear], a spatial force [moment; force], both taken at the origin of the frame
they are expressed in. Notation after R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008, chapter 2.

Zeros are kept out of the matrices on purpose: with joints along the axes of their links most entries are structurally
zero, and the generated code then contains no arithmetic for them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import casadi as ca


def skew(v: Any) -> Any:
    """The matrix [v x], so that skew(v) @ w = v x w. v: (3,), result: (3, 3)."""
    return ca.sparsify(
        ca.vertcat(ca.horzcat(0, -v[2], v[1]), ca.horzcat(v[2], 0, -v[0]), ca.horzcat(-v[1], v[0], 0)),
    )


def rotation(axis: Sequence[float], angle: Any) -> Any:
    """Rotation (3, 3) about a unit axis by `angle` [rad]: axes of the turned frame in the old one (Rodrigues)."""
    a = ca.DM([float(x) for x in axis])
    along = a @ a.T
    return ca.sparsify(along) + ca.cos(angle) * ca.sparsify(ca.DM.eye(3) - along) + ca.sin(angle) * skew(a)


def motion_transform(orientation: Any, origin: Any) -> Any:
    """Transform (6, 6) of motion vectors from a parent to a child frame; its transpose takes forces back to the parent.

    orientation: (3, 3), the child's axes in the parent; origin: (3,) [m], the child's origin in the parent.
    Featherstone, eq. 2.24.
    """
    e = ca.sparsify(orientation.T)
    return _blocks(e, None, -e @ skew(origin), e)


def motion_cross(v: Any) -> Any:
    """The operator (6, 6) of v x m for motion vectors; minus its transpose acts on forces. Featherstone, eq. 2.31."""
    w = skew(v[:3])
    return _blocks(w, None, skew(v[3:]), w)


def rigid_inertia(mass: float, centre: Sequence[float], inertia: Sequence[float]) -> Any:
    """Spatial inertia (6, 6) about the frame's origin.

    inertia: (3,) [kg.m2], diagonal, about the centre of mass; centre: (3,) [m], of mass in the frame.
    Featherstone, eq. 2.63.
    """
    c = skew(ca.DM([float(x) for x in centre]))
    about_origin = ca.diag(ca.DM([float(i) for i in inertia])) + mass * (c @ c.T)
    return _blocks(about_origin, mass * c, mass * c.T, mass * ca.DM.eye(3))


def _blocks(a: Any, b: Any, c: Any, d: Any) -> Any:
    zero = ca.DM(3, 3)
    rows = [[zero if x is None else x for x in row] for row in ((a, b), (c, d))]
    return ca.sparsify(ca.blockcat(rows))
