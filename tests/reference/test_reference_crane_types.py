"""Cranes of other types than the knuckle boom run as plants: they stand as they start, move as told, and keep the
energy account."""

from __future__ import annotations

import pytest

from seacrane import cosim, design, plant
from seacrane.cosim import GaussSeidel
from seacrane.design import Crane
from seacrane.multibody import static_equilibrium
from seacrane.operation import EnergyMeter


def held(run: cosim.Execution, drive: str, bore: float, rod: float, count: int) -> float:
    """What the cylinders of a drive push with, from their pressures [N]."""
    a, b = run.values([f"{drive}.cylinder.pressure_a", f"{drive}.cylinder.pressure_b"])
    return float(count * 0.7853981633974483 * (a * bore**2 - b * (bore**2 - rod**2)))


def stands(run: cosim.Execution, crane: Crane, start: plant.Start) -> None:
    """The pressures are in balance with the statics of the posture at hand, within the friction of the seals."""
    posture = run.values([f"crane.{joint.name}" for joint in crane.joints])
    hanging = float(run.values(["crane.rope.hanging"])[0])
    rest = static_equilibrium(crane, posture, start.load + crane.hoist.hook_mass, hanging)
    for c in crane.cylinders:
        force = held(run, f"{c.name.removesuffix('_cylinder')}_drive", c.bore, c.rod, c.count)
        seals = 0.01 * c.count * 0.7853981633974483 * c.bore**2 * c.pressure
        assert force == pytest.approx(rest.cylinder_forces[c.name], abs=seals + 0.01 * abs(force))


@pytest.mark.parametrize("name", ["gunnerus-pk65", "a-frame-30t"])
def test_a_crane_stands_moves_each_joint_by_its_stick_and_accounts_for_its_energy(name: str) -> None:
    crane = design.load(name)
    start = plant.Start.usual(crane)
    system = plant.build(crane, start=start)
    joints = [f"crane.{joint.name}" for joint in crane.joints]
    axes = [v.name for v in system.slaves["joystick"].inputs if v.name.startswith("axis.")]
    with cosim.Execution(system, GaussSeidel(step=0.002)) as run:
        run.start()
        meter = EnergyMeter(system, run)
        first = run.values(joints)
        run.advance(5.0)
        assert run.values(joints) == pytest.approx(first, abs=2e-3)
        stands(run, crane, start)
        run.set("joystick.deadman", 1.0)
        now = 5.0
        for axis, joint in zip(axes, joints, strict=False):
            for stick in (0.6, -0.6):
                before = float(run.values([joint])[0])
                run.set(f"joystick.{axis}", stick)
                run.advance(now := now + 1.5)
                run.set(f"joystick.{axis}", 0.0)
                run.advance(now := now + 1.5)
                moved = float(run.values([joint])[0]) - before
                assert moved * stick > 1e-3, (axis, stick, moved)
        run.set("joystick.axis.hoist", 0.6)
        before = float(run.values(["crane.rope.unstretched_length"])[0])
        run.advance(now + 2.0)
        assert float(run.values(["crane.rope.unstretched_length"])[0]) < before - 0.1
        account = meter.read()
        assert account.moved > 1e4
        assert account.error < 0.01
