"""The oil: parameters that a whole diagram shares, and the two forms of the orifice law.

Orifice law: q = c A sqrt(2 |dp| / rho) sign(dp), turbulent flow through a sharp edge (H. E. Merritt, Hydraulic Control
Systems, 1967, section 3.4), with the square root rounded below the transition pressure, where real flow turns laminar.
"""

from __future__ import annotations

from typing import Any

from seacrane.model import shared
from seacrane.numerics.regularise import signed_sqrt
from seacrane.units import bar

MERRITT = "H. E. Merritt, Hydraulic Control Systems, 1967"
DISSERTATION = "Virtual Prototyping for Marine Crane Design and Operations, 2018, section 4.2.2 and appendix A"

ATMOSPHERE = 1.01325 * bar
"""What gauge pressures count from [Pa]; gas laws need the absolute pressure."""


def density() -> Any:
    """Shared density of the oil [kg/m3]: 870, a mineral oil at working temperature."""
    return shared("density of the oil", default=870.0, above=0)


def bulk_modulus() -> Any:
    """Shared effective bulk modulus [Pa]: 1.2e9, oil with a little air, in pipes and hoses."""
    return shared("effective bulk modulus of oil, air and hoses", default=1.2e9, above=0)


def transition_pressure() -> Any:
    """Shared pressure drop [Pa] below which orifice flow turns laminar: 0.1 bar."""
    return shared("pressure drop at which orifice flow turns laminar", default=0.1 * bar, above=0)


def viscosity() -> Any:
    """Shared kinematic viscosity [m2/s]: 46 mm2/s, an ISO VG 46 oil at 40 degrees Celsius (ISO 3448)."""
    return shared("kinematic viscosity of the oil", default=46e-6, above=0)


def orifice_flow(dp: Any, area: Any, discharge: Any, density: Any, transition: Any) -> Any:
    """Flow [m3/s] through a sharp edge of `area` [m2] under the pressure drop `dp` [Pa]."""
    return discharge * area * (2 / density) ** 0.5 * signed_sqrt(dp, transition)


def rated_flow(dp: Any, flow: Any, at: Any, transition: Any) -> Any:
    """The same law for an opening that lets pass `flow` [m3/s] under the drop `at` [Pa], as a data sheet gives it."""
    return flow * signed_sqrt(dp, transition) / signed_sqrt(at, transition)
