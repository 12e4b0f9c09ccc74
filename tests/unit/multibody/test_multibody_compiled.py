from __future__ import annotations

import math

import numpy as np
import pytest

from seacrane import design
from seacrane.model import native
from seacrane.multibody import crane_mechanics

POSTURE = np.radians([90, 50, -70])


@pytest.fixture(scope="module")
def model() -> native.NativeModel:
    return native.build(crane_mechanics(design.load("offshore-100t"), 40e3, POSTURE))


def energy_lost(model: native.NativeModel, fixed_step: float) -> float:
    """Energy unaccounted for [J] after a second of hoisting while slewing."""
    with model.instantiate() as crane:
        crane.set("solver.fixed_step", fixed_step)
        crane.set(["slew.torque", "drum.torque"], [5e5, 3.4e5])
        crane.initialize(0.0)
        before = crane.get("energy.closure")
        for k in range(500):
            crane.step(k * 0.002, 0.002)
        assert crane.get("energy.work_slew") > 1e3
        return abs(crane.get("energy.closure") - before)


def test_the_compiled_crane_keeps_its_posture_in_equilibrium(model: native.NativeModel) -> None:
    with model.instantiate() as crane:
        crane.initialize(0.0)
        for k in range(500):
            crane.step(k * 0.002, 0.002)
        assert [crane.get(name) for name in ("slew", "luff", "jib")] == pytest.approx(POSTURE, abs=1e-9)
        assert crane.get("radius") == pytest.approx(24.73, abs=0.005)
        assert crane.get("rope.tension") == pytest.approx(40e3 * 9.81, rel=1e-6)


def test_the_compiled_crane_accounts_for_its_energy(model: native.NativeModel) -> None:
    assert energy_lost(model, 0.0) < 1e-3


def test_a_fixed_step_loses_energy_in_proportion(model: native.NativeModel) -> None:
    coarse, fine = (energy_lost(model, step) for step in (0.002, 0.001))
    assert math.log2(coarse / fine) == pytest.approx(1, abs=0.2)
