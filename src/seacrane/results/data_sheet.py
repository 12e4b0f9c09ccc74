"""The data sheet of a crane: pages of A4 as PDF, without a date: equal content has equal bytes."""

from __future__ import annotations

import io
import string
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from seacrane.results.charts import (
    NOT_CERTIFIED,
    Shape,
    Vector,
    draw_load_curves,
    draw_load_section,
    draw_shapes,
    literal,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Rectangle

_ROWS = 34
"""Radii that the table of a page has room for."""


_CONDITIONS = 22
"""Lines of conditions that the page has room for at full size."""


@dataclass(frozen=True)
class Sheet:
    """What a data sheet says.

    view: the crane from the side, far parts first, its tip at `tip` (x, z) [m]; section: radius (n,), height (m,) [m]
    and load (m, n) [kg], nan out of reach; curves: by mode, radius [m], load [kg] and what governs; tables: by title,
    rows of words, the first their heads.
    """

    name: str
    about: str
    facts: Sequence[tuple[str, str]]
    view: Sequence[Shape]
    tip: tuple[float, float]
    section: tuple[Vector, Vector, Vector]
    curves: Mapping[str, Sequence[tuple[float, float, str]]]
    conditions: Sequence[str]
    tables: Mapping[str, Sequence[Sequence[str]]]
    sources: Sequence[str]
    provenance: str


def data_sheet(sheet: Sheet) -> bytes:
    """The sheet as PDF."""
    from matplotlib.backends.backend_pdf import PdfPages

    content = io.BytesIO()
    with PdfPages(content, metadata={"CreationDate": None, "Title": f"{sheet.name}, data sheet"}) as file:
        for page in pages(sheet):
            file.savefig(page)
    return content.getvalue()


def pages(sheet: Sheet) -> list[Figure]:
    """Its pages: the crane and its workspace; its load chart with the conditions; its particulars and sources."""
    found = [_overview(sheet), _load_chart(sheet), *_particulars(sheet)]
    for number, page in enumerate(found, 1):
        page.text(0.965, 0.022, f"page {number} of {len(found)}", fontsize=7, ha="right")
    return found


def _page(sheet: Sheet, title: str) -> Figure:
    from matplotlib.figure import Figure

    page = Figure(figsize=(11.69, 8.27))
    page.text(0.035, 0.945, _cut(sheet.name, 60), fontsize=16 if len(sheet.name) <= 36 else 10, weight="bold")
    page.text(0.965, 0.948, "NOT A CERTIFIED LOAD CHART", fontsize=10, weight="bold", ha="right", color="#9b1c1c")
    page.text(0.035, 0.918, title, fontsize=10, color="0.35")
    page.text(0.035, 0.022, f"{NOT_CERTIFIED} {sheet.provenance}", fontsize=7)
    for height in (0.908, 0.04):
        page.add_artist(_rule(height))
    return page


def _rule(height: float) -> Line2D:
    from matplotlib.lines import Line2D

    return Line2D([0.035, 0.965], [height, height], color="0.6", linewidth=0.8)


# ---------------------------------------------------------------- pages
def _overview(sheet: Sheet) -> Figure:
    page = _page(sheet, "data sheet: general arrangement and workspace")
    page.text(0.035, 0.895, _wrapped(sheet.about, 170, 3), fontsize=8.5, va="top")
    side = page.add_axes((0.07, 0.35, 0.42, 0.45))
    draw_shapes(side, sheet.view)
    side.autoscale_view()
    side.margins(0.06)
    side.set(xlabel="x [m]", ylabel="height above the foot [m]", aspect="equal", anchor="C")
    side.axvline(0.0, color="0.5", linewidth=0.6, linestyle="-.", zorder=0)
    side.axhline(0.0, color="0.5", linewidth=0.6, zorder=0)
    _dimensions(side, sheet.tip)
    side.set_title("from starboard, half-way out", loc="left", fontsize=9)
    load = page.add_axes((0.56, 0.35, 0.33, 0.45))
    draw_load_section(page, load, *sheet.section, sheet.view)
    load.set_title("load of the best posture, harbour", loc="left", fontsize=9)
    for axes in (side, load, *load.child_axes):
        _small(axes)
    half = (len(sheet.facts) + 1) // 2
    for column, facts in enumerate((sheet.facts[:half], sheet.facts[half:])):
        for row, (what, value) in enumerate(facts):
            y = 0.265 - 0.215 * row / max(half, 8)
            page.text(0.035 + 0.485 * column, y, _cut(what, 26), fontsize=8, color="0.35")
            page.text(0.205 + 0.485 * column, y, _cut(value, 52), fontsize=8)
    return page


def _small(axes: Any) -> None:
    axes.tick_params(labelsize=8)
    for label in (axes.xaxis.label, axes.yaxis.label):
        label.set_fontsize(8)
    if legend := axes.get_legend():
        for text in (legend.get_title(), *legend.get_texts()):
            text.set_fontsize(8)


def _dimensions(axes: Axes, tip: tuple[float, float]) -> None:
    """Radius and height of the tip, as a drawing has them."""
    x, z = tip
    arrow: dict[str, Any] = {"arrowstyle": "<->", "color": "0.3", "linewidth": 0.7, "shrinkA": 0, "shrinkB": 0}
    words: dict[str, Any] = {
        "fontsize": 8,
        "color": "0.2",
        "bbox": {"facecolor": "white", "edgecolor": "none", "pad": 0.8},
    }
    low = axes.get_ylim()[0]
    axes.annotate("", (0.0, low), (x, low), arrowprops=arrow)
    axes.text(0.5 * x, low, f"radius {x:.2f} m", ha="center", va="center", **words)
    axes.annotate("", (x, 0.0), (x, z), arrowprops=arrow)
    axes.text(x, 0.5 * z, f"{z:.2f} m", ha="center", va="center", rotation=90, **words)


def _load_chart(sheet: Sheet) -> Figure:
    page = _page(sheet, "data sheet: load chart")
    curves = page.add_axes((0.065, 0.50, 0.39, 0.36))
    draw_load_curves(
        curves, {mode: ([r for r, _, _ in rows], [load for _, load, _ in rows]) for mode, rows in sheet.curves.items()}
    )
    page.text(0.035, 0.435, "Conditions", fontsize=9, weight="bold")
    lines = [line for text in sheet.conditions for line in _hanging(text, 100)]
    size = min(7.5, 7.5 * _CONDITIONS / max(len(lines), 1))
    page.text(0.035, 0.422, "\n".join(lines), fontsize=size, va="top", linespacing=1.3)
    limits = list(dict.fromkeys(limit for rows in sheet.curves.values() for _, _, limit in rows))
    letters = {limit: string.ascii_lowercase[i] if i < 26 else f"{i}" for i, limit in enumerate(limits)}
    radii = sorted({radius for rows in sheet.curves.values() for radius, _, _ in rows})
    shown = radii[:: -(-len(radii) // _ROWS)] if radii else []
    loads = {(mode, radius): (load, limit) for mode, rows in sheet.curves.items() for radius, load, limit in rows}
    width = 0.43 / (len(sheet.curves) + 1)
    page.text(0.52, 0.878, "load [t] at radius [m], and what governs", fontsize=9, weight="bold")
    for column, mode in enumerate(("radius", *sheet.curves)):
        page.text(0.56 + width * column, 0.855, literal(mode), fontsize=8, ha="right", color="0.35")
    for row, radius in enumerate(shown):
        y = 0.835 - 0.021 * row
        if row % 2:
            page.add_artist(_band(0.515, y - 0.005, 0.45, 0.021))
        page.text(0.56, y, f"{radius:.1f}", fontsize=8, ha="right")
        for column, mode in enumerate(sheet.curves, 1):
            load, limit = loads.get((mode, radius), (None, ""))
            if load is not None:
                page.text(0.56 + width * column, y, f"{load / 1e3:.1f}", fontsize=8, ha="right")
                page.text(0.563 + width * column, y, letters[limit], fontsize=6.5, color="0.35")
    legend = "   ".join(f"{letter} {limit}" for limit, letter in letters.items())
    page.text(0.52, 0.832 - 0.021 * len(shown), _wrapped(legend, 95), fontsize=7.5, va="top")
    _small(curves)
    return page


def _particulars(sheet: Sheet) -> list[Figure]:
    """Tables, then the sources, on as many pages as they need."""
    title = "data sheet: particulars and where they come from"
    pages = [_page(sheet, title)]
    y = 0.88
    for name, rows in sheet.tables.items():
        pages[-1].text(0.035, y, name, fontsize=9, weight="bold")
        y -= 0.024
        for row, cells in enumerate(rows):
            if row % 2 == 0:
                pages[-1].add_artist(_band(0.035, y - 0.005, 0.93, 0.021))
            for column, cell in enumerate(cells):
                x = 0.04 if column == 0 else 0.20 + 0.765 * column / max(len(cells) - 1, 1)
                align = "left" if column == 0 else "right"
                pages[-1].text(x, y, _cut(cell, 30), fontsize=7.5, ha=align, color="0.35" if row == 0 else "black")
            y -= 0.021
        y -= 0.018
    lines = [line for text in sheet.sources for line in _hanging(text, 205)]
    while lines:
        room = max(int((y - 0.07) / 0.0165), 0)
        if room < 4:
            pages.append(_page(sheet, title))
            y = 0.88
            continue
        pages[-1].text(0.035, y, "Sources", fontsize=9, weight="bold")
        pages[-1].text(0.035, y - 0.012, "\n".join(lines[:room]), fontsize=7.5, va="top", linespacing=1.3)
        lines = lines[room:]
        y = 0.0
    return pages


def _band(x: float, y: float, width: float, height: float) -> Rectangle:
    from matplotlib.patches import Rectangle

    return Rectangle((x, y), width, height, facecolor="0.94", edgecolor="none", zorder=-1)


def _cut(text: str, most: int) -> str:
    return literal(text if len(text) <= most else f"{text[: most - 1]}\u2026")


def _wrapped(text: str, width: int, lines: int = 4) -> str:
    return literal("\n".join(textwrap.wrap(text, width, max_lines=lines, placeholder=" \u2026")))


def _hanging(text: str, width: int) -> list[str]:
    return [literal(line) for line in textwrap.wrap(text, width, initial_indent="\u2022 ", subsequent_indent="   ")]
