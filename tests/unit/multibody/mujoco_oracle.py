"""Cranes as MuJoCo models, an independent program to compare with, on a foot whose motion is prescribed.

The foot is a free body. With its acceleration prescribed, the equations of motion M a + b = f are solved for the other
coordinates, and the foot's rows, less what moves the foot itself, give the force that the foot exerts on the crane.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from xml.sax.saxutils import quoteattr

import mujoco
import numpy as np

from seacrane.design import Crane, Link

FOOT_MASS = 1e5
"""Mass [kg] and moments of inertia [kg.m2] of the foot; heavy enough for MuJoCo's own factorisation."""


@dataclass(frozen=True)
class Foot:
    """Attitude of the foot (axes as columns, in the inertial frame) and its motion, in foot axes."""

    axes: np.ndarray
    w: np.ndarray
    alpha: np.ndarray
    a: np.ndarray

    @classmethod
    def at_rest(cls) -> Foot:
        return cls(np.eye(3), np.zeros(3), np.zeros(3), np.zeros(3))

    @classmethod
    def random(cls, rng: np.random.Generator) -> Foot:
        q, r = np.linalg.qr(rng.normal(size=(3, 3)))
        axes = q * np.sign(np.diag(r))
        axes[:, 0] *= np.sign(np.linalg.det(axes))
        return cls(axes, *rng.uniform(-0.5, 0.5, (2, 3)), rng.uniform(-3, 3, 3))

    @property
    def gravity(self) -> np.ndarray:
        """In foot axes [m/s2]."""
        return self.axes.T @ (0, 0, -9.81)


def _numbers(values: Sequence[float]) -> str:
    return quoteattr(" ".join(repr(float(v)) for v in values))


def _chain(links: Sequence[Link], sites: dict[str, str]) -> str:
    if not links:
        return ""
    link, kind = links[0], {"revolute": "hinge", "prismatic": "slide"}[links[0].joint.kind]
    return (
        f"<body pos={_numbers(link.joint.origin)}>"
        f'<joint name="{link.joint.name}" type="{kind}" axis={_numbers(link.joint.axis)}/>'
        f'<inertial pos={_numbers(link.com)} mass="{link.mass}" diaginertia={_numbers(link.inertia)}/>'
        f"{sites.get(link.name, '')}{_chain(links[1:], sites)}</body>"
    )


def _world(chain: str, rest: str = "", more: str = "") -> mujoco.MjModel:
    return mujoco.MjModel.from_xml_string(
        '<mujoco><compiler angle="radian" inertiafromgeom="false"/><option gravity="0 0 -9.81"/><worldbody>'
        '<body name="foot"><freejoint/>'
        f'<inertial pos="0 0 0" mass="{FOOT_MASS}" diaginertia={_numbers([FOOT_MASS] * 3)}/>'
        f"{chain}</body>{rest}</worldbody>{more}</mujoco>"
    )


