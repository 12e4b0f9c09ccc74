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

    def box(self, at: Point, size: Point, colour: str, *, rounded: float = 0, width: float = 1.2) -> None:
        """A rectangle by its corner at the top left."""
        self._reach(at, (at[0] + size[0], at[1] + size[1]))
        self._parts.append(
            f'<rect x="{number(at[0])}" y="{number(at[1])}" width="{number(size[0])}" height="{number(size[1])}"'
            f' rx="{number(rounded)}" fill="#fff" stroke="{colour}" stroke-width="{number(width)}"/>'
        )

    @property
    def frame(self) -> tuple[float, float, float, float]:
        """Left, top, right and bottom of all that is drawn."""
        xs, ys = self._xs or [0.0], self._ys or [0.0]
        return min(xs), min(ys), max(xs), max(ys)

    def place(self, other: Canvas, at: Point) -> None:
        """Another drawing, with the top left of its frame at a point."""
        left, top, right, bottom = other.frame
        self._reach(at, (at[0] + right - left, at[1] + bottom - top))
        self._parts += [
            f'<g transform="translate({number(at[0] - left)},{number(at[1] - top)})">',
            *other._parts,
            "</g>",
        ]

    def group(self, at: Point, size: Point, svg: str, colour: str = INK) -> None:
        """Foreign SVG, drawn with its origin at a point."""
        self._reach(at, (at[0] + size[0], at[1] + size[1]))
        self._parts.append(
            f'<g transform="translate({number(at[0])},{number(at[1])})" fill="none" stroke="{colour}"'
            f' stroke-width="1.5" stroke-linejoin="round" stroke-linecap="round">{svg}</g>'
        )

    def document(self, title: str, margin: float = 18) -> str:
        """The whole drawing, on white."""
        left, top, right, bottom = self.frame
        left, top, width, height = left - margin, top - margin, right - left + 2 * margin, bottom - top + 2 * margin
        box = " ".join(number(v) for v in (left, top, width, height))
        lines = "\n".join(self._parts)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" width="{number(width)}" height="{number(height)}"'
            f' font-family="Helvetica, Arial, sans-serif" role="img">\n<title>{escape(title)}</title>\n'
            f'<rect x="{number(left)}" y="{number(top)}" width="{number(width)}" height="{number(height)}"'
            f' fill="#fff"/>\n{lines}\n</svg>\n'
        )


def stacked(frames: Sequence[tuple[str, Canvas]], remarks: Sequence[str] = ()) -> Canvas:
    """Drawings below one another, each but one without a title in a frame, and remarks at the foot."""
    if len(frames) == 1 and not remarks:
        return frames[0][1]
    whole, inset = Canvas(), 16.0
    y = 0.0
    for title, canvas in frames:
        left, top, right, bottom = canvas.frame
        width, height = right - left, bottom - top
        if title:
            words = min(len(title), 150)
            whole.box(
                (0, y), (max(width, 6.5 * words) + 2 * inset, height + 2 * inset + 14), FAINT, rounded=6, width=0.8
            )
            whole.text((inset, y + 17), title, size=12, colour=INK, anchor="start", bold=True)
            whole.place(canvas, (inset, y + inset + 14))
            y += height + 2 * inset + 14 + 24
        else:
            whole.place(canvas, (inset, y))
            y += height + 24
    for remark in remarks:
        whole.text((0, y + 4), remark, colour=ALARM, anchor="start")
        y += 16
    return whole
