"""Valves that pressures open: counterbalance, relief, reducing, check and anti-cavitation.

A valve is sized as its data sheet does it: `flow`, fully open, under the pressure drop `at`. How far it opens is a law
of its own, from 0 to 1, with corners rounded over 1 % of full opening so that its slope is continuous: at the corners
the opening is off by 0.25 % of full, elsewhere it is exact.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.errors import Problem
from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, WATTON
from seacrane.model import BondGraph, Component, Hydraulic, parameter
from seacrane.numerics.regularise import positive_part
from seacrane.units import FlowRate, Pressure, Ratio, Time, bar

from .fluid import rated_flow, transition_pressure
from .opening import lagging, opening, passing, rising


# ---------------------------------------------------------------- load holding
class CounterbalanceValve(Component):
    """Holds a load until it is driven: free flow from valve to load, piloted flow back.

                     pilot (from the other side of the actuator)
                       ┊
        a (valve) ──►─┤>├──►── b (load)         check: opens with p_a - p_b from `check` to 4 times that
                  ──◄─┤ ├──◄──                  relief: opens with p_b + R p_pilot from `crack` to `full`

    R pilot ratio; the pilot port takes no flow. Both paths pass `flow` under the drop `at` when fully open. A common
    setting of `crack` is 1.3 times the highest load pressure. Given three pressures, gives the flow. Levels: `static`
    (the poppet moves at once) and `dynamic` (the relief opening follows as a first-order lag).
    """

    flow: FlowRate = parameter("flow, fully open, at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop", above=0, most=1e8)
    crack: Pressure = parameter("p_load + R p_pilot at which the relief opens", above=0, most=1e8)
    full: Pressure = parameter("p_load + R p_pilot at which the relief is fully open", above=0, most=1e8)
    ratio: Ratio = parameter("pilot ratio R", least=0, most=20)
    check_pressure: Pressure = parameter(
        "pressure drop that opens the check",
        default=1 * bar,
        reason="a weak spring, not to waste power",
        above=0,
        most=1e7,
    )
    leakage: Ratio = parameter(
        "opening that remains when closed, of full area",
        default=1e-6,
        reason="a poppet is tight; keeps a locked line determined",
        least=0,
        most=0.1,
    )
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("valve side"), "b": Hydraulic("load side"), "pilot": Hydraulic("pilot pressure")}
    bond_graph = BondGraph(
        "through: 1, seat: MR, pilot_piston: Sf",
        "a -> through, through -> b, through ->| seat, pilot ->| pilot_piston, pilot ~> seat, b ~> seat",
    )
    icon = symbols.COUNTERBALANCE_VALVE
    sources = (DISSERTATION,)

    def check(self) -> Iterator[Problem]:
        yield from rising(("crack", self.crack), ("full", self.full))

    def relief_opening(self, m: Any) -> Any:
        """Opening of the relief at the pressures of this instant."""
        return opening(m.b.p + self.ratio * m.pilot.p, self.crack, self.full)

    def paths(self, m: Any, relief: Any) -> Iterator[tuple[Any, Any]]:
        """The flow through check and relief side by side."""
        dp = m.a.p - m.b.p
        check = opening(dp, self.check_pressure, 4 * self.check_pressure)
        total = check + relief + self.leakage
        yield from passing(m, m.a, m.b, total * rated_flow(dp, self.flow, self.at, self.transition_pressure))
        yield m.pilot.q, 0
        m.observe("relief_opening", relief, "1", "opening of the relief, of full area")


class StaticCounterbalanceValve(CounterbalanceValve, level="static"):
    """The poppet follows the pressures at once."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.paths(m, self.relief_opening(m))


class DynamicCounterbalanceValve(CounterbalanceValve, level="dynamic"):
    """The relief opening k follows the static one k_s with a lag, as a damped pilot makes it: T k' + k = k_s."""

    time_constant: Time = parameter("time constant of the poppet", above=0, most=10)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        k = yield from lagging(m, "relief_position", self.relief_opening(m), self.time_constant)
        yield from self.paths(m, k)


