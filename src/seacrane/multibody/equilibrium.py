"""The static equilibrium of a crane in a posture with its load hanging at rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from seacrane.design import Crane
from seacrane.errors import StructureError
from seacrane.multibody.chain import BaseMotion, frames, inverse_dynamics
from seacrane.multibody.cylinder import attachment_point, lengths
from seacrane.multibody.rope import path_length
from seacrane.units import GRAVITY


@dataclass(frozen=True, eq=False)
class Equilibrium:
    """What holds a crane still.

    posture (n,) [rad, m]; effort (n,) [N.m, N]: what must act along each joint in all; cylinder_forces [N] and drives
    [N.m, N] share it, by cylinder name and, for joints no cylinder moves, by joint name; tension [N]; drum_torque
    [N.m]; unstretched_length [m]; load_position (3,) [m] from the foot in foot axes.
    """

    posture: NDArray[np.float64]
    effort: NDArray[np.float64]
    cylinder_forces: dict[str, float]
    drives: dict[str, float]
    tension: float
    drum_torque: float
    unstretched_length: float
    load_position: NDArray[np.float64]


def driven_joints(crane: Crane) -> list[str]:
    """Names of the joints that no cylinder moves, which a drive of their own turns or pushes."""
    moved = {cylinder.moves for cylinder in crane.cylinders}
    return [link.joint.name for link in crane.links if link.joint.name not in moved]


def static_equilibrium(
    crane: Crane,
    posture: Sequence[float],
    load_mass: float,
    hanging: float,
    gravity: Sequence[float] = (0.0, 0.0, -GRAVITY),
) -> Equilibrium:
    """Forces and lengths that hold `load_mass` [kg] at rest, `hanging` [m] below the tip, in a posture [rad, m].

    gravity: vector [m/s2] in foot axes. `StructureError` if the cylinders have no lever on the joints they move.
    """
    joints = [link.joint.name for link in crane.links]
    q = ca.SX.sym("q", len(joints))
    hook = ca.SX.sym("hook", 3)
    poses = frames(crane.links, q)
    path = [attachment_point(a, poses) for a in (crane.hoist.drum, *crane.hoist.sheaves)]
    length = path_length(path, hook, crane.hoist.falls)
    rest = inverse_dynamics(crane.links, q, ca.DM(len(joints), 1), ca.DM(len(joints), 1), BaseMotion.at_rest(gravity))[
        0
    ]
    arms = ca.jacobian(lengths(crane.cylinders, poses), q)
    evaluate = ca.Function("posture", [q, hook], [path[-1], length, ca.jacobian(length, q), rest, arms])

    g = np.asarray(gravity, dtype=float)
    tip = _array(evaluate(posture, [0, 0, 0])[0])
    load = tip + hanging * g / np.linalg.norm(g)
    _, path_l, rope_arms, own, lever = (_array(value) for value in evaluate(posture, load))
    tension = load_mass * float(np.linalg.norm(g)) / crane.hoist.falls
    effort = own + tension * rope_arms.ravel()

    moved = [joints.index(cylinder.moves) for cylinder in crane.cylinders]
    lever = lever.reshape(len(moved), len(joints))
    try:
        forces = np.linalg.solve(lever[:, moved].T, effort[moved])
    except np.linalg.LinAlgError:
        raise StructureError.at(
            f"{crane.name}.cylinders", "have no lever on the joints they move", value=[float(a) for a in posture]
        ) from None
    left = effort - lever.T @ forces
    strain = tension / crane.hoist.rope.EA
    return Equilibrium(
        posture=np.asarray(posture, dtype=float),
        effort=effort,
        cylinder_forces={c.name: float(f) for c, f in zip(crane.cylinders, forces, strict=True)},
        drives={name: float(left[joints.index(name)]) for name in driven_joints(crane)},
        tension=tension,
        drum_torque=tension * crane.hoist.drum_radius,
        unstretched_length=float(path_l) / (1 + strain),
        load_position=load,
    )


def _array(value: ca.DM) -> NDArray[np.float64]:
    return np.asarray(value.full(), dtype=float).squeeze()
