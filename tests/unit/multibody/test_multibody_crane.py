from __future__ import annotations

import math

import casadi as ca
import msgspec
import numpy as np
import pytest
from dae_evaluation import Evaluation, vector
from mujoco_oracle import CraneOracle, Foot

from seacrane import design
from seacrane.errors import StructureError
from seacrane.multibody import crane_mechanics, static_equilibrium
from seacrane.multibody.chain import mass_moment

CRANE = design.load("offshore-100t")
MASS = 40e3
POSTURE = np.radians([90, 50, -70])
JOINTS = ("slew", "luff", "jib")


@pytest.fixture(scope="module")
def model() -> Evaluation:
    return Evaluation(crane_mechanics(CRANE, MASS, POSTURE))


def test_the_interface_is_the_one_that_drives_and_ship_connect_to(model: Evaluation) -> None:
    foot = ["base.z"] + [f"base.{kind}{i}" for kind in ("w", "al", "a", "v", "g") for i in "xyz"]
    forces = ["boom_cylinder.force", "jib_cylinder.force", "slew.torque", "drum.torque"]
    assert sorted(v.name for v in model.dae.inputs) == sorted(foot + forces)
    outputs = {v.name: v.unit for v in model.dae.outputs}
    assert {name: outputs[name] for name in ("slew", "luff", "jib")} == dict.fromkeys(JOINTS, "rad")
    speeds = {
        "slew_rate": "rad/s",
        "boom_cylinder.velocity": "m/s",
        "jib_cylinder.velocity": "m/s",
        "drum.speed": "rad/s",
    }
    assert {name: outputs[name] for name in speeds} == speeds
    wrench = {**{f"wrench.f{i}": "N" for i in "xyz"}, **{f"wrench.m{i}": "N.m" for i in "xyz"}}
    assert {name: outputs[name] for name in wrench} == wrench


def state(q: np.ndarray, qd: np.ndarray, r: np.ndarray, v: np.ndarray) -> dict[str, float]:
    joints = {f"{name}.position": x for name, x in zip(JOINTS, q, strict=True)}
    rates = {f"{name}.rate": x for name, x in zip(JOINTS, qd, strict=True)}
    return {**joints, **rates, **vector("load.position.", r), **vector("load.velocity.", v)}


def base(foot: Foot) -> dict[str, float]:
    motion = (("base.w", foot.w), ("base.al", foot.alpha), ("base.a", foot.a), ("base.g", foot.gravity))
    return {name: value for prefix, v in motion for name, value in vector(prefix, v).items()}


def rates(result: dict[str, float], name: str, of: tuple[str, ...]) -> np.ndarray:
    return np.array([result[f"der({name.format(i)})"] for i in of])


def close(found: object, expected: object, relative: float = 1e-9) -> bool:
    """Equal to within `relative` of the largest component."""
    return bool(np.max(np.abs(np.subtract(found, expected))) <= relative * np.max(np.abs(expected)))


@pytest.mark.parametrize("moving", [False, True], ids=["fixed foot", "moving foot"])
def test_a_whole_crane_moves_as_in_mujoco(model: Evaluation, moving: bool) -> None:
    rng, oracle = np.random.default_rng(4), CraneOracle(CRANE, MASS)
    start = static_equilibrium(CRANE, POSTURE, MASS, 12.0)
    ea, zeta, radius = CRANE.hoist.rope.EA, CRANE.hoist.rope.damping_ratio, CRANE.hoist.drum_radius
    taut = 0
    for _ in range(200):
        foot = Foot.random(rng) if moving else Foot.at_rest()
        q, qd = POSTURE + rng.uniform(-0.4, 0.4, 3), rng.uniform(-0.3, 0.3, 3)
        result = model(state(q, qd, np.zeros(3), np.zeros(3)))
        tip = np.array([result[f"tip.{i}"] for i in "xyz"])
        r, v = tip + rng.uniform((-4, -4, -20), (4, 4, -5)), rng.uniform(-1.5, 1.5, 3)
        path = oracle.place(foot, q, qd, r, v)
        unstretched = path - rng.choice([rng.uniform(-0.3, -0.05), rng.uniform(0.0, 0.2)])
        forces = np.array(list(start.cylinder_forces.values())) + rng.uniform(-1e6, 1e6, 2)
        slew, drum, speed = rng.uniform(-1e6, 1e6), rng.uniform(0, 4e5), rng.uniform(-2, 2)
        friction, rotor = rng.uniform(0, 1e6, 3), rng.uniform(0, 1e6)
        oracle.model.dof_armature[6] = rotor
        stiffness = ea / unstretched
        rope = (stiffness, 2 * zeta * math.sqrt(stiffness * MASS), unstretched, radius * speed)
        qdd, load, tension, wrench = oracle.solve(foot, forces, rope, np.array([slew, 0, 0]) - friction * qd)
        result = model(
            {
                **state(q, qd, r, v),
                **base(foot),
                **{f"{c.name}.force": f for c, f in zip(CRANE.cylinders, forces, strict=True)},
                **{f"{name}.friction": b for name, b in zip(JOINTS, friction, strict=True)},
                "slew.torque": slew,
                "drum.torque": drum,
                "drum.rate": speed,
                "rope.unstretched": unstretched,
                "slew.rotor_inertia": rotor,
                "drum.inertia": 8e3,
                "drum.friction": 1e3,
            }
        )
        taut += tension > 0
        assert close(rates(result, "{}.rate", JOINTS), qdd)
        assert close(rates(result, "load.velocity.{}", ("x", "y", "z")), load)
        assert close([result[f"{c.name}.length"] for c in CRANE.cylinders], oracle.lengths(), 1e-12)
        assert result["rope.tension"] == pytest.approx(tension, rel=1e-9, abs=1e-3)
        assert close([result[f"wrench.m{i}"] for i in "xyz"], -wrench[:3])
        assert close([result[f"wrench.f{i}"] for i in "xyz"], -wrench[3:])
        own = drum - radius * tension - 1e3 * speed
        assert result["der(drum.rate)"] == pytest.approx(own / 8e3, rel=1e-9, abs=1e-6)
    assert 50 < taut < 150


