"""Operating a crane: recorded joysticks, the energy account, the demo."""

from .energy import EnergyAccount, EnergyMeter
from .sticks import Sticks

__all__ = ["EnergyAccount", "EnergyMeter", "Sticks"]
