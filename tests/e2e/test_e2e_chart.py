"""The load chart in a real browser, held against that of the Python package as the rating changes."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from seacrane import design
from seacrane.design import chart, geometry, planar
from seacrane.units import GRAVITY, bar

Browse = Callable[..., Any]

BAND = 0.5
"""Distance of the radii of a curve of the page [m]."""


def test_loads_are_those_of_the_package_in_each_sea_state_with_heel_and_reeving(designer: str, browse: Browse) -> None:
    seen = browse("chart.mjs", designer, "tells_the_load_as_the_rating_changes")
    loads = {}
    for name, told in seen.items():
        crane = design.loads(json.dumps(told["design"]))
        mode = chart.mode(crane, told["mode"])
        limits = chart.each_limit(crane, told["posture"], mode)
        governs = min(limits, key=limits.__getitem__)
        loads[name] = told["load"]
        assert told["load"] == pytest.approx(limits[governs], rel=1e-9), name
        assert f"{governs} governs" in told["says"], name
        same_curve(crane, mode, told["curve"])
    assert loads["harbour"] > loads["hs1.0"] > loads["hs1.5"] > loads["hs2.0"] > loads["hs2.5"] > loads["hs3.0"]
    assert loads["heel"] < loads["harbour"]
    assert loads["hook"] < loads["sheaves"] + 1e-6
    assert seen["heel"]["design"]["rating"]["heel"] == pytest.approx(math.radians(4))
    assert seen["hook"]["design"]["hoist"]["falls"] == 2
    assert seen["hook"]["design"]["hoist"]["sheave_efficiency"] == 0.97
    assert seen["hook"]["design"]["hoist"]["hook_mass"] == 2500
    assert seen["hs3.0"]["design"]["rating"]["wave_heights"] == [1, 1.5, 2, 3]


def same_curve(crane: design.Crane, mode: chart.Mode, curve: list[float | None]) -> None:
    """The best load in each band of radius is that of a fine grid of postures."""
    joints = planar.plane_joints(crane)
    found = chart.capacity(crane, planar.grid(crane, [500] * len(joints)), mode)
    radius, swl = found.radius.ravel(), found.swl.ravel()
    for band in range(20, len(curve) - 1, 8):
        middle = band * BAND
        near = np.abs(radius - middle) < 0.5 * BAND
        best = np.max(swl[near] * np.minimum(1.0, radius[near] / middle))
        assert curve[band] == pytest.approx(best, rel=0.02), (mode.name, middle)


def test_a_cell_of_the_chart_starts_the_simulation_in_its_posture_with_its_load_which_it_holds(
    designer: str, browse: Browse
) -> None:
    seen = browse("chart.mjs", designer, "simulates_from_a_cell_of_the_chart")
    crane = design.load("offshore-100t")
    posture = seen["posture"]
    x, _, z = geometry.tip(crane, posture)
    assert (x, z) == pytest.approx(seen["at"], abs=0.3)
    load = min(chart.each_limit(crane, posture).values())
    assert seen["load"] == pytest.approx(load, rel=1e-9)
    pointed = float(re.match(r"[\d.]+", seen["pointed"]).group())  # type: ignore[union-attr]
    assert pointed == pytest.approx(load / 1e3, abs=0.2)
    # in harbour, on calm water, ten seconds later
    assert seen["hs"] == 0
    held = seen["held"]
    assert held["boom"] == pytest.approx(math.degrees(posture["luff"]), abs=0.2)
    assert held["radius"] == pytest.approx(geometry.radius(crane, posture), abs=0.1)
    for axis, pressure in held["pressures"].items():
        assert pressure == pytest.approx(static_pressure(crane, posture, load, f"{axis}_cylinder"), abs=2.0)


def static_pressure(crane: design.Crane, posture: dict[str, float], load: float, name: str) -> float:
    """On the piston side of a pushing cylinder, the rod side empty, by the statics of the load chart [bar]."""
    plane = planar.Plane(crane, {joint: np.asarray(q) for joint, q in posture.items()})
    cylinder = crane.cylinder(name)
    lifted = plane.by_joint(cylinder.moves, plane.tip())[1] + plane.rope_by_joint(cylinder.moves) / crane.hoist.falls
    borne = plane.own_moment(cylinder.moves, (0.0, 1.0)) + (load + crane.hoist.hook_mass) * lifted
    push = GRAVITY * borne / plane.distance_by_joint(cylinder.moves, cylinder.base, cylinder.eye)
    return float(push / (cylinder.count * math.pi / 4 * cylinder.bore**2) / bar)
