"""A hoisting rope from its drum over sheaves to the hook: elastic, massless, never pushing.

Its state is the unstretched length L0 [m] between drum and hook; l [m] is the length of its path. With the strain
e = l/L0 - 1 the elastic tension is EA e when taut and nothing when slack. The drum's surface moves with the stretched
rope at s = radius * speed (hoisting positive), so unstretched rope enters the span at

    dL0/dt = -s / (1 + e)        and       L0 de/dt = dl/dt + s

which is the rate the damper sees. Strained rope carries its elastic energy with it, EA e^2/2 per unstretched metre,
off the drum when lowering and back onto it when hoisting; `carried` is that power, onto the drum. With the tension T,
its elastic part Te and the elastic energy U = EA e^2 L0/2 it follows that

    dU/dt = Te (dl/dt + s) - carried,       (T - Te) (dl/dt + s) >= 0 is lost to damping.

Sheaves are free of friction and of no size, which leaves out the change of wrap: an approximation of well under a
percent of length for the cranes here.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from seacrane.multibody.cylinder import distance


def path_length(points: Sequence[Any], hook: Any, falls: int = 1) -> Any:
    """Length [m] from the first point (the drum) over the others to the hook, to which it goes in so many falls."""
    led = sum((distance(a, b) for a, b in itertools.pairwise(points)), 0)
    return led + falls * distance(points[-1], hook)


@dataclass(frozen=True)
class RopeLaw:
    """Tension and power of a rope, all scalars: [N], [m], [J], [m/s] and [W]."""

    tension: Any
    stretch: Any
    energy: Any
    unstretched_rate: Any
    dissipation: Any
    carried: Any


def rope_law(length: Any, stretching: Any, winding: Any, unstretched: Any, stiffness: Any, damping: Any) -> RopeLaw:
    """The law above.

    length: of the path, l [m]; stretching: dl/dt + s [m/s]; winding: s [m/s]; unstretched: L0 [m]; stiffness: EA [N];
    damping: [N.s/m].
    """
    stretch = length - unstretched
    strain = ca.fmax(0, stretch / unstretched)
    elastic = stiffness * strain
    tension = ca.if_else(stretch > 0, ca.fmax(0, elastic + damping * stretching), 0)
    density = elastic * strain / 2
    rate = -winding / (1 + strain)
    return RopeLaw(
        tension=tension,
        stretch=stretch,
        energy=density * unstretched,
        unstretched_rate=rate,
        dissipation=(tension - elastic) * stretching,
        carried=-density * rate,
    )
