"""The crane as a model of other programs: MJCF (MuJoCo) and URDF.

Both hold links, joints with their limits, masses, centres and moments of inertia, and the meshes of the links by file
name. The foot is the fixed base, z up. MJCF also has the cylinders, as tendons between their pins with a motor of the
cylinder's force on each, and a key frame half-way through all joints with the forces that hold the crane's own weight
there; URDF has no such thing: the effort of a joint there is what its cylinders push with on their
longest lever.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from xml.etree import ElementTree

import numpy as np

from seacrane.design.chart import forces
from seacrane.design.crane import FOOT, Attachment, Crane, Joint
from seacrane.design.geometry import longest_lever
from seacrane.design.planar import Plane, check_plane
from seacrane.units import GRAVITY

_LARGE = 1e9
"""Effort or speed of a URDF joint [N.m or N, rad/s or m/s], which URDF demands, where a design does not know it."""


def mjcf(crane: Crane, meshes: Mapping[str, str] | None = None) -> str:
    """The crane in MJCF; meshes: by link, the name of a mesh file beside it."""
    root = _element("mujoco", model=crane.name)
    ElementTree.SubElement(root, "compiler", angle="radian", autolimits="true", inertiagrouprange="5 5")
    ElementTree.SubElement(root, "option", gravity=_numbers((0.0, 0.0, -GRAVITY)))
    if meshes:
        asset = ElementTree.SubElement(root, "asset")
        for name, file in meshes.items():
            ElementTree.SubElement(asset, "mesh", name=name, file=file)
    world = ElementTree.SubElement(root, "worldbody")
    _sites(world, crane, FOOT)
    parent = world
    for link in crane.links:
        # MuJoCo has a body `world` of its own, which the foot is fixed to.
        name = f"{link.name} link" if link.name == "world" else link.name
        parent = ElementTree.SubElement(parent, "body", name=name, pos=_numbers(link.joint.origin))
        kind = "hinge" if link.joint.kind == "revolute" else "slide"
        joint = ElementTree.SubElement(
            parent, "joint", name=link.joint.name, type=kind, axis=_numbers(_unit(link.joint))
        )
        if link.joint.limits:
            joint.set("range", _numbers(link.joint.limits))
        ElementTree.SubElement(
            parent,
            "inertial",
            pos=_numbers(link.com),
            mass=_number(link.mass),
            diaginertia=_numbers(link.inertia),
        )
        if meshes and link.name in meshes:
            ElementTree.SubElement(parent, "geom", type="mesh", mesh=link.name, contype="0", conaffinity="0", group="2")
        _sites(parent, crane, link.name)
    if not check_plane(crane):
        coordinates, thrusts = _held(crane)
        frames = ElementTree.SubElement(root, "keyframe")
        ElementTree.SubElement(frames, "key", name="half-way", qpos=_numbers(coordinates), ctrl=_numbers(thrusts))
    tendons = ElementTree.SubElement(root, "tendon")
    motors = ElementTree.SubElement(root, "actuator")
    for cylinder in crane.cylinders:
        tendon = ElementTree.SubElement(tendons, "spatial", name=cylinder.name)
        for end in ("base", "eye"):
            ElementTree.SubElement(tendon, "site", site=f"{cylinder.name}.{end}")
        push, pull = forces(cylinder)
        # A motor works along the lengthening of its tendon: a positive control extends the cylinder.
        ElementTree.SubElement(
            motors,
            "motor",
            name=cylinder.name,
            tendon=cylinder.name,
            gear="1",
            ctrlrange=_numbers((-pull, push)),
        )
    return _text(root)


def urdf(crane: Crane, meshes: Mapping[str, str] | None = None) -> str:
    """The crane in URDF, its base link the foot; meshes: by link, the name of a mesh file beside it."""
    root = _element("robot", name=crane.name)
    ElementTree.SubElement(root, "link", name=FOOT)
    before = FOOT
    for link in crane.links:
        body = ElementTree.SubElement(root, "link", name=link.name)
        inertial = ElementTree.SubElement(body, "inertial")
        ElementTree.SubElement(inertial, "origin", xyz=_numbers(link.com), rpy="0 0 0")
        ElementTree.SubElement(inertial, "mass", value=_number(link.mass))
        xx, yy, zz = (_number(value) for value in link.inertia)
        ElementTree.SubElement(inertial, "inertia", ixx=xx, iyy=yy, izz=zz, ixy="0", ixz="0", iyz="0")
        if meshes and link.name in meshes:
            visual = ElementTree.SubElement(body, "visual")
            geometry = ElementTree.SubElement(visual, "geometry")
            ElementTree.SubElement(geometry, "mesh", filename=meshes[link.name])
        limits = link.joint.limits
        kind = "prismatic" if link.joint.kind == "prismatic" else "revolute" if limits else "continuous"
        joint = ElementTree.SubElement(root, "joint", name=link.joint.name, type=kind)
        ElementTree.SubElement(joint, "origin", xyz=_numbers(link.joint.origin), rpy="0 0 0")
        ElementTree.SubElement(joint, "parent", link=before)
        ElementTree.SubElement(joint, "child", link=link.name)
        ElementTree.SubElement(joint, "axis", xyz=_numbers(_unit(link.joint)))
        bounds = dict(zip(("lower", "upper"), map(_number, limits or ()), strict=False))
        speed = crane.slew.speed if crane.slew and crane.slew.joint == link.joint.name else _LARGE
        bounds |= {"effort": _number(_effort(crane, link.joint)), "velocity": _number(speed)}
        ElementTree.SubElement(joint, "limit", bounds)
        before = link.name
    return _text(root)


def _held(crane: Crane) -> tuple[list[float], list[float]]:
    """The coordinates of all joints half-way, and the force of each cylinder set under the crane's own weight [N]."""
    middle = {joint.name: 0.5 * sum(joint.limits or (0.0, 0.0)) for joint in crane.joints}
    plane = Plane(crane, {name: np.asarray(q) for name, q in middle.items()})
    thrusts = []
    for c in crane.cylinders:
        lever = float(plane.distance_by_joint(c.moves, c.base, c.eye))
        weight = GRAVITY * float(plane.own_moment(c.moves, (0.0, 1.0)))
        thrusts.append(weight / lever if lever else 0.0)
    return list(middle.values()), thrusts


