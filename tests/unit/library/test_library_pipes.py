"""Pipes against the textbook: the Moody chart, water hammer, organ-pipe frequencies."""

from math import log10, pi, sqrt

import numpy as np
import pytest

from seacrane.errors import ParameterError
from seacrane.library import hydraulics as hyd
from seacrane.library.hydraulics.pipes import friction_number
from seacrane.model import Diagram, simulate
from seacrane.units import bar, mm

OIL = {"density": 870.0, "viscosity": 46e-6}


def colebrook(reynolds, roughness):
    """The Darcy friction factor of C. F. Colebrook, 1939, by fixed-point iteration on 1/sqrt(f)."""
    root = 8.0
    for _ in range(100):
        root = -2 * log10(roughness / 3.7 + 2.51 * root / reynolds)
    return 1 / root**2


def factor(reynolds, roughness=0.0):
    return float(friction_number(reynolds, roughness)) / reynolds**2


# ---------------------------------------------------------------- friction
@pytest.mark.parametrize("roughness", [0.0, 1e-5, 1e-4, 1e-3, 1e-2, 0.05])
@pytest.mark.parametrize("reynolds", [4e3, 1e4, 1e5, 1e6, 1e8])
def test_turbulent_friction_is_that_of_the_colebrook_chart(reynolds, roughness):
    assert factor(reynolds, roughness) == pytest.approx(colebrook(reynolds, roughness), rel=0.02)


@pytest.mark.parametrize("reynolds", [1e-3, 1.0, 100.0, 2299.0])
def test_laminar_friction_is_64_over_re_and_forgets_the_roughness(reynolds):
    assert factor(reynolds, 0.01) == pytest.approx(64 / reynolds)


@pytest.mark.parametrize("roughness", [0.0, 1e-3, 0.05])
def test_friction_rises_with_the_flow_without_a_jump_from_laminar_to_turbulent(roughness):
    reynolds = np.linspace(2000, 5000, 3001)
    drop = np.array([float(friction_number(re, roughness)) for re in reynolds])
    steps = np.diff(drop)
    assert steps.min() > 0
    assert steps.max() < 0.01 * drop[0]


def test_friction_turns_round_with_the_flow():
    for reynolds in (10.0, 3000.0, 1e5):
        assert float(friction_number(-reynolds, 1e-3)) == -float(friction_number(reynolds, 1e-3))


def test_slow_flow_takes_the_drop_of_hagen_and_poiseuille(law):
    pipe = hyd.Pipe(level="resistance", length=12.0, diameter=20 * mm, **OIL)
    q = 1e-4
    values = law(pipe, {"a.q": q}, through=("a",))
    expected = 128 * 46e-6 * 870 * 12.0 * q / (pi * 0.02**4)
    assert values["a.p"] - values["b.p"] == pytest.approx(expected)
    assert values["lost_power"] == pytest.approx(q * expected)


def test_fast_flow_takes_the_drop_of_darcy_and_weisbach(law):
    pipe = hyd.Pipe(level="resistance", length=12.0, diameter=20 * mm, roughness=0.02 * mm, **OIL)
    q = 5e-3
    speed = q / (pi / 4 * 0.02**2)
    f = colebrook(speed * 0.02 / 46e-6, 1e-3)
    values = law(pipe, {"a.q": q}, through=("a",))
    assert values["a.p"] == pytest.approx(f * 12.0 / 0.02 * 870 / 2 * speed**2, rel=0.02)
    assert values["reynolds"] == pytest.approx(speed * 0.02 / 46e-6)


# ---------------------------------------------------------------- inertia and compressibility
def test_a_column_of_oil_accelerates_by_pressure_over_its_mass(law):
    pipe = hyd.Pipe(level="inertia", length=10.0, diameter=25 * mm, density=870.0)
    area = pi / 4 * 0.025**2
    values = law(pipe, {"a.p": 3 * bar, "b.p": 1 * bar}, {"flow": 1e-3})
    force, mass = 2 * bar * area, 870 * area * 10.0
    assert values["der(flow)"] == pytest.approx(force / mass * area)
    assert values["a.q"] == -values["b.q"] == 1e-3


def test_oil_let_into_a_pipe_raises_its_pressure(law):
    pipe = hyd.Pipe(level="compressibility", length=10.0, diameter=25 * mm, bulk_modulus=1.2e9)
    values = law(pipe, {"a.q": 2e-4, "b.q": -5e-5}, through=("a", "b"))
    assert values["der(pressure)"] == pytest.approx(1.2e9 * 1.5e-4 / (pi / 4 * 0.025**2 * 10.0))


# ---------------------------------------------------------------- line
def ring_down(segments, until=0.3):
    """The pressure at one end of a line, shut at both, after half of it was set under pressure."""
    diagram = Diagram("ringing", viscosity=1e-9, density=870.0, bulk_modulus=1.2e9)
    line = diagram.add("line", hyd.Pipe(level="line", length=20.0, diameter=50 * mm, segments=segments))
    for end in "ab":
        plug = diagram.add(f"plug_{end}", hyd.Plug())
        diagram.connect(getattr(line, end), plug.a)
    wave = {f"line.pressure_{i}": 50 * bar + 1 * bar * np.cos(pi * i / segments) for i in range(segments + 1)}
    return simulate(diagram, until, every=1e-4, parameters=wave, tolerance=1e-8)


