"""What the mechanics of a crane is told: its inputs, states, parameters and energy counters, by name."""

from __future__ import annotations

from seacrane.design import Crane, Link
from seacrane.model.dae import Variable
from seacrane.multibody.equilibrium import Equilibrium, driven_joints
from seacrane.units import GRAVITY

AXES = ("x", "y", "z")
_FRICTION = 3e-3
"""Default viscous friction [s]: share of the rated moment or pull taken at 1 rad/s or 1 m/s. An assumption."""
_DRUM_SHARE = 0.125
"""Default inertia of drum and rotors, as a mass on the rope: share of the rated load. An assumption."""


def inputs(crane: Crane, start: Equilibrium) -> tuple[Variable, ...]:
    """Efforts of cylinders, drives and drum, then the motion of the foot; they start at what holds the crane still."""
    cylinders = [
        Variable(f"{c.name}.force", "N", start.cylinder_forces[c.name], 1e6, about="force of the set, extending")
        for c in crane.cylinders
    ]
    drives = [
        Variable(
            drive_name(link), "N.m" if turns(link) else "N", start.drives[link.joint.name], 1e6, about="drive effort"
        )
        for link in driven_links(crane)
    ]
    drum = Variable("drum.torque", "N.m", start.drum_torque, 1e5, about="torque on the drum, hoisting")
    gravity = (0.0, 0.0, -GRAVITY)
    base = [
        *(Variable(f"base.w{i}", "rad/s", about="angular velocity of the foot, foot axes") for i in AXES),
        *(Variable(f"base.al{i}", "rad/s2", about="angular acceleration of the foot, foot axes") for i in AXES),
        *(Variable(f"base.a{i}", "m/s2", about="acceleration of the foot without gravity, foot axes") for i in AXES),
        *(Variable(f"base.v{i}", "m/s", about="velocity of the foot, foot axes") for i in AXES),
        Variable("base.z", "m", about="height of the foot above still water"),
        *(Variable(f"base.g{i}", "m/s2", g, about="gravity, foot axes") for i, g in zip(AXES, gravity, strict=True)),
    ]
    return (*cylinders, *drives, drum, *base)


def states(crane: Crane, start: Equilibrium) -> tuple[Variable, ...]:
    """Joints, load, rope, drum and energy counters."""
    joints = []
    for link, q in zip(crane.links, start.posture, strict=True):
        unit = "rad" if turns(link) else "m"
        joints.append(Variable(f"{link.joint.name}.position", unit, float(q), about="joint position"))
    for link in crane.links:
        unit = "rad/s" if turns(link) else "m/s"
        joints.append(Variable(f"{link.joint.name}.rate", unit, 0.0, 0.1, about="joint rate"))
    load = [
        Variable(f"load.position.{i}", "m", float(r), about="load from the foot, foot axes")
        for i, r in zip(AXES, start.load_position, strict=True)
    ]
    load += [Variable(f"load.velocity.{i}", "m/s", about="load relative to the foot, foot axes") for i in AXES]
    return (
        *joints,
        *load,
        Variable("rope.unstretched", "m", start.unstretched_length, about="unstretched length, drum to hook"),
        Variable("drum.rate", "rad/s", about="drum speed, hoisting", shown="rpm"),
        *(Variable(f"counter.{name}", "J", 0.0, 1e6, about=about) for name, about in counters(crane).items()),
    )


def parameters(crane: Crane, load_mass: float) -> tuple[Variable, ...]:
    """Load, rope, drum, frictions and rotors."""
    rated_pull = GRAVITY * max(rated.mass for rated in crane.capacity)
    rated_moment = GRAVITY * max(rated.mass * rated.radius for rated in crane.capacity)
    radius = crane.hoist.drum_radius

    def positive(name: str, unit: str, value: float, about: str) -> Variable:
        return Variable(name, unit, value, value or 1.0, minimum=0.0, about=about)

    def friction(name: str, turning: bool, rated: float) -> Variable:
        unit = "N.m.s/rad" if turning else "N.s/m"
        return positive(f"{name}.friction", unit, _FRICTION * rated, f"viscous friction of {name}")

    joints = [
        friction(link.joint.name, turns(link), rated_moment if turns(link) else rated_pull) for link in crane.links
    ]
    rotors = [
        positive(
            f"{link.joint.name}.rotor_inertia",
            "kg.m2" if turns(link) else "kg",
            0.0,
            "inertia of the drive's rotors reflected to the joint",
        )
        for link in driven_links(crane)
    ]
    return (
        positive("load.mass", "kg", load_mass, "mass on the hook"),
        positive("load.drag", "N.s/m", 0.0, "linear drag of the load in still air"),
        positive("rope.EA", "N", crane.hoist.rope.EA, "axial stiffness of the rope"),
        positive("rope.damping_ratio", "1", crane.hoist.rope.damping_ratio, "of the load's bounce on the rope"),
        positive("drum.radius", "m", radius, "radius of the rope on the drum"),
        positive(
            "drum.inertia",
            "kg.m2",
            _DRUM_SHARE * rated_pull / GRAVITY * radius**2,
            "drum and its drive's rotors, reflected to the drum",
        ),
        friction("drum", True, rated_pull * radius),
        *joints,
        *rotors,
    )


def counters(crane: Crane) -> dict[str, str]:
    """Names of the energy counters, which are states, and what they count."""
    return {
        **{f"work_{short_name(c.name)}": f"work of {c.name}" for c in crane.cylinders},
        **{f"work_{name}": f"work of the drive of {name}" for name in driven_joints(crane)},
        "work_drum": "work of the drum's drive",
        "work_base": "work of the ship at the foot",
        "dissipated": "lost to rope damping, friction and drag",
        "carried": "elastic energy that strained rope took onto the drum",
    }


def turns(link: Link) -> bool:
    """Whether a link turns, rather than slides, on the one before it."""
    return link.joint.kind == "revolute"


def driven_links(crane: Crane) -> list[Link]:
    """Links whose joint no cylinder moves."""
    driven = driven_joints(crane)
    return [link for link in crane.links if link.joint.name in driven]


def drive_name(link: Link) -> str:
    """Input of the drive of a link's joint."""
    return f"{link.joint.name}.{'torque' if turns(link) else 'force'}"


def short_name(cylinder: str) -> str:
    """What a cylinder's counter is named after: boom of boom_cylinder."""
    return cylinder.removesuffix("_cylinder")
