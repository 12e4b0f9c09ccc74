"""Recursive dynamics of a serial chain of links on a moving base.

The chain is data: a sequence of `seacrane.design.Link`, each with its joint to the link before it (revolute or
prismatic, any axis), so one formulation serves an A-frame (RP), a knuckle boom crane (RRR), a telescopic crane (RRP),
a dual drag link crane (RRRR) and any other. The base frame is the crane's foot, fixed to the ship. The ship enters
through the motion of that frame alone, in its own axes, so its attitude need not be known.

Work per call grows linearly with the number of links. Source: R. Featherstone, Rigid Body Dynamics Algorithms, Springer
2008, tables 5.1 (recursive Newton-Euler) and 7.1 (articulated body); rotor inertia in the hinge term as in section 9.6.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from seacrane.design import FOOT, Link
from seacrane.multibody.spatial import motion_cross, motion_transform, rigid_inertia, rotation
from seacrane.units import GRAVITY


@dataclass(frozen=True)
class Frame:
    """Pose of a link in foot axes: `axes` (3, 3), its columns the link's axes, and `origin` (3,) [m]."""

    axes: Any
    origin: Any

    def point(self, position: Sequence[float]) -> Any:
        """Position in foot axes (3,) [m] of a point given in the link's frame."""
        return self.origin + self.axes @ ca.DM([float(x) for x in position])


@dataclass(frozen=True)
class BaseMotion:
    """Motion of the foot in its own axes.

    angular_velocity (3,) [rad/s]; angular_acceleration (3,) [rad/s2]; proper_acceleration (3,) [m/s2]: acceleration of
    the foot's origin less gravity, what an accelerometer there would show.
    """

    angular_velocity: Any
    angular_acceleration: Any
    proper_acceleration: Any

    @classmethod
    def at_rest(cls, gravity: Any = (0.0, 0.0, -GRAVITY)) -> BaseMotion:
        """A foot that does not move, with the gravity vector [m/s2] in its axes."""
        return cls(ca.DM(3, 1), ca.DM(3, 1), ca.sparsify(-ca.DM([float(g) for g in gravity])))

    @property
    def velocity(self) -> Any:
        """Spatial velocity without its linear part, which no acceleration depends on."""
        return ca.vertcat(self.angular_velocity, ca.DM(3, 1))

    @property
    def acceleration(self) -> Any:
        return ca.vertcat(self.angular_acceleration, self.proper_acceleration)


def frames(links: Sequence[Link], q: Any) -> dict[str, Frame]:
    """Pose of every link by name, and of the foot, in foot axes; q: (n,) joint angles [rad] and extensions [m]."""
    axes, origin = ca.DM.eye(3), ca.DM(3, 1)
    poses = {FOOT: Frame(axes, origin)}
    for i, link in enumerate(links):
        turn, step = _joint_pose(link, q[i])
        origin = origin + axes @ step
        axes = ca.sparsify(axes @ turn)
        poses[link.name] = Frame(axes, origin)
    return poses


def forward_dynamics(
    links: Sequence[Link], q: Any, qd: Any, effort: Any, base: BaseMotion, rotor_inertia: Any | None = None
) -> tuple[Any, Any]:
    """Joint accelerations (n,) and the wrench (6,) [moment; force] the foot exerts on the chain, by articulated bodies.

    effort: (n,) [N.m or N], everything that acts along the joints: drives, cylinders, ropes, friction. rotor_inertia:
    (n,) [kg.m2 or kg], inertia of the drive's rotor reflected to its joint; it turns relative to the link before, and
    its own gyroscopic moment, smaller by the gear ratio, is left out.
    """
    n = len(links)
    transforms, velocities, biases = _outward(links, q, qd, base)
    articulated = [ca.SX(_inertia(link)) for link in links]
    force = [-(motion_cross(v).T) @ (m @ v) for v, m in zip(velocities, articulated, strict=True)]
    axis = [_axis(link) for link in links]
    u: list[Any] = [None] * n
    d: list[Any] = [None] * n
    rest: list[Any] = [None] * n
    for i in reversed(range(n)):
        u[i] = articulated[i] @ axis[i]
        d[i] = ca.dot(axis[i], u[i]) + (0 if rotor_inertia is None else rotor_inertia[i])
        rest[i] = effort[i] - ca.dot(axis[i], force[i])
        if i > 0:
            carried = articulated[i] - u[i] @ (u[i].T / d[i])
            carried_force = force[i] + carried @ biases[i] + u[i] * (rest[i] / d[i])
            articulated[i - 1] = articulated[i - 1] + transforms[i].T @ carried @ transforms[i]
            force[i - 1] = force[i - 1] + transforms[i].T @ carried_force
    acceleration, qdd, wrench = base.acceleration, [], None
    for i in range(n):
        acceleration = transforms[i] @ acceleration + biases[i]
        qdd.append((rest[i] - ca.dot(u[i], acceleration)) / d[i])
        acceleration = acceleration + axis[i] * qdd[i]
        if i == 0:
            wrench = transforms[0].T @ (articulated[0] @ acceleration + force[0])
    return ca.vertcat(*qdd), wrench


