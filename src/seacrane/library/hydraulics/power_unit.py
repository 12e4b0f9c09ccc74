"""A hydraulic power unit, put together of components."""

from __future__ import annotations

from math import pi

from seacrane.errors import ParameterError
from seacrane.library.mechanics import ElectricMotor
from seacrane.model import Diagram
from seacrane.units import Displacement, Frequency, Inertia, Power, Pressure, Ratio, Volume, bar, l

from .pumps import ShaftPump
from .sources import Tank
from .valves import CheckValve, ReliefValve
from .volumes import ControlVolume

BREAKDOWN = 2.5
"""Breakdown torque over rated torque of an induction motor: 2 to 3 in data sheets, at least 1.6 by IEC 60034-1."""

EFFICIENCY = 0.9
"""Share of the motor's rated power that the pump's power limit leaves as hydraulic power."""


def power_unit(
    name: str = "power_unit",
    *,
    displacement: Displacement,
    pressure: Pressure,
    power: Power,
    inertia: Inertia,
    mains: Frequency = 60.0,
    pole_pairs: Ratio = 2,
    manifold: Volume = 1 * l,
    running: bool = True,
) -> Diagram:
    """Electric motor, pressure-controlled pump with power limit, relief and check valve, as a diagram.

        mains ─►(M~)══( ▲ )──┬──┤>├──► p         exposes: p, the outlet
                        │    ├─[relief]─ tank
                       tank  ( manifold )

    The pump strokes back at `pressure` [Pa], and where its flow at this pressure would take more than 90 % of the
    motor's rated `power` [W]; the relief valve opens from 1.1 to 1.2 times the pressure. The motor's breakdown torque
    is 2.5 times the rated one. `inertia` [kg.m2] is that of motor, coupling and pump. It starts at synchronous speed
    without pressure or, unless it is `running`, from standstill: start it unloaded, as a real one, or it stalls.
    Returning oil goes to any `Tank`: all are at gauge
    pressure zero.
    """
    if not power > 0 or not mains > 0 or not pole_pairs >= 1:
        raise ParameterError.at(name, "needs power and mains above 0 and at least one pair of poles")
    synchronous = 2 * pi * mains / pole_pairs
    flow = displacement * synchronous
    unit = Diagram(name)
    motor = unit.add(
        "motor",
        ElectricMotor(
            breakdown_torque=BREAKDOWN * power / synchronous,
            mains=mains,
            pole_pairs=pole_pairs,
            inertia=inertia,
            speed=synchronous if running else 0.0,
        ),
    )
    pump = unit.add(
        "pump",
        ShaftPump(
            displacement=displacement,
            pressure=pressure,
            power_limit=EFFICIENCY * power,
            leakage=0.03 * flow / pressure,
            coulomb_friction=0.03 * displacement * pressure,
        ),
    )
    relief = unit.add("relief", ReliefValve(crack=1.1 * pressure, full=1.2 * pressure, flow=flow))
    check = unit.add("check", CheckValve(flow=flow, at=3 * bar))
    room = unit.add("manifold", ControlVolume(volume=manifold))
    tank = unit.add("tank", Tank())
    unit.connect(motor.shaft, pump.shaft)
    unit.connect(tank.p, pump.s, relief.b)
    unit.connect(pump.p, relief.a, check.a, room.a)
    unit.expose(p=check.b)
    return unit