@pytest.mark.parametrize("segments", [1, 3, 10])
def test_a_shut_line_rings_at_the_closed_form_frequency_of_its_chain(segments):
    """n segments: w = 2 n (c/L) sin(pi / 2n), which tends to the pi c / L of a continuous pipe."""
    run = ring_down(segments)
    swing = run["line.pressure_0"] - 50 * bar
    falling = np.flatnonzero((swing[:-1] > 0) & (swing[1:] <= 0))
    crossing = run.time[falling] + 1e-4 * swing[falling] / (swing[falling] - swing[falling + 1])
    measured = 2 * pi / np.diff(crossing).mean()
    wave_speed = sqrt(1.2e9 / 870)
    assert measured == pytest.approx(2 * segments * wave_speed / 20.0 * np.sin(pi / (2 * segments)), rel=1e-3)
    if segments == 10:
        assert measured == pytest.approx(pi * wave_speed / 20.0, rel=5e-3)


def test_a_line_in_steady_flow_has_the_drop_of_its_resistance(law):
    shape = {"length": 12.0, "diameter": 20 * mm, **OIL}
    q = 3e-3
    drop = law(hyd.Pipe(level="resistance", **shape), {"a.q": q}, through=("a",))["a.p"]
    n = 4
    along = {f"pressure_{i}": 100 * bar - drop * i / n for i in range(n + 1)} | {f"flow_{i + 1}": q for i in range(n)}
    line = hyd.Pipe(level="line", segments=n, **shape)
    values = law(line, {"a.q": q, "b.q": -q}, along, through=("a", "b"))
    for i in range(1, n + 1):
        assert values[f"der(flow_{i})"] == pytest.approx(0.0, abs=1e-6)
        assert values[f"der(pressure_{i})"] == pytest.approx(0.0, abs=1e-3)
    assert values["lost_power"] == pytest.approx(drop * q)


def test_a_line_yields_as_a_whole_like_a_compressible_pipe(law):
    shape = {"length": 12.0, "diameter": 20 * mm, "bulk_modulus": 1.2e9}
    line = law(hyd.Pipe(level="line", segments=3, **shape), {"a.q": 1e-3}, through=("a", "b"))
    mean = sum(line[f"der(pressure_{i})"] * (0.5 if i in (0, 3) else 1.0) for i in range(4)) / 3
    whole = law(hyd.Pipe(level="compressibility", **shape), {"a.q": 1e-3}, through=("a", "b"))
    assert mean == pytest.approx(whole["der(pressure)"])


def test_a_hose_yields_by_its_oil_and_by_its_wall(law):
    hose = hyd.Hose(length=2.0, diameter=25 * mm, wall_modulus=4e8, bulk_modulus=1.2e9)
    values = law(hose, {"a.q": 1e-4, "b.q": 1e-4}, through=("a", "b"))
    room = pi / 4 * 0.025**2 * 2.0
    assert values["der(pressure_0)"] == pytest.approx(2e-4 / room / (1 / 1.2e9 + 1 / 4e8))


def test_a_hose_with_a_rigid_wall_is_a_line_of_one_segment(law):
    shape = {"length": 2.0, "diameter": 25 * mm, "roughness": 0.0}
    given, states = {"a.q": 1e-4}, {"pressure_0": 2e5, "pressure_1": 1e5, "flow_1": 2e-4}
    hose = law(hyd.Hose(wall_modulus=1e12, **shape), given, states, through=("a", "b"))
    line = law(hyd.Pipe(level="line", segments=1, **shape), given, states, through=("a", "b"))
    for rate in ("der(pressure_0)", "der(pressure_1)", "der(flow_1)"):
        assert hose[rate] == pytest.approx(line[rate], rel=2e-3)


def test_a_rough_wall_beyond_the_law_and_a_line_without_segments_are_refused():
    with pytest.raises(ParameterError) as caught:
        hyd.Pipe(level="line", length=1.0, diameter=20 * mm, roughness=2 * mm, segments=0)
    assert str(caught.value) == (
        "Pipe(level='line').roughness: 2 mm leaves the range of the law; allowed: at most 1 mm, 5 % of the diameter\n"
        "Pipe(level='line').segments: is no number of segments (got 0); allowed: a whole number from 1 to 50"
    )


@pytest.mark.parametrize("diameter", [5 * mm, 20 * mm])
def test_two_volumes_even_out_through_the_resistance_of_a_pipe(diameter):
    """Laminar (5 mm) with the time constant of a resistance and two stores; turbulent (20 mm) at the start."""
    diagram = Diagram("evening", **OIL)
    pipe = diagram.add("pipe", hyd.Pipe(level="resistance", length=10.0, diameter=diameter))
    for end, pressure in (("a", 60 * bar), ("b", 40 * bar)):
        room = diagram.add(f"room_{end}", hyd.ControlVolume(volume=5e-2, pressure=pressure))
        diagram.connect(room.a, getattr(pipe, end))
    resistance = 128 * 46e-6 * 870 * 10.0 / (pi * diameter**4)
    time = resistance * 5e-2 / 1.2e9 / 2
    run = simulate(diagram, max(5 * time, 0.5), every=max(time / 50, 1e-3))
    drop = run["room_a.pressure"] - run["room_b.pressure"]
    assert run["room_a.pressure"] + run["room_b.pressure"] == pytest.approx(100 * bar, rel=1e-6)
    if diameter == 5 * mm:
        assert abs(run["pipe.reynolds"]).max() < 2300
        assert drop == pytest.approx(20 * bar * np.exp(-run.time / time), abs=0.01 * bar)
    else:
        assert run["pipe.reynolds"].max() > 4000
        assert (np.diff(drop) < 0)[drop[1:] > 0.1 * bar].all()
        assert drop[-1] < 0.2 * bar
