"""Which inputs and states, and whether on time, outputs and state derivatives depend on, through algebraic unknowns."""

from __future__ import annotations

from typing import Any, Final

import casadi as ca
import numpy as np

from seacrane.model.dae import Dae

TIME: Final = ""
"""What stands for the time among the names."""


def dependencies(dae: Dae) -> dict[str, tuple[str, ...]]:
    """For each output and each derivative `der(x)`, the names of the inputs and states it may depend on, and `TIME`.

    An expression that uses one algebraic unknown is taken to depend on all that the equations connected with this
    unknown depend on; the result may name too many, never too few.
    """
    known = ca.vertcat(dae.u, dae.x, dae.t)
    names = [v.name for v in dae.inputs + dae.states] + [TIME]
    through = _pattern(dae.alg, known)
    coupled = _pattern(dae.alg, dae.z)
    count = len(dae.algebraics)
    if count:
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import connected_components

        square = np.zeros((2 * count, 2 * count), dtype=bool)  # equations and unknowns as nodes
        square[:count, count:] = coupled
        _, label = connected_components(csr_array(square), directed=False)
        same = label[count:, None] == label[None, :count]
        through = (same.astype(int) @ through.astype(int)) > 0
    result = {}
    rows = (("{}", dae.outputs, dae.out), ("der({})", dae.states, dae.ode))
    for form, variables, expressions in rows:
        direct = _pattern(expressions, known)
        if count:
            direct |= (_pattern(expressions, dae.z).astype(int) @ through.astype(int)) > 0
        for variable, row in zip(variables, direct, strict=True):
            result[form.format(variable.name)] = tuple(names[i] for i in np.flatnonzero(row))
    return result


def _pattern(expressions: Any, variables: Any) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """The structural Jacobian as a dense Boolean matrix."""
    pattern = np.zeros((expressions.numel(), variables.numel()), dtype=bool)
    if pattern.size:
        sparsity = ca.jacobian_sparsity(ca.densify(expressions), variables)
        pattern[sparsity.row(), sparsity.get_col()] = True
    return pattern
