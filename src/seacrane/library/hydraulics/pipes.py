"""Pipes and hoses: friction, inertia and compressibility of the oil in a line, one by one or together."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any, ClassVar

import casadi as ca

from seacrane.errors import Problem
from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, MERRITT
from seacrane.model import BondGraph, Component, Hydraulic, initial, option, parameter
from seacrane.numerics.regularise import limit, maximum
from seacrane.units import Area, Density, Diameter, FlowRate, KinematicViscosity, Length, Pressure, Ratio, mm

from .fluid import bulk_modulus, density, viscosity

LAMINAR, TURBULENT = 2300.0, 4000.0
"""Reynolds numbers at which laminar flow ends and fully turbulent flow begins; friction is blended between them."""

HAALAND = "S. E. Haaland, Simple and explicit formulas for the friction factor in turbulent pipe flow, 1983"
WHITE = "F. M. White, Fluid Mechanics, 7th ed., 2011, sections 6.4 and 6.6"
_MOST_SEGMENTS = 50


def friction_number(reynolds: Any, roughness: Any) -> Any:
    """f Re^2 sign(Re): the Darcy friction factor f times the square of the Reynolds number, odd in Re.

        laminar    f = 64 / Re                                                       |Re| below 2300
        turbulent  1 / sqrt(f) = -1.8 log10((6.9 / Re) + (roughness / 3.7)^1.11)      |Re| above 4000 (Haaland)

    `roughness` is relative to the diameter. Between the two, f is blended by a cubic in Re, so that slopes are
    continuous. Written as a product with Re^2 because f alone has a pole at rest. Haaland is within 2 % of Colebrook.
    """
    speed = abs(reynolds)
    turbulent_speed = maximum(speed, LAMINAR)
    root = -1.8 * ca.log10(6.9 / turbulent_speed + (roughness / 3.7) ** 1.11)
    s = limit((speed - LAMINAR) / (TURBULENT - LAMINAR), 0.0, 1.0)
    blend = s * s * (3 - 2 * s)
    return reynolds * (64 * (1 - blend) + blend * speed / root**2)


class Pipe(Component):
    """A straight round pipe full of oil.

        a ══════════════════ b        q_a > 0 and q_b < 0: oil goes from a to b
             length, diameter

    Levels, each with A = pi/4 diameter^2:

    - `resistance`: friction only, p_a - p_b = f (L/d) rho/2 (q/A)^2 (Darcy-Weisbach). Given the flow, gives the
      pressure drop.
    - `inertia`: the mass of the oil only, dq/dt = A / (rho L) (p_a - p_b). Given both pressures, gives the flow.
    - `compressibility`: dp/dt = beta / (A L) (q_a + q_b), p_a = p_b = p. Given both flows, gives the pressure.
    - `line`: all three, in a chain of `segments`. Given both flows, gives both pressures.

    Choose by time: a pipe of 10 m answers to a wave in 10 ms. Below that, `line`; above, `compressibility` with
    `resistance`, or nothing.
    """

    length: Length = parameter("length of the pipe", above=0, most=1e4)
    diameter: Diameter = parameter("inner diameter", above=0, most=1)
    ports = {"a": Hydraulic("one end"), "b": Hydraulic("other end")}
    icon = symbols.PIPE
    sources: ClassVar[tuple[str, ...]] = (WHITE, f"{MERRITT}, chapter 3", DISSERTATION)

    @property
    def area(self) -> Area:
        """Cross-section A [m2]."""
        return pi / 4 * self.diameter**2


def _friction_drop(q: Any, length: Any, diameter: Any, density: Any, viscosity: Any, roughness: Any) -> Any:
    """p_a - p_b [Pa] at the flow q [m3/s]: f Re^2 (rho nu^2 L) / (2 d^3), which is Darcy-Weisbach."""
    reynolds = 4 * q / (pi * diameter * viscosity)
    return friction_number(reynolds, roughness / diameter) * density * viscosity**2 * length / (2 * diameter**3)


class ResistivePipe(Pipe, level="resistance"):
    """Friction only: laminar, turbulent and between, see `friction_number`. Turns q (p_a - p_b) into heat."""

    roughness: Length = parameter("height of the wall's roughness", default=0.0, least=0, most=0.01)
    density: Density = density()
    viscosity: KinematicViscosity = viscosity()
    bond_graph = BondGraph("through: 1, friction: R", "a -> through, through -> b, through |-> friction")
    sources = (*Pipe.sources, HAALAND)

    def check(self) -> Iterator[Problem]:
        yield from _roughness_problem(self.roughness, self.diameter)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        drop = _friction_drop(m.a.q, self.length, self.diameter, self.density, self.viscosity, self.roughness)
        yield m.a.p - m.b.p, drop
        yield m.a.q + m.b.q, 0
        m.dissipates(m.a.q * drop)
        m.observe("reynolds", 4 * m.a.q / (pi * self.diameter * self.viscosity), "1", "Reynolds number")


class InertialPipe(Pipe, level="inertia"):
    """The mass of the oil only: stores (rho L / A) q dq/dt."""

    density: Density = density()
    flow: FlowRate = initial("flow from a to b at the start", least=-10, most=10)
    bond_graph = BondGraph("through: 1, mass: I", "a -> through, through -> b, through ->| mass")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        q = m.state("flow", unit="m3/s", start=self.flow, nominal=1e-3, about="flow from a to b")
        yield m.a.q, q
        yield m.b.q, -q
        yield m.der(q), self.area / (self.density * self.length) * (m.a.p - m.b.p)
        m.stores(q * (m.a.p - m.b.p))


class CompressiblePipe(Pipe, level="compressibility"):
    """The yielding of the oil only: a `ControlVolume` of A L with two ends. Stores p (q_a + q_b)."""

    bulk_modulus: Pressure = bulk_modulus()
    pressure: Pressure = initial("pressure at the start (gauge)", least=-1e5, most=1e8)
    bond_graph = BondGraph("inside: 0, oil: C", "a -> inside, inside -> b, inside |-> oil")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        p = m.state("pressure", unit="Pa", start=self.pressure, nominal=1e6, about="pressure in the pipe")
        net = m.a.q + m.b.q
        yield m.a.p, p
        yield m.b.p, p
        yield m.der(p), self.bulk_modulus / (self.area * self.length) * net
        m.stores(p * net)


class LinePipe(Pipe, level="line"):
    """Friction, inertia and compressibility in a chain: n inertias with friction between n + 1 volumes.

        a ──┬──▭~──┬──▭~──┬── b        ▭ friction   ~ inertia, of L/n each
            ┴      ┴      ┴            ┴ volumes of A L/n, half that at the ends

    Closed at both ends and without friction its frequencies are 2 n (c/L) sin(k pi / 2n), c = sqrt(beta/rho), which
    tend to k pi c / L: n segments show n/3 waves within 5 %. Friction is that of steady flow. States: the pressures
    and flows of the chain.
    """

    segments: int = option("number of segments", default=5)
    roughness: Length = parameter("height of the wall's roughness", default=0.0, least=0, most=0.01)
    density: Density = density()
    viscosity: KinematicViscosity = viscosity()
    bulk_modulus: Pressure = bulk_modulus()
    pressure: Pressure = initial("pressure at the start (gauge)", least=-1e5, most=1e8)
    bond_graph = BondGraph(
        "first: 0, oil_a: C, through: 1, friction: R, mass: I, last: 0, oil_b: C",
        "a -> first, first |-> oil_a, first -> through, through |-> friction, through ->| mass, through -> last,"
        "last |-> oil_b, last -> b",
    )
    sources = (*Pipe.sources, HAALAND)

    def check(self) -> Iterator[Problem]:
        yield from _roughness_problem(self.roughness, self.diameter)
        if not isinstance(self.segments, int) or not 1 <= self.segments <= _MOST_SEGMENTS:
            allowed = f"a whole number from 1 to {_MOST_SEGMENTS}"
            yield Problem("segments", "is no number of segments", self.segments, allowed)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from _chain(m, self, self.segments, self.bulk_modulus)


class Hose(Component):
    """A hose: a pipe whose wall yields as well as the oil, 1/beta_eff = 1/beta + 1/wall_modulus.

        a ~~~~~~~~~~~~~~~~~~ b

    Friction, inertia and two volumes (a `Pipe` of level `line` with one segment). `wall_modulus` is d p / (d V / V)
    of the hose alone: steel-spiral high-pressure hoses have 3e8 to 1e9 Pa, textile ones 1e8 Pa or less; the data
    sheet's volume expansion per metre gives it. Given both flows, gives both pressures.
    """

    length: Length = parameter("length of the hose", above=0, most=1e3)
    diameter: Diameter = parameter("inner diameter", above=0, most=1)
    wall_modulus: Pressure = parameter("pressure per relative growth of the inner volume", above=1e6, most=1e12)
    roughness: Length = parameter(
        "height of the wall's roughness", default=0.005 * mm, reason="smooth rubber", least=0, most=0.01
    )
    density: Density = density()
    viscosity: KinematicViscosity = viscosity()
    bulk_modulus: Pressure = bulk_modulus()
    pressure: Pressure = initial("pressure at the start (gauge)", least=-1e5, most=1e8)
    ports = {"a": Hydraulic("one end"), "b": Hydraulic("other end")}
    bond_graph = LinePipe.bond_graph
    icon = symbols.HOSE
    sources = (f"{MERRITT}, chapter 2", WHITE, HAALAND)

    def check(self) -> Iterator[Problem]:
        yield from _roughness_problem(self.roughness, self.diameter)

    @property
    def area(self) -> Area:
        """Cross-section A [m2]."""
        return pi / 4 * self.diameter**2

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from _chain(m, self, 1, 1 / (1 / self.bulk_modulus + 1 / self.wall_modulus))


def _chain(m: Any, pipe: LinePipe | Hose, segments: int, modulus: Any) -> Iterator[tuple[Any, Any]]:
    """The laws of a line of `segments`; see `LinePipe`."""
    length = pipe.length / segments
    volume = pipe.area * length
    pressures = [
        m.state(f"pressure_{i}", unit="Pa", start=pipe.pressure, nominal=1e6, about=f"pressure at {i} of {segments}")
        for i in range(segments + 1)
    ]
    flows = [
        m.state(f"flow_{i}", unit="m3/s", nominal=1e-3, about=f"flow in segment {i}") for i in range(1, segments + 1)
    ]
    yield m.a.p, pressures[0]
    yield m.b.p, pressures[-1]
    squeezing: Any = 0
    hastening: Any = 0
    for i, p in enumerate(pressures):
        inflow = flows[i - 1] if i > 0 else m.a.q
        outflow = flows[i] if i < segments else -m.b.q
        share = 1.0 if 0 < i < segments else 0.5
        yield m.der(p), modulus / (share * volume) * (inflow - outflow)
        squeezing += p * (inflow - outflow)
    for i, q in enumerate(flows):
        drop = _friction_drop(q, length, pipe.diameter, pipe.density, pipe.viscosity, pipe.roughness)
        net = pressures[i] - pressures[i + 1] - drop
        yield m.der(q), pipe.area / (pipe.density * length) * net
        hastening += q * net
        m.dissipates(q * drop)
    m.stores(squeezing + hastening)
    m.observe("compression_power", squeezing, "W", "power into the compression of the oil")
    m.observe("inertia_power", hastening, "W", "power into the motion of the oil")


def _roughness_problem(roughness: Ratio, diameter: Diameter) -> Iterator[Problem]:
    if roughness > 0.05 * diameter:
        allowed = f"at most {0.05 * diameter / mm:g} mm, 5 % of the diameter"
        yield Problem("roughness", f"{roughness / mm:g} mm leaves the range of the law", allowed=allowed)