# ---------------------------------------------------------------- pressure limiting
class ReliefValve(Component):
    """Limits the pressure at a: opens from a to b as dp = p_a - p_b rises from `crack` to `full`.

        a ──►┤/├──► b        q = k(dp) flow sqrt(dp / full), k from 0 at `crack` to 1 at `full`; none backwards

    `flow` passes at dp = `full`: the difference of the two pressures is the override of a real valve (10 to 20 %).
    Two of them, back to back across a motor, are its cross-port relief. Given both pressures, gives the flow. Levels:
    `static` and `dynamic` (the poppet follows as a first-order lag).
    """

    crack: Pressure = parameter("pressure drop at which the valve opens", above=0, most=1e8)
    full: Pressure = parameter("pressure drop at which it is fully open", above=0, most=1e8)
    flow: FlowRate = parameter("flow at the pressure drop `full`", above=0, most=1)
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("protected side"), "b": Hydraulic("relieved to")}
    bond_graph = BondGraph("through: 1, seat: R", "a -> through, through -> b, through ->| seat")
    icon = symbols.RELIEF_VALVE
    sources = (DISSERTATION,)

    def check(self) -> Iterator[Problem]:
        yield from rising(("crack", self.crack), ("full", self.full))

    def static_opening(self, m: Any) -> Any:
        """k_s at the pressures of this instant."""
        return opening(m.a.p - m.b.p, self.crack, self.full)

    def seat(self, m: Any, k: Any) -> Iterator[tuple[Any, Any]]:
        """The flow at the opening k."""
        q = k * rated_flow(m.a.p - m.b.p, self.flow, self.full, self.transition_pressure)
        yield from passing(m, m.a, m.b, q)
        m.observe("opening", k, "1", "opening, of full area")


class StaticReliefValve(ReliefValve, level="static"):
    """The poppet follows the pressures at once."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.seat(m, self.static_opening(m))


class DynamicReliefValve(ReliefValve, level="dynamic"):
    """The opening k follows the static one k_s with a lag: T k' + k = k_s; then the pressure overshoots for a time T.

    T is about 10 ms for a direct-operated valve and 50 ms for a pilot-operated one.
    """

    time_constant: Time = parameter("time constant of the poppet", above=0, most=10)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        k = yield from lagging(m, "poppet", self.static_opening(m), self.time_constant)
        yield from self.seat(m, k)


class PressureReducingValve(Component):
    """Keeps the pressure at b down: open at rest, shuts as p_b rises from `full` to `shut`.

                 ┌┄┄┄┄┄┐
        a ──►─[ ↓ ]──►─┴─ b        k = (shut - p_b) / (shut - full), held within [0, 1]
                │                  q = k flow sqrt(|dp| / at) sign(dp),   dp = p_a - p_b
              spring

    Two ports: it reduces, but does not relieve a load that pushes back. Its spring side drains to the tank at gauge
    pressure zero. Given both pressures, gives the flow. Levels: `static` and `dynamic` (a first-order lag).
    """

    shut: Pressure = parameter("pressure at b at which the valve has shut", above=0, most=1e8)
    full: Pressure = parameter("pressure at b up to which it is fully open", above=0, most=1e8)
    flow: FlowRate = parameter("flow, fully open, at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop", above=0, most=1e8)
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("inlet"), "b": Hydraulic("reduced pressure")}
    bond_graph = BondGraph("through: 1, seat: MR", "a -> through, through -> b, through ->| seat, b ~> seat")
    icon = symbols.PRESSURE_REDUCING_VALVE
    sources = (WATTON,)

    def check(self) -> Iterator[Problem]:
        yield from rising(("full", self.full), ("shut", self.shut))

    def static_opening(self, m: Any) -> Any:
        """k_s at the pressure of this instant."""
        return 1 - opening(m.b.p, self.full, self.shut)

    def seat(self, m: Any, k: Any) -> Iterator[tuple[Any, Any]]:
        """The flow at the opening k."""
        q = k * rated_flow(m.a.p - m.b.p, self.flow, self.at, self.transition_pressure)
        yield from passing(m, m.a, m.b, q)
        m.observe("opening", k, "1", "opening, of full area")


class StaticPressureReducingValve(PressureReducingValve, level="static"):
    """The spool follows the pressure at once."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.seat(m, self.static_opening(m))


class DynamicPressureReducingValve(PressureReducingValve, level="dynamic"):
    """The opening k follows the static one k_s with a lag: T k' + k = k_s. It starts open."""

    time_constant: Time = parameter("time constant of the spool", above=0, most=10)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        k = yield from lagging(m, "spool", self.static_opening(m), self.time_constant, start=1.0)
        yield from self.seat(m, k)


