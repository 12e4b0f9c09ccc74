"""Mechanical components: springs, masses, gears, the winch drum, and the boundaries to a co-simulation partner.

Forces and torques at a port act *on* the component, positive along +v or +w. A boundary (`MotionInput`, `SpeedInput`,
`ForceInput`, `TorqueInput`) is where a drive meets a model in another simulator: it imposes what the partner gives and
reports what the drive gives back, with the sign as the partner feels it, and the work that has passed.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

from seacrane.model import BondGraph, Component, Rotational, SignalIn, SignalOut, Translational, initial, parameter
from seacrane.numerics.regularise import maximum, smooth_sign
from seacrane.units import (
    Acceleration,
    AngularSpeed,
    Damping,
    Diameter,
    Frequency,
    Length,
    Ratio,
    RotationalDamping,
    RotationalStiffness,
    Speed,
    Stiffness,
    Torque,
)
from seacrane.units import (
    Inertia as MomentOfInertia,
)
from seacrane.units import (
    Mass as KilogramMass,
)

DISSERTATION = "Virtual Prototyping for Marine Crane Design and Operations, 2018, section 4.2.2 and appendix A"


# ---------------------------------------------------------------- stores
class Mass(Component):
    """A mass on a line: m dv/dt = sum of F - m g.

    `gravity` is the share of gravity against +v: 0 for a horizontal line, 9.81 m/s2 for one whose +v points up. Stores
    m v dv/dt; gravity supplies -m g v. Given the force, gives the speed.
    """

    mass: KilogramMass = parameter("mass", above=0, most=1e9)
    gravity: Acceleration = parameter("gravity against +v", default=0.0, least=-100, most=100)
    speed: Speed = initial("speed at the start", least=-1e3, most=1e3)
    ports = {"flange": Translational("where forces act")}
    bond_graph = BondGraph(
        "motion: 1, inertia: I, weight: Se", "flange -> motion, motion ->| inertia, weight ->| motion"
    )
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        v = m.state("speed", unit="m/s", start=self.speed, about="speed of the mass")
        yield m.flange.v, v
        yield self.mass * m.der(v), m.flange.F - self.mass * self.gravity
        m.stores(self.mass * v * m.der(v))
        m.supplies(-self.mass * self.gravity * v)


class Inertia(Component):
    """A rotating inertia: J dw/dt = sum of T. Given the torque, gives the speed."""

    inertia: MomentOfInertia = parameter("moment of inertia", above=0, most=1e9)
    speed: AngularSpeed = initial("speed at the start", least=-1e4, most=1e4)
    ports = {"flange": Rotational("where torques act")}
    bond_graph = BondGraph("inertia: I", "flange ->| inertia")
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.state("speed", unit="rad/s", start=self.speed, nominal=10.0, about="speed of the inertia")
        yield m.flange.w, w
        yield self.inertia * m.der(w), m.flange.T
        m.stores(self.inertia * w * m.der(w))


class SpringDamper(Component):
    """A spring and a damper side by side: F = k s + c (v_a - v_b), ds/dt = v_a - v_b.

        a ──┬─/\\/\\/─┬── b      F pushes a along +v; s is how far a has come towards b
            └──[|──┘

    k = 0 leaves a damper, c = 0 a spring. Stores k s ds/dt, loses c (v_a - v_b)^2. Given both speeds, gives the force.
    """

    stiffness: Stiffness = parameter("stiffness", least=0, most=1e13)
    damping: Damping = parameter("damping", least=0, most=1e12)
    compression: Length = initial("compression at the start", least=-1e3, most=1e3)
    ports = {"a": Translational("one end"), "b": Translational("other end")}
    bond_graph = BondGraph(
        "between: 0, closing: 1, spring: C, damper: R",
        "a -> between, between -> b, between -> closing, closing |-> spring, closing |-> damper",
    )
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        s = m.state("compression", unit="m", start=self.compression, nominal=1e-2, about="compression of the spring")
        closing = m.a.v - m.b.v
        yield m.der(s), closing
        yield m.a.F, self.stiffness * s + self.damping * closing
        yield m.a.F + m.b.F, 0
        m.stores(self.stiffness * s * closing)
        m.dissipates(self.damping * closing**2)


class TorsionalSpringDamper(Component):
    """A shaft that twists: T = k s + c (w_a - w_b), ds/dt = w_a - w_b. As `SpringDamper`, in rotation."""

    stiffness: RotationalStiffness = parameter("stiffness", least=0, most=1e13)
    damping: RotationalDamping = parameter("damping", least=0, most=1e12)
    ports = {"a": Rotational("one end"), "b": Rotational("other end")}
    bond_graph = BondGraph(
        "between: 0, slip: 1, spring: C, damper: R",
        "a -> between, between -> b, between -> slip, slip |-> spring, slip |-> damper",
    )
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        s = m.state("twist", unit="rad", nominal=1e-2, about="twist of the shaft")
        slip = m.a.w - m.b.w
        yield m.der(s), slip
        yield m.a.T, self.stiffness * s + self.damping * slip
        yield m.a.T + m.b.T, 0
        m.stores(self.stiffness * s * slip)
        m.dissipates(self.damping * slip**2)


class RotationalFriction(Component):
    """Friction of a bearing against the ground: T = B w + T_c sign(w), the sign rounded within `friction_speed`."""

    viscous: RotationalDamping = parameter("viscous friction", least=0, most=1e12)
    coulomb: Torque = parameter("Coulomb friction torque", least=0, most=1e9)
    friction_speed: AngularSpeed = parameter("speed within which it turns its sign", default=1e-2, above=0, most=10)
    ports = {"flange": Rotational("shaft")}
    bond_graph = BondGraph("friction: R", "flange |-> friction")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.flange.w
        yield m.flange.T, self.viscous * w + self.coulomb * smooth_sign(w, self.friction_speed)
        m.dissipates(m.flange.power)


# ---------------------------------------------------------------- transformers
class Gear(Component):
    """A reduction gear without loss: w_a = i w_b, T_b = -i T_a; i = `reduction` (100 for 100:1).

    motor ══a══(i : 1)══b══ load
    """

    reduction: Ratio = parameter("speed of a over speed of b", above=0, most=1e5)
    ports = {"a": Rotational("fast shaft"), "b": Rotational("slow shaft")}
    bond_graph = BondGraph("gear: TF", "a -> gear, gear -> b")
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.a.w, self.reduction * m.b.w
        yield m.b.T, -self.reduction * m.a.T


class WinchDrum(Component):
    """A drum: v = r w, T = r S, where S is the pull of the rope.

             ___
        w ↻ ( o )═══════ rope ──► S pulls off the drum        v > 0 and w > 0: rope comes in

    The rope port counts +v inwards, so the pull of the rope is rope.F = -S, and the shaft must be driven with
    shaft.T = r S. Reports `radius` [m] and `pull` [N]. Levels: `constant-radius` and `layers`.
    """

    radius: Length = parameter("radius of the drum to the centre of the first layer", above=0, most=20)
    ports = {"shaft": Rotational("shaft; hoisting is positive"), "rope": Translational("rope; coming in is positive")}
    bond_graph = BondGraph("drum: TF", "shaft -> drum, drum -> rope")
    sources = (DISSERTATION,)

    def winding(self, m: Any, radius: Any) -> Iterator[tuple[Any, Any]]:
        """The transformer at this radius."""
        yield m.rope.v, radius * m.shaft.w
        yield m.shaft.T, -radius * m.rope.F
        m.observe("radius_now", radius, "m", "radius at which the rope runs on")
        m.observe("pull", -m.rope.F, "N", "pull of the rope")


class ConstantRadiusWinchDrum(WinchDrum, level="constant-radius"):
    """The radius is that of the first layer."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.winding(m, self.radius)


class LayeredWinchDrum(WinchDrum, level="layers"):
    """The radius grows with the rope on the drum: r = sqrt(r_0^2 + k d^2 L / (pi b)), dL/dt = v.

    It follows from the volume: an annulus pi (r^2 - r_0^2) b holds the length L of rope, of which each metre takes
    k d^2. d rope diameter, b width of the drum, k packing: 1 for layers on top of each other, 0.87 for rope lying in
    the grooves between. Never below r_0.
    """

    rope_diameter: Diameter = parameter("rope diameter", above=0, most=0.5)
    width: Length = parameter("width of the drum between flanges", above=0, most=50)
    packing: Ratio = parameter("packing factor", default=1.0, above=0.5, most=1.5)
    wound: Length = initial("length of rope on the drum at the start", least=0, most=5e4)
    bond_graph = BondGraph("drum: MTF", "shaft -> drum, drum -> rope")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        length = m.state("wound", unit="m", start=self.wound, nominal=100.0, about="length of rope on the drum")
        annulus = self.packing * self.rope_diameter**2 * maximum(length, 0.0) / (pi * self.width)
        yield m.der(length), m.rope.v
        yield from self.winding(m, (self.radius**2 + annulus) ** 0.5)


# ---------------------------------------------------------------- boundaries to a partner
class MotionInput(Component):
    """Imposes a partner's motion and reports the force delivered to it.

        partner  v, x ──►┌───────┐
                         │       ├── flange ── rod of the cylinder
        partner  F   ◄───└───────┘

    v_eff = v + correction (x - x_own),  dx_own/dt = v_eff = flange.v

    A partner gives its speed at communication points only; held between them, its integral would drift away from the
    partner's own position. The correction pulls x_own to the x that the partner reports, with the time constant
    1/correction. F = flange.F is positive along +v: it is what the drive pushes the partner with. `work` is the
    integral of F v_eff, what has left the drive.
    """

    correction: Frequency = parameter("rate of following the partner's position", default=5.0, least=0, most=1e4)
    position: Length = initial("position of the partner at the start", least=-1e5, most=1e5)
    ports = {
        "v": SignalIn("m/s", "speed of the partner"),
        "x": SignalIn("m", "position of the partner"),
        "flange": Translational("what the partner moves"),
        "F": SignalOut("N", "force on the partner, positive along v"),
        "work": SignalOut("J", "work done on the partner"),
    }
    bond_graph = BondGraph("partner: MSf", "partner |-> flange")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        x = m.state("position", unit="m", start=self.position, about="own position of the flange")
        w = m.state("work_done", unit="J", nominal=1e5, about="work done on the partner")
        yield m.flange.v, m.v + self.correction * (m.x - x)
        yield m.der(x), m.flange.v
        yield m.der(w), m.flange.power
        yield m.F, m.flange.F
        yield m.work, w
        m.supplies(-m.flange.power)


class SpeedInput(Component):
    """Imposes a partner's shaft speed w and reports the torque T delivered to it, positive along w.

    The rotational twin of `MotionInput`, without a position: a drive's law does not depend on the angle.
    """

    ports = {
        "w": SignalIn("rad/s", "speed of the partner's shaft"),
        "flange": Rotational("what the partner turns"),
        "T": SignalOut("N.m", "torque on the partner, positive along w"),
        "work": SignalOut("J", "work done on the partner"),
    }
    bond_graph = BondGraph("partner: MSf", "partner |-> flange")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.state("work_done", unit="J", nominal=1e5, about="work done on the partner")
        yield m.flange.w, m.w
        yield m.der(w), m.flange.power
        yield m.T, m.flange.T
        yield m.work, w
        m.supplies(-m.flange.power)


class ForceInput(Component):
    """Imposes a partner's force F, positive along +v of the flange's node, and reports the speed and position there.

    The other causality of `MotionInput`: here the drive holds the mass and the partner the load.
    """

    position: Length = initial("position at the start", least=-1e5, most=1e5)
    ports = {
        "F": SignalIn("N", "force of the partner on the drive"),
        "flange": Translational("where the force acts"),
        "v": SignalOut("m/s", "speed there"),
        "x": SignalOut("m", "position there"),
        "work": SignalOut("J", "work done on the partner"),
    }
    bond_graph = BondGraph("partner: MSe", "partner ->| flange")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        x = m.state("position", unit="m", start=self.position, about="position of the flange")
        w = m.state("work_done", unit="J", nominal=1e5, about="work done on the partner")
        yield m.flange.F, -m.F
        yield m.der(x), m.flange.v
        yield m.der(w), m.flange.power
        yield m.v, m.flange.v
        yield m.x, x
        yield m.work, w
        m.supplies(-m.flange.power)


class TorqueInput(Component):
    """Imposes a partner's torque T, positive along +w of the flange's node, and reports the speed there."""

    ports = {
        "T": SignalIn("N.m", "torque of the partner on the drive"),
        "flange": Rotational("where the torque acts"),
        "w": SignalOut("rad/s", "speed there"),
        "work": SignalOut("J", "work done on the partner"),
    }
    bond_graph = BondGraph("partner: MSe", "partner ->| flange")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.state("work_done", unit="J", nominal=1e5, about="work done on the partner")
        yield m.flange.T, -m.T
        yield m.der(w), m.flange.power
        yield m.w, m.flange.w
        yield m.work, w
        m.supplies(-m.flange.power)
