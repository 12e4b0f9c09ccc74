"""Where oil comes from and goes to: pumps, the tank, a plug, and boundaries given by a signal."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.model import BondGraph, Component, Hydraulic, SignalIn, SignalOut, parameter
from seacrane.units import AngularSpeed, Displacement, Pressure

from .fluid import DISSERTATION


class ConstantPressurePump(Component):
    """A supply that holds its pressure whatever flow is drawn: p = pressure.

    Stands for a pressure-controlled pump with enough flow. Gives p, is given q.
    """

    pressure: Pressure = parameter("supply pressure (gauge)", least=0, most=1e8)
    ports = {"p": Hydraulic("outlet")}
    bond_graph = BondGraph("supply: Se", "supply ->| p")
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.p, self.pressure
        m.supplies(-m.p.power)


class ConstantFlowPump(Component):
    """A fixed-displacement pump at constant speed: q_out = D w, whatever the pressure.

    D [m3/rad], w [rad/s]. Without a relief valve the pressure has no bound. Gives q, is given p.
    """

    displacement: Displacement = parameter("displacement", above=0, most=1e-2)
    speed: AngularSpeed = parameter("shaft speed", least=0, most=1e3)
    ports = {"p": Hydraulic("outlet")}
    bond_graph = BondGraph("supply: Sf", "supply |-> p")
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.q, -self.displacement * self.speed
        m.supplies(-m.p.power)


class Tank(Component):
    """An open tank: p = pressure, whatever flows in or out. At gauge pressure zero unless raised by a return line."""

    pressure: Pressure = parameter("pressure in the tank (gauge)", default=0.0, least=-1e5, most=1e7)
    ports = {"p": Hydraulic("return")}
    bond_graph = BondGraph("tank: Se", "tank ->| p")
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.p, self.pressure
        m.supplies(-m.p.power)


class Plug(Component):
    """A closed end: no flow."""

    ports = {"a": Hydraulic("plugged port")}
    bond_graph = BondGraph("closed: Sf", "closed |-> a")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.a.q, 0


class PressureInput(Component):
    """A pressure given by a signal; `q` reports the flow delivered into the circuit."""

    ports = {"set": SignalIn("Pa", "pressure"), "p": Hydraulic("outlet"), "q": SignalOut("m3/s", "flow delivered")}
    bond_graph = BondGraph("source: MSe", "source ->| p")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.p, m.set
        yield m.q, -m.p.q
        m.supplies(-m.p.power)


class FlowInput(Component):
    """A flow given by a signal, positive into the circuit; `p` of the port is what the circuit makes of it."""

    ports = {"set": SignalIn("m3/s", "flow into the circuit"), "p": Hydraulic("outlet")}
    bond_graph = BondGraph("source: MSf", "source |-> p")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.p.q, -m.set
        m.supplies(-m.p.power)
