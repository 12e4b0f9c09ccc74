"""What a person sees of an FMU: HTML documentation made from the model, and an icon as SVG and PNG."""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterable, Sequence
from html import escape
from typing import Final

import seacrane
from seacrane.fmi.terminals import Terminal
from seacrane.model.codegen import SETTINGS
from seacrane.model.dae import Dae, Variable
from seacrane.units import UNITS

DRAWING: Final = "drawing.svg"
"""The drawing of the diagram beside the page. FMI has diagram.svg only together with diagram.png."""

_STYLE: Final = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#1c2430}"
    "table{border-collapse:collapse;width:100%;margin:.5rem 0 1.5rem}th,td{text-align:left;padding:.2rem .6rem;"
    "border-bottom:1px solid #d5dbe3}td.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}"
    "code{font-family:ui-monospace,monospace}img{max-width:100%}"
)


def page(dae: Dae, terminals: Sequence[Terminal], diagram: bool) -> str:
    """documentation/index.html: what goes in and out, parameters with their ranges, states, and sources of the laws.

    Numbers are in the units in which they are shown. With `diagram`, the page shows the drawing that lies beside it.
    """
    title = escape(dae.name)
    parts = [
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{title}</title>\n'
        f"<style>{_STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>"
    ]
    if dae.about:
        parts.append(f"<p>{escape(dae.about)}</p>")
    if diagram:
        parts.append(f'<p><img src="{DRAWING}" alt="Diagram of {title}"></p>')
    parts += _table("Inputs", dae.inputs, start="default")
    parts += _table("Outputs", dae.outputs)
    if terminals:
        rows = (
            f"<tr><td><code>{escape(t.bond.name)}</code></td><td>{t.domain}</td>"
            f"<td><code>{escape(t.bond.across)}</code>, <code>{escape(t.bond.through)}</code></td>"
            f"<td>{'into' if t.bond.inward else 'out of'} the model</td></tr>"
            for t in terminals
        )
        parts += ["<h2>Power bonds</h2>", "<p>The product of the two variables is power.</p>"]
        heads = "".join(f"<th>{head}</th>" for head in ("name", "domain", "variables", "positive power"))
        parts += [f"<table><tr>{heads}</tr>", *rows, "</table>"]
    parts += _table("Parameters", dae.parameters, start="default")
    parts += _table("Solver", SETTINGS, start="default")
    parts += _table("States", dae.states, start="start")
    parts += _table("Modes, which events change", dae.modes, start="start")
    parts += _table("Unknowns of the algebraic equations", dae.algebraics, start="first guess")
    parts += _table("Other variables", dae.observables)
    if dae.sources:
        parts += ["<h2>Sources</h2>", "<ul>", *(f"<li>{escape(text)}</li>" for text in dae.sources), "</ul>"]
    parts.append(f"<p>Made with seacrane {escape(seacrane.__version__)}.</p>\n</body>\n</html>")
    return "\n".join(parts) + "\n"


def _table(title: str, variables: Iterable[Variable], start: str = "") -> list[str]:
    rows = []
    for v in variables:
        unit = v.display_unit
        cells = [f"<td><code>{escape(v.name)}</code></td>"]
        if start:
            cells.append(f'<td class="n">{_shown(v.start, v)}</td>')
        cells.append(f"<td>{escape('' if unit == '1' else unit)}</td>")
        if start:
            cells.append(f"<td>{_range(v)}</td>")
        cells.append(f"<td>{escape(v.about)}</td>")
        rows.append(f"<tr>{''.join(cells)}</tr>")
    if not rows:
        return []
    head = ["name", *([start] if start else []), "unit", *(["range"] if start else []), "meaning"]
    heads = "".join(f"<th>{h}</th>" for h in head)
    return [f"<h2>{title}</h2>", f"<table><tr>{heads}</tr>", *rows, "</table>"]


