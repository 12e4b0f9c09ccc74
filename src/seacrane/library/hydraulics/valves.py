"""Valves: directional, counterbalance, relief, check and anti-cavitation.

A valve is sized as its data sheet does it: `flow` through one edge, fully open, under the pressure drop `at`. How far
it opens is a law of its own, from 0 to 1, with corners rounded over 1 % of full opening so that its slope is
continuous: at the corners the opening is off by 0.25 % of full, elsewhere it is exact.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.errors import Problem
from seacrane.model import BondGraph, Component, Hydraulic, SignalIn, parameter
from seacrane.numerics.regularise import limit, maximum, minimum, positive_part, smooth_limit
from seacrane.units import AngularSpeed, FlowRate, Pressure, Ratio, Time, bar

from .fluid import DISSERTATION, MERRITT, rated_flow, transition_pressure

ROUNDING = 0.01
_NARROWEST_DEAD_BAND = 1e-6  # keeps a quotient finite where there is no dead band, and no floating centre either


def opening(pressure: Any, crack: Any, full: Any) -> Any:
    """Fraction of full area: rises from 0 at `crack` to 1 at `full` with the pressure that lifts the poppet."""
    return smooth_limit((pressure - crack) / (full - crack), 0.0, 1.0, ROUNDING)


def _rising(name: str, crack: tuple[str, float], full: tuple[str, float]) -> Iterator[Problem]:
    if crack[1] >= full[1]:
        what = f"must be above {crack[0]} = {crack[1] / bar:g} bar"
        yield Problem(f"{name}.{full[0]}", f"{full[1] / bar:g} bar {what}")


# ---------------------------------------------------------------- directional
class DirectionalValve43(Component):
    """A proportional 4/3 valve: four edges, each an orifice, opened by the spool.

             a   b                 x > 0: p to a, b to t
          ┌──┴───┴──┐              x < 0: p to b, a to t
     x ──►│ ╳ │ ┴┬ │ ↕↕│           |x| below the dead band: closed, but for the leakage
          └──┬───┬──┘
             p   t

    Opening of an edge, with s = (|x| - dead_band) / (1 - dead_band):  max(s, 0), corner rounded (see the module), never
    above 1, plus `leakage`. Flow of an edge: opening * flow * sqrt(|dp| / at) sign(dp). The valve turns the sum of
    q dp into heat. Given the four pressures, gives the four flows.

    With `float_centre` above 0 both working ports are open to tank by that much at mid-spool, fading out over the dead
    band as (1 - (x/dead_band)^2)^2. A counterbalance valve needs it: behind a closed centre, leakage raises the pilot
    pressure until the load creeps.

    Levels: `static` (the spool is where the command is) and `dynamic` (it follows as a second-order lag).
    """

    flow: FlowRate = parameter("flow through one edge, fully open, at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop per edge", above=0, most=1e8)
    dead_band: Ratio = parameter("overlap of the spool, of full travel", default=0.05, least=0, most=0.9)
    leakage: Ratio = parameter("opening that remains on a closed edge, of full area", default=1e-4, least=0, most=0.1)
    float_centre: Ratio = parameter("opening of a and b to t at mid-spool, of full area", default=0.0, least=0, most=1)
    transition_pressure: Pressure = transition_pressure()
    ports = {
        "x": SignalIn("1", "spool command", minimum=-1, maximum=1),
        "p": Hydraulic("supply"),
        "t": Hydraulic("tank"),
        "a": Hydraulic("working port A"),
        "b": Hydraulic("working port B"),
    }
    bond_graph = BondGraph(
        "from_p: 0, to_a: 0, to_b: 0, to_t: 0, pa: 1, pb: 1, at: 1, bt: 1,"
        "edge_pa: MR, edge_pb: MR, edge_at: MR, edge_bt: MR",
        "p -> from_p, from_p -> pa, pa -> to_a, from_p -> pb, pb -> to_b, to_a -> at, at -> to_t, to_b -> bt,"
        "bt -> to_t, pa ->| edge_pa, pb ->| edge_pb, at ->| edge_at, bt ->| edge_bt, to_a -> a, to_b -> b, to_t -> t",
    )
    sources = (f"{MERRITT}, chapter 5", DISSERTATION)

    def check(self) -> Iterator[Problem]:
        if self.float_centre > 0 and self.dead_band == 0:
            name = f"{type(self).__name__}.float_centre"
            yield Problem(name, "needs a dead band to fade out in", self.float_centre, "0, or dead_band above 0")

    def edges(self, m: Any, spool: Any) -> Iterator[tuple[Any, Any]]:
        """The flows of the four edges for this spool position."""
        pa = minimum(positive_part((spool - self.dead_band) / (1 - self.dead_band), ROUNDING), 1.0)
        pb = minimum(positive_part((-spool - self.dead_band) / (1 - self.dead_band), ROUNDING), 1.0)

        within = spool / maximum(self.dead_band, _NARROWEST_DEAD_BAND)
        floating = self.float_centre * maximum(1 - within * within, 0.0) ** 2

        def edge(fraction: Any, upper: Any, lower: Any) -> Any:
            dp = upper.p - lower.p
            q = (fraction + self.leakage) * rated_flow(dp, self.flow, self.at, self.transition_pressure)
            m.dissipates(q * dp)
            return q

        q_pa, q_bt = edge(pa, m.p, m.a), edge(pa + floating, m.b, m.t)
        q_pb, q_at = edge(pb, m.p, m.b), edge(pb + floating, m.a, m.t)
        yield m.p.q, q_pa + q_pb
        yield m.a.q, q_at - q_pa
        yield m.b.q, q_bt - q_pb
        yield m.t.q, -q_at - q_bt
        m.observe("spool", spool, "1", "spool position")


class StaticDirectionalValve43(DirectionalValve43, level="static"):
    """The spool is where the command is, held within [-1, 1]."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.edges(m, limit(m.x, -1.0, 1.0))


