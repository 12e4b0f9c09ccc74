"""Plots of recordings, in engineering units. matplotlib is imported here only, and only when something is plotted."""

from __future__ import annotations

from typing import TYPE_CHECKING

from seacrane import units
from seacrane.errors import ParameterError, UnitError
from seacrane.results.recording import Recording, Signal

if TYPE_CHECKING:
    from matplotlib.figure import Figure


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
        ax.set_ylabel(f"{names[0]} [{symbol}]" if len(names) == 1 else f"[{symbol}]")
        ax.grid(True, alpha=0.3)
        ax.legend(loc="best")
    axes[-1].set_xlabel("time [s]")
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
