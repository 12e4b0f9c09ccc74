"""What a crane is: design files, their checks and their geometry.

crane = design.load("offshore-100t")
design.geometry.radius(crane, {"luff": 50 * deg, "jib": -70 * deg})
"""

from seacrane.design import (
    archive,
    buckling,
    changes,
    chart,
    geometry,
    imported,
    mass,
    mesh,
    parts,
    planar,
    robot,
    sheet,
    standard,
    workspace,
)
from seacrane.design.crane import (
    FOOT,
    FORMAT,
    Attachment,
    Crane,
    Cylinder,
    Hoist,
    Joint,
    JointMoment,
    Link,
    RatedLoad,
    Rating,
    Rope,
    Slew,
    Source,
)
from seacrane.design.reader import load, loads, names, save, to_json
from seacrane.design.validation import check

__all__ = [
    "FOOT",
    "FORMAT",
    "Attachment",
    "Crane",
    "Cylinder",
    "Hoist",
    "Joint",
    "JointMoment",
    "Link",
    "RatedLoad",
    "Rating",
    "Rope",
    "Slew",
    "Source",
    "archive",
    "buckling",
    "changes",
    "chart",
    "check",
    "geometry",
    "imported",
    "load",
    "loads",
    "mass",
    "mesh",
    "names",
    "parts",
    "planar",
    "robot",
    "save",
    "sheet",
    "standard",
    "to_json",
    "workspace",
]
