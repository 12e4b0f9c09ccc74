"""The works that laws of several components come from, as `sources` of a component names them."""

from __future__ import annotations

from typing import Final

DISSERTATION: Final = "Virtual Prototyping for Marine Crane Design and Operations, 2018, section 4.2.2 and appendix A"
MERRITT: Final = "H. E. Merritt, Hydraulic Control Systems, 1967"
WATTON: Final = "J. Watton, Fundamentals of Fluid Power Control, 2009"
OLSSON: Final = "H. Olsson et al., Friction models and friction compensation, European Journal of Control 4, 1998"
ASTROM_MURRAY: Final = "K. J. Astrom and R. M. Murray, Feedback Systems, 2008"
KARNOPP: Final = "D. C. Karnopp, D. L. Margolis and R. C. Rosenberg, System Dynamics, 5th ed., 2012"
HYSTERESIS: Final = "M. A. Krasnosel'skii and A. V. Pokrovskii, Systems with Hysteresis, 1989 (the non-ideal relay)"