class ChainOracle:
    """Joint accelerations and foot wrench of a bare chain."""

    def __init__(self, links: Sequence[Link]) -> None:
        self.model = _world(_chain(links, {}))
        self.data = mujoco.MjData(self.model)

    def __call__(
        self, foot: Foot, q: np.ndarray, qd: np.ndarray, effort: np.ndarray, rotor: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        _place(self.data, foot)
        self.data.qpos[7:], self.data.qvel[6:] = q, qd
        self.model.dof_armature[6:] = rotor
        return _solve(self.model, self.data, foot, effort)


class CraneOracle:
    """A crane with cylinders and rope as tendons, and its load as a free body."""

    def __init__(self, crane: Crane, load_mass: float) -> None:
        sites: dict[str, str] = {}
        tendons, actuators = [], []
        rope = (crane.hoist.drum, *crane.hoist.sheaves)
        pairs = [(c.name, (c.base, c.eye)) for c in crane.cylinders]
        for name, points in (*pairs, ("rope", rope)):
            for i, point in enumerate(points):
                site = f'<site name="{name}{i}" pos={_numbers((point.x, 0, point.z))}/>'
                sites[point.link] = sites.get(point.link, "") + site
        for name, _ in pairs:
            tendons.append(f'<spatial name="{name}"><site site="{name}0"/><site site="{name}1"/></spatial>')
            actuators.append(f'<motor name="{name}" tendon="{name}"/>')
        path = "".join(f'<site site="rope{i}"/>' for i in range(len(rope)))
        tendons.append(f'<spatial name="rope">{path}<site site="hook"/></spatial>')
        actuators.append(
            '<general name="rope" tendon="rope" gaintype="fixed" biastype="affine" gainprm="1" biasprm="0 0 0" '
            'forcelimited="true" forcerange="-1e9 0"/>'
        )
        load = (
            f'<body name="load"><freejoint name="load"/><inertial pos="0 0 0" mass="{load_mass}" '
            'diaginertia="1e4 1e4 1e4"/><site name="hook"/></body>'
        )
        more = f"<tendon>{''.join(tendons)}</tendon><actuator>{''.join(actuators)}</actuator>"
        self.model = _world(_chain(crane.links, sites), load, more)
        self.data = mujoco.MjData(self.model)
        self.joints = len(crane.links)
        self.cylinders = [name for name, _ in pairs]

    def place(self, foot: Foot, q: np.ndarray, qd: np.ndarray, r: np.ndarray, v: np.ndarray) -> float:
        """Set the state, load relative to the foot in foot axes; the rope's path length."""
        n, data = self.joints, self.data
        _place(data, foot)
        data.qpos[7 : 7 + n], data.qvel[6 : 6 + n] = q, qd
        data.qpos[7 + n :] = (*(foot.axes @ r), 1, 0, 0, 0)
        data.qvel[6 + n :] = (*(foot.axes @ (v + np.cross(foot.w, r))), 0, 0, 0)
        mujoco.mj_forward(self.model, data)
        return float(data.tendon("rope").length[0])

    def lengths(self) -> np.ndarray:
        return np.array([self.data.tendon(name).length[0] for name in self.cylinders])

    def solve(
        self, foot: Foot, forces: np.ndarray, rope: tuple[float, float, float, float], joint_effort: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        """Joint and relative load accelerations, tension, wrench [moment; force] of the foot on crane and rope.

        rope: stiffness [N/m], damping [N.s/m], unstretched length [m], speed onto the drum [m/s].
        """
        model, data, n = self.model, self.data, self.joints
        for name, force in zip(self.cylinders, forces, strict=True):
            data.actuator(name).ctrl[0] = force
        stiffness, damping, unstretched, winding = rope
        index = model.actuator("rope").id
        model.actuator_gainprm[index, 0] = stiffness
        model.actuator_biasprm[index, :3] = (-damping * winding, -stiffness, -damping)
        data.actuator("rope").ctrl[0] = unstretched
        mujoco.mj_forward(model, data)
        applied = data.qfrc_actuator[6:].copy()
        applied[:n] += joint_effort
        acceleration, wrench = _solve(model, data, foot, applied)
        r = foot.axes.T @ data.qpos[7 + n : 10 + n]
        v = foot.axes.T @ data.qvel[6 + n : 9 + n] - np.cross(foot.w, r)
        absolute = foot.axes.T @ acceleration[n : n + 3]
        relative = absolute - foot.a - np.cross(foot.alpha, r) - np.cross(foot.w, np.cross(foot.w, r))
        relative -= 2 * np.cross(foot.w, v)
        return acceleration[:n], relative, -float(data.actuator("rope").force[0]), wrench


def _place(data: mujoco.MjData, foot: Foot) -> None:
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, foot.axes.ravel())
    data.qpos[:3], data.qpos[3:7] = 0, quaternion
    data.qvel[:3], data.qvel[3:6] = 0, foot.w


def _solve(
    model: mujoco.MjModel, data: mujoco.MjData, foot: Foot, applied: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    mujoco.mj_forward(model, data)
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    prescribed = np.concatenate([foot.axes @ foot.a, foot.alpha])
    bias = data.qfrc_bias
    free = np.linalg.solve(mass[6:, 6:], applied - bias[6:] - mass[6:, :6] @ prescribed)
    reaction = mass[:6, :6] @ prescribed + mass[:6, 6:] @ free + bias[:6] - data.qfrc_actuator[:6]
    force = foot.axes.T @ reaction[:3] - FOOT_MASS * (foot.a - foot.gravity)
    return free, np.concatenate([reaction[3:] - FOOT_MASS * foot.alpha, force])
