"""Whether a cylinder buckles: Euler's load of barrel and rod, fully out between two pins.

A column of two parts of different stiffness on hinges (S. P. Timoshenko, J. M. Gere, Theory of Elastic Stability,
chapter 2, bars with changes in cross section): with k = sqrt(P / (E I)) in each part the least P is that at which

    atan2(k_rod sin(k_barrel L_barrel), k_barrel cos(k_barrel L_barrel)) + k_rod L_rod = pi

The barrel is the one that `mass.wall` estimates. Straight and plumb loaded: own weight, play in the guides and friction
of the pins, which makers' rules take in, are not.
"""

from __future__ import annotations

import math
from typing import Final

from seacrane.design.crane import Crane, Cylinder
from seacrane.design.geometry import cylinder_range, retracted_length
from seacrane.design.mass import wall

ELASTICITY: Final = 2.06e11
"""Young's modulus of steel [Pa]."""


def load(crane: Crane, cylinder: Cylinder) -> float:
    """The least push [N] at which one cylinder of a set buckles, out as far as its joint lets it."""
    closed, longest = retracted_length(crane, cylinder), cylinder_range(crane, cylinder)[1]
    outer = cylinder.bore + 2 * wall(cylinder)
    barrel = math.pi / 64 * (outer**4 - cylinder.bore**4)
    rod = math.pi / 64 * cylinder.rod**4
    return stepped(barrel, max(closed, 0.0), rod, max(longest - closed, 0.0))


def safety(crane: Crane, cylinder: Cylinder) -> float:
    """How many times its push at working pressure a cylinder bears before it buckles."""
    return load(crane, cylinder) / (cylinder.pressure * math.pi / 4 * cylinder.bore**2)


def stepped(first: float, first_length: float, second: float, second_length: float) -> float:
    """Euler's load [N] of a steel column on hinges, of two parts: second moments of area [m4] and lengths [m]."""
    euler = math.pi**2 * ELASTICITY / (first_length + second_length) ** 2
    low, high = euler * min(first, second), euler * max(first, second)

    def bears(push: float) -> bool:
        k1, k2 = (math.sqrt(push / (ELASTICITY * inertia)) for inertia in (first, second))
        if k1 * first_length >= math.pi:
            return False
        phase = math.atan2(k2 * math.sin(k1 * first_length), k1 * math.cos(k1 * first_length))
        return phase + k2 * second_length < math.pi

    for _ in range(50):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if bears(middle) else (low, middle)
    return low
