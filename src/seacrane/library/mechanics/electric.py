"""The electric motor that drives a pump."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

from seacrane.errors import Problem
from seacrane.library import symbols
from seacrane.model import BondGraph, Component, Rotational, initial, parameter
from seacrane.units import Frequency, Inertia, Ratio, ShaftSpeed, Torque, rpm

KLOSS = "M. Kloss, Drehmoment und Schluepfung des Drehstrommotors, Archiv fuer Elektrotechnik 5, 1916"


class ElectricMotor(Component):
    """A three-phase induction motor on the mains, with the inertia of its rotor.

        mains ──►(M~)══ shaft        J dw/dt = T_e + T_shaft
                                     T_e = 2 T_m s s_m / (s^2 + s_m^2),   s = 1 - w / w_0,   w_0 = 2 pi f / pole pairs

    T_m `breakdown_torque`, the most it can give, at the slip s_m: 2 to 3 times the rated torque. Switched on all the
    time; it starts at `speed`, by default standing still. The steady law of Kloss: no stator resistance, no electrical
    transients. The mains supply T_e w_0, of which the rotor turns T_e (w_0 - w) into heat; J w dw/dt is stored. Given
    the torque, gives the speed.
    """

    breakdown_torque: Torque = parameter("most torque T_m", above=0, most=1e7)
    breakdown_slip: Ratio = parameter(
        "slip s_m at that torque", default=0.15, reason="motors of 50 to 500 kW: 0.1 to 0.2", above=0, most=1
    )
    mains: Frequency = parameter(
        "frequency f of the mains", default=60.0, reason="the usual net of ships", above=0, most=400
    )
    pole_pairs: Ratio = parameter(
        "pairs of poles", default=2, reason="1800 rpm at 60 Hz, as pumps like it", least=1, most=20
    )
    inertia: Inertia = parameter("inertia of rotor and coupling", above=0, most=1e6)
    speed: ShaftSpeed = initial("speed at the start", least=0, most=1e3)
    ports = {"shaft": Rotational("shaft")}
    bond_graph = BondGraph(
        "mains: Sf, field: 0, slip: R, rotor: 1, inertia: I",
        "mains |-> field, field |-> slip, field -> rotor, rotor ->| inertia, shaft -> rotor",
    )
    icon = symbols.ELECTRIC_MOTOR
    sources = (KLOSS,)

    def check(self) -> Iterator[Problem]:
        synchronous = 2 * pi * self.mains / self.pole_pairs
        if self.speed > synchronous:
            what = f"{self.speed / rpm:g} rpm must not be above the synchronous {synchronous / rpm:g} rpm"
            yield Problem("speed", what)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.state("speed", unit="rad/s", start=self.speed, nominal=100.0, about="speed of the rotor")
        synchronous = 2 * pi * self.mains / self.pole_pairs
        slip = 1 - w / synchronous
        torque = 2 * self.breakdown_torque * slip * self.breakdown_slip / (slip**2 + self.breakdown_slip**2)
        yield m.shaft.w, w
        yield self.inertia * m.der(w), torque + m.shaft.T
        m.stores(self.inertia * w * m.der(w))
        m.dissipates(torque * (synchronous - w))
        m.supplies(torque * synchronous)
        m.observe("torque", torque, "N.m", "torque of the field on the rotor")
        m.observe("power", torque * synchronous, "W", "power from the mains")
