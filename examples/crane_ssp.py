"""A crane with its drives as one SSP archive, to be run here or by any other tool that knows SSP.

    python examples/crane_ssp.py --out offshore-100t.ssp
    seacrane run offshore-100t.ssp --set spool.boom=0.5 --plot boom.png --signals 'boom_drive.cylinder.*.p,crane.luff'

In the archive are the four hydraulic drives, the crane's mechanics and the ship that it stands on, each an FMU, coupled
by power bonds. The operator's control, which is a Python function, is left out: the spools of the drives are inputs of
the system, each from -1 to 1.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from seacrane import cosim, design, plant

STEP = 0.002
"""Macro step [s], as in the demo."""


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--crane", default="offshore-100t", help="name of a shipped crane, or a design file")
    parser.add_argument("--out", type=Path, default=Path("crane.ssp"), help="the archive, or an .ssd (crane.ssp)")
    parser.add_argument("--version", choices=("1.0", "2.0"), default="1.0", help="version of SSP (default 1.0)")
    options = parser.parse_args(arguments)
    system = without_operator(plant.build(design.load(options.crane)))
    cosim.write_ssp(system, options.out, version=options.version)
    print(f"{options.out}: {len(system.slaves)} FMUs, {len(system.bonds)} power bonds")


def without_operator(whole: cosim.System) -> cosim.System:
    """The plant with the spools of its drives as inputs of the system in place of the joystick that moves them."""
    parts = {name: part for name, part in whole.level.parts.items() if name != "joystick"}
    own = [c for c in whole.level.connections if all(not end.startswith("joystick.") for end in ends(c))]
    experiment = cosim.Experiment(stop=10.0, step=STEP, algorithm="gauss-seidel")
    system = cosim.System(whole.name, parts, own, whole.level.bonds.values(), experiment=experiment)
    for name in parts:
        if name.endswith("_drive"):
            system.expose(f"spool.{name.removesuffix('_drive')}", f"{name}.spool")
    return system


def ends(connection: cosim.Connection | cosim.Transformation) -> list[str]:
    return [end for term in connection.terms for end in (term.source, term.target)]


if __name__ == "__main__":
    main()
