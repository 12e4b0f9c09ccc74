"""Compressible oil at rest: lines, hoses, manifolds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.model import BondGraph, Component, Hydraulic, initial, parameter
from seacrane.units import Pressure, Volume

from .fluid import DISSERTATION, MERRITT, bulk_modulus


class ControlVolume(Component):
    """A rigid volume of oil: dp/dt = (beta / V) q.

        a ──►(  V, p  )      any number of ports may be connected to `a`: the node sums their flows

    V volume [m3], beta effective bulk modulus [Pa], q net flow in [m3/s]. Stores p q. Gives p, is given q.
    """

    volume: Volume = parameter("volume of oil", above=0, most=1e2)
    bulk_modulus: Pressure = bulk_modulus()
    pressure: Pressure = initial("pressure at the start (gauge)", least=-1e5, most=1e8)
    ports = {"a": Hydraulic("oil in")}
    bond_graph = BondGraph("oil: C", "a |-> oil")
    sources = (f"{MERRITT}, chapter 3", DISSERTATION)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        p = m.state("pressure", unit="Pa", start=self.pressure, nominal=1e6, about="pressure in the volume")
        yield m.a.p, p
        yield m.der(p), self.bulk_modulus / self.volume * m.a.q
        m.stores(p * m.der(p) * self.volume / self.bulk_modulus)
