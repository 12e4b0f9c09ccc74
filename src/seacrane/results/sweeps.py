"""Pictures of how error and cost follow the step: figures that belong to no window."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MARKERS = "osD^vP*X"
LEAST = 1e-12
"""What a logarithmic axis shows of an error of 0."""


def error_and_cost(
    runs: Mapping[str, Sequence[tuple[float, float, float | None]]],
    error: str,
    *,
    tolerance: float | None = None,
    chosen: tuple[float, float] | None = None,
    gains: Mapping[str, Mapping[float, float]] | None = None,
    title: str = "",
) -> Figure:
    """Error over step and over cost, a curve for each of `runs`, and below them loop gains over the step.

    `runs` gives (step [s], cost, error) by growing step; an error of None is a run that was lost, which is a cross at
    the upper edge. `error` labels the axis. `tolerance` is drawn dashed, the point `chosen` (cost, error) ringed.
    """
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.0, 7.6 if gains else 4.4), layout="constrained")
    grid = figure.add_gridspec(2 if gains else 1, 2)
    over_step, over_cost = (figure.add_subplot(grid[0, i]) for i in range(2))
    worst = max((e for points in runs.values() for _, _, e in points if e is not None), default=1.0)
    for i, (name, points) in enumerate(runs.items()):
        look = {"marker": MARKERS[i % len(MARKERS)], "color": f"C{i}", "markersize": 5.0}
        kept = [(1e3 * step, cost, max(e, LEAST)) for step, cost, e in points if e is not None]
        over_step.loglog([s for s, _, _ in kept], [e for _, _, e in kept], label=name, **look)
        over_cost.loglog([c for _, c, _ in kept], [e for _, _, e in kept], **look)
        lost = [1e3 * step for step, _, e in points if e is None]
        over_step.plot(lost, [2.0 * worst] * len(lost), linestyle="", marker="x", color=f"C{i}")
    for axes, label in ((over_step, "macro step [ms]"), (over_cost, "CPU time / simulated time")):
        if tolerance is not None:
            axes.axhline(tolerance, color="black", linewidth=0.8, linestyle="--")
        _finish(axes, label, error)
    if chosen is not None:
        over_cost.plot(*([value] for value in chosen), marker="o", markersize=14, fillstyle="none", color="black")
    if gains:
        below = figure.add_subplot(grid[1, :])
        for i, (name, points_) in enumerate(gains.items()):
            drawn = [(1e3 * step, gain) for step, gain in sorted(points_.items()) if gain > 0]
            below.loglog([s for s, _ in drawn], [g for _, g in drawn], marker=MARKERS[i % len(MARKERS)], label=name)
        below.axhline(1.0, color="black", linewidth=0.8, linestyle="--")
        _finish(below, "macro step [ms]", "loop gain")
        below.legend(fontsize="small", ncols=2)
    figure.legend(*over_step.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize="small")
    figure.suptitle(title)
    return figure


def _finish(axes: Axes, x: str, y: str) -> None:
    from matplotlib.ticker import NullFormatter

    for axis in (axes.xaxis, axes.yaxis):
        low, high = axis.get_view_interval()
        if high > 20 * low:  # decades alone say enough
            axis.set_minor_formatter(NullFormatter())
    axes.tick_params(which="minor", labelsize="x-small")
    axes.tick_params(axis="x", which="minor", rotation=60)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(True, which="both", alpha=0.3)
