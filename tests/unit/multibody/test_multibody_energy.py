"""Energy that actuators and ship put in is stored, lost or carried onto the drum, to the tolerance of the solver."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import msgspec
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from seacrane import design
from seacrane.model.dae import Dae
from seacrane.multibody import crane_mechanics
from seacrane.multibody.spatial import rotation

CRANE = design.load("offshore-100t")
POSTURE = np.radians([60, 50, -70])
TOLERANCE = 1e-11


def fixed_foot(t: ca.SX) -> dict[str, ca.SX]:
    return {}


def sailing_foot(t: ca.SX) -> dict[str, ca.SX]:
    """Six harmonic motions of the foot; all that the crane is told follows from them by differentiation."""
    roll, pitch, yaw = 0.12 * ca.sin(0.9 * t), 0.06 * ca.sin(0.7 * t + 1), 0.04 * ca.sin(0.4 * t + 2)
    place = ca.vertcat(0.8 * ca.sin(0.5 * t), 1.1 * ca.sin(0.6 * t + 0.5), 12 + 1.5 * ca.sin(0.8 * t + 1.5))
    axes = ca.densify(rotation((0, 0, 1), yaw) @ rotation((0, 1, 0), pitch) @ rotation((1, 0, 0), roll))
    spin = axes.T @ ca.reshape(ca.jacobian(ca.vec(axes), t), 3, 3)
    w = ca.vertcat(spin[2, 1], spin[0, 2], spin[1, 0])
    velocity = ca.jacobian(place, t)
    vectors = {
        "base.w": w,
        "base.al": ca.jacobian(w, t),
        "base.v": axes.T @ velocity,
        "base.a": axes.T @ ca.jacobian(velocity, t),
        "base.g": axes.T @ ca.DM([0, 0, -9.81]),
    }
    return {"base.z": place[2], **{p + axis: v[i] for p, v in vectors.items() for i, axis in enumerate("xyz")}}


@dataclass(frozen=True)
class Ledger:
    """Outputs over time by name."""

    names: list[str]
    values: np.ndarray

    def __getitem__(self, name: str) -> np.ndarray:
        return self.values[self.names.index(name)]

    @property
    def moved(self) -> float:
        """The energy that went through the actuators and the foot in either direction, at least [J]."""
        return float(sum(np.abs(np.diff(self[n])).sum() for n in self.names if n.startswith("energy.work_")))

    @property
    def unaccounted(self) -> float:
        """Largest departure of the balance from its start [J]."""
        return float(np.abs(self["energy.closure"] - self["energy.closure"][0]).max())


def manoeuvre(foot: dict[str, ca.SX], t: ca.SX, dae: Dae, duration: float, **parameters: float) -> Ledger:
    """Swing the drives smoothly about their holding forces, with springs for the oil; integrate to the tolerance."""
    names = [v.name for v in dae.outputs]
    inputs = []
    for v in dae.inputs:
        value = foot.get(v.name, ca.SX(v.start))
        if v.name.endswith("_cylinder.force"):
            length, speed = (dae.out[names.index(v.name.replace("force", kind))] for kind in ("length", "velocity"))
            rest = ca.Function("rest", [dae.x], [length])([s.start for s in dae.states])
            value = v.start - 2e7 * (length - rest - 0.2 * (1 - ca.cos(0.5 * t))) - 2e5 * speed
        elif v.name == "slew.torque":
            value = 1e6 * ca.sin(0.8 * t)
        elif v.name == "drum.torque":
            value = v.start * (1 + 0.05 * ca.sin(0.7 * t))
        inputs.append(value)
    p = [parameters.pop(v.name, v.start) for v in dae.parameters]
    x0 = np.array([parameters.pop(v.name, v.start) for v in dae.states])
    assert not parameters
    known = ca.vertcat(dae.u, dae.p)
    u = ca.substitute(ca.vertcat(*inputs), dae.p, ca.DM(p))
    ode, out = (ca.substitute(e, known, ca.vertcat(u, ca.DM(p))) for e in (dae.ode, dae.out))
    rate, outputs = (ca.Function("f", [t, dae.x], [e]) for e in (ode, out))
    scale = np.array([v.nominal for v in dae.states])
    run = solve_ivp(
        lambda time, x: rate(time, x).full().ravel(),
        (0, duration),
        x0,
        "DOP853",
        rtol=TOLERANCE,
        atol=TOLERANCE * scale,
        max_step=0.02,
    )
    assert run.success
    values = np.column_stack([outputs(time, x).full().ravel() for time, x in zip(run.t, run.y.T, strict=True)])
    return Ledger(names, values)


@pytest.fixture(scope="module")
def dae() -> Dae:
    return crane_mechanics(CRANE, 40e3, POSTURE)


DRAG_AND_FRICTION = {"load.drag": 500.0, "luff.friction": 2e5, "drum.friction": 5e3}


@pytest.mark.parametrize("foot", [fixed_foot, sailing_foot])
def test_energy_is_accounted_for_to_the_tolerance_of_the_solver(
    dae: Dae, foot: Callable[[ca.SX], dict[str, ca.SX]]
) -> None:
    t = ca.SX.sym("t")
    ledger = manoeuvre(foot(t), t, dae, 10.0, **DRAG_AND_FRICTION)
    assert ledger.moved > 1e6
    assert ledger.unaccounted < 1e-9 * ledger.moved
    assert np.all(np.diff(ledger["energy.dissipated"]) >= -1e-6)
    assert (foot is fixed_foot) == (np.abs(ledger["energy.work_base"]).max() == 0)


def test_energy_is_accounted_for_when_a_slack_rope_catches_the_load(dae: Dae) -> None:
    t = ca.SX.sym("t")
    slack = next(v.start for v in dae.states if v.name == "rope.unstretched") + 0.5
    ledger = manoeuvre(fixed_foot(t), t, dae, 3.0, **{"rope.unstretched": slack})
    assert ledger["energy.rope"][0] == 0
    assert ledger["energy.rope"].max() > 5e4
    assert ledger.unaccounted < 1e-7 * ledger["energy.rope"].max()


def test_falls_share_the_load_and_keep_the_account() -> None:
    t = ca.SX.sym("t")
    crane = msgspec.structs.replace(CRANE, hoist=msgspec.structs.replace(CRANE.hoist, falls=3))
    ledger = manoeuvre(fixed_foot(t), t, crane_mechanics(crane, 40e3, POSTURE), 4.0, **DRAG_AND_FRICTION)
    assert ledger["rope.tension"][0] == pytest.approx(40e3 * 9.81 / 3, rel=1e-9)
    assert ledger.moved > 1e5
    assert ledger.unaccounted < 1e-9 * ledger.moved


def test_strained_rope_carries_energy_off_the_drum_when_lowered(dae: Dae) -> None:
    """T^2/(2 EA) per unstretched metre at a tension that stays near the weight."""
    t = ca.SX.sym("t")
    ledger = manoeuvre(fixed_foot(t), t, dae, 2.0, **{"drum.rate": -1.0})
    paid_out = ledger["rope.unstretched_length"] - ledger["rope.unstretched_length"][0]
    assert np.all(np.diff(ledger["energy.carried"]) <= 0)
    per_metre = (40e3 * 9.81) ** 2 / (2 * CRANE.hoist.rope.EA)
    assert ledger["energy.carried"][-1] == pytest.approx(-per_metre * paid_out[-1], rel=0.1)


def test_without_losses_nothing_is_dissipated(dae: Dae) -> None:
    t = ca.SX.sym("t")
    lossless = {v.name: 0.0 for v in dae.parameters if v.name.endswith(("friction", "damping_ratio", "drag"))}
    ledger = manoeuvre(fixed_foot(t), t, dae, 2.0, **lossless)
    assert np.abs(ledger["energy.dissipated"]).max() == 0
