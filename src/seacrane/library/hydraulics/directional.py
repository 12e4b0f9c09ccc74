"""Directional valves: proportional and on/off.

A valve is sized as its data sheet does it: `flow` through one edge, fully open, under the pressure drop `at`.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import Any

from seacrane.errors import Problem
from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, MERRITT
from seacrane.model import BondGraph, Component, Hydraulic, SignalIn, initial, parameter
from seacrane.numerics.regularise import limit, maximum, minimum, positive_part
from seacrane.units import AngularFrequency, FlowRate, Pressure, Ratio, Time

from .fluid import rated_flow, transition_pressure
from .opening import ROUNDING

_NARROWEST_DEAD_BAND = 1e-6  # keeps a quotient finite where there is no dead band, and no floating centre either


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

    Levels:

    - `static`: the spool is where the command is.
    - `dynamic`: it follows as a second-order lag.
    - `rate-limited`: so does it, but no faster than the pilot stage can fill it.
    - `compensated`: `static`, with a pressure compensator before the inlet edge: the flow is that of the command,
      whatever the load, as long as the supply has `margin` to spare.
    """

    flow: FlowRate = parameter("flow through one edge, fully open, at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop per edge", above=0, most=1e8)
    dead_band: Ratio = parameter(
        "overlap of the spool, of full travel", default=0.05, reason="proportional valves: 5 to 20 %", least=0, most=0.9
    )
    leakage: Ratio = parameter(
        "opening that remains on a closed edge, of full area",
        default=1e-4,
        reason="radial clearance of a spool",
        least=0,
        most=0.1,
    )
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
        "bt -> to_t, pa ->| edge_pa, pb ->| edge_pb, at ->| edge_at, bt ->| edge_bt, to_a -> a, to_b -> b, to_t -> t,"
        "x ~> edge_pa, x ~> edge_pb, x ~> edge_at, x ~> edge_bt",
    )
    icon = symbols.DIRECTIONAL_VALVE_43
    sources = (f"{MERRITT}, chapter 5", DISSERTATION)

    def check(self) -> Iterator[Problem]:
        if self.float_centre > 0 and self.dead_band == 0:
            yield Problem(
                "float_centre", "needs a dead band to fade out in", self.float_centre, "0, or dead_band above 0"
            )

    def metering_drop(self, dp: Any) -> Any:
        """The pressure drop that an inlet edge sees, of the drop `dp` from p to a or b."""
        return dp

    def edges(self, m: Any, spool: Any) -> Iterator[tuple[Any, Any]]:
        """The flows of the four edges for this spool position."""
        pa = minimum(positive_part((spool - self.dead_band) / (1 - self.dead_band), ROUNDING), 1.0)
        pb = minimum(positive_part((-spool - self.dead_band) / (1 - self.dead_band), ROUNDING), 1.0)

        within = spool / maximum(self.dead_band, _NARROWEST_DEAD_BAND)
        floating = self.float_centre * maximum(1 - within * within, 0.0) ** 2

        def edge(fraction: Any, upper: Any, lower: Any) -> Any:
            dp = upper.p - lower.p
            metering = self.metering_drop(dp) if upper is m.p else dp
            q = (fraction + self.leakage) * rated_flow(metering, self.flow, self.at, self.transition_pressure)
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

    natural_frequency: AngularFrequency = parameter("natural frequency of the spool", above=0, most=1e4)
    damping: Ratio = parameter(
        "damping ratio of the spool",
        default=0.8,
        reason="overshoots by 1.5 %, as step responses of data sheets",
        above=0,
        most=10,
    )

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        s = m.state("spool_position", unit="1", about="spool position, of full travel")
        v = m.state("spool_speed", unit="1/s", nominal=10.0, about="speed of the spool")
        w = self.natural_frequency
        yield m.der(s), v
        yield m.der(v), w * w * (limit(m.x, -1.0, 1.0) - s) - 2 * self.damping * w * v
        yield from self.edges(m, s)


class RateLimitedDirectionalValve43(DirectionalValve43, level="rate-limited"):
    """A second-order lag whose speed is bounded: s' = v held within [-1/T, 1/T], T = `travel_time` for full travel.

    v' = w_n^2 (x - s) - 2 zeta w_n v, which stops growing where v is at its bound: the acceleration is cut off over the
    last 1 % of the speed. Small steps show w_n, large ones T, as the data sheet of a pilot-operated valve gives both.
    """

    natural_frequency: AngularFrequency = parameter("natural frequency of the spool", above=0, most=1e4)
    damping: Ratio = parameter(
        "damping ratio of the spool",
        default=0.8,
        reason="overshoots by 1.5 %, as step responses of data sheets",
        above=0,
        most=10,
    )
    travel_time: Time = parameter("time from the centre to full travel, at the least", above=0, most=100)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        s = m.state("spool_position", unit="1", about="spool position, of full travel")
        v = m.state("spool_speed", unit="1/s", nominal=10.0, about="speed of the spool")
        w, fastest = self.natural_frequency, 1 / self.travel_time
        free = w * w * (limit(m.x, -1.0, 1.0) - s) - 2 * self.damping * w * v
        onward = limit((fastest - v) / (ROUNDING * fastest), 0.0, 1.0)
        back = limit((fastest + v) / (ROUNDING * fastest), 0.0, 1.0)
        yield m.der(s), v
        yield m.der(v), maximum(free, 0.0) * onward + minimum(free, 0.0) * back
        yield from self.edges(m, s)