def inverse_dynamics(links: Sequence[Link], q: Any, qd: Any, qdd: Any, base: BaseMotion) -> tuple[Any, Any]:
    """Joint efforts (n,) that give these joint accelerations, and the wrench (6,) the foot exerts, by Newton-Euler."""
    transforms, velocities, biases = _outward(links, q, qd, base)
    acceleration, force = base.acceleration, []
    for i, link in enumerate(links):
        acceleration = transforms[i] @ acceleration + biases[i] + _axis(link) * qdd[i]
        momentum = _inertia(link) @ velocities[i]
        force.append(_inertia(link) @ acceleration - motion_cross(velocities[i]).T @ momentum)
    effort = []
    for i in reversed(range(len(links))):
        effort.append(ca.dot(_axis(links[i]), force[i]))
        if i > 0:
            force[i - 1] = force[i - 1] + transforms[i].T @ force[i]
    return ca.vertcat(*reversed(effort)), transforms[0].T @ force[0]


def kinetic_energy(links: Sequence[Link], q: Any, qd: Any, base_velocity: Any) -> Any:
    """Kinetic energy [J] in the inertial frame; base_velocity: (6,) [angular; linear] of the foot, in its axes."""
    velocity, energy = base_velocity, 0
    for i, link in enumerate(links):
        velocity = motion_transform(*_joint_pose(link, q[i])) @ velocity + _axis(link) * qd[i]
        energy = energy + ca.dot(velocity, _inertia(link) @ velocity) / 2
    return energy


def mass_moment(links: Sequence[Link], q: Any) -> Any:
    """Sum of mass times position of the centre of mass (3,) [kg.m], in foot axes from the foot."""
    poses = frames(links, q)
    return sum((link.mass * poses[link.name].point(link.com) for link in links), ca.DM(3, 1))


def _outward(links: Sequence[Link], q: Any, qd: Any, base: BaseMotion) -> tuple[list[Any], list[Any], list[Any]]:
    """Transforms, spatial velocities and velocity-product accelerations, from the foot to the last link."""
    velocity = base.velocity
    transforms, velocities, biases = [], [], []
    for i, link in enumerate(links):
        transform, own = motion_transform(*_joint_pose(link, q[i])), _axis(link) * qd[i]
        velocity = transform @ velocity + own
        transforms.append(transform)
        velocities.append(velocity)
        biases.append(motion_cross(velocity) @ own)
    return transforms, velocities, biases


def _joint_pose(link: Link, q: Any) -> tuple[Any, Any]:
    """Axes (3, 3) and origin (3,) of a link in the frame of the link before it."""
    joint = link.joint
    origin = ca.sparsify(ca.DM([float(x) for x in joint.origin]))
    if joint.kind == "revolute":
        return rotation(_direction(link), q), origin
    return ca.DM.eye(3), origin + ca.sparsify(ca.DM(_direction(link))) * q


def _axis(link: Link) -> Any:
    """Motion subspace (6, 1) of a link's joint."""
    axis, zero = _direction(link), [0.0] * 3
    return ca.sparsify(ca.DM(axis + zero if link.joint.kind == "revolute" else zero + axis))


def _direction(link: Link) -> list[float]:
    """Unit vector of a link's joint axis."""
    size = math.hypot(*link.joint.axis)
    return [a / size for a in link.joint.axis]


def _inertia(link: Link) -> Any:
    return rigid_inertia(link.mass, link.com, link.inertia)
