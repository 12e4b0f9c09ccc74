"""Equations that lose their unknown: regular as a structure, but not at these values.

The flow of a closed valve does not depend on the pressure behind it. If nothing else does, that pressure is
undetermined. Whether it is shows in the numbers only: in the rank of d alg/d z, and in the coefficients by which
equations were divided when they were solved in closed form.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np

from seacrane.errors import Problem
from seacrane.numerics.equations import Reals

from .dae import Dae, Variable

NOTHING = 1e-10
"""A singular value of the scaled Jacobian below this is none."""

PART = 0.3
"""Entries of a null vector above this share of its largest are told."""


@dataclass(frozen=True)
class Point:
    """Where a model stands: time [s]; states, algebraic unknowns, inputs and parameters [SI]."""

    time: float
    x: Reals
    z: Reals
    u: Reals
    p: Reals

    @property
    def values(self) -> tuple[Any, ...]:
        return self.time, self.x, self.z, self.u, self.p


def start_point(dae: Dae) -> Point:
    """The start values of all variables."""
    x, z, u, p = (
        np.array([v.start for v in group], dtype=np.float64)
        for group in (dae.states, dae.algebraics, dae.inputs, dae.constants)
    )
    return Point(0.0, x, z, u, p)


def undetermined_at(dae: Dae, point: Point, when: str) -> Iterator[Problem]:
    """The unknowns that no equation determines at this point; `when` names it in the text."""
    jacobian = ca.jacobian(dae.alg, dae.z)
    names = [v.name for v in dae.algebraics]
    blocks = [(names, jacobian), *((list(d.unknowns), d.coefficients) for d in dae.divisors)]
    evaluated = _values(dae, [matrix for _, matrix in blocks], point)
    for (unknowns, matrix), values in zip(blocks, evaluated, strict=True):
        for rows, columns in _lost(values):
            entries = [matrix[i, j] for i in rows for j in columns if matrix.sparsity().has_nz(i, j)]
            yield _problem(dae, point, when, [unknowns[j] for j in columns], entries)


def _values(dae: Dae, matrices: Sequence[Any], point: Point) -> list[Reals]:
    dense = [ca.densify(m) for m in matrices]
    results: Any = ca.Function("m", [dae.t, dae.x, dae.z, dae.u, dae.p], dense).call(list(point.values))
    return [np.asarray(r, dtype=np.float64).reshape(m.shape) for r, m in zip(results, matrices, strict=True)]


def _lost(values: Reals) -> Iterator[tuple[list[int], list[int]]]:
    """Rows and columns of each dimension in which a square matrix is singular."""
    if not values.size or not np.all(np.isfinite(values)):
        return
    largest = np.abs(values).max(axis=1, keepdims=True)
    rows = values / np.where(largest > 0, largest, 1.0)
    largest = np.abs(rows).max(axis=0, keepdims=True)
    left, size, right = np.linalg.svd(rows / np.where(largest > 0, largest, 1.0))
    for k in np.flatnonzero(size <= NOTHING):
        yield _large(left[:, k]), _large(right[k])


def _large(vector: Reals) -> list[int]:
    share = np.abs(vector)
    return [int(i) for i in np.flatnonzero(share >= PART * share.max())]


def _problem(dae: Dae, point: Point, when: str, unknowns: list[str], entries: list[Any]) -> Problem:
    known = {v.name: v for v in dae.variables}
    involved = column_of(entries)
    cures = [*_cures(dae, point, involved)]
    owners = list(dict.fromkeys(c.rpartition(".")[0] for c in cures if "." in c)) or components(dae, involved)
    pressures = [n for n in unknowns if n in known and known[n].unit == "Pa"]
    joined = [n for u in unknowns for n in _same(dae, u)]
    at = f" (joined: {', '.join(joined)})" if joined else ""
    by = f": {' and '.join(owners)} should, but with these values what passes there is the same whatever it is"
    message = f"nothing determines it at {when}{at}{by if owners else ''}"
    hint = f"It is determined if {' or '.join(cures)} is above 0. " if cures else ""
    if pressures:
        hint += "A closed valve needs a little leakage, or the node a small volume (ControlVolume)."
    else:
        hint += "Look at the parameters there that are zero."
    return Problem(" and ".join(unknowns[:4]), message, hint=hint)


def column_of(entries: Sequence[Any]) -> Any:
    """Expressions as one column."""
    return ca.vertcat(*entries) if entries else ca.SX(0, 1)


def components(dae: Dae, expression: Any) -> list[str]:
    """The components whose parameters are in an expression, in order."""
    parameters = {v.name for v in dae.parameters}
    symbols = [s.name() for s in ca.symvar(expression)]
    return list(dict.fromkeys(n.rpartition(".")[0] for n in symbols if n in parameters and "." in n))


def _same(dae: Dae, unknown: str) -> list[str]:
    """Ports at which the same quantity is looked at under another name."""
    places = {v.name: dae.z[i] for i, v in enumerate(dae.algebraics)}
    if unknown not in places:
        return []
    here = places[unknown]
    return [v.name for i, v in enumerate(dae.observables) if v.unit == "Pa" and ca.is_equal(dae.obs[i], here, 0)]


def _cures(dae: Dae, point: Point, entries: Any) -> Iterator[str]:
    """Parameters and inputs that are zero and, raised a little, would bring the coefficients back."""
    arguments = [dae.t, dae.x, dae.z, dae.u, dae.p]
    function = ca.Function("c", arguments, [ca.densify(entries)])
    used = {s.name() for s in ca.symvar(entries)}
    groups: list[tuple[tuple[Variable, ...], int]] = [(dae.parameters, 4), (dae.inputs, 3)]
    for variables, place in groups:
        for i, v in enumerate(variables):
            values: list[Any] = [np.copy(a) for a in point.values]
            if v.name not in used or values[place][i] != 0 or v.maximum <= 0:
                continue
            values[place][i] = min(1e-2, v.maximum)
            raised = np.asarray(function(*values), dtype=np.float64)
            if np.all(np.isfinite(raised)) and np.any(raised != 0):
                yield v.name
