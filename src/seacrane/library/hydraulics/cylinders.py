"""Cylinders: double-acting and single-acting."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any, ClassVar

import casadi as ca

from seacrane.errors import Problem
from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, MERRITT, OLSSON
from seacrane.model import BondGraph, Component, Hydraulic, Translational, initial, parameter
from seacrane.numerics.regularise import limit, maximum, smooth_sign
from seacrane.units import (
    Area,
    Damping,
    Density,
    Diameter,
    Force,
    Leakage,
    Length,
    Pressure,
    Ratio,
    Speed,
    Stiffness,
    mm,
)

from .fluid import bulk_modulus, density, orifice_flow, transition_pressure


class _Losses(Component):
    """What the extended levels share: friction of the seals and end stops."""

    viscous_friction: Damping = parameter("viscous friction", default=0.0, least=0, most=1e9)
    coulomb_friction: Force = parameter("Coulomb friction", default=0.0, least=0, most=1e8)
    static_friction: Force = parameter("what friction at rest exceeds it by", default=0.0, least=0, most=1e8)
    friction_speed: Speed = parameter(
        "speed within which friction turns its sign",
        default=2e-3,
        reason="well below working speeds, and not stiffer than the oil",
        above=0,
        most=1,
    )
    stribeck_speed: Speed = parameter(
        "speed at which static friction has faded", default=10e-3, reason="seals: 5 to 20 mm/s", above=0, most=10
    )
    stop_stiffness: Stiffness = parameter(
        "stiffness of an end stop",
        default=2e8,
        reason="yields 1 to 10 mm under the force of a crane cylinder",
        above=0,
        most=1e13,
    )
    stop_damping: Damping = parameter(
        "damping of an end stop",
        default=1e6,
        reason="a third of critical with 10 t",
        least=0,
        most=1e12,
    )

    def friction(self, v: Any) -> Any:
        """F_f [N] at speed v."""
        dry = self.coulomb_friction + self.static_friction * ca.exp(-((v / self.stribeck_speed) ** 2))
        return self.viscous_friction * v + dry * smooth_sign(v, self.friction_speed)

    def stops(self, x: Any, v: Any, stroke: Any) -> tuple[Any, Any]:
        """Force F_s [N] of the end stops on the piston, and the power [W] that goes into their springs."""
        low, high = maximum(-x, 0.0), maximum(x - stroke, 0.0)
        spring = self.stop_stiffness * (low - high)
        push = maximum(self.stop_stiffness * low - self.stop_damping * limit(low / mm, 0.0, 1.0) * v, 0.0)
        pull = maximum(self.stop_stiffness * high + self.stop_damping * limit(high / mm, 0.0, 1.0) * v, 0.0)
        return push - pull, -spring * v


class DoubleActingCylinder(Component):
    """A double-acting cylinder, or `count` equal ones side by side.

          ┌──────────┬──────────────┐
          │  p_a     ║   p_b  ══════╪══════►  rod: extending is positive
          └─┬────────┴───────────┬──┘
            a (piston side)      b (rod side)

    Areas A = pi/4 bore^2 on the piston side and B = pi/4 (bore^2 - rod^2) on the rod side, per cylinder. Port flows and
    the rod force are those of all `count` cylinders together; pressures, the extension and the law are those of one.
    Extension x is 0 fully retracted and `stroke` fully extended. Levels:

    - `simplified`: incompressible and without loss: F = A p_a - B p_b, q_a = A v, q_b = -B v. State: x.
    - `extended`: port orifices, compressible chambers, leakage, friction and end stops. States: x, p_a, p_b.

    Both report `force` [N] on the load, `extension` [m], `pressure_a` and `pressure_b` [Pa] of the chambers. Given the
    rod speed and the port pressures, they give the rod force and the port flows.
    """

    bore: Diameter = parameter("piston diameter", above=0, most=5)
    rod: Diameter = parameter("rod diameter", above=0, most=5)
    stroke: Length = parameter("stroke", above=0, most=50)
    count: Ratio = parameter("number of equal cylinders side by side", default=1, above=0, most=100)
    extension: Length = initial("extension at the start, from fully retracted", least=-0.1, most=50)
    ports = {
        "a": Hydraulic("piston side"),
        "b": Hydraulic("rod side"),
        "rod": Translational("rod eye; extending is positive"),
    }
    bond_graph = BondGraph(
        "piston_side: TF, rod_side: TF, piston: 1",
        "a -> piston_side, piston_side -> piston, piston -> rod_side, rod_side -> b, piston -> rod",
    )
    icon = symbols.DOUBLE_ACTING_CYLINDER
    sources: ClassVar[tuple[str, ...]] = (f"{MERRITT}, chapter 6", DISSERTATION)

    def check(self) -> Iterator[Problem]:
        if self.rod >= self.bore:
            yield Problem("rod", f"{self.rod / mm:g} mm must be below bore = {self.bore / mm:g} mm")
        if self.extension > self.stroke:
            yield Problem("extension", f"{self.extension:g} m must not be above stroke = {self.stroke:g} m")

    @property
    def piston_area(self) -> Area:
        """A [m2], of one cylinder."""
        return pi / 4 * self.bore**2

    @property
    def annulus_area(self) -> Area:
        """B [m2], of one cylinder."""
        return pi / 4 * (self.bore**2 - self.rod**2)

    def extension_state(self, m: Any) -> Any:
        """x [m], which follows the rod."""
        return m.state("extension", unit="m", start=self.extension, about="extension from fully retracted")

    def pushing(self, m: Any, force: Any) -> Iterator[tuple[Any, Any]]:
        """`force` of one cylinder on the load."""
        yield m.rod.F, -self.count * force
        m.observe("force", self.count * force, "N", "force on the load, extending is positive")


class SimplifiedDoubleActingCylinder(DoubleActingCylinder, level="simplified"):
    """Incompressible, lossless, without end stops; see the interface."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        a, b, v = self.piston_area, self.annulus_area, m.rod.v
        yield m.der(self.extension_state(m)), v
        yield m.a.q, self.count * a * v
        yield m.b.q, -self.count * b * v
        yield from self.pushing(m, a * m.a.p - b * m.b.p)
        m.observe("pressure_a", m.a.p, "Pa", "pressure on the piston side")
        m.observe("pressure_b", m.b.p, "Pa", "pressure on the rod side")


