"""Multibody mechanics of cranes: serial chains on a moving foot, cylinders, rope and load."""

from seacrane.multibody.crane import crane_mechanics
from seacrane.multibody.equilibrium import Equilibrium, static_equilibrium
from seacrane.multibody.kinematics import Kinematics

__all__ = ["Equilibrium", "Kinematics", "crane_mechanics", "static_equilibrium"]
