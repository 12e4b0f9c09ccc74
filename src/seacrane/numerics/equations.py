"""Systems of nonlinear equations, solved from a poor start."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Reals = NDArray[np.float64]

ENOUGH = 1e-10
"""Relative size of the last correction."""

SOLVED = 1e-6
"""Residual of each equation that is left, of what a nominal change of its unknowns makes: rounding, and no more."""


def solve_equations(
    residual: Callable[[Reals], tuple[Reals, Reals]], start: Reals, nominal: Reals, most: int = 200
) -> Reals | None:
    """A root of g near `start`, or None. `residual(z)` gives g and its Jacobian, `nominal` > 0 the magnitudes of z.

    Pseudo-transient continuation along the flow that descends |g|: (1/delta + J'J) dz = -J'g, in which z counts in
    nominal values and g in rows scaled by the Jacobian at the start. The step delta of pseudo-time grows as |g| falls
    (switched evolution relaxation; Kelley and Keyes, SIAM J. Numer. Anal. 35, 1998): the end is Newton's method.
    Unlike the flow dz/dt = -g it does not ask for equations written with the right sign.
    """
    z, delta = start.astype(np.float64), 1.0
    g, jacobian = residual(z)
    if not (np.all(np.isfinite(g)) and np.all(np.isfinite(jacobian))):
        return None
    rows = np.abs(jacobian * nominal).max(axis=1, initial=0.0)
    weight = 1.0 / np.where(rows > 0, rows, 1.0)
    size = float(np.linalg.norm(weight * g))
    for _ in range(most):
        scaled = weight[:, None] * jacobian * nominal
        # The least-squares form of the same system: forming J'J would square the condition number.
        stacked = np.vstack([scaled, np.eye(z.size) / np.sqrt(delta)])
        step: Reals = np.linalg.lstsq(stacked, np.concatenate([-weight * g, np.zeros(z.size)]), rcond=None)[0]
        trial: Reals = z + nominal * step
        g_new, jacobian_new = residual(trial)
        size_new = float(np.linalg.norm(weight * g_new))
        if np.isfinite(size_new) and np.all(np.isfinite(jacobian_new)) and size_new <= size:
            last = float(np.max(np.abs(step) / (1.0 + np.abs(z) / nominal), initial=0.0))
            z, g, jacobian = trial, g_new, jacobian_new
            if last <= ENOUGH and delta > 1e6:
                solved = np.abs(g) <= SOLVED * np.abs(jacobian * nominal).max(axis=1, initial=0.0)
                return z if np.all(solved) else None  # or where |g| is least but not zero
            delta = min(delta * max(2.0, min(size / max(size_new, 1e-300), 1e4)), 1e30)
            size = size_new
        else:
            delta /= 10.0
            if delta < 1e-30:
                return None
    return None
