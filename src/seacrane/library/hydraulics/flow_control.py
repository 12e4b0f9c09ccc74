"""Components that share, meter, clean and select flow: compensator, divider, filter and shuttle valve."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.errors import Problem
from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, MERRITT, WATTON
from seacrane.model import BondGraph, Component, Hydraulic, parameter
from seacrane.numerics.regularise import smooth_limit, smooth_sign
from seacrane.units import FlowRate, KinematicViscosity, Pressure, Ratio, bar

from .fluid import rated_flow, transition_pressure, viscosity
from .opening import ROUNDING, opening, passing, rising

RATED_COMPENSATOR_DROP = 5 * bar
"""The pressure drop at which data sheets state the flow of a compensator (q_dp5)."""

DATA_SHEET_VISCOSITY = 30e-6
"""The viscosity [m2/s] at which data sheets state the pressure drop of a filter."""


class PressureCompensator(Component):
    """Keeps the pressure drop over a metering edge near `setting`: closes as p_s - p_ls comes up to it.

        a ──►[ ≷ ]──►─┬─ b ──►(metering edge)──► load
              s ┄┄┄┄┄┄┘                           ┆
              ls ┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┄┘

        k = (setting - (p_s - p_ls)) / setting, held within [0, 1];    q = k flow sqrt(dp / 5 bar),   dp = p_a - p_b

    In front of a metering edge, join s to b. s and ls sense pressure and take no flow. `flow` is what passes fully open
    under 5 bar (q_dp5). The edge keeps a drop a little below `setting`: by flow/q_dp5 of it at 5 bar over the
    compensator. Given four pressures, gives the flow.
    """

    flow: FlowRate = parameter("flow, fully open, at 5 bar", above=0, most=1)
    setting: Pressure = parameter(
        "pressure drop p_s - p_ls at which it is closed",
        default=10 * bar,
        reason="compensators are set to 5 to 15 bar",
        above=0,
        most=1e8,
    )
    transition_pressure: Pressure = transition_pressure()
    ports = {
        "a": Hydraulic("inlet"),
        "b": Hydraulic("outlet"),
        "s": Hydraulic("pressure before the metering edge"),
        "ls": Hydraulic("pressure of the load"),
    }
    bond_graph = BondGraph(
        "through: 1, edge: MR, sensing_s: Sf, sensing_ls: Sf",
        "a -> through, through -> b, through ->| edge, s ->| sensing_s, ls ->| sensing_ls, s ~> edge, ls ~> edge",
    )
    icon = symbols.PRESSURE_COMPENSATOR
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        k = smooth_limit(1 - (m.s.p - m.ls.p) / self.setting, 0.0, 1.0, ROUNDING)
        q = k * rated_flow(m.a.p - m.b.p, self.flow, RATED_COMPENSATOR_DROP, self.transition_pressure)
        yield from passing(m, m.a, m.b, q)
        yield m.s.q, 0
        yield m.ls.q, 0
        m.observe("opening", k, "1", "opening, of full area")


class FlowDivider(Component):
    """A gear flow divider: two gear sections on one shaft share the flow, whatever the pressures.

                 ┌──► b   share r                 q_b = -r q_a,   q_c = -(1 - r) q_a
        a ──►(⚙═⚙)                                p_a = r p_b + (1 - r) p_c + p_f sign(q_a)
                 └──► c   share 1 - r

    A transformer: the section under less load drives the other, so that p_b may be above p_a. p_f is the pressure that
    friction takes, its sign rounded within `friction_flow`. Works in both directions. Given two pressures and a flow,
    gives the rest.
    """

    share: Ratio = parameter("share r of the flow that b gets", default=0.5, reason="equal sections", above=0, below=1)
    friction: Pressure = parameter("pressure drop of friction", default=0.0, least=0, most=1e7)
    friction_flow: FlowRate = parameter(
        "flow within which it turns its sign", default=1e-5, reason="0.6 l/min, below any working flow", above=0, most=1
    )
    ports = {"a": Hydraulic("inlet"), "b": Hydraulic("outlet of share r"), "c": Hydraulic("outlet of the rest")}
    bond_graph = BondGraph(
        "through: 1, friction: R, shaft: 1, inlet: TF, section_b: TF, section_c: TF",
        "a -> through, through |-> friction, through -> inlet, inlet -> shaft, shaft -> section_b, shaft -> section_c,"
        "section_b -> b, section_c -> c",
    )
    icon = symbols.FLOW_DIVIDER
    sources = (f"{MERRITT}, chapter 4 (gear machines)",)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        loss = self.friction * smooth_sign(m.a.q, self.friction_flow)
        yield m.b.q, -self.share * m.a.q
        yield m.c.q, -(1 - self.share) * m.a.q
        yield m.a.p, self.share * m.b.p + (1 - self.share) * m.c.p + loss
        m.dissipates(loss * m.a.q)


class Filter(Component):
    """A filter element with a bypass valve: q = G (nu_0 / nu) (1 - clogging) dp + bypass(dp), dp = p_a - p_b.

             ┌──[╎]──┐
        a ───┤       ├── b        G = flow / at, from the data sheet at nu_0 = 30 mm2/s
             └──┤>├──┘            bypass: opens from `crack` to `full`, and then passes `flow` at `full`

    Flow through the element is laminar, so that its drop goes with the viscosity nu. `clogging` is the share of the
    element that dirt has shut. Given both pressures, gives the flow.
    """

    flow: FlowRate = parameter("rated flow", above=0, most=1)
    at: Pressure = parameter("pressure drop of the clean element at the rated flow, at 30 mm2/s", above=0, most=1e7)
    clogging: Ratio = parameter("share of the element that is clogged", default=0.0, least=0, most=1)
    crack: Pressure = parameter(
        "pressure drop at which the bypass opens",
        default=3.5 * bar,
        reason="common setting of return filters",
        above=0,
        most=1e7,
    )
    full: Pressure = parameter(
        "pressure drop at which it is fully open",
        default=5 * bar,
        reason="below the collapse pressure of return elements, 10 bar",
        above=0,
        most=1e7,
    )
    viscosity: KinematicViscosity = viscosity()
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("dirty side"), "b": Hydraulic("clean side")}
    bond_graph = BondGraph(
        "through: 1, drop: 0, element: R, bypass: R",
        "a -> through, through -> b, through -> drop, drop ->| element, drop ->| bypass",
    )
    icon = symbols.FILTER
    sources = ("ISO 3968:2017 (pressure drop of filters over flow)",)

    def check(self) -> Iterator[Problem]:
        yield from rising(("crack", self.crack), ("full", self.full))

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        dp = m.a.p - m.b.p
        element = (1 - self.clogging) * self.flow * dp / self.at * DATA_SHEET_VISCOSITY / self.viscosity
        k = opening(dp, self.crack, self.full)
        bypass = k * rated_flow(dp, self.flow, self.full, self.transition_pressure)
        yield from passing(m, m.a, m.b, element + bypass)
        m.observe("bypass", k, "1", "opening of the bypass, of full area")


class ShuttleValve(Component):
    """Joins the higher of two pressures to its outlet, as for load sensing.

        a ──►(o)◄── b        k = 1/2 + (p_a - p_b) / (2 shift), held within [0, 1]
              │              q_a = k flow sqrt(|p_a - p_c| / at) sign, q_b = (1 - k) flow sqrt(|p_b - p_c| / at) sign
              c

    The ball shifts over `shift` of pressure difference. Where only sensing ports hang on c, add a small
    `ControlVolume` (the hose), so that its pressure is a state. Given three pressures, gives the flows.
    """

    flow: FlowRate = parameter("flow at the rated pressure drop", above=0, most=1)
    at: Pressure = parameter("rated pressure drop", above=0, most=1e8)
    shift: Pressure = parameter(
        "pressure difference that moves the ball over",
        default=0.5 * bar,
        reason="a light ball without a spring",
        above=0,
        most=1e7,
    )
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("inlet"), "b": Hydraulic("other inlet"), "c": Hydraulic("outlet")}
    bond_graph = BondGraph(
        "from_a: 1, from_b: 1, seat_a: MR, seat_b: MR, out: 0",
        "a -> from_a, from_a ->| seat_a, from_a -> out, b -> from_b, from_b ->| seat_b, from_b -> out, out -> c,"
        "a ~> seat_b, b ~> seat_a",
    )
    icon = symbols.SHUTTLE_VALVE
    sources = (WATTON,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        k = smooth_limit(0.5 + (m.a.p - m.b.p) / (2 * self.shift), 0.0, 1.0, ROUNDING)
        dp_a, dp_b = m.a.p - m.c.p, m.b.p - m.c.p
        q_a = k * rated_flow(dp_a, self.flow, self.at, self.transition_pressure)
        q_b = (1 - k) * rated_flow(dp_b, self.flow, self.at, self.transition_pressure)
        yield m.a.q, q_a
        yield m.b.q, q_b
        yield m.c.q, -(q_a + q_b)
        m.dissipates(q_a * dp_a + q_b * dp_b)
