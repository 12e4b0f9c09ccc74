"""Where oil comes from and goes to: the tank, a plug, and boundaries given by a signal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, KARNOPP
from seacrane.model import BondGraph, Component, Hydraulic, PowerBond, SignalIn, SignalOut, parameter
from seacrane.units import Pressure

_BOUNDARY = (f"{KARNOPP}, chapter 3 (ideal sources)",)


class Tank(Component):
    """An open tank: p = pressure, whatever flows in or out. At gauge pressure zero unless raised by a return line."""

    pressure: Pressure = parameter("pressure in the tank (gauge)", default=0.0, least=-1e5, most=1e7)
    ports = {"p": Hydraulic("return")}
    bond_graph = BondGraph("tank: Se", "tank ->| p")
    icon = symbols.TANK
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.p, self.pressure
        m.supplies(-m.p.power)


class Plug(Component):
    """A closed end: no flow."""

    ports = {"a": Hydraulic("plugged port")}
    bond_graph = BondGraph("closed: Sf", "closed |-> a")
    icon = symbols.PLUG
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.a.q, 0


class PressureInput(Component):
    """A pressure given by a signal; `q` reports the flow delivered into the circuit."""

    ports = {"set": SignalIn("Pa", "pressure"), "p": Hydraulic("outlet"), "q": SignalOut("m3/s", "flow delivered")}
    bond_graph = BondGraph("source: MSe", "source ->| p, set ~> source, p ~> q")
    partner = PowerBond("partner", "set", "q")
    icon = symbols.PRESSURE_SOURCE
    sources = _BOUNDARY

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.p, m.set
        yield m.q, -m.p.q
        m.supplies(-m.p.power)


class FlowInput(Component):
    """A flow given by a signal, positive into the circuit; `p` of the port is what the circuit makes of it."""

    ports = {"set": SignalIn("m3/s", "flow into the circuit"), "p": Hydraulic("outlet")}
    bond_graph = BondGraph("source: MSf", "source |-> p, set ~> source")
    icon = symbols.FLOW_SOURCE
    sources = _BOUNDARY

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.q, -m.set
        m.supplies(-m.p.power)
