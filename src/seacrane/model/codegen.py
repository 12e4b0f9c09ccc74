"""C from a model: its equations through CasADi, and the tables that the C core reads.

Value references are made from names: a variable keeps its reference when others are added, removed or reordered.
"""

from __future__ import annotations

import hashlib
import json
import math
import tempfile
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca

from seacrane.errors import Problem, StructureError
from seacrane.model.dae import Dae, Variable, column
from seacrane.model.elimination import eliminate
from seacrane.native import source
from seacrane.units import UNITS, Unit

CORE = source(
    "model.h", "core.h", "rodas.h", "interface.h", "fmi2.h", "fmi3.h", "linear.c", "instance.c", "evaluate.c",
    "values.c", "newton.c", "integrate.c", "explicit.c", "events.c", "simulate.c", "interface.c", "fmi2.c", "fmi3.c",
)  # fmt: skip
"""The C files that every model is compiled with."""

SETTINGS = (
    Variable("solver.tolerance", "1", 1e-5, 1e-5, 1e-12, 0.1, "relative tolerance of the adaptive integration"),
    Variable(
        "solver.fixed_step", "s", 0.0, 1e-3, 0.0, math.inf, "step of the linearly implicit Euler method; 0: adaptive"
    ),
)
"""Parameters that every compiled model has besides its own."""


@dataclass(frozen=True)
class Entry:
    """A scalar of a compiled model: its variable, its kind (as in model.h), its place and its value reference."""

    variable: Variable
    kind: str
    index: int
    reference: int


@dataclass(frozen=True)
class Generated:
    """A model as C: all files (the core included), its variables, the GUID made from all of that, and the time."""

    dae: Dae
    sources: dict[str, str]
    entries: tuple[Entry, ...]
    guid: str
    time: Entry


def derivative_of(state: Variable) -> Variable:
    """The variable `der(x)` of a state x; without a unit if there is no symbol for it."""
    unit = UNITS[state.unit]
    kg, m, s, rad = unit.dimension
    rate = Unit("", (kg, m, s - 1, rad), unit.factor, unit.kelvin)
    rates = (u.symbol for u in UNITS.values() if u.same_dimension(rate) and u.factor == rate.factor)
    about = f"time derivative of {state.name}"
    return Variable(f"der({state.name})", next(rates, ""), nominal=state.nominal, about=about)


def value_references(names: Iterable[str]) -> dict[str, int]:
    """A 32-bit value reference per name: the FNV-1a hash of the name (Fowler, Noll & Vo; RFC 9923).

    If two names share a hash, the later one in alphabetical order takes the hash of its name with an asterisk appended.
    """
    taken: dict[int, str] = {}
    for name in sorted(names):
        text = name
        while (reference := _fnv1a(text)) in taken:
            text += "*"
        taken[reference] = name
    return {name: reference for reference, name in taken.items()}


def _fnv1a(text: str) -> int:
    value = 0x811C9DC5
    for byte in text.encode():
        value = ((value ^ byte) * 0x01000193) & 0xFFFFFFFF
    return value


def generate(dae: Dae) -> Generated:
    """The C of a model. Raises `StructureError` if a start value is not finite or a nominal value not positive."""
    _check(dae)
    *entries, time = _entries(dae)
    functions, sizes = _functions(dae)
    tables = _tables(dae, [*entries, time], sizes)
    digest = hashlib.sha256(json.dumps([functions, tables, CORE], sort_keys=True).encode()).hexdigest()
    guid = f"{{{digest[:8]}-{digest[8:12]}-{digest[12:16]}-{digest[16:20]}-{digest[20:32]}}}"
    numbers = {
        "NX": len(dae.states),
        "NZ": len(dae.algebraics),
        "NU": len(dae.inputs),
        "NP": len(dae.parameters),
        "NM": len(dae.modes),
        "NE": len(dae.events),
        "NY": len(dae.outputs),
        "NW": len(dae.observables),
        **{key: value for key, value in sizes.items() if isinstance(value, int)},
    }
    header = "".join(f"#define {name} {value}\n" for name, value in numbers.items())
    bytes_of_hash = ", ".join(f"0x{digest[i : i + 2]}" for i in range(0, 32, 2))
    tables += f"const unsigned char model_hash[16] = {{{bytes_of_hash}}};\n"
    # Start values and the GUID that hangs on them are apart: what has only other ones is not compiled anew
    identity = f'#define MODEL_GUID "{guid}"\n'
    sources = {
        **CORE,
        "model_size.h": header,
        "model_guid.h": identity,
        "model_tables.c": tables,
        "model_functions.c": functions,
    }
    return Generated(dae, sources, tuple(entries), guid, time)