class ExtendedDoubleActingCylinder(DoubleActingCylinder, _Losses, level="extended"):
    """Compressible chambers behind port orifices, with leakage, friction and end stops; per cylinder:

        q_a = orifice(p_port_a - p_a)           q_b = orifice(p_port_b - p_b)          (`port_diameter`, `discharge`)
        dp_a/dt = beta / V_a (q_a - A v - G (p_a - p_b))         V_a = A (h + x)
        dp_b/dt = beta / V_b (q_b + B v + G (p_a - p_b))         V_b = B (h + stroke - x)
        F = A p_a - B p_b - F_f(v) + F_s(x, v)
        F_f = f v + (F_c + F_e exp(-(v / v_s)^2)) sign(v)        sign rounded within `friction_speed`
        F_s = k s - c v beyond retracted (s = -x), -(k s + c v) beyond extended (s = x - stroke), never pulling

    h is the height of oil left at each end (`dead_length`), G the piston leakage, f viscous and F_c Coulomb friction,
    F_e what friction at rest exceeds it by (Stribeck, fading with v_s), k and c the stiffness and damping of the end
    stops; c fades in over the first millimetre. Over the last `cushion_length` of the stroke a cushion throttles what
    flows out of the chamber that closes, down to `cushion_opening` of its port; oil flows in freely, past a check
    valve. There is no friction and no cushion unless it is given. Locked in, the oil column of
    height h + x has the stiffness beta A / (h + x). Chambers store p_a (V_a / beta) dp_a/dt + p_b (V_b / beta) dp_b/dt.
    """

    sources = (*DoubleActingCylinder.sources, f"{OLSSON} (friction)")

    port_diameter: Diameter = parameter(
        "bore of each port", default=32 * mm, reason="5 m/s at 240 l/min", above=0, most=1
    )
    discharge: Ratio = parameter(
        "discharge coefficient of the ports", default=0.7, reason="rounded edges; 0.61 for sharp ones", above=0, most=1
    )
    dead_length: Length = parameter(
        "height of oil left at each end of the stroke",
        default=30 * mm,
        reason="port bores and clearances",
        above=0,
        most=10,
    )
    leakage: Leakage = parameter(
        "leakage past the piston",
        default=1e-14,
        reason="18 ml/min at 300 bar; keeps a plugged side determined",
        least=0,
        most=1e-6,
    )
    cushion_length: Length = parameter(
        "way over which a cushion closes",
        default=50 * mm,
        reason="as cushions of large cylinders are long",
        above=0,
        most=10,
    )
    cushion_opening: Ratio = parameter("opening a cushion leaves to outflow, of a port", default=1.0, above=0, most=1)
    density: Density = density()
    bulk_modulus: Pressure = bulk_modulus()
    transition_pressure: Pressure = transition_pressure()
    pressure_a: Pressure = initial("piston-side pressure at the start (gauge)", least=-1e5, most=1e8)
    pressure_b: Pressure = initial("rod-side pressure at the start (gauge)", least=-1e5, most=1e8)
    bond_graph = BondGraph(
        "in_a: 1, port_a: R, chamber_a: 0, oil_a: C, piston_side: TF, past: 1, leakage: R,"
        "piston: 1, friction: R, stop: C, stop_damping: R, rod_side: TF, chamber_b: 0, oil_b: C, out_b: 1, port_b: R",
        "a -> in_a, in_a ->| port_a, in_a -> chamber_a, chamber_a |-> oil_a, chamber_a -> piston_side,"
        "piston_side -> piston, piston |-> friction, piston |-> stop, piston |-> stop_damping, piston -> rod,"
        "piston -> rod_side, rod_side -> chamber_b, chamber_b |-> oil_b, chamber_a -> past, past ->| leakage,"
        "past -> chamber_b, chamber_b -> out_b, out_b ->| port_b, out_b -> b",
    )

    def port_flow(self, dp: Any, from_end: Any) -> Any:
        """Flow into a chamber whose end is `from_end` [m] away from the piston, under the drop dp at its port."""
        port = pi / 4 * self.port_diameter**2
        throttled = self.cushion_opening + (1 - self.cushion_opening) * limit(from_end / self.cushion_length, 0.0, 1.0)
        outward = (1 - smooth_sign(dp, self.transition_pressure)) / 2
        area = port * (1 - (1 - throttled) * outward)
        return orifice_flow(dp, area, self.discharge, self.density, self.transition_pressure)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        a, b, n, v = self.piston_area, self.annulus_area, self.count, m.rod.v
        x = self.extension_state(m)
        p_a = m.state("pressure_a", unit="Pa", start=self.pressure_a, nominal=1e6, about="piston-side pressure")
        p_b = m.state("pressure_b", unit="Pa", start=self.pressure_b, nominal=1e6, about="rod-side pressure")
        dp_a, dp_b = m.a.p - p_a, m.b.p - p_b
        q_a, q_b = self.port_flow(dp_a, x), self.port_flow(dp_b, self.stroke - x)
        q_leak = self.leakage * (p_a - p_b)
        inside = limit(x, 0.0, self.stroke)
        squeezed_a, squeezed_b = q_a - a * v - q_leak, q_b + b * v + q_leak
        friction = self.friction(v)
        stop, stop_stores = self.stops(x, v, self.stroke)
        yield m.a.q, n * q_a
        yield m.b.q, n * q_b
        yield m.der(x), v
        yield m.der(p_a), self.bulk_modulus / (a * (self.dead_length + inside)) * squeezed_a
        yield m.der(p_b), self.bulk_modulus / (b * (self.dead_length + self.stroke - inside)) * squeezed_b
        yield from self.pushing(m, a * p_a - b * p_b - friction + stop)
        m.stores(n * (p_a * squeezed_a + p_b * squeezed_b + stop_stores))
        m.dissipates(n * (q_a * dp_a + q_b * dp_b + q_leak * (p_a - p_b) + friction * v - stop * v - stop_stores))


