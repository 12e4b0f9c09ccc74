"""The icons of the library: hydraulics in the manner of ISO 1219-1, the usual signs of mechanics and signals.

Drawn on a grid of 10 px; ports are on grid points of the rim. Lines take the colour of the drawing.
"""

from __future__ import annotations

from seacrane.model import Symbol

_FILLED = 'fill="currentColor" stroke="none"'
_DASHED = 'stroke-dasharray="4 3"'


def _path(d: str, style: str = "") -> str:
    return f'<path d="{d}" {style}/>' if style else f'<path d="{d}"/>'


def _box(x: float, y: float, width: float, height: float, style: str = "") -> str:
    return f'<rect x="{x}" y="{y}" width="{width}" height="{height}" {style}/>'


def _circle(x: float, y: float, radius: float, style: str = "") -> str:
    return f'<circle cx="{x}" cy="{y}" r="{radius}" {style}/>'


def _word(x: float, y: float, words: str, size: float = 12) -> str:
    return f'<text x="{x}" y="{y}" font-size="{size}" text-anchor="middle" {_FILLED}>{words}</text>'


def _arrow(x0: float, y0: float, x1: float, y1: float) -> str:
    """A line with a small filled head."""
    length = ((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5
    ux, uy = (x1 - x0) / length, (y1 - y0) / length
    bx, by = x1 - 7 * ux, y1 - 7 * uy
    head = f"M{x1} {y1} L{bx - 3 * uy:.1f} {by + 3 * ux:.1f} L{bx + 3 * uy:.1f} {by - 3 * ux:.1f} Z"
    return _path(f"M{x0} {y0} L{bx:.1f} {by:.1f}") + _path(head, _FILLED)


def _spring(x: float, y: float, length: float) -> str:
    """A zigzag to the right, 8 px high, around the line y."""
    step = length / 6
    points = " ".join(f"L{x + step * (i + 0.5):.1f} {y + (4 if i % 2 else -4)}" for i in range(6))
    return _path(f"M{x} {y} {points} L{x + length} {y}")


_ADJUSTABLE = _arrow(6, 38, 36, 4)
_UP = _path("M20 4 L14 14 L26 14 Z", _FILLED)
_DOWN = _path("M20 14 L14 4 L26 4 Z", _FILLED)

# ---------------------------------------------------------------- hydraulics: sources
_CIRCLE = _circle(20, 20, 16) + _path("M20 0 V4")
PUMP_FIXED = Symbol(40, 40, _CIRCLE + _UP, {"p": (20, 0)})
PUMP_CONSTANT_PRESSURE = Symbol(40, 40, _CIRCLE + _UP + _ADJUSTABLE, {"p": (20, 0)})
PRESSURE_SOURCE = Symbol(40, 40, _CIRCLE + _UP + _word(20, 29, "p"), {"p": (20, 0)})
FLOW_SOURCE = Symbol(40, 40, _CIRCLE + _UP + _word(20, 29, "q"), {"p": (20, 0)})
TANK = Symbol(40, 20, _path("M7 6 V18 H33 V6 M20 0 V12"), {"p": (20, 0)}, repeated=True)
PLUG = Symbol(20, 20, _path("M10 0 V10 M4 10 H16"), {"a": (10, 0)})

PUMP_PRESSURE_CONTROLLED = Symbol(40, 40, _CIRCLE + _UP + _ADJUSTABLE + _word(20, 30, "p", 9), {"p": (20, 0)})
PUMP_VARIABLE = Symbol(40, 40, _CIRCLE + _UP + _ADJUSTABLE, {"p": (20, 0), "gain": (0, 20)})
PUMP_LOAD_SENSING = Symbol(
    50, 40, _CIRCLE + _UP + _ADJUSTABLE + _path("M50 30 H33", _DASHED), {"p": (20, 0), "ls": (50, 30)}
)
PUMP_SHAFT = Symbol(
    50,
    40,
    _CIRCLE + _UP + _ADJUSTABLE + _path("M20 36 V40 M36 18 H50 M36 22 H50"),
    {"p": (20, 0), "s": (20, 40), "shaft": (50, 20)},
)

# ---------------------------------------------------------------- hydraulics: lines
_EDGE = _path("M0 20 H40 M10 10 Q20 18 30 10 M10 30 Q20 22 30 30")
_ENDS = {"a": (0.0, 20.0), "b": (40.0, 20.0)}
ORIFICE = Symbol(40, 40, _EDGE, _ENDS)
VARIABLE_ORIFICE = Symbol(40, 40, _EDGE + _arrow(10, 38, 32, 4), {**_ENDS, "k": (20, 0)})
VOLUME = Symbol(40, 30, _path("M20 24 V30") + _box(2, 4, 36, 20, 'rx="10"'), {"a": (20, 30)})
PIPE = Symbol(60, 40, _path("M0 20 H60 M12 14 H48 M12 26 H48"), {"a": (0, 20), "b": (60, 20)})
HOSE = Symbol(60, 40, _path("M0 20 H6 Q30 44 54 20 H60") + _circle(6, 20, 2) + _circle(54, 20, 2), PIPE.ports)
COLUMN = Symbol(40, 40, _path("M10 4 V34 H30 V4 M10 12 H30 M20 34 V40"), {"a": (20, 40)})
OPEN_TANK = Symbol(40, 30, _path("M4 6 V24 H36 V6 M20 24 V30"), {"a": (20, 30)})
ACCUMULATOR = Symbol(
    40,
    50,
    _box(10, 2, 20, 40, 'rx="10"') + _path("M10 22 H30 M20 42 V50") + _path("M16 10 H24 L20 17 Z"),
    {"a": (20, 50)},
)
FILTER = Symbol(40, 40, _path("M0 20 H4 M36 20 H40 M20 4 L36 20 L20 36 L4 20 Z") + _path("M20 4 V36", _DASHED), _ENDS)
FLOW_DIVIDER = Symbol(
    60,
    40,
    _circle(18, 20, 12) + _circle(42, 20, 12) + _path("M30 18 V22 M20 0 V8 M40 0 V8 M20 32 V36 H40 V32 M30 36 V40"),
    {"a": (30, 40), "b": (20, 0), "c": (40, 0)},
)
SHUTTLE_VALVE = Symbol(
    60,
    40,
    _box(10, 10, 40, 20) + _circle(20, 20, 5) + _path("M0 20 H15 M45 15 L50 20 L45 25 M50 20 H60 M30 10 V0"),
    {"a": (0, 20), "b": (60, 20), "c": (30, 0)},
)

# ---------------------------------------------------------------- hydraulics: valves
_CHECK = (
    _path("M20 40 V29 M20 0 V8 M12 20 L20 29 L28 20") + _circle(20, 20, 6) + _path("M20 14 l-4 -1.5 l8 -2 l-4 -2.5")
)
CHECK_VALVE = Symbol(40, 40, _CHECK, {"a": (20, 40), "b": (20, 0)})
ANTICAVITATION_VALVE = Symbol(40, 40, _CHECK, {"t": (20, 40), "a": (20, 0)})
_RELIEF = (
    _box(10, 10, 30, 30)
    + _path("M20 0 V10 M20 40 V50")
    + _arrow(27, 10, 27, 40)
    + _spring(40, 25, 18)
    + _path("M20 5 H4 V25 H10", _DASHED)
    + _arrow(45, 35, 53, 15)
)
RELIEF_VALVE = Symbol(60, 50, _RELIEF, {"a": (20, 0), "b": (20, 50)})
_INLET = _box(10, 10, 30, 30) + _path("M20 0 V10 M20 40 V50") + _spring(40, 25, 18)
PRESSURE_REDUCING_VALVE = Symbol(
    60, 50, _INLET + _arrow(27, 10, 27, 40) + _path("M20 45 H4 V25 H10", _DASHED), {"a": (20, 0), "b": (20, 50)}
)
PRESSURE_COMPENSATOR = Symbol(
    60,
    50,
    _INLET + _arrow(27, 10, 27, 40) + _path("M0 20 H10 M60 40 H46 V36 H40", _DASHED),
    {"a": (20, 0), "b": (20, 50), "s": (0, 20), "ls": (60, 40)},
)
PILOT_OPERATED_CHECK_VALVE = Symbol(
    40, 40, _CHECK + _path("M0 30 H15", _DASHED), {"a": (20, 40), "b": (20, 0), "pilot": (0, 30)}
)
_COUNTERBALANCE = (
    _box(2, 4, 106, 52, 'stroke-dasharray="8 3 2 3"')
    + _box(20, 16, 28, 28)
    + _arrow(41, 16, 41, 44)
    + _path("M30 0 V16 M30 44 V60 M30 9 H85 V21 M85 37 V51 H30")
    + _path("M77 37 L85 30 L93 37 M77 37")
    + _circle(85, 27, 6)
    + _spring(48, 24, 14)
    + _path("M0 30 H20", _DASHED)
    + _path("M30 12 H10 V22 H20", _DASHED)
)
COUNTERBALANCE_VALVE = Symbol(110, 60, _COUNTERBALANCE, {"a": (30, 60), "b": (30, 0), "pilot": (0, 30)})


def _solenoid(x: float) -> str:
    return _box(x, 15, 20, 20) + _path(f"M{x + 4} 35 L{x + 16} 15")


_DIRECTIONAL = (
    _box(40, 5, 120, 40)
    + _path("M80 5 V45 M120 5 V45")
    # left: p to a, b to t; right: crossed; centre: closed
    + _arrow(50, 45, 50, 5)
    + _arrow(70, 5, 70, 45)
    + _arrow(130, 45, 150, 5)
    + _arrow(130, 5, 150, 45)
    + _path("M90 5 V13 M86 13 H94 M110 5 V13 M106 13 H114 M90 45 V37 M86 37 H94 M110 45 V37 M106 37 H114")
    + _path("M90 0 V5 M110 0 V5 M90 45 V50 M110 45 V50")
    + _solenoid(20)
    + _solenoid(160)
    + _spring(0, 25, 20)
    + _spring(180, 25, 20)
    + _path("M40 1 H160 M40 49 H160", 'stroke-width="0.8"')
    + _word(84, -2, "A", 8)
    + _word(116, -2, "B", 8)
    + _word(84, 58, "P", 8)
    + _word(116, 58, "T", 8)
)
DIRECTIONAL_VALVE_43 = Symbol(
    200, 50, _DIRECTIONAL, {"a": (90, 0), "b": (110, 0), "p": (90, 50), "t": (110, 50), "x": (0, 20)}
)

_TWO_WAY = (
    _box(20, 5, 80, 40)
    + _path("M60 5 V45 M50 0 V5 M50 45 V50")
    + _path("M50 5 V13 M46 13 H54 M50 45 V37 M46 37 H54")
    + _arrow(80, 45, 80, 5)
    + _box(0, 15, 20, 20)
    + _path("M4 35 L16 15")
    + _spring(100, 25, 20)
)
DIRECTIONAL_VALVE_22 = Symbol(120, 50, _TWO_WAY, {"a": (50, 0), "p": (50, 50), "on": (0, 20)})
_FOUR_WAY = (
    _box(20, 5, 80, 40)
    + _path("M60 5 V45 M30 0 V5 M50 0 V5 M30 45 V50 M50 45 V50")
    + _path("M30 5 V13 M26 13 H34 M50 5 V13 M46 13 H54 M30 45 V37 M26 37 H34 M50 45 V37 M46 37 H54")
    + _arrow(70, 45, 70, 5)
    + _arrow(90, 5, 90, 45)
    + _box(0, 15, 20, 20)
    + _path("M4 35 L16 15")
    + _spring(100, 25, 20)
)
FOUR_PORT_DIRECTIONAL_VALVE_22 = Symbol(
    120, 50, _FOUR_WAY, {"a": (30, 0), "b": (50, 0), "p": (30, 50), "t": (50, 50), "on": (0, 20)}
)

# ---------------------------------------------------------------- hydraulics: actuators
_CYLINDER = (
    _box(0, 4, 110, 32)
    + _path("M10 36 V50 M100 36 V50")
    + _box(36, 4, 8, 32, 'fill="currentColor" fill-opacity="0.15"')
    + _path("M44 17 H140 M44 23 H140 M140 14 V26")
)
DOUBLE_ACTING_CYLINDER = Symbol(140, 50, _CYLINDER, {"a": (10, 50), "b": (100, 50), "rod": (140, 20)})
_MOTOR = _circle(20, 20, 16) + _path("M20 0 V4 M20 36 V40 M36 18 H50 M36 22 H50")
MOTOR = Symbol(
    50, 40, _MOTOR + _DOWN + _path("M20 26 L14 36 L26 36 Z", _FILLED), {"a": (20, 0), "b": (20, 40), "shaft": (50, 20)}
)
VARIABLE_MOTOR = Symbol(50, 40, MOTOR.svg + _ADJUSTABLE, {**MOTOR.ports, "r": (0, 20)})
_PLUNGER = (
    _box(0, 4, 110, 32)
    + _path("M10 36 V50 M100 36 V42")
    + _box(36, 4, 8, 32, 'fill="currentColor" fill-opacity="0.15"')
    + _path("M44 17 H140 M44 23 H140 M140 14 V26")
)
SINGLE_ACTING_CYLINDER = Symbol(140, 50, _PLUNGER, {"a": (10, 50), "rod": (140, 20)})

PRESSURE_SWITCH = Symbol(
    60,
    40,
    _box(0, 4, 60, 32) + _path("M30 40 V30 M24 14 L36 26") + _spring(4, 20, 18) + _path("M38 10 H60 M38 30 H60"),
    {"p": (30, 40), "above": (60, 10), "below": (60, 30)},
)

# ---------------------------------------------------------------- mechanics
_GROUND = "M{0} {1} h24 m-20 0 l-5 6 m11 -6 l-5 6 m11 -6 l-5 6 m11 -6 l-5 6"
MASS = Symbol(50, 40, _path("M0 20 H8") + _box(8, 4, 42, 32) + _word(29, 25, "m"), {"flange": (0, 20)})
INERTIA = Symbol(
    40, 40, _path("M0 18 H12 M0 22 H12") + _box(12, 2, 16, 36) + _word(20, 24, "J", 11), {"flange": (0, 20)}
)
_PARALLEL = _path("M0 20 H10 M10 8 V32 M50 8 V32 M50 20 H60 M10 10 H14 M46 10 H50") + _spring(14, 10, 32)
_DASHPOT = _path("M10 30 H28 M28 25 V35 M22 23 H36 V37 H22 M36 30 H50")
SPRING_DAMPER = Symbol(60, 40, _PARALLEL + _DASHPOT, {"a": (0, 20), "b": (60, 20)})
TORSIONAL_SPRING_DAMPER = Symbol(
    60, 40, _PARALLEL + _DASHPOT + _path("M24 2 a14 6 0 0 1 14 0 l-1 -4 m1 4 l-5 1"), {"a": (0, 20), "b": (60, 20)}
)
_ENDS_60 = {"a": (0.0, 20.0), "b": (60.0, 20.0)}
SPRING = Symbol(60, 40, _path("M0 20 H12") + _spring(12, 20, 36) + _path("M48 20 H60"), _ENDS_60)
DAMPER = Symbol(60, 40, _path("M0 20 H28 M28 15 V25 M20 11 H38 V29 H20 M38 20 H60"), _ENDS_60)
ROPE_SPRING = Symbol(60, 40, _path("M0 20 Q6 26 12 20") + _spring(12, 20, 36) + _path("M48 20 Q54 26 60 20"), _ENDS_60)
END_STOP = Symbol(
    60, 40, _path("M0 20 H20 M20 8 V32 M28 8 V32") + _spring(28, 20, 22) + _path("M50 8 V32 M50 20 H60"), _ENDS_60
)
ELECTRIC_MOTOR = Symbol(
    50,
    40,
    _circle(20, 20, 16) + _word(20, 19, "M") + _word(20, 31, "3~", 10) + _path("M36 18 H50 M36 22 H50"),
    {"shaft": (50, 20)},
)
FRICTION = Symbol(
    40, 40, _path("M0 18 H34 M0 22 H34 M8 12 H30 M8 28 H30") + _path(_GROUND.format(8, 29)), {"flange": (0, 20)}
)
HOLDING_BRAKE = Symbol(
    40,
    50,
    _path("M0 28 H26 M0 32 H26")
    + _box(14, 14, 6, 32)
    + _path("M8 22 H12 V38 H8 M26 22 H22 V38 H26 M17 0 V6 M10 6 H24")
    + _path(_GROUND.format(14, 46), 'stroke-width="0.8"'),
    {"shaft": (0, 30), "release": (20, 0)},
)
GEAR = Symbol(
    60, 60, _path("M0 20 H20 M40 40 H60") + _box(20, 12, 20, 16) + _box(20, 28, 20, 28), {"a": (0, 20), "b": (60, 40)}
)
WINCH_DRUM = Symbol(
    80,
    50,
    _path("M0 18 H12 M0 22 H12")
    + _box(12, 0, 6, 40)
    + _box(54, 0, 6, 40)
    + _box(18, 8, 36, 24)
    + _path("M24 8 V32 M30 8 V32 M36 8 V32 M42 8 V32 M48 8 V32", 'stroke-width="1"')
    + _path("M48 10 H80"),
    {"shaft": (0, 20), "rope": (80, 10)},
)


def _boundary(letter: str, *signals: str) -> Symbol:
    """What a partner imposes, at the rim of the drive; its signals come and go on the far side."""
    svg = _box(10, 2, 50, 46, 'rx="6"') + _word(32, 26, letter, 14) + _path("M0 20 H10 M4 15 L10 20 L4 25")
    ports = {name: (60.0, 10.0 * (i + 1)) for i, name in enumerate(signals)}
    return Symbol(60, 50, svg, {"flange": (0, 20), **ports})


MOTION_INPUT = _boundary("v", "v", "x", "F", "work")
SPEED_INPUT = _boundary("ω", "w", "T", "work")
FORCE_INPUT = _boundary("F", "F", "v", "x", "work")
TORQUE_INPUT = _boundary("T", "T", "w", "work")


# ---------------------------------------------------------------- signals
def _block(inside: str) -> Symbol:
    return Symbol(50, 40, _box(0, 0, 50, 40) + inside)


_AXES = _path("M10 34 V6 M6 30 H44", 'stroke-width="0.7"')
CONSTANT = _block(_AXES + _path("M10 14 H42"))
SINE = _block(_AXES + _path("M10 20 q8 -20 16 0 t16 0"))
STEP = _block(_AXES + _path("M10 30 H22 V12 H42"))
RAMP = _block(_AXES + _path("M10 30 H18 L42 10"))
JOYSTICK = _block(_path("M12 34 H38 M25 34 L34 10") + _circle(35, 8, 4, _FILLED) + _path("M12 16 A 16 16 0 0 1 22 10"))
RECORDED = _block(_AXES + _path("M10 26 l6 -8 l5 5 l6 -12 l6 9 l8 -4"))
GAIN = Symbol(50, 40, _path("M4 2 V38 L50 20 Z M0 20 H4") + _word(19, 25, "K"))
SUM = Symbol(40, 40, _circle(20, 20, 20) + _word(20, 26, "Σ", 18))
TABLE = _block(_AXES + _path("M10 30 L20 24 L28 10 L42 8"))
SATURATION = _block(_path("M25 4 V36 M6 20 H44", 'stroke-width="0.7"') + _path("M8 32 H16 L34 8 H42"))
DEAD_BAND = _block(_path("M25 4 V36 M6 20 H44", 'stroke-width="0.7"') + _path("M8 34 L18 20 H32 L42 6"))
RELAY = _block(_AXES + _path("M10 30 H34 M18 30 V12 H42 M34 30 V12"))
RATE_LIMIT = _block(_AXES + _path("M10 30 L34 10 H42") + _word(36, 28, "max", 9))
FIRST_ORDER_LAG = _block(_AXES + _path("M10 30 Q16 11 42 10"))
SECOND_ORDER_LAG = _block(_AXES + _path("M10 30 C16 -6 24 4 28 12 S36 12 42 11"))
CONTROLLER = _block(_word(25, 25, "PID", 14))
