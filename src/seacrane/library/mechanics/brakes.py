"""Brakes."""

from __future__ import annotations

from collections.abc import Iterator
from math import copysign
from typing import Any

from seacrane.library import symbols
from seacrane.model import BondGraph, Component, Rotational, SignalIn, initial, parameter
from seacrane.numerics.regularise import limit
from seacrane.units import AngularSpeed, Inertia, Ratio, Torque

KARNOPP = (
    "D. Karnopp, Computer simulation of stick-slip friction in mechanical dynamic systems,"
    " Journal of Dynamic Systems, Measurement, and Control 107, 1985"
)


class HoldingBrake(Component):
    """A friction brake between a shaft and the ground that does not creep: a spring applies it, a signal opens it.

             release
          ┌─────┴─────┐     slipping:  J dw/dt = T - s T_b,   s = 1 or -1 as the shaft turns
    shaft═╡  ▐▌ ▐▌ ▐▌ │     held:      w = 0,                 as long as |T| <= static_ratio T_b
          └─────┬─────┘
               ─┴─          T_b = capacity (1 - release)

    T is the torque of the shaft on the brake, J the inertia of its disc. Sticking and slipping begin at located
    instants, so that a held load stays where it is, which it does not under a friction that is rounded at zero speed
    (`RotationalFriction`). Loses T_b |w|. Given the torque, gives the speed: a shaft whose speed is given from outside
    needs a `TorsionalSpringDamper` before its brake.
    """

    capacity: Torque = parameter("friction torque when it is applied", above=0, most=1e9)
    static_ratio: Ratio = parameter("friction at rest over that in motion", default=1.0, least=1, most=3)
    inertia: Inertia = parameter("inertia of the disc", above=0, most=1e6)
    speed: AngularSpeed = initial("speed at the start", least=-1e4, most=1e4)
    ports = {
        "shaft": Rotational("shaft that is held"),
        "release": SignalIn("1", "0 applied, 1 open", minimum=0, maximum=1),
    }
    bond_graph = BondGraph(
        "motion: 1, inertia: I, friction: MR",
        "shaft -> motion, motion ->| inertia, motion |-> friction, release ~> friction",
    )
    icon = symbols.HOLDING_BRAKE
    sources = (KARNOPP,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.state("speed", unit="rad/s", start=self.speed, nominal=10.0, about="speed of the disc")
        way = m.mode("slip", start=copysign(1, self.speed) if self.speed else 0, about="1 or -1 as it slips, 0 held")
        slips, torque = way**2, m.shaft.T
        friction = self.capacity * limit(1 - m.release, 0.0, 1.0)
        yield m.shaft.w, slips * w
        yield self.inertia * m.der(w), slips * (torque - way * friction)
        m.stores(self.inertia * slips * w * m.der(w))
        m.dissipates(slips * way * friction * w)
        m.observe("torque", slips * way * friction + (1 - slips) * torque, "N.m", "torque of the brake on the shaft")
        held = self.static_ratio * friction
        for name, sign in (("slips", 1), ("slips_back", -1)):
            about = f"torque rises above what the brake holds, {'forwards' if sign > 0 else 'backwards'}"
            m.when(name, (1 - slips) * (sign * torque - held) / self.capacity, (way, sign), about=about)
        m.when("sticks", -way * w, (way, 0), (w, 0), about="the shaft comes to rest")
