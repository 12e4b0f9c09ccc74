"""What valves share: how far they open, how the opening lags behind, and what flows through a seat.

The corners of every law are rounded over 1 % of full opening.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from typing import Any

from seacrane.errors import Problem
from seacrane.numerics.regularise import limit, smooth_limit
from seacrane.units import bar

ROUNDING = 0.01
"""Share of full opening over which corners are rounded: an opening is off by a quarter of it there."""


def opening(pressure: Any, crack: Any, full: Any) -> Any:
    """Fraction of full area: rises from 0 at `crack` to 1 at `full` with the pressure that lifts the poppet."""
    return smooth_limit((pressure - crack) / (full - crack), 0.0, 1.0, ROUNDING)


def passing(m: Any, a: Any, b: Any, flow: Any) -> Iterator[tuple[Any, Any]]:
    """The law of the ports a and b where `flow` [m3/s] passes from one to the other: no oil is lost, but power is."""
    yield a.q, flow
    yield a.q + b.q, 0
    m.dissipates(flow * (a.p - b.p))


def lagging(
    m: Any, name: str, static: Any, time_constant: Any, *, start: float = 0.0, about: str = "opening, of full area"
) -> Generator[tuple[Any, Any], None, Any]:
    """The law of an opening k that follows `static` as T k' + k = k_s, with k the state `name`; returns k."""
    k = m.state(name, unit="1", start=start, about=about)
    yield m.der(k), (static - k) / time_constant
    return limit(k, 0.0, 1.0)


def rising(crack: tuple[str, float], full: tuple[str, float]) -> Iterator[Problem]:
    """What is wrong with a pair of pressures, given by name, of which the second must be the higher."""
    if crack[1] >= full[1]:
        what = f"must be above {crack[0]} = {crack[1] / bar:g} bar"
        yield Problem(full[0], f"{full[1] / bar:g} bar {what}")
