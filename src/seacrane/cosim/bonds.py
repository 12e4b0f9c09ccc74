"""Power bonds between slaves, and the energy that the coupling itself creates or loses.

A bond is an effort and a flow in opposite directions whose product is power. Each side sees its own output as it is
and its input as it was when it was last exchanged, so the two sides compute different powers: their difference is the
residual power of the bond, and its integral is energy that the coupling has created or lost (S. Sadjina, L. T.
Kyllingstad, S. Skjong and E. Pedersen, Energy conservation and power bonds in co-simulations: non-iterative adaptive
step size control and error estimation, Engineering with Computers 33, 2017).

Over one macro step the input is held, and the mean of an output is taken as that of its values at both ends, so the
energies are second-order accurate and the error that is reported is that of the coupling and not of its measurement.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

ACCOUNT: Final = (
    "effort_before",
    "flow_before",
    "power",
    "flow_power",
    "residual",
    "energy",
    "energy_error",
    "energy_moved",
    "peak_residual",
)
"""The values kept for a bond, in the order of the C loop; the first two are scratch of the macro step."""

SIGNALS: Final = {
    "power": "W",
    "flow_power": "W",
    "residual": "W",
    "energy": "J",
    "energy_error": "J",
    "energy_moved": "J",
    "peak_residual": "W",
}
"""What can be read and recorded of a bond under `<bond>.<quantity>`, with its unit."""


@dataclass(frozen=True)
class BondReport:
    """The account of one bond since the start.

    `power` and `flow_power` [W] are what the effort's side gave and the flow's side took in the last macro step, and
    `residual` [W] their difference; `peak_residual` [W] is the largest |residual|. `energy` [J] is the integral of
    power, `energy_moved` [J] that of |power|, `energy_error` [J] that of the residual.
    """

    power: float
    flow_power: float
    residual: float
    energy: float
    energy_error: float
    energy_moved: float
    peak_residual: float

    @property
    def relative_error(self) -> float:
        """|energy error| over energy moved; 0 when nothing has moved."""
        return abs(self.energy_error) / self.energy_moved if self.energy_moved else 0.0
