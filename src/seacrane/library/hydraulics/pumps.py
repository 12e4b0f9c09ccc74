"""Pumps: how pressure and flow at the outlet hang together, and pumps driven by a shaft.

A `Pump` stands for pump, drive and suction together: it draws its power from outside. A `ShaftPump` has a suction port
and a shaft, so that what drives it feels it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.errors import Problem
from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, MERRITT, WATTON
from seacrane.model import BondGraph, Component, Hydraulic, Rotational, SignalIn, parameter
from seacrane.numerics.regularise import limit, maximum, minimum, smooth_limit, smooth_sign
from seacrane.units import (
    Displacement,
    Leakage,
    Power,
    Pressure,
    Ratio,
    RotationalDamping,
    ShaftSpeed,
    Time,
    Torque,
    bar,
)

from .opening import ROUNDING, lagging


class Pump(Component):
    """A supply of oil with its drive.

          ▲ p          Levels:
        ( ▲ )          - `constant-flow`: q = D w, whatever the pressure
          │            - `constant-pressure`: p = pressure, whatever the flow
                       - `pressure-controlled`: full stroke, until the pressure comes near its setting
                       - `variable-flow`: q = k D w with a signal k, the port `gain`

    All levels have the outlet `p`; only `variable-flow` has another port. q counts out of the pump here, so that the
    port's flow is -q. D displacement [m3/rad], w shaft speed [rad/s]. Without a relief valve a pump that gives its
    flow has no bound of pressure.
    """

    ports = {"p": Hydraulic("outlet")}
    sources = (DISSERTATION,)


class ConstantFlowPump(Pump, level="constant-flow"):
    """A fixed-displacement pump at constant speed: q_out = D w, whatever the pressure. Given p, gives q."""

    displacement: Displacement = parameter("displacement", above=0, most=1e-2)
    speed: ShaftSpeed = parameter("shaft speed", least=0, most=1e3)
    bond_graph = BondGraph("supply: Sf", "supply |-> p")
    icon = symbols.PUMP_FIXED

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.q, -self.displacement * self.speed
        m.supplies(-m.p.power)


class ConstantPressurePump(Pump, level="constant-pressure"):
    """A supply that holds its pressure whatever flow is drawn: p = pressure.

    Stands for a pressure-controlled pump with enough flow. Given q, gives p.
    """

    pressure: Pressure = parameter("supply pressure (gauge)", least=0, most=1e8)
    bond_graph = BondGraph("supply: Se", "supply ->| p")
    icon = symbols.PUMP_CONSTANT_PRESSURE

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.p, self.pressure
        m.supplies(-m.p.power)


class PressureControlledPump(Pump, level="pressure-controlled"):
    """Strokes back near its setting: q_out = k D w, k = (pressure - p) / full_stroke held within [0, 1].

    At `pressure` the flow is zero, `full_stroke` below it the flow is full and stays so. Corners of k are rounded over
    1 % of full stroke. Given p, gives q. `full_stroke` is a few bar in a real controller: 10 bar by default.
    """

    displacement: Displacement = parameter("displacement", above=0, most=1e-2)
    speed: ShaftSpeed = parameter("shaft speed", least=0, most=1e3)
    pressure: Pressure = parameter("pressure (gauge) at which the flow has gone", above=0, most=1e8)
    full_stroke: Pressure = parameter(
        "how far below it the stroke is full",
        default=10 * bar,
        reason="pressure controllers: 5 to 15 bar",
        above=0,
        most=1e8,
    )
    bond_graph = BondGraph("supply: MSf", "supply |-> p, p ~> supply")
    icon = symbols.PUMP_PRESSURE_CONTROLLED

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        k = smooth_limit((self.pressure - m.p.p) / self.full_stroke, 0.0, 1.0, ROUNDING)
        yield m.p.q, -k * self.displacement * self.speed
        m.supplies(-m.p.power)
        m.observe("stroke", k, "1", "stroke, of full")


class VariableFlowPump(Pump, level="variable-flow"):
    """Stroked by a signal: q_out = k D w, k = `gain` held within [least_stroke, 1]. Given p, gives q.

    `least_stroke` is 0 for a pump of one direction, -1 for an over-centre pump, which can reverse its flow.
    """

    displacement: Displacement = parameter("displacement", above=0, most=1e-2)
    speed: ShaftSpeed = parameter("shaft speed", least=0, most=1e3)
    least_stroke: Ratio = parameter("least stroke, of full", default=0.0, least=-1, most=0)
    ports = {"gain": SignalIn("1", "stroke, of full", minimum=-1, maximum=1), "p": Hydraulic("outlet")}
    bond_graph = BondGraph("supply: MSf", "supply |-> p, gain ~> supply")
    icon = symbols.PUMP_VARIABLE

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.q, -limit(m.gain, self.least_stroke, 1.0) * self.displacement * self.speed
        m.supplies(-m.p.power)


# ---------------------------------------------------------------- load sensing
class LoadSensingPump(Component):
    """Holds its pressure a margin above that of the load: q_out = k D w.

             p    ls      k_s = (p_ref - p) / full_stroke held within [0, 1]
             │    ┊       p_ref = the smaller of p_ls + margin and the cut-off pressure
           ( ▲ )┄┄┘

    The port `ls` senses pressure and takes no flow: join it to a shuttle valve, with a small volume. At rest
    (p_ls = 0) the pump idles between margin - full_stroke and margin. Given both pressures, gives the flow. Levels:
    `static` (k = k_s) and `dynamic` (T k' + k = k_s).
    """

    displacement: Displacement = parameter("displacement", above=0, most=1e-2)
    speed: ShaftSpeed = parameter("shaft speed", least=0, most=1e3)
    cut_off: Pressure = parameter("highest pressure (gauge), whatever the load", above=0, most=1e8)
    margin: Pressure = parameter(
        "pressure kept above that of the load",
        default=20 * bar,
        reason="load-sensing controllers: 15 to 25 bar",
        above=0,
        most=1e8,
    )
    full_stroke: Pressure = parameter(
        "how far below its reference the stroke is full",
        default=5 * bar,
        reason="a fraction of the margin",
        above=0,
        most=1e8,
    )
    ports = {"p": Hydraulic("outlet"), "ls": Hydraulic("pressure of the load")}
    bond_graph = BondGraph("supply: MSf, sensing: Sf", "supply |-> p, ls ->| sensing, p ~> supply, ls ~> supply")
    icon = symbols.PUMP_LOAD_SENSING
    sources = (WATTON,)

    def stroke(self, m: Any) -> Any:
        """k_s at the pressures of this instant."""
        reference = minimum(m.ls.p + self.margin, self.cut_off)
        return smooth_limit((reference - m.p.p) / self.full_stroke, 0.0, 1.0, ROUNDING)

    def delivery(self, m: Any, stroke: Any) -> Iterator[tuple[Any, Any]]:
        """The flows at this stroke."""
        yield m.p.q, -stroke * self.displacement * self.speed
        yield m.ls.q, 0
        m.supplies(-m.p.power)
        m.observe("stroke", stroke, "1", "stroke, of full")


class StaticLoadSensingPump(LoadSensingPump, level="static"):
    """The stroke follows the pressures at once."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.delivery(m, self.stroke(m))


class DynamicLoadSensingPump(LoadSensingPump, level="dynamic"):
    """The swash plate follows with a lag: T k' + k = k_s. T is 30 to 100 ms in pumps of this kind."""

    time_constant: Time = parameter(
        "time constant of the swash plate", default=50e-3, reason="30 to 100 ms in pumps of this kind", above=0, most=10
    )

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        k = yield from lagging(m, "swash", self.stroke(m), self.time_constant, about="stroke, of full")
        yield from self.delivery(m, k)


# ---------------------------------------------------------------- driven by a shaft
class ShaftPump(Component):
    """A pressure-controlled pump on a shaft, which never asks for more than a given power.

              p             q_out = k D w - G dp,   dp = p_p - p_s
            ( ▲ )══ shaft   T = k D dp + B w + T_0 sign(w)         torque that turns it
              s             k = (pressure - dp) / full_stroke, held within [0, the smaller of 1 and P / (D w dp)]

    D displacement [m3/rad], G leakage, B viscous and T_0 Coulomb friction, P `power_limit`. Loses
    G dp^2 + (B w + T_0 sign(w)) w. Given pressures and speed, gives flows and torque.
    """

    displacement: Displacement = parameter("displacement", above=0, most=1e-2)
    pressure: Pressure = parameter("pressure over suction at which the flow has gone", above=0, most=1e8)
    full_stroke: Pressure = parameter(
        "how far below it the stroke is full",
        default=10 * bar,
        reason="pressure controllers: 5 to 15 bar",
        above=0,
        most=1e8,
    )
    power_limit: Power = parameter("most hydraulic power", above=0, most=1e8)
    leakage: Leakage = parameter("leakage from outlet to suction", default=0.0, least=0, most=1e-6)
    viscous_friction: RotationalDamping = parameter("viscous friction", default=0.0, least=0, most=1e6)
    coulomb_friction: Torque = parameter("Coulomb friction torque", default=0.0, least=0, most=1e6)
    friction_speed: ShaftSpeed = parameter(
        "speed within which friction turns its sign",
        default=0.1,
        reason="1 rpm, below working speeds",
        above=0,
        most=10,
    )
    ports = {"s": Hydraulic("suction"), "p": Hydraulic("outlet"), "shaft": Rotational("shaft")}
    bond_graph = BondGraph(
        "speed: 1, friction: R, displacement: MTF, drop: 0, leakage: R, through: 1",
        "shaft -> speed, speed |-> friction, speed -> displacement, displacement -> drop, drop ->| leakage,"
        "drop -> through, s -> through, through -> p, p ~> displacement, s ~> displacement, shaft ~> displacement",
    )
    icon = symbols.PUMP_SHAFT
    sources = (f"{MERRITT}, chapter 4",)

    def check(self) -> Iterator[Problem]:
        if self.full_stroke > self.pressure:
            what = f"{self.full_stroke / bar:g} bar must not be above pressure = {self.pressure / bar:g} bar"
            yield Problem("full_stroke", what)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        dp, w = m.p.p - m.s.p, m.shaft.w
        free = smooth_limit((self.pressure - dp) / self.full_stroke, 0.0, 1.0, ROUNDING)
        full_power = self.displacement * maximum(w * dp, 0.0)
        k = minimum(free, self.power_limit / maximum(full_power, self.power_limit))
        friction = self.viscous_friction * w + self.coulomb_friction * smooth_sign(w, self.friction_speed)
        torque = k * self.displacement * dp + friction
        yield m.p.q, self.leakage * dp - k * self.displacement * w
        yield m.s.q + m.p.q, 0
        yield m.shaft.T, torque
        m.dissipates(self.leakage * dp * dp + friction * w)
        m.observe("stroke", k, "1", "stroke, of full")