def test_a_slack_rope_pulls_nothing_and_the_load_falls_freely(model: Evaluation) -> None:
    result = model({"rope.unstretched": 60.0, "load.velocity.z": 5.0})
    assert result["rope.tension"] == 0
    assert result["energy.rope"] == 0
    assert [result[f"der(load.velocity.{i})"] for i in "xyz"] == [0, 0, -9.81]


def test_a_rope_never_pushes_even_when_its_damper_would(model: Evaluation) -> None:
    start = next(v.start for v in model.dae.states if v.name == "rope.unstretched")
    length = start * (1 + MASS * 9.81 / CRANE.hoist.rope.EA)
    result = model({"rope.unstretched": length - 1e-4, "load.velocity.z": 2.0})
    assert result["rope.stretch"] > 0
    assert result["rope.tension"] == 0


def test_nothing_is_undefined_with_the_hook_in_the_tip_sheave(model: Evaluation) -> None:
    tip = model()
    result = model({f"load.position.{i}": tip[f"tip.{i}"] for i in "xyz"})
    assert all(math.isfinite(value) for value in result.values())


def test_the_crane_starts_at_rest(model: Evaluation) -> None:
    result = model()
    assert max(abs(value) for name, value in result.items() if name.startswith("der(")) < 1e-9


def test_the_ship_carries_the_weight_of_crane_and_load(model: Evaluation) -> None:
    result = model()
    weight = 9.81 * (sum(link.mass for link in CRANE.links) + MASS)
    assert result["wrench.fz"] == pytest.approx(-weight, rel=1e-12)
    assert result["wrench.mx"] < 0, "a load to port heels to port"


def test_the_wrench_on_the_ship_is_weight_less_the_rate_of_momentum(model: Evaluation) -> None:
    """Momentum as the gradient of the kinetic energy by the foot's velocity; its rate by central differences."""
    dae = model.dae
    rng = np.random.default_rng(6)
    kinetic = dae.out[[v.name for v in dae.outputs].index("energy.kinetic")]
    moment = ca.gradient(kinetic, dae.u)
    momentum = ca.Function("momentum", [dae.x, dae.u, dae.p], [moment])
    inputs = [v.name for v in dae.inputs]
    foot = [inputs.index(prefix + i) for prefix in ("base.w", "base.v") for i in "xyz"]
    start = state(POSTURE, rng.uniform(-0.3, 0.3, 3), np.array([1.0, 25.0, 2.0]), rng.uniform(-1, 1, 3))
    result = model({**start, "boom_cylinder.force": 6e6, "rope.unstretched": 46.0})
    assert result["rope.tension"] > 1e5
    x = np.array([start.get(v.name, v.start) for v in dae.states])
    rate = np.array([result[f"der({v.name})"] for v in dae.states])
    u, p = ([v.start for v in group] for group in (dae.inputs, dae.parameters))
    h = 1e-5
    after, before = (momentum(x + s * h * rate, u, p).full().ravel()[foot] for s in (1, -1))
    weight = np.array([0, 0, -9.81])
    moment_of_mass = mass_moment(CRANE.links, x[:3].tolist()).full().ravel() + MASS * x[6:9]
    mass = sum(link.mass for link in CRANE.links) + MASS
    gravity = np.concatenate([np.cross(moment_of_mass, weight), mass * weight])
    wrench = [result[f"wrench.{i}"] for i in ("mx", "my", "mz", "fx", "fy", "fz")]
    assert close(wrench, gravity - (after - before) / (2 * h), 1e-7)


def test_a_heeled_crane_is_held_by_its_slewing_drive_too(model: Evaluation) -> None:
    heel = math.radians(5)
    gravity = (0.0, 9.81 * math.sin(heel), -9.81 * math.cos(heel))
    posture = np.radians([0, 50, -70])
    held = static_equilibrium(CRANE, posture, MASS, 12.0, gravity)
    assert held.drives["slew"] < 0, "heeled to port, the boom must be kept from falling to port"
    result = model(
        {
            **state(posture, np.zeros(3), held.load_position, np.zeros(3)),
            **vector("base.g", np.array(gravity)),
            **{f"{name}.force": force for name, force in held.cylinder_forces.items()},
            "slew.torque": held.drives["slew"],
            "rope.unstretched": held.unstretched_length,
        }
    )
    assert max(abs(value) for name, value in result.items() if name.startswith("der(")) < 1e-8


def test_a_cylinder_without_a_lever_is_named() -> None:
    pivot, eye = design.Attachment(link="column", x=0, z=4), design.Attachment(link="boom", x=3, z=0)
    radial = msgspec.structs.replace(CRANE.cylinders[0], base=pivot, eye=eye)
    crane = msgspec.structs.replace(CRANE, cylinders=(radial, CRANE.cylinders[1]))
    with pytest.raises(StructureError, match="have no lever on the joints they move"):
        static_equilibrium(crane, POSTURE, MASS, 12.0)
