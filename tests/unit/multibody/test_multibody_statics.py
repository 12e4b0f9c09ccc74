"""Known values of the reference crane, and small motions about its equilibrium."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest
from dae_evaluation import Evaluation
from scipy.integrate import solve_ivp

from seacrane import design
from seacrane.multibody import Kinematics, crane_mechanics, static_equilibrium
from seacrane.multibody.chain import BaseMotion, inverse_dynamics
from seacrane.units import bar

CRANE = design.load("offshore-100t")
MASS = 40e3
POSTURE = np.radians([90, 50, -70])
PISTONS = np.array([c.count * math.pi / 4 * c.bore**2 for c in CRANE.cylinders])


def linearised(posture: np.ndarray, oil_spring: float, hanging: float = 12.0) -> tuple[list[str], np.ndarray]:
    """States and system matrix, drum and slewing held, cylinders on oil springs, no friction."""
    dae = crane_mechanics(CRANE, MASS, posture, hanging)
    names = [v.name for v in dae.states]
    held = {f"{c.name}.force" for c in CRANE.cylinders}
    start = [ca.DM([v.start for v in group]) for group in (dae.states, dae.inputs, dae.parameters)]
    parameters = ca.DM([0 if v.name.endswith(("friction", "damping_ratio")) else v.start for v in dae.parameters])
    outputs = [v.name for v in dae.outputs]
    lengths = ca.vertcat(*(dae.out[outputs.index(f"{c.name}.length")] for c in CRANE.cylinders))
    rest = ca.Function("lengths", [dae.x], [lengths])(start[0])
    u = ca.DM(start[1])
    forces = ca.vertcat(*(u[i] for i, v in enumerate(dae.inputs) if v.name in held)) - oil_spring * (lengths - rest)
    inputs = ca.vertcat(forces, u[len(held) :])
    assert [v.name for v in dae.inputs][: len(held)] == [f"{c.name}.force" for c in CRANE.cylinders]
    ode = ca.substitute(dae.ode, ca.vertcat(dae.u, dae.p), ca.vertcat(inputs, parameters))
    matrix = ca.Function("a", [dae.x], [ca.jacobian(ode, dae.x)])(start[0]).full()
    free = [i for i, n in enumerate(names) if not n.startswith(("slew", "drum", "rope", "counter"))]
    return [names[i] for i in free], matrix[np.ix_(free, free)]


def frequencies(matrix: np.ndarray) -> np.ndarray:
    """Natural frequencies [rad/s], ascending, each once."""
    eigenvalues = np.linalg.eigvals(matrix)
    assert np.abs(eigenvalues.real).max() < 1e-5
    return np.sort(eigenvalues.imag[eigenvalues.imag > 0])


def test_the_reference_posture_has_its_radius_lengths_and_arms() -> None:
    kinematics = Kinematics(CRANE)
    assert kinematics.radius(POSTURE) == pytest.approx(24.73, abs=0.005)
    assert kinematics.cylinder_lengths(POSTURE) == pytest.approx([8.54, 7.14], abs=0.005)
    arms = kinematics.cylinder_arms(POSTURE)
    assert [arms[0, 1], arms[1, 2]] == pytest.approx([3.00, 2.19], abs=0.005)


def test_static_pressures_with_the_rope_led_to_the_drum() -> None:
    held = static_equilibrium(CRANE, POSTURE, MASS, 12.0)
    pressures = np.array(list(held.cylinder_forces.values())) / PISTONS
    assert pressures / bar == pytest.approx([191.0, 115.5], abs=0.05)
    assert held.tension == pytest.approx(MASS * 9.81, rel=1e-12)
    assert held.drum_torque == pytest.approx(MASS * 9.81 * CRANE.hoist.drum_radius, rel=1e-12)


def test_static_pressures_with_the_load_hung_from_the_tip() -> None:
    kinematics = Kinematics(CRANE)
    own, _ = inverse_dynamics(CRANE.links, ca.DM(POSTURE), ca.DM.zeros(3), ca.DM.zeros(3), BaseMotion.at_rest())
    effort = own.full().ravel() + MASS * 9.81 * kinematics.jacobian(POSTURE)[2]
    arms = kinematics.cylinder_arms(POSTURE)
    pressures = np.linalg.solve(arms[:, 1:].T, effort[1:]) / PISTONS
    assert pressures / bar == pytest.approx([195.3, 118.2], abs=0.05)


@pytest.mark.parametrize("oil_spring", [2.2e8, 2.4e8])
def test_modes_with_locked_cylinders(oil_spring: float) -> None:
    _, matrix = linearised(POSTURE, oil_spring)
    found = frequencies(matrix)
    assert found[-3:] == pytest.approx([5.9, 19, 44], rel=0.05)


def test_the_load_swings_and_bounces_as_a_pendulum_on_a_spring() -> None:
    """With the crane held: sqrt(g/l) across, sqrt(EA/(m L0)) along."""
    hanging = 20.0
    names, matrix = linearised(POSTURE, 2.2e8, hanging)
    load = [i for i, n in enumerate(names) if n.startswith("load")]
    found = frequencies(matrix[np.ix_(load, load)])
    held = static_equilibrium(CRANE, POSTURE, MASS, hanging)
    bounce = math.sqrt(CRANE.hoist.rope.EA / (MASS * held.unstretched_length))
    assert found == pytest.approx([math.sqrt(9.81 / hanging)] * 2 + [bounce], rel=1e-9)


def test_a_small_swing_takes_the_period_of_the_closed_form() -> None:
    hanging, amplitude = 20.0, 0.01
    dae = crane_mechanics(CRANE, MASS, POSTURE, hanging)
    model = Evaluation(dae)
    names = [v.name for v in dae.states]
    moving = [names.index(f"load.{kind}.{i}") for kind in ("position", "velocity") for i in "xyz"]
    start = np.array([v.start for v in dae.states])
    u, p = ([v.start for v in group] for group in (dae.inputs, dae.parameters))

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        full = start.copy()
        full[moving] = x
        return model.function(t, full, u, p)[0].full().ravel()[moving]

    first = start[moving]
    first[0] += hanging * math.sin(amplitude)
    first[2] += hanging * (1 - math.cos(amplitude))

    def crossing(t: float, x: np.ndarray) -> float:
        return float(x[0] - start[moving[0]])

    run = solve_ivp(rate, (0, 30), first, "DOP853", rtol=1e-10, atol=1e-10, events=crossing)
    half_periods = np.diff(run.t_events[0])
    assert half_periods == pytest.approx(math.pi * math.sqrt(hanging / 9.81), rel=1e-4)
