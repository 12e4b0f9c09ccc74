"""Gears and drums."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

from seacrane.library import symbols
from seacrane.library.references import DISSERTATION
from seacrane.model import BondGraph, Component, Rotational, Translational, initial, parameter
from seacrane.numerics.regularise import maximum
from seacrane.units import Diameter, Length, Ratio


class Gear(Component):
    """A reduction gear without loss: w_a = i w_b, T_b = -i T_a; i = `reduction` (100 for 100:1).

    motor ══a══(i : 1)══b══ load
    """

    reduction: Ratio = parameter("speed of a over speed of b", above=0, most=1e5)
    ports = {"a": Rotational("fast shaft"), "b": Rotational("slow shaft")}
    bond_graph = BondGraph("gear: TF", "a -> gear, gear -> b")
    icon = symbols.GEAR
    sources = (DISSERTATION,)

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield m.a.w, self.reduction * m.b.w
        yield m.b.T, -self.reduction * m.a.T


class WinchDrum(Component):
    """A drum: v = r w, T = r S, where S is the pull of the rope.

             ___
        w ↻ ( o )═══════ rope ──► S pulls off the drum        v > 0 and w > 0: rope comes in

    The rope port counts +v inwards, so the pull of the rope is rope.F = -S, and the shaft must be driven with
    shaft.T = r S. Reports `radius` [m] and `pull` [N]. Levels: `constant-radius` and `layers`.
    """

    radius: Length = parameter("radius of the drum to the centre of the first layer", above=0, most=20)
    ports = {"shaft": Rotational("shaft; hoisting is positive"), "rope": Translational("rope; coming in is positive")}
    bond_graph = BondGraph("drum: TF", "shaft -> drum, drum -> rope")
    icon = symbols.WINCH_DRUM
    sources = (DISSERTATION,)

    def winding(self, m: Any, radius: Any) -> Iterator[tuple[Any, Any]]:
        """The transformer at this radius."""
        yield m.rope.v, radius * m.shaft.w
        yield m.shaft.T, -radius * m.rope.F
        m.observe("radius_now", radius, "m", "radius at which the rope runs on")
        m.observe("pull", -m.rope.F, "N", "pull of the rope")


class ConstantRadiusWinchDrum(WinchDrum, level="constant-radius"):
    """The radius is that of the first layer."""

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        yield from self.winding(m, self.radius)


class LayeredWinchDrum(WinchDrum, level="layers"):
    """The radius grows with the rope on the drum: r = sqrt(r_0^2 + k d^2 L / (pi b)), dL/dt = v.

    It follows from the volume: an annulus pi (r^2 - r_0^2) b holds the length L of rope, of which each metre takes
    k d^2. d rope diameter, b width of the drum, k packing: 1 for layers on top of each other, 0.87 for rope lying in
    the grooves between. Never below r_0.
    """

    rope_diameter: Diameter = parameter("rope diameter", above=0, most=0.5)
    width: Length = parameter("width of the drum between flanges", above=0, most=50)
    packing: Ratio = parameter("packing factor", default=1.0, above=0.5, most=1.5)
    wound: Length = initial("length of rope on the drum at the start", least=0, most=5e4)
    bond_graph = BondGraph("drum: MTF", "shaft -> drum, drum -> rope, rope ~> drum")

    def equations(self, m: Any) -> Iterator[tuple[Any, Any]]:
        length = m.state("wound", unit="m", start=self.wound, nominal=100.0, about="length of rope on the drum")
        annulus = self.packing * self.rope_diameter**2 * maximum(length, 0.0) / (pi * self.width)
        yield m.der(length), m.rope.v
        yield from self.winding(m, (self.radius**2 + annulus) ** 0.5)
