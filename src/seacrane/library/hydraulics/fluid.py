"""The oil: parameters that a whole diagram shares, how they change with temperature, and the orifice law in two forms.

Orifice law: q = c A sqrt(2 |dp| / rho) sign(dp), turbulent flow through a sharp edge (H. E. Merritt, Hydraulic Control
Systems, 1967, section 3.4), with the square root rounded below the transition pressure, where real flow turns laminar.
"""

from __future__ import annotations

from math import log10
from typing import Any, Final

from seacrane.errors import ParameterError, Problem
from seacrane.model import shared
from seacrane.numerics.regularise import signed_sqrt
from seacrane.units import Density, KinematicViscosity, Pressure, Temperature, bar

ATMOSPHERE: Final = 1.01325 * bar
"""The pressure of the standard atmosphere [Pa], from which gauge pressures count unless a diagram says otherwise."""

DENSITY: Final = 870.0
BULK_MODULUS: Final = 1.2e9
VISCOSITY: Final = 46e-6


# ---------------------------------------------------------------- shared parameters
def density() -> Any:
    """Shared density of the oil [kg/m3]: 870, a mineral oil at working temperature."""
    return shared(
        "density of the oil", default=DENSITY, reason="a mineral oil at working temperature", above=0, most=3e3
    )


def bulk_modulus() -> Any:
    """Shared effective bulk modulus [Pa]: 1.2e9, oil with a little air, in pipes and hoses."""
    return shared(
        "effective bulk modulus of oil, air and hoses",
        default=BULK_MODULUS,
        reason="oil with a little air, in pipes and hoses",
        least=1e6,
        most=1e15,
    )


def transition_pressure() -> Any:
    """Shared pressure drop [Pa] below which orifice flow turns laminar: 0.1 bar."""
    return shared(
        "pressure drop at which orifice flow turns laminar",
        default=0.1 * bar,
        reason="as orifices of valves do, at Reynolds numbers of a few 100",
        above=0,
        most=1e7,
    )


def viscosity() -> Any:
    """Shared kinematic viscosity [m2/s]: 46 mm2/s, an ISO VG 46 oil at 40 degrees Celsius (ISO 3448)."""
    return shared(
        "kinematic viscosity of the oil", default=VISCOSITY, reason="ISO VG 46 at 40 degrees Celsius", above=0, most=1.0
    )


def atmospheric_pressure() -> Any:
    """Shared absolute pressure [Pa] of the surroundings: 1.01325 bar at sea level, more in the deep."""
    return shared(
        "absolute pressure at gauge pressure zero", default=ATMOSPHERE, reason="standard atmosphere", above=0, most=1e8
    )


# ---------------------------------------------------------------- temperature
REFERENCE_TEMPERATURE: Final = 313.15
"""40 degrees Celsius [K], at which oils are graded and the defaults above are meant."""

COLDEST_OIL, HOTTEST_OIL = 233.15, 393.15
"""Range [K] of `mineral_oil`: -40 to 120 degrees Celsius."""

_EXPANSION = 7e-4  # thermal expansion of mineral oil, 1/K
_SOFTENING = 0.0024  # decimal logarithm of the bulk modulus lost per kelvin


def mineral_oil(
    temperature: Temperature,
    *,
    viscosity_40: KinematicViscosity = VISCOSITY,
    viscosity_100: KinematicViscosity = 6.8e-6,
    density: Density = DENSITY,
    bulk_modulus: Pressure = BULK_MODULUS,
) -> dict[str, float]:
    """The shared parameters `density`, `viscosity` and `bulk_modulus` of a mineral oil at `temperature` [K].

        viscosity     lg lg (nu / (mm2/s) + 0.7) = A - B lg T, through the viscosities at 40 and 100 degrees Celsius
        density       rho = rho_40 / (1 + 7e-4 (T - T_40))
        bulk modulus  beta = beta_40 10^(-0.0024 (T - T_40))

    The defaults are those of the shared parameters; 6.8 mm2/s at 100 degrees goes with ISO VG 46 and a viscosity index
    of 100. Given to a diagram, `Diagram("drive", **mineral_oil(333.15))`; a run of a compiled model takes those of them
    that the model has. The law of viscosity is good to a few percent, that of the modulus to ten.

    Sources: ASTM D341 (viscosity); A. T. J. Hayward, How to estimate the bulk modulus of hydraulic fluids, Hydraulic
    Pneumatic Power, 1970 (modulus); Merritt, chapter 2 (expansion).
    """
    problems = []
    if not COLDEST_OIL <= temperature <= HOTTEST_OIL:
        celsius = f"Did you mean {temperature:g} degrees Celsius, {temperature + 273.15:g} K?"
        problems.append(
            Problem(
                "mineral_oil.temperature",
                f"{temperature:g} K is out of range",
                allowed=f"{COLDEST_OIL:g} to {HOTTEST_OIL:g} K",
                hint=celsius if COLDEST_OIL <= temperature + 273.15 <= HOTTEST_OIL else None,
            )
        )
    if not 1e-6 <= viscosity_100 < viscosity_40 <= 1.0:
        what = f"{viscosity_100 * 1e6:g} mm2/s must be at least 1 mm2/s and below viscosity_40 = "
        problems.append(Problem("mineral_oil.viscosity_100", f"{what}{viscosity_40 * 1e6:g} mm2/s"))
    if problems:
        raise ParameterError(problems)
    warmer = temperature - REFERENCE_TEMPERATURE
    cold, hot = (log10(log10(1e6 * nu + 0.7)) for nu in (viscosity_40, viscosity_100))
    share = log10(temperature / REFERENCE_TEMPERATURE) / log10((REFERENCE_TEMPERATURE + 60) / REFERENCE_TEMPERATURE)
    return {
        "density": density / (1 + _EXPANSION * warmer),
        "viscosity": 1e-6 * (10 ** (10 ** (cold + share * (hot - cold))) - 0.7),
        "bulk_modulus": bulk_modulus * 10 ** (-_SOFTENING * warmer),
    }


# ---------------------------------------------------------------- the orifice law
def orifice_flow(dp: Any, area: Any, discharge: Any, density: Any, transition: Any) -> Any:
    """Flow [m3/s] through a sharp edge of `area` [m2] under the pressure drop `dp` [Pa]."""
    return discharge * area * (2 / density) ** 0.5 * signed_sqrt(dp, transition)


def rated_flow(dp: Any, flow: Any, at: Any, transition: Any) -> Any:
    """The same law for an opening that lets pass `flow` [m3/s] under the drop `at` [Pa], as a data sheet gives it."""
    return flow * signed_sqrt(dp, transition) / signed_sqrt(at, transition)
