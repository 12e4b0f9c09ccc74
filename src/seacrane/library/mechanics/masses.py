"""Masses and inertias."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.library import symbols
from seacrane.library.references import DISSERTATION
from seacrane.model import BondGraph, Component, Rotational, Translational, initial, parameter
from seacrane.units import (
    GRAVITY,
    Acceleration,
    AngularSpeed,
    Length,
    Speed,
)
from seacrane.units import (
    Inertia as MomentOfInertia,
)
from seacrane.units import (
    Mass as KilogramMass,
)


class Mass(Component):
    """A mass on a line: m dv/dt = sum of F - m g. Stores m v dv/dt; gravity supplies -m g v. Given the force,
    gives the speed. Levels:

    - `horizontal`: no weight, unless `gravity` gives the share of it against +v, as on a slope.
    - `vertical`: +v points up; the weight is always there, and the mass knows its height.
    """

    mass: KilogramMass = parameter("mass", above=0, most=1e9)
    speed: Speed = initial("speed at the start", least=-1e3, most=1e3)
    ports = {"flange": Translational("where forces act")}
    bond_graph = BondGraph(
        "motion: 1, inertia: I, weight: Se", "flange -> motion, motion ->| inertia, weight ->| motion"
    )
    icon = symbols.MASS
    sources = (DISSERTATION,)

    def moving(self, m: Any, gravity: Any) -> Iterator[tuple[Any, Any]]:
        """Newton's law against `gravity` [m/s2] along -v."""
        v = m.state("speed", unit="m/s", start=self.speed, about="speed of the mass")
        yield m.flange.v, v
        yield self.mass * m.der(v), m.flange.F - self.mass * gravity
        m.stores(self.mass * v * m.der(v))
        m.supplies(-self.mass * gravity * v)


class HorizontalMass(Mass, level="horizontal"):
    """`gravity` is the share of gravity against +v: 0 on the level."""

    gravity: Acceleration = parameter("gravity against +v", default=0.0, least=-100, most=100)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.moving(m, self.gravity)


class VerticalMass(Mass, level="vertical"):
    """+v points up: dh/dt = v, m dv/dt = sum of F - m g."""

    gravity: Acceleration = parameter("gravity", default=GRAVITY, least=0, most=100)
    height: Length = initial("height at the start", least=-1e5, most=1e5)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        h = m.state("height", unit="m", start=self.height, about="height of the mass")
        yield m.der(h), m.flange.v
        yield from self.moving(m, self.gravity)


class Inertia(Component):
    """A rotating inertia: J dw/dt = sum of T. Given the torque, gives the speed."""

    inertia: MomentOfInertia = parameter("moment of inertia", above=0, most=1e9)
    speed: AngularSpeed = initial("speed at the start", least=-1e4, most=1e4)
    ports = {"flange": Rotational("where torques act")}
    bond_graph = BondGraph("inertia: I", "flange ->| inertia")
    icon = symbols.INERTIA
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.state("speed", unit="rad/s", start=self.speed, nominal=10.0, about="speed of the inertia")
        yield m.flange.w, w
        yield self.inertia * m.der(w), m.flange.T
        m.stores(self.inertia * w * m.der(w))
