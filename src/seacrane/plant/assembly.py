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
from dataclasses import replace

from seacrane import fmi
from seacrane.control import HOIST, SLEW, Axis, Joystick, axis_names
from seacrane.cosim import FmuSlave, FunctionSlave, ModelSlave, System
from seacrane.design import Crane, Cylinder, Joint, Slew, geometry
from seacrane.errors import Problem, StructureError
from seacrane.model import Dae, Diagram
from seacrane.multibody import Equilibrium, crane_mechanics, static_equilibrium
from seacrane.units import GRAVITY, Length, Mass, deg, kN
from seacrane.vessel import Fixed, Harmonic

from .drives import DEAD_BAND, Hydraulics, cylinder_drive, slew_drive, telescope_drive, winch_drive
from .start import Start

RELEASE_TIME = 0.4
"""From full command to none when the dead man's switch is let go [s]: a harder stop shakes the load off its rope."""


def build(
    crane: Crane,
    *,
    vessel: Fixed | Harmonic | None = None,
    start: Start | None = None,
    hydraulics: Hydraulics | None = None,
) -> System:
    """The whole plant of `crane` as a co-simulation system, at rest in static equilibrium.

    Slaves: `ship`, `joystick`, a drive for each axis of the joystick (`slew_drive`, and one for each cylinder set and
    telescope), `winch_drive`, `crane`. Drives are exported as FMUs (kept in the cache) and run from there. Bonds: one
    for each drive and six at the crane's foot. What is not given is as `Start.usual` and `Hydraulics.of` have it.
    `StructureError` for a crane whose joints cannot all be driven.
    """
    check(crane)
    start, hydraulics = start or Start.usual(crane), hydraulics or Hydraulics.of(crane)
    rest = _rest(crane, start)
    system = System(crane.name)
    system.add("ship", ModelSlave((vessel or Fixed()).model(crane.pedestal)))
    system.add("joystick", joystick(crane, rest, start))
    for name, part in parts(crane, start=start, hydraulics=hydraulics).items():
        system.add(name, FmuSlave(fmi.cached(part)) if isinstance(part, Diagram) else ModelSlave(part))
    _couple(system, crane)
    return system


def check(crane: Crane) -> None:
    """`StructureError` with all that keeps a crane from being driven: joints without a drive, or with two."""
    names, moved = axis_names(crane), [cylinder.moves for cylinder in crane.cylinders]
    problems = []
    for axis, joint in zip(names, crane.joints, strict=True):
        path, sets, slewed = f"{crane.name}: joint {joint.name}", moved.count(joint.name), axis == SLEW
        if sets + slewed > 1:
            problems.append(
                Problem(path, "has more than one drive", f"{sets} cylinder sets", "one cylinder set, or slew")
            )
        elif not sets and not slewed and joint.kind == "revolute":
            problems.append(
                Problem(
                    path, "turns and nothing moves it", allowed="a cylinder", hint="Add one whose `moves` names it."
                )
            )
        elif not slewed and joint.limits is None:
            problems.append(Problem(path, "slides without limits", allowed="a joint with limits"))
    problems += [
        Problem(
            f"{crane.name}: cylinder {cylinder.name}",
            f"passes a dead point within the limits of {cylinder.moves}: coming out, it would raise and then lower",
            hint="Move its pins, or narrow the limits.",
        )
        for cylinder in crane.cylinders
        if cylinder.moves in {joint.name for joint in crane.joints if joint.limits}
        and geometry.extends_upward(crane, cylinder) is None
    ]
    taken = [*names, HOIST, "winch"]
    problems += [
        Problem(f"{crane.name}: axis {name}", "is the name of two drives", hint="Rename the joint or its cylinder.")
        for name in sorted({name for name in taken if taken.count(name) > 1})
    ]
    if problems:
        raise StructureError(problems)


def _rest(crane: Crane, start: Start) -> Equilibrium:
    return static_equilibrium(crane, start.joints(crane), _hung(crane, start), start.hanging)


def _hung(crane: Crane, start: Start) -> Mass:
    """What hangs on the rope: the load and the hook block."""
    return start.load + crane.hoist.hook_mass


def parts(
    crane: Crane, *, start: Start | None = None, hydraulics: Hydraulics | None = None
) -> dict[str, Diagram | Dae]:
    """The models that `build` couples, by name: each drive of the crane as a diagram, then its mechanics, "crane".

    They fit each other: all start in the same equilibrium, and the mechanics have the inertia of the drives' motors.
    `fmi.export` turns each into an FMU. `StructureError` for a crane whose joints cannot all be driven.
    """
    check(crane)
    start, hydraulics = start or Start.usual(crane), hydraulics or Hydraulics.of(crane)
    mechanics = crane_mechanics(crane, _hung(crane, start), start.joints(crane), start.hanging)
    return {
        **{diagram.name: diagram for diagram in drives(crane, _rest(crane, start), start, hydraulics)},
        mechanics.name: _with_rotors(mechanics, crane.slew, hydraulics),
    }


