"""Figures 4.13 to 4.15 of the dissertation: a recorded joystick drives the spool of a main boom cylinder.

    python examples/dissertation/manual_manipulation.py --out figures

The hydraulic drive is an FMU, the load is a rigid body beside it; the two meet at the rod by a power bond. As in print,
"reference" is the motion that the FMU believes and "actual" that of the body. What must be seen: the piston's speed
follows the sign of the stick; the piston stops at its bumpers, 1.4 m of stroke and about 0.01 m of deflection, while
the stick is still positive; there the pressure on the piston side rises to the supply and that on the rod side falls to
the tank.

The dissertation prints no sizes but the stroke and the bumpers: bore, rod, supply, valve and load are those of
`Drive`, and the joystick is a random one of the same length, recorded in joystick.csv.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seacrane import cosim, fmi
from seacrane.library import hydraulics as hyd
from seacrane.library import mechanics as mech
from seacrane.model import Diagram
from seacrane.results import Recording
from seacrane.units import GRAVITY, bar, l, l_min, mm

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Drive:
    """The drive of Table 4.4 and of these figures."""

    bore: float = 280 * mm
    rod: float = 200 * mm
    stroke: float = 1.4
    bumper: float = 10 * mm
    supply: float = 210 * bar
    load: float = 20e3
    start: float = 0.7

    @property
    def piston_area(self) -> float:
        return math.pi / 4 * self.bore**2

    @property
    def weight(self) -> float:
        return self.load * GRAVITY

    @property
    def bumper_stiffness(self) -> float:
        """Such that the full push of the supply, less the load, goes `bumper` into it."""
        return (self.supply * self.piston_area - self.weight) / self.bumper


def hydraulics(d: Drive) -> Diagram:
    """Pump, 4/3 valve, lines and extended cylinder: spool and rod motion in, rod force out."""
    drive = Diagram("boom_drive", bulk_modulus=1.0e9)
    pump = drive.add("pump", hyd.ConstantPressurePump(pressure=d.supply))
    tank = drive.add("tank", hyd.Tank())
    valve = drive.add(
        "valve", hyd.DirectionalValve43(level="dynamic", flow=400 * l_min, at=35 * bar, natural_frequency=60.0)
    )
    cylinder = drive.add(
        "cylinder",
        hyd.DoubleActingCylinder(
            level="extended",
            bore=d.bore,
            rod=d.rod,
            stroke=d.stroke,
            extension=d.start,
            pressure_a=d.weight / d.piston_area,
            viscous_friction=6e4,
            coulomb_friction=3e3,
            stop_stiffness=d.bumper_stiffness,
            stop_damping=1e6,
        ),
    )
    body = drive.add("body", mech.MotionInput(position=d.start, correction=20.0))
    drive.connect(pump.p, valve.p)
    drive.connect(tank.p, valve.t)
    for side, port, start in (("a", valve.a, d.weight / d.piston_area), ("b", valve.b, 0.0)):
        line = drive.add(f"line_{side}", hyd.ControlVolume(volume=1 * l, pressure=start))
        drive.connect(port, line.a, cylinder.a if side == "a" else cylinder.b)
    drive.connect(cylinder.rod, body.flange)
    drive.expose(spool=valve.x, velocity=body.v, position=body.x, force=body.F)
    return drive


def load(d: Drive) -> Diagram:
    """The mass on the rod, with gravity against extension."""
    diagram = Diagram("load")
    mass = diagram.add("mass", mech.Mass(mass=d.load, gravity=GRAVITY))
    rod = diagram.add("rod", mech.ForceInput(position=d.start))
    diagram.connect(mass.flange, rod.flange)
    diagram.expose(force=rod.F, velocity=rod.v, position=rod.x)
    return diagram


def simulate(stick: Recording, until: float, step: float = 0.001, d: Drive | None = None) -> Recording:
    """The co-simulation over `until` [s], recorded every 10 ms under the names of the figures."""
    d = d or Drive()
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "boom_drive.fmu"
        fmi.export(hydraulics(d), file)
        system = cosim.System("manual manipulation")
        system.add("drive", cosim.FmuSlave(file))
        system.add("load", cosim.ModelSlave(load(d)))
        system.bond("rod", effort=("drive.force", "load.force"), flow=("load.velocity", "drive.velocity"))
        system.connect("load.position", "drive.position")
        with cosim.Execution(system, cosim.GaussSeidel(step=step)) as run:
            names = {
                "gain": "drive.spool",
                "reference speed": "drive.body.flange.v",
                "actual speed": "load.velocity",
                "reference displacement": "drive.cylinder.extension",
                "actual displacement": "load.position",
                "piston-side pressure": "drive.cylinder.pressure_a",
                "rod-side pressure": "drive.cylinder.pressure_b",
            }
            recorder = run.record(list(names.values()), every=0.01)
            run.start()
            for k in range(round(until / 0.01)):
                run.set("drive.spool", float(np.interp(run.time, stick.time, stick["gain"])))
                run.advance(0.01 * (k + 1))
            run.flush()
            recording = recorder.recording()
    return Recording(recording.time, {name: recording.signal(source) for name, source in names.items()})


FIGURES = {
    "figure_4_13": ("gain",),
    "figure_4_14": ("reference speed", "actual speed", "reference displacement", "actual displacement"),
    "figure_4_15": ("piston-side pressure", "rod-side pressure"),
}


def stops(recording: Recording, d: Drive) -> list[tuple[float, float]]:
    """Spans of time [s] in which the piston sits in its upper bumper while the stick still asks for more."""
    held = (recording["actual displacement"] > d.stroke) & (recording["gain"] > 0.05)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], held, [False]])))
    return [(float(recording.time[a]), float(recording.time[b - 1])) for a, b in edges.reshape(-1, 2)]


def main(arguments: list[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument(
        "--out", type=Path, default=Path("figures"), help="folder for the figures (SVG) and the data (CSV)"
    )
    parser.add_argument("--until", type=float, default=40.0, help="simulated time [s]")
    parser.add_argument("--stick", type=Path, default=HERE / "joystick.csv", help="recorded joystick (CSV)")
    options = parser.parse_args(arguments)
    d = Drive()
    recording = simulate(Recording.read_csv(options.stick), options.until, d=d)
    options.out.mkdir(parents=True, exist_ok=True)
    recording.to_csv(options.out / "manual_manipulation.csv")
    for name, signals in FIGURES.items():
        recording.plot(*signals, title=f"Figure {name[-4:].replace('_', '.')}").savefig(options.out / f"{name}.svg")
    print(f"{options.out}: {', '.join(FIGURES)} (SVG), manual_manipulation.csv")
    print(f"largest displacement {recording['actual displacement'].max():.4f} m of {d.stroke:g} m + {d.bumper:g} m")
    for begin, end in stops(recording, d):
        inside = recording.between(begin, end)
        a, b = (inside[name][-1] / bar for name in ("piston-side pressure", "rod-side pressure"))
        print(f"in the bumper from {begin:.1f} to {end:.1f} s: piston side {a:.0f} bar, rod side {b:.1f} bar")


if __name__ == "__main__":
    main()