def _check(dae: Dae) -> None:
    problems = [
        Problem(v.name, "the start value is not a finite number", v.start)
        for v in dae.states + dae.algebraics + dae.inputs + dae.constants
        if not math.isfinite(v.start)
    ]
    problems += [
        Problem(v.name, "the nominal value must be a positive number", v.nominal)
        for v in dae.states + dae.algebraics
        if not 0 < v.nominal < math.inf
    ]
    problems += [
        Problem(v.name, "is a name that every compiled model has already")
        for v in dae.variables
        if v.name in {s.name for s in SETTINGS}
    ]
    if problems:
        raise StructureError(problems)


def _entries(dae: Dae) -> tuple[Entry, ...]:
    groups: tuple[tuple[str, Sequence[Variable]], ...] = (
        ("INPUT", dae.inputs),
        ("OUTPUT", dae.outputs),
        ("PARAMETER", dae.parameters),
        ("MODE", dae.modes),
        ("SETTING", SETTINGS),
        ("STATE", dae.states),
        ("DERIVATIVE", [derivative_of(v) for v in dae.states]),
        ("ALGEBRAIC", dae.algebraics),
        ("OBSERVABLE", dae.observables),
        ("INDICATOR", [Variable(e.name, about=e.about or "indicator of an event") for e in dae.events]),
        ("TIME", [_independent(dae)]),
    )
    references = value_references(v.name for _, variables in groups for v in variables)
    return tuple(
        Entry(v, kind, i, references[v.name]) for kind, variables in groups for i, v in enumerate(variables)
    )  # fmt: skip


def _independent(dae: Dae) -> Variable:
    """The time as a variable; if a variable of the model is called that, under a name that is free."""
    name = "time"
    while name in {v.name for v in dae.variables}:
        name += "_"
    return Variable(name, "s", about="simulated time")


def _functions(dae: Dae) -> tuple[str, dict[str, Any]]:
    """The C that CasADi writes, and what the core must know of it: work sizes and sparsity patterns."""
    t, u, p = dae.t, dae.u, dae.p
    y = ca.vertcat(dae.x, dae.z)
    f = ca.densify(ca.vertcat(dae.ode, dae.alg))
    alg, out, obs = ca.densify(dae.alg), ca.densify(dae.out), ca.densify(dae.obs)
    jacobian, jacobian_alg = ca.jacobian(f, y), ca.jacobian(alg, dae.z)
    dt, dy, du, dp = (ca.SX.sym(name, *v.shape) for name, v in (("dt", t), ("dy", y), ("du", u), ("dp", p)))

    def along(expression: Any, variables: Any, direction: Any) -> Any:
        return ca.densify(ca.jtimes(expression, variables, direction))

    rows, columns = jacobian.sparsity().row(), jacobian.sparsity().get_col()
    e = eliminate(dae.x.numel(), y.numel(), rows, columns)
    due = ca.SX.sym("due", len(dae.events))
    everything, direction = ca.vertcat(t, y, u, p), ca.vertcat(dt, dy, du, dp)
    inputs = [t, y, u, p]
    functions = [
        _function("model_residual", inputs, [f]),
        _function("model_jacobian", inputs, [f, jacobian, along(f, t, ca.SX(1))]),
        _function("model_factor", [e.nonzeros, e.s], [e.factors]),
        _function("model_solve", [e.factor, e.b], [e.x]),
        _function("model_algebraic", inputs, [alg, jacobian_alg]),
        _function("model_input_rate", [*inputs, du], [along(f, u, du)]),
        _function("model_output", inputs, [out]),
        _function("model_observe", inputs, [obs]),
        _function(
            "model_directional",
            [*inputs, dt, dy, du, dp],
            [along(f, everything, direction), along(out, everything, direction)],
        ),
        _function("model_indicate", inputs, [column(*[e.indicator for e in dae.events])]),
        _function("model_reset", [*inputs, due], [_after_events(dae, due)]),
    ]
    generator = ca.CodeGenerator("model_functions.c", {"casadi_int": "int"})
    for function in functions:
        generator.add(function)
    with tempfile.TemporaryDirectory(prefix="seacrane-") as folder:
        generator.generate(folder + "/")
        text = (Path(folder) / "model_functions.c").read_text(encoding="utf-8")
    return text, {
        "NNZ": jacobian.nnz(),
        "NNZ_ALG": jacobian_alg.nnz(),
        "NFACTORS": e.factors.numel(),
        "WORK_ARG": max(g.sz_arg() for g in functions),
        "WORK_RES": max(g.sz_res() for g in functions),
        "WORK_REAL": max(1, *(g.sz_w() for g in functions)),
        "WORK_INT": max(1, *(g.sz_iw() for g in functions)),
        "pattern": (rows, columns),
        "pattern_alg": (jacobian_alg.sparsity().row(), jacobian_alg.sparsity().get_col()),
    }


