"""The demo: a crane on its ship at sea, driven in the browser or by a recorded joystick."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from seacrane import design, documents, ocean, plant
from seacrane.control import HOIST, axis_names
from seacrane.cosim import Execution, FmuSlave, GaussSeidel, RealTime, System
from seacrane.errors import ParameterError, Problem
from seacrane.units import UNITS, Length, Mass, Time, deg
from seacrane.vessel import Fixed, Harmonic

from .energy import EnergyMeter
from .sticks import Sticks, played

FACTORY = "seacrane.operation.demo:Demo"
"""Where another process finds the simulation of the demo."""

SHIP = {"length": 90.0, "beam": 20.0, "draught": 6.5, "depth": 9.5}
"""A synthetic offshore supply vessel [m]; it has no model beside it."""

HEADING = 2.5
"""Where the waves go in the ship's frame [rad]: they come from 37 degrees off the starboard bow."""

LOAD_SIZE = (4.0, 3.0, 2.0)
"""Length, width and height of a load of 40 t that is drawn [m]; a lighter one is smaller in all directions."""

TICK = 0.02
"""How often a recorded joystick is read [s]."""


@dataclass(frozen=True)
class Settings:
    """What the demo shows. hs [m] and tp [s] of the sea; step: macro step [s]. Load [kg] and posture [rad or m] are as
    `plant.Start.usual` has them unless given."""

    crane: str = "offshore-100t"
    load: Mass | None = None
    sea: str = "swell"
    hs: Length = 2.0
    tp: Time = 9.0
    step: Time = 0.002
    posture: Mapping[str, float] | None = None

    def __post_init__(self) -> None:
        bounds = {
            "load": (100.0, 200e3, "kg"),
            "hs": (0.0, 10.0, "m"),
            "tp": (4.0, 25.0, "s"),
            "step": (1e-4, 0.02, "s"),
        }
        problems = [
            Problem(name, f"{value:g} {unit} is out of range", None, f"{low:g} to {high:g} {unit}")
            for name, (low, high, unit) in bounds.items()
            if (value := getattr(self, name)) is not None and not low <= value <= high
        ]
        if self.sea not in SEAS:
            problems.append(Problem("sea", "is not a sea of the demo", self.sea, ", ".join(SEAS)))
        if problems:
            raise ParameterError(problems)


SEAS = ("swell", "jonswap", "calm")


def _sea(s: Settings) -> tuple[ocean.WaveList, Fixed | Harmonic]:
    """The waves that are drawn and the motion of the ship, which is prescribed and follows a regular wave.

    In an irregular sea that is the regular wave of equal energy, H = Hs / sqrt(2), at the peak period.
    """
    if s.sea == "calm" or s.hs == 0:
        nothing = np.empty(0)
        return ocean.WaveList(nothing, nothing, nothing, nothing, nothing, "calm water"), Fixed()
    height = s.hs if s.sea == "swell" else s.hs / math.sqrt(2)
    size = {k: SHIP[k] for k in ("length", "beam", "draught")}
    ship = Harmonic.following(height, s.tp, HEADING, **size)
    if s.sea == "swell":
        return ocean.regular(height, s.tp, HEADING), ship
    return ocean.Jonswap(hs=s.hs, tp=s.tp, direction=HEADING, seed=7).waves(), ship


class Demo:
    """The demo as a simulation for the server: an execution, what it is, and how it is driven."""

    def __init__(self, **settings: Any) -> None:
        self.settings = Settings(**settings)
        self.crane = design.load(self.settings.crane)
        self.waves, ship = _sea(self.settings)
        plant.check(self.crane)
        self.start = plant.Start.usual(self.crane, self.settings.posture, self.settings.load)
        self.axes = (*axis_names(self.crane), HOIST)
        self.system: System = plant.build(self.crane, vessel=ship, start=self.start)
        self.execution = Execution(self.system, GaussSeidel(step=self.settings.step))

    def command(self, axes: Mapping[str, float], deadman: bool) -> None:
        """Put the sticks where `axes` says, each in [-1, 1]."""
        for name in self.axes:
            self.execution.set(f"joystick.axis.{name}", axes.get(name, 0.0))
        self.execution.set("joystick.deadman", 1.0 if deadman else 0.0)

    def describe(self) -> dict[str, Any]:
        """Everything a page needs to draw the crane, the ship and the sea, and to name the signals."""
        waves = self.waves
        return {
            "crane": json.loads(design.to_json(self.crane)),
            "load": {
                "mass": self.start.load,
                "size": [size * min(1.0, self.start.load / 40e3) ** (1 / 3) for size in LOAD_SIZE],
            },
            "ship": {**SHIP, "pedestal": list(self.crane.pedestal)},
            "sea": {
                "about": waves.about,
                "waves": [
                    [float(v) for v in row]
                    for row in zip(waves.omega, waves.k, waves.direction, waves.amplitude, waves.phase, strict=True)
                ],
            },
            "slaves": [{"name": n, "about": s.about} for n, s in self.system.slaves.items()],
            "variables": [
                {
                    "name": name,
                    "unit": v.unit,
                    "shown": v.display_unit,
                    "factor": UNITS[v.unit].factor / UNITS[v.display_unit].factor,
                    "about": v.about,
                }
                for name, v in self.execution.variables.items()
                if self.system.causality(name) != "parameter"
            ],
            "axes": list(self.axes),
        }


