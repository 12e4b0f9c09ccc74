"""Oil in rooms: compressed, stacked in a column, or open to the air."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, ClassVar

import casadi as ca

from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, MERRITT
from seacrane.model import BondGraph, Component, Hydraulic, initial, parameter
from seacrane.numerics.regularise import maximum
from seacrane.units import GRAVITY, Acceleration, Area, Density, Length, Pressure, Ratio, bar
from seacrane.units import Volume as CubicMetres

from .fluid import atmospheric_pressure, bulk_modulus, density

LEAST_PRESSURE = 0.01 * bar
"""Absolute pressure below which the law of entrained air is not followed further: oil has long begun to boil."""

GHOLIZADEH = (
    "H. Gholizadeh, R. Burton and G. Schoenau, Fluid bulk modulus: a literature survey,"
    " International Journal of Fluid Power 12(3), 2011"
)


class Volume(Component):
    """A room of oil, by what its pressure depends on.

        a ──►(  V, p  )      any number of ports may be connected to `a`: the node sums their flows

    Levels:

    - `control-volume`: compressible oil, dp/dt = (beta / V) q.
    - `entrained-air`: the same, with air in the oil that makes it soft at low pressure.
    - `fluid-column`: an upright column of incompressible oil under the air, p = rho g h.
    - `open-tank`: a tank so large that its level and pressure stay, p = pressure (a `Tank` by another name).

    All give p and are given the net flow q.
    """

    ports = {"a": Hydraulic("oil in")}
    sources: ClassVar[tuple[str, ...]] = (f"{MERRITT}, chapter 3", DISSERTATION)


class ControlVolume(Volume, level="control-volume"):
    """A rigid volume of oil: dp/dt = (beta / V) q.

    V volume [m3], beta effective bulk modulus [Pa], q net flow in [m3/s]. Stores p q. Given q, gives p.
    """

    volume: CubicMetres = parameter("volume of oil", above=0, most=1e2)
    bulk_modulus: Pressure = bulk_modulus()
    pressure: Pressure = initial("pressure at the start (gauge)", least=-1e5, most=1e8)
    bond_graph = BondGraph("oil: C", "a |-> oil")
    icon = symbols.VOLUME

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        p = m.state("pressure", unit="Pa", start=self.pressure, nominal=1e6, about="pressure in the volume")
        yield m.a.p, p
        yield m.der(p), self.bulk_modulus / self.volume * m.a.q
        m.stores(p * m.der(p) * self.volume / self.bulk_modulus)


class EntrainedAirVolume(Volume, level="entrained-air"):
    """A rigid volume of oil with air bubbles: dp/dt = (beta_e / V) q, with P = p + P_0 and

        V_m / V_0 = (1 - alpha) exp(-p / beta) + alpha (P_0 / P)^(1/n)          what fills V_0 at P_0
        beta_e    = -V_m / (dV_m/dp)

    P_0 is the pressure of the atmosphere; alpha is the share of air by volume there: 0.005 to 0.02 in a working system.
    n = 1.4: bubbles are compressed too fast to give off heat. beta is here the modulus of the oil alone; see
    `mineral_oil` for that at a temperature. None of the air dissolves. Stores p q. Reports `effective_modulus` [Pa].
    """

    volume: CubicMetres = parameter("volume of oil", above=0, most=1e2)
    air: Ratio = parameter(
        "share of air by volume at atmospheric pressure",
        default=0.01,
        reason="0.005 to 0.02 in a working system",
        least=0,
        below=0.5,
    )
    exponent: Ratio = parameter(
        "polytropic exponent n of the air",
        default=1.4,
        reason="bubbles are compressed too fast to give off heat",
        least=1,
        most=1.67,
    )
    bulk_modulus: Pressure = bulk_modulus()
    atmospheric_pressure: Pressure = atmospheric_pressure()
    pressure: Pressure = initial("pressure at the start (gauge)", least=-1e5, most=1e8)
    bond_graph = BondGraph("oil: C", "a |-> oil")
    icon = symbols.VOLUME
    sources = (*Volume.sources, GHOLIZADEH)

    def effective_modulus(self, p: Any) -> Any:
        """beta_e [Pa] at the gauge pressure p."""
        atmosphere = self.atmospheric_pressure
        absolute = maximum(p + atmosphere, LEAST_PRESSURE)
        liquid = (1 - self.air) * ca.exp(-(absolute - atmosphere) / self.bulk_modulus)
        air = self.air * (atmosphere / absolute) ** (1 / self.exponent)
        return (liquid + air) / (liquid / self.bulk_modulus + air / (self.exponent * absolute))

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        p = m.state("pressure", unit="Pa", start=self.pressure, nominal=1e6, about="pressure in the volume")
        modulus = self.effective_modulus(p)
        yield m.a.p, p
        yield m.der(p), modulus / self.volume * m.a.q
        m.stores(p * m.a.q)
        m.observe("effective_modulus", modulus, "Pa", "bulk modulus of oil and air together")


class FluidColumn(Volume, level="fluid-column"):
    """An upright column of incompressible oil, open at the top: p = rho g h, dh/dt = q / A.

    p is that at the foot, where the oil comes in. Stores p q as height. The law does not know how high the walls are,
    nor when the column has run empty.
    """

    area: Area = parameter("cross-section of the column", above=0, most=1e4)
    gravity: Acceleration = parameter("gravity", default=GRAVITY, above=0, most=100)
    height: Length = initial("height of the column at the start", least=0, most=1e3)
    density: Density = density()
    bond_graph = BondGraph("column: C", "a |-> column")
    icon = symbols.COLUMN

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        h = m.state("height", unit="m", start=self.height, about="height of the column")
        yield m.a.p, self.density * self.gravity * h
        yield m.der(h), m.a.q / self.area
        m.stores(self.density * self.gravity * h * m.der(h) * self.area)


class OpenTankVolume(Volume, level="open-tank"):
    """p = pressure, whatever flows in or out."""

    pressure: Pressure = parameter("pressure in the tank (gauge)", default=0.0, least=-1e5, most=1e7)
    bond_graph = BondGraph("tank: Se", "tank ->| a")
    icon = symbols.OPEN_TANK

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.a.p, self.pressure
        m.supplies(-m.a.power)
