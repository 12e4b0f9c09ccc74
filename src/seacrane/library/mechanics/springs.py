"""Springs, dampers, ropes, end stops and friction."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.library import symbols
from seacrane.model import BondGraph, Component, Rotational, Translational, initial, parameter
from seacrane.numerics.regularise import limit, maximum, smooth_sign
from seacrane.units import (
    AngularSpeed,
    Damping,
    Length,
    RotationalDamping,
    RotationalStiffness,
    Stiffness,
    Torque,
    mm,
)

DISSERTATION = "Virtual Prototyping for Marine Crane Design and Operations, 2018, section 4.2.2 and appendix A"


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
    icon = symbols.SPRING_DAMPER
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
    icon = symbols.TORSIONAL_SPRING_DAMPER
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        s = m.state("twist", unit="rad", nominal=1e-2, about="twist of the shaft")
        slip = m.a.w - m.b.w
        yield m.der(s), slip
        yield m.a.T, self.stiffness * s + self.damping * slip
        yield m.a.T + m.b.T, 0
        m.stores(self.stiffness * s * slip)
        m.dissipates(self.damping * slip**2)


class RopeSpring(Component):
    """A rope: a spring and a damper that can pull but not push. S = max(k s + c ds/dt, 0) where s > 0, else 0.

        a ══════════ b        ds/dt = v_b - v_a;   S pulls a along +v and b along -v

    s is the stretch; below zero the rope hangs slack by -s. The damping comes in over the first `onset` of stretch, so
    that the force has no jump. Stores k s ds/dt; the rest is lost. Given both speeds, gives the force.
    """

    stiffness: Stiffness = parameter("stiffness k", least=0, most=1e13)
    damping: Damping = parameter("damping c", least=0, most=1e12)
    onset: Length = parameter("stretch over which the damping comes in", default=1 * mm, above=0, most=1)
    stretch: Length = initial("stretch at the start, slack below zero", least=-1e3, most=1e3)
    ports = {"a": Translational("one end"), "b": Translational("other end")}
    bond_graph = BondGraph(
        "between: 0, parting: 1, spring: C, damper: MR",
        "a -> between, between -> b, between -> parting, parting |-> spring, parting |-> damper",
    )
    icon = symbols.ROPE_SPRING
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        s = m.state("stretch", unit="m", start=self.stretch, nominal=1e-2, about="stretch of the rope")
        parting = m.b.v - m.a.v
        spring, force = one_sided(s, parting, self.stiffness, self.damping, self.onset)
        yield m.der(s), parting
        yield m.a.F, -force
        yield m.b.F, force
        m.stores(spring * parting)
        m.dissipates((force - spring) * parting)
        m.observe("pull", force, "N", "pull of the rope")


class EndStop(Component):
    """A stop: pushes two parts apart where they meet, and never holds them. F = max(k s + c ds/dt, 0) where s > 0.

        a ──►   gap   |◄── b        ds/dt = v_a - v_b;   F pushes a along -v and b along +v

    s is how far they have pressed into each other; -s is the gap. The damping comes in over the first `onset`. Stores
    k s ds/dt; the rest is lost. Given both speeds, gives the force.
    """

    stiffness: Stiffness = parameter("stiffness k", least=0, most=1e13)
    damping: Damping = parameter("damping c", least=0, most=1e12)
    onset: Length = parameter("depth over which the damping comes in", default=1 * mm, above=0, most=1)
    depth: Length = initial("depth at the start; the gap is -depth", least=-1e3, most=1e3)
    ports = {"a": Translational("part that comes"), "b": Translational("part that is met")}
    bond_graph = BondGraph(
        "between: 0, closing: 1, spring: C, damper: MR",
        "a -> between, between -> b, between -> closing, closing |-> spring, closing |-> damper",
    )
    icon = symbols.END_STOP
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        s = m.state("depth", unit="m", start=self.depth, nominal=1e-3, about="depth of the contact")
        closing = m.a.v - m.b.v
        spring, force = one_sided(s, closing, self.stiffness, self.damping, self.onset)
        yield m.der(s), closing
        yield m.a.F, force
        yield m.b.F, -force
        m.stores(spring * closing)
        m.dissipates((force - spring) * closing)


def one_sided(s: Any, rate: Any, stiffness: Any, damping: Any, onset: Any) -> tuple[Any, Any]:
    """The force of a spring that acts for s > 0 only, without and with its damper, which never turns it round."""
    spring = stiffness * maximum(s, 0.0)
    return spring, maximum(spring + damping * limit(s / onset, 0.0, 1.0) * rate, 0.0)


class RotationalFriction(Component):
    """Friction of a bearing against the ground: T = B w + T_c sign(w), the sign rounded within `friction_speed`."""

    viscous: RotationalDamping = parameter("viscous friction", least=0, most=1e12)
    coulomb: Torque = parameter("Coulomb friction torque", least=0, most=1e9)
    friction_speed: AngularSpeed = parameter("speed within which it turns its sign", default=1e-2, above=0, most=10)
    ports = {"flange": Rotational("shaft")}
    bond_graph = BondGraph("friction: R", "flange |-> friction")
    icon = symbols.FRICTION

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.flange.w
        yield m.flange.T, self.viscous * w + self.coulomb * smooth_sign(w, self.friction_speed)
        m.dissipates(m.flange.power)
