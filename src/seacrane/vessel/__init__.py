"""Ships: what moves under the crane's foot. All levels have the same ports.

ship = vessel.Harmonic(heave=vessel.Motion(amplitude=1.0, period=8.0)).model(pedestal=crane.pedestal)
"""

from seacrane.vessel.prescribed import INPUTS, OUTPUTS, Fixed, Harmonic, Motion

__all__ = ["INPUTS", "OUTPUTS", "Fixed", "Harmonic", "Motion"]
