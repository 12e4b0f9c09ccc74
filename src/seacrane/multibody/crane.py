"""The mechanics of a whole crane as a DAE: links, cylinders, rope and drum, load, and the wrench on the ship.

All positions and velocities are relative to the crane's foot, in foot axes (x forward, y port, z up, fixed to the
ship). The ship enters through its motion at the foot, and receives the wrench there. Forces of the drives enter as
inputs, speeds of the same points leave as outputs, so each drive couples by a power bond.

The load is a point mass on the hook. With r its position from the foot, and w, dw/dt, a the foot's angular velocity,
angular acceleration and acceleration,

    m (d2r/dt2 + a + dw/dt x r + w x (w x r) + 2 w x dr/dt) = m g - T dl/dr - d v

where T is the rope's tension, l(q, r) the length of its path with all falls, and d v a linear drag on the velocity v
over still air.

Energy is accounted in the inertial frame: kinetic + potential + rope + dissipated + carried - work stays constant on an
exact solution, with the work of every actuator and of the ship as states. The `energy.closure` output is that sum.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca

from seacrane.design import Crane, geometry
from seacrane.model.dae import Dae, PowerBond, Variable, column
from seacrane.multibody import interface
from seacrane.multibody.chain import BaseMotion, forward_dynamics, frames, kinetic_energy, mass_moment
from seacrane.multibody.cylinder import attachment_point, distance, lengths
from seacrane.multibody.equilibrium import static_equilibrium
from seacrane.multibody.interface import AXES, turns
from seacrane.multibody.rope import RopeLaw, path_length, rope_law


def crane_mechanics(
    crane: Crane, load_mass: float = 40e3, posture: Sequence[float] | None = None, hanging: float = 12.0
) -> Dae:
    """The mechanics of `crane` as a `Dae` named "crane", starting in static equilibrium.

    load_mass [kg] on the hook; posture: joint values [rad, m] at the start, by default the middle of each joint's
    range; hanging [m]: from the tip sheave to the hook at the start. Inputs start at the forces that hold this posture.

    Joints moved by a cylinder take `<cylinder>.force` [N] (all cylinders of the set together, extending is positive);
    any other joint takes `<joint>.torque` [N.m] or `<joint>.force` [N]. `drum.torque` hoists when positive. Frictions
    and the drum's inertia start at a small share of the rated load, rotors at zero: set what the drives really have.
    """
    if posture is None:
        posture = [sum(link.joint.limits) / 2 if link.joint.limits else 0.0 for link in crane.links]
    start = static_equilibrium(crane, posture, load_mass, hanging)
    inputs, states, parameters = (
        interface.inputs(crane, start),
        interface.states(crane, start),
        interface.parameters(crane, load_mass),
    )
    t = ca.SX.sym("t")
    u, x, p = (ca.SX.sym(name, len(group)) for name, group in (("u", inputs), ("x", states), ("p", parameters)))
    values = {v.name: s[i] for g, s in ((inputs, u), (states, x), (parameters, p)) for i, v in enumerate(g)}
    motion = _motion(crane, values)
    outputs, observables = _outputs(crane, values, motion), _observables(crane, values, motion)
    ode = column(*(motion.rates[v.name] for v in states))
    out, obs = (column(*(expression for _, expression in group)) for group in (outputs, observables))
    ode, out, obs = ca.cse([ode, out, obs])
    nothing = ca.SX(0, 1)
    return Dae(
        name="crane",
        states=states,
        algebraics=(),
        inputs=inputs,
        parameters=parameters,
        outputs=tuple(v for v, _ in outputs),
        observables=tuple(v for v, _ in observables),
        t=t,
        x=x,
        z=nothing,
        u=u,
        p=p,
        ode=ode,
        alg=nothing,
        out=out,
        obs=obs,
        about=f"mechanics of {crane.name}: {len(crane.links)} links, cylinders, rope, drum and load on a moving foot",
        sources=("R. Featherstone, Rigid Body Dynamics Algorithms, Springer 2008",),
        bonds=_bonds(crane),
    )


# ---------------------------------------------------------------- equations
@dataclass(frozen=True)
class _Motion:
    """What the outputs are made of: rates of all states by name, and the quantities of the mechanism."""

    rates: Mapping[str, Any]
    cylinder_length: Any
    cylinder_speed: Any
    cylinder_arms: Any
    tip: Any
    tip_velocity: Any
    plane: Any
    rope: RopeLaw
    wrench: Any
    kinetic: Any
    potential: Any


def _motion(crane: Crane, s: Mapping[str, Any]) -> _Motion:
    joints = [link.joint.name for link in crane.links]
    q = ca.vertcat(*(s[f"{j}.position"] for j in joints))
    qd = ca.vertcat(*(s[f"{j}.rate"] for j in joints))
    r, v = _vector(s, "load.position."), _vector(s, "load.velocity.")
    w, alpha, a = _vector(s, "base.w"), _vector(s, "base.al"), _vector(s, "base.a")
    foot_velocity, gravity = _vector(s, "base.v"), _vector(s, "base.g")
    proper = a - gravity

    poses = frames(crane.links, q)
    path = [attachment_point(point, poses) for point in (crane.hoist.drum, *crane.hoist.sheaves)]
    tip = path[-1]
    falls = crane.hoist.falls
    rope_length = path_length(path, r, falls)
    rope_by_q, rope_by_r = ca.jacobian(rope_length, q), ca.jacobian(rope_length, r)
    mass, unstretched, ea = s["load.mass"], s["rope.unstretched"], s["rope.EA"]
    winding = s["drum.radius"] * s["drum.rate"]
    rope = rope_law(
        rope_length,
        stretching=rope_by_q @ qd + rope_by_r @ v + winding,
        winding=winding,
        unstretched=unstretched,
        stiffness=ea,
        damping=2 * s["rope.damping_ratio"] * ca.sqrt(ea / unstretched * mass) / falls,
    )

    cylinder_length = lengths(crane.cylinders, poses)
    arms = ca.jacobian(cylinder_length, q)
    speed = arms @ qd
    cylinder_force = ca.vertcat(*(s[f"{c.name}.force"] for c in crane.cylinders))
    friction = ca.vertcat(*(s[f"{j}.friction"] * s[f"{j}.rate"] for j in joints))
    drive = ca.vertcat(*(s.get(interface.drive_name(link), 0) for link in crane.links))
    rotor = ca.vertcat(*(s.get(f"{j}.rotor_inertia", 0) for j in joints))
    effort = arms.T @ cylinder_force + drive - friction - rope_by_q.T * rope.tension
    base = BaseMotion(w, alpha, proper)
    qdd, foot_on_chain = forward_dynamics(crane.links, q, qd, effort, base, rotor)

    still_air = foot_velocity + ca.cross(w, r) + v
    rope_on_load = -rope_by_r.T * rope.tension
    drag = -s["load.drag"] * still_air
    fictitious = proper + ca.cross(alpha, r) + ca.cross(w, ca.cross(w, r)) + 2 * ca.cross(w, v)
    load_acceleration = (rope_on_load + drag) / mass - fictitious

    drum_rate, drum_inertia = s["drum.rate"], s["drum.inertia"]
    drum_drag = s["drum.friction"] * drum_rate
    drum_acceleration = (s["drum.torque"] - rope.tension * s["drum.radius"] - drum_drag) / drum_inertia

    # The rope is massless, so it hands the pull of the load to the crane at the tip.
    wrench = ca.vertcat(ca.cross(tip, -rope_on_load), -rope_on_load) - foot_on_chain
    foot_twist = ca.vertcat(w, foot_velocity)
    kinetic = (
        kinetic_energy(crane.links, q, qd, foot_twist)
        + ca.dot(rotor, qd * qd) / 2
        + drum_inertia * drum_rate**2 / 2
        + mass * ca.dot(still_air, still_air) / 2
    )
    total_mass = sum(link.mass for link in crane.links) + mass
    moment = mass_moment(crane.links, q) + mass * r
    potential = total_mass * ca.norm_2(gravity) * s["base.z"] - ca.dot(gravity, moment)

    rates = {
        **dict(zip((f"{j}.position" for j in joints), ca.vertsplit(qd), strict=True)),
        **dict(zip((f"{j}.rate" for j in joints), ca.vertsplit(ca.densify(qdd)), strict=True)),
        **dict(zip((f"load.position.{i}" for i in AXES), ca.vertsplit(v), strict=True)),
        **dict(zip((f"load.velocity.{i}" for i in AXES), ca.vertsplit(load_acceleration), strict=True)),
        "rope.unstretched": rope.unstretched_rate,
        "drum.rate": drum_acceleration,
        "counter.work_drum": s["drum.torque"] * drum_rate,
        "counter.work_base": -ca.dot(wrench, foot_twist),
        "counter.dissipated": rope.dissipation + ca.dot(friction, qd) + drum_drag * drum_rate - ca.dot(drag, still_air),
        "counter.carried": rope.carried,
    }
    for i, cylinder in enumerate(crane.cylinders):
        rates[f"counter.work_{interface.short_name(cylinder.name)}"] = cylinder_force[i] * speed[i]
    for link in interface.driven_links(crane):
        name = link.joint.name
        rates[f"counter.work_{name}"] = s[interface.drive_name(link)] * s[f"{name}.rate"]
    return _Motion(
        rates=rates,
        cylinder_length=cylinder_length,
        cylinder_speed=speed,
        cylinder_arms=arms,
        tip=tip,
        tip_velocity=ca.jacobian(tip, q) @ qd,
        plane=poses[crane.links[0].name].axes,
        rope=rope,
        wrench=wrench,
        kinetic=kinetic,
        potential=potential,
    )


# ---------------------------------------------------------------- results
def _outputs(crane: Crane, s: Mapping[str, Any], m: _Motion) -> list[tuple[Variable, Any]]:
    out: list[tuple[Variable, Any]] = []

    def give(name: str, unit: str, expression: Any, about: str, shown: str = "") -> None:
        out.append((Variable(name, unit, about=about, shown=shown), expression))

    for link in crane.links:
        name, angle = link.joint.name, turns(link)
        give(name, "rad" if angle else "m", s[f"{name}.position"], "joint position")
        give(f"{name}_rate", "rad/s" if angle else "m/s", s[f"{name}.rate"], "joint rate")
    for i, cylinder in enumerate(crane.cylinders):
        give(f"{cylinder.name}.length", "m", m.cylinder_length[i], "length between the pins")
        give(f"{cylinder.name}.velocity", "m/s", m.cylinder_speed[i], "speed of extension")
        extension = m.cylinder_length[i] - geometry.retracted_length(crane, cylinder)
        give(f"{cylinder.name}.extension", "m", extension, "extension from fully retracted")
    give("drum.speed", "rad/s", s["drum.rate"], "drum speed, hoisting", "rpm")
    for axis in AXES:
        give(f"load.{axis}", "m", s[f"load.position.{axis}"], "load from the foot, foot axes")
    for axis in AXES:
        give(f"load.v{axis}", "m/s", s[f"load.velocity.{axis}"], "load relative to the foot, foot axes")
    for i, axis in enumerate(AXES):
        give(f"tip.{axis}", "m", m.tip[i], "tip sheave from the foot, foot axes")
    load, gravity = _vector(s, "load.position."), _vector(s, "base.g")
    up = -gravity / ca.norm_2(gravity)
    give("rope.tension", "N", m.rope.tension, "tension of the rope")
    give("rope.unstretched_length", "m", s["rope.unstretched"], "unstretched length, drum to hook")
    give("rope.stretch", "m", m.rope.stretch, "stretch of the rope; negative when slack", "mm")
    give("rope.hanging", "m", distance(m.tip, load), "distance from the tip sheave to the hook")
    give("radius", "m", distance(m.tip[:2], ca.DM(2, 1)), "working radius: tip from the slew axis")
    give("hook_height", "m", s["base.z"] + ca.dot(up, load), "height of the hook above still water")
    for i, axis in enumerate(AXES):
        give(f"wrench.f{axis}", "N", m.wrench[3 + i], "force of the crane on the ship at the foot, foot axes")
    for i, axis in enumerate(AXES):
        give(f"wrench.m{axis}", "N.m", m.wrench[i], "moment of the crane on the ship about the foot, foot axes")
    give("energy.kinetic", "J", m.kinetic, "kinetic energy in the inertial frame")
    give("energy.potential", "J", m.potential, "potential energy over still water")
    give("energy.rope", "J", m.rope.energy, "elastic energy of the rope")
    counters = interface.counters(crane)
    for name, about in counters.items():
        give(f"energy.{name}", "J", s[f"counter.{name}"], about)
    stored = m.kinetic + m.potential + m.rope.energy + s["counter.dissipated"] + s["counter.carried"]
    work = sum(s[f"counter.{name}"] for name in counters if name.startswith("work_"))
    give("energy.closure", "J", stored - work, "energy unaccounted for: constant on an exact solution")
    return out


def _bonds(crane: Crane) -> tuple[PowerBond, ...]:
    """Where power goes in from cylinders and drives, and out to the ship."""
    return (
        *(PowerBond(c.name, f"{c.name}.velocity", f"{c.name}.force") for c in crane.cylinders),
        *(
            PowerBond(link.joint.name, f"{link.joint.name}_rate", interface.drive_name(link))
            for link in interface.driven_links(crane)
        ),
        PowerBond("drum", "drum.speed", "drum.torque"),
        *(PowerBond(f"foot_{axis}", f"base.v{axis}", f"wrench.f{axis}", inward=False) for axis in AXES),
        *(PowerBond(f"foot_r{axis}", f"base.w{axis}", f"wrench.m{axis}", inward=False) for axis in AXES),
    )


def _observables(crane: Crane, s: Mapping[str, Any], m: _Motion) -> list[tuple[Variable, Any]]:
    obs = []
    for i, cylinder in enumerate(crane.cylinders):
        joint = [link.joint.name for link in crane.links].index(cylinder.moves)
        arm = m.cylinder_arms[i, joint]
        turning = turns(crane.links[joint])
        obs.append((Variable(f"{cylinder.name}.arm", "m" if turning else "1", about="lever arm on its joint"), arm))
        effort = Variable(f"{cylinder.name}.moment", "N.m" if turning else "N", about="moment on its joint")
        obs.append((effort, arm * s[f"{cylinder.name}.force"]))
    for i, axis in enumerate(AXES):
        obs.append((Variable(f"tip.v{axis}", "m/s", about="tip relative to the foot, foot axes"), m.tip_velocity[i]))
    fall = _vector(s, "load.position.") - m.tip
    down = ca.dot(fall, _vector(s, "base.g") / ca.norm_2(_vector(s, "base.g")))
    for name, direction in (("offlead", 0), ("sidelead", 1)):
        about = f"angle of the rope from the vertical {'in' if direction == 0 else 'across'} the plane of the crane"
        angle = ca.atan2(ca.dot(fall, m.plane[:, direction]), down)
        obs.append((Variable(f"rope.{name}", "rad", about=about), angle))
    return obs


def _vector(s: Mapping[str, Any], prefix: str) -> Any:
    return ca.vertcat(*(s[prefix + i] for i in AXES))
