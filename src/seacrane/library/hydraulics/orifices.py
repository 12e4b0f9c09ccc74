"""Orifices: fixed, and opened by a signal."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

from seacrane.library import symbols
from seacrane.library.references import DISSERTATION, MERRITT
from seacrane.model import BondGraph, Component, Hydraulic, SignalIn, parameter
from seacrane.numerics.regularise import limit
from seacrane.units import Density, Diameter, Pressure, Ratio

from .fluid import density, orifice_flow, transition_pressure
from .opening import passing

_SOURCES = (f"{MERRITT}, section 3.4", DISSERTATION)


class Orifice(Component):
    """A sharp-edged hole: q = c (pi/4 d^2) sqrt(2 |dp| / rho) sign(dp), dp = p_a - p_b.

        a ──►) (──► b

    d bore [m], c discharge coefficient, rho density [kg/m3]; smooth through zero (see `fluid`). Turns q dp into heat.
    Given both pressures, gives the flow.
    """

    diameter: Diameter = parameter("bore of the orifice", above=0, most=1.0)
    discharge: Ratio = parameter(
        "discharge coefficient", default=0.7, reason="rounded edges; 0.61 for sharp ones", above=0, most=1
    )
    density: Density = density()
    transition_pressure: Pressure = transition_pressure()
    ports = {"a": Hydraulic("inlet"), "b": Hydraulic("outlet")}
    bond_graph = BondGraph("through: 1, edge: R", "a -> through, through -> b, through ->| edge")
    icon = symbols.ORIFICE
    sources = _SOURCES

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        area = pi / 4 * self.diameter**2
        q = orifice_flow(m.a.p - m.b.p, area, self.discharge, self.density, self.transition_pressure)
        yield from passing(m, m.a, m.b, q)


class VariableOrifice(Component):
    """An orifice whose area a signal k in [0, 1] scales; k is held within its limits, closed means no flow."""

    diameter: Diameter = parameter("bore of the fully open orifice", above=0, most=1.0)
    discharge: Ratio = parameter(
        "discharge coefficient", default=0.7, reason="rounded edges; 0.61 for sharp ones", above=0, most=1
    )
    density: Density = density()
    transition_pressure: Pressure = transition_pressure()
    ports = {"k": SignalIn("1", "opening", minimum=0, maximum=1), "a": Hydraulic("inlet"), "b": Hydraulic("outlet")}
    bond_graph = BondGraph("through: 1, edge: MR", "a -> through, through -> b, through ->| edge, k ~> edge")
    icon = symbols.VARIABLE_ORIFICE
    sources = _SOURCES

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        area = limit(m.k, 0.0, 1.0) * pi / 4 * self.diameter**2
        q = orifice_flow(m.a.p - m.b.p, area, self.discharge, self.density, self.transition_pressure)
        yield from passing(m, m.a, m.b, q)
