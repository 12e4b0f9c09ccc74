"""From a design to a running system.

system = plant.build(design.load("offshore-100t"), vessel=vessel.Fixed())
with cosim.Execution(system, cosim.GaussSeidel(step=0.002)) as run:
    recording = run.run(until=20.0)
"""

from .assembly import build, check, parts
from .drives import Hydraulics, Motors, cylinder_drive, slew_drive, telescope_drive, winch_drive
from .start import POSTURE, Start

__all__ = [
    "POSTURE",
    "Hydraulics",
    "Motors",
    "Start",
    "build",
    "check",
    "cylinder_drive",
    "parts",
    "slew_drive",
    "telescope_drive",
    "winch_drive",
]
