"""Smooth stand-ins for square roots, switches and signs, with the error and the slope of each.

The raw laws have infinite or undefined slopes where machines spend much of their time: no flow, no speed, a closed
valve. Every function here is finite with a finite slope everywhere. They are written with arithmetic operators only, so
that one definition serves floats, NumPy arrays and CasADi symbols.

`minimum`, `maximum` and `limit` are exact and have a kink; the others are smooth.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from typing import Any


def signed_sqrt(x: Any, transition: Any) -> Any:
    """sign(x) sqrt(|x|), rounded within about `transition` > 0 of zero: x / (x^2 + transition^2)^(1/4).

    Odd and infinitely smooth; slope at zero transition^(-1/2). Never above the exact law in magnitude; below it by at
    most 0.255 sqrt(transition), and by less than (transition/x)^2 / 4 of its value.
    """
    return x / ((x * x + transition * transition) ** 0.5) ** 0.5


def smooth_sign(x: Any, width: Any) -> Any:
    """sign(x), rounded within about `width` > 0 of zero: x / sqrt(x^2 + width^2).

    Odd and infinitely smooth; slope at zero 1/width. Below one in magnitude by less than (width/x)^2 / 2.
    """
    return x / (x * x + width * width) ** 0.5


def positive_part(x: Any, width: Any) -> Any:
    """max(x, 0), rounded by a parabola where |x| < `width` (> 0), and exact elsewhere.

    Slope continuous and in [0, 1]; largest error width/4, at zero. Never negative, not even by a rounding error.
    """
    over = maximum(x - width, 0.0)
    inside = maximum(x - over + width, 0.0)
    return inside * inside / (4 * width) + over


def smooth_limit(x: Any, low: Any, high: Any, width: Any) -> Any:
    """x held within [low, high], its corners rounded where x is within `width` of a limit (width <= (high - low)/2).

    Slope continuous and in [0, 1]; exact elsewhere; largest error width/4, at the corners, inside the limits.
    """
    return low + positive_part(x - low, width) - positive_part(x - high, width)


def minimum(a: Any, b: Any) -> Any:
    """The smaller of the two; where they are equal the slope is the mean of both."""
    return (a + b - abs(a - b)) / 2


def maximum(a: Any, b: Any) -> Any:
    """The larger of the two; where they are equal the slope is the mean of both."""
    return (a + b + abs(a - b)) / 2


def limit(x: Any, low: Any, high: Any) -> Any:
    """x held within [low, high], with sharp corners."""
    return minimum(maximum(x, low), high)


def piecewise_linear(x: Any, points: Sequence[tuple[float, float]]) -> Any:
    """The line through `points` (abscissae strictly rising), constant beyond the first and the last."""
    y: Any = points[0][1] + 0 * x
    for (x0, y0), (x1, y1) in itertools.pairwise(points):
        y = y + (y1 - y0) * limit((x - x0) / (x1 - x0), 0.0, 1.0)
    return y