class CompensatedDirectionalValve43(DirectionalValve43, level="compensated"):
    """An inlet edge sees dp where dp is below `margin`, and `margin` where it is above; the compensator takes the rest.

    Set `margin` to `at` for the rated flow at full travel. The corner is rounded over 5 % of the margin. Back from a or
    b to p, and to the tank, the edges are plain orifices.
    """

    margin: Pressure = parameter("pressure drop that the compensator leaves to the inlet edge", above=0, most=1e8)

    def metering_drop(self, dp: Any) -> Any:
        return dp - positive_part(dp - self.margin, 0.05 * self.margin)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.edges(m, limit(m.x, -1.0, 1.0))


# ---------------------------------------------------------------- on and off
class _Switched(Component):
    """What on/off valves share: one opening k for all paths, which a solenoid drives.

    T dk/dt = +1 or -1 until k has come to the command; the command is on from `on` > 0.55, off below 0.45, and in
    between in proportion. Over the last 5 % of the travel the approach is a first-order lag.
    """

    flow: FlowRate = parameter("flow through one path, fully open, at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop per path", above=0, most=1e8)
    switching_time: Time = parameter(
        "time T for the full travel", default=50e-3, reason="solenoid valves: 20 to 100 ms", above=0, most=100
    )
    leakage: Ratio = parameter(
        "opening that remains when closed, of full area",
        default=1e-6,
        reason="a poppet is tight; keeps a locked line determined",
        least=0,
        most=0.1,
    )
    opening: Ratio = initial("opening at the start", least=0, most=1)
    transition_pressure: Pressure = transition_pressure()
    sources = (DISSERTATION,)

    def spool(self, m: Any) -> Generator[tuple[Any, Any], None, Any]:
        """The law of k, the state `opening`; returns k."""
        k = m.state("opening", unit="1", start=self.opening, about="opening, of full area")
        command = limit((m.on - 0.45) / 0.1, 0.0, 1.0)
        yield m.der(k), limit((command - k) / 0.05, -1.0, 1.0) / self.switching_time
        return k

    def path(self, m: Any, k: Any, upper: Any, lower: Any) -> Any:
        """The flow of one path."""
        dp = upper.p - lower.p
        area = limit(k, 0.0, 1.0) + self.leakage
        q = area * rated_flow(dp, self.flow, self.at, self.transition_pressure)
        m.dissipates(q * dp)
        return q


class DirectionalValve22(_Switched):
    """An on/off valve with two ports: shut at rest, open from p to a when it is switched on.

              a
        ┌─┴─┬─│─┐
    on ►│ ┬ │ ↕ │      q = k flow sqrt(|dp| / at) sign(dp)
        └─┬─┴─│─┘
              p

    k runs between 0 and 1 in `switching_time`; see `on`. Given both pressures, gives the flow.
    """

    ports = {
        "on": SignalIn("1", "1 opens, 0 shuts", minimum=0, maximum=1),
        "p": Hydraulic("inlet"),
        "a": Hydraulic("outlet"),
    }
    bond_graph = BondGraph("through: 1, edge: MR", "p -> through, through -> a, through ->| edge, on ~> edge")
    icon = symbols.DIRECTIONAL_VALVE_22

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        k = yield from self.spool(m)
        q = self.path(m, k, m.p, m.a)
        yield m.p.q, q
        yield m.a.q, -q


class FourPortDirectionalValve22(_Switched):
    """An on/off valve with four ports: all shut at rest, p to a and b to t when it is switched on.

               a b
        ┌─┬─┬─┴─┴─┐
    on ►│ ↑ ↓ │ ⊥⊥│      each path as in `DirectionalValve22`
        └─┴─┴─┬─┬─┘
               p t
    """

    ports = {
        "on": SignalIn("1", "1 opens, 0 shuts", minimum=0, maximum=1),
        "p": Hydraulic("supply"),
        "t": Hydraulic("tank"),
        "a": Hydraulic("working port A"),
        "b": Hydraulic("working port B"),
    }
    bond_graph = BondGraph(
        "pa: 1, bt: 1, edge_pa: MR, edge_bt: MR",
        "p -> pa, pa -> a, pa ->| edge_pa, b -> bt, bt -> t, bt ->| edge_bt, on ~> edge_pa, on ~> edge_bt",
    )
    icon = symbols.FOUR_PORT_DIRECTIONAL_VALVE_22

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        k = yield from self.spool(m)
        q_pa, q_bt = self.path(m, k, m.p, m.a), self.path(m, k, m.b, m.t)
        yield m.p.q, q_pa
        yield m.a.q, -q_pa
        yield m.b.q, q_bt
        yield m.t.q, -q_bt
