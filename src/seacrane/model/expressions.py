"""CasADi expressions to be read: as text, and as LaTeX.

An expression is unfolded from the instructions that compute it. Minimum and maximum, which laws write with an absolute
value, are found again; a longer part that occurs twice gets a name of its own.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from fractions import Fraction
from typing import Any, Final

import casadi as ca

from .dae import column

_BINARY: Final = {
    ca.OP_ADD: "+",
    ca.OP_SUB: "-",
    ca.OP_MUL: "*",
    ca.OP_DIV: "/",
    ca.OP_POW: "^",
    ca.OP_CONSTPOW: "^",
    ca.OP_LT: "<",
    ca.OP_LE: "<=",
    ca.OP_EQ: "==",
    ca.OP_NE: "!=",
    ca.OP_AND: "and",
    ca.OP_OR: "or",
}
_CALLS: Final = {
    ca.OP_SIN: "sin",
    ca.OP_COS: "cos",
    ca.OP_TAN: "tan",
    ca.OP_ASIN: "asin",
    ca.OP_ACOS: "acos",
    ca.OP_ATAN: "atan",
    ca.OP_SINH: "sinh",
    ca.OP_COSH: "cosh",
    ca.OP_TANH: "tanh",
    ca.OP_EXP: "exp",
    ca.OP_LOG: "log",
    ca.OP_SQRT: "sqrt",
    ca.OP_FABS: "abs",
    ca.OP_SIGN: "sign",
    ca.OP_FLOOR: "floor",
    ca.OP_CEIL: "ceil",
    ca.OP_ERF: "erf",
    ca.OP_ATAN2: "atan2",
    ca.OP_FMIN: "min",
    ca.OP_FMAX: "max",
    ca.OP_FMOD: "mod",
    ca.OP_COPYSIGN: "copysign",
    ca.OP_IF_ELSE_ZERO: "when",
    ca.OP_NOT: "not",
}
_RANK: Final = {"or": 0, "and": 0, "<": 1, "<=": 1, "==": 1, "!=": 1, "+": 2, "-": 2, "*": 3, "/": 3, "neg": 3, "^": 4}
NAMED_FROM: Final = 4
"""Operations in a part that occurs twice, from which on it gets a name."""

Node = tuple[str, tuple[Any, ...]]


class Reader:
    """Expressions as nodes: (operation, arguments), each different node once. `scope` is left out of names."""

    def __init__(self, expressions: Sequence[Any], scope: str = "") -> None:
        self._nodes: list[Node] = []
        self._index: dict[Node, int] = {}
        whole = column(*expressions)
        symbols = ca.symvar(whole)
        function = ca.Function("f", [column(*symbols)], [whole])
        work: dict[int, int] = {}
        results: dict[int, int] = {}
        for k in range(function.n_instructions()):
            op, out, args = function.instruction_id(k), function.instruction_output(k), function.instruction_input(k)
            if op == ca.OP_OUTPUT:
                results[out[1]] = work[args[0]]
            elif op == ca.OP_INPUT:
                work[out[0]] = self._node("symbol", symbols[args[1]].name().replace(scope, ""))
            elif op == ca.OP_CONST:
                work[out[0]] = self._node("number", float(function.instruction_constant(k)))
            else:
                work[out[0]] = self._operation(op, [work[a] for a in args])
        self.roots = [results.get(i, self._node("number", 0.0)) for i in range(len(expressions))]

    def __getitem__(self, node: int) -> Node:
        return self._nodes[node]

    def _node(self, op: str, *args: Any) -> int:
        key = (op, args)
        if key not in self._index:
            self._index[key] = len(self._nodes)
            self._nodes.append(key)
        return self._index[key]

    def _operation(self, op: int, args: list[int]) -> int:
        match op:
            case ca.OP_NEG:
                return self._node("neg", *args)
            case ca.OP_SQ:
                return self._node("^", args[0], self._node("number", 2.0))
            case ca.OP_TWICE:
                return self._node("*", self._node("number", 2.0), args[0])
            case ca.OP_INV:
                return self._node("/", self._node("number", 1.0), args[0])
        if op in _CALLS:
            return self._node(_CALLS[op], *args)
        if op not in _BINARY:
            return self._node(f"operation {op}", *args)
        name = _BINARY[op]
        if name == "*":
            for half, other in (args, args[::-1]):
                if self._nodes[half] == ("number", (0.5,)):
                    return self._extreme(other) or self._node("/", other, self._node("number", 2.0))
        if name == "/" and self._nodes[args[1]] == ("number", (2.0,)):
            return self._extreme(args[0]) or self._node("/", *args)
        return self._node(name, *args)

    def _extreme(self, node: int) -> int | None:
        """The minimum or maximum whose double this is: a + b -+ |a - b|, or a -+ |a| where b is zero."""
        op, args = self._nodes[node]
        if op == "-" and self._nodes[args[0]] == ("abs", (args[1],)):
            return self._node("max", self._node("neg", args[1]), self._node("number", 0.0))
        if op not in ("+", "-") or self._nodes[args[1]][0] != "abs":
            return None
        total, (difference,) = args[0], self._nodes[args[1]][1]
        name = "max" if op == "+" else "min"
        if difference == total:
            return self._node(name, total, self._node("number", 0.0))
        if self._nodes[difference][0] != "-":
            return None
        a, b = self._nodes[difference][1]
        if {self._index.get(("+", (a, b))), self._index.get(("+", (b, a)))} & {total}:
            return self._node(name, a, b)
        return None

    def named(self) -> list[int]:
        """Parts that occur more than once and are long enough to be named, inner ones first."""
        uses: dict[int, int] = {}
        sizes: dict[int, int] = {}
        pending = [*self.roots]
        while pending:
            node = pending.pop()
            uses[node] = uses.get(node, 0) + 1
            if uses[node] == 1:
                pending += self._children(node)
        for node in sorted(uses):  # arguments come before what uses them
            sizes[node] = 1 + sum(sizes[a] for a in self._children(node))
        return [n for n in sorted(uses) if uses[n] > 1 and sizes[n] >= NAMED_FROM and n not in self.roots]

    def _children(self, node: int) -> tuple[int, ...]:
        op, args = self._nodes[node]
        return () if op in ("symbol", "number") else args


# ---------------------------------------------------------------- text
def text(reader: Reader, node: int, names: dict[int, str], *, whole: bool = False) -> str:
    """The node in one line; parts in `names` by their name. `whole`: the node itself is written out."""
    return _text(reader, node, names, whole)[0]


def _text(reader: Reader, node: int, names: dict[int, str], whole: bool = False) -> tuple[str, int]:
    """The text and how tightly it binds."""
    if node in names and not whole:
        return names[node], 9
    op, args = reader[node]
    if op == "symbol":
        return args[0], 9
    if op == "number":
        words = _number(args[0])
        return words, 3 if args[0] < 0 or "/" in words or "*" in words else 9
    if op not in _RANK:
        return f"{op}({', '.join(_text(reader, a, names)[0] for a in args)})", 9
    rank = _RANK[op]
    parts = [_text(reader, a, names) for a in args]
    if op == "neg":
        return "-" + _in_brackets(*parts[0], parts[0][1] <= 3), 2
    left = _in_brackets(*parts[0], parts[0][1] < rank or (op == "^" and parts[0][1] == rank))
    right = _in_brackets(*parts[1], parts[1][1] < rank or (op in "-/^" and parts[1][1] == rank))
    space = "" if op == "^" else " "
    return f"{left}{space}{op}{space}{right}", rank


def _in_brackets(words: str, _: int, needed: bool) -> str:
    return f"({words})" if needed else words


def _number(value: float) -> str:
    """A short name of the number: a fraction of pi if it is one."""
    fraction = _of_pi(value)
    if fraction is None:
        return f"{value:.10g}"
    top = "pi" if fraction.numerator == 1 else f"{fraction.numerator}*pi"
    return top if fraction.denominator == 1 else f"{top}/{fraction.denominator}"


def _of_pi(value: float) -> Fraction | None:
    fraction = Fraction(value / math.pi).limit_denominator(64)
    near = fraction > 0 and math.isclose(float(fraction) * math.pi, value, rel_tol=1e-14)
    return fraction if near and fraction.numerator <= 16 else None


# ---------------------------------------------------------------- LaTeX
def latex(reader: Reader, node: int, names: dict[int, str], *, whole: bool = False) -> str:
    """As `text`, for a LaTeX formula."""
    return _latex(reader, node, names, whole)[0]


def _latex(reader: Reader, node: int, names: dict[int, str], whole: bool = False) -> tuple[str, int]:
    if node in names and not whole:
        return symbol_latex(names[node]), 9
    op, args = reader[node]
    if op == "symbol":
        return symbol_latex(args[0]), 9
    if op == "number":
        return _number_latex(args[0]), 9 if args[0] >= 0 else 2
    parts = [_latex(reader, a, names) for a in args]
    inner = [words for words, _ in parts]
    special: dict[str, Callable[[], str]] = {
        "/": lambda: rf"\frac{{{inner[0]}}}{{{inner[1]}}}",
        "sqrt": lambda: rf"\sqrt{{{inner[0]}}}",
        "abs": lambda: rf"\left|{inner[0]}\right|",
    }
    if op == "^" and reader[args[1]] == ("number", (0.5,)):
        return rf"\sqrt{{{inner[0]}}}", 9
    if op in special:
        return special[op](), 9 if op != "/" else 3
    if op not in _RANK:
        return rf"\operatorname{{{op}}}\left({', '.join(inner)}\right)", 9
    rank = _RANK[op]
    if op == "neg":
        return "-" + _latex_brackets(*parts[0], parts[0][1] <= 2), 2
    left = _latex_brackets(*parts[0], parts[0][1] < rank or (op == "^" and parts[0][1] <= rank))
    if op == "^":
        return f"{left}^{{{inner[1]}}}", rank
    right = _latex_brackets(*parts[1], parts[1][1] < rank or (op == "-" and parts[1][1] == rank))
    sign = {"*": r" \, ", "<=": r" \le ", "!=": r" \ne ", "==": " = "}.get(op, f" {op} ")
    return f"{left}{sign}{right}", rank


def _latex_brackets(words: str, _: int, needed: bool) -> str:
    return rf"\left({words}\right)" if needed else words


def _number_latex(value: float) -> str:
    fraction = _of_pi(value)
    if fraction is not None:
        top = r"\pi" if fraction.numerator == 1 else rf"{fraction.numerator} \pi"
        return top if fraction.denominator == 1 else rf"\frac{{{top}}}{{{fraction.denominator}}}"
    mantissa, _, exponent = f"{value:.10g}".partition("e")
    return mantissa if not exponent else rf"{mantissa} \cdot 10^{{{int(exponent)}}}"


def symbol_latex(name: str) -> str:
    """A name as a LaTeX symbol: `a.p` as p with the index a, `der(x)` with a dot."""
    rate = re.fullmatch(r"der\((.*)\)", name)
    if rate:
        return rf"\dot{{{symbol_latex(rate[1])}}}"
    scope, _, own = name.rpartition(".")
    words = own.replace("_", r"\_")
    letter = words if len(own) == 1 else rf"\mathrm{{{words}}}"
    place = scope.replace("_", r"\_")
    return f"{letter}_{{\\mathrm{{{place}}}}}" if scope else letter
