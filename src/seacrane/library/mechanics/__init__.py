"""Mechanical components: springs, masses, brakes, gears, the winch drum, and the boundaries to a co-simulation partner.

Forces and torques at a port act *on* the component, positive along +v or +w. A boundary (`MotionInput`, `SpeedInput`,
`ForceInput`, `TorqueInput`) is where a drive meets a model in another simulator: it imposes what the partner gives and
reports what the drive gives back, with the sign as the partner feels it, and the work that has passed.
"""

from .boundaries import ForceInput, MotionInput, SpeedInput, TorqueInput
from .brakes import HoldingBrake
from .electric import ElectricMotor
from .masses import Inertia, Mass
from .springs import EndStop, RopeSpring, RotationalFriction, SpringDamper, TorsionalSpringDamper
from .transformers import ConstantRadiusWinchDrum, Gear, LayeredWinchDrum, WinchDrum

__all__ = [
    "ConstantRadiusWinchDrum",
    "ElectricMotor",
    "EndStop",
    "ForceInput",
    "Gear",
    "HoldingBrake",
    "Inertia",
    "LayeredWinchDrum",
    "Mass",
    "MotionInput",
    "RopeSpring",
    "RotationalFriction",
    "SpeedInput",
    "SpringDamper",
    "TorqueInput",
    "TorsionalSpringDamper",
    "WinchDrum",
]
