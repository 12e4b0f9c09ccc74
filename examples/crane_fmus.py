"""A crane as FMUs: its slewing, boom, jib and winch drive and its mechanics, ready to be coupled by their terminals.

    python examples/crane_fmus.py --out fmus --version 3.0 --platforms all

Each FMU runs for co-simulation and for model exchange in any tool that knows FMI. The terminals of the drives fit those
of the crane: what leaves `boom_drive` at `rod` goes into `crane` at `boom_cylinder`.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from seacrane import design, fmi, plant


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--crane", default="offshore-100t", help="name of a shipped crane, or a design file")
    parser.add_argument("--out", type=Path, default=Path("fmus"), help="folder for the FMUs (default fmus)")
    parser.add_argument("--version", choices=("2.0", "3.0"), default="2.0", help="version of FMI (default 2.0)")
    parser.add_argument("--platforms", default="host", help="host, all, or names such as x86_64-windows,aarch64-linux")
    parser.add_argument("--sources", action="store_true", help="put the C sources inside")
    options = parser.parse_args(arguments)
    platforms = options.platforms if options.platforms in ("host", "all") else options.platforms.split(",")

    options.out.mkdir(parents=True, exist_ok=True)
    for name, model in plant.parts(design.load(options.crane)).items():
        print(f"{name}: exporting", file=sys.stderr)
        path = fmi.export(
            model,
            options.out / f"{name}.fmu",
            version=options.version,
            platforms=platforms,
            sources=options.sources,
        )
        description = fmi.read(path)
        print(f"{path}: {len(description.derivatives)} states, {path.stat().st_size / 1024:.0f} kB")
        for terminal in description.terminals:
            print(f"    {terminal.name}: {', '.join(terminal.members.values())}")


if __name__ == "__main__":
    main()
