"""A few components small enough to check the compiler by hand."""

from math import pi

import casadi as ca

from seacrane.model import (
    Component,
    Hydraulic,
    Rotational,
    SignalIn,
    SignalOut,
    Translational,
    initial,
    parameter,
    shared,
)
from seacrane.units import Density, Diameter, Force, Frequency, Inertia, Mass, Pressure, Ratio, Stiffness, Volume


class PressureSource(Component):
    pressure: Pressure = parameter("set pressure", above=0)
    ports = {"p": Hydraulic()}

    def equations(self, m):
        yield m.p.p, self.pressure


class Orifice(Component):
    diameter: Diameter = parameter("bore of the orifice", above=0)
    density: Density = shared("fluid density", default=870.0, above=0)
    ports = {"a": Hydraulic(), "b": Hydraulic()}


class TurbulentOrifice(Orifice, level="turbulent"):
    cd: Ratio = parameter("discharge coefficient", default=0.7, above=0)
    sources = ("Merritt, Hydraulic Control Systems, 1967, eq. 3-30",)

    def equations(self, m):
        dp = m.a.p - m.b.p
        area = pi / 4 * self.diameter**2
        yield m.a.q, self.cd * area * ca.sqrt(2 / self.density) * dp / ca.sqrt(ca.sqrt(dp * dp + 4e8))
        yield m.a.q + m.b.q, 0
        m.dissipates(m.a.power + m.b.power)


class LinearOrifice(Orifice, level="linear"):
    conductance: Ratio = parameter("flow per pressure", default=1e-11, above=0)

    def equations(self, m):
        yield m.a.q, self.conductance * (m.a.p - m.b.p)
        yield m.a.q + m.b.q, 0


class Chamber(Component):
    volume: Volume = parameter("volume", above=0)
    pressure: Pressure = initial("initial pressure")
    ports = {"a": Hydraulic()}

    def equations(self, m):
        p = m.state("p", unit="Pa", start=self.pressure, nominal=1e6)
        yield m.a.p, p
        yield m.der(p), 1e9 / self.volume * m.a.q


class MassBlock(Component):
    mass: Mass = parameter("mass", above=0)
    ports = {"flange": Translational()}

    def equations(self, m):
        v = m.state("v", unit="m/s")
        yield m.flange.v, v
        yield self.mass * m.der(v), m.flange.F


class Spring(Component):
    stiffness: Stiffness = parameter("stiffness", above=0)
    ports = {"a": Translational(), "b": Translational()}

    def equations(self, m):
        f = m.state("f", unit="N", nominal=1e3)
        yield m.der(f), self.stiffness * (m.a.v - m.b.v)
        yield m.a.F, f
        yield m.b.F, -f


class Wall(Component):
    ports = {"flange": Translational()}

    def equations(self, m):
        yield m.flange.v, 0


class Push(Component):
    force: Force = parameter("force along v", default=1000.0)
    ports = {"flange": Translational()}

    def equations(self, m):
        yield m.flange.F, -self.force


class Flywheel(Component):
    inertia: Inertia = parameter("inertia", above=0)
    ports = {"shaft": Rotational()}

    def equations(self, m):
        w = m.state("w", unit="rad/s")
        yield m.shaft.w, w
        yield self.inertia * m.der(w), m.shaft.T


class Lag(Component):
    rate: Frequency = parameter("corner rate", default=2.0, above=0)
    ports = {"u": SignalIn("m", "what is followed"), "y": SignalOut("m", "what follows")}

    def equations(self, m):
        y = m.state("level", unit="m")
        yield m.y, y
        yield m.der(y), self.rate * (m.u - y)


class InMillimetre(Component):
    ports = {"u": SignalIn("mm")}

    def equations(self, m):
        m.observe("reading", m.u, "mm")
        yield from ()
