"""Figures 4.13 to 4.15 of the dissertation: a recorded joystick drives the spool of a main boom cylinder.

    python examples/dissertation/manual_manipulation.py --out figures

The hydraulic drive is an FMU, the load is a rigid body beside it; the two meet at the rod by a power bond. As in print,
"reference" is the motion that the FMU believes and "actual" that of the body. What must be seen: the piston's speed
follows the sign of the stick; the piston stops at its bumpers, 1.4 m of stroke and about 0.01 m of deflection, while
the stick is still positive; there the pressure on the piston side rises to the supply and that on the rod side falls to
the tank.

The drive is that of cylinder.py; the joystick is a random one of the printed length, recorded in joystick.csv.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path

import numpy as np
from cylinder import Drive, add_circuit

from seacrane import cosim, fmi
from seacrane.library import mechanics as mech
from seacrane.model import Diagram
from seacrane.results import Recording
from seacrane.units import GRAVITY, bar

HERE = Path(__file__).parent


def hydraulics(d: Drive) -> Diagram:
    """Pump, 4/3 valve, lines and extended cylinder: spool and rod motion in, rod force out."""
    drive = Diagram("boom_drive", bulk_modulus=1.0e9)
    valve, cylinder = add_circuit(drive, d)
    body = drive.add("body", mech.MotionInput(position=d.start, correction=20.0))
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
