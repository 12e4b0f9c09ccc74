"""Where a drive meets a model in another simulator."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from seacrane.library import symbols
from seacrane.library.references import DISSERTATION
from seacrane.model import (
    BondGraph,
    Component,
    PowerBond,
    Rotational,
    SignalIn,
    SignalOut,
    Translational,
    initial,
    parameter,
)
from seacrane.units import Frequency, Length

_SOURCES = (f"{DISSERTATION} (drives in co-simulation)",)


class MotionInput(Component):
    """Imposes a partner's motion and reports the force delivered to it.

        partner  v, x ──►┌───────┐
                         │       ├── flange ── rod of the cylinder
        partner  F   ◄───└───────┘

    v_eff = v + correction (x - x_own),  dx_own/dt = v_eff = flange.v

    A partner gives its speed at communication points only; held between them, its integral would drift away from the
    partner's own position. The correction pulls x_own to the x that the partner reports, with the time constant
    1/correction. F = flange.F is positive along +v: it is what the drive pushes the partner with. `work` is the
    integral of F v_eff, what has left the drive.
    """

    correction: Frequency = parameter(
        "rate of following the partner's position",
        default=5.0,
        reason="drift goes in 0.2 s, slow beside the oil",
        least=0,
        most=1e4,
    )
    position: Length = initial("position of the partner at the start", least=-1e5, most=1e5)
    ports = {
        "v": SignalIn("m/s", "speed of the partner"),
        "x": SignalIn("m", "position of the partner", start="position"),
        "flange": Translational("what the partner moves"),
        "F": SignalOut("N", "force on the partner, positive along v"),
        "work": SignalOut("J", "work done on the partner"),
    }
    bond_graph = BondGraph(
        "partner: MSf", "partner |-> flange, v ~> partner, x ~> partner, flange ~> F, flange ~> work"
    )
    partner = PowerBond("partner", "v", "F", inward=False)
    icon = symbols.MOTION_INPUT
    sources = _SOURCES

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        x = m.state("position", unit="m", start=self.position, about="own position of the flange")
        w = m.state("work_done", unit="J", nominal=1e5, about="work done on the partner")
        yield m.flange.v, m.v + self.correction * (m.x - x)
        yield m.der(x), m.flange.v
        yield m.der(w), m.flange.power
        yield m.F, m.flange.F
        yield m.work, w
        m.supplies(-m.flange.power)


class SpeedInput(Component):
    """Imposes a partner's shaft speed w and reports the torque T delivered to it, positive along w.

    The rotational twin of `MotionInput`, without a position: a drive's law does not depend on the angle.
    """

    ports = {
        "w": SignalIn("rad/s", "speed of the partner's shaft"),
        "flange": Rotational("what the partner turns"),
        "T": SignalOut("N.m", "torque on the partner, positive along w"),
        "work": SignalOut("J", "work done on the partner"),
    }
    bond_graph = BondGraph("partner: MSf", "partner |-> flange, w ~> partner, flange ~> T, flange ~> work")
    partner = PowerBond("partner", "w", "T", inward=False)
    icon = symbols.SPEED_INPUT
    sources = _SOURCES

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.state("work_done", unit="J", nominal=1e5, about="work done on the partner")
        yield m.flange.w, m.w
        yield m.der(w), m.flange.power
        yield m.T, m.flange.T
        yield m.work, w
        m.supplies(-m.flange.power)


class ForceInput(Component):
    """Imposes a partner's force F, positive along +v of the flange's node, and reports the speed and position there.

    The other causality of `MotionInput`: here the drive holds the mass and the partner the load.
    """

    position: Length = initial("position at the start", least=-1e5, most=1e5)
    ports = {
        "F": SignalIn("N", "force of the partner on the drive"),
        "flange": Translational("where the force acts"),
        "v": SignalOut("m/s", "speed there"),
        "x": SignalOut("m", "position there"),
        "work": SignalOut("J", "work done on the partner"),
    }
    bond_graph = BondGraph("partner: MSe", "partner ->| flange, F ~> partner, flange ~> v, flange ~> x, flange ~> work")
    partner = PowerBond("partner", "v", "F")
    icon = symbols.FORCE_INPUT
    sources = _SOURCES

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        x = m.state("position", unit="m", start=self.position, about="position of the flange")
        w = m.state("work_done", unit="J", nominal=1e5, about="work done on the partner")
        yield m.flange.F, -m.F
        yield m.der(x), m.flange.v
        yield m.der(w), m.flange.power
        yield m.v, m.flange.v
        yield m.x, x
        yield m.work, w
        m.supplies(-m.flange.power)


class TorqueInput(Component):
    """Imposes a partner's torque T, positive along +w of the flange's node, and reports the speed there."""

    ports = {
        "T": SignalIn("N.m", "torque of the partner on the drive"),
        "flange": Rotational("where the torque acts"),
        "w": SignalOut("rad/s", "speed there"),
        "work": SignalOut("J", "work done on the partner"),
    }
    bond_graph = BondGraph("partner: MSe", "partner ->| flange, T ~> partner, flange ~> w, flange ~> work")
    partner = PowerBond("partner", "w", "T")
    icon = symbols.TORQUE_INPUT
    sources = _SOURCES

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        w = m.state("work_done", unit="J", nominal=1e5, about="work done on the partner")
        yield m.flange.T, -m.T
        yield m.der(w), m.flange.power
        yield m.w, m.flange.w
        yield m.work, w
        m.supplies(-m.flange.power)
