"""From a design to a running system: the drives as FMUs, the crane, the ship and the operator's control, coupled.

    ship ──► crane                foot motion; the crane's wrench goes back to the ship
    joystick ──► drives           spools
    drives ◄═══► crane            power bonds: force and rod speed, torque and shaft speed

The slaves step one after the other in the order ship, joystick, drives, crane, each with the newest values of those
before it. That sequence, more than which comes first, keeps stiff hydraulics stable at steps that a simultaneous
exchange does not survive (docs/decisions/0004).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

from seacrane import fmi
from seacrane.control import Joystick
from seacrane.control.joystick import Axis
from seacrane.cosim import FmuSlave, FunctionSlave, ModelSlave, System
from seacrane.design import Crane, Cylinder, Slew, geometry
from seacrane.errors import ParameterError, Problem, StructureError, nearest
from seacrane.model import Dae, Diagram
from seacrane.multibody import Equilibrium, crane_mechanics, static_equilibrium
from seacrane.units import Length, Mass, deg
from seacrane.vessel import Fixed, Harmonic

from .drives import DEAD_BAND, Hydraulics, cylinder_drive, slew_drive, winch_drive

JOINTS = ("luff", "jib")
"""The joints of a knuckle boom crane after slewing, for which the operator's control is made."""

POSTURE = {"slew": 90 * deg, "luff": 50 * deg, "jib": -70 * deg}
"""Where a crane starts unless told otherwise: over the side, boom half up, jib folded."""


RELEASE_TIME = 0.4
"""From full command to none when the dead man's switch is let go [s]: a harder stop shakes the load off its rope."""


@dataclass(frozen=True)
class Start:
    """The state in which a plant starts: joint values [rad] by name, the load [kg], and how far it hangs [m]."""

    posture: Mapping[str, float]
    load: Mass = 40e3
    hanging: Length = 14.0

    def joints(self, crane: Crane) -> list[float]:
        """The posture in the order of the crane's joints; `ParameterError` with all that the crane cannot take."""
        known = {joint.name: joint.limits for joint in crane.joints}
        problems = [
            Problem(f"posture.{name}", "is not a joint of the crane", hint=nearest(name, known))
            for name in self.posture
            if name not in known
        ]
        for name, limits in known.items():
            value = self.posture.get(name, 0.0)
            low, high = limits or (-inf, inf)
            if not low - 1e-9 <= value <= high + 1e-9:
                allowed = f"{low / deg:.4g} to {high / deg:.4g} deg"
                problems.append(
                    Problem(f"posture.{name}", f"{value / deg:.4g} deg is beyond its limits", None, allowed)
                )
        if problems:
            raise ParameterError(problems)
        return [self.posture.get(name, 0.0) for name in known]


def build(
    crane: Crane,
    *,
    vessel: Fixed | Harmonic | None = None,
    start: Start | None = None,
    hydraulics: Hydraulics | None = None,
) -> System:
    """The whole plant of `crane` as a co-simulation system, at rest in static equilibrium.

    Slaves: `ship`, `joystick`, `slew_drive`, one drive for each cylinder set, `winch_drive`, `crane`. Drives are
    exported as FMUs (kept in the cache) and run from there. Bonds: one for each drive and six at the crane's foot.
    `StructureError` for a crane of a type that has no plant yet.
    """
    check(crane)
    start, hydraulics = start or Start(POSTURE), hydraulics or Hydraulics()
    joints = start.joints(crane)
    rest = static_equilibrium(crane, joints, start.load, start.hanging)
    system = System(crane.name)
    system.add("ship", ModelSlave((vessel or Fixed()).model(crane.pedestal)))
    system.add("joystick", joystick(crane, rest))
    for name, part in parts(crane, start=start, hydraulics=hydraulics).items():
        system.add(name, FmuSlave(fmi.cached(part)) if isinstance(part, Diagram) else ModelSlave(part))
    _couple(system, crane)
    return system


def check(crane: Crane) -> Slew:
    """The slewing gear of a knuckle boom crane; `StructureError` that names the joints of any other crane."""
    joints = tuple(joint.name for joint in crane.joints)
    moved = {cylinder.moves for cylinder in crane.cylinders}
    if crane.slew is None or joints != (crane.slew.joint, *JOINTS) or moved != set(JOINTS):
        raise StructureError.at(
            f"{crane.name}: links",
            "only a knuckle boom crane can be operated so far: slewing, and luffing and jib by cylinders",
            value=", ".join(joints),
            allowed=", ".join(("the slewing joint", *JOINTS)),
            hint="Its mechanics run alone: multibody.crane_mechanics(crane).",
        )
    return crane.slew


