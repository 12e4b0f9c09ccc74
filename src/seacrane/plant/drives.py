"""The hydraulic drives of a crane, as diagrams: one for each cylinder set, telescope, the slewing gear and the winch.

A drive is given a spool command and the motion of what it moves, and gives the force or torque on it. All are fed at
one supply pressure and return to one tank. Sizes follow from the design (areas, speeds) and from `Hydraulics`, whose
values are assumptions of the usual magnitude.

    p ──┬─────────┐ 4/3 valve, overlapped spool; in its centre both service lines are joined to the tank a little,
    t ──┴─────────┘ so that no pilot pressure is left to open the counterbalance valve
        │line_a  │line_b
    [counterbalance valves]   one on each side that can carry the load, piloted from the other line
        │hose_a  │hose_b      anti-cavitation and port relief valves where the actuator is
      piston    rod
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import pi, sqrt
from typing import Self

from seacrane.design import Crane, Cylinder, Link, Slew
from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mech
from seacrane.library import signals as sig
from seacrane.model import Diagram, Part, PortHandle
from seacrane.multibody import Equilibrium
from seacrane.units import (
    GRAVITY,
    Diameter,
    Displacement,
    FlowRate,
    Inertia,
    Length,
    Pressure,
    Ratio,
    Speed,
    Time,
    Volume,
    bar,
    cm3_rev,
    l,
    mm,
)


@dataclass(frozen=True)
class Motors:
    """The motors of a rotating drive: `count` equal ones, with a rotor of `inertia`, geared down by `reduction`."""

    count: int
    displacement: Displacement
    reduction: Ratio
    inertia: Inertia

    @property
    def per_radian(self) -> float:
        """Oil taken per radian of the driven shaft [m3/rad]."""
        return self.count * self.displacement * self.reduction

    @property
    def reflected_inertia(self) -> float:
        """Inertia of all rotors at the driven shaft [kg.m2]."""
        return self.count * self.inertia * self.reduction**2

    def sized(self, ratio: Ratio) -> Motors:
        """Larger or smaller ones on the same gear."""
        return replace(self, displacement=ratio * self.displacement, inertia=ratio * self.inertia)


@dataclass(frozen=True)
class Hydraulics:
    """Sizes of the hydraulic drives that a design file does not hold. Assumptions, chosen for the 100 t class.

    supply: pressure of the ring line. rod_speed: of the cylinders at about half the supply pressure in the valve, and
    travel_time: the least from end to end, which makes short cylinders slower.
    slew, winch: motors. holding: counterbalance setting over the supply pressure. pilot_ratio: of the counterbalance
    valves. relief: port relief over the supply pressure. line, hose: oil between valve, counterbalance valve and
    actuator. float_centre: opening from the service lines to tank in the spool's centre. lowering: full travel of a
    spool towards lowering, where the load drives too, over that towards hoisting: so both are about equally fast.
    fidelity: level of the cylinders.
    """

    supply: Pressure = 280 * bar
    rod_speed: Speed = 0.1
    travel_time: Time = 25.0
    slew: Motors = field(default_factory=lambda: Motors(4, 125 * cm3_rev, 1000.0, 0.05))
    winch: Motors = field(default_factory=lambda: Motors(4, 500 * cm3_rev, 100.0, 0.4))
    holding: Ratio = 1.15
    pilot_ratio: Ratio = 3.0
    relief: Ratio = 1.25
    line: Volume = 10 * l
    hose: Volume = 5 * l
    float_centre: Ratio = 0.05
    lowering: Ratio = 0.6
    fidelity: str = "extended"

    @classmethod
    def of(cls, crane: Crane) -> Self:
        """The same, for a crane of any size: supply at the highest working pressure of its cylinders, the displacement
        and the rotors of its motors in proportion to the load moment that is slewed, and to the pull at the drum."""
        usual = cls()
        supply = max((c.pressure for c in crane.cylinders), default=usual.supply)
        moment = max(rated.mass * rated.radius for rated in crane.capacity)
        pull = crane.hoist.line_pull or 1.1 * GRAVITY * max(rated.mass for rated in crane.capacity) / crane.hoist.falls
        slew = moment / _SLEWED * usual.supply / supply
        winch = pull * crane.hoist.drum_radius / _WOUND * usual.supply / supply
        return cls(supply=supply, slew=usual.slew.sized(slew), winch=usual.winch.sized(winch))


_SLEWED = 1500e3
"""Load moment [kg.m] for which the slewing motors of `Hydraulics` are chosen: 100 t at 15 m."""

_WOUND = 864e3
"""Torque [N.m] at the drum for which its winch motors are chosen: 1080 kN at 0.8 m."""

RATED_DROP = 35 * bar
"""Pressure drop per edge at which the flow of a proportional valve is stated (ISO 10770-1)."""

DEAD_BAND = 0.05
"""Overlap of the spools, of full travel."""

UNLOADED_SHARE = 0.7
"""Rated flow of the slewing valve against that of the loaded drives: with little load on the motor, more of the supply
pressure is left for the valve."""

SPOOL_FREQUENCY = 60.0
"""Natural frequency of the spools [rad/s]: a size 32 pilot-operated proportional valve, about 10 Hz."""


@dataclass(frozen=True)
class Rods:
    """Equal cylinders side by side that no design file names."""

    bore: Diameter
    rod: Diameter
    stroke: Length
    pressure: Pressure
    count: int = 1


def cylinder_drive(crane: Crane, cylinder: Cylinder, start: Equilibrium, extension: float, h: Hydraulics) -> Diagram:
    """A cylinder set with its valves: inputs `spool`, `rod_velocity`, `rod_position`; output `rod_force`.

    It starts at `extension` [m] with the pressure that holds the crane in `start`, the other side at tank pressure.
    Both sides can hold a load: a jib folded far in hangs in its rod side.
    """
    name = cylinder.name.removesuffix("_cylinder")
    return _linear_drive(name, cylinder, start.cylinder_forces[cylinder.name], extension, crane.bulk_modulus, h)


def telescope_drive(crane: Crane, link: Link, start: Equilibrium, extension: float, h: Hydraulics) -> Diagram:
    """The drive of a link that slides without a cylinder in the design: the same ports as a cylinder drive.

    One cylinder as long as the travel stands for the stages of a telescope, whatever pulls them. It carries at the
    supply pressure a third more than twice the heaviest rated load (once on the hook, once as the pull of the rope) and
    the link itself, straight up.
    """
    low, high = link.joint.limits or (0.0, 0.0)
    heaviest = GRAVITY * (2 * max(rated.mass for rated in crane.capacity) + link.mass)
    bore = sqrt(4 / pi * 4 / 3 * heaviest / h.supply)
    rods = Rods(bore=bore, rod=0.7 * bore, stroke=high - low, pressure=h.supply)
    return _linear_drive(link.joint.name, rods, start.drives[link.joint.name], extension, crane.bulk_modulus, h)


def slew_drive(slew: Slew, bulk_modulus: Pressure, h: Hydraulics) -> Diagram:
    """The slewing gear: inputs `spool`, `speed` of the column; output `torque` on it. It starts unloaded."""
    flow = h.slew.per_radian * slew.speed
    drive = Diagram("slew_drive", bulk_modulus=bulk_modulus)
    motor = drive.add("motor", _motor(h.slew))
    # A closed centre, or the column would turn freely; leakage of the edges keeps both lines near half the supply.
    line_a, line_b = _valve(drive, UNLOADED_SHARE * flow, h, pressure=0.5 * h.supply)
    _protect(drive, "a", line_a, flow, h)
    _protect(drive, "b", line_b, flow, h)
    for name, source, sink in (("relief_ab", motor.a, motor.b), ("relief_ba", motor.b, motor.a)):
        relief = drive.add(name, hyd.ReliefValve(crack=0.85 * h.supply, full=h.supply, flow=flow))
        drive.connect(relief.a, source)
        drive.connect(relief.b, sink)
    drive.connect(line_a, motor.a)
    drive.connect(line_b, motor.b)
    _geared(drive, motor, h.slew)
    return drive


def winch_drive(crane: Crane, start: Equilibrium, h: Hydraulics) -> Diagram:
    """The hoisting winch: inputs `spool`, `speed` of the drum; output `torque` on it.

    Hoisting is positive. The counterbalance valve on the hoisting side holds the load of `start`.
    """
    flow = h.winch.per_radian * crane.hoist.speed / crane.hoist.drum_radius
    p_a = start.drum_torque / h.winch.per_radian
    drive = Diagram("winch_drive", bulk_modulus=crane.bulk_modulus)
    motor = drive.add("motor", _motor(h.winch))
    line_a, line_b = _valve(drive, flow, h, float_centre=h.float_centre, lowering=h.lowering)
    hose_a = _held(drive, "a", line_a, line_b, flow, p_a, h)
    _protect(drive, "b", line_b, flow, h)
    drive.connect(hose_a, motor.a)
    drive.connect(line_b, motor.b)
    _geared(drive, motor, h.winch)
    return drive


# ---------------------------------------------------------------- what they share
def _linear_drive(
    name: str, rods: Cylinder | Rods, force: float, extension: float, bulk_modulus: Pressure, h: Hydraulics
) -> Diagram:
    """Cylinders with their valves that start at `extension` [m] with the pressure that gives `force` [N]."""
    piston = rods.count * pi / 4 * rods.bore**2
    annulus = piston - rods.count * pi / 4 * rods.rod**2
    p_a, p_b = max(force, 0.0) / piston, max(-force, 0.0) / annulus
    flow = piston * min(h.rod_speed, rods.stroke / h.travel_time)
    drive = Diagram(f"{name}_drive", bulk_modulus=bulk_modulus)
    actuator = drive.add(
        "cylinder",
        hyd.DoubleActingCylinder(
            level=h.fidelity,
            bore=rods.bore,
            rod=rods.rod,
            stroke=rods.stroke,
            count=rods.count,
            extension=extension,
            **_losses(rods, p_a, p_b) if h.fidelity == "extended" else {},
        ),
    )
    line_a, line_b = _valve(drive, flow, h, float_centre=h.float_centre, lowering=h.lowering)
    hose_a = _held(drive, "a", line_a, line_b, flow, p_a, h)
    hose_b = _held(drive, "b", line_b, line_a, flow * annulus / piston, p_b, h)
    drive.connect(hose_a, actuator.a)
    drive.connect(hose_b, actuator.b)
    partner = drive.add("partner", mech.MotionInput(position=extension, correction=20.0))
    drive.connect(partner.flange, actuator.rod)
    drive.expose(rod_velocity=partner.v, rod_position=partner.x, rod_force=partner.F, rod_work=partner.work)
    return drive


def _losses(cylinder: Cylinder | Rods, p_a: float, p_b: float) -> dict[str, float]:
    """Losses of an extended cylinder: seals that grip with 1 % of the working force, ports that pass its flow, a piston
    that leaks in proportion to its area."""
    push = pi / 4 * cylinder.bore**2 * cylinder.pressure
    return {
        "pressure_a": p_a,
        "pressure_b": p_b,
        "port_diameter": 60 * mm,
        "leakage": 5.6e-13 * cylinder.bore**2,
        "coulomb_friction": 0.01 * push,
        "viscous_friction": 0.02 * push,
    }


def _motor(motors: Motors) -> hyd.HydraulicMotor:
    """Motors of good efficiency: 0.5 % of the flow leaks at full pressure and speed, 2 % of the torque is friction."""
    return hyd.HydraulicMotor(
        displacement=motors.displacement,
        count=motors.count,
        leakage=0.005 * motors.displacement * 100.0 / (280 * bar),
        coulomb_friction=0.02 * motors.displacement * 280 * bar,
    )


def _geared(drive: Diagram, motor: Part, motors: Motors) -> None:
    """Gear and boundary of a rotating drive."""
    gear = drive.add("gear", mech.Gear(reduction=motors.reduction))
    partner = drive.add("partner", mech.SpeedInput())
    drive.connect(motor.shaft, gear.a)
    drive.connect(gear.b, partner.flange)
    drive.expose(speed=partner.w, torque=partner.T, work=partner.work)


def _valve(
    drive: Diagram,
    flow: FlowRate,
    h: Hydraulics,
    *,
    pressure: Pressure = 0.0,
    float_centre: Ratio = 0.0,
    lowering: Ratio = 1.0,
) -> tuple[PortHandle, PortHandle]:
    """Supply, tank, 4/3 valve and both service lines at `pressure`; gives the ports of the lines."""
    pump = drive.add("pump", hyd.ConstantPressurePump(pressure=h.supply))
    tank = drive.add("tank", hyd.Tank())
    valve = drive.add(
        "valve",
        hyd.DirectionalValve43(
            level="dynamic",
            flow=0.7 * flow,
            at=RATED_DROP,
            dead_band=DEAD_BAND,
            leakage=1e-5,
            float_centre=float_centre,
            natural_frequency=SPOOL_FREQUENCY,
        ),
    )
    travel = drive.add("travel", sig.Table(points=((-1, -lowering), (-DEAD_BAND, -DEAD_BAND), (1, 1))))
    drive.connect(travel.y, valve.x)
    drive.connect(pump.p, valve.p)
    drive.connect(tank.p, valve.t)
    drive.expose(spool=travel.u)
    lines = []
    for side, service in (("a", valve.a), ("b", valve.b)):
        line = drive.add(f"line_{side}", hyd.ControlVolume(volume=h.line, pressure=pressure))
        drive.connect(service, line.a)
        lines.append(line.a)
    return lines[0], lines[1]


def _held(
    drive: Diagram, side: str, line: PortHandle, pilot: PortHandle, flow: FlowRate, pressure: Pressure, h: Hydraulics
) -> PortHandle:
    """A counterbalance valve between `line` and the actuator, and the protected hose behind it at `pressure`.

    The pilot is the other service line, in front of its own counterbalance valve: a shock of the load there does not
    open this one.
    """
    holding = drive.add(
        f"counterbalance_{side}",
        hyd.CounterbalanceValve(
            flow=flow,
            at=10 * bar,
            crack=h.holding * h.supply,
            full=1.6 * h.holding * h.supply,
            ratio=h.pilot_ratio,
        ),
    )
    hose = drive.add(f"hose_{side}", hyd.ControlVolume(volume=h.hose, pressure=pressure))
    drive.connect(line, holding.a)
    drive.connect(pilot, holding.pilot)
    drive.connect(holding.b, hose.a)
    _protect(drive, side, hose.a, flow, h)
    return hose.a


def _protect(drive: Diagram, side: str, port: PortHandle, flow: FlowRate, h: Hydraulics) -> None:
    """Anti-cavitation and port relief valves to tank."""
    refill = drive.add(f"refill_{side}", hyd.AnticavitationValve(flow=2 * flow, at=0.6 * bar))
    crack = h.relief * h.supply
    relief = drive.add(f"relief_{side}", hyd.ReliefValve(crack=crack, full=1.15 * crack, flow=flow))
    drive.connect(port, refill.a, relief.a)
    drive.connect(drive.parts["tank"].p, refill.t, relief.b)
