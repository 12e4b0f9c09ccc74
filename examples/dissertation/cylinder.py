"""The cylinder drive of the dissertation's chapter on a single drive, shared by the scripts beside this file.

The dissertation prints no sizes but the stroke and the bumpers: bore, rod, supply, valve and load are those of `Drive`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mech
from seacrane.library import signals as sig
from seacrane.model import Component, Diagram, Part
from seacrane.units import GRAVITY, bar, l, l_min, mm


@dataclass(frozen=True)
class Drive:
    """Sizes of the drive, in SI."""

    bore: float = 280 * mm
    rod: float = 200 * mm
    stroke: float = 1.4
    bumper: float = 10 * mm
    supply: float = 210 * bar
    load: float = 20e3
    start: float = 0.7

    @property
    def piston_area(self) -> float:
        return math.pi / 4 * self.bore**2

    @property
    def weight(self) -> float:
        return self.load * GRAVITY

    @property
    def bumper_stiffness(self) -> float:
        """Such that the full push of the supply, less the load, goes `bumper` into it."""
        return (self.supply * self.piston_area - self.weight) / self.bumper


@dataclass(frozen=True)
class Sine:
    """The reference of the piston: mean + amplitude sin(2 pi t / period)."""

    amplitude: float = 0.4
    period: float = 15.0


def cylinder(d: Drive, level: str = "extended") -> hyd.DoubleActingCylinder:
    """The cylinder at one of its levels; the simplified one has neither chambers, friction nor bumpers."""
    size = {"bore": d.bore, "rod": d.rod, "stroke": d.stroke, "extension": d.start}
    if level == "simplified":
        return hyd.DoubleActingCylinder(level=level, **size)
    return hyd.DoubleActingCylinder(
        level=level,
        **size,
        pressure_a=d.weight / d.piston_area,
        viscous_friction=6e4,
        coulomb_friction=3e3,
        stop_stiffness=d.bumper_stiffness,
        stop_damping=1e6,
    )


def add_circuit(drive: Diagram, d: Drive, level: str = "extended", *, own_pump: bool = True) -> tuple[Part, Part]:
    """Pump, tank, 4/3 valve, two lines and the cylinder, joined; gives the valve and the cylinder.

    Without a pump of its own the port `supply` is exposed.
    """
    tank = drive.add("tank", hyd.Tank())
    valve = drive.add(
        "valve", hyd.DirectionalValve43(level="dynamic", flow=400 * l_min, at=35 * bar, natural_frequency=60.0)
    )
    part = drive.add("cylinder", cylinder(d, level))
    if own_pump:
        pump = drive.add("pump", hyd.ConstantPressurePump(pressure=d.supply))
        drive.connect(pump.p, valve.p)
    else:
        drive.expose(supply=valve.p)
    drive.connect(tank.p, valve.t)
    for side, port, start in (("a", valve.a, d.weight / d.piston_area), ("b", valve.b, 0.0)):
        line = drive.add(f"line_{side}", hyd.ControlVolume(volume=1 * l, pressure=start))
        drive.connect(port, line.a, part.a if side == "a" else part.b)
    return valve, part


@dataclass(frozen=True)
class Gains:
    """The controller: a PID on the speed. Asked for is the speed of the reference and a share of what is missing."""

    follow: float = 8.0  # [1/s] speed asked for per metre of displacement error
    kp: float = 1.0
    ki: float = 5.0
    kd: float = 0.002
    forward: float = 4.5  # spool per speed asked for [s/m]
    beyond: float = 0.05  # spool added to leave the dead band of the valve
    within: float = 0.01  # spool over which that is faded in


def controlled(
    level: str = "extended",
    d: Drive | None = None,
    sine: Sine | None = None,
    gains: Gains | None = None,
    *,
    own_pump: bool = True,
    load: Component | None = None,
    **shared: float,
) -> Diagram:
    """The drive with its load on the rod, and a controller that makes the piston follow a sine.

    The load is a mass unless another one is given by its component. Where that is the motion of a partner, the drive
    takes `velocity` and `position` and gives the `force` of the rod.

    Observables to look at: `cylinder.extension` and its reference `displacement.y`.
    """
    d, sine, g = d or Drive(), sine or Sine(), gains or Gains()
    drive = Diagram(f"{level}_drive", **{"bulk_modulus": 1.0e9, **shared})
    valve, part = add_circuit(drive, d, level, own_pump=own_pump)
    on_rod = drive.add("load" if load else "mass", load or mech.Mass(mass=d.load, gravity=GRAVITY))
    probe = drive.add("probe", mech.ForceInput(position=d.start))  # without force: it measures
    nothing = drive.add("nothing", sig.Constant(value=0.0, unit="N"))
    drive.connect(part.rod, on_rod.flange, probe.flange)
    drive.connect(nothing.y, probe.F)

    rate = 2 * math.pi / sine.period * sine.amplitude
    displacement = drive.add(
        "displacement", sig.Sine(amplitude=sine.amplitude, period=sine.period, bias=d.start, unit="m")
    )
    speed = drive.add("speed", sig.Sine(amplitude=rate, period=sine.period, phase=math.pi / 2, unit="m/s"))
    missing = drive.add("missing", sig.Sum(signs="+-", unit="m"))
    follow = drive.add("follow", sig.Gain(gain=g.follow, takes="m", gives="m/s"))
    asked = drive.add("asked", sig.Sum(unit="m/s"))
    pid = drive.add("pid", sig.PID(kp=g.kp, ki=g.ki, kd=g.kd, low=-1.0, high=1.0, takes="m/s", gives="1"))
    forward = drive.add("forward", sig.Gain(gain=g.forward, takes="m/s", gives="1"))
    spool = drive.add("spool", sig.Sum())
    jump = drive.add(
        "jump",
        sig.Table(
            points=[(-1.0, -1.0), (-g.within, -g.within - g.beyond), (g.within, g.within + g.beyond), (1.0, 1.0)]
        ),
    )
    drive.connect(displacement.y, missing.u1)
    drive.connect(probe.x, missing.u2)
    drive.connect(missing.y, follow.u)
    drive.connect(speed.y, asked.u1, forward.u)
    drive.connect(follow.y, asked.u2)
    drive.connect(asked.y, pid.reference)
    drive.connect(probe.v, pid.measured)
    drive.connect(pid.u, spool.u1)
    drive.connect(forward.y, spool.u2)
    drive.connect(spool.y, jump.u)
    drive.connect(jump.y, valve.x)
    if isinstance(load, mech.MotionInput):
        drive.expose(velocity=on_rod.v, position=on_rod.x, force=on_rod.F)
    return drive
