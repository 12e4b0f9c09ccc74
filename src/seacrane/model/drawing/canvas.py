"""An SVG document in the making: shapes in the colours of the domains."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Final

COLOURS: Final = {
    "hydraulic": "#b3261e",
    "translational": "#1f5f8b",
    "rotational": "#1b7a4b",
    "signal": "#6b6b6b",
    "": "#333333",
}
"""Line colour by domain."""

INK: Final = "#1a1a1a"
FAINT: Final = "#6f6f6f"
ALARM: Final = "#d98200"

Point = tuple[float, float]


def number(value: float) -> str:
    """A coordinate with at most one decimal."""
    return f"{round(value, 1):g}"


class Canvas:
    """Collects shapes; `document` puts them in a frame that holds all of them."""

    def __init__(self) -> None:
        self._parts: list[str] = []
        self._xs: list[float] = []
        self._ys: list[float] = []

    def _reach(self, *points: Point) -> None:
        self._xs += [x for x, _ in points]
        self._ys += [y for _, y in points]

    def line(self, points: Sequence[Point], colour: str, *, width: float = 1.6, dash: str = "") -> None:
        self._reach(*points)
        path = " ".join(f"{number(x)},{number(y)}" for x, y in points)
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self._parts.append(
            f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{number(width)}"'
            f' stroke-linejoin="round" stroke-linecap="round"{dashed}/>'
        )

    def dot(self, at: Point, radius: float, colour: str) -> None:
        self._reach(at)
        self._parts.append(f'<circle cx="{number(at[0])}" cy="{number(at[1])}" r="{number(radius)}" fill="{colour}"/>')

    def text(
        self, at: Point, words: str, *, size: float = 11, colour: str = INK, anchor: str = "middle", bold: bool = False
    ) -> None:
        """Words with their middle (or start, or end) at a point of the baseline, on a halo that keeps them legible."""
        half = 0.3 * size * len(words)
        shift = {"middle": 0.0, "start": half, "end": -half}[anchor]
        self._reach((at[0] + shift - half, at[1] - size), (at[0] + shift + half, at[1] + 3))
        weight = ' font-weight="600"' if bold else ""
        self._parts.append(
            f'<text x="{number(at[0])}" y="{number(at[1])}" font-size="{number(size)}" text-anchor="{anchor}"'
            f' fill="{colour}" stroke="#fff" stroke-width="3" paint-order="stroke"{weight}>{escape(words)}</text>'
        )

    def group(self, at: Point, size: Point, svg: str, colour: str = INK) -> None:
        """Foreign SVG, drawn with its origin at a point."""
        self._reach(at, (at[0] + size[0], at[1] + size[1]))
        self._parts.append(
            f'<g transform="translate({number(at[0])},{number(at[1])})" fill="none" stroke="{colour}"'
            f' stroke-width="1.5" stroke-linejoin="round" stroke-linecap="round">{svg}</g>'
        )

    def document(self, title: str, margin: float = 18) -> str:
        """The whole drawing, on white."""
        xs, ys = self._xs or [0.0], self._ys or [0.0]
        left, top = min(xs) - margin, min(ys) - margin
        width, height = max(xs) - left + margin, max(ys) - top + margin
        box = " ".join(number(v) for v in (left, top, width, height))
        lines = "\n".join(self._parts)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" width="{number(width)}" height="{number(height)}"'
            f' font-family="Helvetica, Arial, sans-serif" role="img">\n<title>{escape(title)}</title>\n'
            f'<rect x="{number(left)}" y="{number(top)}" width="{number(width)}" height="{number(height)}"'
            f' fill="#fff"/>\n{lines}\n</svg>\n'
        )
