"""The command line: `seacrane demo`, `designer`, `run` and the others, one module each."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence

from seacrane import __version__
from seacrane.errors import SeacraneError

from . import demo, design, designer, diagnose, fmu, model, recording, run, simulate


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and give its exit code.

    0 if all went well; 1 if a check, or a comparison, found problems; 2 if the command could not be carried out.
    """
    options = _parser().parse_args(arguments)
    try:
        status: int = options.run(options)
        sys.stdout.flush()
    except SeacraneError as error:
        for problem in error.problems:
            print(f"seacrane: {error.code}: {problem}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:  # who read the output has seen enough
        sys.stdout = None
        return 0
    except OSError as error:
        print(f"seacrane: {error.filename or 'system'}: {error.strerror or error}", file=sys.stderr)
        return 2
    return status


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="seacrane",
        description="Marine cranes: designed, modelled, simulated, operated.",
        epilog="Exit code: 0 if all went well, 1 if a check found problems, 2 if the command could not be carried out.",
    )
    parser.add_argument("--version", action="version", version=f"seacrane {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for command in (demo, run, diagnose, recording, simulate, model, fmu, design, designer):
        command.add(commands)
    return parser
