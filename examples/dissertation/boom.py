"""A crane boom on the cylinder drive (cylinder.py): whole, and split at the rod into two units.

The boom turns about a pin; the cylinder, whose barrel has its pin below, pushes on it. Its length l(q) is the
constraint between them: the rod moves with v = dl/dq dq/dt and a force F on it turns the boom with F dl/dq. The
dissertation prints no sizes of its boom: these give it an inertia at the rod like that of the load of the drive alone.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import casadi as ca
from cylinder import Drive, controlled

from seacrane.cosim import ModelSlave, Slave, System
from seacrane.design import FOOT, Attachment, Cylinder, Joint, Link
from seacrane.library import mechanics as mech
from seacrane.model import BondGraph, Component, Dae, Diagram, Translational, Variable, initial, parameter
from seacrane.multibody.chain import BaseMotion, forward_dynamics
from seacrane.multibody.chain import frames as frames_of
from seacrane.multibody.cylinder import lengths
from seacrane.units import GRAVITY, Angle, Inertia, Length, deg
from seacrane.units import Mass as Kilograms


@dataclass(frozen=True)
class Boom:
    """Sizes of the boom, in SI. It is a slender rod; the barrel's pin is at `base` from the boom's pin."""

    mass: float = 4e3
    length: float = 5.0
    base: tuple[float, float] = (0.671, -0.995)
    eye: float = 2.4
    retracted: float = 2.0
    angle: float = 35 * deg

    @property
    def inertia(self) -> float:
        """About its pin."""
        return self.mass * self.length**2 / 3

    def cylinder_length(self, angle: Any, root: Any = math.sqrt, cos: Any = math.cos) -> Any:
        """Between the pins, by the law of cosines."""
        a, b = math.hypot(*self.base), self.eye
        return root(a**2 + b**2 - 2 * a * b * cos(angle - math.atan2(self.base[1], self.base[0])))

    @property
    def extension(self) -> float:
        """Of the piston at the start."""
        return float(self.cylinder_length(self.angle)) - self.retracted

    @property
    def push(self) -> float:
        """Force of the rod that holds it at the start."""
        h = 1e-6
        arm = (self.cylinder_length(self.angle + h) - self.cylinder_length(self.angle - h)) / (2 * h)
        return self.mass * GRAVITY * self.length / 2 * math.cos(self.angle) / float(arm)

    @property
    def drive(self) -> Drive:
        """The drive that starts in balance with it."""
        return Drive(load=self.push / GRAVITY, start=self.extension)


class LuffingBoom(Component):
    """J dw/dt = F dl/dq - m g c cos q, with v = dl/dq w at the rod and l(q) from the triangle of the three pins."""

    mass: Kilograms = parameter("mass", above=0)
    inertia: Inertia = parameter("moment of inertia about the pin", above=0)
    centre: Length = parameter("distance of the centre of mass from the pin", above=0)
    base: Length = parameter("distance of the barrel's pin", above=0)
    below: Angle = parameter("angle of the barrel's pin below the horizontal", least=-math.pi, most=math.pi)
    eye: Length = parameter("distance of the rod's pin along the boom", above=0)
    angle: Angle = initial("angle above the horizontal at the start", least=-math.pi, most=math.pi)
    ports = {"flange": Translational("the rod's pin, positive as the cylinder extends")}
    bond_graph = BondGraph(
        "triangle: MTF, turning: 1, inertia: I, weight: Se",
        "flange -> triangle, triangle -> turning, turning |-> inertia, weight |-> turning",
    )

    @classmethod
    def of(cls, boom: Boom) -> LuffingBoom:
        x, z = boom.base
        return cls(mass=boom.mass, inertia=boom.inertia, centre=boom.length / 2, base=math.hypot(x, z),
                   below=-math.atan2(z, x), eye=boom.eye, angle=boom.angle)  # fmt: skip

    def equations(self, m: Any) -> Any:
        q = m.state("angle", unit="rad", start=self.angle, about="angle above the horizontal")
        w = m.state("rate", unit="rad/s", about="rate of the boom")
        opening = q + self.below
        length = ca.sqrt(self.base**2 + self.eye**2 - 2 * self.base * self.eye * ca.cos(opening))
        arm = self.base * self.eye * ca.sin(opening) / length
        weight = self.mass * GRAVITY * self.centre * ca.cos(q)
        yield m.der(q), w
        yield m.flange.v, arm * w
        yield self.inertia * m.der(w), arm * m.flange.F - weight
        m.stores(self.inertia * w * m.der(w))
        m.supplies(-weight * w)


def whole(boom: Boom) -> Diagram:
    """Drive and boom in one model: the reference."""
    return controlled("extended", boom.drive, load=LuffingBoom.of(boom))


def drive_unit(boom: Boom) -> Diagram:
    """The drive with its controller: takes position and velocity of the rod and gives its force."""
    return controlled("extended", boom.drive, load=mech.MotionInput(position=boom.extension, correction=0.0))


def boom_unit(boom: Boom) -> Diagram:
    """The boom: takes the force of the rod and gives its motion."""
    unit = Diagram("boom")
    part = unit.add("boom", LuffingBoom.of(boom))
    push = unit.add("push", mech.ForceInput(position=boom.extension))
    unit.connect(part.flange, push.flange)
    unit.expose(force=push.F, velocity=push.v, position=push.x)
    return unit


def rigid_body(boom: Boom) -> Dae:
    """The boom by the rigid-body engine: a link on the foot and a cylinder between two points of them."""
    joint = Joint(name="luff", kind="revolute", axis=(0.0, -1.0, 0.0), origin=(0.0, 0.0, 0.0))
    about = boom.mass * boom.length**2 / 12
    link = Link(name="boom", joint=joint, mass=boom.mass, com=(boom.length / 2, 0.0, 0.0), inertia=(1.0, about, about))
    base, eye = Attachment(link=FOOT, x=boom.base[0], z=boom.base[1]), Attachment(link="boom", x=boom.eye, z=0.0)
    d = boom.drive
    pins = Cylinder(name="boom_cylinder", moves="luff", bore=d.bore, rod=d.rod, stroke=d.stroke, pressure=d.supply,
                    base=base, eye=eye)  # fmt: skip
    x, force = ca.SX.sym("x", 2), ca.SX.sym("force")
    q, rate = x[0], x[1]
    length = lengths([pins], frames_of([link], q))
    arm = ca.jacobian(length, q)
    acceleration, _ = forward_dynamics([link], q, rate, force * arm, BaseMotion.at_rest())
    none = ca.SX(0, 1)
    return Dae(
        "rigid_body",
        (Variable("luff.position", "rad", boom.angle), Variable("luff.rate", "rad/s")),
        (),
        (Variable("force", "N", boom.push, 1e5),),
        (),
        (Variable("velocity", "m/s"), Variable("position", "m", boom.extension)),
        (),
        t=ca.SX.sym("t"),
        x=x,
        z=none,
        u=force,
        p=none,
        ode=ca.vertcat(rate, acceleration),
        alg=none,
        out=ca.vertcat(arm * rate, length - boom.retracted),
        obs=none,
        about="boom by the rigid-body engine",
    )


def split(drive: Slave, boom: Slave) -> System:
    """The two units with a power bond at the rod. The boom steps after the drive."""
    system = System("cylinder_and_boom", {"drive": drive, "boom": boom})
    system.connect("boom.position", "drive.position")
    system.bond("rod", effort=("drive.force", "boom.force"), flow=("boom.velocity", "drive.velocity"))
    return system


def compiled(boom: Boom, tolerance: float = 1e-6) -> System:
    """Both units as compiled models."""
    settings = {"solver.tolerance": tolerance}
    return split(ModelSlave(drive_unit(boom), settings), ModelSlave(boom_unit(boom), settings))
