"""What a crane is: links, cylinders, hoist, slewing, capacity. Plain frozen data in SI; how it behaves is elsewhere.

Frames. The links form one chain from the crane's foot. The foot frame is fixed to the ship at the slewing ring:
x forward, y to port, z up. The frame of a link sits at its joint and turns (or slides) with it: x along the link,
z up in the plane of the crane. A luffing axis (0, -1, 0) makes raising positive. With all joints at zero all frames
are parallel.

The constraints written here are checked by `seacrane.design.check`, the single place for it: a `msgspec.Struct` does
not check itself when it is built in Python.
"""

from __future__ import annotations

import math
from typing import Annotated, Final, Literal, NoReturn

from msgspec import Meta, Struct, field

from seacrane.design.parts import Name, Part
from seacrane.units import (
    Angle,
    AngularSpeed,
    Diameter,
    Force,
    Frequency,
    Inertia,
    Length,
    Mass,
    MassPerLength,
    Pressure,
    Ratio,
    Speed,
    Torque,
)

FORMAT: Final = "seacrane-crane/1"
"""The version of the design file that this package writes and reads."""

FOOT: Final = "foot"
"""What an attachment names in place of a link to sit on the foot itself, fixed to the ship."""

Point = tuple[Length, Length, Length]
Direction = tuple[Ratio, Ratio, Ratio]
Limits = tuple[Angle, Angle]
"""Lower and upper end of a joint's travel: [rad] of a revolute joint, [m] of a prismatic one."""