def parts(
    crane: Crane, *, start: Start | None = None, hydraulics: Hydraulics | None = None
) -> dict[str, Diagram | Dae]:
    """The models that `build` couples, by name: each drive of the crane as a diagram, then its mechanics, "crane".

    They fit each other: all start in the same equilibrium, and the mechanics have the inertia of the drives' motors.
    `fmi.export` turns each into an FMU. `StructureError` for a crane of a type that has no plant yet.
    """
    slew = check(crane).joint
    start, hydraulics = start or Start(POSTURE), hydraulics or Hydraulics()
    joints = start.joints(crane)
    rest = static_equilibrium(crane, joints, start.load, start.hanging)
    mechanics = crane_mechanics(crane, start.load, joints, start.hanging)
    return {
        **{diagram.name: diagram for diagram in drives(crane, rest, start, hydraulics)},
        mechanics.name: _with_rotors(mechanics, slew, hydraulics),
    }


def _with_rotors(mechanics: Dae, slew: str, hydraulics: Hydraulics) -> Dae:
    """The motors' inertia, which the mechanics hold because they hold the speed, on top of what turns there anyway."""
    more = {
        f"{slew}.rotor_inertia": hydraulics.slew.reflected_inertia,
        "drum.inertia": hydraulics.winch.reflected_inertia,
    }
    parameters = tuple(replace(v, start=v.start + more.get(v.name, 0.0)) for v in mechanics.parameters)
    return replace(mechanics, parameters=parameters)


def drives(crane: Crane, rest: Equilibrium, start: Start, hydraulics: Hydraulics) -> list[Diagram]:
    """The drives of the crane as diagrams, starting at the forces of `rest`."""
    cylinders = [
        cylinder_drive(crane, c, rest, extension(crane, c, start.posture), hydraulics) for c in crane.cylinders
    ]
    return [slew_drive(check(crane), crane.bulk_modulus, hydraulics), *cylinders, winch_drive(crane, rest, hydraulics)]


def extension(crane: Crane, cylinder: Cylinder, posture: Mapping[str, float]) -> Length:
    """How far a cylinder is out in a posture [m]."""
    return geometry.cylinder_length(crane, cylinder, posture) - geometry.retracted_length(crane, cylinder)


def joystick(crane: Crane, rest: Equilibrium) -> FunctionSlave:
    """The operator's control; rope may be drawn in to half of what is out at the start, and 200 m more paid out."""
    axis = Axis(valve_dead_band=DEAD_BAND)
    settings = Joystick.of(
        crane,
        rope=(0.5 * rest.unstretched_length, rest.unstretched_length + 200.0),
        slew_axis=Axis(ramp=0.4, valve_dead_band=DEAD_BAND),
        boom_axis=axis,
        jib_axis=axis,
        hoist_axis=axis,
        release_time=RELEASE_TIME,
        angle_margin=1.0 * deg,
    )
    return FunctionSlave(settings, inputs=Joystick.inputs, outputs=Joystick.outputs, state=Joystick.start)


# ---------------------------------------------------------------- connections
def _couple(system: System, crane: Crane) -> None:
    for axis in "xyz":
        for quantity in ("al", "a", "g"):
            system.connect(f"ship.foot.{quantity}{axis}", f"crane.base.{quantity}{axis}")
        _foot_bond(system, f"foot_{axis}", f"wrench.f{axis}", f"v{axis}")
        _foot_bond(system, f"foot_r{axis}", f"wrench.m{axis}", f"w{axis}")
    system.connect("ship.foot.z", "crane.base.z")
    for measured in ("luff", "jib", "rope.unstretched_length", "rope.hanging", "rope.tension"):
        system.connect(f"crane.{measured}", f"joystick.{measured}")

    joint = check(crane).joint
    _bond(system, "slew", "slew_drive", ("torque", f"{joint}.torque"), (f"{joint}_rate", "speed"))
    for cylinder in crane.cylinders:
        name = cylinder.name.removesuffix("_cylinder")
        drive = f"{name}_drive"
        _bond(
            system,
            name,
            drive,
            ("rod_force", f"{cylinder.name}.force"),
            (f"{cylinder.name}.velocity", "rod_velocity"),
        )
        system.connect(f"crane.{cylinder.name}.extension", f"{drive}.rod_position")
    _bond(system, "winch", "winch_drive", ("torque", "drum.torque"), ("drum.speed", "speed"))


def _bond(system: System, spool: str, drive: str, effort: Sequence[str], flow: Sequence[str]) -> None:
    """The power bond between a drive and the crane, named after the drive's spool, and that spool."""
    system.connect(f"joystick.spool.{spool}", f"{drive}.spool")
    system.bond(
        f"{spool}_bond",
        effort=(f"{drive}.{effort[0]}", f"crane.{effort[1]}"),
        flow=(f"crane.{flow[0]}", f"{drive}.{flow[1]}"),
    )


def _foot_bond(system: System, name: str, wrench: str, motion: str) -> None:
    system.bond(
        name,
        effort=(f"crane.{wrench}", f"ship.{wrench}"),
        flow=(f"ship.foot.{motion}", f"crane.base.{motion}"),
    )
