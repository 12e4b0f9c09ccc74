"""Printed equations: they say what is computed, and they can be read."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from seacrane.library import hydraulics as hyd
from seacrane.model import Diagram, load
from seacrane.model.expressions import Reader, latex, text
from seacrane.numerics.regularise import limit, maximum, minimum, positive_part, signed_sqrt, smooth_limit, smooth_sign
from seacrane.units import bar, l, mm

BOOM_DRIVE = Path(__file__).parents[3] / "examples" / "boom_drive.json"
a, b, c = (ca.SX.sym(name) for name in "abc")

EXPRESSIONS = [
    a + b * c,
    (a + b) * c,
    a - (b - c),
    a - b + c,
    a / (b / c),
    a / (b * c),
    -(a + b) * c,
    -(a**2),
    (-a) ** 2,
    a ** (b**2),
    (b**2) ** c,
    2 * a + 1 / b,
    ca.exp(-a / b) * ca.sin(c),
    minimum(a, b),
    maximum(a - b, c),
    maximum(-a, 0.0),
    limit(a, -b, c),
    signed_sqrt(a, b),
    smooth_sign(a - c, b),
    positive_part(a - b, 0.01),
    smooth_limit(a, 0.0, 1.0, 0.01),
    math.pi / 4 * a**2 - 3 * math.pi * b,
    a / (math.pi / 4 * b**2),
    a / (math.pi / 4),
    ca.if_else(a > b, c, a),
    ca.fmin(a, ca.fabs(b)),
    ca.SX(0),
    ca.SX(-2.5) * a - 1e-12,
]

CALLS: dict[str, Any] = {name: getattr(math, name) for name in ("sin", "cos", "exp", "sqrt", "log", "tanh")} | {
    "min": min,
    "max": max,
    "abs": abs,
    "pi": math.pi,
    "when": lambda x, y: y if x else 0.0,
}


def value(words: str, names: dict[str, float]) -> float:
    return float(eval(words.replace("^", "**"), {"__builtins__": {}}, {**CALLS, "not": None, **names}))


@pytest.mark.parametrize("expression", EXPRESSIONS, ids=str)
def test_the_text_has_the_value_of_the_expression(expression: Any) -> None:
    reader = Reader([expression])
    words = text(reader, reader.roots[0], {}).replace("not(", "1 - (")
    function = ca.Function("f", [a, b, c], [expression])
    for point in np.random.default_rng(2).uniform(0.1, 2.0, (5, 3)):
        expected = float(function(*point))
        assert value(words, dict(zip("abc", point, strict=True))) == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (minimum(a, b), "min(a, b)"),
        (maximum(a, 0.0), "max(a, 0)"),
        (maximum(-a, 0.0), "max(-a, 0)"),
        (limit(a, -1.0, 1.0), "min(max(a, -1), 1)"),
        (math.pi / 4 * a**2, "pi/4 * a^2"),
        (a - (b - c), "a - (b - c)"),
    ],
)
def test_an_expression_reads_as_it_was_meant(expression: Any, expected: str) -> None:
    reader = Reader([expression])
    assert text(reader, reader.roots[0], {}) == expected


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        (a / (b + c), r"\frac{a}{b + c}"),
        (ca.sqrt(a) * (b + c), r"\sqrt{a} \, \left(b + c\right)"),
        (2 * a**2, r"2 \, a^{2}"),
        (1e-12 * a, r"1 \cdot 10^{-12} \, a"),
    ],
)
def test_latex_formulas(expression: Any, expected: str) -> None:
    reader = Reader([expression])
    assert latex(reader, reader.roots[0], {}) == expected


def test_what_occurs_twice_is_named_once() -> None:
    part = ca.sqrt(a * a + b * c)
    reader = Reader([part * a, part * b])
    names = {node: f"s{i}" for i, node in enumerate(reader.named(), start=1)}
    assert [text(reader, root, names) for root in reader.roots] == ["s1 * a", "s1 * b"]
    assert [text(reader, node, names, whole=True) for node in names] == ["sqrt(a^2 + b * c)"]


def filling() -> Diagram:
    diagram = Diagram("filling")
    pump = diagram.add("pump", hyd.ConstantPressurePump(pressure=210 * bar))
    edge = diagram.add("edge", hyd.Orifice(diameter=3 * mm))
    volume = diagram.add("volume", hyd.ControlVolume(volume=5 * l))
    diagram.connect(pump.p, edge.a)
    diagram.connect(edge.b, volume.a)
    return diagram


def test_equations_are_listed_by_component_in_its_own_names_and_by_node() -> None:
    assert str(filling().equations()).splitlines() == [
        "pump: Pump (constant-pressure)",
        "    p.p = pressure",
        "edge: Orifice",
        "    a.q = discharge * pi/4 * diameter^2 * sqrt(2 / density) * (a.p - b.p)"
        " / sqrt(sqrt((a.p - b.p)^2 + transition_pressure^2))",
        "    a.q + b.q = 0",
        "volume: Volume (control-volume)",
        "    a.p = pressure",
        "    der(pressure) = bulk_modulus / volume * a.q",
        "nodes",
        "    pump.p.p = edge.a.p",
        "    pump.p.q + edge.a.q = 0",
        "    edge.b.p = volume.a.p",
        "    edge.b.q + volume.a.q = 0",
    ]


def test_latex_is_aligned_at_the_equals_signs() -> None:
    printed = filling().equations().latex()
    assert r"\paragraph{volume: Volume (control-volume)}" in printed
    assert r"  \dot{\mathrm{pressure}} &= \frac{\mathrm{bulk\_modulus}}{\mathrm{volume}} \, q_{\mathrm{a}}" in printed
    assert printed.count(r"\begin{align*}") == printed.count(r"\end{align*}") == 4


def test_every_part_of_a_whole_drive_has_its_equations() -> None:
    drive = load(BOOM_DRIVE)
    printed = drive.equations()
    assert [part.path for part in printed.components] == list(drive.parts)
    assert "operation" not in str(printed)
    cylinder = printed.components[0]
    assert "der(extension) = rod.v" in [str(line) for line in cylinder.lines]
