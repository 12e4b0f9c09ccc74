"""A sea has the height, the peak and the energy per frequency that were asked for, and repeats exactly."""

import math

import numpy as np
import pytest

from seacrane import ocean
from seacrane.errors import ParameterError
from seacrane.units import GRAVITY, deg


@pytest.fixture(scope="module")
def sea():
    return ocean.Jonswap(hs=3.0, tp=9.0, direction=30 * deg, seed=7)


def test_a_regular_wave_is_a_travelling_cosine():
    wave = ocean.regular(height=2.0, period=8.0, direction=90 * deg)
    length = GRAVITY * 8.0**2 / (2 * math.pi)
    assert wave.elevation(0, 0, 0) == pytest.approx(1.0)
    assert wave.elevation(0, 0, 4.0) == pytest.approx(-1.0)
    assert wave.elevation(0, length / 2, 0) == pytest.approx(-1.0)
    assert wave.elevation(1000.0, 0, 0) == pytest.approx(1.0)
    # going to +y: the crest is there later, at the phase speed g T / 2 pi
    t = 1.7
    assert wave.elevation(0, length / 8.0 * t, t) == pytest.approx(1.0)


def test_a_regular_wave_has_the_significant_height_of_its_energy():
    assert ocean.regular(2.0, 8.0).significant_height == pytest.approx(4 * math.sqrt(0.5))


def test_every_component_obeys_deep_water_dispersion(sea):
    waves = sea.waves()
    np.testing.assert_allclose(waves.omega**2, GRAVITY * waves.k, rtol=1e-14)


@pytest.mark.parametrize("components", [1, 20, 200, 500])
@pytest.mark.parametrize(("hs", "tp"), [(0.5, 4.0), (3.0, 9.0), (12.0, 14.0)])
def test_the_list_has_the_significant_height_asked_for(hs, tp, components):
    waves = ocean.Jonswap(hs=hs, tp=tp, components=components).waves()
    assert len(waves.omega) == components
    assert waves.significant_height == pytest.approx(hs, rel=1e-12)


@pytest.mark.parametrize("gamma", [1.0, 3.3, 7.0])
def test_the_spectrum_integrates_to_a_sixteenth_of_the_height_squared(gamma):
    sea = ocean.Jonswap(hs=3.0, tp=9.0, gamma=gamma)
    omega = np.linspace(0.05, 5.0, 200_001)
    assert np.trapezoid(sea.density(omega), omega) == pytest.approx(3.0**2 / 16, rel=1e-4)


def test_the_spectrum_peaks_at_the_peak_period_and_gamma_raises_the_peak(sea):
    omega = np.linspace(0.3, 2.5, 100_001)
    assert omega[np.argmax(sea.density(omega))] == pytest.approx(2 * math.pi / 9.0, rel=1e-3)
    flat = ocean.Jonswap(hs=3.0, tp=9.0, gamma=1.0)
    low, peak = 1.8 * sea.peak, sea.peak  # at 1.8 times the peak nothing of the peakedness is left

    def over(spectrum):
        return float(spectrum.density(peak) / spectrum.density(low))

    assert over(sea) / over(flat) == pytest.approx(3.3, rel=1e-6)


def test_without_peakedness_the_spectrum_is_pierson_moskowitz():
    sea, omega = ocean.Jonswap(hs=3.0, tp=9.0, gamma=1.0), np.linspace(0.4, 2.5, 50)
    closed = 5 / 16 * 9.0 * sea.peak**4 * omega**-5.0 * np.exp(-1.25 * (sea.peak / omega) ** 4)
    np.testing.assert_allclose(sea.density(omega), closed, rtol=6e-3)  # the band leaves out 0.5 % of the energy


def test_each_component_carries_the_energy_of_its_bin(sea):
    waves, edges = sea.waves(), sea.bin_edges()
    assert np.all((waves.omega >= edges[:-1]) & (waves.omega <= edges[1:]))
    for low, high, amplitude in zip(edges[:-1], edges[1:], waves.amplitude, strict=True):
        omega = np.linspace(low, high, 201)
        energy = np.trapezoid(sea.density(omega), omega)
        assert amplitude**2 / 2 == pytest.approx(energy, rel=2e-3, abs=1e-9)


def test_half_of_the_bins_follow_the_energy_and_half_the_width(sea):
    edges = sea.bin_edges()
    width = np.diff(edges)
    assert width.max() <= 2.0 * (edges[-1] - edges[0]) / 200 * (1 + 1e-6)
    assert (sea.waves().amplitude ** 2 / 2).max() <= 2.0 * 3.0**2 / 16 / 200 * (1 + 1e-3)


