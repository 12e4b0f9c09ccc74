"""Mass, centre and inertia of parts and links, from the volume that their meshes enclose.

Every triangle and the origin span a tetrahedron with a signed volume; volume, first and second moments of a closed
surface are the sums over all (B. Mirtich, Fast and accurate computation of polyhedral mass properties, Journal of
Graphics Tools 1(2), 1996, does the same by surface integrals).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import msgspec
import numpy as np

from seacrane.design.crane import Crane, Cylinder, Link
from seacrane.design.mesh import Array, Mesh, mesh
from seacrane.design.parts import STEEL, Part

_HOOP_STRESS = 150e6
"""Of a cylinder's barrel at working pressure [Pa]."""


@dataclass(frozen=True, eq=False)
class MassProperties:
    """mass [kg]; centre (3,) [m]; inertia (3, 3) [kg.m2] about the centre, along the axes of the frame."""

    mass: float
    centre: Array
    inertia: Array


def volume(surface: Mesh) -> float:
    """What a closed mesh encloses [m3]; negative if it is inside out."""
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c))) / 6


def of_mesh(surface: Mesh, density: float) -> MassProperties:
    """Mass properties of what a closed mesh encloses, at a density [kg/m3]."""
    a, b, c = (surface.vertices[surface.faces[:, k]] for k in range(3))
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    volume = float(volumes.sum())
    centre = (volumes[:, None] * (a + b + c)).sum(axis=0) / 4 / volume
    a, b, c = a - centre, b - centre, c - centre
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    total = a + b + c
    second = sum(np.einsum("n,ni,nj->ij", volumes, p, p) for p in (a, b, c, total)) / 20
    return MassProperties(density * volume, centre, density * (np.trace(second) * np.eye(3) - second))


def of_part(part: Part) -> MassProperties:
    """Mass properties of a part in the frame of its link."""
    return of_mesh(mesh(part), part.density)


def combined(bodies: Iterable[MassProperties]) -> MassProperties:
    """Several bodies fixed to each other as one (Steiner's theorem); at least one."""
    bodies = list(bodies)
    mass = sum(body.mass for body in bodies)
    centre = sum((body.mass * body.centre for body in bodies), np.zeros(3)) / mass
    inertia = np.zeros((3, 3))
    for body in bodies:
        d = body.centre - centre
        inertia += body.inertia + body.mass * (float(d @ d) * np.eye(3) - np.outer(d, d))
    return MassProperties(mass, centre, inertia)


def of_link(link: Link) -> MassProperties:
    """Mass properties of the parts of a link together; a link without parts has those that the design gives it."""
    if link.parts:
        return combined(of_part(part) for part in link.parts)
    return MassProperties(link.mass, np.array(link.com, float), np.diag(link.inertia))


def weighed(crane: Crane) -> Crane:
    """The crane with mass, centre and moments of inertia of each link taken from its parts, where it has any.

    Products of inertia are left out, as everywhere in a design: a part in the plane of the crane has one small one.
    """

    def link(old: Link) -> Link:
        if not old.parts:
            return old
        body = of_link(old)
        x, y, z = (float(v) for v in body.centre)
        xx, yy, zz = (float(v) for v in np.diag(body.inertia))
        return msgspec.structs.replace(old, mass=body.mass, com=(x, y, z), inertia=(xx, yy, zz))

    return msgspec.structs.replace(crane, links=tuple(link(old) for old in crane.links))


def wall(cylinder: Cylinder) -> float:
    """An estimate of a barrel's wall [m]: it bears the working pressure at a hoop stress of 150 MPa (p d / 2 t)."""
    return cylinder.pressure * cylinder.bore / (2 * _HOOP_STRESS)


def of_cylinder(cylinder: Cylinder) -> float:
    """An estimate of the mass of a cylinder set [kg], steel only: rods, barrels, pistons with heads and eyes.

    Pistons, heads and eyes are taken as a solid two bores long.
    """
    rod = math.pi / 4 * cylinder.rod**2 * cylinder.stroke
    barrel = math.pi * (cylinder.bore + wall(cylinder)) * wall(cylinder) * cylinder.stroke
    ends = math.pi / 4 * cylinder.bore**2 * 2 * cylinder.bore
    return cylinder.count * STEEL * (rod + barrel + ends)
