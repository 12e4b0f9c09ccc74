"""Ports: where components touch.

A power port carries an effort and a flow whose product is the power *into* the component that owns the port [W]. At a
node, the variable that is common to all ports is the *across* variable; the one that sums to zero is the *through*
variable. In hydraulics the effort (pressure) is common; in mechanics the flow (velocity) is.

    domain         across       through      meaning of a positive through variable
    hydraulic      p [Pa]       q [m3/s]     oil flows into the component
    translational  v [m/s]      F [N]        the surroundings push the component along +v
    rotational     w [rad/s]    T [N.m]      the surroundings turn the component along +w

A signal port carries one number with its unit; it has a direction.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar


@dataclass(frozen=True)
class PowerPort:
    """A port that carries power; see the module for the variables of each domain."""

    about: str = ""

    domain: ClassVar[str]
    across: ClassVar[str]
    through: ClassVar[str]
    across_unit: ClassVar[str]
    through_unit: ClassVar[str]
    across_nominal: ClassVar[float]
    through_nominal: ClassVar[float]


@dataclass(frozen=True)
class Hydraulic(PowerPort):
    """Pressure p [Pa, gauge] and volume flow q [m3/s] at port pressure, positive into the component."""

    domain = "hydraulic"
    across, across_unit, across_nominal = "p", "Pa", 1e7
    through, through_unit, through_nominal = "q", "m3/s", 1e-2


@dataclass(frozen=True)
class Translational(PowerPort):
    """Velocity v [m/s] and force F [N] on the component, positive along v."""

    domain = "translational"
    across, across_unit, across_nominal = "v", "m/s", 1.0
    through, through_unit, through_nominal = "F", "N", 1e5


@dataclass(frozen=True)
class Rotational(PowerPort):
    """Angular velocity w [rad/s] and torque T [N.m] on the component, positive along w."""

    domain = "rotational"
    across, across_unit, across_nominal = "w", "rad/s", 10.0
    through, through_unit, through_nominal = "T", "N.m", 1e4


@dataclass(frozen=True)
class SignalIn:
    """A number the component is given, in `unit`; `minimum` and `maximum` say what is meaningful.

    `start` names the value of the component that the number has as long as nobody gives another; without, it is zero.
    """

    unit: str = "1"
    about: str = ""
    minimum: float = -math.inf
    maximum: float = math.inf
    shown: str = ""
    start: str = ""


@dataclass(frozen=True)
class SignalOut:
    """A number the component computes, in `unit`."""

    unit: str = "1"
    about: str = ""
    shown: str = ""


Port = PowerPort | SignalIn | SignalOut
