"""Hydraulic motors."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.library import symbols
from seacrane.model import BondGraph, Component, Hydraulic, Rotational, parameter
from seacrane.numerics.regularise import smooth_sign
from seacrane.units import AngularSpeed, Displacement, Leakage, Ratio, RotationalDamping, Torque

from .fluid import DISSERTATION, MERRITT


class HydraulicMotor(Component):
    """A fixed-displacement motor: pressure makes torque, speed takes flow.

        a ──►(M)──► b       flow            q = n (D w + G dp),   dp = p_a - p_b
               ║            torque on load  T = n (D dp - B w - T_c sign(w))
             shaft          w > 0: oil goes from a to b

    D displacement [m3/rad], G leakage between the ports [m3/(s.Pa)], B viscous and T_c Coulomb friction (its sign
    rounded within `friction_speed`), n = `count` equal motors on one shaft; B and T_c are those of one. Driven by the
    load, it pumps. Loses n (G dp^2 + B w^2 + T_c |w|). Given the pressures and the speed, gives flows and torque.
    """

    displacement: Displacement = parameter("displacement", above=0, most=1e-2)
    count: Ratio = parameter("number of equal motors on the shaft", default=1, above=0, most=100)
    leakage: Leakage = parameter("leakage between the ports", default=0.0, least=0, most=1e-6)
    viscous_friction: RotationalDamping = parameter("viscous friction", default=0.0, least=0, most=1e6)
    coulomb_friction: Torque = parameter("Coulomb friction torque", default=0.0, least=0, most=1e6)
    friction_speed: AngularSpeed = parameter(
        "speed within which friction turns its sign", default=0.1, above=0, most=10
    )
    ports = {"a": Hydraulic("inlet at w > 0"), "b": Hydraulic("outlet at w > 0"), "shaft": Rotational("shaft")}
    bond_graph = BondGraph(
        "through: 1, drop: 0, leakage: R, displacement: TF, speed: 1, friction: R",
        "a -> through, through -> b, through -> drop, drop ->| leakage, drop -> displacement, displacement -> speed,"
        "speed |-> friction, speed -> shaft",
    )
    icon = symbols.MOTOR
    sources = (f"{MERRITT}, chapter 4", DISSERTATION)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        dp, w = m.a.p - m.b.p, m.shaft.w
        friction = self.viscous_friction * w + self.coulomb_friction * smooth_sign(w, self.friction_speed)
        torque = self.count * (self.displacement * dp - friction)
        yield m.a.q, self.count * (self.displacement * w + self.leakage * dp)
        yield m.a.q + m.b.q, 0
        yield m.shaft.T, -torque
        m.dissipates(self.count * (self.leakage * dp * dp + friction * w))
        m.observe("torque", torque, "N.m", "torque on the load")
        m.observe("pressure_drop", dp, "Pa", "pressure from a to b")