class DynamicDirectionalValve43(DirectionalValve43, level="dynamic"):
    """The spool follows the command as a second-order lag: s'' + 2 zeta w_n s' + w_n^2 s = w_n^2 x."""

    natural_frequency: AngularSpeed = parameter("natural frequency of the spool", above=0, most=1e4)
    damping: Ratio = parameter("damping ratio of the spool", default=0.8, above=0, most=10)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        s = m.state("spool_position", unit="1", about="spool position, of full travel")
        v = m.state("spool_speed", unit="1/s", nominal=10.0, about="speed of the spool")
        w = self.natural_frequency
        yield m.der(s), v
        yield m.der(v), w * w * (limit(m.x, -1.0, 1.0) - s) - 2 * self.damping * w * v
        yield from self.edges(m, s)


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
    check_pressure: Pressure = parameter("pressure drop that opens the check", default=1 * bar, above=0, most=1e7)
    leakage: Ratio = parameter("opening that remains when closed, of full area", default=1e-6, least=0, most=0.1)
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("valve side"), "b": Hydraulic("load side"), "pilot": Hydraulic("pilot pressure")}
    bond_graph = BondGraph(
        "through: 1, seat: MR, pilot_piston: Sf", "a -> through, through -> b, through ->| seat, pilot ->| pilot_piston"
    )
    sources = (DISSERTATION,)

    def check(self) -> Iterator[Problem]:
        yield from _rising(type(self).__name__, ("crack", self.crack), ("full", self.full))

    def relief_opening(self, m: Any) -> Any:
        """Opening of the relief at the pressures of this instant."""
        return opening(m.b.p + self.ratio * m.pilot.p, self.crack, self.full)

    def paths(self, m: Any, relief: Any) -> Iterator[tuple[Any, Any]]:
        """The flow through check and relief side by side."""
        dp = m.a.p - m.b.p
        check = opening(dp, self.check_pressure, 4 * self.check_pressure)
        total = check + relief + self.leakage
        yield m.a.q, total * rated_flow(dp, self.flow, self.at, self.transition_pressure)
        yield m.a.q + m.b.q, 0
        yield m.pilot.q, 0
        m.dissipates(m.a.q * dp)
        m.observe("relief_opening", relief, "1", "opening of the relief, of full area")


class StaticCounterbalanceValve(CounterbalanceValve, level="static"):
    """The poppet follows the pressures at once."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.paths(m, self.relief_opening(m))


class DynamicCounterbalanceValve(CounterbalanceValve, level="dynamic"):
    """The relief opening k follows the static one k_s with a lag, as a damped pilot makes it: T k' + k = k_s."""

    time_constant: Time = parameter("time constant of the poppet", above=0, most=10)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        k = m.state("relief_position", unit="1", about="opening of the relief, of full area")
        yield m.der(k), (self.relief_opening(m) - k) / self.time_constant
        yield from self.paths(m, maximum(k, 0.0))


