"""The state in which a plant starts: posture, load, and how far it hangs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Final, Self

import numpy as np

from seacrane.design import Crane, Joint, chart, geometry, planar
from seacrane.errors import ParameterError, Problem, nearest
from seacrane.units import Length, Mass, deg

POSTURE: Final = {"slew": 90 * deg, "luff": 50 * deg, "jib": -70 * deg}
"""Where a knuckle boom crane starts unless told otherwise: over the side, boom half up, jib folded."""

_HEAVIEST: Final = 40e3
_LIGHTEST: Final = 100.0
_MOST_HANGING: Final = 14.0
_LEAST_HANGING: Final = 2.0

_INNER: Final = 0.15
"""Share of a joint's travel at each end that a usual posture keeps away from."""


@dataclass(frozen=True)
class Start:
    """Joint values [rad or m] by name, those left out at zero; the load [kg] below the hook block; and how far it hangs
    below the tip [m]."""

    posture: Mapping[str, float]
    load: Mass = _HEAVIEST
    hanging: Length = _MOST_HANGING

    @classmethod
    def usual(cls, crane: Crane, posture: Mapping[str, float] | None = None, load: Mass | None = None) -> Self:
        """Where an operator would begin, for what is not given.

        Posture: `POSTURE` where the crane has just these joints and reaches it; else the slewing joint over the side
        and the others, away from their ends, so that the crane lifts most at three fifths of its reach and well above
        the sea. Load: 40 t, but no more than four fifths of what `POSTURE` bears in harbour, half of what any other
        does, and 100 kg at least. It hangs 14 m, or three fifths of the way to the sea.
        """
        posture = _posture(crane) if posture is None else posture
        plane = {joint.name: posture.get(joint.name, 0.0) for joint in planar.plane_joints(crane)}
        if load is None:
            share = 0.8 if posture == POSTURE else 0.5
            load = max(_LIGHTEST, min(_HEAVIEST, share * min(chart.each_limit(crane, plane).values())))
        above = crane.pedestal[2] + float(geometry.tip(crane, plane)[2])
        return cls(posture, load, min(_MOST_HANGING, max(_LEAST_HANGING, 0.6 * above)))

    def joints(self, crane: Crane) -> list[float]:
        """The posture in the order of the crane's joints; `ParameterError` with all that the crane cannot take."""
        known = {joint.name: joint for joint in crane.joints}
        problems = [
            Problem(f"posture.{name}", "is not a joint of the crane", hint=nearest(name, known))
            for name in self.posture
            if name not in known
        ]
        for name, joint in known.items():
            value = self.posture.get(name, 0.0)
            low, high = joint.limits or (-inf, inf)
            if not low - 1e-9 <= value <= high + 1e-9:
                message = f"{_shown(joint, value)} is beyond its limits"
                problems.append(
                    Problem(f"posture.{name}", message, None, f"{_shown(joint, low)} to {_shown(joint, high)}")
                )
        if problems:
            raise ParameterError(problems)
        return [self.posture.get(name, 0.0) for name in known]


def _shown(joint: Joint, value: float) -> str:
    return f"{value / deg:.4g} deg" if joint.kind == "revolute" else f"{value:.4g} m"


def _posture(crane: Crane) -> dict[str, float]:
    if {joint.name for joint in crane.joints} == set(POSTURE) and all(
        joint.limits is None or joint.limits[0] <= POSTURE[joint.name] <= joint.limits[1] for joint in crane.joints
    ):
        return dict(POSTURE)
    inner = {
        joint.name: np.linspace(low + _INNER * (high - low), high - _INNER * (high - low), 9)
        for joint in planar.plane_joints(crane)
        for low, high in (joint.limits or (0.0, 0.0),)
    }
    postures = dict(zip(inner, np.meshgrid(*inner.values(), indexing="ij"), strict=True))
    found = chart.capacity(crane, postures)
    reach = float(planar.Plane(crane, planar.grid(crane, 9)).tip()[0].max())
    off = np.abs(found.radius - 0.6 * reach)
    near = off <= max(0.05 * reach, float(off.min()))
    above = found.height + crane.pedestal[2]
    near &= above >= min(0.6 * above[near].max(), _MOST_HANGING)
    best = np.unravel_index(int(np.argmax(np.where(near, found.swl, -1.0))), found.swl.shape)
    slew = {crane.slew.joint: POSTURE["slew"]} if crane.slew else {}
    return slew | {name: float(q[best]) for name, q in postures.items()}