def _with_rotors(mechanics: Dae, slew: Slew | None, hydraulics: Hydraulics) -> Dae:
    """The motors' inertia, which the mechanics hold because they hold the speed, on top of what turns there anyway."""
    more = {"drum.inertia": hydraulics.winch.reflected_inertia}
    if slew:
        more[f"{slew.joint}.rotor_inertia"] = hydraulics.slew.reflected_inertia
    parameters = tuple(replace(v, start=v.start + more.get(v.name, 0.0)) for v in mechanics.parameters)
    return replace(mechanics, parameters=parameters)


def drives(crane: Crane, rest: Equilibrium, start: Start, hydraulics: Hydraulics) -> list[Diagram]:
    """The drives of the crane as diagrams, in the order of its joints and then the winch, starting at the forces of
    `rest`."""
    cylinders = {cylinder.moves: cylinder for cylinder in crane.cylinders}
    made = []
    for link in crane.links:
        joint = link.joint
        if crane.slew and joint.name == crane.slew.joint:
            made.append(slew_drive(crane.slew, crane.bulk_modulus, hydraulics))
        elif joint.name in cylinders:
            cylinder = cylinders[joint.name]
            out = extension(crane, cylinder, start.posture)
            made.append(cylinder_drive(crane, cylinder, rest, out, hydraulics))
        else:
            out = start.posture.get(joint.name, 0.0) - _lower(joint)
            made.append(telescope_drive(crane, link, rest, out, hydraulics))
    return [*made, winch_drive(crane, rest, hydraulics)]


def _lower(joint: Joint) -> float:
    return joint.limits[0] if joint.limits else 0.0


def extension(crane: Crane, cylinder: Cylinder, posture: Mapping[str, float]) -> Length:
    """How far a cylinder is out in a posture [m]."""
    return geometry.cylinder_length(crane, cylinder, posture) - geometry.retracted_length(crane, cylinder)


def joystick(crane: Crane, rest: Equilibrium, start: Start) -> FunctionSlave:
    """The operator's control; rope may be drawn in to half of what is out at the start, and 200 m more paid out."""
    settings = Joystick.of(
        crane,
        rope=(0.5 * rest.unstretched_length, rest.unstretched_length + 200.0),
        axis=Axis(valve_dead_band=DEAD_BAND),
        slew_axis=Axis(ramp=0.4, valve_dead_band=DEAD_BAND),
        release_time=RELEASE_TIME,
        angle_margin=1.0 * deg,
        two_block=min(3.0, 0.5 * start.hanging),
        rope_zone=min(5.0, 0.4 * start.hanging),
        slack_tension=min(5 * kN, 0.05 * GRAVITY * max(rated.mass for rated in crane.capacity) / crane.hoist.falls),
    )
    return FunctionSlave(settings, inputs=settings.inputs, outputs=settings.outputs, state=settings.start)


# ---------------------------------------------------------------- connections
def _couple(system: System, crane: Crane) -> None:
    for axis in "xyz":
        for quantity in ("al", "a", "g"):
            system.connect(f"ship.foot.{quantity}{axis}", f"crane.base.{quantity}{axis}")
        _foot_bond(system, f"foot_{axis}", f"wrench.f{axis}", f"v{axis}")
        _foot_bond(system, f"foot_r{axis}", f"wrench.m{axis}", f"w{axis}")
    system.connect("ship.foot.z", "crane.base.z")
    limited = [joint.name for joint in crane.joints if joint.limits]
    for measured in (*limited, "rope.unstretched_length", "rope.hanging", "rope.tension"):
        system.connect(f"crane.{measured}", f"joystick.{measured}")

    cylinders = {cylinder.moves: cylinder for cylinder in crane.cylinders}
    for axis, joint in zip(axis_names(crane), crane.joints, strict=True):
        name, drive = joint.name, f"{axis}_drive"
        if axis == SLEW:
            _bond(system, axis, ("torque", f"{name}.torque"), (f"{name}_rate", "speed"))
        elif name in cylinders:
            rods = cylinders[name].name
            upward = 1.0 if geometry.extends_upward(crane, cylinders[name]) else -1.0
            _bond(system, axis, ("rod_force", f"{rods}.force"), (f"{rods}.velocity", "rod_velocity"), upward)
            system.connect(f"crane.{rods}.extension", f"{drive}.rod_position")
        else:
            _bond(system, axis, ("rod_force", f"{name}.force"), (f"{name}_rate", "rod_velocity"))
            system.connect(f"crane.{name}", f"{drive}.rod_position", bias=-_lower(joint))
    _bond(system, "winch", ("torque", "drum.torque"), ("drum.speed", "speed"))


def _bond(system: System, spool: str, effort: Sequence[str], flow: Sequence[str], upward: float = 1.0) -> None:
    """The power bond between a drive and the crane, named after the drive's spool, and that spool.

    upward: -1 where the joint goes up as the cylinder goes in.
    """
    drive = f"{spool}_drive"
    system.connect(f"joystick.spool.{spool}", f"{drive}.spool", gain=upward)
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
