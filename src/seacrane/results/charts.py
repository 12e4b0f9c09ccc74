"""Pictures of load charts and workspaces, in engineering units: figures that belong to no window."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Vector = npt.NDArray[np.float64]
Line = tuple[Sequence[float], Sequence[float]]

_TOP = 93.0
"""The percentile of the loads at which the colours end."""

NOT_CERTIFIED = "Computed from a design. Not a certified load chart."


@dataclass(frozen=True, eq=False)
class Shape:
    """A body from the side: triangles (n, 3, 2) of what it hides, and the edges (m, 2, 2) that are drawn of it [m]."""

    covers: Vector
    edges: Vector


def draw_shapes(axes: Axes, shapes: Sequence[Shape]) -> None:
    """Bodies in given axes, what is farther away first."""
    from matplotlib.collections import LineCollection, PolyCollection

    for place, shape in enumerate(shapes):
        order = 2 + place / (len(shapes) + 1)  # over what is coloured, under what is written
        if len(shape.covers):
            axes.add_collection(PolyCollection(list(shape.covers), facecolor="white", linewidths=0, zorder=order))
        axes.add_collection(LineCollection(list(shape.edges), colors="black", linewidths=0.6, zorder=order))


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


def load_section(radius: Vector, height: Vector, load: Vector, view: Sequence[Shape] = (), title: str = "") -> Figure:
    """The load [kg] of the best posture over the crane's plane, coloured and contoured.

    radius (n,), height (m,) [m]; load (m, n), nan where the tip cannot be; view: the crane from the side.
    """
    figure, axes = _figure(title)
    draw_load_section(figure, axes, radius, height, load, view)
    _disclaim(axes)
    return figure


def draw_load_section(
    figure: Figure, axes: Axes, radius: Vector, height: Vector, load: Vector, view: Sequence[Shape] = ()
) -> None:
    """The picture of `load_section` in given axes of a figure."""
    from matplotlib.ticker import MaxNLocator

    tonnes = np.ma.masked_invalid(load / 1e3)
    most = float(tonnes.max()) if tonnes.count() else 0.0
    # Close to the slewing axis a moment allows any load: colours are for what is lifted where the crane works.
    lifted = tonnes.compressed()[tonnes.compressed() > 0]
    top = float(f"{np.percentile(lifted, _TOP):.2g}") if lifted.size else 1.0
    colours = axes.pcolormesh(
        radius, height, tonnes, cmap="viridis", shading="nearest", rasterized=True, vmin=0.0, vmax=top
    )
    levels = [level for level in MaxNLocator(9, steps=[1, 2, 2.5, 5, 10]).tick_values(0.0, top) if 0 < level < most]
    if levels and float(tonnes.min()) < levels[-1]:
        lines = axes.contour(radius, height, tonnes, levels=levels, colors="white", linewidths=0.7)
        axes.clabel(lines, fmt=lambda level: f"{level:g} t", fontsize="x-small")
    draw_shapes(axes, view)
    axes.autoscale_view()
    beyond: Literal["max", "neither"] = "max" if most > top else "neither"
    beside = axes.inset_axes((1.03, 0.0, 0.04, 1.0))
    figure.colorbar(colours, cax=beside, label="load of the best posture [t]", extend=beyond)
    axes.set_xlabel("radius [m]")
    axes.set_ylabel("height above the foot [m]")
    axes.set_aspect("equal")


def literal(text: str) -> str:
    """A text for matplotlib to draw as it stands, which takes what is between two $ for a formula."""
    return text.replace("$", r"\$")


def _disclaim(axes: Axes) -> None:
    axes.text(1.0, 1.01, NOT_CERTIFIED, transform=axes.transAxes, ha="right", fontsize="x-small")


def _figure(title: str) -> tuple[Figure, Axes]:
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.0, 6.0), layout="constrained")
    if title:
        figure.suptitle(literal(title))
    return figure, figure.subplots()
