"""Hydraulic motors: of fixed and of variable displacement."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, MERRITT
from seacrane.model import BondGraph, Component, Hydraulic, Rotational, SignalIn, parameter
from seacrane.numerics.regularise import limit, smooth_sign
from seacrane.units import Displacement, Leakage, Pressure, Ratio, RotationalDamping, ShaftSpeed, Torque

from .fluid import transition_pressure

_FIXED = BondGraph(
    "through: 1, drop: 0, leakage: R, displacement: TF, speed: 1, friction: R",
    "a -> through, through -> b, through -> drop, drop ->| leakage, drop -> displacement, displacement -> speed,"
    "speed |-> friction, speed -> shaft",
)
_VARIABLE = BondGraph(
    "through: 1, drop: 0, leakage: R, displacement: MTF, speed: 1, friction: R",
    "a -> through, through -> b, through -> drop, drop ->| leakage, drop -> displacement, displacement -> speed,"
    "speed |-> friction, speed -> shaft, r ~> displacement",
)


class _Motor(Component):
    """What all motors share: the law around a displacement, a leakage and a friction torque."""

    displacement: Displacement = parameter("displacement", above=0, most=1e-2)
    count: Ratio = parameter("number of equal motors on the shaft", default=1, above=0, most=100)
    friction_speed: ShaftSpeed = parameter(
        "speed within which friction turns its sign",
        default=0.1,
        reason="1 rpm, below working speeds",
        above=0,
        most=10,
    )
    sources = (f"{MERRITT}, chapter 4", DISSERTATION)

    def turning(self, m: Any, stroke: Any, leakage: Any, friction: Any) -> Iterator[tuple[Any, Any]]:
        """The laws of the ports, at `stroke` of the full displacement; leakage [m3/(s.Pa)], friction [N.m]."""
        dp, w, d = m.a.p - m.b.p, m.shaft.w, stroke * self.displacement
        torque = self.count * (d * dp - friction)
        yield m.a.q, self.count * (d * w + leakage * dp)
        yield m.a.q + m.b.q, 0
        yield m.shaft.T, -torque
        m.dissipates(self.count * (leakage * dp * dp + friction * w))
        m.observe("torque", torque, "N.m", "torque on the load")
        m.observe("pressure_drop", dp, "Pa", "pressure from a to b")


class _FrictionLosses(_Motor):
    """Losses given as leakage and friction."""

    leakage: Leakage = parameter("leakage between the ports", default=0.0, least=0, most=1e-6)
    viscous_friction: RotationalDamping = parameter("viscous friction", default=0.0, least=0, most=1e6)
    coulomb_friction: Torque = parameter("Coulomb friction torque", default=0.0, least=0, most=1e6)

    def with_losses(self, m: Any, stroke: Any) -> Iterator[tuple[Any, Any]]:
        w = m.shaft.w
        friction = self.viscous_friction * w + self.coulomb_friction * smooth_sign(w, self.friction_speed)
        yield from self.turning(m, stroke, self.leakage, friction)


class _EfficiencyLosses(_Motor):
    """Losses given as efficiencies at full stroke, at a rated pressure and speed."""

    volumetric_efficiency: Ratio = parameter(
        "volumetric efficiency at the rated point",
        default=0.95,
        reason="axial piston motors: 0.93 to 0.97",
        above=0,
        most=1,
    )
    mechanical_efficiency: Ratio = parameter(
        "mechanical efficiency at full stroke",
        default=0.93,
        reason="axial piston motors: 0.90 to 0.95",
        above=0,
        most=1,
    )
    rated_pressure: Pressure = parameter("pressure drop of the rated point", above=0, most=1e8)
    rated_speed: ShaftSpeed = parameter("speed of the rated point", above=0, most=1e4)
    transition_pressure: Pressure = transition_pressure()

    def with_losses(self, m: Any, stroke: Any) -> Iterator[tuple[Any, Any]]:
        dp, w = m.a.p - m.b.p, m.shaft.w
        ideal = self.displacement * self.rated_speed
        leakage = ideal * (1 / self.volumetric_efficiency - 1) / self.rated_pressure
        size = dp * smooth_sign(dp, self.transition_pressure)
        lost = (1 - self.mechanical_efficiency) * self.displacement * size
        yield from self.turning(m, stroke, leakage, lost * smooth_sign(w, self.friction_speed))


# ---------------------------------------------------------------- fixed displacement
class HydraulicMotor(_Motor):
    """A fixed-displacement motor: pressure makes torque, speed takes flow.

        a ──►(M)──► b       flow            q = n (D w + G dp),   dp = p_a - p_b
               ║            torque on load  T = n (D dp - T_f)
             shaft          w > 0: oil goes from a to b

    D displacement [m3/rad], G leakage between the ports [m3/(s.Pa)], T_f friction, n = `count` equal motors on one
    shaft. Driven by the load, it pumps. Loses n (G dp^2 + T_f w). Given the pressures and the speed, gives flows and
    torque. Levels:

    - `friction`: T_f = B w + T_c sign(w), with G, B and T_c given, of one motor.
    - `efficiency`: T_f = (1 - eta_m) D |dp| sign(w) and G = D w_r (1 / eta_v - 1) / p_r, from a data sheet: at
      the rated pressure p_r and speed w_r it takes D w / eta_v and, at any pressure, gives eta_m D dp.

    Signs are rounded: of w within `friction_speed`, of dp within the transition pressure.
    """

    ports = {"a": Hydraulic("inlet at w > 0"), "b": Hydraulic("outlet at w > 0"), "shaft": Rotational("shaft")}
    bond_graph = _FIXED
    icon = symbols.MOTOR


class FrictionHydraulicMotor(HydraulicMotor, _FrictionLosses, level="friction"):
    """B viscous, T_c Coulomb friction and G leakage of one motor; see the interface."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.with_losses(m, 1.0)