# ---------------------------------------------------------------- one way
class CheckValve(Component):
    """Lets oil pass from a to b only: opens as dp = p_a - p_b rises from `crack` to `full`.

        a ──►┤>├──► b        q = k(dp) flow sqrt(dp / at)

    `flow` passes fully open under the drop `at`. Given both pressures, gives the flow.
    """

    flow: FlowRate = parameter("flow, fully open, at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop", above=0, most=1e8)
    crack: Pressure = parameter(
        "pressure drop at which the poppet lifts",
        default=0.5 * bar,
        reason="the common spring of check valves",
        above=0,
        most=1e7,
    )
    full: Pressure = parameter(
        "pressure drop at which it is fully open",
        default=2 * bar,
        reason="four times the cracking pressure",
        above=0,
        most=1e8,
    )
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("inlet"), "b": Hydraulic("outlet")}
    bond_graph = BondGraph("through: 1, seat: R", "a -> through, through -> b, through ->| seat")
    icon = symbols.CHECK_VALVE
    sources = (WATTON, DISSERTATION)

    def check(self) -> Iterator[Problem]:
        yield from rising(("crack", self.crack), ("full", self.full))

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        dp = m.a.p - m.b.p
        k = opening(dp, self.crack, self.full)
        yield from passing(m, m.a, m.b, k * rated_flow(dp, self.flow, self.at, self.transition_pressure))


class PilotOperatedCheckValve(Component):
    """A check valve that a pilot can open backwards: it locks a load without leakage until it is to be lowered.

                pilot
                  ┊
        a ──►───┤>├───►── b        lift = p_a - p_b + R max(p_pilot - p_a, 0), opens from `crack` to `full`

    R pilot ratio: area of the pilot piston over that of the seat. The load p_b is let go at p_pilot = p_a +
    (p_b - p_a + crack) / R. The pilot takes no flow. Given three pressures, gives the flow.
    """

    flow: FlowRate = parameter("flow, fully open, at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop", above=0, most=1e8)
    ratio: Ratio = parameter("pilot ratio R", above=0, most=50)
    crack: Pressure = parameter(
        "lift at which the poppet leaves its seat",
        default=0.5 * bar,
        reason="the common spring of check valves",
        above=0,
        most=1e7,
    )
    full: Pressure = parameter(
        "lift at which it is fully open", default=2 * bar, reason="four times the cracking pressure", above=0, most=1e8
    )
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("inlet"), "b": Hydraulic("load"), "pilot": Hydraulic("pilot pressure")}
    bond_graph = BondGraph(
        "through: 1, seat: MR, pilot_piston: Sf",
        "a -> through, through -> b, through ->| seat, pilot ->| pilot_piston, pilot ~> seat, a ~> seat",
    )
    icon = symbols.PILOT_OPERATED_CHECK_VALVE
    sources = (WATTON,)

    def check(self) -> Iterator[Problem]:
        yield from rising(("crack", self.crack), ("full", self.full))

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        dp = m.a.p - m.b.p
        pilot = self.ratio * positive_part(m.pilot.p - m.a.p, self.crack / self.ratio)
        k = opening(dp + pilot, self.crack, self.full)
        yield from passing(m, m.a, m.b, k * rated_flow(dp, self.flow, self.at, self.transition_pressure))
        yield m.pilot.q, 0
        m.observe("opening", k, "1", "opening, of full area")


class AnticavitationValve(Component):
    """Fills a line from the tank when an overrunning load would suck it empty: a check valve with a weak spring.

        t ──►┤>├──► a        opens as p_t - p_a rises from `crack` to `full`

    Size it so that `flow` is the largest the load can draw and `at` well below 1 bar: the pressure of the line then
    stays above vacuum, -1 bar. Given both pressures, gives the flow.
    """

    flow: FlowRate = parameter("flow, fully open, at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop", above=0, most=1e8)
    crack: Pressure = parameter(
        "pressure drop at which the poppet lifts",
        default=0.1 * bar,
        reason="must open before the line is at vacuum",
        above=0,
        most=1e6,
    )
    full: Pressure = parameter(
        "pressure drop at which it is fully open",
        default=0.4 * bar,
        reason="well below the 1 bar that the atmosphere gives",
        above=0,
        most=1e6,
    )
    transition_pressure: Pressure = transition_pressure()
    ports = {"t": Hydraulic("tank"), "a": Hydraulic("line to keep filled")}
    bond_graph = BondGraph("through: 1, seat: R", "t -> through, through -> a, through ->| seat")
    icon = symbols.ANTICAVITATION_VALVE
    sources = (DISSERTATION,)

    def check(self) -> Iterator[Problem]:
        yield from rising(("crack", self.crack), ("full", self.full))

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        dp = m.t.p - m.a.p
        k = opening(dp, self.crack, self.full)
        yield from passing(m, m.t, m.a, k * rated_flow(dp, self.flow, self.at, self.transition_pressure))