# ---------------------------------------------------------------- single-acting
class SingleActingCylinder(Component):
    """A cylinder that oil extends and its load retracts (a plunger, or a piston with the rod side open to the air).

          ┌──────────┬─────────────
          │    p     ║ ═════════════►  rod: extending is positive
          └─┬────────┴─────────────
            a

    A = pi/4 bore^2 of one of `count` equal cylinders side by side; flow and force are those of all. Extension x is 0
    fully retracted and `stroke` fully extended. Levels:

    - `simplified`: incompressible and without loss: F = A p, q = A v. State: x.
    - `extended`: compressible oil, friction and end stops. States: x, p.

    It can push only: where the load pulls, the pressure falls below vacuum unless oil is let in. Reports `force` [N] on
    the load, `extension` [m] and `pressure` [Pa].
    """

    bore: Diameter = parameter("diameter of piston or plunger", above=0, most=5)
    stroke: Length = parameter("stroke", above=0, most=50)
    count: Ratio = parameter("number of equal cylinders side by side", default=1, above=0, most=100)
    extension: Length = initial("extension at the start, from fully retracted", least=-0.1, most=50)
    ports = {"a": Hydraulic("oil in"), "rod": Translational("rod eye; extending is positive")}
    bond_graph = BondGraph("piston: TF", "a -> piston, piston -> rod")
    icon = symbols.SINGLE_ACTING_CYLINDER
    sources: ClassVar[tuple[str, ...]] = (f"{MERRITT}, chapter 6", DISSERTATION)

    def check(self) -> Iterator[Problem]:
        if self.extension > self.stroke:
            yield Problem("extension", f"{self.extension:g} m must not be above stroke = {self.stroke:g} m")

    @property
    def area(self) -> Area:
        """A [m2], of one cylinder."""
        return pi / 4 * self.bore**2

    def extension_state(self, m: Any) -> Any:
        """x [m], which follows the rod."""
        return m.state("extension", unit="m", start=self.extension, about="extension from fully retracted")

    def pushing(self, m: Any, force: Any) -> Iterator[tuple[Any, Any]]:
        """`force` of one cylinder on the load."""
        yield m.rod.F, -self.count * force
        m.observe("force", self.count * force, "N", "force on the load, extending is positive")