class Joint(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How a link moves against the link before it."""

    name: Annotated[Name, Meta(description="name of the coordinate, such as luff")]
    kind: Annotated[Literal["revolute", "prismatic"], Meta(description="turns about, or slides along, its axis")]
    axis: Annotated[Direction, Meta(description="axis in the frame of the link before; any length but zero")]
    origin: Annotated[Point, Meta(description="origin of this link's frame in the frame of the link before")]
    limits: Annotated[Limits | None, Meta(description="lower and upper end of travel; absent if endless")] = None


class Link(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A rigid body of the chain, carried by its joint."""

    name: Name
    joint: Joint
    mass: Annotated[Mass, Meta(gt=0, description="mass with all that is fixed to it")]
    com: Annotated[Point, Meta(description="centre of mass in the link's frame")]
    inertia: Annotated[
        tuple[Inertia, Inertia, Inertia],
        Meta(description="moments of inertia about the centre of mass, along the link's axes; no products"),
    ]
    parts: Annotated[tuple[Part, ...], Meta(description="what it is built from")] = ()


class Attachment(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A point in the plane of the crane, fixed to a link or to the foot."""

    link: Annotated[str, Meta(description="name of the link, or foot")]
    x: Annotated[Length, Meta(description="along the link from its joint")]
    z: Annotated[Length, Meta(description="up from the link's axis")]


class Cylinder(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One or more equal double-acting cylinders side by side between two links."""

    name: Name
    moves: Annotated[str, Meta(description="name of the joint it moves")]
    count: Annotated[int, Meta(ge=1, le=16, description="number of cylinders side by side")] = 1
    bore: Annotated[Diameter, Meta(gt=0, description="piston diameter")]
    rod: Annotated[Diameter, Meta(gt=0, description="rod diameter")]
    stroke: Annotated[Length, Meta(gt=0, description="travel from end to end")]
    pressure: Annotated[Pressure, Meta(gt=0, description="working pressure")]
    base: Annotated[Attachment, Meta(description="pin of the barrel")]
    eye: Annotated[Attachment, Meta(description="pin of the rod")]
    retracted: Annotated[
        Length | None,
        Meta(gt=0, description="pin-to-pin length when fully in; absent: the travel is centred in the stroke"),
    ] = None
    efficiency: Annotated[Ratio, Meta(gt=0, le=1, description="force at the eye over pressure times area")] = 1.0


class Rope(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A wire rope."""

    diameter: Annotated[Diameter, Meta(gt=0)]
    EA: Annotated[Force, Meta(gt=0, description="axial stiffness: force per unit strain")]
    mass_per_length: Annotated[MassPerLength, Meta(gt=0)]
    damping_ratio: Annotated[Ratio, Meta(ge=0, lt=1, description="of critical, with the load as the mass")]
    breaking_load: Annotated[Force | None, Meta(gt=0, description="minimum breaking load")] = None
    safety_factor: Annotated[Ratio, Meta(ge=1, description="breaking load over the largest tension, dynamics in")] = 3.0


class Hoist(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Drum, rope and the sheaves on the way to the hook."""

    drum: Annotated[Attachment, Meta(description="where the rope leaves the drum")]
    drum_radius: Annotated[Length, Meta(gt=0, description="to the centre of the rope in the first layer")]
    sheaves: Annotated[tuple[Attachment, ...], Meta(min_length=1, description="from the drum to the tip, tip last")]
    rope: Rope
    speed: Annotated[Speed, Meta(gt=0, description="of the rope, with the rated load")]
    compensation_speed: Annotated[Speed, Meta(gt=0, description="of the rope, in heave compensation")]
    falls: Annotated[int, Meta(ge=1, le=16, description="parts of rope that carry the hook")] = 1
    sheave_efficiency: Annotated[Ratio, Meta(gt=0, le=1, description="of one sheave turning under load")] = 1.0
    line_pull: Annotated[Force | None, Meta(gt=0, description="largest pull of the winch on the rope")] = None
    hook_mass: Annotated[Mass, Meta(ge=0, description="hook block and what hangs above the load")] = 0.0


class Slew(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The slewing drive."""

    joint: Annotated[str, Meta(description="name of the joint it moves")]
    speed: Annotated[AngularSpeed, Meta(gt=0, description="rated slewing speed")]


class RatedLoad(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One point of the rated-load curve."""

    radius: Annotated[Length, Meta(gt=0, description="from the slewing axis")]
    mass: Annotated[Mass, Meta(gt=0, description="on the hook")]


class JointMoment(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the structure bears about a joint."""

    joint: Annotated[str, Meta(description="name of the joint")]
    moment: Annotated[Torque, Meta(gt=0, description="allowable moment of all that hangs outboard, dynamics in")]


class Rating(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What bounds the loads besides cylinders, rope and winch, and the conditions that the load chart is drawn for."""

    harbour_factor: Annotated[
        Ratio, Meta(ge=1, le=3, description="dynamic factor in harbour, and the least at sea")
    ] = 1.0
    wave_heights: Annotated[
        tuple[Annotated[Length, Meta(gt=0, le=20, description="significant wave height")], ...],
        Meta(max_length=12, description="significant wave heights Hs with a curve of their own"),
    ] = (1.0, 1.5, 2.0, 2.5)
    tip_speed_per_height: Annotated[
        Frequency, Meta(ge=0, description="vertical speed of the tip per metre of Hs, from the ship's motion")
    ] = 0.0
    heel: Annotated[Angle, Meta(ge=0, le=0.35, description="heel of the ship, to whichever side is worse")] = 0.0
    trim: Annotated[Angle, Meta(ge=0, le=0.35, description="trim of the ship, by whichever end is worse")] = 0.0
    slew_moment: Annotated[
        Torque | None, Meta(gt=0, description="allowable overturning moment of the slewing ring, dynamics in")
    ] = None
    slew_torque: Annotated[
        Torque | None, Meta(gt=0, description="what the slewing gear holds about its axis, dynamics in")
    ] = None
    load_moment: Annotated[
        Torque | None, Meta(gt=0, description="allowable weight of load and hook block times radius")
    ] = None
    heeling_moment: Annotated[
        Torque | None, Meta(gt=0, description="what the ship's stability allows: load and hook over the side")
    ] = None
    structure: Annotated[tuple[JointMoment, ...], Meta(description="what the structure bears, joint by joint")] = ()

    @property
    def tilt(self) -> float:
        """How steeply the deck falls, heel and trim together [rad]."""
        return math.atan(math.hypot(math.tan(self.heel), math.tan(self.trim)))


class Source(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Where numbers of a design come from."""

    of: Annotated[str, Meta(min_length=1, description="which numbers")]
    kind: Literal["published", "measured", "derived", "fitted", "assumption"]
    note: Annotated[str, Meta(min_length=1)]


class Crane(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A crane: everything that its model, its load chart and its picture are made from."""

    format: Annotated[Literal["seacrane-crane/1"], Meta(description="version of the design file")] = FORMAT
    name: Name
    about: Annotated[str, Meta(min_length=1, description="what it is, in a sentence or two")]
    links: Annotated[
        tuple[Link, ...], Meta(min_length=1, max_length=12, description="the chain, from the foot to the tip")
    ]
    cylinders: tuple[Cylinder, ...]
    hoist: Hoist
    slew: Annotated[Slew | None, Meta(description="absent if the crane does not slew")] = None
    rating: Rating = field(default_factory=Rating)
    bulk_modulus: Annotated[Pressure, Meta(gt=0, description="effective bulk modulus of oil with its hoses")]
    pedestal: Annotated[Point, Meta(description="the foot in the ship's frame: from midship at the waterline")]
    capacity: Annotated[tuple[RatedLoad, ...], Meta(min_length=1, description="rated load, by growing radius")]
    sources: Annotated[tuple[Source, ...], Meta(description="where the numbers come from")] = field(default=())

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The joints of the chain, from the foot to the tip."""
        return tuple(link.joint for link in self.links)

    def link(self, name: str) -> Link:
        """The link of this name; `KeyError` if there is none."""
        return next((link for link in self.links if link.name == name), None) or _missing("link", name)

    def cylinder(self, name: str) -> Cylinder:
        """The cylinder (or pair) of this name; `KeyError` if there is none."""
        return next((c for c in self.cylinders if c.name == name), None) or _missing("cylinder", name)


def _missing(kind: str, name: str) -> NoReturn:
    raise KeyError(f"no {kind} {name!r}")
