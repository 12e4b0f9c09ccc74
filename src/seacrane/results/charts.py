"""Pictures of load charts and workspaces, in engineering units: figures that belong to no window."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Vector = npt.NDArray[np.float64]
Line = tuple[Sequence[float], Sequence[float]]

_CAP = 4.0
"""Loads beyond so many times their median are drawn as that."""

NOT_CERTIFIED = "Computed from a design. Not a certified load chart."


def load_curves(curves: Mapping[str, Line], title: str = "") -> Figure:
    """Load [t] over radius [m], one curve for each mode; each curve is (radii [m], loads [kg])."""
    figure, axes = _figure(title)
    draw_load_curves(axes, curves)
    return figure


def draw_load_curves(axes: Axes, curves: Mapping[str, Line]) -> None:
    """The curves of `load_curves` in given axes."""
    for name, (radii, loads) in curves.items():
        axes.plot(radii, np.asarray(loads) / 1e3, marker=".", label=name)
    axes.set_xlabel("radius [m]")
    axes.set_ylabel("load [t]")
    axes.set_ylim(bottom=0.0)
    axes.grid(True, alpha=0.3)
    axes.legend(title="mode")
    _disclaim(axes)


def load_section(radius: Vector, height: Vector, load: Vector, outline: Sequence[Line] = (), title: str = "") -> Figure:
    """The load [kg] of the best posture over the crane's plane, coloured and contoured.

    radius (n,), height (m,) [m]; load (m, n), nan where the tip cannot be; outline: lines of the crane's picture.
    """
    figure, axes = _figure(title)
    draw_load_section(figure, axes, radius, height, load, outline)
    _disclaim(axes)
    return figure


def draw_load_section(
    figure: Figure, axes: Axes, radius: Vector, height: Vector, load: Vector, outline: Sequence[Line] = ()
) -> None:
    """The picture of `load_section` in given axes of a figure."""
    from matplotlib.ticker import MaxNLocator

    tonnes = np.ma.masked_invalid(load / 1e3)
    most = float(tonnes.max()) if tonnes.count() else 0.0
    # Close to the slewing axis a moment allows any load: colours are for what is lifted where the crane works.
    top = min(most, _CAP * float(np.median(tonnes.compressed()))) if tonnes.count() else 0.0
    top = top if top > 0 else most or 1.0
    colours = axes.pcolormesh(
        radius, height, tonnes, cmap="viridis", shading="nearest", rasterized=True, vmin=0.0, vmax=top
    )
    levels = [level for level in MaxNLocator(9, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, top) if 0 < level < most]
    if levels and float(tonnes.min()) < levels[-1]:
        lines = axes.contour(radius, height, tonnes, levels=levels, colors="white", linewidths=0.7)
        axes.clabel(lines, fmt=lambda level: f"{level:g} t", fontsize="x-small")
    for x, z in outline:
        axes.plot(x, z, color="black", linewidth=1.2, solid_capstyle="round")
    beyond: Literal["max", "neither"] = "max" if most > top else "neither"
    beside = axes.inset_axes((1.03, 0.0, 0.04, 1.0))
    figure.colorbar(colours, cax=beside, label="load of the best posture [t]", extend=beyond)
    axes.set_xlabel("radius [m]")
    axes.set_ylabel("height above the foot [m]")
    axes.set_aspect("equal")


def _literal(text: str) -> str:
    """A text for matplotlib to draw as it stands, which takes what is between two $ for a formula."""
    return text.replace("$", r"\$")


def _disclaim(axes: Axes) -> None:
    axes.text(1.0, 1.01, NOT_CERTIFIED, transform=axes.transAxes, ha="right", fontsize="x-small")


def _figure(title: str) -> tuple[Figure, Axes]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    if title:
        figure.suptitle(_literal(title))
    return figure, figure.subplots()


def data_sheet(
    name: str,
    about: str,
    facts: Sequence[tuple[str, str]],
    drawing: Sequence[Line],
    curves: Mapping[str, Line],
    section: tuple[Vector, Vector, Vector],
    provenance: str,
) -> bytes:
    """One landscape A4 page of PDF, without a date: the same content gives the same bytes."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    figure = Figure(figsize=(11.69, 8.27), layout=ConstrainedLayoutEngine(rect=(0.0, 0.03, 1.0, 0.97)))
    figure.suptitle(f"{_literal(name)}   data sheet", fontsize="x-large", x=0.02, ha="left", weight="bold")
    grid = figure.add_gridspec(3, 2, height_ratios=(0.16, 1, 1))
    head = figure.add_subplot(grid[0, :])
    head.axis("off")
    head.text(0.0, 0.9, _literal(about), transform=head.transAxes, va="top", fontsize="small", wrap=True)
    side = figure.add_subplot(grid[1, 0])
    for x, z in drawing:
        side.plot(x, z, color="black", linewidth=0.5)
    side.set(xlabel="x [m]", ylabel="height above the foot [m]", aspect="equal", title="side view")
    load = figure.add_subplot(grid[1, 1])
    draw_load_section(figure, load, *section)
    load.set_title("harbour", loc="left", fontsize="medium")
    draw_load_curves(figure.add_subplot(grid[2, 0]), curves)
    table = figure.add_subplot(grid[2, 1])
    table.axis("off")
    for row, (what, value) in enumerate(facts):
        y = 1.0 - row / max(len(facts), 1)
        table.text(0.0, y, _literal(what), transform=table.transAxes, va="top", fontsize="small")
        table.text(0.5, y, _literal(value), transform=table.transAxes, va="top", fontsize="small")
    figure.text(0.02, 0.003, f"{NOT_CERTIFIED} {provenance}", fontsize="x-small")
    content = io.BytesIO()
    figure.savefig(content, format="pdf", metadata={"CreationDate": None})
    return content.getvalue()