def test_a_seed_repeats_exactly_and_another_gives_another_sea(sea):
    first, again = sea.waves(), ocean.Jonswap(hs=3.0, tp=9.0, direction=30 * deg, seed=7).waves()
    other = ocean.Jonswap(hs=3.0, tp=9.0, direction=30 * deg, seed=8).waves()
    for name in ("omega", "k", "direction", "amplitude", "phase"):
        assert np.array_equal(getattr(first, name), getattr(again, name))
    assert not np.array_equal(first.phase, other.phase)
    np.testing.assert_array_equal(first.amplitude, other.amplitude)


def test_directions_spread_about_the_main_one(sea):
    offset = sea.waves().direction - 30 * deg
    assert abs(offset.mean()) < 0.5 * deg
    # cos^2s(theta/2): the mean of cos(theta) is s / (s + 1)
    assert np.cos(offset).mean() == pytest.approx(10 / 11, rel=2e-3)
    long_crested = ocean.Jonswap(hs=3.0, tp=9.0, direction=30 * deg, spreading=math.inf).waves()
    np.testing.assert_array_equal(long_crested.direction, 30 * deg)


def test_the_elevation_of_a_grid_is_the_direct_sum(sea):
    waves = sea.waves()
    x, y, t = np.linspace(-60, 80, 17), np.linspace(-40, 30, 13), 1234.5
    direct = waves.elevation(x[:, None], y[None, :], t)
    assert direct.shape == (17, 13)
    np.testing.assert_allclose(waves.elevation_grid(x, y, t), direct, atol=1e-10)
    total = sum(
        a * math.cos(k * (x[3] * math.cos(d) + y[5] * math.sin(d)) - w * t + p) for w, k, d, a, p in waves.rows()
    )
    assert direct[3, 5] == pytest.approx(total, abs=1e-10)


def test_the_elevation_over_hours_has_the_height_asked_for(sea):
    elevation = sea.waves().elevation(3.0, -5.0, np.arange(0.0, 6 * 3600.0, 1.0))
    assert 4 * elevation.std() == pytest.approx(3.0, rel=0.03)
    assert abs(elevation.mean()) < 0.01


def test_the_list_says_what_sea_it_is_and_cannot_be_changed(sea):
    waves = sea.waves()
    assert waves.about == ("JONSWAP, Hs 3 m, Tp 9 s, gamma 3.3, going to 30 deg, spreading 10, 200 components, seed 7")
    with pytest.raises(ValueError, match="read-only"):
        waves.amplitude[0] = 1.0


def test_a_list_of_uneven_lengths_or_of_no_numbers_is_refused():
    with pytest.raises(ParameterError, match="phase: must be as long as omega"):
        ocean.WaveList(*(np.ones(2),) * 4, np.ones(3))
    with pytest.raises(ParameterError, match="amplitude: must be finite"):
        ocean.WaveList(np.ones(1), np.ones(1), np.ones(1), np.array([np.nan]), np.ones(1))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"hs": 0.0}, r"hs: is no height of a wave \[m\] \(got 0.0\); allowed: above 0"),
        ({"hs": -1.0}, "hs: is no height"),
        ({"hs": math.nan}, "hs: is no height"),
        ({"hs": 250.0}, "hs: is no height"),
        ({"tp": 0.0}, "tp: is no period"),
        ({"tp": math.inf}, "tp: is no period"),
        ({"tp": 0.125}, "Did you mean 0.125 Hz, a period of 8 s?"),
        ({"hs": 8.0, "tp": 4.0}, "hs: is too steep: waves of 4 s are 25 m long and break .*up to 3.57 m"),
        ({"gamma": 0.5}, "gamma: is no peakedness"),
        ({"direction": 180.0}, "did you mean 180 deg?"),
        ({"direction": math.nan}, "direction: is no plausible angle"),
        ({"spreading": 0.0}, "spreading: must be positive"),
        ({"components": 0}, "components: must be a whole number"),
        ({"seed": 1.5}, "seed: must be a whole number"),
    ],
)
def test_no_sea_is_made_of_wrong_numbers(wrong, message):
    with pytest.raises(ParameterError, match=message):
        ocean.Jonswap(**({"hs": 2.5, "tp": 8.0} | wrong))


def test_all_that_is_wrong_with_a_sea_is_said_at_once():
    with pytest.raises(ParameterError) as caught:
        ocean.Jonswap(hs=-1.0, tp=0.0, gamma=0.0)
    assert [problem.path for problem in caught.value.problems] == ["hs", "tp", "gamma"]


def test_a_regular_wave_that_breaks_or_is_given_in_degrees_is_refused():
    with pytest.raises(ParameterError, match="height: is too steep"):
        ocean.regular(6.0, 5.0)
    with pytest.raises(ParameterError, match="did you mean 90 deg"):
        ocean.regular(2.0, 8.0, direction=90.0)
