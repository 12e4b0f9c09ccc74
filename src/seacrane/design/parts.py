"""The parts that links are built from: each a shape from a few parameters, in the frame of its link.

A part says what a drawing would: where it sits, its outer dimensions and the thickness of its plates. `mesh` makes its
surface, `mass` its mass, centre and inertia. `standard` gives a crane that has none the parts one would expect of it.
"""

from __future__ import annotations

from typing import Annotated, Final

from msgspec import Meta, Struct

from seacrane.units import Density, Diameter, Length

STEEL: Final = 7850.0
"""Density of structural steel [kg/m3]."""

Name = Annotated[str, Meta(min_length=1, max_length=100)]
"""What something is called: one line."""

Place = tuple[Length, Length, Length]


class Station(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One cross-section of a girder."""

    x: Annotated[Length, Meta(description="along the link")]
    top: Annotated[Length, Meta(description="upper side above the link's axis")]
    bottom: Annotated[Length, Meta(description="lower side above the link's axis; usually negative")]
    width: Annotated[Length, Meta(gt=0, description="across the link")]


class _Part(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True, tag_field="kind"):
    name: Name
    density: Annotated[Density, Meta(gt=0)] = STEEL


class _Pinned(_Part, frozen=True, kw_only=True):
    x: Annotated[Length, Meta(description="of the pin or axle")]
    z: Annotated[Length, Meta(description="of the pin or axle")]


class Girder(_Part, frozen=True, kw_only=True, tag="girder"):
    """A tapering box of plates along the link, closed at both ends: boom, jib, telescope section, leg of a frame."""

    stations: Annotated[tuple[Station, ...], Meta(min_length=2, description="cross-sections, by growing x")]
    thickness: Annotated[Length, Meta(gt=0, description="of the plates")]
    y: Annotated[Length, Meta(description="of the middle, to port")] = 0.0


class Tube(_Part, frozen=True, kw_only=True, tag="tube"):
    """A round tube, conical if its diameters differ, open at both ends: pedestal, column, cross tube, pin."""

    start: Annotated[Place, Meta(description="middle of the first end")]
    end: Annotated[Place, Meta(description="middle of the second end")]
    diameter: Annotated[Diameter, Meta(gt=0, description="outer, at the start")]
    end_diameter: Annotated[Diameter, Meta(gt=0, description="outer, at the end")]
    thickness: Annotated[Length, Meta(gt=0, description="of the wall")]


class Lug(_Pinned, frozen=True, kw_only=True, tag="lug"):
    """A pair of eye plates that hold a pin, growing from a root on the structure."""

    root_x: Annotated[Length, Meta(description="of the middle of the root")]
    root_z: Annotated[Length, Meta(description="of the middle of the root")]
    root_width: Annotated[Length, Meta(gt=0, description="of the root along the structure")]
    radius: Annotated[Length, Meta(gt=0, description="of the plate about the pin")]
    hole: Annotated[Diameter, Meta(gt=0, description="of the pin")]
    thickness: Annotated[Length, Meta(gt=0, description="of one plate")]
    gap: Annotated[Length, Meta(gt=0, description="between the plates")]
    y: Annotated[Length, Meta(description="of the middle of the pair, to port")] = 0.0


class Sheave(_Pinned, frozen=True, kw_only=True, tag="sheave"):
    """A rope sheave on a pin across the link."""

    radius: Annotated[Length, Meta(gt=0, description="to the rim")]
    groove: Annotated[Length, Meta(gt=0, description="depth of the groove")]
    width: Annotated[Length, Meta(gt=0, description="across the rim")]
    hole: Annotated[Diameter, Meta(gt=0, description="of the pin")]


class Drum(_Pinned, frozen=True, kw_only=True, tag="drum"):
    """A winch drum with two flanges, its axle across the link."""

    radius: Annotated[Length, Meta(gt=0, description="of the barrel")]
    length: Annotated[Length, Meta(gt=0, description="between the outer sides of the flanges")]
    flange: Annotated[Length, Meta(gt=0, description="radius of the flanges")]
    thickness: Annotated[Length, Meta(gt=0, description="of barrel and flanges")]


class Box(_Part, frozen=True, kw_only=True, tag="box"):
    """A box of plates, or a solid one without a thickness: cabin, machinery house, counterweight."""

    centre: Annotated[Place, Meta(description="middle of the box")]
    size: Annotated[Place, Meta(description="along the link, across it, and up")]
    thickness: Annotated[Length | None, Meta(gt=0, description="of the plates; absent: solid")] = None


class Imported(_Part, frozen=True, kw_only=True, tag="mesh"):
    """A closed surface of the user's own, from `imported.read`; solid inside."""

    source: Annotated[str, Meta(min_length=1, description="the file it came from")]
    surface: Annotated[
        str, Meta(min_length=1, description="binary STL in m, z up, in the frame of the link, as base64")
    ]


Part = Girder | Tube | Lug | Sheave | Drum | Box | Imported