def _after_events(dae: Dae, due: Any) -> Any:
    """States, then modes, after those events whose entry of `due` is not zero."""
    after = {v.name: dae.x[i] for i, v in enumerate(dae.states)}
    after |= {v.name: dae.p[len(dae.parameters) + i] for i, v in enumerate(dae.modes)}
    for i, event in enumerate(dae.events):
        for name, value in event.resets.items():
            after[name] = ca.if_else(due[i] != 0, value, after[name])
    return column(*after.values())


def _function(name: str, inputs: list[Any], outputs: list[Any]) -> Any:
    return ca.Function(name, inputs, ca.cse(outputs))


def _tables(dae: Dae, entries: Sequence[Entry], sizes: dict[str, Any]) -> str:
    unknowns = dae.states + dae.algebraics
    lines = ["#include <math.h>", "", '#include "model.h"', "", "const struct variable model_variables[NVARIABLES] = {"]
    lines += [
        f"    {{0x{e.reference:08x}u, {e.kind}, {e.index}, {_text(e.variable.name)}, {_text(e.variable.unit)}}},"
        for e in sorted(entries, key=lambda e: e.reference)
    ]
    lines.append("};")
    reals = (
        ("start_y", "N", [v.start for v in unknowns]),
        ("nominal_y", "N", [v.nominal for v in unknowns]),
        ("start_u", "NU", [v.start for v in dae.inputs]),
        ("start_m", "NM", [v.start for v in dae.modes]),
        ("start_p", "NP", [v.start for v in dae.parameters]),
        ("minimum_p", "NP", [v.minimum for v in dae.parameters]),
        ("maximum_p", "NP", [v.maximum for v in dae.parameters]),
    )
    lines += [f"const double model_{name}[ROOM({size})] = {{{_reals(values)}}};" for name, size, values in reals]
    names = ", ".join(_text(e.name) for e in dae.events) or "0"
    lines.append(f"const char *const model_event[ROOM(NE)] = {{{names}}};")
    for suffix, size, key in (("", "NNZ", "pattern"), ("_alg", "NNZ_ALG", "pattern_alg")):
        for name, indices in zip(("row", "column"), sizes[key], strict=True):
            lines.append(f"const int model_{name}{suffix}[ROOM({size})] = {{{', '.join(map(str, indices)) or '0'}}};")
    return "\n".join(lines) + "\n"


def _reals(values: Sequence[float]) -> str:
    return ", ".join(_real(v) for v in values) or "0"


def _real(value: float) -> str:
    if math.isinf(value):
        return "HUGE_VAL" if value > 0 else "-HUGE_VAL"
    return repr(float(value))


def _text(text: str) -> str:
    return json.dumps(text)