# ---------------------------------------------------------------- pressure limiting
class ReliefValve(Component):
    """Limits the pressure at a: opens from a to b as dp = p_a - p_b rises from `crack` to `full`.

        a ──►┤/├──► b        q = k(dp) flow sqrt(dp / full), k from 0 at `crack` to 1 at `full`; none backwards

    `flow` passes at dp = `full`: the difference of the two pressures is the override of a real valve (10 to 20 %).
    Two of them, back to back across a motor, are its cross-port relief. Given both pressures, gives the flow.
    """

    crack: Pressure = parameter("pressure drop at which the valve opens", above=0, most=1e8)
    full: Pressure = parameter("pressure drop at which it is fully open", above=0, most=1e8)
    flow: FlowRate = parameter("flow at the pressure drop `full`", above=0, most=1)
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("protected side"), "b": Hydraulic("relieved to")}
    bond_graph = BondGraph("through: 1, seat: R", "a -> through, through -> b, through ->| seat")
    sources = (DISSERTATION,)

    def check(self) -> Iterator[Problem]:
        yield from _rising(type(self).__name__, ("crack", self.crack), ("full", self.full))

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        dp = m.a.p - m.b.p
        k = opening(dp, self.crack, self.full)
        yield m.a.q, k * rated_flow(dp, self.flow, self.full, self.transition_pressure)
        yield m.a.q + m.b.q, 0
        m.dissipates(m.a.q * dp)
        m.observe("opening", k, "1", "opening, of full area")


class CheckValve(Component):
    """Lets oil pass from a to b only: opens as dp = p_a - p_b rises from `crack` to `full`.

        a ──►┤>├──► b        q = k(dp) flow sqrt(dp / at)

    `flow` passes fully open under the drop `at`. Given both pressures, gives the flow.
    """

    flow: FlowRate = parameter("flow, fully open, at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop", above=0, most=1e8)
    crack: Pressure = parameter("pressure drop at which the poppet lifts", default=0.5 * bar, above=0, most=1e7)
    full: Pressure = parameter("pressure drop at which it is fully open", default=2 * bar, above=0, most=1e8)
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("inlet"), "b": Hydraulic("outlet")}
    bond_graph = BondGraph("through: 1, seat: R", "a -> through, through -> b, through ->| seat")

    def check(self) -> Iterator[Problem]:
        yield from _rising(type(self).__name__, ("crack", self.crack), ("full", self.full))

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        dp = m.a.p - m.b.p
        k = opening(dp, self.crack, self.full)
        yield m.a.q, k * rated_flow(dp, self.flow, self.at, self.transition_pressure)
        yield m.a.q + m.b.q, 0
        m.dissipates(m.a.q * dp)


class AnticavitationValve(Component):
    """Fills a line from the tank when an overrunning load would suck it empty: a check valve with a weak spring.

        t ──►┤>├──► a        opens as p_t - p_a rises from `crack` to `full`

    Size it so that `flow` is the largest the load can draw and `at` well below 1 bar: the pressure of the line then
    stays above vacuum, -1 bar. Given both pressures, gives the flow.
    """

    flow: FlowRate = parameter("flow, fully open, at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop", above=0, most=1e8)
    crack: Pressure = parameter("pressure drop at which the poppet lifts", default=0.1 * bar, above=0, most=1e6)
    full: Pressure = parameter("pressure drop at which it is fully open", default=0.4 * bar, above=0, most=1e6)
    transition_pressure: Pressure = transition_pressure()
    ports = {"t": Hydraulic("tank"), "a": Hydraulic("line to keep filled")}
    bond_graph = BondGraph("through: 1, seat: R", "t -> through, through -> a, through ->| seat")
    sources = (DISSERTATION,)

    def check(self) -> Iterator[Problem]:
        yield from _rising(type(self).__name__, ("crack", self.crack), ("full", self.full))

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        dp = m.t.p - m.a.p
        k = opening(dp, self.crack, self.full)
        yield m.t.q, k * rated_flow(dp, self.flow, self.at, self.transition_pressure)
        yield m.t.q + m.a.q, 0
        m.dissipates(m.t.q * dp)