# ---------------------------------------------------------------- headless
def run_headless(
    settings: Settings, seconds: float, *, realtime: bool = False, csv: Path | None = None
) -> dict[str, Any]:
    """Drive the shipped recording `manoeuvre` for `seconds` of simulated time and report on it.

    As fast as it goes, or paced to the clock. `csv` records all outputs every 20 ms.
    """
    if not (math.isfinite(seconds) and seconds > 0):
        raise ParameterError.at("seconds", "must be a time above zero [s]", value=seconds)
    sticks = Sticks.shipped("manoeuvre")
    demo = Demo(**asdict(settings))
    run = demo.execution
    with run:
        if csv is not None:
            run.record_csv(csv, every=TICK)
        run.start()
        meter = EnergyMeter(demo.system, run)
        pacing = RealTime(run) if realtime else None
        begun = time.perf_counter()
        for tick in range(math.ceil(seconds / TICK - 1e-9)):
            recorded, deadman = sticks.at(tick * TICK)
            demo.command({axis: recorded[column] for axis, column in played(demo.axes).items()}, deadman)
            until = min((tick + 1) * TICK, seconds)
            (pacing or run).advance(until)
        wall = time.perf_counter() - begun
        report = _report(demo, run, meter, wall)
        if pacing is not None:
            pace = pacing.pace
            report |= {"overruns": pace.overruns, "late_ms_p99": pace.lateness_p99 * 1e3, "lost_s": pace.lost_s}
            report["rtf"] = pace.real_time_factor
    return report


def _report(demo: Demo, run: Execution, meter: EnergyMeter, wall: float) -> dict[str, Any]:
    account = meter.read()
    kinds = {joint.name: joint.kind for joint in demo.crane.joints}
    positions = dict(zip(kinds, run.values([f"crane.{name}" for name in kinds]).tolist(), strict=True))
    pressures = {}
    for drive in demo.system.slaves:
        if f"{drive}.cylinder.pressure_a" in run.variables:
            a, b = run.values([f"{drive}.cylinder.pressure_a", f"{drive}.cylinder.pressure_b"]) / 1e5
            pressures[drive.replace("drive", "cylinder")] = {"piston": float(a), "rod": float(b)}
    return {
        "simulated_s": run.time,
        "wall_s": wall,
        "rtf": wall / run.time,
        "macro_step_s": run.macro_step,
        "slaves": list(demo.system.slaves),
        "fmus": [s.path.name for s in demo.system.slaves.values() if isinstance(s, FmuSlave)],
        "energy_balance_error": account.error,
        "energy_moved_J": account.moved,
        "peak_power_residual_W": max(bond.peak_residual for bond in run.bonds.values()),
        "bonds": {name: asdict(bond) for name, bond in run.bonds.items()},
        "joint_angles_deg": {n: v / deg for n, v in positions.items() if kinds[n] == "revolute"},
        "joint_slides_m": {n: v for n, v in positions.items() if kinds[n] == "prismatic"},
        "cylinder_pressures_bar": pressures,
    }


def summary(report: Mapping[str, Any]) -> str:
    """The report in a few lines."""
    joints = [f"{name} {value:.1f} deg" for name, value in report["joint_angles_deg"].items()]
    joints += [f"{name} {value:.2f} m" for name, value in report["joint_slides_m"].items()]
    pressures = ", ".join(
        f"{name} {p['piston']:.0f}/{p['rod']:.0f} bar" for name, p in report["cylinder_pressures_bar"].items()
    )
    lines = [
        f"{report['simulated_s']:.1f} s simulated in {report['wall_s']:.2f} s, real-time factor {report['rtf']:.3f}"
        f" at a macro step of {report['macro_step_s'] * 1e3:g} ms",
        f"energy balance closes within {report['energy_balance_error']:.2%} of {report['energy_moved_J'] / 1e6:.2f} MJ"
        f" moved; largest power residual at a bond {report['peak_power_residual_W'] / 1e3:.1f} kW",
        f"joints: {', '.join(joints)}",
        f"cylinders (piston/rod): {pressures}",
    ]
    if "overruns" in report:
        lines.append(
            f"paced to the clock: {report['overruns']} overruns, 99 % of steps within {report['late_ms_p99']:.2f} ms"
        )
    return "\n".join(lines)


def write_report(report: Mapping[str, Any], path: Path) -> None:
    """Write the report as JSON, whole or not at all."""
    documents.write(json.dumps(report, indent=2) + "\n", path)