class SimplifiedSingleActingCylinder(SingleActingCylinder, level="simplified"):
    """Incompressible, lossless, without end stops. Given speed and pressure, gives flow and force."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.der(self.extension_state(m)), m.rod.v
        yield m.a.q, self.count * self.area * m.rod.v
        yield from self.pushing(m, self.area * m.a.p)
        m.observe("pressure", m.a.p, "Pa", "pressure in the cylinder")


class ExtendedSingleActingCylinder(SingleActingCylinder, _Losses, level="extended"):
    """Compressible, with friction and end stops as those of `ExtendedDoubleActingCylinder`; per cylinder:

        dp/dt = beta / V (q - A v)        V = A (h + x), x held within the stroke
        F = A p - F_f(v) + F_s(x, v)

    h is the height of oil left at the end (`dead_length`). Locked in, the column has the stiffness beta A / (h + x).
    Stores p (V / beta) dp/dt. Given the flow and the speed, gives pressure and force.
    """

    dead_length: Length = parameter(
        "height of oil left when it is retracted", default=30 * mm, reason="port bore and clearance", above=0, most=10
    )
    bulk_modulus: Pressure = bulk_modulus()
    pressure: Pressure = initial("pressure at the start (gauge)", least=-1e5, most=1e8)
    bond_graph = BondGraph(
        "chamber: 0, oil: C, area: TF, piston: 1, friction: R, stop: C, stop_damping: R",
        "a -> chamber, chamber |-> oil, chamber -> area, area -> piston, piston |-> friction, piston |-> stop,"
        "piston |-> stop_damping, piston -> rod",
    )
    sources = (*SingleActingCylinder.sources, f"{OLSSON} (friction)")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        v, n = m.rod.v, self.count
        x = self.extension_state(m)
        p = m.state("pressure", unit="Pa", start=self.pressure, nominal=1e6, about="pressure in the cylinder")
        height = self.dead_length + limit(x, 0.0, self.stroke)
        squeezed = m.a.q / n - self.area * v
        friction = self.friction(v)
        stop, stop_stores = self.stops(x, v, self.stroke)
        yield m.a.p, p
        yield m.der(x), v
        yield m.der(p), self.bulk_modulus / (self.area * height) * squeezed
        yield from self.pushing(m, self.area * p - friction + stop)
        m.stores(n * (p * squeezed + stop_stores))
        m.dissipates(n * (friction * v - stop * v - stop_stores))
