"""Switches that oil works."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.errors import Problem
from seacrane.library import symbols
from seacrane.library.references import HYSTERESIS
from seacrane.model import BondGraph, Component, Hydraulic, SignalOut, initial, parameter
from seacrane.units import Pressure, Ratio, bar


class PressureSwitch(Component):
    """A changeover contact that the pressure works: `above` = 1 once p has risen above `high`, 0 once it has fallen
    below `low`; `below` = 1 - above.

        p ──/\\/\\─┤ ─o above       above   ┌──<──┬─────
                 └──o below             ───┴──>──┘
                                          low   high

    Takes no oil. `below` loads a pump that fills an accumulator (the gain of a `VariableFlowPump`), `above` opens an
    unloading valve. It switches at once, at a located instant. Given the pressure, gives no flow.
    """

    low: Pressure = parameter("pressure (gauge) below which it falls back", least=-1e5, most=1e8)
    high: Pressure = parameter("pressure (gauge) above which it switches", least=-1e5, most=1e8)
    switched: Ratio = initial("1 if it starts as after `high`, 0 as after `low`", least=0, most=1)
    ports = {
        "p": Hydraulic("pressure that is watched"),
        "above": SignalOut("1", "1 from `high` on until `low`"),
        "below": SignalOut("1", "1 from `low` on until `high`"),
    }
    bond_graph = BondGraph("closed: Sf", "closed |-> p, p ~> above, p ~> below")
    icon = symbols.PRESSURE_SWITCH
    sources = (HYSTERESIS,)

    def check(self) -> Iterator[Problem]:
        if self.low >= self.high:
            yield Problem("high", f"{self.high / bar:g} bar must be above low = {self.low / bar:g} bar")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        above = m.mode("switched", start=round(self.switched), about="1 from the upper pressure on until the lower")
        yield m.p.q, 0
        yield m.above, above
        yield m.below, 1 - above
        span = self.high - self.low
        m.when(
            "rises", (1 - above) * (m.p.p - self.high) / span, (above, 1), about="pressure rises above its upper limit"
        )
        m.when("falls", above * (self.low - m.p.p) / span, (above, 0), about="pressure falls below its lower limit")
