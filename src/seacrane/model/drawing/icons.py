"""The iconic diagram as SVG: the symbols of the components, joined by right-angled lines in domain colours."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from html import escape
from typing import Final

from seacrane.model.diagram import Diagram
from seacrane.model.net import End, Net, Node, net
from seacrane.model.ports import Port, PowerPort, SignalIn
from seacrane.model.structure import Symbol

from .arrangement import Item, Wire, arrange
from .canvas import COLOURS, FAINT, INK, Canvas, Point, stacked
from .routing import Router

STUB: Final = 20.0
"""How far a line goes straight on from a port [px]."""

Step = tuple[int, int]


@dataclass(frozen=True)
class Placed:
    """A symbol, and where the ports are on it: the point and the direction that leads away; `named` if they show."""

    symbol: Symbol
    ports: dict[str, tuple[Point, Step]]
    named: bool = False


def icons_svg(diagram: Diagram) -> str:
    """See the module. Diagrams placed in it stay boxes; each that looks different is drawn in a frame below."""
    frames: dict[object, tuple[list[str], Canvas]] = {}

    def add(path: str, inner: Diagram) -> None:
        whole = net(inner, open_up=False)
        likeness = _likeness(whole)
        if likeness in frames:
            frames[likeness][0].append(path)
        else:
            frames[likeness] = ([path], _drawn(whole))
        for name, placed in whole.diagrams.items():
            add(f"{path}.{name}" if path else name, placed)

    add("", diagram)
    sheets = [(", ".join(paths), canvas) for paths, canvas in frames.values()]
    return stacked(sheets).document(f"Diagram of {diagram.name}")


def _likeness(whole: Net) -> object:
    """What a sheet has in common with those that look like it."""
    kinds = tuple((path, type(component), tuple(component.interface())) for path, component in whole.components.items())
    boxes = tuple((path, tuple(inner.interface())) for path, inner in whole.diagrams.items())
    return kinds, boxes, tuple((tuple(end.path for end in node.ends), node.exposed) for node in whole.nodes)


def _drawn(whole: Net) -> Canvas:
    placed: dict[str, Placed] = {}
    for path, component in whole.components.items():
        symbol = component.icon or _box_of(type(component).__name__, component.interface())
        placed[path] = _ports_on(component.interface(), symbol)
    for path, inner in whole.diagrams.items():
        margin = 4.5 * max(map(len, inner.interface())) + 6
        placed[path] = _ports_on(inner.interface(), _box_of(inner.name, inner.interface(), margin), named=True)
    repeated = {path for path, p in placed.items() if p.symbol.repeated}
    attached = [*_attached(whole, repeated)]
    wires = [*_wires(whole, placed, repeated)]
    items = {path: _item(path, p, [a for a in attached if a.end.owner == path]) for path, p in placed.items()}
    items = {path: item for path, item in items.items() if path not in repeated}
    at = arrange(items, wires)
    canvas = Canvas()
    router = Router([item.box_at(at[path], body=True) for path, item in items.items()])
    for path, item in items.items():
        for x0, y0, x1, y1 in item.extras:
            router.block((at[path][0] + x0, at[path][1] + y0, at[path][0] + x1, at[path][1] + y1))
    for wire in wires:
        for owner, (x, y), step in wire.ends:
            router.reserve((at[owner][0] + x, at[owner][1] + y), step)
    ordered = sorted(wires, key=lambda wire: (len(wire.ends), wire.span(at)))
    for wire in ordered:
        _draw_wire(canvas, router, wire, at)
    for a in attached:
        _draw_attached(canvas, a, placed, at)
    for path, item in items.items():
        canvas.group(at[path], (item.width, item.height), placed[path].symbol.svg)
        x, y, anchor = _label_place(placed[path])
        canvas.text((at[path][0] + x, at[path][1] + y), path, size=10, colour=INK, anchor=anchor)
        if placed[path].named:
            _draw_port_names(canvas, placed[path], at[path])
    return canvas


def _draw_port_names(canvas: Canvas, placed: Placed, at: Point) -> None:
    """The names of the ports of a box, inside its rim."""
    for key, ((x, y), (dx, _)) in placed.ports.items():
        anchor = "start" if dx < 0 else "end"
        canvas.text((at[0] + x - 4 * dx, at[1] + y + 3), key, size=8, colour=FAINT, anchor=anchor)


# ---------------------------------------------------------------- symbols and ports
def _box_of(name: str, interface: Mapping[str, Port], margin: float = 0.0) -> Symbol:
    """A box with a name, for what has no icon; `margin` is room for the names of ports at both sides."""
    width = 20.0 * max(3, round((len(name) * 6.5 + 2 * margin) / 20 + 0.5))
    height = 20.0 + 20.0 * max(1, (len(interface) + 1) // 2)
    svg = (
        f'<rect x="0" y="0" width="{width:g}" height="{height:g}"/>'
        f'<text x="{width / 2:g}" y="{height / 2 + 4:g}" font-size="10" text-anchor="middle" fill="currentColor"'
        f' stroke="none">{escape(name)}</text>'
    )
    return Symbol(width, height, svg)


def _ports_on(interface: Mapping[str, Port], symbol: Symbol, *, named: bool = False) -> Placed:
    ports: dict[str, tuple[Point, Step]] = {}
    rest: dict[str, list[str]] = {"left": [], "right": []}
    for key, port in interface.items():
        if key in symbol.ports:
            point = symbol.ports[key]
            ports[key] = (point, _outwards(point, symbol))
        elif isinstance(port, PowerPort):
            rest["left" if len(rest["left"]) <= len(rest["right"]) else "right"].append(key)
        else:
            rest["left" if isinstance(port, SignalIn) else "right"].append(key)
    for side, keys in rest.items():
        x = 0.0 if side == "left" else symbol.width
        taken = {point for point, _ in ports.values()}
        free = [10.0 * i for i in range(1, int(symbol.height // 10)) if (x, 10.0 * i) not in taken] or [10.0]
        for i, key in enumerate(keys):
            y = free[min(len(free) - 1, (2 * i + 1) * len(free) // (2 * len(keys)))]
            ports[key] = ((x, y), (-1 if side == "left" else 1, 0))
    return Placed(symbol, ports, named)


def _outwards(point: Point, symbol: Symbol) -> Step:
    """The direction of the nearest rim."""
    x, y = point
    distances = {(0, -1): y, (0, 1): symbol.height - y, (-1, 0): x, (1, 0): symbol.width - x}
    return min(distances, key=lambda step: distances[step])


def _label_place(placed: Placed) -> tuple[float, float, str]:
    """Where the name goes: on a side without ports."""
    width, height = placed.symbol.width, placed.symbol.height
    taken = {step for _, step in placed.ports.values()}
    if (1, 0) not in taken:
        return width + 5, height / 2 + 4, "start"
    if (0, 1) not in taken:
        return width / 2, height + 12, "middle"
    if (0, -1) not in taken:
        return width / 2, -5, "middle"
    return width + 3, height + 11, "start"


# ---------------------------------------------------------------- what hangs on a port
@dataclass(frozen=True)
class Attached:
    """Something drawn right at a port: the name under which it is exposed, or a symbol of its own (a tank)."""

    end: End
    names: tuple[str, ...] = ()
    tank: str = ""


def _attached(whole: Net, repeated: set[str]) -> Iterator[Attached]:
    for node in whole.nodes:
        ends = [end for end in node.ends if end.owner not in repeated]
        tank = next((end.owner for end in node.ends if end.owner in repeated), None)
        if tank is not None:
            yield from (Attached(end, tank=tank) for end in ends)
        elif node.exposed and ends:
            yield Attached(ends[0], names=node.exposed)


def _item(path: str, placed: Placed, attached: list[Attached]) -> Item:
    width, height = placed.symbol.width, placed.symbol.height
    boxes = []
    x, y, anchor = _label_place(placed)
    words = 6.0 * len(path)
    left = {"start": x, "middle": x - words / 2}[anchor]
    boxes.append((left, y - 9, left + words, y + 3))
    room = []
    hung = {a.end.key for a in attached}
    for key, ((px, py), (dx, dy)) in placed.ports.items():
        if key not in hung:
            tip = (px + STUB * dx, py + STUB * dy)
            room.append((min(px, tip[0]), min(py, tip[1]), max(px, tip[0]), max(py, tip[1])))
    for a in attached:
        (px, py), (dx, dy) = placed.ports[a.end.key]
        if a.tank:
            cx, cy = (px, py + 10) if dy > 0 else (px + 20 * dx, py + 10) if dx else (px + 30, py)
            boxes.append((cx - 14, cy, cx + 14, cy + 22))
        else:
            far = STUB + 6.2 * max(len(name) for name in a.names)
            if dx:
                boxes.append((min(px, px + far * dx), py - 4, max(px, px + far * dx), py + 4))
            else:
                sides = sorted((px - 10 * _aside(placed, a.end.key), px + far * _aside(placed, a.end.key)))
                boxes.append((sides[0], min(py, py + 30 * dy), sides[1], max(py, py + 30 * dy)))
    return Item(width, height, tuple(boxes), tuple(room))


def _draw_attached(canvas: Canvas, a: Attached, placed: dict[str, Placed], at: dict[str, Point]) -> None:
    (px, py), (dx, dy) = placed[a.end.owner].ports[a.end.key]
    x, y = at[a.end.owner][0] + px, at[a.end.owner][1] + py
    port = a.end.port
    colour = COLOURS[port.domain if isinstance(port, PowerPort) else "signal"]
    if a.tank:
        symbol = placed[a.tank].symbol
        (tx, ty), _ = next(iter(placed[a.tank].ports.values()))
        if dy > 0:
            bottom = (x, y + 10)
            canvas.line([(x, y), bottom], colour)
        elif dx:
            bottom = (x + 20 * dx, y + 10)
            canvas.line([(x, y), (bottom[0], y), bottom], colour)
        else:
            bottom = (x + 30, y)
            canvas.line([(x, y), (x, y - 10), (x + 30, y - 10), bottom], colour)
        canvas.group((bottom[0] - tx, bottom[1] - ty), (symbol.width, symbol.height), symbol.svg)
        return
    tip = (x + STUB * dx, y + STUB * dy)
    signal = not isinstance(port, PowerPort)
    canvas.line([(x, y), tip], colour, width=1.0 if signal else 1.8)
    if signal:
        _arrow_head(canvas, *((tip, (x, y)) if isinstance(port, SignalIn) else ((x, y), tip)), colour)
    else:
        canvas.dot(tip, 3, colour)
    for i, name in enumerate(a.names):
        if dx:
            canvas.text(
                (tip[0] + 5 * dx, y + 4 + 11 * i), name, size=10, colour=colour, anchor="start" if dx > 0 else "end"
            )
        else:
            side = _aside(placed[a.end.owner], a.end.key)
            anchor = "start" if side > 0 else "end"
            canvas.text((tip[0] + 5 * side, tip[1] + 4 + 11 * i), name, size=10, colour=colour, anchor=anchor)


def _aside(placed: Placed, key: str) -> int:
    """The side of a line up or down on which its name goes: right (1), or left (-1) if a port beside it is there."""
    (x, _), step = placed.ports[key]
    return -1 if any(s == step and x < px <= x + 60 for (px, _), s in placed.ports.values()) else 1


def _arrow_head(canvas: Canvas, tail: Point, head: Point, colour: str) -> None:
    dx, dy = head[0] - tail[0], head[1] - tail[1]
    length = max((dx * dx + dy * dy) ** 0.5, 1e-9)
    ux, uy = dx / length, dy / length
    canvas.line(
        [
            (head[0] - 7 * ux + 3 * uy, head[1] - 7 * uy - 3 * ux),
            head,
            (head[0] - 7 * ux - 3 * uy, head[1] - 7 * uy + 3 * ux),
        ],
        colour,
        width=1.0,
    )


# ---------------------------------------------------------------- lines
def _wires(whole: Net, placed: dict[str, Placed], repeated: set[str]) -> Iterator[Wire]:
    for node in whole.nodes:
        if any(end.owner in repeated for end in node.ends) or len(node.ends) < 2:
            continue
        ends = tuple((end.owner, *placed[end.owner].ports[end.key]) for end in node.ends)
        yield Wire(ends, _domain(node), tuple(isinstance(end.port, SignalIn) for end in node.ends))


def _domain(node: Node) -> str:
    port = node.ends[0].port
    return port.domain if isinstance(port, PowerPort) else "signal"


def _draw_wire(canvas: Canvas, router: Router, wire: Wire, at: dict[str, Point]) -> None:
    colour = COLOURS[wire.domain]
    width = 1.0 if wire.domain == "signal" else 1.8
    ends = [((at[owner][0] + x, at[owner][1] + y), step) for owner, (x, y), step in wire.ends]
    paths, joints = router.tree(ends)
    for path in paths:
        canvas.line(path, colour, width=width)
    for joint in joints:
        canvas.dot(joint, 3 if wire.domain != "signal" else 2, colour)
    if wire.domain == "signal":
        for (point, (dx, dy)), takes in zip(ends, wire.takes, strict=True):
            if takes:
                _arrow_head(canvas, (point[0] + STUB * dx, point[1] + STUB * dy), point, colour)
