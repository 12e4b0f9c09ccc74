"""Hydraulic components: sources, volumes, orifices, valves, cylinders and motors.

Pressures are gauge pressures: a tank open to the air is at 0 Pa, and oil cannot hold less than about -1e5 Pa. The laws
do not model cavitation; where a line may be sucked empty (an overrunning load), put an `AnticavitationValve` from tank
to it, as a real circuit has.

Volume flow is counted at port pressure, so that pressure times flow is the power through a port. The oil is one for a
whole diagram: `density`, `bulk_modulus`, `viscosity`, `transition_pressure` and `atmospheric_pressure` are shared, as
in `Diagram("drive", density=860.0)`. `mineral_oil` gives the first three at a temperature:
`Diagram("drive", **mineral_oil(333.15))`.
"""

from .accumulators import GasAccumulator
from .cylinders import DoubleActingCylinder, SingleActingCylinder
from .directional import DirectionalValve22, DirectionalValve43, FourPortDirectionalValve22
from .flow_control import Filter, FlowDivider, PressureCompensator, ShuttleValve
from .fluid import mineral_oil
from .motors import HydraulicMotor, VariableHydraulicMotor
from .orifices import Orifice, VariableOrifice
from .pipes import Hose, Pipe
from .power_unit import power_unit
from .pumps import (
    ConstantFlowPump,
    ConstantPressurePump,
    LoadSensingPump,
    PressureControlledPump,
    Pump,
    ShaftPump,
    VariableFlowPump,
)
from .sources import FlowInput, Plug, PressureInput, Tank
from .switches import PressureSwitch
from .valves import (
    AnticavitationValve,
    CheckValve,
    CounterbalanceValve,
    PilotOperatedCheckValve,
    PressureReducingValve,
    ReliefValve,
)
from .volumes import ControlVolume, EntrainedAirVolume, FluidColumn, Volume

__all__ = [
    "AnticavitationValve",
    "CheckValve",
    "ConstantFlowPump",
    "ConstantPressurePump",
    "ControlVolume",
    "CounterbalanceValve",
    "DirectionalValve22",
    "DirectionalValve43",
    "DoubleActingCylinder",
    "EntrainedAirVolume",
    "Filter",
    "FlowDivider",
    "FlowInput",
    "FluidColumn",
    "FourPortDirectionalValve22",
    "GasAccumulator",
    "Hose",
    "HydraulicMotor",
    "LoadSensingPump",
    "Orifice",
    "PilotOperatedCheckValve",
    "Pipe",
    "Plug",
    "PressureCompensator",
    "PressureControlledPump",
    "PressureInput",
    "PressureReducingValve",
    "PressureSwitch",
    "Pump",
    "ReliefValve",
    "ShaftPump",
    "ShuttleValve",
    "SingleActingCylinder",
    "Tank",
    "VariableFlowPump",
    "VariableHydraulicMotor",
    "VariableOrifice",
    "Volume",
    "mineral_oil",
    "power_unit",
]
