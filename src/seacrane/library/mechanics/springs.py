"""Springs, dampers, ropes, end stops and friction."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import Any

from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, OLSSON
from seacrane.model import BondGraph, Component, Rotational, Translational, initial, parameter
from seacrane.numerics.regularise import limit, maximum, smooth_sign
from seacrane.units import (
    Angle,
    AngularSpeed,
    Damping,
    Length,
    RotationalDamping,
    RotationalStiffness,
    Stiffness,
    Torque,
    mm,
)


# ---------------------------------------------------------------- springs and dampers
def _joined(m: Any, spring: Any = 0, damping: Any = 0) -> Iterator[tuple[Any, Any]]:
    """The ports `a` and `b` of a spring with the force `spring` [N or N.m] beside a damper, in either domain."""
    closing = m.a.across - m.b.across
    yield m.a.through, spring + damping * closing
    yield m.a.through + m.b.through, 0
    m.stores(spring * closing)
    m.dissipates(damping * closing**2)


_BOTH = BondGraph(
    "between: 0, closing: 1, spring: C, damper: R",
    "a -> between, between -> b, between -> closing, closing |-> spring, closing |-> damper",
)
_SPRING = BondGraph("between: 0, spring: C", "a -> between, between -> b, between |-> spring")
_DAMPER = BondGraph("between: 0, damper: R", "a -> between, between -> b, between |-> damper")


class _Stiff(Component):
    """The parameters of a spring on a line."""

    stiffness: Stiffness = parameter("stiffness k", least=0, most=1e13)
    compression: Length = initial("compression at the start", least=-1e3, most=1e3)

    def spring(self, m: Any) -> Generator[tuple[Any, Any], None, Any]:
        """The law of the compression s; returns the force k s."""
        s = m.state("compression", unit="m", start=self.compression, nominal=1e-2, about="compression of the spring")
        yield m.der(s), m.a.v - m.b.v
        return self.stiffness * s


class _Damped(Component):
    """The parameter of a damper on a line."""

    damping: Damping = parameter("damping c", least=0, most=1e12)


class SpringDamper(Component):
    """A spring and a damper side by side: F = k s + c (v_a - v_b), ds/dt = v_a - v_b.

        a ──┬─/\\/\\/─┬── b      F pushes a along +v; s is how far a has come towards b
            └──[|──┘

    Levels: `both`, `spring` (c = 0) and `damper` (k = 0, no state). Stores k s ds/dt, loses c (v_a - v_b)^2. It pushes
    and pulls; see `RopeSpring` for one that only pulls, `EndStop` for one that only pushes. Given both speeds, gives
    the force.
    """

    ports = {"a": Translational("one end"), "b": Translational("other end")}
    bond_graph = _BOTH
    icon = symbols.SPRING_DAMPER
    sources = (DISSERTATION,)


class BothSpringDamper(SpringDamper, _Stiff, _Damped, level="both"):
    """Spring and damper side by side."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        force = yield from self.spring(m)
        yield from _joined(m, force, self.damping)


class SpringOnly(SpringDamper, _Stiff, level="spring"):
    """F = k s."""

    bond_graph = _SPRING
    icon = symbols.SPRING

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        force = yield from self.spring(m)
        yield from _joined(m, force)


class DamperOnly(SpringDamper, _Damped, level="damper"):
    """F = c (v_a - v_b)."""

    bond_graph = _DAMPER
    icon = symbols.DAMPER

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from _joined(m, damping=self.damping)


class _TorsionallyStiff(Component):
    """The parameters of a spring that twists."""

    stiffness: RotationalStiffness = parameter("stiffness k", least=0, most=1e13)
    twist: Angle = initial("twist at the start", least=-100, most=100)

    def spring(self, m: Any) -> Generator[tuple[Any, Any], None, Any]:
        """The law of the twist s; returns the torque k s."""
        s = m.state("twist", unit="rad", start=self.twist, nominal=1e-2, about="twist of the shaft")
        yield m.der(s), m.a.w - m.b.w
        return self.stiffness * s


class _TorsionallyDamped(Component):
    """The parameter of a damper that twists."""

    damping: RotationalDamping = parameter("damping c", least=0, most=1e12)


class TorsionalSpringDamper(Component):
    """A shaft that twists: T = k s + c (w_a - w_b), ds/dt = w_a - w_b. As `SpringDamper`, in rotation.

    Levels: `both`, `spring` (c = 0) and `damper` (k = 0, no state).
    """

    ports = {"a": Rotational("one end"), "b": Rotational("other end")}
    bond_graph = _BOTH
    icon = symbols.TORSIONAL_SPRING_DAMPER
    sources = (DISSERTATION,)


class BothTorsionalSpringDamper(TorsionalSpringDamper, _TorsionallyStiff, _TorsionallyDamped, level="both"):
    """Spring and damper side by side."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        torque = yield from self.spring(m)
        yield from _joined(m, torque, self.damping)


class TorsionalSpringOnly(TorsionalSpringDamper, _TorsionallyStiff, level="spring"):
    """T = k s."""

    bond_graph = _SPRING

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        torque = yield from self.spring(m)
        yield from _joined(m, torque)


class TorsionalDamperOnly(TorsionalSpringDamper, _TorsionallyDamped, level="damper"):
    """T = c (w_a - w_b)."""

    bond_graph = _DAMPER

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from _joined(m, damping=self.damping)


# ---------------------------------------------------------------- one-sided
class RopeSpring(Component):
    """A rope: a spring and a damper that can pull but not push. S = max(k s + c ds/dt, 0) where s > 0, else 0.

        a ══════════ b        ds/dt = v_b - v_a;   S pulls a along +v and b along -v

    s is the stretch; below zero the rope hangs slack by -s. The damping comes in over the first `onset` of stretch, so
    that the force has no jump. Stores k s ds/dt; the rest is lost. Given both speeds, gives the force.
    """

    stiffness: Stiffness = parameter("stiffness k", least=0, most=1e13)
    damping: Damping = parameter("damping c", least=0, most=1e12)
    onset: Length = parameter(
        "stretch over which the damping comes in",
        default=1 * mm,
        reason="small beside the stretch under load",
        above=0,
        most=1,
    )
    stretch: Length = initial("stretch at the start, slack below zero", least=-1e3, most=1e3)
    ports = {"a": Translational("one end"), "b": Translational("other end")}
    bond_graph = BondGraph(
        "between: 0, parting: 1, spring: C, damper: MR",
        "a -> between, between -> b, between -> parting, parting |-> spring, parting |-> damper, spring ~> damper",
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
    onset: Length = parameter(
        "depth over which the damping comes in",
        default=1 * mm,
        reason="small beside the depth under load",
        above=0,
        most=1,
    )
    depth: Length = initial("depth at the start; the gap is -depth", least=-1e3, most=1e3)
    ports = {"a": Translational("part that comes"), "b": Translational("part that is met")}
    bond_graph = BondGraph(
        "between: 0, closing: 1, spring: C, damper: MR",
        "a -> between, between -> b, between -> closing, closing |-> spring, closing |-> damper, spring ~> damper",
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


# ---------------------------------------------------------------- friction
class RotationalFriction(Component):
    """Friction of a bearing against the ground: T = B w + T_c sign(w), the sign rounded within `friction_speed`."""

    viscous: RotationalDamping = parameter("viscous friction", least=0, most=1e12)
    coulomb: Torque = parameter("Coulomb friction torque", least=0, most=1e9)
    friction_speed: AngularSpeed = parameter(
        "speed within which it turns its sign",
        default=1e-2,
        reason="0.1 rpm, below working speeds of slewing gears",
        above=0,
        most=10,
    )
    ports = {"flange": Rotational("shaft")}
    bond_graph = BondGraph("friction: R", "flange |-> friction")
    icon = symbols.FRICTION
    sources = (OLSSON,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.flange.w
        yield m.flange.T, self.viscous * w + self.coulomb * smooth_sign(w, self.friction_speed)
        m.dissipates(m.flange.power)
