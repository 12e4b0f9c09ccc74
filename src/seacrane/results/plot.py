"""Plots of recordings, in engineering units. matplotlib is imported here only, and only when something is plotted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from seacrane import units
from seacrane.errors import ParameterError, UnitError
from seacrane.results.recording import Recording, Signal, Vector

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ComplexVector = npt.NDArray[np.complex128]


def plot(recording: Recording, unit: str | float | None = None, title: str = "") -> Figure:
    """A figure with one axes for each unit shown, above one another on a shared time axis.

    The figure belongs to no window and needs no display; save it with `figure.savefig(path)`.
    """
    from matplotlib.figure import Figure

    if not recording.signals:
        raise ParameterError.at("names", "there is no signal to plot")
    panels: dict[str, list[str]] = {}
    for name, signal in recording.signals.items():
        panels.setdefault(_shown(name, signal, unit), []).append(name)
    figure = Figure(figsize=(9.0, 1.2 + 2.2 * len(panels)), layout="constrained")
    axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
    for ax, (symbol, names) in zip(axes, panels.items(), strict=True):
        for name in names:
            signal = recording.signals[name]
            ax.plot(recording.time, units.convert(1.0, signal.unit, symbol) * signal.values, label=name)
        ax.set_ylabel(units.labelled(names[0] if len(names) == 1 else "", symbol).strip())
        ax.grid(True, alpha=0.3)
        ax.legend(loc="best")
    axes[-1].set_xlabel("time [s]")
    if title:
        figure.suptitle(title)
    return figure


def overlay(name: str, runs: Mapping[str, Recording], reference: Recording, unit: str | None = None) -> Figure:
    """One signal of several runs over a reference, and below it how far each run is from the reference."""
    from matplotlib.figure import Figure

    shown = unit or reference.signal(name).display
    factor = units.convert(1.0, reference.signal(name).unit, shown, name)
    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    for label, run in runs.items():
        above.plot(run.time, factor * run[name], label=label)
        apart = factor * (run[name] - np.interp(run.time, reference.time, reference[name]))
        below.plot(run.time, apart, label=label, zorder=2 + 1 / (1 + np.abs(apart).max()))  # the closest in front
    above.plot(reference.time, factor * reference[name], "k--", linewidth=0.8, label="reference")
    above.set_ylabel(units.labelled(name, shown))
    below.set_ylabel(units.labelled("deviation", shown))
    below.set_xlabel("time [s]")
    for ax in (above, below):
        ax.grid(True, alpha=0.3)
    columns = 2 if max(map(len, runs), default=0) < 50 else 1
    figure.legend(*above.get_legend_handles_labels(), loc="outside lower center", ncols=columns, fontsize="small")
    return figure


def family(
    name: str,
    runs: Sequence[Recording],
    values: Sequence[float],
    parameter: str,
    parameter_unit: str,
    parameter_shown: str,
    unit: str | None = None,
) -> Figure:
    """One signal of runs that differ in a parameter, the colour following its value."""
    from matplotlib import colormaps
    from matplotlib.figure import Figure

    shown = unit or runs[0].signal(name).display
    factor = units.convert(1.0, runs[0].signal(name).unit, shown, name)
    figure = Figure(figsize=(9.0, 4.5), layout="constrained")
    ax = figure.subplots()
    for i, (run, value) in enumerate(zip(runs, values, strict=True)):
        converted = units.convert(value, parameter_unit, parameter_shown, parameter)
        label = units.with_unit(converted, parameter_shown)
        ax.plot(run.time, factor * run[name], color=colormaps["viridis"](i / max(1, len(runs) - 1)), label=label)
    ax.set_xlabel("time [s]")
    ax.set_ylabel(units.labelled(name, shown))
    ax.grid(True, alpha=0.3)
    ax.legend(loc="best", fontsize="small", title=parameter)
    return figure


def bode(frequency: Vector, response: Mapping[str, ComplexVector], title: str = "") -> Figure:
    """Magnitude [dB of SI units] and phase [deg] of frequency responses over `frequency` [Hz]."""
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    figure = Figure(figsize=(9.0, 6.0), layout="constrained")
    magnitude, phase = figure.subplots(2, 1, sharex=True)
    for label, values in response.items():
        with np.errstate(divide="ignore"):
            magnitude.semilogx(frequency, 20 * np.log10(np.abs(values)), label=label)
        phase.semilogx(frequency, np.rad2deg(np.unwrap(np.angle(values))), label=label)
    magnitude.set_ylabel("magnitude [dB]")
    phase.set_ylabel("phase [deg]")
    phase.yaxis.set_major_locator(MaxNLocator(nbins=8, steps=[1, 1.5, 3, 4.5, 9, 10]))
    phase.set_xlabel("frequency [Hz]")
    for ax in (magnitude, phase):
        ax.grid(True, which="both", alpha=0.3)
    magnitude.legend(loc="best", fontsize="small")
    if title:
        figure.suptitle(title)
    return figure


def _shown(name: str, signal: Signal, wanted: str | float | None) -> str:
    if wanted is None:
        return signal.display
    if isinstance(wanted, str):
        units.convert(1.0, signal.unit, wanted, name)
        return wanted
    own = units.unit(signal.unit)
    for candidate in units.UNITS.values():
        if candidate.factor == wanted and candidate.same_dimension(own):
            return candidate.symbol
    raise UnitError.at(name, f"no unit for a quantity in {signal.unit!r} has this factor to SI", value=wanted)
