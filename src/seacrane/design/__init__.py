"""What a crane is: design files, their checks and their geometry.

crane = design.load("offshore-100t")
design.geometry.radius(crane, {"luff": 50 * deg, "jib": -70 * deg})
"""

from seacrane.design import geometry
from seacrane.design.crane import (
    FORMAT,
    Attachment,
    Crane,
    Cylinder,
    Hoist,
    Joint,
    Link,
    RatedLoad,
    Rope,
    Slew,
    Source,
)
from seacrane.design.reader import load, loads, names, save, to_json
from seacrane.design.validation import check

__all__ = [
    "FORMAT",
    "Attachment",
    "Crane",
    "Cylinder",
    "Hoist",
    "Joint",
    "Link",
    "RatedLoad",
    "Rope",
    "Slew",
    "Source",
    "check",
    "geometry",
    "load",
    "loads",
    "names",
    "save",
    "to_json",
]