def _shown(value: float, v: Variable) -> str:
    return f"{value * UNITS[v.unit].factor / UNITS[v.display_unit].factor:.6g}"


def _range(v: Variable) -> str:
    if math.isinf(v.minimum) and math.isinf(v.maximum):
        return ""
    if math.isinf(v.maximum):
        return f"at least {_shown(v.minimum, v)}"
    if math.isinf(v.minimum):
        return f"at most {_shown(v.maximum, v)}"
    return f"{_shown(v.minimum, v)} to {_shown(v.maximum, v)}"


_SIDE: Final = 200
_COLOURS: Final = {"hydraulic": "#c0392b", "translational": "#2c7a4b", "rotational": "#8e5bb0"}
_SIGNAL: Final = "#2b5fa8"


def _marks(count: int) -> list[float]:
    """Where that many ports sit along a side."""
    return [_SIDE * (i + 1) / (count + 1) for i in range(count)]


def _ports(dae: Dae, terminals: Sequence[Terminal]) -> list[tuple[float, float, str]]:
    """Position and colour of each port: signals in on the left, signals out on the right, power bonds below."""
    bonded = {name for t in terminals for name in (t.bond.across, t.bond.through)}
    given = [v for v in dae.inputs if v.name not in bonded]
    found = [v for v in dae.outputs if v.name not in bonded]
    ports = [(6.0, y, _SIGNAL) for y in _marks(len(given))]
    ports += [(_SIDE - 6.0, y, _SIGNAL) for y in _marks(len(found))]
    ports += [(x, _SIDE - 6.0, _COLOURS[t.domain]) for x, t in zip(_marks(len(terminals)), terminals, strict=True)]
    return ports


def icon_svg(dae: Dae, terminals: Sequence[Terminal]) -> str:
    """A block with the name of the model and a mark for each port, in the colour of its domain."""
    marks = "".join(
        f'<rect x="{x - 5:.4g}" y="{y - 5:.4g}" width="10" height="10" fill="{colour}"/>'
        for x, y, colour in _ports(dae, terminals)
    )
    size = min(26.0, 1.6 * (_SIDE - 30) / max(1, len(dae.name)))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_SIDE} {_SIDE}" width="{_SIDE}" height="{_SIDE}">'
        f'<rect x="6" y="6" width="{_SIDE - 12}" height="{_SIDE - 12}" rx="6" fill="#f6f8fb" stroke="#33415c"'
        f' stroke-width="3"/>{marks}<text x="{_SIDE // 2}" y="{_SIDE // 2}" text-anchor="middle"'
        f' dominant-baseline="middle" font-family="sans-serif" font-size="{size:.4g}" fill="#1c2430">'
        f"{escape(dae.name)}</text></svg>\n"
    )


def icon_png(dae: Dae, terminals: Sequence[Terminal]) -> bytes:
    """The same block without its name, for tools that show no SVG."""
    rows = [bytearray(b"\xff\xff\xff\x00" * _SIDE) for _ in range(_SIDE)]

    def fill(x1: float, y1: float, x2: float, y2: float, colour: str) -> None:
        pixel = bytes.fromhex(colour[1:]) + b"\xff"
        for y in range(max(0, round(y1)), min(_SIDE, round(y2))):
            rows[y][4 * round(x1) : 4 * round(x2)] = pixel * (round(x2) - round(x1))

    fill(5, 5, _SIDE - 5, _SIDE - 5, "#33415c")
    fill(8, 8, _SIDE - 8, _SIDE - 8, "#f6f8fb")
    for x, y, colour in _ports(dae, terminals):
        fill(x - 5, y - 5, x + 5, y + 5, colour)
    data = zlib.compress(b"".join(b"\0" + row for row in rows), 9)
    head = struct.pack(">IIBBBBB", _SIDE, _SIDE, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", head) + _chunk(b"IDAT", data) + _chunk(b"IEND", b"")


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
