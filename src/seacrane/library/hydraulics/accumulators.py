"""Gas accumulators: oil against nitrogen, for heave compensation and for peaks of flow."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.errors import Problem
from seacrane.library import symbols
from seacrane.model import BondGraph, Component, Hydraulic, initial, parameter
from seacrane.numerics.regularise import limit, maximum, minimum
from seacrane.units import Pressure, Ratio, Temperature, Time, Volume, l

from . import nitrogen
from .fluid import ATMOSPHERE, atmospheric_pressure

SQUEEZED = 0.02
"""Least gas volume, of the volume at precharge: oil beyond it meets no more resistance."""

SEAT = 1e-3
"""Share of the volume that oil may fall below empty while the valve at the oil port seats."""

OTIS = (
    "A. Pourmovahed and D. R. Otis, An experimental thermal time-constant correlation for hydraulic accumulators,"
    " Journal of Dynamic Systems, Measurement, and Control 112, 1990"
)


class GasAccumulator(Component):
    """Oil and gas in one shell, with a bladder, diaphragm or light piston between: p_oil = p_gas(V_gas).

          ╭─────╮
          │ gas │   V_gas = volume - oil,   d oil / dt = q
          │~~~~~│
          │ oil │
          ╰──┬──╯
             a

    `volume` is that of the gas at `precharge`, when there is no oil in it and all is at the temperature of the
    surroundings. Levels:

    - `isothermal`: slow against the flow of heat (minutes): p V = constant.
    - `adiabatic`: fast against it (seconds): p V^n = constant, n = 1.4.
    - `real-gas`: nitrogen by the equation of Benedict, Webb and Rubin, with a temperature that returns to that of the
      surroundings. For heave compensation, whose period is between the two, and above 200 bar, where nitrogen is
      stiffer than an ideal gas.

    Below the precharge the oil port shuts: the pressure falls to nothing over 0.1 % of the volume. Pressures are
    gauge; gas laws are written with p + `atmospheric_pressure`. Reports `gas_volume` [m3] and `gas_pressure` [Pa,
    absolute]. Given the flow, gives the pressure.
    """

    volume: Volume = parameter("volume of gas at precharge", above=0, most=1e2)
    precharge: Pressure = parameter("pressure (gauge) of the gas without oil", above=0, most=1e8)
    atmospheric_pressure: Pressure = atmospheric_pressure()
    oil: Volume = initial("oil in it at the start", least=0, most=1e2)
    ports = {"a": Hydraulic("oil in")}
    bond_graph = BondGraph("gas: C", "a |-> gas")
    icon = symbols.ACCUMULATOR

    def check(self) -> Iterator[Problem]:
        most = (1 - SQUEEZED) * self.volume
        if self.oil > most:
            yield Problem("oil", f"{self.oil / l:g} l leave no room for the gas", allowed=f"at most {most / l:g} l")

    def gas(self, m: Any) -> tuple[Any, Any]:
        """The state of the oil, and the volume of the gas [m3]."""
        oil = m.state("oil", unit="m3", start=self.oil, nominal=1e-2, about="oil in the accumulator")
        volume = limit(self.volume - oil, SQUEEZED * self.volume, self.volume)
        m.observe("gas_volume", volume, "m3", "volume of the gas")
        return oil, volume

    def filled(self, m: Any, oil: Any, pressure: Any) -> Iterator[tuple[Any, Any]]:
        """Port laws, with the gas at `pressure` [Pa, absolute]."""
        seat = (self.precharge + self.atmospheric_pressure) / (SEAT * self.volume) * minimum(oil, 0.0)
        yield m.a.p, pressure - self.atmospheric_pressure + seat
        yield m.der(oil), m.a.q
        m.observe("gas_pressure", pressure, "Pa", "absolute pressure of the gas")
        m.stores((seat - self.atmospheric_pressure) * m.a.q)

    def oil_at(self, pressure: Pressure, atmosphere: Pressure = ATMOSPHERE) -> Volume:
        """The oil [m3] in the accumulator at rest at this pressure (gauge), at the surroundings' temperature.

        `atmosphere` [Pa] is what gauge pressures count from.
        """
        return float(self.volume * maximum(1 - (self.precharge + atmosphere) / (pressure + atmosphere), 0.0))


class IsothermalGasAccumulator(GasAccumulator, level="isothermal"):
    """p V = constant: the gas stays at the temperature of the surroundings. Stores p q."""

    sources = ("Ideal gas at constant temperature (Boyle)",)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        oil, volume = self.gas(m)
        pressure = (self.precharge + self.atmospheric_pressure) * self.volume / volume
        yield from self.filled(m, oil, pressure)
        m.stores(pressure * m.a.q)


class AdiabaticGasAccumulator(GasAccumulator, level="adiabatic"):
    """p V^n = constant: no heat passes. n = 1.4 for nitrogen as an ideal gas. Stores p q."""

    exponent: Ratio = parameter("exponent n", default=1.4, reason="a diatomic gas", least=1, most=3)
    sources = ("Ideal gas without heat exchange (Poisson)",)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        oil, volume = self.gas(m)
        pressure = (self.precharge + self.atmospheric_pressure) * (self.volume / volume) ** self.exponent
        yield from self.filled(m, oil, pressure)
        m.stores(pressure * m.a.q)


class RealGasAccumulator(GasAccumulator, level="real-gas"):
    """Nitrogen with heat exchange: p = p(v, T) of `nitrogen`, and

        dT/dt = (T_s - T) / tau - T / c_v (dp/dT)_v dv/dt

    v molar volume, T_s `surroundings`, tau `time_constant` of the heat exchange at constant volume: about 10 s for a
    litre, 30 s for 50 litres, minutes for bottles; foam in the gas makes it longer. Starts at T_s. Stores the internal
    energy of the gas; the heat from the surroundings is supplied.
    """

    time_constant: Time = parameter("thermal time constant", above=0, most=1e6)
    surroundings: Temperature = parameter(
        "temperature of the surroundings", default=293.15, reason="20 degrees Celsius", least=220, most=400
    )
    temperature_difference: Ratio = initial("gas above surroundings at the start, in K", least=-70, most=500)
    bond_graph = BondGraph(
        "gas: C, heat: R, surroundings: Se, exchange: 1, inside: 0",
        "a -> inside, inside |-> gas, surroundings ->| exchange, exchange -> inside, exchange ->| heat",
    )
    sources = (nitrogen.BENEDICT_WEBB_RUBIN, OTIS)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        oil, volume = self.gas(m)
        excess = m.state(
            "temperature_difference",
            unit="K",
            start=self.temperature_difference,
            nominal=10.0,
            about="temperature of the gas above that of the surroundings",
        )
        moles = self.volume / nitrogen.molar_volume(self.precharge + self.atmospheric_pressure, self.surroundings)
        v, t = volume / moles, limit(self.surroundings + excess, COLDEST, HOTTEST)
        pressure, capacity = nitrogen.pressure(v, t), moles * nitrogen.heat_capacity(v, t)
        coupling = t * nitrogen.pressure_slope(v, t)
        heat = capacity * (self.surroundings - t) / self.time_constant
        warming = (heat + coupling * m.a.q) / capacity
        yield from self.filled(m, oil, pressure)
        yield m.der(excess), warming
        m.stores(capacity * warming - (coupling - pressure) * m.a.q)
        m.supplies(heat)
        m.observe("temperature", t, "K", "temperature of the gas")

    def oil_at(self, pressure: Pressure, atmosphere: Pressure = ATMOSPHERE) -> Volume:
        """See the interface; by the equation of state."""
        before = nitrogen.molar_volume(self.precharge + atmosphere, self.surroundings)
        now = nitrogen.molar_volume(pressure + atmosphere, self.surroundings)
        return float(self.volume * maximum(1 - now / before, 0.0))


COLDEST, HOTTEST = 150.0, 1000.0
"""Temperatures [K] within which the gas law is used."""