class EfficiencyHydraulicMotor(HydraulicMotor, _EfficiencyLosses, level="efficiency"):
    """Efficiencies eta_v and eta_m of the rated point; see the interface."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.with_losses(m, 1.0)


# ---------------------------------------------------------------- variable displacement
class VariableHydraulicMotor(_Motor):
    """A motor whose displacement a signal sets: `HydraulicMotor` with r D in the place of D.

              r
              ┊             q = n (r D w + G dp)
        a ──►(M↗)──► b      T = n (r D dp - T_f)
               ║
             shaft          r is held within [least_stroke, 1]

    At r < 0 it turns the other way round; `least_stroke` is then -1. At r = 0 it turns freely: let it not be there
    under load, or it overspeeds. Leakage and friction are those of full stroke. Levels as those of `HydraulicMotor`.
    """

    least_stroke: Ratio = parameter(
        "least stroke, of full", default=-1.0, reason="over-centre, as for a closed circuit", least=-1, below=1
    )
    ports = {
        "r": SignalIn("1", "stroke, of full", minimum=-1, maximum=1),
        "a": Hydraulic("inlet at w > 0 and r > 0"),
        "b": Hydraulic("outlet at w > 0 and r > 0"),
        "shaft": Rotational("shaft"),
    }
    bond_graph = _VARIABLE
    icon = symbols.VARIABLE_MOTOR

    def stroke(self, m: Any) -> Any:
        """r within its limits."""
        return limit(m.r, self.least_stroke, 1.0)


class FrictionVariableHydraulicMotor(VariableHydraulicMotor, _FrictionLosses, level="friction"):
    """B viscous, T_c Coulomb friction and G leakage of one motor; see `HydraulicMotor`."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.with_losses(m, self.stroke(m))


class EfficiencyVariableHydraulicMotor(VariableHydraulicMotor, _EfficiencyLosses, level="efficiency"):
    """Efficiencies eta_v and eta_m of the rated point at full stroke; see `HydraulicMotor`."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.with_losses(m, self.stroke(m))
