"""Hydraulic components: sources, volumes, orifices, valves, cylinders and motors.

Pressures are gauge pressures: a tank open to the air is at 0 Pa, and oil cannot hold less than about -1e5 Pa. The laws
do not model cavitation; where a line may be sucked empty (an overrunning load), put an `AnticavitationValve` from tank
to it, as a real circuit has.

Volume flow is counted at port pressure, so that pressure times flow is the power through a port. The oil is one for a
whole diagram: `density`, `bulk_modulus` and `transition_pressure` are shared, as in `Diagram("drive", density=860.0)`.
"""

from .cylinders import DoubleActingCylinder
from .motors import HydraulicMotor
from .orifices import Orifice, VariableOrifice
from .sources import ConstantFlowPump, ConstantPressurePump, FlowInput, Plug, PressureInput, Tank
from .valves import (
    AnticavitationValve,
    CheckValve,
    CounterbalanceValve,
    DirectionalValve43,
    ReliefValve,
)
from .volumes import ControlVolume

__all__ = [
    "AnticavitationValve",
    "CheckValve",
    "ConstantFlowPump",
    "ConstantPressurePump",
    "ControlVolume",
    "CounterbalanceValve",
    "DirectionalValve43",
    "DoubleActingCylinder",
    "FlowInput",
    "HydraulicMotor",
    "Orifice",
    "Plug",
    "PressureInput",
    "ReliefValve",
    "Tank",
    "VariableOrifice",
]