def _effort(crane: Crane, joint: Joint) -> float:
    """The most that the cylinders of a joint give it in its travel [N.m or N]."""
    found = [longest_lever(crane, c) * max(forces(c)) for c in crane.cylinders if c.moves == joint.name]
    return max(found, default=_LARGE)


def _sites(body: ElementTree.Element, crane: Crane, link: str) -> None:
    pins: list[tuple[str, Attachment]] = []
    for cylinder in crane.cylinders:
        pins += [(f"{cylinder.name}.base", cylinder.base), (f"{cylinder.name}.eye", cylinder.eye)]
    pins += [("drum", crane.hoist.drum)]
    pins += [(f"sheave {number}", sheave) for number, sheave in enumerate(crane.hoist.sheaves, 1)]
    for name, pin in pins:
        if pin.link == link:
            ElementTree.SubElement(body, "site", name=name, pos=_numbers((pin.x, 0.0, pin.z)))


def _unit(joint: Joint) -> tuple[float, ...]:
    size = math.hypot(*joint.axis)
    return tuple(component / size for component in joint.axis)


def _element(tag: str, **attributes: str) -> ElementTree.Element:
    return ElementTree.Element(tag, attributes)


def _number(value: float) -> str:
    return repr(float(value))


def _numbers(values: Sequence[float]) -> str:
    return " ".join(_number(value) for value in values)


def _text(root: ElementTree.Element) -> str:
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, encoding="unicode") + "\n"
