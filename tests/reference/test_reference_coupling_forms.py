"""A cylinder drive meets its load in two ways: force out, motion in, or motion out, force in.

In the one, the partner holds the piston's mass and the drive its oil; in the other the drive holds both, and the
partner is moved. Both must come to the solution of the whole model as the macro step shrinks.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import numpy as np
import pytest

from seacrane import cosim
from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mech
from seacrane.model import Diagram, Part, simulate
from seacrane.model.dae import Variable
from seacrane.model.diagram import PortHandle
from seacrane.results import Recording
from seacrane.units import GRAVITY, bar, l_min, mm

PISTON, LOAD = 5e3, 20e3
START = 0.5
UNTIL = 2.0
OPENING = ([0.0, 0.2, 0.4, UNTIL], [0.0, 0.0, 0.5, 0.5])


def oil(diagram: Diagram) -> Part:
    """Pump, valve and cylinder, with the rod left open; the chambers hold piston and load from the start."""
    area_a, area_b = np.pi / 4 * 0.2**2, np.pi / 4 * (0.2**2 - 0.14**2)
    held = 20 * bar
    cylinder = diagram.add(
        "cylinder",
        hyd.DoubleActingCylinder(
            level="extended",
            bore=200 * mm,
            rod=140 * mm,
            stroke=1.2,
            extension=START,
            pressure_a=((PISTON + LOAD) * GRAVITY + held * area_b) / area_a,
            pressure_b=held,
            viscous_friction=2e4,
        ),
    )
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=210 * bar))
    valve = diagram.add("valve", hyd.DirectionalValve43(flow=200 * l_min, at=35 * bar, leakage=1e-6))
    tank = diagram.add("tank", hyd.Tank())
    diagram.connect(pump.p, valve.p)
    diagram.connect(valve.t, tank.p)
    diagram.connect(valve.a, cylinder.a)
    diagram.connect(valve.b, cylinder.b)
    diagram.expose(spool=valve.x)
    return cylinder


def piston(diagram: Diagram) -> PortHandle:
    return diagram.add("piston", mech.Mass(mass=PISTON, gravity=GRAVITY)).flange


def hanging(diagram: Diagram, rod: PortHandle) -> None:
    """The load on a rope that is stretched by its weight."""
    rope = diagram.add("rope", mech.SpringDamper(stiffness=4e6, damping=4e4, compression=LOAD * GRAVITY / 4e6))
    load = diagram.add("load", mech.Mass(mass=LOAD, gravity=GRAVITY))
    diagram.connect(rod, rope.a)
    diagram.connect(rope.b, load.flange)


@functools.cache
def whole() -> Recording:
    diagram = Diagram("whole")
    cylinder = oil(diagram)
    mass = piston(diagram)
    diagram.connect(cylinder.rod, mass)
    hanging(diagram, mass)
    return simulate(diagram, UNTIL, inputs={"spool": OPENING}, linear=True, tolerance=1e-9)


def force_out() -> tuple[Diagram, Diagram]:
    """The drive is given the motion of the piston, which the partner holds."""
    drive, partner = Diagram("drive"), Diagram("partner")
    cylinder = oil(drive)
    moved = drive.add("moved", mech.MotionInput(position=START))
    drive.connect(cylinder.rod, moved.flange)
    drive.expose(v=moved.v, x=moved.x, F=moved.F)
    mass = piston(partner)
    pushed = partner.add("pushed", mech.ForceInput(position=START))
    partner.connect(mass, pushed.flange)
    hanging(partner, mass)
    partner.expose(F=pushed.F, v=pushed.v, x=pushed.x)
    return drive, partner


def motion_out() -> tuple[Diagram, Diagram]:
    """The drive holds the piston, and is given the force of the load that hangs on it."""
    drive, partner = Diagram("drive"), Diagram("partner")
    cylinder = oil(drive)
    mass = piston(drive)
    pushed = drive.add("pushed", mech.ForceInput(position=START))
    drive.connect(cylinder.rod, mass, pushed.flange)
    drive.expose(F=pushed.F, v=pushed.v, x=pushed.x)
    moved = partner.add("moved", mech.MotionInput(position=START))
    hanging(partner, moved.flange)
    partner.expose(v=moved.v, x=moved.x, F=moved.F)
    return drive, partner


def coupled(drive: Diagram, partner: Diagram, step: float) -> Recording:
    """Both as slaves, drive first, exchanging what they have at macro steps."""
    system = cosim.System("coupled")
    system.add("stick", cosim.FunctionSlave(lambda t, h, u: [np.interp(t + h, *OPENING)], outputs=[Variable("spool")]))
    system.add("drive", cosim.ModelSlave(drive.compile()))
    system.add("partner", cosim.ModelSlave(partner.compile()))
    system.connect("stick.spool", "drive.spool")
    effort, flow = ("drive", "partner") if "v" in inputs(drive) else ("partner", "drive")
    system.bond("rod", effort=(f"{effort}.F", f"{flow}.F"), flow=(f"{flow}.v", f"{effort}.v"))
    system.connect(f"{flow}.x", f"{effort}.x")
    with cosim.Execution(system, cosim.GaussSeidel(step=step)) as run:
        return run.run(until=UNTIL)


def inputs(diagram: Diagram) -> set[str]:
    return {v.name for v in diagram.compile().inputs}


@functools.cache
def error(form: Callable[[], tuple[Diagram, Diagram]], step: float) -> float:
    """RMSE [m] of the piston's position against the whole model."""
    reference = whole()
    run = coupled(*form(), step)
    there = np.interp(run.time, reference.time, reference["cylinder.extension"])
    return float(np.sqrt(np.mean((run["partner.x" if form is force_out else "drive.x"] - there) ** 2)))


@pytest.mark.parametrize("form", [force_out, motion_out])
def test_both_forms_of_a_drive_come_to_the_whole_model_as_the_macro_step_shrinks(form) -> None:
    assert np.ptp(whole()["cylinder.extension"]) > 0.05
    assert error(form, 1e-3) < 0.6 * error(form, 2e-3)
    assert error(form, 1e-3) < 3e-4


def test_the_form_that_is_cut_at_the_softer_spring_is_the_more_accurate() -> None:
    """The rope is softer than the oil, and what crosses the cut changes more slowly."""
    assert error(motion_out, 1e-3) < error(force_out, 1e-3)
