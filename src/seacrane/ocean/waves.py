"""Waves as one list of components, shared by the physics and the picture.

    eta(x, y, t) = sum_i a_i cos(k_i (x cos d_i + y sin d_i) - omega_i t + phase_i)

Linear waves in deep water, omega^2 = g k. x and y are horizontal axes fixed to the earth [m], eta is positive up from
the still surface. A direction is where a wave is *going to* [rad], counter-clockwise seen from above, 0 along x.
Every component has its own frequency and its own direction (single summation), so the sea is never standing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seacrane.errors import ParameterError, Problem
from seacrane.units import GRAVITY, Angle, Length, Time, quantity_of

Array = NDArray[np.float64]

STEEPEST: Final = 1 / 7
"""Height over length at which a wave in deep water breaks (Michell 1893: 0.142)."""

BAND: Final = (0.4, 4.0)
"""Frequencies of a spectrum that are kept, in units of the peak; 0.5 % of the energy of an open tail lies above."""

_PERIODS: Final = (0.5, 60.0)
_HIGHEST: Final = 40.0


@dataclass(frozen=True, eq=False)
class WaveList:
    """Wave components: arrays of one length n, which cannot be written to.

    omega [rad/s], k [rad/m], direction (going to) [rad], amplitude [m], phase [rad]; `about` says what sea it is.
    """

    omega: Array
    k: Array
    direction: Array
    amplitude: Array
    phase: Array
    about: str = ""

    def __post_init__(self) -> None:
        problems = []
        for name in ("omega", "k", "direction", "amplitude", "phase"):
            values = np.array(getattr(self, name), float, ndmin=1)
            values.setflags(write=False)
            object.__setattr__(self, name, values)
            if values.shape != self.omega.shape:
                problems.append(Problem(name, "must be as long as omega", values.shape, str(self.omega.shape)))
            elif not np.isfinite(values).all():
                problems.append(Problem(name, "must be finite numbers"))
        if problems:
            raise ParameterError(problems)

    @property
    def significant_height(self) -> float:
        """Hs = 4 sqrt(m0) [m], with m0 = sum a^2 / 2."""
        return 4.0 * math.sqrt(0.5 * float(self.amplitude @ self.amplitude))

    def rows(self) -> list[list[float]]:
        """One [omega, k, direction, amplitude, phase] for each component: what a page draws the sea from."""
        columns = (self.omega, self.k, self.direction, self.amplitude, self.phase)
        rows: list[list[float]] = np.column_stack(columns).tolist()
        return rows

    def elevation(self, x: ArrayLike, y: ArrayLike, t: ArrayLike) -> Array:
        """Elevation [m] at points and times that broadcast against each other: x, y [m], t [s]."""
        x, y, t = (np.asarray(a, float)[..., None] for a in (x, y, t))
        kx, ky = self._wave_numbers
        elevation: Array = (self.amplitude * np.cos(kx * x + ky * y - self.omega * t + self.phase)).sum(-1)
        return elevation

    def elevation_grid(self, x: ArrayLike, y: ArrayLike, t: float) -> Array:
        """Elevation (nx, ny) [m] on the rectangular grid of x (nx) and y (ny) [m] at one time t [s].

        cos(X + Y) = cos X cos Y - sin X sin Y makes the sum two matrix products, some thirty times faster than the
        direct sum; the two agree to rounding.
        """
        kx, ky = self._wave_numbers
        phase = np.remainder(self.phase - self.omega * t, 2 * math.pi)
        along = np.multiply.outer(np.asarray(x, float), kx) + phase
        across = np.multiply.outer(np.asarray(y, float), ky)
        grid: Array = (np.cos(along) * self.amplitude) @ np.cos(across).T - (np.sin(along) * self.amplitude) @ np.sin(
            across
        ).T
        return grid

    @cached_property
    def _wave_numbers(self) -> tuple[Array, Array]:
        return self.k * np.cos(self.direction), self.k * np.sin(self.direction)


def regular(height: float, period: float, direction: float = 0.0, phase: float = 0.0) -> WaveList:
    """One wave of `height` crest to trough [m], `period` [s], going to `direction` [rad].

    `ParameterError` if no such wave is possible in deep water.
    """
    _refuse(_sea_problems("height", height, "period", period) + _angle_problems(direction=direction, phase=phase))
    omega = 2 * math.pi / period
    return WaveList(
        omega=np.array([omega]),
        k=np.array([omega**2 / GRAVITY]),
        direction=np.array([direction]),
        amplitude=np.array([0.5 * height]),
        phase=np.array([phase]),
        about=f"regular wave, {height:g} m high, {period:g} s, going to {math.degrees(direction):g} deg",
    )


@dataclass(frozen=True, kw_only=True)
class Jonswap:
    """A JONSWAP sea (Hasselmann et al. 1973), renormalised so that its height is the one asked for.

        S(omega) = C omega^-5 exp(-5/4 (omega_p/omega)^4) gamma^b
        b = exp(-(omega/omega_p - 1)^2 / (2 sigma^2)),  sigma = 0.07 up to the peak and 0.09 above

    with C such that the integral over the kept band (0.4 to 4 times the peak) is Hs^2/16. The directions follow
    cos^(2s)(theta/2) about the main one, s = `spreading`; `math.inf` makes a long-crested sea.

    hs: significant height [m]; tp: peak period [s]; gamma: peakedness, 1 is Pierson-Moskowitz; direction: going to
    [rad]; one `seed` gives one sea, always. `ParameterError` lists all that is wrong.
    """

    hs: Length
    tp: Time
    gamma: float = 3.3
    direction: Angle = 0.0
    spreading: float = 10.0
    seed: int = 1
    components: int = 200

    def __post_init__(self) -> None:
        problems = _sea_problems("hs", self.hs, "tp", self.tp) + _angle_problems(direction=self.direction)
        if not 1.0 <= self.gamma <= 20.0:
            problems.append(Problem("gamma", "is no peakedness of a sea", self.gamma, "1 to 20"))
        if not self.spreading > 0.0:
            problems.append(Problem("spreading", "must be positive", self.spreading, "above 0, or math.inf"))
        for name, value, least in (("seed", self.seed, 0), ("components", self.components, 1)):
            if isinstance(value, bool) or not isinstance(value, int) or value < least:
                problems.append(Problem(name, "must be a whole number", value, f"{least} or more"))
        _refuse(problems)

    @property
    def peak(self) -> float:
        """Peak frequency [rad/s]."""
        return 2 * math.pi / self.tp

    def density(self, omega: ArrayLike) -> Array:
        """Spectral density S(omega) [m2.s/rad]; zero outside the kept band."""
        ratio = np.asarray(omega, float) / self.peak
        inside = (ratio >= BAND[0]) & (ratio <= BAND[1])
        scale = self.hs**2 / 16 / self.peak / _cumulative(self.gamma)[1][-1]
        density: Array = np.where(inside, scale * _shape(np.where(inside, ratio, 1.0), self.gamma), 0.0)
        return density

    def bin_edges(self) -> Array:
        """Frequencies (components + 1) [rad/s] between which one component stands for the sea.

        Half of the weight is energy and half is width: equal energy alone leaves the tails, in which a ship may have
        its natural period, to a few wide bins; equal width alone leaves the peak to a few.
        """
        ratio, energy = _cumulative(self.gamma)
        weight = 0.5 * energy / energy[-1] + 0.5 * (ratio - ratio[0]) / (ratio[-1] - ratio[0])
        edges: Array = self.peak * np.interp(np.linspace(0.0, 1.0, self.components + 1), weight, ratio)
        return edges

    def waves(self) -> WaveList:
        """The sea as a list: the energy of each bin exactly, at a random frequency in it, with random phases.

        The directions are stratified: each of n equal slices of the spreading's probability is used once.
        """
        generator = np.random.Generator(np.random.Philox(self.seed))
        n, edges = self.components, self.bin_edges()
        ratio, energy = _cumulative(self.gamma)
        share = np.diff(np.interp(edges / self.peak, ratio, energy / energy[-1]))
        omega = edges[:-1] + generator.random(n) * np.diff(edges)
        quantile = (generator.permutation(n) + generator.random(n)) / n
        phase = generator.random(n) * (2 * math.pi)
        spread = "long-crested" if math.isinf(self.spreading) else f"spreading {self.spreading:g}"
        return WaveList(
            omega=omega,
            k=omega**2 / GRAVITY,
            direction=self.direction + self._offsets(quantile),
            amplitude=np.sqrt(2.0 * share / share.sum()) * self.hs / 4,
            phase=phase,
            about=(
                f"JONSWAP, Hs {self.hs:g} m, Tp {self.tp:g} s, gamma {self.gamma:g}, going to "
                f"{math.degrees(self.direction):g} deg, {spread}, {n} components, seed {self.seed}"
            ),
        )

    def _offsets(self, quantile: Array) -> Array:
        """Angles off the main direction [rad] at quantiles of cos^(2s)(theta/2)."""
        if math.isinf(self.spreading):
            return np.zeros_like(quantile)
        theta = np.linspace(-math.pi, math.pi, 4001)
        probability = _integral(np.cos(0.5 * theta) ** (2.0 * self.spreading), theta)
        return np.interp(quantile, probability / probability[-1], theta)


def _shape(ratio: Array, gamma: float) -> Array:
    sigma = np.where(ratio <= 1.0, 0.07, 0.09)
    peaked = gamma ** np.exp(-0.5 * ((ratio - 1.0) / sigma) ** 2)
    shape: Array = ratio**-5.0 * np.exp(-1.25 * ratio**-4.0) * peaked
    return shape


@lru_cache(maxsize=32)
def _cumulative(gamma: float) -> tuple[Array, Array]:
    """Frequencies over the peak and the running integral of the shape."""
    ratio = np.linspace(*BAND, 16001)
    return ratio, _integral(_shape(ratio, gamma), ratio)


def _integral(values: Array, at: Array) -> Array:
    """Running integral by trapezoids, from zero."""
    return np.concatenate(([0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(at))))


# ---------------------------------------------------------------- what no sea is
def _refuse(problems: list[Problem]) -> None:
    if problems:
        raise ParameterError(problems)


def _sea_problems(height_name: str, height: float, period_name: str, period: float) -> list[Problem]:
    problems = []
    low, high = _PERIODS
    if not (math.isfinite(height) and 0.0 < height <= _HIGHEST):
        problems.append(Problem(height_name, "is no height of a wave [m]", height, f"above 0, up to {_HIGHEST:g} m"))
    if not (math.isfinite(period) and low <= period <= high):
        inverse = 1.0 / period if period else math.inf
        asked = f"Did you mean {period:g} Hz, a period of {inverse:g} s?" if low <= inverse <= high else None
        problems.append(Problem(period_name, "is no period of a wave [s]", period, f"{low:g} to {high:g} s", asked))
    if not problems:
        length = GRAVITY * period**2 / (2 * math.pi)
        if height > STEEPEST * length:
            problems.append(
                Problem(
                    height_name,
                    f"is too steep: waves of {period:g} s are {length:.3g} m long and break",
                    height,
                    f"up to {STEEPEST * length:.3g} m at this period",
                )
            )
    return problems


def _angle_problems(**angles: float) -> list[Problem]:
    quantity = quantity_of(Angle)
    problems = []
    for name, value in angles.items():
        question = quantity.slip(value) if quantity else None
        if question is not None or not math.isfinite(value):
            problems.append(Problem(name, "is no plausible angle [rad]", value, hint=question))
    return problems
