"""The energy account of a crane in a coupled run: what the drives and the ship gave, and where it is.

Given: the work that each drive has counted at its own boundary, and the work of the ship at the foot. Taken: kinetic,
potential and elastic energy of crane, rope and load, and what friction and damping turned to heat. On an exact solution
the two agree; in a co-simulation they differ by what the coupling created or lost, which shrinks with the macro step.
"""

from __future__ import annotations

from dataclasses import dataclass

from seacrane.cosim import Execution, System

_TAKEN = ("kinetic", "potential", "rope", "dissipated", "carried")


@dataclass(frozen=True)
class EnergyAccount:
    """Energies [J] since the account was opened. `moved` is the energy that passed the drives, to and fro."""

    given: float
    taken: float
    moved: float

    @property
    def error(self) -> float:
        """|given - taken| over the energy moved; 0 when nothing has moved."""
        return abs(self.given - self.taken) / self.moved if self.moved else 0.0


class EnergyMeter:
    """Opens the account of the slave `crane` and its drives in a started run; `read()` closes it."""

    def __init__(self, system: System, run: Execution) -> None:
        works = [
            f"{name}.{w}" for name in system.slaves for w in ("work", "rod_work") if f"{name}.{w}" in run.variables
        ]
        self._names = [*works, "crane.energy.work_base", *(f"crane.energy.{part}" for part in _TAKEN)]
        self._given = len(works) + 1
        self._bonds = [n for n, bond in system.bonds.items() if not bond.effort[0].startswith("crane.")]
        self._run = run
        self._start = run.values(self._names)
        self._moved = self._moved_now()

    def read(self) -> EnergyAccount:
        """The account from the opening until now."""
        change = self._run.values(self._names) - self._start
        given, taken = float(change[: self._given].sum()), float(change[self._given :].sum())
        return EnergyAccount(given, taken, self._moved_now() - self._moved)

    def _moved_now(self) -> float:
        return sum(self._run.bonds[name].energy_moved for name in self._bonds)
